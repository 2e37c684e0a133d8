"""A base that drives: plans for tables with a PR2 beside them, and what cannot be planned for."""

import json
import math
from pathlib import Path

import jsonschema
import pytest

from bad_input import refused
from check_plan import check_file
from clearway_cli import BAD_INPUT, IMPOSSIBLE, OUT_OF_BUDGET, SOLVED

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLE = REPOSITORY / "examples" / "pr2_table.yaml"
HALF = 0.568
"""Of the example's table, metres."""


@pytest.fixture(scope="module")
def example(clearway, tmp_path_factory) -> dict:
    """The plan for the example; with it the scene as JSON has it."""
    plan = tmp_path_factory.mktemp("mobile") / "plan.json"
    clearway.solve(EXAMPLE, plan, "--seed", 1)
    judge(clearway, plan)
    return json.loads(plan.read_text())


@pytest.fixture
def scene(example) -> dict:
    return json.loads(json.dumps(example["scene"]))


def judge(clearway, plan: Path, fast: bool = False) -> None:
    violations = check_file(plan, fast)
    assert not violations, "\n".join(map(str, violations))
    verified = clearway.run("verify", plan)
    assert verified.code == SOLVED, verified.out + verified.err


def written(folder: Path, scene: dict) -> Path:
    path = folder / "scene.json"
    path.write_text(json.dumps(scene))
    return path


def drives(plan: dict):
    """The segments in which the base moves, and what is held in them."""
    joints, base = plan["robot"]["joints"], plan["robot"]["base_joints"]
    columns = [joints.index(name) for name in base]
    for step in plan["steps"]:
        for segment in step["segments"]:
            rows = segment["positions"]
            if any(rows[0][c] != row[c] for row in rows for c in columns):
                yield columns, segment


def test_the_example_drives_and_removes_no_more_than_without(clearway, example, tmp_path):
    assert example["robot"]["base_joints"] == ["base_x", "base_y", "base_yaw"]
    assert example["robot"]["joints"][:3] == example["robot"]["base_joints"]
    moves = list(drives(example))
    assert moves, "it never drives"
    region = example["scene"]["robot"]["region"]
    at, turn = (example["scene"]["robot"]["base"][key] for key in ("position", "rpy"))
    for columns, segment in moves:
        assert segment["kind"] in ("transit", "transfer")
        for row in segment["positions"]:
            x, y, _ = (row[c] for c in columns)
            c, s = math.cos(turn[2]), math.sin(turn[2])
            place = (at[0] + c * x - s * y, at[1] + s * x + c * y)
            for value, low, high in zip(place, region["min"], region["max"], strict=True):
                assert low <= value <= high
            # The arm is still while the base drives.
            others = [v for i, v in enumerate(row) if i not in columns]
            first = [v for i, v in enumerate(segment["positions"][0]) if i not in columns]
            assert max(abs(a - b) for a, b in zip(others, first, strict=True)) < 1e-9
    explained = clearway.run("explain", written(tmp_path, example))
    assert explained.code == SOLVED and "The base moves" in explained.out, explained.out


@pytest.mark.parametrize("seed", (2, 3, 6))
def test_driving_never_removes_more(clearway, tmp_path, seed):
    table = tmp_path / "table.yaml"
    done = clearway.run("generate", "table", "--seed", seed, "-o", table)
    assert done.code == SOLVED, done.err
    clearway.solve(table, tmp_path / "drives.json", "--seed", 1)
    judge(clearway, tmp_path / "drives.json", fast=seed != 2)
    schema = json.loads(clearway.run("schema", "plan").out)
    plan = json.loads((tmp_path / "drives.json").read_text())
    jsonschema.validate(plan, schema)
    fixed = clearway.run("plan", table, "--fixed-base", "--seed", 1, "-o", tmp_path / "stands.json")
    stands = json.loads((tmp_path / "stands.json").read_text())
    assert fixed.code in (SOLVED, OUT_OF_BUDGET)
    if fixed.code == SOLVED:
        assert not list(drives(stands))
        assert len(plan["removed"]) <= len(stands["removed"])


