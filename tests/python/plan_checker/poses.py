"""Poses as 4×4 matrices (`a_from_b`), single or stacked along the first axis."""

import numpy as np


def pose(rotation: np.ndarray, position) -> np.ndarray:
    """The 4×4 matrix of a rotation matrix and a position (metres)."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = position
    return matrix


def rotation_from_rpy(rpy) -> np.ndarray:
    """URDF's fixed axes: about x, then y, then z (radians)."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def rotation_from_quaternion(quaternion) -> np.ndarray:
    """From `[x, y, z, w]`; the length may be off 1 by up to 1e-3."""
    q = np.asarray(quaternion, float)
    length = np.linalg.norm(q)
    if q.shape != (4,) or not abs(length - 1.0) < 1e-3:
        raise ValueError(f"not a unit quaternion: {quaternion}")
    x, y, z, w = q / length
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def from_keys(keys: dict | None) -> np.ndarray:
    """From a mapping with `position` and either `rpy` or `quaternion`, all optional."""
    keys = keys or {}
    if keys.get("quaternion") is not None:
        rotation = rotation_from_quaternion(keys["quaternion"])
    else:
        rotation = rotation_from_rpy(keys.get("rpy") or (0.0, 0.0, 0.0))
    return pose(rotation, keys.get("position") or (0.0, 0.0, 0.0))


def inverse(matrix: np.ndarray) -> np.ndarray:
    """The inverse of one pose or of a stack of them."""
    result = np.zeros_like(matrix)
    transposed = np.swapaxes(matrix[..., :3, :3], -1, -2)
    result[..., :3, :3] = transposed
    result[..., :3, 3] = -(transposed @ matrix[..., :3, 3:])[..., 0]
    result[..., 3, 3] = 1.0
    return result


def apply(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """`points` (k×3) through one pose (→ k×3) or through n of them (→ n×k×3)."""
    return points @ np.swapaxes(matrix[..., :3, :3], -1, -2) + matrix[..., None, :3, 3]


def largest_shift(first: np.ndarray, second: np.ndarray, points: np.ndarray) -> float:
    """How far the farthest-moving of `points` is between two poses (metres)."""
    return float(np.linalg.norm(apply(first, points) - apply(second, points), axis=-1).max())
