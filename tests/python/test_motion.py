"""`clearway motion`: every kind of obstacle, what is held, trajectories, and bad input."""

import json

import jsonschema
import numpy as np
import pytest

import motion_checker
import sphere_arm
from bad_input import SECONDS
from base_scene import line_of, yaml_text
from box_stl import write_box_stl
from clearway_cli import BAD_INPUT, OUT_OF_BUDGET, SOLVED
from motion_checker import Part
from plan_checker import poses

FINER = 4 * 32
ROUNDING = 1e-6
ROOT_IN_WORLD = {"position": [0.1, -0.2, 0.05], "rpy": [0.0, 0.0, 0.4]}
ROOT_FROM_WORLD = poses.inverse(poses.from_keys(ROOT_IN_WORLD))
TURNED = {"rpy": [0.3, -0.4, 0.5]}


def in_the_way(**keys) -> dict:
    """An obstacle straight ahead of the arm, 0.55 m from its root."""
    at = poses.apply(poses.from_keys(ROOT_IN_WORLD), np.array([[0.55, 0.0, 0.5]]))[0]
    return {"id": "wall", "position": at.tolist(), **keys}


def problem() -> dict:
    return {
        "format": "clearway-motion/1",
        "robot": {"urdf": "arm.urdf"},
        "base": ROOT_IN_WORLD,
        "obstacles": [in_the_way(sphere={"radius": 0.15})],
        "start": {"pan": 0.3, "shoulder": 0.9, "elbow": 0.4, "wrist": 0.0},
        "goals": [[-1.5, 0.9, 0.4, 0.2], {"pan": -1.7, "shoulder": 1.0, "elbow": 0.3, "wrist": 0}],
    }


def plan(clearway, folder, content, *more, seconds=60.0):
    (folder / "arm.urdf").write_text(sphere_arm.urdf(), encoding="utf-8")
    text = content if isinstance(content, str) else yaml_text(content)
    (folder / "problem.yaml").write_text(text, encoding="utf-8")
    return clearway.run("motion", folder / "problem.yaml", *more, seconds=seconds)


def solved(clearway, folder, content, *more) -> dict:
    done = plan(clearway, folder, content, "--json", *more)
    assert done.code == SOLVED, done.err
    answer = json.loads(done.out)
    assert answer["status"] == "solved" and answer["joints"] == sphere_arm.JOINTS
    return answer


def posture(keys) -> np.ndarray:
    return np.array([keys[j] for j in sphere_arm.JOINTS] if isinstance(keys, dict) else keys)


def check(answer, content, parts, margin=0.0, held=(), ignored=()):
    """The path leads from the start to the goal named, round the parts, at the cost said."""
    path = np.array(answer["path"])
    assert np.allclose(path[0], posture(content["start"]))
    assert np.allclose(path[-1], posture(content["goals"][answer["goal"]]))
    assert answer["cost"] == pytest.approx(motion_checker.length(path))
    arm = motion_checker.SphereRobot(sphere_arm.urdf(), sphere_arm.JOINTS)
    parts = [Part(p.kind, p.size, ROOT_FROM_WORLD @ p.pose) for p in parts]

    def least(rows):
        dense = motion_checker.densely(rows, FINER)
        return arm.clearances(dense, parts, held, ignored).min()

    assert least(path) >= margin - ROUNDING
    # The straight line is not free, so something was asked of the planner.
    assert least([path[0], path[-1]]) < margin
    if answer["trajectory"]:
        assert least(answer["trajectory"]["positions"]) >= margin - ROUNDING


def world(keys) -> np.ndarray:
    return poses.from_keys(keys)


SHAPES = {
    "box": ({"box": {"size": [0.1, 0.24, 0.3]}}, [("box", (0.05, 0.12, 0.15), np.eye(4))]),
    "cylinder": (
        {"cylinder": {"radius": 0.12, "height": 0.4}},
        [("cylinder", (0.12, 0.2), np.eye(4))],
    ),
    "sphere": ({"sphere": {"radius": 0.15}}, [("sphere", 0.15, np.eye(4))]),
    "capsule": ({"capsule": {"radius": 0.1, "height": 0.3}}, [("capsule", (0.1, 0.15), np.eye(4))]),
    "mesh": (
        {"mesh": {"file": "block.stl", "scale": 0.5}},
        [("box", (0.05, 0.12, 0.15), poses.pose(np.eye(3), [0.05, 0.0, 0.0]))],
    ),
    "points": (
        {"points": {"file": "cloud.xyz", "radius": 0.03}},
        [
            ("sphere", 0.03, poses.pose(np.eye(3), [0.0, y, z]))
            for y in (-0.1, -0.05, 0.0, 0.05, 0.1)
            for z in (-0.1, -0.05, 0.0, 0.05, 0.1)
        ],
    ),
    "compound": (
        {
            "compound": [
                {"box": {"size": [0.04, 0.3, 0.04]}, "position": [0.0, 0.0, 0.1]},
                {"sphere": {"radius": 0.1}, "position": [0.0, 0.0, -0.1]},
            ]
        },
        [
            ("box", (0.02, 0.15, 0.02), poses.pose(np.eye(3), [0.0, 0.0, 0.1])),
            ("sphere", 0.1, poses.pose(np.eye(3), [0.0, 0.0, -0.1])),
        ],
    ),
}


