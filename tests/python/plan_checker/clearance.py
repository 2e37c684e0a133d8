"""The least room between what moves and what stands still, at the rows; whether it is what the
scene asks, and what the plan claims.

Links, what is held and what is pushed, against fixtures and standing objects; held and pushed also
against links that are not the hand's. Left out: the hand and what it grips, lets go of or pushes;
the mounted root and fixtures; an object and what carries it, within 3 cm of where it stood or is
put, and all along a push. A neighbour that is nearer at either of those places than is asked has to
stay as far as it is there, and does not count to the least.
"""

import numpy as np

from . import poses, tolerances
from .contact_rules import GRIPPING, Hold
from .distance import bodies_apart, signed_distance
from .robot import Robot
from .sweep import Mover, Still, travel
from .timing import Segment
from .violations import Report
from .world import World

_UP_TO = 0.05
"""Metres; larger distances are not looked for."""


class Clearance:
    """Measures segment by segment, then judges. `asked` in metres, 0 for nothing."""

    def __init__(self, robot: Robot, asked: float, report: Report) -> None:
        self._robot, self._report, self.asked = robot, report, asked
        self.least, self._where, self._pair = max(_UP_TO, asked), "plan", ""
        self.found = False

    def measure(self, segment: Segment, step_object: str, world: World, hold: Hold | None) -> None:
        robot = self._robot
        postures = robot.place(robot.values(segment.rows, segment.gripper))
        links = [
            Mover(link, part, postures.link(link) @ part.body_from_part)
            for link, parts in robot.parts.items()
            for part in parts
        ]
        stills = [
            Still(body.id, index, part, at @ part.body_from_part)
            for body, at in world.still(leave_out=(hold.object,) if hold else ())
            for index, part in enumerate(body.parts)
        ]
        gripping = segment.kind in GRIPPING
        for still in stills:
            for mover in links:
                hand = gripping and still.owner == step_object and mover.owner in robot.hand_links
                if not hand and not (
                    still.owner in world.fixtures and mover.owner in robot.mounted
                ):
                    self._pair_of(mover, still, mover.travel, segment)
        if hold is None:
            return
        at = hold.world_from_object(postures)
        parts = world.objects[hold.object].parts
        carried = [Mover(hold.object, part, at @ part.body_from_part) for part in parts]
        for body, other_at in world.still(leave_out=(hold.object,)):
            counts, keep = self._room(hold, at, body, other_at, world)
            for still in (s for s in stills if s.owner == body.id):
                for mover in carried:
                    self._pair_of(mover, still, mover.travel, segment, counts, keep)
        for link in links:
            if gripping and hold.object == step_object and link.owner in robot.hand_links:
                continue
            for mover in carried:
                seen = travel(poses.inverse(link.at) @ mover.at, mover.part.corners)
                self._pair_of(link, mover, seen, segment)

    def _room(self, hold: Hold, at, body, other_at, world: World):
        """The rows that count, and what is to be kept instead of what is asked (or None)."""
        counts, keep = np.ones(len(at), bool), None
        parts = world.objects[hold.object].parts
        for carriers, pose in (
            (hold.carriers_before, hold.stood),
            (hold.carriers_after, hold.placed),
        ):
            if body.id in {c[0] for c in carriers}:
                away = np.linalg.norm(at[:, :3, 3] - pose[:3, 3], axis=1)
                counts &= (away > tolerances.CARRIER_NEAR) & (not hold.pushed)
            elif self.asked > 0.0:
                apart = bodies_apart(parts, pose, body.parts, other_at)
                if apart < self.asked:
                    keep = apart if keep is None else min(keep, apart)
        return counts, keep

    def _pair_of(self, mover, other, travelled, segment: Segment, counts=None, keep=None) -> None:
        """Looks at the rows of one pair, passing over those that the last distance clears."""
        bound = self.least if keep is None else keep
        gap = np.maximum(mover.low - other.high, other.low - mover.high).max(axis=1)
        rows = np.flatnonzero((gap < bound) if counts is None else (gap < bound) & counts)
        position, nearest = 0, None
        while position < len(rows):
            row = int(rows[position])
            there = other.at[row] if other.at.ndim == 3 else other.at
            apart = signed_distance(mover.part, mover.at[row], other.part, there)
            if apart < bound:
                bound, nearest = apart, row
            clear = travelled[row] + apart - bound
            position = max(position + 1, int(np.searchsorted(travelled[rows], clear, side="left")))
        if nearest is None:
            return
        pair = f"{mover.owner} and {other.owner}"
        if keep is None:
            self.least, self._where, self._pair, self.found = bound, segment.where, pair, True
        elif bound < keep - tolerances.CLEARANCE:
            text = (
                f"{pair} come within {bound * 1e3:.2f} mm; they started {keep * 1e3:.2f} mm apart"
            )
            self._report.add("clearance", segment.where, text)

    def judge(self, claim: dict | None) -> None:
        """Of the whole plan; `claim` is the plan's own."""
        if self.found and self.asked and self.least < self.asked - tolerances.CLEARANCE:
            text = (
                f"{self._pair} come within {self.least * 1e3:.2f} mm, {self.asked * 1e3:.2f} asked"
            )
            self._report.add("clearance", self._where, text)
        if claim is None:
            return
        least = claim.get("least")
        claimed = float(least["distance"]) if least else float(claim["up_to"])
        if self.found and not claimed <= self.least + tolerances.CLEARANCE_CLAIM:
            text = (
                f"claims {claimed * 1e3:.2f} mm; {self._pair} are {self.least * 1e3:.2f} mm apart"
            )
            self._report.add("clearance", "plan", text)
