"""A plan's rows on the grid of the simulation's steps."""

from dataclasses import dataclass

import numpy as np

from . import settings
from .gap import Gap


@dataclass(frozen=True)
class Span:
    """One segment: its first and one-past-last step of the grid."""

    step: int
    object: str
    kind: str
    first: int
    last: int


@dataclass(frozen=True)
class Timeline:
    """Joint values and velocities asked for at each step of the grid, a column per joint."""

    arm: np.ndarray
    arm_velocity: np.ndarray
    hand: np.ndarray
    hand_velocity: np.ndarray
    spans: list[Span]

    def __len__(self) -> int:
        return len(self.arm)


def timeline(plan: dict, hand: list[str], gap: Gap) -> Timeline:
    """`hand`: the gripper's driven joints. Straight lines between rows; the velocity told to the
    motors is that between a row's neighbours, straight lines between those."""
    times, rows, grips, spans, now = [], [], [], [], 0.0
    pressing = False
    for number, step in enumerate(plan["steps"]):
        for segment in step["segments"]:
            at = now + np.asarray(segment["times"], float)
            asked = _gripper(segment, hand, len(at))
            asked, pressing = _pressed(segment["kind"], asked, hand, gap, pressing)
            times.append(at)
            rows.append(np.asarray(segment["positions"], float).reshape(len(at), -1))
            grips.append(asked)
            first, now = round(now / settings.STEP), float(at[-1])
            spans.append(
                Span(number, step["object"], segment["kind"], first, round(now / settings.STEP))
            )
    return _on_grid(np.concatenate(times), np.concatenate(rows), np.concatenate(grips), spans)


def _gripper(segment: dict, hand: list[str], count: int) -> np.ndarray:
    """A row per time, a column per joint of the hand."""
    given = segment.get("gripper") or {}
    columns = [np.broadcast_to(np.asarray(given[name], float), count) for name in hand]
    return np.stack(columns, axis=1) if columns else np.zeros((count, 0))


def _pressed(kind: str, asked, hand: list[str], gap: Gap, pressing: bool):
    """From a `grasp` that closes the hand to the `release`, it is told to close further than the
    plan says, evenly along the way: its motor stalls on what it holds, as a gripper's does."""
    if gap.joint not in hand:
        return asked, False
    column = hand.index(gap.joint)
    beyond, values = gap.beyond(), asked[:, column]
    change = values[-1] - values[0]
    result = asked.copy()
    if kind == "grasp" and change * beyond > 1e-6:
        result[:, column] += beyond * (values - values[0]) / change
        return result, True
    if not pressing:
        return asked, False
    if kind == "release":
        left = (values[-1] - values) / change if abs(change) > 1e-6 else 1.0
        result[:, column] += beyond * left
        return result, False
    result[:, column] += beyond
    return result, True


def _on_grid(times, rows, grips, spans) -> Timeline:
    _, kept = np.unique(times, return_index=True)
    times, rows, grips = times[kept], rows[kept], grips[kept]
    grid = np.arange(round(times[-1] / settings.STEP) + 1) * settings.STEP

    def spread(values):
        columns = [np.interp(grid, times, column) for column in values.T]
        return np.stack(columns, axis=1) if columns else np.zeros((len(grid), 0))

    def slopes(values):
        return np.gradient(values, times, axis=0) if len(times) > 1 else np.zeros_like(values)

    return Timeline(spread(rows), spread(slopes(rows)), spread(grips), spread(slopes(grips)), spans)
