"""Rules about pushes: where the object is while the hand pushes it, and whether it would go so.

Quasi-static: the tool goes straight and level without turning; after its free way the hand meets
the object, which goes with it from then on. Only upright round bodies do not turn aside.
"""

from dataclasses import dataclass

import numpy as np

from . import hold_rules, poses, shapes, tolerances
from .contact_rules import Hold
from .distance import bodies_apart
from .robot import Postures, Robot
from .violations import Report
from .world import Body, World

_GRAVITY = 9.81
_PLACES = 5
"""Places on the way at which carriers and balance are looked at."""


@dataclass
class Push(Hold):
    """What is pushed, in place of what is held: `tool` is the link that leads, `begin` where it was
    at first (4×4), `furthest` how far it has come before the segment at hand."""

    direction: np.ndarray | None = None
    free: float = 0.0
    distance: float = 0.0
    begin: np.ndarray | None = None
    furthest: float = 0.0

    def along(self, postures: Postures) -> np.ndarray:
        """How far the tool has come at each of n postures."""
        return (postures.link(self.tool)[:, :3, 3] - self.begin[:3, 3]) @ self.direction

    def ways(self, postures: Postures) -> np.ndarray:
        """How far the object has come."""
        far = np.maximum(np.maximum.accumulate(self.along(postures)), self.furthest)
        return np.clip(far - self.free, 0.0, self.distance)

    def at_way(self, way: float) -> np.ndarray:
        moved = self.stood.copy()
        moved[:3, 3] += self.direction * way
        return moved

    def world_from_object(self, postures: Postures) -> np.ndarray:
        at = np.repeat(self.stood[None], len(postures), axis=0)
        at[:, :3, 3] += self.ways(postures)[:, None] * self.direction
        return at


def begin(step, keys: dict | None, tool: str, rows: Postures, world: World, where, report) -> Push:
    """The push of a step; `rows` are the postures of all its push segments. Without `push` in the
    plan (`keys`) the way is from where the object stood to `placed`."""
    stood, start = world.standing[step.object], rows.link(tool)[0]
    travel = rows.link(tool)[-1][:3, 3] - start[:3, 3]
    if keys:
        direction = np.asarray(keys["direction"], float)
        distance, free = float(keys["distance"]), float(keys["free"])
        if abs(np.linalg.norm(direction) - 1.0) > 1e-3 or abs(direction[2]) > 1e-3:
            report.add("push", where, f"the direction {direction} is no level unit vector")
        if not (distance >= 0.0 and free >= 0.0):
            report.add("push", where, f"goes {distance} m after {free} m")
    else:
        way = (step.placed[:3, 3] - stood[:3, 3]) * [1, 1, 0]
        distance = float(np.linalg.norm(way))
        direction = way / distance if distance > 1e-6 else travel
        free = max(0.0, float(travel @ direction) - distance)
    direction = direction * [1, 1, 0] / max(np.linalg.norm(direction[:2]), 1e-9)
    carriers = world.carriers(step.object, stood)
    push = Push(step.object, tool, np.eye(4), stood, step.placed, carriers, carriers, True)
    push.direction, push.free, push.distance, push.begin = direction, free, distance, start
    return push


def check_line(push: Push, rows: Postures, where: str, report: Report) -> None:
    """The tool goes straight, without turning, as far as is said; the object ends at `placed`."""
    tool = rows.link(push.tool)
    moved = tool[:, :3, 3] - push.begin[:3, 3]
    aside = np.linalg.norm(moved - np.outer(moved @ push.direction, push.direction), axis=1).max()
    cosine = (np.trace(tool[:, :3, :3] @ push.begin[:3, :3].T, axis1=1, axis2=2) - 1.0) / 2.0
    turned = np.arccos(np.clip(cosine, -1.0, 1.0)).max()
    far = float(push.along(rows).max()) - push.free - push.distance
    if aside > tolerances.PUSH_PLACE:
        report.add("push", where, f"the tool is {aside * 1e3:.2f} mm beside its line")
    if turned > tolerances.PUSH_TURN:
        report.add("push", where, f"the tool turns by {turned:.4f} rad")
    if abs(far) > tolerances.PUSH_PLACE:
        report.add("push", where, f"the tool goes {far * 1e3:+.2f} mm farther than is said")
    off = push.at_way(push.distance)[:3, 3] - push.placed[:3, 3]
    if np.linalg.norm(off[:2]) > tolerances.PUSH_PLACE or abs(off[2]) > tolerances.PUSH_PLACE:
        report.add("push", where, f"{push.object} ends {np.linalg.norm(off) * 1e3:.2f} mm off")
    turn = push.placed[:3, :3] @ push.stood[:3, :3].T
    tilt = np.arctan2(np.linalg.norm(turn[:2, 2]), turn[2, 2])
    if tilt > tolerances.PUSH_TURN:
        report.add("push", where, f"{push.object} is tilted by {tilt:.4f} rad")


