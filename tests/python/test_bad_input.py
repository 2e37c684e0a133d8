"""Bad input ends in exit code 2 (3 when proved impossible), soon, with an error that helps.

The error is on stderr and names the file and, for text, the line; nothing is written; no panic.
"""

import json
from pathlib import Path

import pytest

import base_scene
from bad_input import SECONDS, plan_text, refused
from base_scene import box, cylinder, line_of, yaml_text
from clearway_cli import BAD_INPUT, IMPOSSIBLE, OUT_OF_BUDGET, SOLVED


@pytest.fixture
def scene() -> dict:
    return base_scene.scene()


# --- text ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "format: clearway-scene/1\nname: [unclosed\ntarget: {\n",
        "format: clearway-scene/1\n\tname: tabs\n",
        "format: 'clearway-scene/1\n",
        "a: 1\n b: 2\n",
    ],
    ids=["brackets", "tabs", "quote", "indent"],
)
def test_not_yaml(clearway, tmp_path, text):
    refused(clearway, tmp_path, text, line=True)


@pytest.mark.parametrize(
    "data", [b"", b"\0\1\2\3" * 50, b"\xff\xfe\x80", b"just words", b"[1, 2, 3]"],
    ids=["empty", "zeros", "not-utf8", "words", "list"],
)  # fmt: skip
def test_not_a_scene(clearway, tmp_path, data):
    refused(clearway, tmp_path, data)


def test_no_such_file(clearway, tmp_path):
    refused(clearway, tmp_path, None)


def test_a_folder_is_no_scene(clearway, tmp_path):
    (tmp_path / "scene.yaml").mkdir()
    refused(clearway, tmp_path, None)


def test_another_format(clearway, tmp_path, scene):
    scene["format"] = "clearway-scene/999"
    refused(clearway, tmp_path, yaml_text(scene), "clearway-scene/1", "clearway-scene/999")


@pytest.mark.parametrize("where", ["scene", "robot", "fixture", "object", "shape", "place"])
def test_unknown_key(clearway, tmp_path, scene, where):
    {
        "scene": scene,
        "robot": scene["robot"],
        "fixture": scene["fixtures"][1],
        "object": scene["objects"][2],
        "shape": scene["objects"][2]["cylinder"],
        "place": scene["place"][0],
    }[where]["colour"] = "red"
    text = yaml_text(scene)
    refused(clearway, tmp_path, text, "colour", line=line_of(text, "colour"))


@pytest.mark.parametrize("key", ["format", "robot", "objects", "target"])
def test_missing_key(clearway, tmp_path, scene, key):
    del scene[key]
    refused(clearway, tmp_path, yaml_text(scene), key)


def test_wrong_type(clearway, tmp_path, scene):
    scene["objects"][1]["cylinder"]["radius"] = "wide"
    text = yaml_text(scene)
    refused(clearway, tmp_path, text, line=line_of(text, "wide"))


def test_two_shapes(clearway, tmp_path, scene):
    scene["objects"][1]["sphere"] = {"radius": 0.03}
    refused(clearway, tmp_path, yaml_text(scene), "near_middle", line=True)


def test_no_shape(clearway, tmp_path, scene):
    del scene["objects"][1]["cylinder"]
    refused(clearway, tmp_path, yaml_text(scene), "near_middle", line=True)


# --- numbers ------------------------------------------------------------------------------------

BAD_NUMBERS = [".nan", ".inf", "-.inf", "1e400"]


@pytest.mark.parametrize("value", [*BAD_NUMBERS, "0", "0.0", "-0.037"])
def test_bad_sizes(clearway, tmp_path, scene, value):
    scene["objects"][1]["cylinder"]["radius"] = "SIZE"
    text = yaml_text(scene).replace('"SIZE"', value)
    refused(clearway, tmp_path, text, line=line_of(text, "near_middle"))


@pytest.mark.parametrize("value", [*BAD_NUMBERS, "0", "-1"])
def test_bad_fixture_sizes(clearway, tmp_path, scene, value):
    scene["fixtures"][3]["box"]["size"][1] = "SIZE"
    text = yaml_text(scene).replace('"SIZE"', value)
    refused(clearway, tmp_path, text, line=line_of(text, "back_wall"))


@pytest.mark.parametrize("value", BAD_NUMBERS)
@pytest.mark.parametrize("where", ["object", "fixture", "place", "base"])
def test_bad_positions(clearway, tmp_path, scene, value, where):
    {
        "object": scene["objects"][1],
        "fixture": scene["fixtures"][1],
        "place": scene["place"][0],
        "base": scene["robot"]["base"],
    }[where]["position"][0] = "NUMBER"
    text = yaml_text(scene).replace('"NUMBER"', value)
    refused(clearway, tmp_path, text, line=line_of(text, value))


@pytest.mark.parametrize("quaternion", [[0, 0, 0, 0], [1, 2, 3, 4], [0, 0, 1]])
def test_bad_quaternions(clearway, tmp_path, scene, quaternion):
    scene["objects"][1]["quaternion"] = quaternion
    text = yaml_text(scene)
    refused(clearway, tmp_path, text, line=line_of(text, "near_middle"))


