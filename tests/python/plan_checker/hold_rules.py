"""Rules about what the hand holds and where it is put down."""

import numpy as np

from . import balance, poses, tolerances
from .distance import bodies_apart
from .robot import Postures, Robot
from .violations import PlanError, Report
from .world import World


def tool_from_object(attached: dict, robot: Robot, where: str) -> np.ndarray:
    """The 4×4 pose in `attached`."""
    if attached["tool"] not in robot.parts:
        raise PlanError(f"{where}: tool {attached['tool']!r} is no link of the URDF")
    return poses.from_keys(attached["pose_in_tool"])


def check_reach(
    name: str, at: np.ndarray, robot: Robot, postures: Postures, world: World, where, report: Report
) -> None:
    """At the segment's first and last row, a hand link is within 5 mm of the held object.

    `at`: n×4×4, world from object.
    """
    body = world.objects[name]
    for row, label in ((0, "at its beginning"), (len(postures) - 1, "at its end")):
        nearest = min(
            (
                bodies_apart(robot.parts[link], postures.link(link)[row], body.parts, at[row])
                for link in robot.hand_links
            ),
            default=np.inf,
        )
        if nearest > tolerances.HOLD_REACH + tolerances.DISTANCE_SLACK:
            text = f"{name} is held, but {nearest * 1e3:.2f} mm from the hand {label}"
            report.add("hold", where, text)


def check_same_pose(name, found, wanted, rule: str, what: str, world: World, where, report) -> None:
    """No point of the object is more than 1 mm off."""
    off = poses.largest_shift(found, wanted, world.objects[name].corners())
    if off > tolerances.POSE_MATCH:
        report.add(rule, where, f"{name} is {off * 1e3:.2f} mm off {what}")


def check_placed(name, placed, carried_by, world: World, where: str, report: Report) -> None:
    """Upright, resting, and in a place or on what carried it (None: on anything). `placed`: world
    from object."""
    start = world.objects[name].start
    cosine = np.clip(placed[2, :3] @ start[2, :3], -1.0, 1.0)
    tilt = float(np.arctan2(np.linalg.norm(np.cross(placed[2, :3], start[2, :3])), cosine))
    if tilt > tolerances.UPRIGHT:
        report.add("placed", where, f"{name} is put down tilted by {tilt:.4f} rad")
    if carried_by is None:
        return
    carriers = world.carriers(name, placed)
    if world.place_under(name, placed) or {c[0] for c in carriers} & {c[0] for c in carried_by}:
        return
    low, high = world.objects[name].bounds(placed)
    over = [
        place
        for place in world.places
        if np.all(high[:2] > place.low) and np.all(low[:2] < place.high)
    ]
    if not over:
        text = f"{name} is put down outside every place and off what carried it"
    elif all(abs(low[2] - place.z) > tolerances.RESTING for place in over):
        gap = min((low[2] - place.z for place in over), key=abs)
        text = f"{name} does not rest: its underside is {gap * 1e3:+.2f} mm from the place"
    else:
        text = f"{name}'s footprint sticks out of the place {over[0].id}"
    report.add("placed", where, text)


def check_standing(name: str, at: np.ndarray, world: World, where: str, report: Report) -> None:
    """A standing object is carried by something and touches nothing else."""
    contacts = world.contacts(name, at)
    for other, _, apart, carries in contacts:
        allowed = tolerances.RESTING if carries else tolerances.TOUCHING
        if -apart > allowed + tolerances.DISTANCE_SLACK:
            report.add("touch", where, f"{name} stands in {other}: {-apart * 1e3:.2f} mm deep")
    if not any(c[3] for c in contacts) and not world.place_under(name, at):
        report.add("support", where, f"nothing carries {name}")


def check_balance(world: World, when: str, where: str, report: Report) -> None:
    """What stands does not fall."""
    for group in balance.balance_of(world).falling(tolerances.BALANCE):
        report.add("unstable", where, f"{', '.join(sorted(group))} would fall {when}")
