"""Position servos: torque = stiffness · (asked - is) + damping · (asked velocity - is), limited."""

import mujoco
import numpy as np

from . import settings
from .timeline import Timeline
from .world import World


class Servos:
    """Gains by the inertia that each joint moves; the hand's limited to its grip."""

    def __init__(self, world: World, line: Timeline) -> None:
        self._world = world
        arm, hand = world.drives.arm, world.drives.hand
        inertia = _largest_inertia(world, line)
        stiffness = settings.STIFFNESS**2 * inertia[: len(arm)]
        limits = [world.tree.joints[name].effort or np.inf for name in arm]
        grip = world.gap
        self.stiffness = np.concatenate([stiffness, np.full(len(hand), grip.stiffness())])
        self.damping = 2.0 * np.sqrt(self.stiffness * inertia)
        limits = np.array(limits + [grip.grip_limit()] * len(hand))
        model = world.model
        model.actuator_gainprm[:, 0] = self.stiffness
        model.actuator_biasprm[:, 1] = -self.stiffness
        model.actuator_biasprm[:, 2] = -self.damping
        limits = np.minimum(limits, 1e9)
        model.actuator_forcerange[:] = np.stack([-limits, limits], axis=1)
        self._lead = self.damping / self.stiffness

    def ask(self, line: Timeline, step: int) -> None:
        """What is asked for at a step of the grid."""
        values = np.concatenate([line.arm[step], line.hand[step]])
        velocities = np.concatenate([line.arm_velocity[step], line.hand_velocity[step]])
        self._world.data.ctrl[:] = values + self._lead * velocities


def _largest_inertia(world: World, line: Timeline) -> np.ndarray:
    """By joint with a motor: the largest entry of the mass matrix's diagonal along the way, what
    is coupled to it added."""
    model, data, drives = world.model, world.data, world.drives
    motors = drives.arm + drives.hand
    columns = {name: model.joint(name).dofadr[0] for name in motors + list(drives.coupled)}
    largest = np.zeros(len(motors))
    matrix = np.zeros((model.nv, model.nv))
    for step in range(0, len(line), max(1, len(line) // 50)):
        world.set_robot(line.arm[step], line.hand[step])
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fullM(model, data, matrix)
        found = [matrix[columns[name], columns[name]] for name in motors]
        for joint, (leader, multiplier, _) in drives.coupled.items():
            column = columns[joint]
            found[motors.index(leader)] += multiplier**2 * matrix[column, column]
        largest = np.maximum(largest, found)
    return largest
