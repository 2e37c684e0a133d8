"""A user's own robot file, over any URDF with meshes, works like the built-in robots."""

import json
import re
from pathlib import Path

import pytest

import base_scene
import user_robots
from base_scene import box
from check_plan import check_file
from clearway_cli import BAD_INPUT, SOLVED, Clearway


def with_model(scene: Path, model: str) -> None:
    """Replaces `robot.model` in a scene file, YAML or JSON, that names a built-in robot."""
    text, count = re.subn(
        r'("?model"?\s*:\s*)"?[\w./-]+"?', rf'\g<1>"{model}"', scene.read_text(), count=1
    )
    assert count == 1, "the scene names no robot model"
    scene.write_text(text)


def solved_and_sound(clearway: Clearway, scene: Path) -> dict:
    """Plans the scene and lets both judges at it; returns the plan."""
    plan = scene.with_name("plan.json")
    clearway.solve(scene, plan, "--seed", 1, seconds=300)
    violations = check_file(plan)
    assert not violations, "\n".join(map(str, violations))
    done = clearway.run("verify", plan)
    assert done.code == SOLVED, done.out + done.err
    return json.loads(plan.read_text())


def assert_meshes_listed(plan: dict, count: int) -> None:
    """Every collision mesh of the URDF is named, with its file and hash (which we checked)."""
    stl = [entry for entry in plan["robot"]["meshes"] if entry["uri"].endswith(".stl")]
    assert len(stl) >= count
    assert all(len(entry["sha256"]) == 64 for entry in stl)


@pytest.mark.parametrize("build", [user_robots.official_ur10, user_robots.official_panda])
def test_the_robot_command_takes_packages(clearway, tmp_path, build):
    """`--package` in place of `packages:` in the file."""
    robot = build(tmp_path, packages=False)
    done = clearway.run("robot", robot)
    assert done.code == BAD_INPUT and user_robots.PACKAGE in done.err, done.err
    package = f"{user_robots.PACKAGE}={user_robots.package_folder()}"
    done = clearway.run("robot", robot, "--package", package)
    assert done.code == SOLVED, done.err
    joint = "elbow_joint" if build is user_robots.official_ur10 else "panda_joint4"
    assert joint in done.out + done.err


@pytest.mark.parametrize("build", [user_robots.official_ur10, user_robots.official_panda])
def test_the_robot_command_reads_packages_from_the_file(clearway, tmp_path, build):
    done = clearway.run("robot", build(tmp_path))
    assert done.code == SOLVED, done.err


@pytest.mark.parametrize("build", [user_robots.official_ur10, user_robots.official_panda])
def test_a_mesh_that_is_gone_is_an_error(clearway, tmp_path, build):
    robot = build(tmp_path)
    gone = sorted((tmp_path / "data").rglob("collision/*.stl"))[2]
    gone.unlink()
    done = clearway.run("robot", robot)
    assert done.code == BAD_INPUT and gone.name in done.err, done.err


def test_the_official_ur10_plans(clearway, tmp_path):
    user_robots.official_ur10(tmp_path)
    scene = tmp_path / "scene.yaml"
    done = clearway.run("generate", "shelf", "--objects", 12, "--seed", 1, "-o", scene)
    assert done.code == SOLVED, done.err
    with_model(scene, "robot.yaml")
    assert_meshes_listed(solved_and_sound(clearway, scene), 7)


def panda_scene() -> dict:
    """A low cabinet within the Panda's reach: floor at z = 0.25, opening at x = 0.42."""
    radius, height, floor = 0.03, 0.22, 0.25

    def can(name: str, x: float, y: float) -> dict:
        shape = {"radius": radius, "height": height}
        return {"id": name, "cylinder": shape, "position": [x, y, floor + height / 2]}

    return {
        "format": "clearway-scene/1",
        "name": "panda",
        "frame": "world",
        "robot": {"model": "robot.yaml", "base": {"position": [0.0, 0.0, 0.0]}},
        "fixtures": [
            box("floor", [0.38, 0.74, 0.02], [0.61, 0.0, 0.24]),
            box("left_wall", [0.38, 0.02, 0.5], [0.61, 0.36, 0.5]),
            box("right_wall", [0.38, 0.02, 0.5], [0.61, -0.36, 0.5]),
            box("back_wall", [0.02, 0.74, 0.5], [0.81, 0.0, 0.5]),
            box("ceiling", [0.38, 0.74, 0.02], [0.61, 0.0, 0.76]),
            box("table", [0.5, 0.4, 0.04], [0.1, -0.6, 0.18]),
        ],
        "objects": [
            can("near_left", 0.52, 0.11),
            can("near_middle", 0.51, 0.0),
            can("near_right", 0.52, -0.11),
            can("wanted", 0.62, 0.02),
            can("far_left", 0.62, 0.22),
        ],
        "target": "wanted",
        "place": [{"id": "tray", "size": [0.4, 0.3], "position": [0.1, -0.6, 0.2]}],
    }


def test_the_official_panda_plans(clearway, tmp_path):
    user_robots.official_panda(tmp_path)
    scene = base_scene.write(tmp_path, panda_scene())
    plan = solved_and_sound(clearway, scene)
    assert plan["removed"][-1] == "wanted"
    assert_meshes_listed(plan, 9)
    assert "panda_finger_joint1" in plan["steps"][0]["segments"][0]["gripper"]


def test_files_beside_the_plan_are_found_from_another_folder(clearway, tmp_path):
    """The plan may be written elsewhere: its meshes are relative to it."""
    robot_folder, elsewhere = tmp_path / "robot", tmp_path / "out" / "deep"
    robot_folder.mkdir()
    elsewhere.mkdir(parents=True)
    user_robots.official_panda(robot_folder)
    scene = base_scene.write(robot_folder, panda_scene())
    clearway.solve(scene, elsewhere / "plan.json", "--seed", 2, seconds=300)
    violations = check_file(elsewhere / "plan.json", fast=True)
    assert not violations, "\n".join(map(str, violations))
