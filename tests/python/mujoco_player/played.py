"""What came of playing a plan."""

from dataclasses import dataclass, field

MOVED, UNTOUCHED, TILT = 0.010, 0.005, 10.0
"""Metres and degrees within which an object is as planned."""


@dataclass(frozen=True)
class Ended:
    """An object at the end. `error`: metres horizontally from where the plan says; `tilt`:
    degrees from the upright it should have; `dropped`: metres below where it should be."""

    object: str
    moved: bool
    position: tuple[float, float, float]
    expected: tuple[float, float, float]
    error: float
    tilt: float
    dropped: float

    @property
    def fell(self) -> bool:
        """Lies on its side, or lies lower than it should."""
        return self.tilt > 45.0 or self.dropped > 0.05

    @property
    def as_planned(self) -> bool:
        limit = MOVED if self.moved else UNTOUCHED
        return self.error <= limit and self.tilt <= TILT and not self.fell


@dataclass(frozen=True)
class Contact:
    """The hardest moment between two that should not have touched: newtons along the normals,
    seconds since the first row, the step's number (-1: none) and the segment's kind."""

    one: str
    other: str
    force: float
    time: float
    step: int
    kind: str

    @property
    def of_arm(self) -> bool:
        return self.one.startswith("link/") or self.other.startswith("link/")


@dataclass(frozen=True)
class StepEnd:
    """Right after a step. `error`: metres horizontally of the step's object from `placed`.
    `slip`: metres that it was from where the plan held it when the hand was about to let go (for
    a push and where nothing is held: None). `drop`: metres it then hung above its `placed`."""

    object: str
    action: str
    error: float
    tilt: float
    slip: float | None
    drop: float | None


@dataclass(frozen=True)
class Played:
    """`tracking`: the tool's largest distance from where the plan has it, metres. `motion`:
    seconds of the plan; `wall`: seconds that playing it took."""

    objects: dict[str, Ended]
    contacts: list[Contact]
    steps: list[StepEnd]
    tracking: float
    motion: float
    wall: float
    notes: list[str] = field(default_factory=list)

    @property
    def as_planned(self) -> bool:
        """Every object is where the plan says, upright as it says."""
        return all(ended.as_planned for ended in self.objects.values())

    @property
    def arm_force(self) -> float:
        """The largest force between a link of the robot and what it should not have touched."""
        return max((contact.force for contact in self.contacts if contact.of_arm), default=0.0)

    def faults(self) -> list[str]:
        """One line each."""
        lines = list(self.notes)
        for ended in self.objects.values():
            if not ended.as_planned:
                lines.append(
                    f"{ended.object}: {1e3 * ended.error:.1f} mm off, tilted {ended.tilt:.1f}°"
                    + (", fell" if ended.fell else "")
                )
        for contact in self.contacts:
            if contact.force > 1.0:
                lines.append(
                    f"{contact.one} met {contact.other} with {contact.force:.1f} N at "
                    f"{contact.time:.2f} s (step {contact.step}, {contact.kind})"
                )
        return lines
