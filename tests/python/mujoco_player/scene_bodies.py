"""Fixtures and objects as MJCF. What touches an object rubs with the object's own friction, since
fixtures have none and MuJoCo takes the larger of two; of two objects, with the larger one's."""

import xml.etree.ElementTree as ElementTree

from . import poses, settings, shapes

FIXTURE, OBJECT = "fixture/", "object/"
"""Before the names of their bodies."""


def mass_of(keys: dict) -> float:
    """Kilograms."""
    if (mass := keys.get("mass")) is not None:
        return float(mass)
    return settings.DENSITY * sum(shape.volume for shape in shapes.of_body(keys))


def friction_of(keys: dict, scene: dict) -> float:
    """The object's own, else the scene's, else the default."""
    for found in (keys.get("friction"), scene.get("friction")):
        if found is not None:
            return float(found)
    return settings.FRICTION


def add_fixture(worldbody, keys: dict) -> None:
    at = poses.attributes(poses.from_keys(keys))
    body = ElementTree.SubElement(worldbody, "body", name=FIXTURE + keys["id"], **at)
    for shape in shapes.of_body(keys):
        masks = {"contype": "2", "conaffinity": "1", "friction": "0 0 0"}
        ElementTree.SubElement(body, "geom", **shape.geom(), **masks, **settings.CONTACT)


def add_object(worldbody, keys: dict, scene: dict) -> None:
    at = poses.attributes(poses.from_keys(keys))
    body = ElementTree.SubElement(worldbody, "body", name=OBJECT + keys["id"], **at)
    ElementTree.SubElement(body, "freejoint", name=OBJECT + keys["id"])
    parts = shapes.of_body(keys)
    density = mass_of(keys) / sum(shape.volume for shape in parts)
    friction = f"{friction_of(keys, scene):.9g} 0 0"
    for shape in parts:
        mass = f"{density * shape.volume:.9g}"
        masks = {"contype": "1", "conaffinity": "1", "condim": "3"}
        ElementTree.SubElement(
            body, "geom", **shape.geom(), mass=mass, friction=friction, **masks, **settings.CONTACT
        )
