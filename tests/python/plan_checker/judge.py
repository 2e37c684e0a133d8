"""Reads a plan file and replays it: what stands, what is held, what is put down, step by step."""

import json
from pathlib import Path

import numpy as np

from . import hold_rules, poses, push_rules, tolerances
from .clearance import Clearance
from .contact_rules import ContactRules, Hold
from .meshes import MeshStore
from .robot import Robot
from .robot_rules import check_fixed_and_mimics, check_unchecked_pairs
from .timing import Segment, check_rows, read_segment
from .violations import PlanError, Report, Violation
from .world import World

FORMAT = "clearway-plan/1"


def check_file(path: str | Path, fast: bool = False) -> list[Violation]:
    """All violations of the plan file at `path`; `fast` checks collisions at rows only."""
    path = Path(path)
    try:
        plan = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        return [Violation("format", str(path), str(error))]
    return check_plan(plan, path.parent, fast)


def check_plan(plan: dict, folder: str | Path = ".", fast: bool = False) -> list[Violation]:
    """All violations of a plan; the files that it names are relative to `folder`."""
    report = Report()
    try:
        _judge(plan, Path(folder), fast, report)
    except PlanError as error:
        report.add("format", "plan", str(error))
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, ArithmeticError) as error:
        report.add("format", "plan", f"{type(error).__name__}: {error}")
    return report.finish()


def _judge(plan: dict, folder: Path, fast: bool, report: Report) -> None:
    if plan["format"] != FORMAT:
        raise PlanError(f"format is {plan['format']!r}, expected {FORMAT!r}")
    if plan["status"] != "solved":
        report.add("status", "plan", f"not solved: {plan['status']}")
        return
    meshes = MeshStore(plan["robot"].get("meshes") or [], folder, report)
    placement = plan["scene"]["robot"]
    robot = Robot(plan["robot"], poses.from_keys(placement.get("base")), meshes)
    world = World(plan["scene"], meshes)
    goal = plan.get("goal")
    if goal is not None and not isinstance(goal, str):
        raise PlanError(f"goal is {goal!r}, expected a text")
    _check_removed(plan, world, goal, report)

    steps = [_Step(index, keys, robot) for index, keys in enumerate(plan["steps"])]
    segments = [segment for step in steps for segment in step.segments]
    # A goal may hold as things stand.
    if not segments and (steps or goal is None):
        raise PlanError("a solved plan without segments")
    start = {**robot.home, **(placement.get("start") or {})}
    if segments:
        check_rows(segments, robot, start, report)
    check_fixed_and_mimics(robot, segments, report)
    _check_region(placement.get("region"), robot, segments, report)
    pairs = plan["robot"].get("unchecked_pairs") or []
    check_unchecked_pairs(robot, pairs, report)

    for name, at in world.standing.items():
        hold_rules.check_standing(name, at, world, "scene", report)
    hold_rules.check_balance(world, "at the start", "scene", report)
    contacts = ContactRules(robot, pairs, report, fast)
    room = Clearance(robot, world.clearance, report)
    for step in steps:
        if step.object not in world.objects:
            raise PlanError(f"{step.where}: {step.object!r} is no object of the scene")
        _Replay(step, robot, world, (contacts, room), report, anywhere=goal is not None).run()
    room.judge(plan.get("clearance"))


class _Step:
    """A step of the plan as arrays and poses."""

    def __init__(self, index: int, keys: dict, robot: Robot) -> None:
        self.object: str = keys["object"]
        self.where = f"step {index} ({self.object})"
        self.action: str = keys["action"]
        if self.action not in ("pick_place", "push"):
            raise PlanError(f"{self.where}: unknown action {self.action!r}")
        self.placed = poses.from_keys(keys["placed"])
        self.push: dict | None = keys.get("push")
        self.segments = [
            read_segment(s, len(robot.joints), f"{self.where} segment {i} {s['kind']}")
            for i, s in enumerate(keys["segments"])
        ]


