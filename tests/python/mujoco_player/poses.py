"""Poses as 4×4 matrices, from the keys of plan files and URDF and to those of MJCF."""

import mujoco
import numpy as np


def pose(rotation, position) -> np.ndarray:
    """From a 3×3 rotation and a position."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = position
    return matrix


def turn(axis, angle: float) -> np.ndarray:
    """The rotation by `angle` about `axis`, of any length but nothing."""
    quaternion, matrix = np.zeros(4), np.zeros(9)
    unit = np.asarray(axis, float) / np.linalg.norm(axis)
    mujoco.mju_axisAngle2Quat(quaternion, unit, angle)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def from_rpy(rpy) -> np.ndarray:
    """URDF's fixed axes: about x, then y, then z."""
    roll, pitch, yaw = rpy
    return turn((0, 0, 1), yaw) @ turn((0, 1, 0), pitch) @ turn((1, 0, 0), roll)


def from_keys(keys: dict | None) -> np.ndarray:
    """From `position` and `rpy` or `quaternion` (x, y, z, w), all of which may be left out."""
    keys = keys or {}
    if (quaternion := keys.get("quaternion")) is not None:
        x, y, z, w = np.asarray(quaternion, float) / np.linalg.norm(quaternion)
        matrix = np.zeros(9)
        mujoco.mju_quat2Mat(matrix, np.array([w, x, y, z]))
        rotation = matrix.reshape(3, 3)
    else:
        rotation = from_rpy(keys.get("rpy") or (0.0, 0.0, 0.0))
    return pose(rotation, keys.get("position") or (0.0, 0.0, 0.0))


def quaternion_of(matrix: np.ndarray) -> np.ndarray:
    """MuJoCo's order: w, x, y, z."""
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(matrix[:3, :3]).ravel())
    return quaternion


def words(values) -> str:
    """Numbers as MJCF has them."""
    return " ".join(f"{value:.12g}" for value in values)


def attributes(matrix: np.ndarray) -> dict[str, str]:
    """`pos` and `quat` of an MJCF element."""
    return {"pos": words(matrix[:3, 3]), "quat": words(quaternion_of(matrix))}
