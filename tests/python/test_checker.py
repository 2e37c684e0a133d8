"""The checker itself: a planted fault for every rule, and what has to be allowed.

`mini_plan.plan()` has no fault; each test plants one and names the rule that must see it.
"""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mini_plan
from box_stl import write_box_stl
from plan_checker import check_file, check_plan

# --- the plan without a fault -------------------------------------------------------------------


def rules(plan: dict, folder: Path = Path("."), fast: bool = False) -> set[str]:
    return {violation.rule for violation in check_plan(plan, folder, fast)}


@pytest.fixture
def plan() -> dict:
    return mini_plan.plan()


@pytest.mark.parametrize("fast", [True, False])
def test_a_good_plan_has_no_violations(plan, fast):
    assert check_plan(plan, fast=fast) == []


def test_unknown_keys_are_ignored(plan):
    plan["news"] = plan["steps"][0]["news"] = plan["robot"]["news"] = {"x": 1}
    plan["scene"]["fixtures"][0]["news"] = 1
    assert check_plan(plan) == []


def test_an_unsolved_plan_is_a_violation(plan):
    plan["status"] = "out_of_budget"
    assert rules(plan) == {"status"}


def test_the_command_line(plan, tmp_path):
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(json.dumps(plan))
    plan["removed"] = ["b", "a"]
    bad.write_text(json.dumps(plan))
    script = Path(__file__).with_name("check_plan.py")
    for files, code in (([good], 0), ([bad], 1), ([good, bad], 1), ([tmp_path / "none"], 1)):
        done = subprocess.run([sys.executable, script, *files], capture_output=True, text=True)
        assert done.returncode == code, done.stdout + done.stderr
    assert check_file(good) == []


# --- planted faults -----------------------------------------------------------------------------
# Segments: 0 transit, 1 approach, 2 grasp, 3 lift, 4 carry, 5 lower, 6 release, 7 retreat.


def segment(plan: dict, step: int, index: int) -> dict:
    return plan["steps"][step]["segments"][index]


def replace(plan: dict, step: int, index: int, new: dict) -> None:
    plan["steps"][step]["segments"][index] = new


def drop_a_row(plan):
    for key in ("times", "positions"):
        del segment(plan, 0, 0)[key][5]


def time_stands_still(plan):
    segment(plan, 0, 4)["times"][3] = segment(plan, 0, 4)["times"][2]


def time_from_later(plan):
    s = segment(plan, 0, 1)
    s["times"] = [t + 0.01 for t in s["times"]]


def past_a_limit(plan):
    plan["robot"]["urdf"] = plan["robot"]["urdf"].replace('upper="-0.1"', 'upper="-0.61"')


def gripper_past_its_limit(plan):
    text = plan["robot"]["urdf"]
    plan["robot"]["urdf"] = text.replace('lower="0" upper="0.05"', 'lower="0" upper="0.015"', 1)


def too_fast(plan):
    plan["robot"]["limits"]["velocity"]["y"] = 0.5


def faster_than_the_urdf(plan):
    plan["robot"]["limits"]["velocity"]["y"] = 1.5


def too_hard(plan):
    plan["robot"]["limits"]["acceleration"]["z"] = 2.0


def too_sudden(plan):
    """The cosines of `mini_plan` start with their full acceleration."""
    plan["robot"]["limits"]["jerk"] = {"x": 1e4, "y": 50.0, "z": 1e4}


def jerk_of_one_joint_missing(plan):
    plan["robot"]["limits"]["jerk"] = {"x": 1e4, "y": 1e4}


def starts_moving(plan):
    """The first motion from its middle: within the limits inside, not at rest before."""
    s, middle = segment(plan, 0, 0), len(segment(plan, 0, 0)["times"]) // 2
    s["positions"] = s["positions"][middle:]
    s["times"] = s["times"][: len(s["positions"])]
    plan["robot"]["home"] = dict(zip("xyz", s["positions"][0]))


