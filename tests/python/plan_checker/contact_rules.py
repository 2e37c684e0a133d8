"""Rules about touching during a segment: links, the held object, and what stands."""

from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from . import poses, tolerances
from .robot import Postures, Robot
from .sweep import Mover, Still, Touch, against_movers, against_still
from .timing import Segment
from .violations import Report
from .world import World

GRIPPING = ("approach", "grasp", "transfer", "release", "retreat", "push")
"""Kinds in which the hand's links may touch the object of the step."""
_CHUNK = 4000
"""Postures looked at together: bounds memory."""


@dataclass
class Hold:
    """What the hand holds during a segment. `stood`, `placed`: world from object."""

    object: str
    tool: str
    tool_from_object: np.ndarray
    stood: np.ndarray
    placed: np.ndarray
    carriers_before: set = field(default_factory=set)
    carriers_after: set = field(default_factory=set)
    pushed: bool = False

    def world_from_object(self, postures: Postures) -> np.ndarray:
        return postures.link(self.tool) @ self.tool_from_object

    def forgiven(self, at: np.ndarray, carrier: tuple[str, int]) -> np.ndarray | None:
        """Overlap allowed at each of n poses with this part of a body: 1 mm near where the part
        carried the object or will carry it, all along a push."""
        near = np.zeros(len(at), bool)
        for carriers, pose in (
            (self.carriers_before, self.stood),
            (self.carriers_after, self.placed),
        ):
            if carrier in carriers:
                away = np.linalg.norm(at[:, :3, 3] - pose[:3, 3], axis=1)
                near |= (away <= tolerances.LIFT_OFF) | self.pushed
        if not near.any():
            return None
        return np.where(near, tolerances.RESTING, tolerances.TOUCHING)


class ContactRules:
    """Holds what stays the same over the plan: the robot and the pairs to check."""

    def __init__(self, robot: Robot, unchecked_pairs: list, report: Report, fast: bool) -> None:
        self._robot, self._report, self._fast = robot, report, fast
        unchecked = {frozenset(pair) for pair in unchecked_pairs}
        shaped = [link for link in robot.tree.links() if robot.parts[link]]
        self._pairs = [p for p in combinations(shaped, 2) if frozenset(p) not in unchecked]
        self._hand = set(robot.hand_links)
        self.postures_checked = 0

    def check(self, segment: Segment, step_object: str, world: World, hold: Hold | None) -> None:
        """Every row, and, unless fast, sub-steps in which nothing moves more than 2 mm."""
        robot = self._robot
        at_rows = robot.place(robot.values(segment.rows, segment.gripper))
        shares = self._sub_steps(at_rows, world, hold)
        self.postures_checked += len(shares)
        stills = [
            Still(body.id, index, part, at @ part.body_from_part)
            for body, at in world.still(leave_out=(hold.object,) if hold else ())
            for index, part in enumerate(body.parts)
        ]
        worst: dict[tuple[str, str], tuple[float, float, Touch]] = {}
        for start in range(0, len(shares), _CHUNK):
            chunk = shares[start : start + _CHUNK]
            postures = at_rows
            if len(shares) != len(at_rows):
                postures = robot.place(_between(robot, segment, chunk))
            for first, second, touch in self._touches(
                postures, segment, step_object, stills, world, hold
            ):
                pair = (first, second)
                known = worst.get(pair)
                if known is None or touch.depth > known[2].depth:
                    begun = known[0] if known else chunk[touch.first]
                    worst[pair] = (begun, chunk[touch.deepest], touch)
        for (first, second), (begun, deepest, touch) in worst.items():
            time = float(np.interp(begun, np.arange(len(segment.times)), segment.times))
            text = (
                f"{first} touches {second} from row {begun:.1f} ({time:.3f} s), "
                f"{touch.depth * 1e3:.2f} mm deep at row {deepest:.1f}"
            )
            self._report.add("touch", segment.where, text)

    def _sub_steps(self, at_rows: Postures, world: World, hold: Hold | None) -> np.ndarray:
        """Row numbers, with fractions, at which to look."""
        count = len(at_rows)
        if self._fast or count == 1:
            return np.arange(count, dtype=float)
        moved = np.zeros(count - 1)
        for link, parts in self._robot.parts.items():
            for part in parts:
                corners = poses.apply(part.body_from_part, part.corners)
                points = poses.apply(at_rows.link(link), corners)
                moved = np.maximum(moved, _strides(points))
        if hold:
            points = poses.apply(
                hold.world_from_object(at_rows), world.objects[hold.object].corners()
            )
            moved = np.maximum(moved, _strides(points))
        shares = [
            row + np.arange(pieces) / pieces
            for row, pieces in enumerate(
                np.maximum(1, np.ceil(moved / tolerances.SUB_STEP)).astype(int)
            )
        ]
        return np.concatenate([*shares, [count - 1.0]])

    def _touches(self, postures, segment: Segment, step_object: str, stills, world: World, hold):
        """Yields (name, name, Touch)."""
        robot, hand = self._robot, self._hand
        gripping = segment.kind in GRIPPING
        links = {
            link: [Mover(link, part, postures.link(link) @ part.body_from_part) for part in parts]
            for link, parts in robot.parts.items()
            if parts
        }

        def may_meet(mover: Mover, still: Still) -> bool:
            if still.owner in world.fixtures:
                return mover.owner in robot.mounted
            return gripping and still.owner == step_object and mover.owner in hand

        movers = [mover for group in links.values() for mover in group]
        for mover, still, touch in against_still(movers, stills, may_meet):
            yield mover.owner, still.owner, touch
        pairs = [(a, b) for x, y in self._pairs for a in links[x] for b in links[y]]
        for first, second, touch in against_movers(pairs):
            yield first.owner, second.owner, touch
        if hold is None:
            return
        at = hold.world_from_object(postures)
        held = [
            Mover(hold.object, part, at @ part.body_from_part)
            for part in world.objects[hold.object].parts
        ]

        def forgiven(_mover: Mover, still: Still):
            return hold.forgiven(at, (still.owner, still.index))

        for mover, still, touch in against_still(held, stills, lambda *_: False, forgiven):
            yield mover.owner, still.owner, touch
        free = gripping and hold.object == step_object
        others = [mover for mover in movers if not (free and mover.owner in hand)]
        for first, second, touch in against_movers([(a, b) for a in others for b in held]):
            yield first.owner, second.owner, touch


def _strides(points: np.ndarray) -> np.ndarray:
    """Metres moved by the farthest-moving of k points between neighbours of n×k×3."""
    return np.linalg.norm(np.diff(points, axis=0), axis=-1).max(axis=1)


def _between(robot: Robot, segment: Segment, shares: np.ndarray) -> dict[str, np.ndarray]:
    """Joint values on the straight lines between rows; `shares` are row numbers with fractions."""
    numbers = np.arange(len(segment.times))
    rows = np.stack(
        [np.interp(shares, numbers, segment.rows[:, i]) for i in range(segment.rows.shape[1])], 1
    )
    gripper = {name: np.interp(shares, numbers, v) for name, v in segment.gripper.items()}
    return robot.values(rows, gripper)
