"""What plans come to in MuJoCo (`mujoco_player`), and whether the player itself can be believed."""

import copy
import json

from pathlib import Path

import mujoco
import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import mini_plan
import scenes
from clearway_cli import SOLVED
from mujoco_player import Unplayable, play, settings
from mujoco_player.measure import summary
from mujoco_player.world import World

GRAVITY = 9.81


def gantry_plan() -> dict:
    """The small hand-made plan, of a gantry with motors strong enough to follow it."""
    plan = mini_plan.plan()
    plan["robot"]["urdf"] = mini_plan.URDF.replace('effort="1"', 'effort="500"')
    return plan


def alone(friction: float = 0.4, height: float = 0.0) -> tuple[World, int]:
    """A world with the gantry out of the way, and cylinder a `height` above the table; its body."""
    plan = gantry_plan()
    plan["scene"]["objects"] = plan["scene"]["objects"][:1]
    plan["scene"]["objects"][0].update(friction=friction, position=[0.3, 0.0, 0.06 + height])
    world = World(plan)
    world.set_robot([-0.5, 0.5, -0.2], [0.0])
    world.forward()
    return world, world.body_of["object/a"]


def run(world: World, seconds: float) -> None:
    for _ in range(round(seconds / settings.STEP)):
        mujoco.mj_step(world.model, world.data)


# --- the physics of it, by closed forms ---------------------------------------------------------


def test_free_fall():
    world, _ = alone(height=1.0)
    run(world, 0.3)
    fallen = 1.06 - world.object_pose("a")[2, 3]
    assert fallen == pytest.approx(GRAVITY * 0.3**2 / 2, rel=0.01)


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.4])
def test_what_slides_stops_where_friction_stops_it(friction):
    world, _ = alone(friction)
    speed = 0.5
    world.data.qvel[world.model.joint("object/a").dofadr[0]] = speed
    run(world, 1.0)
    slid = world.object_pose("a")[0, 3] - 0.3
    assert slid == pytest.approx(speed**2 / (2 * friction * GRAVITY), rel=0.05)


@pytest.mark.parametrize("height, tips", [(0.06, False), (0.09, True)])
def test_what_is_pushed_above_radius_by_friction_tips(height, tips):
    """Radius 0.03 and friction 0.4: 0.075 above the table."""
    world, body = alone(0.4)
    run(world, 0.1)
    push = 1.05 * 0.4 * GRAVITY * world.model.body_mass[body]
    for _ in range(round(0.4 / settings.STEP)):
        lever = height - 0.06
        world.data.xfrc_applied[body] = [push, 0, 0, 0, push * lever, 0]
        mujoco.mj_step(world.model, world.data)
    tilt = np.degrees(np.arccos(min(1.0, world.object_pose("a")[2, 2])))
    assert (tilt > 10) == tips and (tips or tilt < 0.5), f"{tilt:.2f} degrees"


def test_mass_and_friction_are_the_plan_s():
    plan = gantry_plan()
    plan["scene"]["objects"][0].update(mass=1.7, friction=0.9)
    model = World(plan).model
    assert model.body("object/a").mass[0] == pytest.approx(1.7)
    assert model.body("object/b").mass[0] == pytest.approx(500 * np.pi * 0.03**2 * 0.12)
    frictions = [model.geom_friction[model.body(f"object/{name}").geomadr[0], 0] for name in "ab"]
    assert frictions == pytest.approx([0.9, 0.4])


# --- a hand-made plan, and what spoils it -------------------------------------------------------


def test_a_plan_made_by_hand():
    played = play(gantry_plan())
    assert played.as_planned and not played.faults(), played.faults()
    assert played.arm_force == 0.0 and played.tracking < 1e-3
    assert [(step.object, step.slip < 2e-3) for step in played.steps] == [("a", True), ("b", True)]