# --- what stands where --------------------------------------------------------------------------


def test_overlapping_objects(clearway, tmp_path, scene):
    scene["objects"][1]["position"][1] = 0.07
    refused(clearway, tmp_path, yaml_text(scene), "near_left", "near_middle")


def test_an_object_in_a_wall(clearway, tmp_path, scene):
    scene["objects"][4]["position"][1] = 0.43
    refused(clearway, tmp_path, yaml_text(scene), "far_left", "left_wall")


@pytest.mark.parametrize("shift", [-0.003, 0.003, -0.05, 0.4])
def test_sunk_or_floating(clearway, tmp_path, scene, shift):
    scene["objects"][4]["position"][2] += shift
    refused(clearway, tmp_path, yaml_text(scene), "far_left")


@pytest.mark.parametrize("shift", [-0.0008, 0.0008])
def test_measurement_noise_is_no_error(clearway, tmp_path, scene, shift):
    scene["objects"][4]["position"][2] += shift
    path = base_scene.write(tmp_path, scene)
    clearway.solve(path, tmp_path / "plan.json", "--seed", 1)


def test_beside_every_support(clearway, tmp_path, scene):
    scene["objects"].append(cylinder("adrift", 0.3, 0.9))
    refused(clearway, tmp_path, yaml_text(scene), "adrift")


def test_a_scene_mesh_that_is_missing(clearway, tmp_path, scene):
    del scene["objects"][1]["cylinder"]
    scene["objects"][1]["mesh"] = {"file": "missing.stl"}
    refused(clearway, tmp_path, yaml_text(scene), "missing.stl", "near_middle")


# --- names --------------------------------------------------------------------------------------


@pytest.mark.parametrize("target", ["nobody", "floor", ""])
def test_the_target_is_no_object(clearway, tmp_path, scene, target):
    scene["target"] = target
    text = yaml_text(scene)
    refused(clearway, tmp_path, text, target, line=line_of(text, "target:"))


@pytest.mark.parametrize(
    "kinds", [("objects", "objects"), ("fixtures", "fixtures"), ("fixtures", "objects")]
)
def test_two_with_one_id(clearway, tmp_path, scene, kinds):
    scene[kinds[0]][0]["id"] = scene[kinds[1]][1]["id"] = "twin"
    refused(clearway, tmp_path, yaml_text(scene), "twin", line=True)


def test_no_objects(clearway, tmp_path, scene):
    scene["objects"] = []
    refused(clearway, tmp_path, yaml_text(scene))


def test_a_start_that_names_no_joint(clearway, tmp_path, scene):
    scene["robot"]["start"] = {"knee_joint": 0.0}
    refused(clearway, tmp_path, yaml_text(scene), "knee_joint")


def test_a_start_past_a_limit(clearway, tmp_path, scene):
    scene["robot"]["start"] = {"elbow_joint": 3.5}
    refused(clearway, tmp_path, yaml_text(scene), "elbow_joint")


# --- too much -----------------------------------------------------------------------------------


@pytest.mark.parametrize("opening", ["[", "{a: ", "- "])
def test_200_000_nested_values(clearway, tmp_path, opening):
    refused(clearway, tmp_path, "name: x\nobjects:\n  " + opening * 200_000)


def test_an_alias_bomb(clearway, tmp_path):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x, x]"]
    for level in range(1, 30):
        lines.append(f"a{level}: &a{level} [" + ", ".join([f"*a{level - 1}"] * 10) + "]")
    refused(clearway, tmp_path, "\n".join(lines) + "\nobjects: *a29\n")


