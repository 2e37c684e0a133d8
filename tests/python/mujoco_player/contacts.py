"""Watches who touches whom, and keeps what was not intended."""

import numpy as np

from .played import Contact
from .scene_bodies import OBJECT
from .timeline import Span
from .world import World

_HANDLING = ("approach", "grasp", "transfer", "release", "retreat", "push")
"""Segments in which the hand's links may touch the step's object."""
_LEVEL = 0.7
"""Least vertical part of the normal where a thing rests on another; else it meets its side."""


class Watch:
    """Keeps the largest force of every pair of owners that should not have touched."""

    def __init__(self, world: World, carried: np.ndarray) -> None:
        """`carried`: owner × owner, what may rest on what at all times."""
        self._world, self._carried = world, carried
        self._hand = [world.link(name) for name in world.hand_links]
        self._handled = np.zeros_like(carried)
        self._now = (-1, "start")
        self._largest: dict[tuple[int, int], tuple] = {}

    def enter(self, span: Span | None, kind: str = "end") -> None:
        """A segment begins; without one, a pause of `kind`."""
        self._handled[:] = False
        self._now = (-1, kind) if span is None else (span.step, span.kind)
        if span is not None and span.kind in _HANDLING:
            body = self._world.body_of[OBJECT + span.object]
            self._handled[self._hand, body] = self._handled[body, self._hand] = True

    def look(self, time: float) -> None:
        """Takes in the contacts of the last step of physics."""
        data = self._world.data
        if data.ncon == 0:
            return
        owners = self._world.owner_of_geom[data.contact.geom]
        address = data.contact.efc_address
        one, other = owners[:, 0], owners[:, 1]
        rests = self._carried[one, other] & (np.abs(data.contact.frame[:, 2]) > _LEVEL)
        odd = ~(rests | self._handled[one, other]) & (address >= 0)
        if not odd.any():
            return
        forces: dict[tuple[int, int], float] = {}
        for (a, b), row in zip(owners[odd].tolist(), address[odd].tolist(), strict=True):
            pair = (min(a, b), max(a, b))
            forces[pair] = forces.get(pair, 0.0) + float(data.efc_force[row])
        for pair, force in forces.items():
            if force > self._largest.get(pair, (0.0,))[0]:
                self._largest[pair] = (force, time, *self._now)

    def found(self) -> list[Contact]:
        """The hardest first."""
        names = self._world.owners
        contacts = [
            Contact(names[a], names[b], force, time, step, kind)
            for (a, b), (force, time, step, kind) in self._largest.items()
        ]
        return sorted(contacts, key=lambda contact: -contact.force)
