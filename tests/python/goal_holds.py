"""A goal in PDDL, asked of where everything is at the end of a plan; by our own reader."""

import re

from plan_checker.meshes import MeshStore
from plan_checker.violations import Report
from plan_checker.world import World
from scenes import final

IN_PLACE = 1e-3
"""Metres from where an object stood at first."""


def read(text: str) -> list:
    """Nested lists of words."""
    words = iter(re.findall(r"[()]|[^\s();]+", re.sub(r";.*", "", text)))
    assert next(words) == "("
    return _list(words)


def _list(words) -> list:
    found = []
    for word in words:
        if word == ")":
            return found
        found.append(_list(words) if word == "(" else word)
    raise ValueError("a list is not closed")


class State:
    """What is true where a plan leaves things."""

    def __init__(self, plan: dict) -> None:
        self.world = World(plan["scene"], MeshStore([], ".", Report()))
        self.places = final(plan)
        self.world.standing = dict(self.places)
        self.carriers = {
            name: {carrier for carrier, _ in self.world.carriers(name, at)}
            for name, at in self.places.items()
        }
        for name, at in self.places.items():
            if place := self.world.place_under(name, at):
                self.carriers[name].add(place.id)

    def named(self, kind: str) -> list[str]:
        places = [place.id for place in self.world.places]
        return {"item": list(self.places), "place": places}[kind]

    def is_on(self, name: str, support: str) -> bool:
        return support in self.carriers[name]

    def in_place(self, name: str) -> bool:
        shift = self.places[name][:3, 3] - self.world.objects[name].start[:3, 3]
        return float((shift @ shift) ** 0.5) <= IN_PLACE

    def holds(self, goal: list, values: dict[str, str] | None = None) -> bool:
        """`values` are those of variables."""
        values = values or {}
        head, *rest = goal
        if head == "and":
            return all(self.holds(part, values) for part in rest)
        if head == "or":
            return any(self.holds(part, values) for part in rest)
        if head == "not":
            return not self.holds(rest[0], values)
        if head == "imply":
            return not self.holds(rest[0], values) or self.holds(rest[1], values)
        if head in ("forall", "exists"):
            (variable, _, kind), body = rest
            each = (self.holds(body, {**values, variable: n}) for n in self.named(kind))
            return all(each) if head == "forall" else any(each)
        names = [values.get(name, name) for name in rest]
        if head == "=":
            return names[0] == names[1]
        if head == "Clear":
            return not any(names[0] in under for under in self.carriers.values())
        return {"On": self.is_on, "InPlace": self.in_place}[head](*names)
