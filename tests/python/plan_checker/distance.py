"""Signed distances between posed parts: positive apart, negative overlapping (metres).

Coal's tolerances are chosen by trial: closed forms come out within 1.1e-6 on either side, and
within 1e-8 apart. A tighter `epa_tolerance` makes its search for the depth give up at times, which
it reports as the most negative number there is; that is caught here and asked again, looser. The
accelerated variants of the search and the duality-gap criterion are off by up to 0.3 mm on
round shapes and are not used. Between two meshes, and between a mesh and a shape, overlap is that
of the deepest pair of triangles: right for the shallow overlaps that matter, and blind to a shape
that lies wholly inside a mesh without meeting its surface.
"""

import coal
import numpy as np

from . import poses
from .shapes import Part


def _request(epa_tolerance: float):
    request = coal.DistanceRequest()
    request.enable_signed_distance = True
    request.gjk_tolerance, request.epa_tolerance = min(1e-8, epa_tolerance), epa_tolerance
    request.gjk_max_iterations, request.epa_max_iterations = 500, 256
    return request


_REQUESTS = [_request(tolerance) for tolerance in (1e-6, 1e-5, 1e-4)]
_GAVE_UP = -1e3

_CONTACTS = coal.CollisionRequest()
_CONTACTS.enable_contact = True
_CONTACTS.num_max_contacts = 1000


def transform(matrix: np.ndarray):
    """A 4×4 pose as Coal's."""
    return coal.Transform3s(matrix[:3, :3], matrix[:3, 3])


def _distance(first, world_from_first, second, world_from_second) -> float:
    """Coal's answer, from the tightest request that it does not give up on."""
    for request in _REQUESTS:
        result = coal.DistanceResult()
        distance = coal.distance(
            first, world_from_first, second, world_from_second, request, result
        )
        if distance > _GAVE_UP:
            return distance
    raise ArithmeticError("Coal finds no depth for two overlapping shapes")


def signed_distance(first: Part, world_from_first, second: Part, world_from_second) -> float:
    """Between two parts whose world poses are 4×4 matrices."""
    if first.kind == "points" and second.kind == "points":
        gaps = poses.apply(world_from_first, first.points)[:, None] - poses.apply(
            world_from_second, second.points
        )
        return float(np.linalg.norm(gaps, axis=-1).min()) - first.radius - second.radius
    if first.kind == "points":
        return _to_points(second, world_from_second, first, world_from_first)
    if second.kind == "points":
        return _to_points(first, world_from_first, second, world_from_second)
    a, b = transform(world_from_first), transform(world_from_second)
    distance = _distance(first.geometry, a, second.geometry, b)
    if first.is_mesh and second.is_mesh and distance <= 0.0:
        result = coal.CollisionResult()
        coal.collide(first.geometry, a, second.geometry, b, _CONTACTS, result)
        contacts = [result.getContact(i) for i in range(result.numContacts())]
        ours = poses.apply(world_from_first, first.triangles([c.b1 for c in contacts]))
        theirs = poses.apply(world_from_second, second.triangles([c.b2 for c in contacts]))
        return -max((_crossing(a, b) for a, b in zip(ours, theirs)), default=0.0)
    return distance


def _crossing(first: np.ndarray, second: np.ndarray) -> float:
    """The least translation that parts two crossing triangles (3×3, a corner per row).

    By separating axes: the normals, the edges' cross products, and for triangles in one plane the
    edges' normals in it. Coal's own depth for a pair of triangles is at times that of another axis.
    """
    edges, others = np.roll(first, -1, 0) - first, np.roll(second, -1, 0) - second
    normal, other = np.cross(edges[0], edges[1]), np.cross(others[0], others[1])
    axes = [normal, other, *np.cross(edges[:, None], others).reshape(-1, 3)]
    axes += [*np.cross(edges, normal), *np.cross(others, other)]
    lengths = np.linalg.norm(axes, axis=1)
    axes = np.array(axes)[lengths > 1e-9 * lengths.max()]
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    a, b = first @ axes.T, second @ axes.T
    return max(0.0, float(np.minimum(a.max(0) - b.min(0), b.max(0) - a.min(0)).min()))


def _to_points(part: Part, world_from_part, cloud: Part, world_from_cloud) -> float:
    """Nearest ball first, by distance to the box round the part, until no other can be nearer."""
    part_from_cloud = poses.inverse(world_from_part) @ world_from_cloud
    points = poses.apply(part_from_cloud, cloud.points)
    outside = np.maximum(np.abs(points - part.centre) - part.half, 0.0)
    at_least = np.linalg.norm(outside, axis=1) - cloud.radius
    ball, best = coal.Sphere(cloud.radius), np.inf
    for index in np.argsort(at_least, kind="stable"):
        if at_least[index] >= best:
            break
        best = min(
            best,
            _distance(
                part.geometry,
                coal.Transform3s(),
                ball,
                coal.Transform3s(np.eye(3), points[index]),
            ),
        )
    return float(best)


def bodies_apart(first: list[Part], world_from_first, second: list[Part], world_from_second):
    """The least signed distance between two bodies, each a list of parts with one pose."""
    return min(
        (
            signed_distance(
                a, world_from_first @ a.body_from_part, b, world_from_second @ b.body_from_part
            )
            for a in first
            for b in second
        ),
        default=np.inf,
    )
