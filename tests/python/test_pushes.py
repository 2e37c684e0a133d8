"""Objects pushed aside instead of picked: what the plan says of a push, what both judges and
MuJoCo make of it, when nothing is pushed and why, mass and friction in the scene."""

import json

import numpy as np
import pytest

import base_scene
import scenes
from bad_input import refused
from base_scene import box, cylinder, line_of, yaml_text
from clearway_cli import BAD_INPUT
from mujoco_player import play
from plan_checker import poses
from scenes import generated, judged

SEEDS = (2, 3, 5, 8)
"""Of shelves of 12 objects in which something can be pushed aside."""
FRICTION, DENSITY = 0.4, 500.0
"""Where the scene gives none."""


@pytest.fixture(scope="module")
def plans(clearway, tmp_path_factory):
    """By seed and option: where the plan is. Planned once."""
    folder, known = tmp_path_factory.mktemp("pushes"), {}

    def path(seed: int, option: str = ""):
        if (seed, option) not in known:
            scene = generated(clearway, folder, "shelf", 12, seed)
            known[seed, option] = folder / f"plan-{seed}{option}.json"
            clearway.solve(scene, known[seed, option], *([option] if option else []))
        return known[seed, option]

    return path


def read(path) -> dict:
    return json.loads(path.read_text())


def pushes(plan: dict) -> list[dict]:
    return [step for step in plan["steps"] if step["action"] == "push"]


def motion(plan: dict) -> float:
    """Seconds."""
    return sum(s["times"][-1] for step in plan["steps"] for s in step["segments"])


def object_of(plan: dict, name: str) -> dict:
    return next(keys for keys in plan["scene"]["objects"] if keys["id"] == name)


def why(plan: dict, name: str) -> str:
    """What the plan says about pushing an object."""
    return next(of["push"] for of in plan["why"]["objects"] if of["object"] == name)


# --- plans with pushes --------------------------------------------------------------------------


def check_segments(step: dict) -> None:
    kinds = [segment["kind"] for segment in step["segments"]]
    inner = [kind for kind in kinds if kind != "transit"]
    assert inner == ["approach", "push", "retreat"], kinds
    first = kinds.index("approach")
    assert kinds[first : first + 3] == inner, kinds
    assert all(segment["attached"] is None for segment in step["segments"])
    values = [np.ravel(list(segment["gripper"].values())) for segment in step["segments"]]
    assert np.ptp(np.concatenate(values)) == 0.0, "the hand moves its fingers"


def check_push(step: dict, keys: dict) -> None:
    """The step's `push` beside where its object (`keys`, of the scene) stood."""
    push, stood = step["push"], poses.from_keys(keys)
    placed = poses.from_keys(step["placed"])
    direction = np.array(push["direction"])
    assert np.linalg.norm(direction) == pytest.approx(1.0, abs=1e-6)
    assert direction[2] == pytest.approx(0.0, abs=1e-6)
    assert push["distance"] > 0.0 and push["free"] >= 0.0 and push["margin_of_error"] > 0.0
    expected = stood[:3, 3] + direction * push["distance"]
    assert np.allclose(placed[:3, 3], expected, atol=1e-6)
    assert np.allclose(placed[:3, :3], stood[:3, :3], atol=1e-6)
    tips_at = keys["cylinder"]["radius"] / keys["friction"]
    assert push["tips_at"] == pytest.approx(tips_at, abs=1e-6)
    assert 0.0 < push["height"] < push["tips_at"]


@pytest.mark.parametrize("seed", SEEDS)
def test_pushed_aside(clearway, plans, seed):
    """What the plan says is consistent, and the checker and `verify` pass it."""
    plan = judged(clearway, plans(seed, "--prefer-push"))
    assert pushes(plan), "nothing is pushed"
    for step in pushes(plan):
        check_segments(step)
        check_push(step, object_of(plan, step["object"]))
        assert step["object"] in plan["removed"]
        assert why(plan, step["object"]).startswith("pushed aside by ")
    assert all("push" not in s for s in plan["steps"] if s["action"] == "pick_place")


@pytest.mark.parametrize("seed", SEEDS)
def test_pushed_aside_in_mujoco(plans, seed):
    plan = read(plans(seed, "--prefer-push"))
    played = play(plan)
    assert played.as_planned and not played.faults(), played.faults()
    assert played.arm_force <= 1.0
    for step in pushes(plan):
        assert played.objects[step["object"]].error <= 0.010


