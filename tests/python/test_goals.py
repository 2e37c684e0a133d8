"""Goals in PDDL: what a plan leaves behind is looked at by our own reader of goals."""

import json
import re

import pytest

import base_scene
import goal_holds
import physics
import stacks
from clearway_cli import IMPOSSIBLE, OUT_OF_BUDGET
from scenes import generated, judged, read, replayed

ALL_BACK = "(and (On {0} tray) (forall (?o - item) (or (= ?o {0}) (InPlace ?o))))"
ALL_INSIDE = "(and (On {0} tray) (forall (?o - item) (or (= ?o {0}) (On ?o shelf_floor))))"


def scene_with_short_ones() -> dict:
    """The base scene, with two objects that others bear."""
    scene = base_scene.scene()
    short = {"radius": 0.035, "height": 0.1}
    scene["objects"] += [
        {"id": "short", "cylinder": short, "position": [0.72, 0.3, 0.65]},
        base_scene.box("brick", [0.06, 0.06, 0.1], [0.72, -0.34, 0.65]),
    ]
    return scene


def reached(clearway, path, goal: str, *more) -> dict:
    """The plan for the goal, judged: the goal holds at its end, and everything stands then."""
    plan_path = path.with_suffix(".plan.json")
    clearway.solve(path, plan_path, "--goal", goal, "--time-limit", 30, *more)
    plan = judged(clearway, plan_path)
    assert plan["goal"] and len(plan["removed"]) == len({s["object"] for s in plan["steps"]})
    state = goal_holds.State(plan)
    assert state.holds(goal_holds.read(goal)), f"{goal} does not hold"
    for _, _, places in replayed(plan):
        assert not physics.fallen(stacks.at_poses(plan["scene"], places))
    return plan


def moves(plan: dict) -> list[str]:
    return [step["object"] for step in plan["steps"]]


# --- the shelf is tidy again --------------------------------------------------------------------


@pytest.mark.parametrize(
    "kind, objects, seed", [("shelf", 12, 3), ("shelf", 12, 6), ("stacked", 8, 1)]
)
def test_all_others_back_in_place(clearway, tmp_path, kind, objects, seed):
    path = generated(clearway, tmp_path, kind, objects, seed)
    plan = reached(clearway, path, ALL_BACK.format(read(path)["target"]))
    assert len(moves(plan)) > len(set(moves(plan))), "nothing is moved twice"


@pytest.mark.parametrize("kind, objects, seed", [("shelf", 12, 5), ("stacked", 8, 2)])
def test_relocation_inside_the_shelf(clearway, tmp_path, kind, objects, seed):
    path = generated(clearway, tmp_path, kind, objects, seed)
    target = read(path)["target"]
    plan = reached(clearway, path, ALL_INSIDE.format(target))
    state = goal_holds.State(plan)
    assert [name for name in state.places if state.is_on(name, "tray")] == [target]


# --- sorting, stacking --------------------------------------------------------------------------


@pytest.mark.parametrize(
    "goal",
    [
        "(and (On near_left tray) (On far_right tray))",
        "(exists (?p - place) (On wanted ?p))",
        "(or (On wanted tray) (On far_left tray))",
        "(not (On near_middle floor))",
        "(and (On wanted tray) (imply (On near_right floor) (InPlace near_right)))",
    ],
)
def test_sorting(clearway, tmp_path, goal):
    reached(clearway, base_scene.write(tmp_path, base_scene.scene()), goal)


@pytest.mark.parametrize(
    "goal",
    [
        "(On short near_left)",
        "(and (On short brick) (On brick tray))",
        "(and (On wanted tray) (On short wanted))",
        "(and (On brick near_right) (On short brick) (Clear short))",
    ],
)
def test_stacking(clearway, tmp_path, goal):
    reached(clearway, base_scene.write(tmp_path, scene_with_short_ones()), goal)


@pytest.mark.parametrize(
    "kind, objects, goal",
    [
        ("stacked", 8, "(forall (?o - item) (not (exists (?p - item) (On ?o ?p))))"),
        ("stacked", 6, "(not (Clear o4))"),
        ("shelf", 6, "(exists (?a - item) (exists (?b - item) (On ?a ?b)))"),
    ],
)
def test_goals_about_all_there_is(clearway, tmp_path, kind, objects, goal):
    """Where anything may be put on anything, not all of it is thought of at once."""
    reached(clearway, generated(clearway, tmp_path, kind, objects, 1), goal)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_shelf_is_emptied_without_detours(clearway, tmp_path, seed):
    plan = reached(
        clearway,
        generated(clearway, tmp_path, "shelf", 12, seed),
        "(forall (?o - item) (On ?o tray))",
    )
    assert sorted(moves(plan)) == sorted(o["id"] for o in plan["scene"]["objects"])