def test_an_object_moved_aside():
    played = play(gantry_plan(), shifted={"b": (0.0, 0.03)})
    assert not played.as_planned
    assert played.objects["a"].as_planned and not played.objects["b"].as_planned


def test_an_object_that_nobody_moves_moved_aside():
    plan = gantry_plan()
    idle = copy.deepcopy(plan["scene"]["objects"][0])
    idle.update(id="c", position=[0.5, 0.2, 0.06])
    plan["scene"]["objects"].append(idle)
    assert play(plan).as_planned
    played = play(plan, shifted={"c": (0.006, 0.0)})
    assert played.objects["c"].error == pytest.approx(0.006, abs=2e-4) and not played.as_planned


def test_a_hand_that_never_closes():
    plan = gantry_plan()
    for step in plan["steps"]:
        for segment in step["segments"]:
            segment["gripper"] = {"finger_joint": mini_plan.OPEN}
    played = play(plan)
    far = {"a": np.hypot(0.05, 0.4), "b": 0.4}
    for name, ended in played.objects.items():
        assert ended.error == pytest.approx(far[name], abs=2e-3) and not ended.fell
    assert not played.as_planned and played.steps[0].error > 0.3


def test_what_is_too_heavy_for_the_grip_stays_behind():
    plan = gantry_plan()
    plan["scene"]["objects"][1]["mass"] = 3.0 * 2 * settings.GRIP * settings.PADS / GRAVITY
    played = play(plan)
    assert played.objects["a"].as_planned and not played.objects["b"].as_planned


def test_a_fixture_in_the_way_of_the_arm():
    plan = gantry_plan()
    post = {"id": "post", "box": {"size": [0.04, 0.04, 0.3]}, "position": [-0.1, 0.0, 0.4]}
    plan["scene"]["fixtures"].append(post)
    played = play(plan)
    assert played.arm_force > 10.0
    hardest = next(contact for contact in played.contacts if contact.of_arm)
    names = {hardest.one, hardest.other}
    assert "fixture/post" in names and any(name.startswith("link/") for name in names)
    assert any("fixture/post" in line for line in played.faults())


def test_an_object_in_the_way_of_what_is_carried():
    plan = gantry_plan()
    tall = {"id": "tall", "cylinder": {"radius": 0.03, "height": 0.32}, "position": [0, 0.2, 0.16]}
    plan["scene"]["objects"].append(tall)
    played = play(plan)
    assert played.objects["tall"].fell and not played.as_planned
    met = {frozenset((contact.one, contact.other)) for contact in played.contacts}
    assert frozenset(("object/a", "object/tall")) in met


def test_a_push():
    """The open hand's left finger pushes cylinder b 5 cm along the table."""
    plan = gantry_plan()
    over, low, pushed = [0.08, 0.0, -0.6], [0.08, 0.0, -0.83], [0.18, 0.0, -0.83]
    ways = [
        ("transit", mini_plan.HOME, over),
        ("approach", over, low),
        ("push", low, pushed),
        ("retreat", pushed, low),
        ("transit", low, over),
    ]
    segments = [mini_plan.segment(kind, a, b, mini_plan.OPEN) for kind, a, b in ways]
    # The finger's far side is at 0.06 from the hand's middle, b's middle 0.03 further.
    placed = {"position": [0.27, 0.0, 0.06], "quaternion": [0.0, 0.0, 0.0, 1.0]}
    push = {"object": "b", "action": "push", "segments": segments, "placed": placed}
    plan["scene"]["objects"][0]["position"] = [-0.3, 0.3, 0.06]
    plan["steps"] = [push]
    played = play(plan)
    assert played.as_planned and not played.faults(), played.faults()
    (step,) = played.steps
    assert step.action == "push" and step.error < 3e-3 and step.slip is None
    placed["position"][0] += 0.02
    assert not play(plan).as_planned


