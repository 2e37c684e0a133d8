"""Rules about rows alone: shapes of arrays, times, limits, rates, continuity, the gripper.

Velocity and acceleration are finite differences over the whole plan: segments follow one another
without a break, and the robot is at rest before the first row and after the last. The mean
velocity between two rows never exceeds the true peak, and the difference of two neighbouring means
over the time between their middles never exceeds the peak acceleration, so a plan within its
limits passes; `tolerances.RATE_SLACK` is relative. So do third divided differences, times six, where
the plan has limits of jerk; both ends count three times, to see accelerations that jump there.
"""

from dataclasses import dataclass

import numpy as np

from . import tolerances
from .robot import Robot
from .violations import PlanError, Report

KINDS = ("transit", "approach", "grasp", "transfer", "release", "retreat", "push")
GRIPPER_MOVES = ("grasp", "release")


@dataclass
class Segment:
    """A segment as arrays: `times` (n, s), `rows` (n×joints), `gripper` (n for each joint)."""

    where: str
    kind: str
    times: np.ndarray
    rows: np.ndarray
    gripper: dict[str, np.ndarray]
    attached: dict | None


def read_segment(keys: dict, columns: int, where: str) -> Segment:
    """Checks shapes and finiteness; anything else is a `PlanError`."""
    times, rows = np.asarray(keys["times"], float), np.asarray(keys["positions"], float)
    if keys["kind"] not in KINDS:
        raise PlanError(f"{where}: unknown kind {keys['kind']!r}")
    if times.ndim != 1 or len(times) == 0 or rows.shape != (len(times), columns):
        raise PlanError(
            f"{where}: {times.shape} times and {rows.shape} positions for {columns} joints"
        )
    gripper = {}
    for joint, value in (keys.get("gripper") or {}).items():
        values = np.asarray(value, float)
        if values.ndim == 0:
            values = np.full(len(times), float(values))
        if values.shape != times.shape:
            raise PlanError(f"{where}: gripper {joint} has {values.shape} values")
        gripper[joint] = values
    if not all(np.isfinite(a).all() for a in (times, rows, *gripper.values())):
        raise PlanError(f"{where}: a value is not finite")
    return Segment(where, keys["kind"], times, rows, gripper, keys.get("attached"))


def check_rows(segments: list[Segment], robot: Robot, start: dict[str, float], report: Report):
    """Every rule of this module, over all segments in order."""
    _check_start(segments[0], robot, start, report)
    for segment in segments:
        _check_times(segment, report)
        _check_positions(segment, robot, report)
        _check_gripper(segment, robot, report)
    for before, after in zip(segments, segments[1:]):
        _check_border(before, after, robot, report)
    _check_rates(segments, robot, report)


def _check_start(first: Segment, robot: Robot, start: dict[str, float], report: Report) -> None:
    for name in start:
        if name not in robot.tree.joints:
            report.add("start", "plan", f"the start names {name}, which is not in the URDF")
    row = dict(zip(robot.joints, first.rows[0]))
    row.update({joint: values[0] for joint, values in first.gripper.items()})
    for name, value in row.items():
        joint = robot.tree.joints.get(name)
        if joint is None or (name in first.gripper and name not in start):
            continue
        wanted = start.get(name, float(np.clip(0.0, joint.lower, joint.upper)))
        if abs(value - wanted) > tolerances.CONTINUITY:
            text = f"{name} starts at {value:.6f}, the scene's start is {wanted:.6f}"
            report.add("start", first.where, text)


def _check_times(segment: Segment, report: Report) -> None:
    if segment.times[0] != 0.0:
        report.add("times", segment.where, f"times start at {segment.times[0]}, not 0")
    gaps = np.diff(segment.times)
    if np.any(gaps <= 0.0):
        row = int(np.argmax(gaps <= 0.0)) + 1
        report.add("times", segment.where, f"row {row}: time does not rise")
    if np.any(gaps > tolerances.ROW_SPACING + 1e-9):
        row = int(np.argmax(gaps))
        text = f"rows {row} and {row + 1} are {gaps[row]:.4f} s apart, at most 0.02 allowed"
        report.add("times", segment.where, text)


def _check_limit(values: np.ndarray, joint, where: str, report: Report) -> None:
    excess = np.maximum(values - joint.upper, joint.lower - values)
    row = int(np.argmax(excess))
    if excess[row] > tolerances.LIMIT_SLACK:
        text = (
            f"row {row}: {joint.name} at {values[row]:.6f}, [{joint.lower}, {joint.upper}] allowed"
        )
        report.add("limits", where, text)


def _check_positions(segment: Segment, robot: Robot, report: Report) -> None:
    for column, name in enumerate(robot.joints):
        _check_limit(segment.rows[:, column], robot.tree.joints[name], segment.where, report)


