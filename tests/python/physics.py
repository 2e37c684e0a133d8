"""What falls, by MuJoCo: a scene's fixtures stand still, its objects are free, of one density."""

import math

import mujoco
import numpy as np

DENSITY = 700.0
"""Of every object, kg/m³; what stands or falls does not depend on it."""
STEP = 0.002
SECONDS = 2.0
STILL, UPRIGHT = 3e-3, 1.0
"""Metres and degrees by which what stands may move."""


def _vector(values) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _geom(keys: dict, friction: float) -> str:
    """The one shape of a body; x, y and z turn as in URDF."""
    if box := keys.get("box"):
        shape = f'type="box" size="{_vector(np.asarray(box["size"]) / 2)}"'
    else:
        cylinder = keys["cylinder"]
        size = (cylinder["radius"], cylinder["height"] / 2)
        shape = f'type="cylinder" size="{_vector(size)}"'
    stiff = 'solref="0.004 1" solimp="0.95 0.99 0.0002"'
    return f'<geom {shape} density="{DENSITY}" friction="{friction} 0.005 0.0001" {stiff}/>'


def _body(keys: dict, free: bool, friction: float) -> str:
    joint = "<freejoint/>" if free else ""
    pose = f'pos="{_vector(keys["position"])}"'
    if turn := keys.get("quaternion"):
        pose += f' quat="{_vector((turn[3], *turn[:3]))}"'
    elif turn := keys.get("rpy"):
        pose += f' euler="{_vector(turn)}"'
    return f'<body name="{keys["id"]}" {pose}>{joint}{_geom(keys, friction)}</body>'


def world(scene: dict, friction: float = 1.0) -> mujoco.MjModel:
    """Boxes and cylinders of a scene."""
    bodies = [_body(keys, False, friction) for keys in scene["fixtures"]]
    bodies += [_body(keys, True, friction) for keys in scene["objects"]]
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco>
          <compiler angle="radian" eulerseq="XYZ"/>
          <option timestep="{STEP}" cone="elliptic" integrator="implicitfast" impratio="10">
            <flag multiccd="enable"/>
          </option>
          <worldbody>{"".join(bodies)}</worldbody>
        </mujoco>"""
    )


def moved(scene: dict, seconds: float = SECONDS, friction: float = 1.0) -> dict:
    """By object: metres that its centre moves in so long, and degrees that it tilts."""
    model = world(scene, friction)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = [keys["id"] for keys in scene["objects"]]
    numbers = [model.body(name).id for name in names]
    at, axes = data.xpos[numbers].copy(), data.xmat[numbers].reshape(-1, 3, 3)[:, :, 2].copy()
    for _ in range(round(seconds / STEP)):
        mujoco.mj_step(model, data)
    shifts = np.linalg.norm(data.xpos[numbers] - at, axis=1)
    cosines = np.sum(data.xmat[numbers].reshape(-1, 3, 3)[:, :, 2] * axes, axis=1)
    tilts = [math.degrees(math.acos(max(-1.0, min(1.0, c)))) for c in cosines]
    return dict(zip(names, zip(shifts.tolist(), tilts, strict=True), strict=True))


def fallen(scene: dict, friction: float = 1.0) -> set[str]:
    """The objects that do not stay where they are."""
    shifts = moved(scene, friction=friction)
    return {name for name, (far, tilt) in shifts.items() if far > STILL or tilt > UPRIGHT}
