"""A robot of ours against an official one in the wheel `example-robot-data`: kinematics, shapes,
unchecked pairs.

Needs `pin` (Pinocchio, with `coal`), `example-robot-data` and `numpy`.
"""

import itertools
import math
import pathlib
import struct
import xml.etree.ElementTree as ElementTree

import coal
import numpy as np
import pinocchio as pin

REPOSITORY = next(p for p in pathlib.Path(__file__).resolve().parents if (p / "robots").is_dir())


def official_directory(description):
    """A robot's folder in the wheel, which keeps its data beside Pinocchio's."""
    for parent in pathlib.Path(pin.__file__).resolve().parents:
        found = parent / "share" / "example-robot-data" / "robots" / description
        if found.is_dir():
            return found
    raise FileNotFoundError("install example-robot-data")


def index_of(model, joint):
    """Where a joint's value stands in a configuration."""
    return model.joints[model.getJointId(joint)].idx_q


def set_value(model, q, joint, value):
    """Of a joint in a configuration, which has cosine and sine for a continuous one."""
    i = index_of(model, joint)
    if model.joints[model.getJointId(joint)].nq == 2:
        q[i : i + 2] = math.cos(value), math.sin(value)
    else:
        q[i] = value


def limits_of(model, joint):
    """(lower, upper, velocity); a whole turn for a continuous joint."""
    found = model.joints[model.getJointId(joint)]
    velocity = model.velocityLimit[found.idx_v]
    if found.nq == 2:
        return -math.pi, math.pi, velocity
    return model.lowerPositionLimit[found.idx_q], model.upperPositionLimit[found.idx_q], velocity


def kinematics_error(official, ours, joints, postures):
    """Of two URDFs, over the link frames that both have and random values of `joints`: (worst
    metres, worst radians, frames, limits alike)."""
    theirs, ours = pin.buildModelFromUrdf(str(official)), pin.buildModelFromUrdf(str(ours))
    frames = [
        f.name
        for f in theirs.frames
        if f.type == pin.FrameType.BODY and ours.existFrame(f.name, pin.FrameType.BODY)
    ]
    limits = all(limits_of(theirs, name) == limits_of(ours, name) for name in joints)
    their_data, our_data = theirs.createData(), ours.createData()
    random = np.random.default_rng(1)
    metres = radians = 0.0
    for _ in range(postures):
        their_q, our_q = pin.neutral(theirs), pin.neutral(ours)
        for name in joints:
            value = random.uniform(*limits_of(theirs, name)[:2])
            set_value(theirs, their_q, name, value)
            set_value(ours, our_q, name, value)
        pin.framesForwardKinematics(theirs, their_data, their_q)
        pin.framesForwardKinematics(ours, our_data, our_q)
        for name in frames:
            a = their_data.oMf[theirs.getFrameId(name, pin.FrameType.BODY)]
            b = our_data.oMf[ours.getFrameId(name, pin.FrameType.BODY)]
            metres = max(metres, float(np.linalg.norm(a.translation - b.translation)))
            radians = max(radians, float(np.linalg.norm(pin.log3(a.rotation.T @ b.rotation))))
    return metres, radians, frames, limits


def shapes_of(urdf, link):
    """(kind, link_from_shape, size) of each of a link's shapes. The size of a box: half its edges;
    of a cylinder: radius and half its length; of a sphere: its radius."""
    found = []
    for collision in ElementTree.parse(urdf).findall(f"link[@name='{link}']/collision"):
        origin, shape = collision.find("origin"), collision.find("geometry")[0]
        rotation = pin.rpy.rpyToMatrix(np.array([float(x) for x in origin.get("rpy").split()]))
        place = pin.SE3(rotation, np.array([float(x) for x in origin.get("xyz").split()]))
        if shape.tag == "box":
            size = np.array([float(x) for x in shape.get("size").split()]) / 2
        elif shape.tag == "cylinder":
            size = np.array([float(shape.get("radius")), float(shape.get("length")) / 2])
        else:
            assert shape.tag == "sphere", shape.tag
            size = float(shape.get("radius"))
        found.append((shape.tag, place, size))
    return found


def signed_distance(points, shapes):
    """Metres from each point to the nearest shape, less than 0 inside."""
    distances = []
    for kind, place, size in shapes:
        local = (points - place.translation) @ place.rotation
        if kind == "sphere":
            distances.append(np.linalg.norm(local, axis=1) - size)
            continue
        if kind == "cylinder":
            local = np.column_stack([np.hypot(local[:, 0], local[:, 1]), local[:, 2]])
        over = np.abs(local) - size
        corner = np.linalg.norm(np.maximum(over, 0), axis=1)
        distances.append(np.where((over > 0).any(axis=1), corner, over.max(axis=1)))
    return np.min(distances, axis=0)


def mesh_points(path, spacing=0.003):
    """Points of a mesh's surface, no two neighbours farther apart than `spacing`."""
    data = path.read_bytes()
    (count,) = struct.unpack("<I", data[80:84])
    layout = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
    points = []
    for a, b, c in np.frombuffer(data[84 : 84 + 50 * count], layout)["corners"].astype(float):
        longest = max(np.linalg.norm(b - a), np.linalg.norm(c - b), np.linalg.norm(a - c))
        n = max(1, math.ceil(longest / spacing))
        i, j = np.meshgrid(np.arange(n + 1), np.arange(n + 1))
        inside = i + j <= n
        u, v = (i[inside] / n)[:, None], (j[inside] / n)[:, None]
        points.append(a + (b - a) * u + (c - a) * v)
    return np.vstack(points)


