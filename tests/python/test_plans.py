"""What the program plans passes a checker that shares nothing with it."""

import copy
import json
from pathlib import Path

import jsonschema
import pytest

import base_scene
from check_plan import check_file, check_plan
from clearway_cli import OUT_OF_BUDGET, SOLVED, VIOLATIONS, Clearway

SIZES, SEEDS = (12, 16, 20), (1, 2, 3)


def generated(clearway: Clearway, folder: Path, objects: int, seed: int) -> Path:
    scene = folder / f"shelf-{objects}-{seed}.yaml"
    done = clearway.run("generate", "shelf", "--objects", objects, "--seed", seed, "-o", scene)
    assert done.code == SOLVED and scene.is_file(), done.err
    return scene


@pytest.fixture(scope="module")
def schema(clearway) -> dict:
    done = clearway.run("schema", "plan")
    assert done.code == SOLVED, done.err
    return json.loads(done.out)


@pytest.fixture(scope="module")
def solved(clearway, tmp_path_factory) -> Path:
    """One plan of the base scene, for tests that spoil it."""
    folder = tmp_path_factory.mktemp("base")
    clearway.solve(base_scene.write(folder, base_scene.scene()), folder / "plan.json", "--seed", 1)
    return folder / "plan.json"


def judge(clearway: Clearway, plan: Path, schema: dict, fast: bool = False) -> None:
    """All three judges: ours, the program's own verifier, the schema."""
    violations = check_file(plan, fast)
    assert not violations, "\n".join(map(str, violations))
    verified = clearway.run("verify", plan)
    assert verified.code == SOLVED, verified.out + verified.err
    jsonschema.validate(json.loads(plan.read_text()), schema)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("objects", SIZES)
def test_generated_shelves(clearway, schema, tmp_path, objects, seed):
    plan = tmp_path / "plan.json"
    scene = generated(clearway, tmp_path, objects, seed)
    done = clearway.solve(scene, plan, "--seed", 1, "--json")
    assert isinstance(json.loads(done.out), dict)
    judge(clearway, plan, schema)


def test_the_base_scene(clearway, schema, solved):
    judge(clearway, solved, schema)


def test_a_scene_written_as_json_is_the_same(clearway, schema, tmp_path, solved):
    scene = tmp_path / "scene.json"
    scene.write_text(json.dumps(base_scene.scene()))
    clearway.solve(scene, tmp_path / "plan.json", "--seed", 1)
    judge(clearway, tmp_path / "plan.json", schema, fast=True)


def test_the_program_may_start_elsewhere(clearway, schema, tmp_path):
    scene = base_scene.scene()
    scene["robot"]["start"] = {"shoulder_pan_joint": -0.5}
    plan = tmp_path / "plan.json"
    clearway.solve(base_scene.write(tmp_path, scene), plan, "--seed", 1)
    judge(clearway, plan, schema, fast=True)


# --- the same seed, the same plan ---------------------------------------------------------------


def without_timing(plan: Path) -> dict:
    content = json.loads(plan.read_text())
    del content["timing"]
    return content


def within_iterations(clearway: Clearway, scene: Path, plan: Path, *more) -> dict:
    """20 iterations, no time limit: the answer depends on the seed alone."""
    done = clearway.run(
        "plan", scene, "--seed", 7, "--iterations", 20, "-o", plan, *more, seconds=300
    )
    assert done.code in (SOLVED, OUT_OF_BUDGET), done.err
    return without_timing(plan)


@pytest.mark.parametrize("objects", [12, 20])
def test_one_seed_one_plan(clearway, tmp_path, objects):
    scene = generated(clearway, tmp_path, objects, 4)
    first = within_iterations(clearway, scene, tmp_path / "first.json")
    second = within_iterations(clearway, scene, tmp_path / "second.json")
    assert first == second


@pytest.mark.parametrize("objects", [12, 20])
def test_threads_change_nothing(clearway, tmp_path, objects):
    scene = generated(clearway, tmp_path, objects, 5)
    one = within_iterations(clearway, scene, tmp_path / "one.json", "--threads", 1)
    two = within_iterations(clearway, scene, tmp_path / "two.json", "--threads", 2)
    assert one == two


def test_one_seed_one_scene(clearway, tmp_path):
    texts = []
    for name in ("a", "b"):
        folder = tmp_path / name
        folder.mkdir()
        texts.append(generated(clearway, folder, 12, 9).read_bytes())
    assert texts[0] == texts[1]


# --- both judges see a spoilt plan --------------------------------------------------------------


def attached_segments(plan: dict) -> list[dict]:
    return [s for step in plan["steps"] for s in step["segments"] if s["attached"]]


def reversed_removed(plan):
    plan["removed"] = plan["removed"][::-1] + ["nobody"]


def twice_as_fast(plan):
    for step in plan["steps"]:
        for segment in step["segments"]:
            segment["times"] = [t / 2 for t in segment["times"]]


def wall_across_the_opening(plan):
    plan["scene"]["fixtures"].append(base_scene.box("curtain", [0.01, 0.9, 0.4], [0.66, 0.0, 0.85]))


def held_askew(plan):
    for segment in attached_segments(plan):
        segment["attached"]["pose_in_tool"]["position"][2] += 0.004


def put_beside(plan):
    plan["steps"][0]["placed"]["position"][0] += 0.02


def a_row_jumps(plan):
    segment = max(
        (s for step in plan["steps"] for s in step["segments"]), key=lambda s: len(s["times"])
    )
    segment["positions"][len(segment["positions"]) // 2][0] += 0.3


def starts_elsewhere(plan):
    plan["robot"]["home"] = {name: value + 0.1 for name, value in plan["robot"]["home"].items()}
    plan["scene"]["robot"].pop("start", None)


def everything_unchecked(plan):
    links = ["base_link", "forearm_link", "wrist_1_link", "gripper_base_link"]
    plan["robot"]["unchecked_pairs"] += [[a, b] for a in links for b in links if a < b]


SPOILT = [
    reversed_removed,
    twice_as_fast,
    wall_across_the_opening,
    held_askew,
    put_beside,
    a_row_jumps,
    starts_elsewhere,
    everything_unchecked,
]


@pytest.mark.parametrize("spoil", SPOILT, ids=lambda spoil: spoil.__name__)
def test_both_judges_see_a_spoilt_plan(clearway, solved, tmp_path, spoil):
    plan = copy.deepcopy(json.loads(solved.read_text()))
    spoil(plan)
    assert check_plan(plan, solved.parent, fast=True), "our checker sees nothing"
    path = tmp_path / "spoilt.json"
    path.write_text(json.dumps(plan))
    done = clearway.run("verify", path)
    assert done.code == VIOLATIONS, f"verify: exit code {done.code}\n{done.out}{done.err}"
    assert done.out.strip() or done.err.strip()


def test_verify_ignores_unknown_keys(clearway, solved, tmp_path):
    plan = json.loads(solved.read_text())
    plan["news"] = plan["robot"]["news"] = plan["steps"][0]["segments"][0]["news"] = 1
    path = tmp_path / "newer.json"
    path.write_text(json.dumps(plan))
    done = clearway.run("verify", path)
    assert done.code == SOLVED, done.out + done.err