def test_the_text_tells_of_a_push(clearway, plans, tmp_path):
    plan = read(plans(5, "--prefer-push"))
    (step,) = pushes(plan)
    scene = generated(clearway, tmp_path, "shelf", 12, 5)
    done = clearway.solve(scene, tmp_path / "plan.json", "--prefer-push")
    told = f"; pushed aside by {1000 * step['push']['distance']:.0f} mm"
    (line,) = [text for text in done.out.splitlines() if f" {step['object']}: " in text]
    assert told in line, done.out


def test_no_push_picks(clearway, plans):
    for seed in SEEDS:
        plan = judged(clearway, plans(seed, "--no-push"))
        assert not pushes(plan)
        assert all(step["action"] == "pick_place" for step in plan["steps"])


def test_by_default_what_takes_less_time(plans):
    """The same objects go; pushing where that is faster makes the motions shorter in sum."""
    chosen, picked = ([read(plans(seed, option)) for seed in SEEDS] for option in ("", "--no-push"))
    for one, other in zip(chosen, picked):
        assert set(one["removed"]) == set(other["removed"])
    assert any(pushes(plan) for plan in chosen)
    assert sum(map(motion, chosen)) <= sum(map(motion, picked)) + 1e-9


def test_one_seed_one_plan(clearway, tmp_path):
    scene, texts = generated(clearway, tmp_path, "shelf", 12, 8), []
    for name in ("first", "second"):
        path = tmp_path / f"{name}.json"
        options = ("--seed", 7, "--iterations", 20, "--prefer-push")
        clearway.solve(scene, path, *options)
        plan = read(path)
        assert pushes(plan)
        del plan["timing"]
        texts.append(json.dumps(plan))
    assert texts[0] == texts[1]


# --- options ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "options, words",
    [
        (["--no-push", "--prefer-push"], ["--no-push", "--prefer-push"]),
        (["--prefer-push", "--symbolic"], ["--prefer-push", "symbols", "pick"]),
    ],
    ids=["both", "symbolic"],
)
def test_options_that_do_not_go_together(clearway, tmp_path, options, words):
    scene = base_scene.write(tmp_path, base_scene.scene())
    done = clearway.run("plan", scene, "-o", tmp_path / "plan.json", *options)
    assert done.code == BAD_INPUT and not (tmp_path / "plan.json").exists()
    assert all(word in done.err for word in words), done.err


# --- what is not pushed, and why ----------------------------------------------------------------


def bay() -> dict:
    """A bay so narrow that what stands in front has to go, with room to push it aside."""
    scene = base_scene.scene()
    for fixture, y in zip(scene["fixtures"][1:3], (0.14, -0.14)):
        fixture["position"][1] = y
    scene["objects"] = [cylinder("front", 0.75, 0.0), cylinder("wanted", 0.92, 0.0)]
    return scene


def kerbs(x: float, gap: float, high: float) -> list[dict]:
    """Low kerbs on all four sides of a cylinder at (x, 0), which can only be lifted over them."""
    near, wide, z = base_scene.RADIUS + gap, 0.01, base_scene.FLOOR + high / 2
    sides = {"left": (0, 1), "right": (0, -1), "front": (-1, 0), "back": (1, 0)}
    return [
        box(
            f"kerb_{name}",
            [wide if dx else 2 * near, wide if dy else 2 * near, high],
            [x + dx * (near + wide / 2), dy * (near + wide / 2), z],
        )
        for name, (dx, dy) in sides.items()
    ]


def walled_in(scene: dict) -> None:
    scene["fixtures"] += kerbs(0.75, gap=0.002, high=0.0095)


def walled_in_low(scene: dict) -> None:
    """Kerbs of 6 mm hold the object back as well as higher ones."""
    scene["fixtures"] += kerbs(0.75, gap=0.002, high=0.006)


def rough(scene: dict) -> None:
    scene["objects"][0]["friction"] = 2.0


def all_rough(scene: dict) -> None:
    scene["friction"] = 2.0


def rectangular(scene: dict) -> None:
    front = scene["objects"][0]
    del front["cylinder"]
    front["box"] = {"size": [0.07, 0.07, base_scene.HEIGHT]}


def test_there_is_room_in_the_bay(clearway, tmp_path):
    scene = base_scene.write(tmp_path, bay())
    clearway.solve(scene, tmp_path / "plan.json", "--prefer-push")
    plan = judged(clearway, tmp_path / "plan.json")
    assert [step["object"] for step in pushes(plan)] == ["front"]
    played = play(plan)
    assert played.as_planned and not played.faults(), played.faults()