def test_what_cannot_be_put_down_here_is_driven_elsewhere(clearway, tmp_path, scene):
    """The only place is a shelf by the wall, out of reach from anywhere near the table."""
    scene["place"] = [{"id": "shelf", "size": [0.9, 0.3], "position": [0.0, 1.95, 0.72]}]
    box = {"size": [0.9, 0.3, 0.03]}
    scene["fixtures"].append({"id": "shelf_board", "box": box, "position": [0.0, 1.95, 0.705]})
    scene["robot"]["region"] = {"min": [-3.0, -3.0], "max": [3.0, 3.0]}
    plan = tmp_path / "plan.json"
    clearway.solve(written(tmp_path, scene), plan, "--seed", 1, "--time-limit", 30)
    judge(clearway, plan, fast=True)
    content = json.loads(plan.read_text())
    carried = [segment for _, segment in drives(content) if segment.get("attached")]
    assert len(carried) >= len(content["removed"])
    assert all(s["kind"] == "transfer" for s in carried)


def test_weights_say_what_a_plan_costs(clearway, tmp_path, scene):
    """Where a move of the base costs more than all removals it stays, if it can."""
    scene["weights"] = {"removal": 1.0, "base_move": 1000.0, "second": 0.0}
    path = written(tmp_path, scene)
    clearway.solve(path, tmp_path / "plan.json", "--seed", 1)
    judge(clearway, tmp_path / "plan.json", fast=True)
    scene["weights"]["removal"] = -1.0
    done = clearway.run("plan", written(tmp_path, scene))
    assert done.code == BAD_INPUT and "weights" in done.err and "removal" in done.err


def test_without_a_free_side_each_is_told(clearway, tmp_path, scene):
    """A fence round the table, with the robot within it at one side."""
    for name, x, y, size in [
        ("fence_far", 0.75, 0.0, [0.05, 1.6, 0.6]),
        ("fence_left", 0.0, 0.75, [1.6, 0.05, 0.6]),
        ("fence_right", 0.0, -0.75, [1.6, 0.05, 0.6]),
        ("fence_near", -0.75, 0.0, [0.05, 1.6, 0.6]),
    ]:
        scene["fixtures"].append({"id": name, "box": {"size": size}, "position": [x, y, 0.3]})
    scene["robot"]["base"] = {"position": [-1.7, 0.0, 0.0], "rpy": [0.0, 0.0, 0.0]}
    scene["robot"]["region"] = {"min": [-3.0, -3.0], "max": [3.0, 3.0]}
    plan = tmp_path / "plan.json"
    done = clearway.run("plan", written(tmp_path, scene), "-o", plan, "--time-limit", 5)
    assert done.code in (IMPOSSIBLE, OUT_OF_BUDGET)
    sides = json.loads(plan.read_text())["why"]["sides"]
    assert len(sides) == 8
    assert all(side["free"] == 0 and side["tried"] > 0 for side in sides)
    named = {name for side in sides for name in side["blocked_by"]}
    assert {"fence_far", "fence_left", "fence_right", "fence_near"} & named, named
    assert any(name in done.err for name in named), done.err


# --- bad input ----------------------------------------------------------------------------------


def test_a_region_that_the_base_does_not_fit(clearway, tmp_path, scene):
    scene["robot"]["region"] = {"min": [-1.0, -0.3], "max": [-0.5, 0.1]}
    text = json.dumps(scene, indent=1)
    refused(clearway, tmp_path, text, "region", line=True)


def test_a_start_in_collision(clearway, tmp_path, scene):
    scene["robot"]["start"] = {"base_x": 0.35}
    text = json.dumps(scene, indent=1)
    refused(clearway, tmp_path, text, "in collision", "table", line=True)


def test_a_base_that_leans(clearway, tmp_path, scene):
    scene["robot"]["base"]["rpy"] = [0.2, 0.0, 0.0]
    text = json.dumps(scene, indent=1)
    refused(clearway, tmp_path, text, "leans", line=True)