def _check_gripper(segment: Segment, robot: Robot, report: Report) -> None:
    for name, values in segment.gripper.items():
        joint = robot.tree.joints.get(name)
        if joint is None or name in robot.joints:
            report.add("gripper", segment.where, f"{name} is no joint of the gripper")
            continue
        _check_limit(values, joint, segment.where, report)
        if segment.kind not in GRIPPER_MOVES and np.ptp(values) > tolerances.CONTINUITY:
            text = f"{name} moves by {np.ptp(values):.6f} in a {segment.kind}"
            report.add("gripper", segment.where, text)


def _check_border(before: Segment, after: Segment, robot: Robot, report: Report) -> None:
    jumps = np.abs(after.rows[0] - before.rows[-1])
    worst = int(np.argmax(jumps))
    if jumps[worst] > tolerances.CONTINUITY:
        text = f"{robot.joints[worst]} jumps by {jumps[worst]:.6f} from the segment before"
        report.add("continuity", after.where, text)
    for name in before.gripper.keys() | after.gripper.keys():
        if name not in before.gripper or name not in after.gripper:
            report.add("gripper", after.where, f"{name} is given in some segments only")
        elif abs(after.gripper[name][0] - before.gripper[name][-1]) > tolerances.CONTINUITY:
            text = f"{name} jumps from {before.gripper[name][-1]} to {after.gripper[name][0]}"
            report.add("gripper", after.where, text)


def _check_rates(segments: list[Segment], robot: Robot, report: Report) -> None:
    rated = list(robot.joints)
    rated += [j for j in segments[0].gripper if j in robot.limits["velocity"]]
    for name in rated:
        top = robot.limits["velocity"].get(name)
        hard = robot.limits["acceleration"].get(name)
        joint = robot.tree.joints.get(name)
        if top is None or (hard is None and name in robot.joints):
            report.add("velocity", "plan", f"robot.limits has no entry for {name}")
            continue
        if joint and top > joint.velocity * (1.0 + 1e-9):
            text = f"robot.limits allows {name} {top}, the URDF {joint.velocity}"
            report.add("velocity", "plan", text)
        sudden = robot.limits.get("jerk")
        if sudden is not None and name in robot.joints and name not in sudden:
            report.add("jerk", "plan", f"robot.limits.jerk has no entry for {name}")
        limits = top, np.inf if hard is None else hard, (sudden or {}).get(name, np.inf)
        _check_rates_of(name, limits, segments, robot, report)


def _check_rates_of(name, limits, segments, robot: Robot, report: Report) -> None:
    """One joint: strides of all segments in one row, at rest before and after."""
    top, hard, sudden = limits
    steps, gaps, places = [], [], []
    for segment in segments:
        if name in robot.joints:
            values = segment.rows[:, robot.joints.index(name)]
        elif name in segment.gripper:
            values = segment.gripper[name]
        else:
            return
        steps.append(np.diff(values))
        gaps.append(np.diff(segment.times))
        places += [(segment.where, row) for row in range(len(values) - 1)]
    steps, gaps = np.concatenate(steps), np.concatenate(gaps)
    usable = gaps > 0.0
    steps, gaps = steps[usable], gaps[usable]
    places = [place for place, use in zip(places, usable) if use]
    if not len(gaps):
        return
    rates = steps / gaps
    row = int(np.argmax(np.abs(rates)))
    if abs(rates[row]) > top * (1.0 + tolerances.RATE_SLACK) + 1e-9:
        text = f"row {places[row][1]}: {name} at {rates[row]:.4f}/s, {top} allowed"
        report.add("velocity", places[row][0], text)
    rates = np.concatenate([[0.0], rates, [0.0]])
    gaps = np.concatenate([[0.0], gaps, [0.0]])
    accelerations = np.diff(rates) / ((gaps[1:] + gaps[:-1]) / 2)
    row = int(np.argmax(np.abs(accelerations)))
    if abs(accelerations[row]) > hard * (1.0 + tolerances.RATE_SLACK) + 1e-9:
        where, at = places[min(row, len(places) - 1)]
        end = " (at rest at both ends)" if row in (0, len(accelerations) - 1) else ""
        text = f"row {at}: {name} at {accelerations[row]:.3f}/s², {hard} allowed{end}"
        report.add("acceleration", where, text)
    rates = np.concatenate([[0.0], rates, [0.0]])
    gaps = np.concatenate([[0.0], gaps, [0.0]])
    pairs = gaps[1:] + gaps[:-1]
    halves = np.divide(np.diff(rates), pairs, out=np.zeros(len(pairs)), where=pairs > 0.0)
    jerks = np.abs(6.0 * np.diff(halves) / (pairs[1:] + gaps[:-2]))
    row = int(np.argmax(jerks))
    if jerks[row] > sudden * (1.0 + tolerances.JERK_SLACK) + tolerances.JERK_ROUNDING:
        where, at = places[max(0, min(row - 1, len(places) - 1))]
        report.add("jerk", where, f"row {at}: {name} at {jerks[row]:.2f}/s³, {sudden} allowed")