@pytest.mark.parametrize("options", [[], ["--prefer-push"]], ids=["default", "prefer"])
@pytest.mark.parametrize(
    "change, reason",
    [
        (walled_in, "there is no room to push it"),
        (walled_in_low, "there is no room to push it"),
        (rough, "it would tip"),
        (all_rough, "it would tip"),
        (rectangular, "it is no upright cylinder"),
    ],
    ids=["no-room", "low-kerbs", "rough", "all-rough", "box"],
)
def test_picked_and_why(clearway, tmp_path, change, reason, options):
    """The same bay, changed: solved by picks; the text and the plan say why."""
    scene = bay()
    change(scene)
    path = tmp_path / "plan.json"
    done = clearway.solve(base_scene.write(tmp_path, scene), path, *options)
    plan = judged(clearway, path)
    assert plan["removed"] == ["front", "wanted"] and not pushes(plan)
    (line,) = [text for text in done.out.splitlines() if " front: " in text]
    said, told = line.partition("; picked: ")[2], why(plan, "front")
    assert said and told == f"picked: {said}"
    assert reason in said, said


def test_boxes_are_never_pushed(clearway, tmp_path):
    """Every cylinder of generated shelves made a box within it."""
    for seed in SEEDS[:2]:
        path = generated(clearway, tmp_path, "shelf", 12, seed)
        scene = scenes.read(path)
        for keys in scene["objects"]:
            shape = keys.pop("cylinder")
            side = 1.4 * shape["radius"]
            keys["box"] = {"size": [side, side, shape["height"]]}
        path.write_text(yaml_text(scene))
        clearway.solve(path, tmp_path / "plan.json", "--prefer-push")
        assert not pushes(judged(clearway, tmp_path / "plan.json"))


# --- mass and friction --------------------------------------------------------------------------


def test_what_is_left_out_is_filled_in(clearway, plans):
    plan = read(plans(2))
    assert plan["scene"]["friction"] == FRICTION
    for keys in plan["scene"]["objects"]:
        shape = keys["cylinder"]
        mass = DENSITY * np.pi * shape["radius"] ** 2 * shape["height"]
        assert keys["friction"] == FRICTION
        assert keys["mass"] == pytest.approx(mass, abs=1.01e-4)


def test_what_is_given_is_kept(clearway, tmp_path):
    """An object's own friction goes before the scene's."""
    scene = bay()
    scene["friction"] = 0.3
    scene["objects"][1].update(friction=0.7, mass=1.25)
    clearway.solve(base_scene.write(tmp_path, scene), tmp_path / "plan.json")
    front, wanted = read(tmp_path / "plan.json")["scene"]["objects"]
    assert front["friction"] == 0.3
    assert wanted["friction"] == 0.7 and wanted["mass"] == 1.25


BAD = ["-1", "0", "1e9", ".nan", ".inf"]


@pytest.mark.parametrize("value", BAD)
@pytest.mark.parametrize("key", ["friction", "mass"])
def test_bad_numbers(clearway, tmp_path, key, value):
    scene = base_scene.scene()
    scene["objects"][1][key] = "NUMBER"
    text = yaml_text(scene).replace('"NUMBER"', value)
    line = line_of(text, "near_middle")
    words = (key, "near_middle", "expected", "help:", "leave the key out")
    done = refused(clearway, tmp_path, text, *words, line=line)
    column = text.splitlines()[line - 1].index(f'"{key}"') + len(key) + 5
    assert f"scene.yaml:{line}:{column}" in done.err, done.err


@pytest.mark.parametrize("value", ["-1", ".nan", "9"])
def test_bad_friction_of_the_scene(clearway, tmp_path, value):
    text = f"friction: {value}\n{yaml_text(base_scene.scene())}"
    refused(clearway, tmp_path, text, "scene.yaml:1:11", "friction", "leave the key out", line=1)


@pytest.mark.parametrize("key", ["friction", "mass"])
def test_fixtures_have_none(clearway, tmp_path, key):
    scene = base_scene.scene()
    scene["fixtures"][1][key] = 0.5
    text = yaml_text(scene)
    words = (key, "left_wall", "only objects", "delete the key")
    refused(clearway, tmp_path, text, *words, line=line_of(text, "left_wall"))
