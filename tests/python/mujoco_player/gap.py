"""The gap between the pads of a parallel hand, from the plan's table `hand.opening`."""

import numpy as np

from . import settings


class Gap:
    """One joint value → metres between the pads; straight lines between the table's entries."""

    def __init__(self, hand: dict) -> None:
        table = sorted((float(k), float(v)) for k, v in (hand.get("opening") or {}).items())
        self._values = np.array([value for value, _ in table])
        self._gaps = np.array([gap for _, gap in table])
        self.joint = hand.get("joint")

    def slope(self) -> float:
        """Metres of gap per unit of the joint, on average, with its sign; 1 without a table."""
        if len(self._values) < 2:
            return 1.0
        wide = self._values[-1] - self._values[0]
        return float((self._gaps[-1] - self._gaps[0]) / wide)

    def drive_inertia(self) -> float:
        """What each finger's drive adds to its joint."""
        return settings.FINGER * (self.slope() / 2) ** 2

    def grip_limit(self) -> float:
        """Force or torque of the joint that presses both pads with `GRIP`."""
        return settings.GRIP * abs(self.slope())

    def stiffness(self) -> float:
        """Of the joint's servo."""
        return settings.GRIP_STIFFNESS * self.slope() ** 2

    def beyond(self) -> float:
        """What to add to the joint's value to press."""
        return -settings.BEYOND / self.slope()