@pytest.mark.parametrize("filler", ["# a comment\n", "x: 1\n"], ids=["comments", "keys"])
def test_a_50_mb_scene(clearway, tmp_path, scene, filler):
    refused(clearway, tmp_path, yaml_text(scene) + filler * (50_000_000 // len(filler)))


def test_a_file_without_end(clearway, tmp_path):
    (tmp_path / "scene.yaml").symlink_to("/dev/zero")
    refused(clearway, tmp_path, None)


def test_two_thousand_objects(clearway, tmp_path, scene):
    """Too many is an answer; a panic or a hang is none."""
    scene["objects"] += [
        {
            "id": f"pea{i}",
            "sphere": {"radius": 0.001},
            "position": [1.1 + 0.003 * (i % 40), 0.003 * (i // 40), base_scene.FLOOR + 0.001],
        }
        for i in range(2000)
    ]
    done, _ = plan_text(clearway, tmp_path, yaml_text(scene), "--time-limit", "5")
    assert done.code in (SOLVED, BAD_INPUT, OUT_OF_BUDGET), f"exit code {done.code}\n{done.err}"
    if done.code == BAD_INPUT:
        assert "scene.yaml" in done.err


# --- the robot cannot start, or cannot do it ----------------------------------------------------


FOLDED = {
    "shoulder_pan_joint": 0.0,
    "shoulder_lift_joint": -2.273,
    "elbow_joint": 2.148,
    "wrist_1_joint": 0.125,
    "wrist_2_joint": 1.5708,
    "wrist_3_joint": 0.0,
}
"""A start posture, clear of the base scene; radians."""
ELBOW, KNUCKLES = [-0.395, 0.05, 0.895], [0.36, 0.164, 0.85]
"""Where the elbow is in that posture, and the middle between the knuckles; metres, world."""


def test_a_start_in_a_fixture(clearway, tmp_path, scene):
    scene["robot"]["start"] = FOLDED
    scene["fixtures"].append(box("post", [0.2, 0.2, 0.2], ELBOW))
    done = refused(clearway, tmp_path, yaml_text(scene), "post")
    assert any(link in done.err for link in ("forearm_link", "upper_arm_link")), done.err


def test_a_start_in_an_object(clearway, tmp_path, scene):
    """A can on a stand, between the knuckles."""
    scene["robot"]["start"] = FOLDED
    x, y, z = KNUCKLES
    scene["fixtures"].append(
        box("stand", [0.06, 0.06, 0.04], [x, y, z - base_scene.HEIGHT / 2 - 0.02])
    )
    scene["objects"].append(cylinder("can", x, y, z))
    done = refused(clearway, tmp_path, yaml_text(scene), "can")
    assert "knuckle" in done.err, done.err


def test_a_start_in_itself(clearway, tmp_path, scene):
    """The forearm folded back onto the upper arm."""
    scene["robot"]["start"] = {**FOLDED, "elbow_joint": 3.14, "wrist_1_joint": 0.0}
    done = refused(clearway, tmp_path, yaml_text(scene))
    assert done.err.count("_link") >= 2, done.err


def test_nowhere_to_put_things(clearway, tmp_path, scene):
    scene["place"] = []
    done, plan = plan_text(clearway, tmp_path, yaml_text(scene))
    assert done.code in (BAD_INPUT, IMPOSSIBLE), f"exit code {done.code}\n{done.err}"
    assert "place" in done.err
    if done.code == BAD_INPUT:
        assert not plan.exists() and "scene.yaml" in done.err
    else:
        says_why(plan, "impossible")


def says_why(plan: Path, status: str) -> str:
    """The plan file of a failure has its status and a reason; returns the reason."""
    content = json.loads(plan.read_text())
    assert content["status"] == status
    assert not content.get("steps")
    summary = content["why"]["summary"]
    assert summary.strip()
    return summary


def test_a_target_that_no_grasp_reaches(clearway, tmp_path, scene):
    """Three metres further off, even an empty cabinet is out of reach."""
    for body in scene["fixtures"][:5] + scene["objects"]:
        body["position"][0] += 3.0
    done, plan = plan_text(clearway, tmp_path, yaml_text(scene))
    assert done.code == IMPOSSIBLE, f"exit code {done.code}\n{done.err}"
    assert "wanted" in says_why(plan, "impossible")
    assert "wanted" in done.err


def test_a_target_wider_than_the_hand_opens(clearway, tmp_path, scene):
    scene["objects"][3]["cylinder"]["radius"] = 0.06
    done, plan = plan_text(clearway, tmp_path, yaml_text(scene))
    assert done.code == IMPOSSIBLE, f"exit code {done.code}\n{done.err}"
    assert "wanted" in says_why(plan, "impossible")


def test_no_time_at_all(clearway, tmp_path, scene):
    done, plan = plan_text(clearway, tmp_path, yaml_text(scene), "--time-limit", "1e-6")
    assert done.code == OUT_OF_BUDGET, f"exit code {done.code}\n{done.err}"
    says_why(plan, "out_of_budget")


# --- the command line ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ["fly"],
        ["plan"],
        ["plan", "SCENE", "--speed", "9"],
        ["plan", "SCENE", "--seed", "many"],
        ["plan", "SCENE", "--time-limit", "nan"],
        ["plan", "SCENE", "--time-limit", "-1"],
        ["plan", "SCENE", "--threads", "0"],
        ["generate", "cave"],
        ["generate", "shelf", "--objects", "0"],
        ["generate", "shelf", "--objects", "100000"],
        ["schema", "shelf"],
        ["verify", "SCENE"],
        ["verify", "nowhere.json"],
        ["explain", "nowhere.json"],
        ["robot", "nowhere.yaml"],
    ],
    ids=" ".join,
)
def test_a_wrong_command_line(clearway, tmp_path, scene, arguments):
    path = str(base_scene.write(tmp_path, scene))
    done = clearway.run(*(a.replace("SCENE", path) for a in arguments), seconds=SECONDS)
    assert done.code == BAD_INPUT, f"exit code {done.code}\n{done.out}{done.err}"
    assert done.err.strip()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        '{"format": "clearway-plan/1"}',
        '{"format": "clearway-plan/1", "status": 3}',
        "[" * 200_000,
    ],
    ids=["empty", "brace", "keys", "type", "nested"],
)  # fmt: skip
def test_a_spoilt_plan_file(clearway, tmp_path, text):
    path = tmp_path / "plan.json"
    path.write_text(text)
    done = clearway.run("verify", path, seconds=SECONDS)
    assert done.code == BAD_INPUT, f"exit code {done.code}\n{done.err}"
    assert "plan.json" in done.err
