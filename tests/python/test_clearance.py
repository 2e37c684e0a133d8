"""The room that a scene asks its motions to keep: what plans say they keep, what both judges and
MuJoCo make of it, and what cannot be asked."""

import json

import pytest

import base_scene
from bad_input import refused
from base_scene import box, line_of, yaml_text
from check_plan import check_plan
from clearway_cli import SOLVED, VIOLATIONS
from mujoco_player import play
from plan_checker import tolerances
from scenes import generated, judged

ASKED = 0.005
SEEDS = (2, 3, 5)
"""Of shelves of 12 objects."""


@pytest.fixture(scope="module")
def plans(clearway, tmp_path_factory):
    """By seed and clearance (None: not in the scene): where the plan is. Planned once."""
    folder, known = tmp_path_factory.mktemp("clearance"), {}

    def path(seed: int, asked: float | None = ASKED):
        if (seed, asked) not in known:
            scene = generated(clearway, folder, "shelf", 12, seed)
            if asked is not None:
                scene.write_text(f"{scene.read_text()}clearance: {asked}\n")
            known[seed, asked] = folder / f"plan-{seed}-{asked}.json"
            clearway.solve(scene, known[seed, asked])
        return known[seed, asked]

    return path


def read(path) -> dict:
    return json.loads(path.read_text())


def with_a_pillar(apart: float, asked: float) -> str:
    """The base scene as text, which asks for room on its first line; a pillar stands so far from
    the outside of the left finger at home."""
    scene = base_scene.scene()
    scene["fixtures"].append(box("pillar", [0.02, 0.02, 0.3], [0.45, 0.247 + apart, 0.85]))
    return f"clearance: {asked}\n{yaml_text(scene)}"


# --- plans --------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", (*SEEDS, 41))
def test_what_is_asked_is_kept(clearway, plans, seed):
    """By the plan's own word, by the checker's measure and by `verify`. With 41 the hand goes home
    close by what it has put down."""
    plan = judged(clearway, plans(seed))
    assert plan["scene"]["clearance"] == ASKED == plan["clearance"]["asked"]
    least = plan["clearance"]["least"]
    assert least["distance"] >= ASKED - tolerances.CLEARANCE
    step = plan["steps"][least["step"]]
    assert 0 <= least["segment"] < len(step["segments"])
    assert len(least["between"]) == 2 and least["time"] >= 0.0


def test_what_nobody_asks_for_is_told(clearway, plans):
    for seed in SEEDS:
        plan = judged(clearway, plans(seed, None))
        assert plan["scene"]["clearance"] == 0.0 == plan["clearance"]["asked"]
        assert 0.0 < plan["clearance"]["least"]["distance"] <= plan["clearance"]["up_to"]


def test_pushes_keep_it_too(clearway, tmp_path):
    scene = generated(clearway, tmp_path, "shelf", 12, 5)
    scene.write_text(f"{scene.read_text()}clearance: {ASKED}\n")
    clearway.solve(scene, tmp_path / "plan.json", "--prefer-push")
    plan = judged(clearway, tmp_path / "plan.json")
    assert "push" in {step["action"] for step in plan["steps"]}
    assert plan["clearance"]["least"]["distance"] >= ASKED - tolerances.CLEARANCE


def test_with_noise_in_mujoco(plans):
    """Everything may stand 2 mm elsewhere: nothing is touched."""
    played = play(read(plans(3)), seed=1, noise=0.002)
    assert played.as_planned and not played.faults(), played.faults()
    assert played.arm_force <= 1.0


# --- both judges see what is not kept -----------------------------------------------------------


def test_asked_for_afterwards(clearway, plans, tmp_path):
    plan = read(plans(2))
    plan["scene"]["clearance"] = plan["clearance"]["asked"] = 0.03
    assert {v.rule for v in check_plan(plan, tmp_path, fast=True)} == {"clearance"}
    path = tmp_path / "raised.json"
    path.write_text(json.dumps(plan))
    done = clearway.run("verify", path, "--json")
    assert done.code == VIOLATIONS, done.out + done.err
    assert {v["kind"] for v in json.loads(done.out)["violations"]} == {"clearance"}
    done = clearway.run("verify", path)
    assert done.code == VIOLATIONS and "clearance" in done.out, done.out


def test_a_plan_that_claims_too_much(clearway, plans, tmp_path):
    plan = read(plans(2, None))
    # The checker measures at the rows: what comes nearer between two of them it does not see.
    plan["clearance"]["least"]["distance"] += 0.015
    assert "clearance" in {v.rule for v in check_plan(plan, tmp_path, fast=True)}
    path = tmp_path / "boast.json"
    path.write_text(json.dumps(plan))
    done = clearway.run("verify", path)
    assert done.code == VIOLATIONS and "clearance" in done.out, done.out


def test_a_millimetre_more_than_there_is(clearway, plans, tmp_path):
    """`verify` finds it where the plan says that the least room is."""
    plan = read(plans(3))
    plan["scene"]["clearance"] = plan["clearance"]["least"]["distance"] + 0.001
    path = tmp_path / "near.json"
    path.write_text(json.dumps(plan))
    done = clearway.run("verify", path, "--json")
    (first, *_) = json.loads(done.out)["violations"]
    assert done.code == VIOLATIONS and first["kind"] == "clearance"
    assert first["time"] == pytest.approx(plan["clearance"]["least"]["time"], abs=0.5)


# --- what cannot be asked -----------------------------------------------------------------------


@pytest.mark.parametrize("value", ["-0.001", ".nan", ".inf", "-.inf", "1"])
def test_bad_clearance(clearway, tmp_path, value):
    text = yaml_text(base_scene.scene()) + f"clearance: {value}\n"
    line = line_of(text, "clearance")
    words = (f"scene.yaml:{line}:12", "the clearance is", "leave the key out")
    refused(clearway, tmp_path, text, *words, line=line)


def test_clearance_in_words(clearway, tmp_path):
    text = yaml_text(base_scene.scene()) + "clearance: wide\n"
    refused(clearway, tmp_path, text, "wide", line=line_of(text, "clearance"))


def test_the_start_is_nearer_than_asked(clearway, tmp_path):
    text = with_a_pillar(apart=0.02, asked=0.05)
    words = ("scene.yaml:1:12", "start", "clearance", "pillar", "left_finger", "ask for less")
    refused(clearway, tmp_path, text, *words, line=1)


def test_the_start_is_as_far_as_asked(clearway, tmp_path):
    """The same pillar, and less asked for."""
    path = tmp_path / "scene.yaml"
    path.write_text(with_a_pillar(apart=0.02, asked=0.003))
    done = clearway.run("plan", path, "-o", tmp_path / "plan.json", "--time-limit", 20)
    assert done.code == SOLVED, done.err
    judged(clearway, tmp_path / "plan.json")