@pytest.mark.parametrize("kind", SHAPES)
@pytest.mark.parametrize("margin", [0.0, 0.02])
def test_every_shape_is_kept_clear_of(clearway, tmp_path, kind, margin):
    keys, made_of = SHAPES[kind]
    write_box_stl(tmp_path / "block.stl", ((0.1, 0.0, 0.0), (0.2, 0.48, 0.6)))
    cloud = [p[2][:3, 3] for p in SHAPES["points"][1]]
    (tmp_path / "cloud.xyz").write_text("".join(f"{x} {y} {z}\n" for x, y, z in cloud))
    obstacle = in_the_way(**keys, **TURNED)
    content = {**problem(), "obstacles": [obstacle], "margin": margin}
    parts = [Part(k, size, world(obstacle) @ inner) for k, size, inner in made_of]
    check(solved(clearway, tmp_path, content), content, parts, margin)


def test_what_is_held_is_kept_clear_too(clearway, tmp_path):
    """A ball at the end of the hand; it may touch the fore arm, which it overlaps."""
    content = problem()
    content["attached"] = {
        "id": "ball",
        "link": "hand",
        "sphere": {"radius": 0.07},
        "position": [0.0, 0.0, 0.1],
        "touch_links": ["fore"],
    }
    ball = [("hand", [0.0, 0.0, 0.1], 0.07, "ball")]
    (obstacle,) = content["obstacles"]
    answer = solved(clearway, tmp_path, content)
    sphere = [Part("sphere", 0.15, world(obstacle))]
    check(answer, content, sphere, 0.0, ball, [("ball", "hand"), ("ball", "fore")])
    content["attached"]["touch_links"] = []
    done = plan(clearway, tmp_path, content)
    # Nothing but the list of links lets the ball meet the fore arm; unless they never part.
    assert done.code in (SOLVED, BAD_INPUT)
    content["attached"]["sphere"]["radius"] = 0.5
    done = plan(clearway, tmp_path, content)
    assert done.code == BAD_INPUT and "ball" in done.err and "touches" in done.err


def test_one_seed_one_path(clearway, tmp_path):
    first, again, other = (solved(clearway, tmp_path, problem(), "--seed", s) for s in (4, 4, 5))
    for key in ("path", "trajectory", "cost", "goal"):
        assert first[key] == again[key]
    assert first["path"] != other["path"]


def test_trajectories_keep_the_limits(clearway, tmp_path):
    limits = {"acceleration": {j: 3.0 + i for i, j in enumerate(sphere_arm.JOINTS)}, "jerk": 60}
    content = {**problem(), "limits": limits}
    answer = solved(clearway, tmp_path, content)
    check(answer, content, [Part("sphere", 0.15, world(content["obstacles"][0]))])
    times = np.array(answer["trajectory"]["times"])
    rows = np.array(answer["trajectory"]["positions"])
    steps = np.diff(times)
    assert times[0] == 0 and (steps > 0).all() and steps.max() <= 0.02 + 1e-9
    assert np.allclose(rows[[0, -1]], np.array(answer["path"])[[0, -1]], atol=1e-9)
    velocity = np.diff(rows, axis=0) / steps[:, None]
    assert np.abs(velocity).max() <= 2.0 + 1e-6
    between = (steps[1:] + steps[:-1])[:, None] / 2
    acceleration = np.abs(np.diff(velocity, axis=0) / between).max(axis=0)
    assert (acceleration <= np.array([3.0, 4.0, 5.0, 6.0]) + 1e-6).all()
    even = steps.mean()
    assert np.allclose(steps, even, rtol=1e-6)
    assert np.abs(np.diff(rows, n=3, axis=0)).max() / even**3 <= 60 + 1e-3


def test_no_limits_no_trajectory(clearway, tmp_path):
    answer = solved(clearway, tmp_path, problem())
    assert answer["trajectory"] is None
    assert any("limits" in why for why in answer["why"])


