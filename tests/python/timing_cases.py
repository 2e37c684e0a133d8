"""Paths to be timed, and the geometric curve that both programs time: for `test_timing.py`."""

import numpy as np
import toppra
from toppra.interpolator import AbstractGeometricPath

ROBOTS = {
    "ur10": ([2.0943951] * 2 + [3.1415927] * 4, [8.0] * 6, [80.0] * 6),
    "panda": (
        [2.175] * 4 + [2.61] * 3,
        [15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0],
        [7500.0, 3750.0, 5000.0, 6250.0, 7500.0, 10000.0, 10000.0],
    ),
}
"""By robot: velocity, acceleration and jerk limits."""


def cases(robot: str, count: int, seed: int) -> list[dict]:
    """Random paths of 2 to 6 waypoints, 2 to 8 rad long, that lead somewhere."""
    velocity, acceleration, jerk = ROBOTS[robot]
    random, joints = np.random.default_rng(seed), len(velocity)
    result = []
    while len(result) < count:
        strides = int(random.integers(1, 6))
        steps = random.normal(size=(strides, joints))
        steps += random.uniform(0.0, 1.5) * random.normal(size=joints)
        parts = random.uniform(0.3, 1.0, strides)
        long = random.uniform(2.0, 8.0) * parts / parts.sum()
        steps *= (long / np.linalg.norm(steps, axis=1))[:, None]
        path = random.uniform(-1.5, 1.5, joints) + np.vstack([np.zeros(joints), steps.cumsum(0)])
        if np.abs(path).max() < 3.1:
            limits = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
            result.append({"path": path.tolist(), **limits})
    return result


class Cubics(AbstractGeometricPath):
    """Cubic pieces, given by the derivatives where each begins."""

    def __init__(self, knots, pieces) -> None:
        self.knots, self.pieces = np.asarray(knots), np.asarray(pieces)

    def __call__(self, path_positions, order: int = 0):
        s = np.asarray(path_positions, float)
        at = np.atleast_1d(s)
        piece = np.clip(np.searchsorted(self.knots, at, "right") - 1, 0, len(self.pieces) - 1)
        t = (at - self.knots[piece])[:, None]
        q, slope, bend, twist = np.moveaxis(self.pieces[piece], 1, 0)
        rows = (
            q + t * (slope + t * (bend / 2 + t * twist / 6)),
            slope + t * (bend + t * twist / 2),
            bend + t * twist,
        )[order]
        return rows if s.ndim else rows[0]

    @property
    def dof(self) -> int:
        return self.pieces.shape[2]

    @property
    def path_interval(self) -> np.ndarray:
        return self.knots[[0, -1]]

    @property
    def waypoints(self):
        return None


def toppra_duration(path: AbstractGeometricPath, velocity, acceleration, points: int = 400) -> float:
    """The least time that `toppra` finds, from rest to rest. It knows no limits of jerk."""
    both = [np.column_stack([-np.asarray(most), most]) for most in (velocity, acceleration)]
    limits = [
        toppra.constraint.JointVelocityConstraint(both[0]),
        toppra.constraint.JointAccelerationConstraint(both[1]),
    ]
    grid = np.linspace(*path.path_interval, points + 1)
    _, speeds, _ = toppra.algorithm.TOPPRA(limits, path, gridpoints=grid).compute_parameterization(0, 0)
    assert speeds is not None and np.isfinite(speeds).all(), "toppra found no timing"
    return float(np.sum(2.0 * np.diff(grid) / (speeds[1:] + speeds[:-1])))


def straight_duration(far: float, velocity: float, acceleration: float, jerk: float) -> float:
    """The least time for a straight line from rest to rest: the seven-segment profile."""
    v, a, j = velocity, acceleration, jerk
    rise = v / a + a / j if v * j >= a * a else 2.0 * np.sqrt(v / j)
    if far >= v * rise:
        return rise + far / v
    if far >= 2.0 * a**3 / j**2:
        return a / j + np.sqrt((a / j) ** 2 + 4.0 * far / a)
    return float(np.cbrt(32.0 * far / j))


def derivatives(times, rows) -> list[np.ndarray]:
    """Velocities, accelerations and jerks: divided differences; at rest before and after."""
    times, rows = np.asarray(times), np.asarray(rows)
    t = np.concatenate([times[:1], times[:1], times, times[-1:], times[-1:]])
    d = np.concatenate([rows[:1], rows[:1], rows, rows[-1:], rows[-1:]])
    result = []
    for order, factor in ((1, 1.0), (2, 2.0), (3, 6.0)):
        span = (t[order:] - t[:-order])[:, None]
        d = np.divide(np.diff(d, axis=0), span, out=np.zeros((len(span), rows.shape[1])), where=span > 0)
        result.append(factor * d)
    return result