def test_a_camera(clearway, tmp_path, scene):
    scene["camera"] = {"position": [-1.5, 0.0, 1.5], "look_at": [0.0, 0.0, 0.75], "fov": 1.0}
    text = json.dumps(scene, indent=1)
    refused(clearway, tmp_path, text, "drives", "camera", line=True)


def robot_file(folder: Path, old: str, new: str) -> Path:
    """The built-in robot's files, with one text replaced."""
    for name in ("robot.yaml", "pr2_left.urdf", "pr2_left.srdf"):
        text = (REPOSITORY / "robots" / "pr2_left" / name).read_text()
        (folder / name).write_text(text.replace(old, new))
    return folder / "robot.yaml"


def test_a_base_joint_named_twice(clearway, tmp_path):
    robot = robot_file(tmp_path, "[base_x, base_y, base_yaw]", "[base_x, base_x, base_yaw]")
    done = clearway.run("robot", robot)
    assert done.code == BAD_INPUT
    assert "base_x" in done.err and "different names" in done.err and "robot.yaml:" in done.err


def test_a_base_of_joints_out_of_place(clearway, tmp_path):
    """The URDF brings the joints itself, but x begins beside the root."""
    text = (REPOSITORY / "robots" / "pr2_left" / "pr2_left.urdf").read_text()
    root = "base_footprint"
    joints = f"""
      <link name="ground"/><link name="a"/><link name="b"/>
      <joint name="base_x" type="prismatic"><origin xyz="0.1 0 0"/><parent link="ground"/>
        <child link="a"/><axis xyz="1 0 0"/>
        <limit lower="-9" upper="9" velocity="0.5" effort="9"/></joint>
      <joint name="base_y" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="0 1 0"/>
        <limit lower="-9" upper="9" velocity="0.5" effort="9"/></joint>
      <joint name="base_yaw" type="continuous"><parent link="b"/><child link="{root}"/>
        <axis xyz="0 0 1"/><limit velocity="0.8" effort="9"/></joint>
    </robot>"""
    robot = robot_file(tmp_path, "\0", "\0")
    (tmp_path / "pr2_left.urdf").write_text(text.replace("</robot>", joints))
    done = clearway.run("robot", robot)
    assert done.code == BAD_INPUT
    assert "base_x" in done.err and "offset" in done.err
    straight = joints.replace("0.1 0 0", "0 0 0")
    (tmp_path / "pr2_left.urdf").write_text(text.replace("</robot>", straight))
    done = clearway.run("robot", robot)
    assert done.code == SOLVED, done.err


# --- anybody's arm ------------------------------------------------------------------------------


def test_any_arm_can_be_given_a_base(clearway, tmp_path):
    """The built-in UR10 on a base that drives: never more removals than with the base fixed."""
    robots = REPOSITORY / "robots" / "ur10_ag95"
    for name in ("ur10_ag95.urdf", "ur10_ag95.srdf"):
        (tmp_path / name).write_text((robots / name).read_text())
    mobile = "mobile: {planar: {joints: [bx, by, byaw], velocity: [0.5, 0.5, 0.8]}}"
    text = (robots / "robot.yaml").read_text()
    assert "mobile: none" in text
    (tmp_path / "robot.yaml").write_text(text.replace("mobile: none", mobile))
    shelf = (REPOSITORY / "examples" / "shelf.yaml").read_text()
    assert "model: ur10_ag95" in shelf and "id: pedestal" in shelf
    # What drives does not stand on a post.
    head, rest = shelf.split("- id: pedestal", 1)
    shelf = head + "objects:" + rest.split("objects:", 1)[1]
    scene = tmp_path / "scene.yaml"
    scene.write_text(shelf.replace("model: ur10_ag95", f"model: {tmp_path / 'robot.yaml'}"))
    removed = []
    for more in ([], ["--fixed-base"]):
        plan = tmp_path / f"plan{len(more)}.json"
        clearway.solve(scene, plan, "--seed", 1, *more)
        judge(clearway, plan, fast=True)
        content = json.loads(plan.read_text())
        assert content["robot"]["base_joints"] == ["bx", "by", "byaw"]
        removed.append(len(content["removed"]))
    assert removed[0] <= removed[1]
