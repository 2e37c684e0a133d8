"""Plays a plan: the servos follow its rows, step by step; physics does the rest."""

import math
import time as clock

import mujoco
import numpy as np

from . import settings, shifts, timeline
from .carriers import may_touch
from .contacts import Watch
from .played import Ended, Played, StepEnd
from .poses import from_keys
from .servos import Servos
from .suction import Suction
from .timeline import Span
from .world import World


def play(plan: dict, seed: int | None = None, noise: float = 0.0, shifted=None) -> Played:
    """Every object stands up to `noise` metres off (uniform in a disc, less where objects would
    overlap; drawn from `seed`), or as far as `shifted` (object → x, y) says. What the plan does
    not move is expected where it then stands, what it moves where the plan puts it."""
    return Playing(plan, seed, noise, shifted or {}).run()


class Playing:
    """One run."""

    def __init__(self, plan: dict, seed: int | None, noise: float, shifted: dict) -> None:
        self._began = clock.perf_counter()
        self._plan = plan
        self.world = World(plan)
        self.line = timeline.timeline(plan, self.world.drives.hand, self.world.gap)
        self._servos = Servos(self.world, self.line)
        self._tool = self.world.link(self.world.tool)
        self._set_out(seed, noise, shifted)
        self._suction = Suction(self.world) if self.world.cup else None
        self._jacobian = np.zeros((3, self.world.model.nv))
        self._columns = self.world.columns(self.world.drives.arm)
        self._tracking = 0.0
        self._ends: list[StepEnd] = []
        self._letting_go: tuple[float, float] | None = None

    def _set_out(self, seed, noise: float, shifted: dict) -> None:
        world = self.world
        mujoco.mj_resetData(world.model, world.data)
        world.set_robot(self.line.arm[0], self.line.hand[0])
        world.forward()
        self._watch = Watch(world, may_touch(world, self._plan))
        expected = {name: world.object_pose(name) for name in world.objects}
        by = shifts.in_a_disc(world.objects, noise, seed) if noise else {}
        shifts.displace(world, {**by, **shifted})
        self._expected = {
            name: at if name in shifted else world.object_pose(name)
            for name, at in expected.items()
        }
        self._moved = set()
        world.forward()

    def run(self) -> Played:
        self._watch.enter(None, "start")
        self._stand(settings.SETTLE, 0)
        for span in self.line.spans:
            self._follow(span)
        self._watch.enter(None, "end")
        last = len(self.line) - 1
        self._stand(settings.AFTER, last)
        motion = last * settings.STEP
        wall = clock.perf_counter() - self._began
        objects = {name: self._ended(name) for name in self.world.objects}
        return Played(objects, self._watch.found(), self._ends, self._tracking, motion, wall)

    def _stand(self, seconds: float, row: int) -> None:
        for _ in range(round(seconds / settings.STEP)):
            self._servos.ask(self.line, row)
            self._step(row)

    def _follow(self, span: Span) -> None:
        """One segment; the step ends with its last one."""
        step = self._plan["steps"][span.step]
        self._watch.enter(span)
        if span.kind == "release":
            self._letting_go = self._held_off(step)
        for row in range(span.first, span.last):
            self._servos.ask(self.line, row)
            if self._suction:
                self._suction.update(span.kind, span.object)
            self._step(row)
            if row % 20 == 0:
                self._track(row)
        if span is self._last_touch(span.step):
            self._end_step(step)

    def _last_touch(self, number: int) -> Span:
        """The segment after which a step leaves its object alone: only transits follow."""
        spans = [span for span in self.line.spans if span.step == number]
        touching = [span for span in spans if span.kind != "transit"]
        return (touching or spans)[-1]

    def _step(self, row: int) -> None:
        mujoco.mj_step(self.world.model, self.world.data)
        self._watch.look(row * settings.STEP)

    def _track(self, row: int) -> None:
        """How far the tool is from where it should be: by the joints' errors, linearly."""
        world = self.world
        values, rates = self._columns
        mujoco.mj_jacBody(world.model, world.data, self._jacobian, None, self._tool)
        asked = self.line.arm[min(row + 1, len(self.line) - 1)]
        off = self._jacobian[:, rates] @ (world.data.qpos[values] - asked)
        self._tracking = max(self._tracking, float(np.linalg.norm(off)))

    def _held_off(self, step: dict) -> tuple[float, float]:
        """Metres from `placed` just before the hand lets go: in all, and upwards."""
        away = self.world.object_pose(step["object"])[:3, 3] - from_keys(step["placed"])[:3, 3]
        return float(np.linalg.norm(away)), float(away[2])

    def _end_step(self, step: dict) -> None:
        name, action = step["object"], step["action"]
        self._expected[name] = from_keys(step["placed"])
        self._moved.add(name)
        ended = self._ended(name)
        slip, drop = self._letting_go or (None, None)
        self._ends.append(StepEnd(name, action, ended.error, ended.tilt, slip, drop))
        self._letting_go = None

    def _ended(self, name: str) -> Ended:
        at, wanted = self.world.object_pose(name), self._expected[name]
        off = at[:3, 3] - wanted[:3, 3]
        cosine = float(np.clip(at[:3, 2] @ wanted[:3, 2], -1.0, 1.0))
        keys = next(keys for keys in self._plan["scene"]["objects"] if keys["id"] == name)
        return Ended(
            object=name,
            moved=name in self._moved,
            position=tuple(at[:3, 3].tolist()),
            expected=tuple(wanted[:3, 3].tolist()),
            error=float(np.hypot(off[0], off[1])),
            tilt=0.0 if keys.get("sphere") else math.degrees(math.acos(cosine)),
            dropped=-float(off[2]),
        )