@pytest.mark.parametrize("objects, seed", [(10, 13), (16, 16)])
def test_sorting_onto_two_trays(clearway, tmp_path, objects, seed):
    """Half of the objects, in turn onto one half of the tray and onto the other."""
    path = generated(clearway, tmp_path, "shelf", objects, seed)
    scene = read(path)
    ((length, width), (x, y, z)) = scene["place"][0]["size"], scene["place"][0]["position"]
    scene["place"] = [
        {"id": name, "size": [length, width / 2], "position": [x, y + side * width / 4, z]}
        for name, side in (("near", 1), ("far", -1))
    ]
    path.write_text(json.dumps(scene))
    half = [o["id"] for o in scene["objects"]][: objects // 2]
    goal = " ".join(f"(On {name} {('near', 'far')[i % 2]})" for i, name in enumerate(half))
    plan = reached(clearway, path, f"(and {goal})")
    assert len(moves(plan)) == len(set(moves(plan)))


def test_a_goal_from_a_file_is_the_same(clearway, tmp_path):
    path = base_scene.write(tmp_path, base_scene.scene())
    (tmp_path / "goal.pddl").write_text("; sorted\n(and\n  (On near_left tray)) ; done\n")
    for name, goal in (("a", "(and (On near_left tray))"), ("b", tmp_path / "goal.pddl")):
        clearway.solve(path, tmp_path / name, "--goal", goal)
    first, second = (json.loads((tmp_path / name).read_text())["steps"] for name in "ab")
    assert first == second


def test_a_goal_that_holds_needs_no_steps(clearway, tmp_path):
    path = base_scene.write(tmp_path, base_scene.scene())
    assert reached(clearway, path, "(InPlace wanted)")["steps"] == []


# --- domains and streams of one's own -----------------------------------------------------------


def with_fragile(clearway, names) -> str:
    """The built-in domain, in which nothing picks the named objects."""
    text = clearway.run("pddl", "domain").out
    either = " ".join(f"(= ?o {name})" for name in names)
    for old, new in (
        ("(:predicates", f"(:constants {' '.join(names)} - item)\n  (:predicates"),
        ("    ; derived\n", "    ; derived\n    (Fragile ?o - item)\n"),
        ("(:action pick", f"(:derived (Fragile ?o - item) (or {either}))\n  (:action pick"),
        ("(HandEmpty) (Clear ?o)", "(HandEmpty) (Clear ?o) (not (Fragile ?o))"),
    ):
        assert text.count(old) == 1, f"{old!r} is not once in the domain"
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize("mode", ["symbolic", "all movable", "goal"])
def test_what_a_domain_forbids_is_not_done(clearway, tmp_path, mode):
    """One after the other, what the last plan moved may not be moved any more."""
    path = base_scene.write(tmp_path, base_scene.scene())
    options = {
        "symbolic": ["--symbolic"],
        "all movable": ["--symbolic", "--all-movable"],
        "goal": ["--goal", "(On wanted tray)"],
    }[mode]
    fragile: set[str] = set()
    for i in range(2):
        if fragile:
            (tmp_path / "domain.pddl").write_text(with_fragile(clearway, sorted(fragile)))
            options = [*options[:2], "--domain", tmp_path / "domain.pddl"]
        plan_path = tmp_path / f"{i}.json"
        clearway.solve(path, plan_path, "--time-limit", 20, *options)
        moved = set(moves(judged(clearway, plan_path)))
        assert "wanted" in moved and not moved & fragile
        fragile |= moved - {"wanted"}
        assert fragile, "nothing stood in the way"


def unreached(clearway, tmp_path, scene: dict, *options) -> str:
    """No plan, soon, and a reason."""
    plan_path = tmp_path / "plan.json"
    path = base_scene.write(tmp_path, scene)
    done = clearway.run("plan", path, "-o", plan_path, "--time-limit", 10, *options, seconds=15)
    assert done.code in (IMPOSSIBLE, OUT_OF_BUDGET), f"exit code {done.code}\n{done.err}"
    plan = json.loads(plan_path.read_text())
    assert plan["status"] != "solved" and not plan["steps"]
    summary = plan["why"]["summary"]
    assert summary.strip(" .:") and summary in done.err
    return summary


def test_the_one_that_has_to_move_may_not(clearway, tmp_path):
    (tmp_path / "domain.pddl").write_text(with_fragile(clearway, ["wanted"]))
    for options in (["--symbolic"], ["--goal", "(On wanted tray)"]):
        more = [*options, "--domain", tmp_path / "domain.pddl"]
        assert "wanted" in unreached(clearway, tmp_path, base_scene.scene(), *more)


def test_a_stream_left_out_is_not_used(clearway, tmp_path):
    text = clearway.run("pddl", "streams").out
    text, count = re.subn(r"\(:stream sample-stacking.*?\n\n", "", text, flags=re.DOTALL)
    assert count == 1
    (tmp_path / "streams.pddl").write_text(text)
    more = ["--streams", tmp_path / "streams.pddl", "--goal"]
    unreached(clearway, tmp_path, scene_with_short_ones(), *more, "(On short near_left)")
    path = base_scene.write(tmp_path, scene_with_short_ones())
    reached(clearway, path, "(On short tray)", *more[:2])


# --- what cannot be reached ---------------------------------------------------------------------


@pytest.mark.parametrize("algorithm", ["focused", "incremental"])
def test_behind_a_shutter(clearway, tmp_path, algorithm):
    scene = base_scene.scene()
    scene["fixtures"].append(base_scene.box("shutter", [0.02, 0.94, 0.5], [0.64, 0.0, 0.85]))
    more = ["--algorithm", algorithm, "--goal", "(On wanted tray)"]
    unreached(clearway, tmp_path, scene, *more)


@pytest.mark.parametrize(
    "goal",
    [
        "(not (HandEmpty))",
        "(On wanted wanted)",
        "(and (On wanted tray) (InPlace wanted))",
        "(and (On short near_left) (On near_left short))",
    ],
)
def test_what_can_never_be(clearway, tmp_path, goal):
    unreached(clearway, tmp_path, scene_with_short_ones(), "--goal", goal)