def evenly(half, spacing):
    return np.linspace(-half, half, int(2 * half / spacing) + 2)


def cylinder_surface(size, spacing):
    radius, half = size
    around = np.linspace(0, 2 * math.pi, int(2 * math.pi * radius / spacing) + 2)
    out = np.linspace(0, radius, int(radius / spacing) + 2)
    side = [(radius, a, z) for a in around for z in evenly(half, spacing)]
    caps = [(r, a, z) for a in around for r in out for z in (-half, half)]
    r, a, z = np.array(side + caps).T
    return np.column_stack([r * np.cos(a), r * np.sin(a), z])


def box_surface(size, spacing):
    faces = []
    for axis, half in enumerate(size):
        edges = [evenly(h, spacing) for h in size]
        edges[axis] = [-half, half]
        faces += itertools.product(*edges)
    return np.array(faces)


def sphere_surface(radius, spacing):
    points = []
    for down in np.linspace(0, math.pi, int(math.pi * radius / spacing) + 2):
        ring = radius * math.sin(down)
        for a in np.linspace(0, 2 * math.pi, int(2 * math.pi * ring / spacing) + 2):
            points.append((ring * math.cos(a), ring * math.sin(a), radius * math.cos(down)))
    return np.array(points)


SURFACE = {"box": box_surface, "cylinder": cylinder_surface, "sphere": sphere_surface}


def surface_points(shapes, spacing=0.004):
    """Points of the surface of the shapes' union."""
    points = np.vstack(
        [
            SURFACE[kind](size, spacing) @ place.rotation.T + place.translation
            for kind, place, size in shapes
        ]
    )
    return points[signed_distance(points, shapes) > -1e-6]


def distance(shape_a, at_a, shape_b, at_b):
    """Metres between two of coal's shapes, less than 0 if they overlap."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return coal.distance(shape_a, at_a, shape_b, at_b, request, result)


def excess(shapes, mesh):
    """How far a mesh (its file) sticks out of shapes, and they out of it (most, mean): metres."""
    outside = float(signed_distance(mesh_points(mesh), shapes).max())
    solid = coal.MeshLoader().load(str(mesh))
    grain, origin = coal.Sphere(1e-6), coal.Transform3s()
    beyond = [
        distance(solid, origin, grain, coal.Transform3s(np.eye(3), p))
        for p in surface_points(shapes)
    ]
    return outside, max(beyond), float(np.mean(beyond))


def touching(urdf, values_of, postures):
    """For each pair of links: in what part of postures they overlap by more than 0.1 mm.
    `values_of` draws a posture, joint → value, from a random generator and the model."""
    model = pin.buildModelFromUrdf(str(urdf))
    shapes = pin.buildGeomFromUrdf(model, str(urdf), pin.GeometryType.COLLISION)
    data, placed = model.createData(), pin.GeometryData(shapes)
    link = [model.frames[s.parentFrame].name for s in shapes.geometryObjects]
    shape = [s.geometry for s in shapes.geometryObjects]
    by_pair = {}
    for i, j in itertools.combinations(range(len(link)), 2):
        if link[i] != link[j]:
            by_pair.setdefault(frozenset((link[i], link[j])), []).append((i, j))
    random = np.random.default_rng(1)
    counts = dict.fromkeys(by_pair, 0)
    for _ in range(postures):
        q = pin.neutral(model)
        for name, value in values_of(random, model).items():
            set_value(model, q, name, value)
        pin.updateGeometryPlacements(model, data, shapes, placed, q)
        at = [coal.Transform3s(pose.rotation, pose.translation) for pose in placed.oMg]
        for pair, parts in by_pair.items():
            gaps = (distance(shape[i], at[i], shape[j], at[j]) for i, j in parts)
            counts[pair] += any(gap < -1e-4 for gap in gaps)
    return {pair: count / postures for pair, count in counts.items()}


def within_limits(random, model, joints):
    """joint → a value drawn uniformly within its limits."""
    return {name: random.uniform(*limits_of(model, name)[:2]) for name in joints}


def unchecked_pairs(srdf):
    rows = ElementTree.parse(srdf).getroot().findall("disable_collisions")
    return [frozenset((row.get("link1"), row.get("link2"))) for row in rows]


def adjacent_pairs(urdf):
    joints = ElementTree.parse(urdf).getroot().findall("joint")
    return {frozenset(joint.find(end).get("link") for end in ("parent", "child")) for joint in joints}


def shaped_parents(urdf, shaped):
    """link → the next link above it that is among `shaped`."""
    joints = ElementTree.parse(urdf).getroot().findall("joint")
    above = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in joints}
    parents = {}
    for link in shaped:
        at = above.get(link)
        while at is not None and at not in shaped:
            at = above.get(at)
        parents[link] = at
    return parents


def check_unchecked_pairs(urdf, srdf, hand, share):
    """Pairs never checked are adjacent, in the hand, or touch in most postures; and no pair that
    touches in most was forgotten, as it would make them collisions."""
    unchecked, adjacent = unchecked_pairs(srdf), adjacent_pairs(urdf)
    for pair in unchecked:
        assert pair in adjacent or pair <= hand or share[pair] >= 0.7, sorted(pair)
    for pair, part in share.items():
        assert part < 0.7 or pair in unchecked, sorted(pair)


def print_touching(share, srdf):
    for pair, part in sorted(share.items(), key=lambda item: -item[1]):
        if part > 0:
            unchecked = ", unchecked" if pair in unchecked_pairs(srdf) else ""
            print(f"{' – '.join(sorted(pair))}: {part:.1%}{unchecked}")