def stops_dead(plan):
    for key in ("times", "positions"):
        s = segment(plan, 1, 7)
        s[key] = s[key][: len(s[key]) // 2]


def runs_on_at_a_border(plan):
    """Two halves of one line, each from rest to rest: the middle is where a border jerks."""
    s = segment(plan, 0, 4)
    half = len(s["times"]) // 2
    s["positions"] = s["positions"][: half + 1] + [s["positions"][-1]]
    s["times"] = s["times"][: half + 2]


def starts_elsewhere(plan):
    plan["scene"]["robot"]["start"] = {"x": -0.3}


def jumps_between_segments(plan):
    for row in segment(plan, 0, 4)["positions"]:
        row[0] += 1e-4


def opens_while_carrying(plan):
    s = segment(plan, 0, 4)
    count = len(s["times"])
    s["gripper"]["finger_joint"] = np.linspace(0.02, 0.0195, count).tolist()


def gripper_jumps(plan):
    segment(plan, 0, 4)["gripper"]["finger_joint"] = 0.0195


def gripper_comes_and_goes(plan):
    segment(plan, 0, 4)["gripper"] = {}
    plan["robot"]["fixed"]["finger_joint"] = 0.02


def fixed_past_its_limit(plan):
    plan["robot"]["fixed"]["lamp_joint"] = 4.0


def fixed_and_planned(plan):
    plan["robot"]["fixed"]["x"] = 0.0


def joint_without_a_value(plan):
    plan["robot"]["fixed"] = {}


def mimic_goes_its_own_way(plan):
    for step in plan["steps"]:
        for s in step["segments"]:
            s["gripper"]["right_joint"] = 0.01


def pair_that_hardly_touches(plan):
    plan["robot"]["unchecked_pairs"].append(["hand", "stand"])


def pair_of_nobody(plan):
    plan["robot"]["unchecked_pairs"].append(["hand", "tail"])


def held_where_it_did_not_stand(plan):
    for index in (3, 4, 5):
        segment(plan, 0, index)["attached"]["pose_in_tool"]["position"][2] += 0.003


def slips(plan):
    segment(plan, 0, 4)["attached"]["pose_in_tool"]["position"][1] += 0.0005


def put_elsewhere(plan):
    plan["steps"][0]["placed"]["position"][0] += 0.003


def turned_unseen(plan):
    plan["steps"][0]["placed"]["quaternion"] = [0.0, 0.0, np.sin(0.1), np.cos(0.1)]


def never_let_go(plan):
    for index in (6, 7):
        segment(plan, 0, index)["attached"] = segment(plan, 0, 5)["attached"]


def never_held(plan):
    for index in (3, 4, 5):
        segment(plan, 0, index)["attached"] = None


def grips_air(plan):
    for step in plan["steps"]:
        for s in step["segments"]:
            s["gripper"] = {"finger_joint": 0.0}


def placed_tilted(plan):
    plan["steps"][0]["placed"]["quaternion"] = [np.sin(0.002), 0.0, 0.0, np.cos(0.002)]


def place_is_elsewhere(plan):
    """Beside the tray, on the table that carried it: allowed only on the same fixture."""
    plan["scene"]["place"][0]["position"][1] = -0.3
    table = plan["scene"]["fixtures"]
    table[0]["box"]["size"][1], table[0]["position"][1] = 0.7, -0.05
    table.append({"id": "other", "box": {"size": [1.2, 0.4, 0.04]}, "position": [0.1, 0.5, -0.02]})


def sticks_out(plan):
    place_is_elsewhere(plan)
    plan["scene"]["place"][0]["position"][1] = 0.25 + 0.021


def put_down_high(plan):
    """The table where they are put is 2 mm lower, and so is the place."""
    place_is_elsewhere(plan)
    plan["scene"]["place"][0]["position"] = [0.1, 0.4, -0.002]
    plan["scene"]["fixtures"][1]["position"][2] -= 0.002


def put_down_sunk(plan):
    place_is_elsewhere(plan)
    plan["scene"]["place"][0]["position"] = [0.1, 0.4, 0.0]
    plan["scene"]["fixtures"][1]["position"][2] += 0.002


def floating_at_the_start(plan):
    plan["scene"]["fixtures"][0]["position"][2] -= 0.002


def stacked_on_what_is_taken(plan):
    shape = {"radius": 0.02, "height": 0.04}
    plan["scene"]["objects"].append({"id": "c", "cylinder": shape, "position": [0, 0, 0.14]})


def overlapping_at_the_start(plan):
    shape = {"radius": 0.03, "height": 0.12}
    plan["scene"]["objects"].append({"id": "c", "cylinder": shape, "position": [0.45, -0.2, 0.06]})
    plan["scene"]["objects"].append({"id": "d", "cylinder": shape, "position": [0.5, -0.2, 0.06]})


def stack(plan, *shifts):
    """Flat blocks on each other, out of the way, each so far along x from where the stack is."""
    size = [0.06, 0.06, 0.03]
    for i, shift in enumerate(shifts):
        at = [0.45 + shift, -0.2, 0.015 + 0.03 * i]
        plan["scene"]["objects"].append({"id": f"s{i}", "box": {"size": size}, "position": at})


def stacked_too_far_out(plan):
    stack(plan, 0.0, 0.032)


def stacked_by_and_by_too_far_out(plan):
    """No block falls off the one below it by itself."""
    stack(plan, 0.0, 0.025, 0.05)


def plank_on_what_is_taken(plan):
    """It lies on a and on another, and stays on that alone."""
    other = {"id": "c", "box": {"size": [0.06, 0.06, 0.12]}, "position": [0.0, -0.1, 0.06]}
    plank = {"id": "d", "box": {"size": [0.02, 0.14, 0.02]}, "position": [0.0, -0.05, 0.13]}
    plan["scene"]["objects"] += [other, plank]


def goal_is_no_text(plan):
    plan["goal"] = ["On", "a", "tray"]


def put_down_into_another(plan):
    plan["scene"]["objects"].append(
        {"id": "c", "cylinder": {"radius": 0.02, "height": 0.03}, "position": [-0.05, 0.352, 0.015]}
    )


def post_in_the_way(plan):
    """Reaches the fingers' tips on their way to b's place, not what they hold before."""
    plan["scene"]["fixtures"].append(
        {"id": "post", "box": {"size": [0.02, 0.02, 0.28]}, "position": [0.155, 0.05, 0.14]}
    )


def low_beam_over_what_is_carried(plan):
    """Between the fingers' tips and the underside of what they hold, which hangs lower."""
    plan["scene"]["fixtures"].append(
        {"id": "beam", "box": {"size": [0.005, 0.02, 0.23]}, "position": [-0.03, 0.25, 0.115]}
    )


def object_beside_the_grasp(plan):
    plan["scene"]["objects"].append(
        {"id": "c", "cylinder": {"radius": 0.02, "height": 0.12}, "position": [0.075, 0, 0.06]}
    )


def lamp_hangs_low(plan):
    """The lamp's ball where the hand passes: a link against a link."""
    text = plan["robot"]["urdf"].replace('<origin xyz="0.3 0 0"/>', '<origin xyz="0 0.2 -0.6"/>')
    plan["robot"]["urdf"] = text


def lamp_meets_what_is_held(plan):
    """A ball fixed to the bridge, under the fingers, where what they hold passes."""
    text = plan["robot"]["urdf"].replace('<origin xyz="0.3 0 0"/>', '<origin xyz="0 0.2 -0.67"/>')
    plan["robot"]["urdf"] = text.replace('radius="0.02"', 'radius="0.005"')


def squeezes_in_a_transit(plan):
    """Closed by 0.5 mm more: fine while gripping, not in a transit."""
    segment(plan, 0, 7)["kind"] = "transit"
    for index in (6, 7):
        s = segment(plan, 0, index)
        s["gripper"] = {"finger_joint": [0.0205] * len(s["times"])}
    for index in (3, 4, 5):
        segment(plan, 0, index)["gripper"] = {"finger_joint": 0.0205}
    segment(plan, 0, 2)["gripper"] = {"finger_joint": np.linspace(0, 0.0205, 11).tolist()}
    s = mini_plan.hand_moves("release", segment(plan, 0, 7)["positions"][-1], 0.0205, 0.0)
    plan["steps"][0]["segments"].append(s)


def removed_in_another_order(plan):
    plan["removed"] = ["b", "a"]


def target_is_not_last(plan):
    plan["scene"]["target"] = "a"


def bound_above_the_plan(plan):
    plan["lower_bound"]["removed"] = 3


def step_of_nobody(plan):
    plan["steps"][0]["object"] = "ghost"


def not_finite(plan):
    segment(plan, 0, 4)["positions"][3][1] = float("nan")


def key_is_missing(plan):
    del plan["robot"]["limits"]


def mesh_is_not_listed(plan):
    text = plan["robot"]["urdf"]
    plan["robot"]["urdf"] = text.replace('<sphere radius="0.02"/>', '<mesh filename="lamp.stl"/>')


FAULTS = [
    (drop_a_row, "times"),
    (time_stands_still, "times"),
    (time_from_later, "times"),
    (past_a_limit, "limits"),
    (gripper_past_its_limit, "limits"),
    (too_fast, "velocity"),
    (faster_than_the_urdf, "velocity"),
    (too_hard, "acceleration"),
    (too_sudden, "jerk"),
    (jerk_of_one_joint_missing, "jerk"),
    (starts_moving, "acceleration"),
    (stops_dead, "acceleration"),
    (runs_on_at_a_border, "acceleration"),
    (starts_elsewhere, "start"),
    (jumps_between_segments, "continuity"),
    (opens_while_carrying, "gripper"),
    (gripper_jumps, "gripper"),
    (gripper_comes_and_goes, "gripper"),
    (fixed_past_its_limit, "limits"),
    (fixed_and_planned, "fixed"),
    (joint_without_a_value, "format"),
    (mimic_goes_its_own_way, "mimic"),
    (pair_that_hardly_touches, "unchecked"),
    (pair_of_nobody, "unchecked"),
    (held_where_it_did_not_stand, "attach"),
    (held_where_it_did_not_stand, "release"),
    (slips, "hold"),
    (put_elsewhere, "release"),
    (turned_unseen, "release"),
    (never_let_go, "release"),
    (never_held, "hold"),
    (grips_air, "hold"),
    (placed_tilted, "placed"),
    (place_is_elsewhere, "placed"),
    (sticks_out, "placed"),
    (put_down_high, "placed"),
    (put_down_high, "support"),
    (put_down_sunk, "touch"),
    (floating_at_the_start, "support"),
    (stacked_on_what_is_taken, "support"),
    (overlapping_at_the_start, "touch"),
    (stacked_too_far_out, "unstable"),
    (stacked_by_and_by_too_far_out, "unstable"),
    (plank_on_what_is_taken, "unstable"),
    (put_down_into_another, "touch"),
    (post_in_the_way, "touch"),
    (low_beam_over_what_is_carried, "touch"),
    (object_beside_the_grasp, "touch"),
    (lamp_hangs_low, "touch"),
    (lamp_meets_what_is_held, "touch"),
    (squeezes_in_a_transit, "touch"),
    (removed_in_another_order, "removed"),
    (target_is_not_last, "removed"),
    (bound_above_the_plan, "bound"),
    (step_of_nobody, "format"),
    (goal_is_no_text, "format"),
    (not_finite, "format"),
    (key_is_missing, "format"),
    (mesh_is_not_listed, "mesh"),
]


@pytest.mark.parametrize("fault, rule", FAULTS, ids=lambda value: getattr(value, "__name__", value))
def test_planted_fault(plan, fault, rule):
    fault(plan)
    found = rules(plan)
    assert rule in found, f"found only {found}"


ALONE = {
    drop_a_row: {"times"},
    too_fast: {"velocity"},
    too_hard: {"acceleration"},
    too_sudden: {"jerk"},
    starts_elsewhere: {"start"},
    pair_that_hardly_touches: {"unchecked"},
    removed_in_another_order: {"removed"},
    place_is_elsewhere: {"placed"},
    sticks_out: {"placed"},
    stacked_too_far_out: {"unstable"},
    stacked_by_and_by_too_far_out: {"unstable"},
    plank_on_what_is_taken: {"unstable", "touch"},
    lamp_hangs_low: {"touch"},
    lamp_meets_what_is_held: {"touch"},
    low_beam_over_what_is_carried: {"touch"},
    object_beside_the_grasp: {"touch"},
    stacked_on_what_is_taken: {"support", "touch"},
}


@pytest.mark.parametrize("fault", ALONE, ids=lambda fault: fault.__name__)
def test_a_fault_breaks_only_its_own_rule(plan, fault):
    fault(plan)
    extra = rules(plan) - ALONE[fault]
    assert not extra - ({"acceleration", "velocity"} if fault is drop_a_row else set())


def test_the_pair_is_named(plan):
    lamp_meets_what_is_held(plan)
    found = [violation.text for violation in check_plan(plan)]
    assert len(found) == 2, found
    assert "lamp touches a " in found[0] and "lamp touches b " in found[1], found


# --- what is allowed ----------------------------------------------------------------------------


def test_squeezing_is_allowed_while_gripping(plan):
    squeezes_in_a_transit(plan)
    segment(plan, 0, 7)["kind"] = "retreat"
    found = [v for v in check_plan(plan) if v.rule == "touch"]
    assert found == []


@pytest.mark.parametrize("shift", [-0.0009, 0.0009])
def test_a_millimetre_at_lift_off_and_put_down_is_forgiven(plan, shift):
    plan["scene"]["fixtures"][0]["position"][2] += shift
    assert check_plan(plan) == []


def test_a_relocated_object_may_stay_on_what_carried_it(plan):
    plan["scene"]["place"] = []
    assert check_plan(plan) == []


@pytest.mark.parametrize("shifts", [(0, 0.028), (0, 0.02, 0.035), (0, 0.02, -0.01), (0, 0.02, 0)])
def test_what_balances_stands(plan, shifts):
    stack(plan, *shifts)
    assert check_plan(plan) == []


def test_a_goal_of_its_own_leaves_things_anywhere(plan):
    place_is_elsewhere(plan)
    target_is_not_last(plan)
    assert rules(plan) == {"placed", "removed"}
    plan["goal"] = "(and)"
    assert check_plan(plan) == []
    plan["steps"], plan["removed"], plan["lower_bound"] = [], [], None
    assert check_plan(plan) == []
    del plan["goal"]
    assert rules(plan) == {"format", "removed"}


def test_the_root_link_may_meet_what_it_is_mounted_on(plan):
    plan["robot"]["urdf"] = plan["robot"]["urdf"].replace('xyz="-0.4 0.2 0.05"', 'xyz="-0.4 0.2 0"')
    assert check_plan(plan) == []


def test_a_pair_that_always_touches_may_go_unchecked(plan):
    lamp = '<origin xyz="0.3 0 0"/>'
    plan["robot"]["urdf"] = plan["robot"]["urdf"].replace(lamp, '<origin xyz="0 0 0.1"/>')
    plan["robot"]["fixed"]["lamp_joint"] = 0.0
    plan["robot"]["unchecked_pairs"].append(["bridge", "lamp"])
    assert check_plan(plan) == []


# --- between the rows ---------------------------------------------------------------------------


def test_what_happens_between_rows_is_seen(plan):
    """A small ball on the carriage passes a needle from one row to the next."""
    text = plan["robot"]["urdf"]
    ball = '<origin xyz="0 0 0.15"/><geometry><sphere radius="0.002"/></geometry>'
    plan["robot"]["urdf"] = text.replace(
        '<link name="carriage"/>', f'<link name="carriage"><collision>{ball}</collision></link>'
    )
    rows = np.array(segment(plan, 0, 4)["positions"])
    middle = len(rows) // 2
    x, y = (rows[middle, :2] + rows[middle + 1, :2]) / 2
    assert np.linalg.norm(rows[middle + 1] - rows[middle]) > 0.012
    plan["scene"]["fixtures"].append(
        {"id": "needle", "cylinder": {"radius": 0.001, "height": 0.02}, "position": [x, y, 1.15]}
    )
    assert rules(plan, fast=True) == set()
    assert rules(plan, fast=False) == {"touch"}


# --- meshes in a plan ---------------------------------------------------------------------------


def with_meshes(plan: dict, folder: Path) -> None:
    """The hand and the table as meshes, of the same sizes."""
    entries = []
    for name, size in (("hand", [0.14, 0.05, 0.04]), ("table", [1.2, 1.2, 0.04])):
        file = f"{name}.stl"
        digest = write_box_stl(folder / file, ([0, 0, 0], size))
        entries.append({"uri": f"package://mini/{file}", "file": file, "sha256": digest})
    plan["robot"]["meshes"] = entries
    mesh = '<mesh filename="package://mini/hand.stl"/>'
    plan["robot"]["urdf"] = plan["robot"]["urdf"].replace('<box size="0.14 0.05 0.04"/>', mesh)
    table = plan["scene"]["fixtures"][0]
    del table["box"]
    table["mesh"] = {"file": "package://mini/table.stl"}


def test_meshes_stand_in_for_boxes(plan, tmp_path):
    with_meshes(plan, tmp_path)
    assert check_plan(plan, tmp_path) == []
    plan["scene"]["fixtures"].append(
        {"id": "post", "box": {"size": [0.02, 0.02, 0.38]}, "position": [0.1, 0.2, 0.19]}
    )
    found = check_plan(plan, tmp_path)
    assert any("hand touches post" in violation.text for violation in found)


def test_a_changed_mesh_is_noticed(plan, tmp_path):
    with_meshes(plan, tmp_path)
    plan["robot"]["meshes"][0]["sha256"] = "0" * 64
    assert rules(plan, tmp_path) == {"mesh"}


def test_a_missing_mesh_is_noticed(plan, tmp_path):
    with_meshes(plan, tmp_path)
    (tmp_path / "hand.stl").unlink()
    assert rules(plan, tmp_path) == {"mesh"}


def test_points_are_balls(plan, tmp_path):
    data = b"0.2 0.2 0.32\n0.6 0.6 0.6\n"
    (tmp_path / "cloud.xyz").write_bytes(data)
    digest = hashlib.sha256(data).hexdigest()
    plan["robot"]["meshes"] = [{"uri": "cloud.xyz", "file": "cloud.xyz", "sha256": digest}]
    fixture = {"id": "cloud", "points": {"file": "cloud.xyz", "radius": 0.01}}
    plan["scene"]["fixtures"].append(fixture)
    assert rules(plan, tmp_path) == {"touch"}
    fixture["position"] = [0.0, 0.0, -0.25]
    assert rules(plan, tmp_path) == set()


def test_compounds_are_all_their_parts(plan):
    parts = [
        {"box": {"size": [0.02, 0.02, 0.02]}, "position": [-0.5, 0, 0]},
        {"sphere": {"radius": 0.02}, "position": [0, 0, 0.1]},
    ]
    fixture = {"id": "thing", "compound": parts, "position": [0.2, 0.2, 0.2]}
    plan["scene"]["fixtures"].append(fixture)
    assert rules(plan) == {"touch"}
    fixture["rpy"] = [0.0, 0.0, 0.0]
    parts[1]["position"] = [0.35, 0, 0.1]
    assert rules(plan) == set()


def test_a_push_slides_on_what_carries_it(plan):
    """The target is dragged along the table, held in the fingers, as a push."""
    names = plan["steps"][1]["segments"]
    at, goal = [0.2, 0.0, mini_plan.DOWN], [0.2, 0.2, mini_plan.DOWN]
    over_goal = [0.2, 0.2, mini_plan.ABOVE]
    slide = mini_plan.segment("push", at, goal, mini_plan.CLOSED, names[3]["attached"])
    plan["steps"][1]["segments"] = [
        *names[:3],
        slide,
        mini_plan.hand_moves("release", goal, mini_plan.CLOSED, mini_plan.OPEN),
        mini_plan.segment("retreat", goal, over_goal, mini_plan.OPEN),
    ]
    plan["steps"][1]["action"] = "push"
    plan["steps"][1]["placed"]["position"] = [0.2, 0.2, 0.06]
    assert check_plan(plan) == []
    plan["scene"]["fixtures"].append(
        {"id": "curb", "box": {"size": [0.4, 0.02, 0.01]}, "position": [0.2, 0.15, 0.005]}
    )
    assert rules(plan) == {"touch"}


@pytest.mark.parametrize("region, expected", [([-0.3, 0.9], set()), ([0.0, 0.9], {"region"})])
def test_a_base_that_drives_stays_in_its_region(plan, region, expected):
    """The gantry's x and y, then a turn, as a mobile base."""
    text = plan["robot"]["urdf"].replace(
        '<joint name="z" type="prismatic">\n    <parent link="carriage"/>',
        '<link name="turned"/><joint name="yaw" type="continuous"><parent link="carriage"/>'
        '<child link="turned"/><axis xyz="0 0 1"/></joint>'
        '<joint name="z" type="prismatic">\n    <parent link="turned"/>',
    )
    plan["robot"]["urdf"] = text
    plan["robot"]["fixed"]["yaw"] = 0.0
    plan["robot"]["joints"] = ["x", "y", "yaw", "z"]
    del plan["robot"]["fixed"]["yaw"]
    plan["robot"]["home"]["yaw"] = 0.0
    for limits in plan["robot"]["limits"].values():
        limits["yaw"] = 1.0
    for step in plan["steps"]:
        for s in step["segments"]:
            s["positions"] = [[x, y, 0.0, z] for x, y, z in s["positions"]]
    low, high = region
    plan["scene"]["robot"]["region"] = {"min": [low, low], "max": [high, high]}
    assert rules(plan) == expected


# --- pushes ---------------------------------------------------------------------------------------


@pytest.fixture
def pushed(monkeypatch) -> dict:
    """The target is pushed 10 cm along x by the finger behind it, 2 cm away at first."""
    monkeypatch.setattr(mini_plan, "ACCELERATION", 1.5)
    plan = mini_plan.plan()
    over, down = [0.2, 0.0, mini_plan.ABOVE], [0.2, 0.0, mini_plan.DOWN]
    end, away = [0.32, 0.0, mini_plan.DOWN], [0.32, 0.0, mini_plan.ABOVE]
    ways = [("approach", over, down), ("push", down, end), ("retreat", end, away)]
    step = plan["steps"][1]
    step["segments"] = [
        step["segments"][0],
        *(mini_plan.segment(kind, start, goal, mini_plan.OPEN) for kind, start, goal in ways),
    ]
    step["action"], step["placed"]["position"] = "push", [0.3, 0.0, 0.06]
    step["push"] = {"direction": [1, 0, 0], "distance": 0.1, "free": 0.02}
    plan["scene"]["friction"] = 0.2
    return plan


def test_a_push_without_a_fault(pushed):
    assert check_plan(pushed) == []
    del pushed["steps"][1]["push"]
    assert check_plan(pushed) == []


def ends_elsewhere(plan):
    plan["steps"][1]["placed"]["position"][0] += 0.002


def swerves(plan):
    rows = segment(plan, 1, 2)["positions"]
    for i, row in enumerate(rows):
        row[1] += 0.003 * np.sin(np.pi * i / (len(rows) - 1)) ** 2


def meets_it_later(plan):
    plan["steps"][1]["push"].update(free=0.023, distance=0.097)
    plan["steps"][1]["placed"]["position"][0] = 0.297


def meets_it_sooner(plan):
    plan["steps"][1]["push"].update(free=0.017, distance=0.103)
    plan["steps"][1]["placed"]["position"][0] = 0.303


def says_more_than_it_does(plan):
    plan["steps"][1]["push"]["distance"] = 0.105
    plan["steps"][1]["placed"]["position"][0] = 0.305


def goes_uphill(plan):
    plan["steps"][1]["push"]["direction"] = [0.8, 0, 0.6]


def tips(plan):
    plan["scene"]["objects"][1]["friction"] = 0.3


def is_not_round(plan):
    body = plan["scene"]["objects"][1]
    del body["cylinder"]
    body["box"] = {"size": [0.06, 0.06, 0.12]}


def slides_on(plan):
    plan["scene"]["friction"] = 0.1


def slides_onto_a_mat(plan):
    mat = {"id": "mat", "box": {"size": [0.1, 0.1, 0.01]}, "position": [0.32, 0, -0.005]}
    plan["scene"]["fixtures"].append(mat)


def carries_another(plan):
    shape = {"radius": 0.01, "height": 0.02}
    plan["scene"]["objects"].append({"id": "c", "cylinder": shape, "position": [0.2, 0, 0.13]})


PUSH_FAULTS = [
    ends_elsewhere,
    swerves,
    meets_it_later,
    meets_it_sooner,
    says_more_than_it_does,
    goes_uphill,
    tips,
    is_not_round,
    slides_on,
    slides_onto_a_mat,
    carries_another,
]


@pytest.mark.parametrize("fault", PUSH_FAULTS, ids=lambda fault: fault.__name__)
def test_planted_fault_of_a_push(pushed, fault):
    fault(pushed)
    assert "push" in rules(pushed)


@pytest.mark.parametrize("across, touches", [(0.039, True), (0.0405, False)])
def test_what_is_pushed_touches_nothing(pushed, across, touches):
    curb = {"id": "curb", "box": {"size": [0.02, 0.02, 0.04]}, "position": [0.27, across, 0.02]}
    pushed["scene"]["fixtures"].append(curb)
    assert rules(pushed) == ({"touch"} if touches else set())


def test_what_is_pushed_over_an_edge_falls(pushed):
    pushed["scene"]["fixtures"][0]["box"]["size"][0] = 0.39  # the table ends at x = 0.295
    pushed["scene"]["place"] = [{"id": "p", "size": [0.4, 0.4], "position": [0, 0.4, 0]}]
    assert "unstable" in rules(pushed)


# --- clearance ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "gap, asked, expected",
    [(0.001, 0, set()), (0.0021, 0.002, set()), (0.0018, 0.002, {"clearance"})],
)
def test_room_over_the_bridge(plan, gap, asked, expected):
    slab = {"id": "slab", "box": {"size": [2, 2, 0.02]}, "position": [0, 0, 1.03 + gap]}
    plan["scene"]["fixtures"].append(slab)
    plan["scene"]["clearance"] = asked
    assert rules(plan) == expected
    for claimed, more in ((gap, set()), (gap + 0.0005, {"clearance"})):
        plan["clearance"] = {"asked": asked, "up_to": 0.05, "least": {"distance": claimed}}
        assert rules(plan) == expected | more
    plan["clearance"]["least"] = None
    assert rules(plan) == {"clearance"}


@pytest.mark.parametrize("bump, expected", [(0.0, set()), (0.0006, {"clearance"})])
def test_a_neighbour_that_is_near_stays_as_far(pushed, bump, expected):
    """A low wall beside the push, 1 mm from it, and a bump half-way."""
    wall = {"box": {"size": [0.3, 0.02, 0.02]}, "position": [0, 0, 0]}
    post = {"box": {"size": [0.001, 0.02, 0.02]}, "position": [0, -bump, 0]}
    fixture = {"id": "wall", "compound": [wall, post], "position": [0.25, 0.041, 0.01]}
    pushed["scene"]["fixtures"].append(fixture)
    assert rules(pushed) == set()
    pushed["scene"]["clearance"] = 0.002
    assert rules(pushed) == expected


def test_what_carries_an_object_is_near_it_only_where_it_stands(plan):
    """Lifted by less than 3 cm it may be near the table, not on all of its way."""
    for index in (3, 4, 5):
        rows = segment(plan, 0, index)["positions"]
        for row in rows:
            row[2] = min(row[2], mini_plan.DOWN + 0.002)
    assert "clearance" not in rules(plan)
    plan["scene"]["clearance"] = 0.004
    assert "clearance" in rules(plan)
