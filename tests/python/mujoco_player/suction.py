"""A suction cup: takes hold of what it is near while the plan grips, lets go where it says so."""

import mujoco
import numpy as np

from . import settings
from .scene_bodies import OBJECT
from .world import World


class Suction:
    """A weld between the tool and the object, on only while the cup holds it."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._held: str | None = None

    def update(self, kind: str, name: str) -> None:
        """Once a step of physics, in a segment of `kind` of a step with the object `name`."""
        if self._held is None and kind == "grasp":
            if self._distance(name) <= settings.CUP_REACH:
                self._hold(name)
        elif self._held is not None and kind == "release":
            self._world.data.eq_active[self._weld(self._held)] = 0
            self._held = None

    def _weld(self, name: str) -> int:
        return self._world.model.equality(OBJECT + name).id

    def _distance(self, name: str) -> float:
        """From the hand's links to the object."""
        model, data = self._world.model, self._world.data
        hand = {self._world.link(link) for link in self._world.hand_links}
        body = self._world.body_of[OBJECT + name]
        owners = self._world.owner_of_geom
        ends = np.zeros(6)
        return min(
            mujoco.mj_geomDistance(model, data, a, b, 1.0, ends)
            for a in range(model.ngeom)
            for b in range(model.ngeom)
            if owners[a] in hand and owners[b] == body
        )

    def _hold(self, name: str) -> None:
        model, data = self._world.model, self._world.data
        tool, body = self._world.link(self._world.tool), self._world.body_of[OBJECT + name]
        back, turned, offset, relative = np.zeros(3), np.zeros(4), np.zeros(3), np.zeros(4)
        mujoco.mju_negPose(back, turned, data.xpos[tool], data.xquat[tool])
        mujoco.mju_mulPose(offset, relative, back, turned, data.xpos[body], data.xquat[body])
        weld = self._weld(name)
        model.eq_data[weld, 0:3] = 0.0
        model.eq_data[weld, 3:6] = offset
        model.eq_data[weld, 6:10] = relative
        data.eq_active[weld] = 1
        self._held = name
