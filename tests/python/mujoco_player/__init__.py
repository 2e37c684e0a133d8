"""Plays plan files in MuJoCo: the arm follows the plan, everything else follows physics.

Made from the contract of the plan file alone; shares no code with the planner. Units: metres,
radians, seconds, kilograms, newtons; poses are 4×4 matrices in the world unless named otherwise.

`play(plan)` → `Played`: where every object ended, what touched what it should not have touched.
`python -m mujoco_player.measure --help`: many generated scenes, a table of how they ended.
"""

from .played import Contact, Ended, Played, StepEnd
from .player import play
from .unplayable import Unplayable

__all__ = ["Contact", "Ended", "Played", "StepEnd", "Unplayable", "play"]