def test_what_the_player_does_not_know():
    plan = gantry_plan()
    plan["scene"]["fixtures"].append({"id": "cloud", "points": {"file": "a.ply", "radius": 0.01}})
    with pytest.raises(Unplayable, match="cloud"):
        play(plan)
    plan = gantry_plan()
    del plan["robot"]["fixed"]["lamp_joint"]
    with pytest.raises(Unplayable, match="lamp_joint"):
        play(plan)


# --- generated plans ----------------------------------------------------------------------------


def planned(clearway, folder, kind: str, seed: int, *more) -> dict:
    scene, path = folder / "scene.yaml", folder / "plan.json"
    made = clearway.run("generate", kind, "--seed", seed, *more, "-o", scene)
    assert made.code == SOLVED, made.err
    clearway.solve(scene, path, "--seed", seed)
    return json.loads(path.read_text())


@pytest.mark.parametrize(
    "kind, seed, more",
    [
        ("shelf", 1, ("--objects", 12)),
        ("shelf", 2, ("--objects", 12)),
        ("stacked", 1, ()),
        ("occluded", 1, ("--objects", 8)),
    ],
    ids=["shelf-1", "shelf-2", "stacked", "suction"],
)
def test_generated_plans(clearway, tmp_path, kind, seed, more):
    plan = planned(clearway, tmp_path, kind, seed, *more)
    played = play(plan)
    assert played.as_planned and not played.faults(), played.faults()
    assert played.arm_force <= 1.0 and played.tracking < 1e-3
    assert summary(plan, played)["target"]


EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("name", ["blocked", "bottle_shelf", "fridge", "table"])
def test_examples(clearway, tmp_path, name):
    """Boxes among them that are turned, cartons that are held near their front, a hand whose fingers swing."""
    path = tmp_path / "plan.json"
    clearway.solve(EXAMPLES / f"{name}.yaml", path)
    played = play(json.loads(path.read_text()))
    assert played.as_planned and not played.faults(), played.faults()
    done = clearway.run("simulate", path)
    assert done.code == SOLVED, done.out


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_turned_boxes_are_held_by_their_sides(clearway, tmp_path, seed):
    """A generated shelf, every cylinder a box within it, each turned otherwise."""
    scene, path = tmp_path / "scene.yaml", tmp_path / "plan.json"
    made = clearway.run("generate", "shelf", "--objects", 8, "--seed", seed, "-o", scene)
    assert made.code == SOLVED, made.err
    keys = scenes.read(scene)
    for turn, body in enumerate(keys["objects"]):
        shape = body.pop("cylinder")
        side = 1.4 * shape["radius"]
        body.update(box={"size": [side, side, shape["height"]]}, rpy=[0, 0, 0.37 * turn])
    scene.write_text(yaml.safe_dump(keys))
    clearway.solve(scene, path)
    plan = json.loads(path.read_text())
    played = play(plan)
    assert played.as_planned and not played.faults(), played.faults()
    for step in plan["steps"]:
        grasped = next(part["attached"] for part in step["segments"] if part.get("attached"))["pose_in_tool"]
        forward = Rotation.from_quat(grasped["quaternion"]).inv().apply([0, 0, 1])
        assert np.abs(forward[:2]).max() == pytest.approx(1, abs=1e-3), (step["object"], forward)


def test_noise_is_drawn_from_the_seed():
    plan = gantry_plan()
    idle = copy.deepcopy(plan["scene"]["objects"][0])
    idle.update(id="c", position=[0.5, 0.2, 0.06])
    plan["scene"]["objects"].append(idle)
    plan["steps"] = plan["steps"][:1]
    ends = [play(plan, seed=seed, noise=0.004).objects["c"] for seed in (1, 1, 2)]
    assert ends[0].position == ends[1].position != ends[2].position
    far = [np.hypot(end.position[0] - 0.5, end.position[1] - 0.2) for end in ends]
    assert all(1e-6 < value <= 0.0042 for value in far) and all(end.as_planned for end in ends)
