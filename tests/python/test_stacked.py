"""Things on top of each other: generated scenes, what stands and what falls by MuJoCo, and plans
with and without symbols. Fig. 10 of the paper: the one on top goes first, then one of the two below
it, then the target."""

import copy
import importlib.util
import json
import os
from pathlib import Path

import pytest

import physics
import stacks
from bad_input import refused
from check_plan import check_plan
from clearway_cli import BAD_INPUT, SOLVED, VIOLATIONS
from scenes import figure, generated, judged, read, standing, supports

MODES = {
    "native": [],
    "symbolic": ["--symbolic"],
    "all movable": ["--symbolic", "--all-movable"],
    "incremental": ["--symbolic", "--algorithm", "incremental"],
}


# --- scenes -------------------------------------------------------------------------------------


@pytest.mark.parametrize("objects", [1, 2, 3, 4, 5, 6, 7, 8, 12, 20])
def test_generated_scenes(clearway, tmp_path, objects):
    for seed in (1, 2):
        path = generated(clearway, tmp_path, "stacked", objects, seed)
        again = clearway.run("generate", "stacked", "--objects", objects, "--seed", seed)
        assert again.code == SOLVED and again.out == path.read_text()
        scene = read(path)
        assert len(scene["objects"]) == objects
        above = {n: under for n, under in supports(standing(scene)).items() if under}
        if objects >= 4:
            top, below = figure(scene)
            assert len(below) == 2 and scene["target"] not in {top, *below}
        else:
            assert len(above) == (objects == 3), above
        assert not physics.fallen(scene)
    assert generated(clearway, tmp_path, "stacked", objects, 1).read_text() != path.read_text()


def test_an_unstable_stack_is_refused_and_falls(clearway, tmp_path):
    """The one on top is drawn forth until its middle is over nothing."""
    scene = read(generated(clearway, tmp_path, "stacked", 4, 1))
    top, _ = figure(scene)
    keys = next(k for k in scene["objects"] if k["id"] == top)
    keys["position"][0] -= 0.046
    assert supports(standing(scene))[top], "it still touches what is below it"
    text = json.dumps(scene, indent=1)
    refused(clearway, tmp_path, text, top, "not stable", line=True)
    assert physics.fallen(scene) == {top}


def test_random_stacks(clearway, tmp_path):
    """The scene's reader, `verify`, the checker's balance of forces and MuJoCo agree."""
    scene = read(generated(clearway, tmp_path, "stacked", 1, 1))
    scene["fixtures"].append(stacks.SLAB)
    path, plan_path = tmp_path / "scene.json", tmp_path / "plan.json"
    path.write_text(json.dumps(scene))
    clearway.solve(path, plan_path)
    plan = json.loads(plan_path.read_text())
    plan["lower_bound"] = None
    for objects, stands in stacks.clear_stacks(seed=1, count=5):
        told = json.dumps(objects)
        alone = {"fixtures": [stacks.SLAB], "objects": objects}
        assert bool(physics.fallen(alone, friction=0.3)) != stands, f"MuJoCo: {told}"
        path.write_text(json.dumps({**scene, "objects": scene["objects"] + objects}))
        done = clearway.run("plan", path, "--time-limit", 10, "-o", tmp_path / "other.json")
        assert done.code == (SOLVED if stands else BAD_INPUT), f"{done.err}\n{told}"
        spoilt = copy.deepcopy(plan)
        spoilt["scene"]["objects"] += objects
        plan_path.write_text(json.dumps(spoilt))
        done = clearway.run("verify", plan_path)
        assert done.code == (SOLVED if stands else VIOLATIONS), f"{done.out}\n{told}"


# --- plans --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", (1, 2, 3))
@pytest.mark.parametrize("objects", [4, 8, 12, 20])
def test_the_optimum_of_the_paper(clearway, tmp_path, objects, seed):
    """Whatever the mode: in all of them for the first seed, in two for the others."""
    path = generated(clearway, tmp_path, "stacked", objects, seed)
    scene = read(path)
    top, below = figure(scene)
    for mode, options in list(MODES.items())[: 4 if seed == 1 else 2]:
        plan_path = tmp_path / f"{mode}.json"
        clearway.solve(path, plan_path, "--time-limit", 30, *options)
        plan = judged(clearway, plan_path, fast=(objects, seed) != (8, 1))
        first, second, third = plan["removed"]
        assert first == top and second in below and third == scene["target"], mode
        assert [step["object"] for step in plan["steps"]] == plan["removed"], mode


def test_both_judges_see_what_is_lifted_from_under_a_load(clearway, tmp_path):
    """The plan without its first step, in which the one on top goes."""
    path = generated(clearway, tmp_path, "stacked", 4, 2)
    clearway.solve(path, tmp_path / "plan.json", "--symbolic")
    plan = json.loads((tmp_path / "plan.json").read_text())
    del plan["steps"][0], plan["removed"][0]
    assert "unstable" in {violation.rule for violation in check_plan(plan, tmp_path, fast=True)}
    (tmp_path / "plan.json").write_text(json.dumps(plan))
    done = clearway.run("verify", tmp_path / "plan.json")
    assert done.code == VIOLATIONS and "unstable" in done.out, done.out


def fast_downward() -> Path:
    """The driver in the wheel, which is not imported: that would need all of `unified-planning`."""
    wheel = importlib.util.find_spec("up_fast_downward")
    return Path(wheel.submodule_search_locations[0]) / "downward" / "fast-downward.py"


@pytest.mark.parametrize("objects", [4, 8])
def test_fast_downward_finds_the_same(clearway, tmp_path, objects):
    path = generated(clearway, tmp_path, "stacked", objects, 1)
    driver = fast_downward()
    removed = []
    for name, options in (("own", []), ("other", ["--fast-downward", driver])):
        plan_path = tmp_path / f"{name}.json"
        clearway.solve(path, plan_path, "--symbolic", *options)
        removed.append(judged(clearway, plan_path)["removed"])
    assert removed[0] == removed[1]


def test_the_driver_may_be_named_from_here(clearway, tmp_path):
    path = generated(clearway, tmp_path, "stacked", 4, 1)
    driver = os.path.relpath(fast_downward())
    clearway.solve(path, tmp_path / "plan.json", "--symbolic", "--fast-downward", driver)


@pytest.mark.parametrize(
    "options", [*MODES.values(), ["--goal", "(and (On o1 tray) (On o2 tray))"]],
    ids=[*MODES, "goal"],
)  # fmt: skip
def test_one_seed_one_plan(clearway, tmp_path, options):
    path = generated(clearway, tmp_path, "stacked", 8, 3)
    plans = []
    for name in ("first", "second"):
        plan_path = tmp_path / f"{name}.json"
        clearway.solve(path, plan_path, "--seed", 7, "--iterations", 50, *options)
        plan = json.loads(plan_path.read_text())
        del plan["timing"]
        plans.append(json.dumps(plan))
    assert plans[0] == plans[1]
