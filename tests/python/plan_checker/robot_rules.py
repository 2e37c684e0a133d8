"""Rules about the robot alone: `fixed` joints, mimics, and the pairs that go unchecked."""

import numpy as np

from . import tolerances
from .distance import bodies_apart
from .robot import Robot
from .timing import Segment
from .violations import Report


def check_fixed_and_mimics(robot: Robot, segments: list[Segment], report: Report) -> None:
    """Fixed joints within limits and given once; a mimic that is given follows its leader."""
    for name, value in robot.fixed.items():
        joint = robot.tree.joints[name]
        if name in robot.joints:
            report.add("fixed", "plan", f"{name} is in joints and in fixed")
        if not joint.moves:
            continue
        excess = max(value - joint.upper, joint.lower - value)
        if excess > tolerances.LIMIT_SLACK:
            text = f"fixed {name} at {value}, [{joint.lower}, {joint.upper}] allowed"
            report.add("limits", "plan", text)
    for segment in segments:
        values = robot.values(segment.rows, segment.gripper)
        given = {name: np.full(len(segment.rows), v) for name, v in robot.fixed.items()}
        given.update({name: segment.rows[:, i] for i, name in enumerate(robot.joints)})
        given.update(segment.gripper)
        for joint in robot.moving:
            if joint.mimic is None or joint.name not in given:
                continue
            off = float(np.abs(given[joint.name] - values[joint.name]).max())
            if off > tolerances.CONTINUITY:
                text = f"{joint.name} is {off:.6f} off what it mimics, {joint.mimic.joint}"
                report.add("mimic", segment.where, text)


def adjacent(robot: Robot, first: str, second: str) -> bool:
    """Joined by one joint, or by several with nothing but links without shapes between."""
    for low, high in ((first, second), (second, first)):
        for joint in robot.tree.chain(low):
            if joint.parent == high:
                return True
            if robot.parts[joint.parent]:
                break
    return False


def hand_of(robot: Robot) -> set[str]:
    """`hand.links`, and every link that hangs on one of them (knuckles, frames)."""
    named = set(robot.hand_links)
    return named | {
        link
        for link in robot.tree.links()
        if any(joint.parent in named for joint in robot.tree.chain(link))
    }


def check_unchecked_pairs(robot: Robot, pairs: list, report: Report) -> None:
    """Each pair is adjacent, of the hand, or touches in most postures drawn uniformly.

    The share is an estimate from `POSTURES` draws: only one that is three standard deviations
    below the contract's 70 % is reported.
    """
    hand, doubtful = hand_of(robot), []
    for first, second in pairs:
        unknown = [link for link in (first, second) if link not in robot.parts]
        if unknown:
            report.add("unchecked", "plan", f"{unknown[0]} is no link of the URDF")
        elif robot.parts[first] and robot.parts[second] and first != second:
            if not adjacent(robot, first, second) and not {first, second} <= hand:
                doubtful.append((first, second))
    if not doubtful:
        return
    postures = robot.place(_uniform(robot))
    count = len(postures)
    sure = tolerances.ALWAYS_TOUCHING
    sure -= 3.0 * np.sqrt(sure * (1.0 - sure) / count)
    for first, second in doubtful:
        at, to = postures.link(first), postures.link(second)
        touching = sum(
            bodies_apart(robot.parts[first], at[i], robot.parts[second], to[i])
            < -tolerances.TOUCHING
            for i in range(count)
        )
        if touching < sure * count:
            text = f"{first} and {second} go unchecked, but touch in only {touching} of {count}"
            report.add("unchecked", "plan", text + " uniform postures, and are not adjacent")


def _uniform(robot: Robot) -> dict[str, np.ndarray]:
    """Every free joint uniform within its limits (a full turn if it has none)."""
    draw = np.random.default_rng(20240229)
    free = {}
    for joint in robot.moving:
        if joint.name in robot.joints or (joint.mimic is None and joint.name not in robot.fixed):
            endless = not np.isfinite(joint.lower)
            low, high = (-np.pi, np.pi) if endless else (joint.lower, joint.upper)
            free[joint.name] = draw.uniform(low, high, tolerances.POSTURES)
    columns = [free.pop(name) for name in robot.joints]
    rows = np.stack(columns, axis=1) if columns else np.zeros((tolerances.POSTURES, 0))
    return robot.values(rows, free)
