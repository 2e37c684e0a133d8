"""Touching along a motion: boxes first, in NumPy; then exact distances, only where they matter.

Between two checks of a pair, its parts approach each other by no more than the farthest-moving
corner of the box round one of them moves, seen from the other. So after a distance d, every
posture within d of travel is known to be clear and is skipped: nothing is lost by it.
"""

from dataclasses import dataclass

import numpy as np

from . import poses, tolerances
from .distance import signed_distance
from .shapes import Part

_STILL_BAD = 60
"""Exact checks spent on one pair after its first violation, to find how deep it gets."""


@dataclass
class Mover:
    """A part that moves: `at` is n×4×4, world from part; `owner` a link or an object."""

    owner: str
    part: Part
    at: np.ndarray

    def __post_init__(self) -> None:
        self.low, self.high = self.part.loose_bounds(self.at)
        self.travel = travel(self.at, self.part.corners)


@dataclass
class Still:
    """A part that stands: `at` is 4×4, world from part; `owner` a fixture or an object."""

    owner: str
    index: int
    part: Part
    at: np.ndarray

    def __post_init__(self) -> None:
        self.low, self.high = self.part.bounds(self.at)


@dataclass(frozen=True)
class Touch:
    """The first row of too deep an overlap, and the deepest found (metres, positive)."""

    first: int
    deepest: int
    depth: float


def travel(at: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Metres travelled up to each of n poses by the farthest-moving corner of each stride."""
    points = poses.apply(at, corners)
    strides = np.linalg.norm(np.diff(points, axis=0), axis=-1).max(axis=1)
    return np.concatenate([[0.0], np.cumsum(strides)])


def _boxes_meet(mover: Mover, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The rows in which the box round a mover meets another box (or that of each row)."""
    return np.flatnonzero(np.all(mover.low <= high, axis=1) & np.all(mover.high >= low, axis=1))


def _follow(distance_at, candidates: np.ndarray, travelled: np.ndarray, allowed) -> Touch | None:
    """Walks the candidate rows of one pair, skipping what the last distance clears."""
    least = tolerances.TOUCHING if np.ndim(allowed) == 0 else float(np.min(allowed))
    first = deepest = None
    depth, spent, position = 0.0, 0, 0
    while position < len(candidates) and spent < _STILL_BAD:
        row = int(candidates[position])
        distance = distance_at(row)
        limit = allowed if np.ndim(allowed) == 0 else allowed[row]
        if -distance > limit + tolerances.DISTANCE_SLACK:
            first = row if first is None else first
            if -distance > depth:
                deepest, depth = row, -distance
        spent += first is not None
        clear = travelled[row] + max(distance + least, 0.0)
        jump = np.searchsorted(travelled[candidates], clear, side="right")
        position = max(position + 1, int(jump) if distance + least > 0.0 else 0)
    return None if first is None else Touch(first, deepest, depth)


def against_still(movers: list[Mover], stills: list[Still], skip, allowed=None):
    """Yields (mover, still, touch). `skip(mover, still)` names pairs that may meet; `allowed`
    gives the overlap forgiven at each row (n), or None for the usual."""
    if not stills:
        return
    lows, highs = np.array([s.low for s in stills]), np.array([s.high for s in stills])
    for mover in movers:
        near = np.all(mover.low.min(0) <= highs, axis=1) & np.all(mover.high.max(0) >= lows, axis=1)
        for index in np.flatnonzero(near):
            still = stills[index]
            if skip(mover, still):
                continue
            candidates = _boxes_meet(mover, still.low, still.high)
            if not len(candidates):
                continue
            forgiven = allowed(mover, still) if allowed else None
            touch = _follow(
                lambda row: signed_distance(mover.part, mover.at[row], still.part, still.at),
                candidates,
                mover.travel,
                tolerances.TOUCHING if forgiven is None else forgiven,
            )
            if touch:
                yield mover, still, touch


def against_movers(pairs):
    """Yields (first, second, touch) for the pairs of movers given."""
    for first, second in pairs:
        candidates = _boxes_meet(first, second.low, second.high)
        if not len(candidates):
            continue
        large, small = (
            (first, second) if first.part.half.max() >= second.part.half.max() else (second, first)
        )
        travelled = travel(poses.inverse(large.at) @ small.at, small.part.corners)
        touch = _follow(
            lambda row: signed_distance(first.part, first.at[row], second.part, second.at[row]),
            candidates,
            travelled,
            tolerances.TOUCHING,
        )
        if touch:
            yield first, second, touch