class _Replay:
    """One step, segment after segment; moves the object in `world`. `anywhere`: to whatever
    carries it."""

    def __init__(
        self, step: _Step, robot: Robot, world: World, rules, report: Report, anywhere: bool
    ) -> None:
        self._step, self._robot, self._world = step, robot, world
        (self._contacts, self._room), self._report, self._anywhere = rules, report, anywhere
        self._hold: Hold | None = None
        self._last: np.ndarray | None = None
        """World pose of the held object at the end of the segment before."""
        self._moved = False
        self._pushed_to = 0.0
        """Metres that the tool has come in the push segments before."""

    def run(self) -> None:
        step = self._step
        for segment in step.segments:
            if segment.attached is not None:
                self._carry(segment)
            elif segment.kind == "push":
                self._slide(segment)
            elif self._hold:
                self._put_down(segment)
            self._contacts.check(segment, step.object, self._world, self._hold)
            self._room.measure(segment, step.object, self._world, self._hold)
        if self._hold:
            self._report.add("release", step.where, f"{step.object} is still held at the end")
            self._put_down(step.segments[-1])
        if not self._moved:
            self._report.add("hold", step.where, f"{step.object} is never held")
            if step.object in self._world.standing:
                hold_rules.check_same_pose(
                    step.object,
                    self._world.standing[step.object],
                    step.placed,
                    "release",
                    "`placed`, and was never held",
                    self._world,
                    step.where,
                    self._report,
                )

    def _carry(self, segment: Segment) -> None:
        step, world, robot, report = self._step, self._world, self._robot, self._report
        attached, where = segment.attached, segment.where
        if attached["object"] != step.object:
            raise PlanError(f"{where}: holds {attached['object']!r}, the step is {step.object}'s")
        tool_from_object = hold_rules.tool_from_object(attached, robot, where)
        postures = robot.place(robot.values(segment.rows, segment.gripper))
        at = postures.link(attached["tool"]) @ tool_from_object
        if self._hold is None:
            self._pick_up(at[0], attached["tool"], tool_from_object, where)
        else:
            off = poses.largest_shift(self._last, at[0], world.objects[step.object].corners())
            if off > 1e-5:
                report.add("hold", where, f"{step.object} slips by {off * 1e3:.3f} mm in the hand")
            self._hold.tool, self._hold.tool_from_object = attached["tool"], tool_from_object
        self._last = at[-1]
        hold_rules.check_reach(step.object, at, robot, postures, world, where, report)

    def _slide(self, segment: Segment) -> None:
        """The object goes with the hand; all push segments are judged at the first."""
        step, robot, world, report = self._step, self._robot, self._world, self._report
        postures = robot.place(robot.values(segment.rows, segment.gripper))
        pushing = [s for s in step.segments if s.kind == "push"]
        if any(s.attached is not None for s in pushing):
            raise PlanError(f"{step.where}: held in some push segments only")
        if self._hold is None:
            rows = np.concatenate([s.rows for s in pushing])
            gripper = {k: np.concatenate([s.gripper[k] for s in pushing]) for k in segment.gripper}
            ends = np.cumsum([0.0] + [s.times[-1] for s in pushing])
            times = np.concatenate([s.times + t for s, t in zip(pushing, ends)])
            every = robot.place(robot.values(rows, gripper))
            where = segment.where
            push = push_rules.begin(step, step.push, robot.tool, every, world, where, report)
            push_rules.check_line(push, every, where, report)
            push_rules.check_hand(push, every, robot, world, where, report)
            push_rules.check_braking(push, every, times, world, where, report)
            push_rules.check_way(push, world, where, report)
            self._hold, self._moved = push, True
        self._hold.furthest = self._pushed_to
        self._pushed_to = max(self._pushed_to, float(self._hold.along(postures).max()))
        # That it comes there is judged above; it may turn about itself.
        self._last = step.placed

    def _pick_up(self, at, tool: str, tool_from_object, where: str) -> None:
        step, world, report = self._step, self._world, self._report
        stood = world.standing[step.object]
        hold_rules.check_same_pose(
            step.object, at, stood, "attach", "where it stood", world, where, report
        )
        carriers = world.carriers(step.object, stood)
        del world.standing[step.object]
        for name, pose in world.standing.items():
            carried = world.carriers(name, pose) or world.place_under(name, pose)
            if not carried:
                report.add("support", where, f"nothing carries {name} once {step.object} is taken")
        hold_rules.check_balance(world, f"once {step.object} is taken", where, report)
        self._hold = Hold(
            step.object,
            tool,
            tool_from_object,
            stood,
            step.placed,
            carriers,
            world.carriers(step.object, step.placed),
            step.action == "push",
        )
        self._moved = True

    def _put_down(self, segment: Segment) -> None:
        step, world, report, hold = self._step, self._world, self._report, self._hold
        where = segment.where
        hold_rules.check_same_pose(
            step.object, self._last, step.placed, "release", "`placed`", world, where, report
        )
        before = None if self._anywhere else hold.carriers_before
        hold_rules.check_placed(step.object, step.placed, before, world, where, report)
        hold_rules.check_standing(step.object, step.placed, world, where, report)
        world.standing[step.object] = step.placed
        hold_rules.check_balance(world, f"once {step.object} is put down", where, report)
        self._hold = None


def _check_removed(plan: dict, world: World, goal: str | None, report: Report) -> None:
    """`removed` is the steps' objects in order (an object of several steps once, or each time);
    without a goal of the plan's own the target last; the lower bound is no larger."""
    removed, moved = plan["removed"], [step["object"] for step in plan["steps"]]
    orders = (moved, list(dict.fromkeys(moved)), list(dict.fromkeys(moved[::-1]))[::-1])
    if removed not in orders:
        report.add("removed", "plan", f"removed is {removed}, the steps move {moved}")
    last = not removed or removed[-1] != world.target or moved[-1:] != [world.target]
    if last and goal is None:
        report.add("removed", "plan", f"the target {world.target} is not the last to be removed")
    bound = plan.get("lower_bound")
    if bound and bound["removed"] > len(removed):
        text = f"lower_bound.removed is {bound['removed']}, the plan removes {len(removed)}"
        report.add("bound", "plan", text)


def _check_region(region: dict | None, robot: Robot, segments: list[Segment], report) -> None:
    """A mobile base (the joints below the root: slide, slide, turn) stays in `region`."""
    if region is None:
        return
    base = robot.tree.root
    for kinds in (("prismatic",), ("prismatic",), ("revolute", "continuous")):
        below = [j for j in robot.tree.joints.values() if j.parent == base and j.kind in kinds]
        if len(below) != 1 or below[0].name not in robot.joints:
            report.add("region", "plan", "scene.robot.region is given, but the base does not drive")
            return
        base = below[0].child
    low, high = np.asarray(region["min"], float), np.asarray(region["max"], float)
    for segment in segments:
        at = robot.place(robot.values(segment.rows, segment.gripper)).link(base)[:, :2, 3]
        out = np.maximum(low - at, at - high).max(axis=1)
        if out.max() > tolerances.LIMIT_SLACK:
            text = f"row {int(out.argmax())}: the base is {out.max():.4f} m out of its region"
            report.add("region", segment.where, text)