def check_way(push: Push, world: World, where: str, report: Report) -> None:
    """The same carries it all along, and it does not fall; nothing stands on it."""
    name, before = push.object, {c[0] for c in push.carriers_before}
    world.standing[name] = push.stood
    for other, at in world.standing.items():
        if other != name and any(c[0] == name for c in world.carriers(other, at)):
            report.add("push", where, f"{other} stands on {name}")
    for way in np.linspace(0.0, push.distance, _PLACES):
        world.standing[name] = push.at_way(way)
        now = {c[0] for c in world.carriers(name, world.standing[name])}
        if now != before:
            text = f"{name} stands on {sorted(before)}, after {way:.3f} m on {sorted(now)}"
            report.add("push", where, text)
            break
        hold_rules.check_balance(world, f"pushed {way:.3f} m", where, report)
    del world.standing[name]


def check_hand(push: Push, rows: Postures, robot: Robot, world: World, where, report) -> None:
    """The hand is at the object while it moves, not in it, and not so high that it tips."""
    if push.distance < 1e-6:
        return
    body, links = world.objects[push.object], robot.hand_links
    foot, why = _foot(body, push.stood)
    if why:
        report.add("push", where, f"{push.object} may turn aside: {why}")
    low, high = body.bounds(push.stood)
    tips_at = foot / _friction(push, world)
    above = (
        _above(body, push.stood, low[2] + tips_at) if not why and high[2] > low[2] + tips_at else []
    )
    ways, at = push.ways(rows), push.world_from_object(rows)
    deepest, farthest, tips = np.inf, -np.inf, False

    def apart(parts, row, here) -> float:
        return min(
            (bodies_apart(robot.parts[k], rows.link(k)[row], parts, here) for k in links),
            default=np.inf,
        )

    for row in range(len(rows)):
        near = apart(body.parts, row, at[row])
        deepest = min(deepest, near)
        if row and ways[row] > ways[row - 1] + 1e-9:
            farthest = max(farthest, near)
            if above and not tips:
                moved = np.eye(4)
                moved[:3, 3] = at[row][:3, 3] - push.stood[:3, 3]
                tips = apart(above, row, moved) < tolerances.PUSH_NEAR - 1e-4
    if deepest < -tolerances.PUSH_DEPTH - tolerances.DISTANCE_SLACK:
        report.add("push", where, f"the hand is {-deepest * 1e3:.2f} mm inside {push.object}")
    if farthest > tolerances.PUSH_NEAR + tolerances.DISTANCE_SLACK:
        report.add("push", where, f"the hand is {farthest * 1e3:.2f} mm from {push.object}")
    if tips:
        report.add("push", where, f"{push.object} tips: pushed above {tips_at * 1e3:.1f} mm")


def check_braking(push: Push, rows: Postures, times, world: World, where: str, report) -> None:
    """The hand brakes no harder than friction does the object; after the push it is at rest.
    `times` are those of all rows."""
    along, ways, gaps = push.along(rows), push.ways(rows), np.diff(times)
    use = gaps > 0.0
    rates = np.append(np.diff(along)[use] / gaps[use], 0.0)
    moves, gaps = (np.diff(ways) > 1e-9)[use], gaps[use]
    braking = -np.diff(rates) / ((gaps + np.append(gaps[1:], gaps[-1:])) / 2)
    hardest = braking[moves].max(initial=0.0)
    most = _friction(push, world) * _GRAVITY
    if hardest > most + 0.01:
        report.add(
            "push", where, f"the hand brakes at {hardest:.2f} m/s², {most:.2f} stop the object"
        )


def _friction(push: Push, world: World) -> float:
    """The object's; of two objects the larger."""
    names = [push.object, *(c[0] for c in push.carriers_before if c[0] in world.objects)]
    return max(world.friction[name] for name in names)


def _foot(body: Body, at: np.ndarray) -> tuple[float, str]:
    """The radius of the face it stands on; why it is not round, if it is not."""
    placed = [at @ part.body_from_part for part in body.parts]
    if any(part.kind != "cylinder" for part in body.parts):
        return 0.0, "it is not made of cylinders"
    if any(np.linalg.norm(pose[:2, 2]) > tolerances.PUSH_TURN for pose in placed):
        return 0.0, "it does not stand upright"
    if any(np.linalg.norm((pose - placed[0])[:2, 3]) > 1e-4 for pose in placed):
        return 0.0, "its parts have no common axis"
    bottoms = [pose[2, 3] - part.half[2] for pose, part in zip(placed, body.parts, strict=True)]
    lowest = min(bottoms) + 1e-4
    return max(p.radius for p, z in zip(body.parts, bottoms, strict=True) if z <= lowest), ""


def _above(body: Body, at: np.ndarray, height: float) -> list[shapes.Part]:
    """What of a round body is above this height, in the world."""
    found = []
    for part in body.parts:
        pose = at @ part.body_from_part
        top, low = pose[2, 3] + part.half[2], max(pose[2, 3] - part.half[2], height)
        if top > low + 1e-6:
            middle = poses.pose(np.eye(3), [*pose[:2, 3], (top + low) / 2])
            found.append(shapes.cylinder(part.radius, top - low, middle))
    return found