def test_a_robot_file_has_limits(clearway, tmp_path):
    """The built-in robot stands on a table, which its root may touch."""
    content = {
        "format": "clearway-motion/1",
        "robot": {"model": "panda"},
        "obstacles": [
            {"id": "table", "box": {"size": [1.0, 1.0, 0.04]}, "position": [0.0, 0.0, -0.01]},
            {"id": "post", "capsule": {"radius": 0.05, "height": 0.8}, "position": [0.5, 0.0, 0.5]},
        ],
        "start": [0.9, 0.2, 0.0, -1.9, 0.0, 2.0, 0.785],
        "goals": [[-0.9, 0.2, 0.0, -1.9, 0.0, 2.0, 0.785]],
    }
    done = plan(clearway, tmp_path, content, "-o", tmp_path / "answer.json")
    assert done.code == SOLVED, done.err
    assert done.out.startswith("solved: ") and "s of motion" in done.out
    answer = json.loads((tmp_path / "answer.json").read_text())
    assert len(answer["joints"]) == 7 and len(answer["trajectory"]["times"]) > 10


def test_json_is_read_and_the_schema_holds(clearway, tmp_path):
    schema = json.loads(clearway.run("schema", "motion").out)
    jsonschema.validate(problem(), schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**problem(), "colour": "red"}, schema)
    solved(clearway, tmp_path, json.dumps(problem()))


def test_goals_in_collision_are_passed_over(clearway, tmp_path):
    content = problem()
    content["goals"].insert(0, [-0.6, 0.9, 0.4, 0.0])
    answer = solved(clearway, tmp_path, content)
    assert answer["goal"] in (1, 2)
    assert any(why.startswith("goal 1 is in collision: ") for why in answer["why"])


def test_no_goal_reachable_is_4(clearway, tmp_path):
    """Walls on both sides of the start, and a ceiling."""
    content = problem()
    content["start"] = {"pan": 0.9, "shoulder": 1.6, "elbow": 0.0, "wrist": 0.0}
    content["goals"] = [[-0.9, 1.6, 0.0, 0.0]]
    # The arm points along pan + 0.6, so the first wall is between; low as the ceiling is, the arm
    # cannot be folded small enough to pass a wall's inner end, nor be turned over.
    walls = [
        ([1.27, 0.02, 0.9], 0.6, [0.765, 0.0, 0.05]),
        ([1.27, 0.02, 0.9], 0.6 + np.pi, [0.765, 0.0, 0.05]),
    ]
    content["obstacles"] = []
    for i, (size, yaw, at) in enumerate([*walls, ([3.0, 3.0, 0.02], 0.0, [0.0, 0.0, 0.52])]):
        turn = poses.from_keys(ROOT_IN_WORLD) @ poses.from_keys({"rpy": [0.0, 0.0, yaw]})
        place = poses.apply(turn, np.array([at]))[0].tolist()
        body = {
            "id": f"wall{i}",
            "box": {"size": size},
            "position": place,
            "rpy": [0, 0, 0.4 + yaw],
        }
        content["obstacles"].append(body)
    done = plan(clearway, tmp_path, content, "--time-limit", "1", "-o", tmp_path / "a.json")
    assert done.code == OUT_OF_BUDGET, done.out + done.err
    assert "no way from the start to the goal was found" in done.err
    answer = json.loads((tmp_path / "a.json").read_text())
    assert answer["status"] == "out_of_budget" and answer["path"] == []
    assert "nothing is proved" in answer["why"][0]


def changed(**keys):
    return lambda content: content.update(keys)


def robot(**keys):
    return lambda content: content.update(robot=keys)


def obstacle(**keys):
    return lambda content: content["obstacles"].append({"id": "new", "position": [9, 9, 9], **keys})


def held(**keys):
    return lambda content: content.update(attached={"link": "hand", **keys})


NAN = float("nan")
BAD = [
    (changed(format="clearway-motion/2"), "format", ["`clearway-motion/2`", "`clearway-motion/1`"]),
    (changed(colour="red"), "colour", ["unknown key `colour`"]),
    (
        changed(start=[0.0, 0.0, 2.6, 0.0]),
        "start",
        ["elbow", "2.6", "-2.5 to 2.5", "out of limits"],
    ),
    (changed(start={"pan": 0.0}), "start", ["says nothing of joint `shoulder`"]),
    (changed(start={"pann": 0.0}), "start", ["`pann` is not planned for", "did you mean `pan`"]),
    (changed(start=[0.0, 0.0]), "start", ["2 values", "4", "`wrist`"]),
    (changed(start="home"), "start", ["a mapping from joint to number, or a list of numbers"]),
    (changed(start=[0.0, NAN, 0.0, 0.0]), "start", ["`shoulder` at NaN"]),
    (changed(start=[-0.6, 0.9, 0.4, 0.0]), "start", ["the start is in collision", "touches wall"]),
    (
        changed(start=[0.0, 0.0, 2.5, 0.0], goals=[[0, 0, 0, 0]], obstacles=[], margin=NAN),
        "margin",
        ["NaN"],
    ),
    (changed(goals=[]), "goals", ["no goals"]),
    (
        changed(goals=[[0.0, -9.0, 0.0, 0.0]]),
        "  - [0.0, -9.0",
        ["the goal", "shoulder", "-9", "-2.2 to 2.2"],
    ),
    (
        changed(goals=[[-0.6, 0.9, 0.4, 0.0]]),
        "  - [-0.6, 0.9",
        ["the goal is in collision", "touches wall"],
    ),
    (changed(margin=-0.1), "margin", ["-0.1"]),
    (changed(range=0.0), "range", ["the range is 0"]),
    (changed(checks_per_rad=0.1), "checks_per_rad", ["0.1"]),
    (changed(limits={"acceleration": -1}), "limits", ["the limit -1"]),
    (
        changed(limits={"acceleration": {"pan": 1}}),
        "acceleration",
        ["no limit for joint `shoulder`"],
    ),
    (
        changed(limits={"acceleration": {"pam": 1}}),
        "acceleration",
        ["`pam` is not planned for", "`pan`"],
    ),
    (changed(base={"position": [0, NAN, 0]}), "  position", ["NaN"]),
    (obstacle(), "new", ["obstacle `new` has no shape"]),
    (obstacle(sphere={"radius": NAN}), "new", ["radius", "NaN", "positive"]),
    (obstacle(box={"size": [1, 0, 1]}), "new", ["size", "positive"]),
    (obstacle(sphere={"radius": 1}, rpy=[0, NAN, 0]), "new", ["NaN"]),
    (
        obstacle(points={"file": "empty.xyz", "radius": 0.01}),
        "new",
        ["empty.xyz", "without points"],
    ),
    (obstacle(points={"file": "nan.xyz", "radius": 0.01}), "new", ["nan.xyz:1"]),
    (obstacle(mesh={"file": "none.stl"}), "new", ["none.stl", "no such file"]),
    (
        obstacle(id="wall", sphere={"radius": 1}),
        "position: [9",
        ["`wall` is taken by another obstacle"],
    ),
    (robot(srdf="arm.srdf"), "robot", ["no robot", "`urdf`"]),
    (robot(urdf="arm.urdf", model="ur10_ag95"), "  urdf", ["both `model` and `urdf`"]),
    (robot(model="ur10_ag95", joints=["pan"]), "  joints", ["both `model` and `joints`"]),
    (robot(model="ur11"), "  model", ["no built-in robot is called `ur11`"]),
    (robot(urdf="none.urdf"), "  urdf", ["none.urdf", "no such file"]),
    (robot(urdf="bare.urdf"), "  urdf", ["without a single collision shape"]),
    (robot(urdf="arm.urdf", joints=["pan", "elbo"]), "  urdf", ["no joint `elbo`", "`elbow`"]),
    (robot(urdf="arm.urdf", fixed={"pan": 9.0}), "  urdf", ["joint `pan` held at 9"]),
    (held(), "attached", ["`attached` has no shape"]),
    (
        held(link="hant", sphere={"radius": 0.1}),
        "  link",
        ["no link `hant`", "did you mean `hand`"],
    ),
    (held(sphere={"radius": 0.1}, touch_links=["no"]), "touch_links", ["no link `no`"]),
    (held(points={"file": "cloud.xyz", "radius": 0.1}), "points", ["unknown key `points`"]),
]


@pytest.mark.parametrize("number", range(len(BAD)))
def test_bad_input(clearway, tmp_path, number):
    spoil, at, words = BAD[number]
    (tmp_path / "empty.xyz").write_text("# nothing\n")
    (tmp_path / "nan.xyz").write_text("0 nan 0\n")
    bare = sphere_arm.urdf().replace("<collision>", "<visual>").replace("</collision>", "</visual>")
    (tmp_path / "bare.urdf").write_text(bare)
    content = problem()
    spoil(content)
    text = yaml_text(content).replace("NaN", ".nan")
    if "position: [9" in at:
        at = '"id": "wall", "position": [9'
    done = plan(clearway, tmp_path, text, "-o", tmp_path / "answer.json", seconds=SECONDS)
    assert done.code == BAD_INPUT, f"{done.code}: {done.out}{done.err}"
    assert not (tmp_path / "answer.json").exists() and done.out == ""
    for word in words:
        assert word in done.err, f"{word!r} is not in: {done.err}"
    line, named = line_of(text, at), done.lines_named("problem.yaml")
    assert set(range(line, line + 5)) & named, f"line {line} is not in: {done.err}"
