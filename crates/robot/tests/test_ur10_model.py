"""Our UR10 against the one in the wheel `example-robot-data`: kinematics, shapes, unchecked pairs.

Needs `pin` (Pinocchio, with `coal`), `example-robot-data` and `numpy`. Run with pytest, or alone to
print the measured numbers.
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
OURS = REPOSITORY / "robots" / "ur10_ag95" / "ur10_ag95.urdf"
OUR_SRDF = REPOSITORY / "robots" / "ur10_ag95" / "ur10_ag95.srdf"
ARM = [
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
]
MESHES = {
    "base_link": "base",
    "shoulder_link": "shoulder",
    "upper_arm_link": "upperarm",
    "forearm_link": "forearm",
    "wrist_1_link": "wrist1",
    "wrist_2_link": "wrist2",
    "wrist_3_link": "wrist3",
}
HAND = {"gripper_base_link", "left_knuckle", "left_finger", "right_knuckle", "right_finger"}


def official_directory():
    """The UR robots of the wheel, which keeps its data beside Pinocchio's."""
    for parent in pathlib.Path(pin.__file__).resolve().parents:
        found = parent / "share" / "example-robot-data" / "robots" / "ur_description"
        if found.is_dir():
            return found
    raise FileNotFoundError("install example-robot-data")


def index_of(model, joint):
    """Where a joint's value stands in a configuration."""
    return model.joints[model.getJointId(joint)].idx_q


def kinematics_error(postures):
    """Over the link frames that both have: (worst metres, worst radians, frames, limits alike)."""
    theirs = pin.buildModelFromUrdf(str(official_directory() / "urdf" / "ur10_robot.urdf"))
    ours = pin.buildModelFromUrdf(str(OURS))
    frames = [
        f.name
        for f in theirs.frames
        if f.type == pin.FrameType.BODY and ours.existFrame(f.name, pin.FrameType.BODY)
    ]
    limits = all(
        (t.lowerPositionLimit[i], t.upperPositionLimit[i], t.velocityLimit[i])
        == (o.lowerPositionLimit[j], o.upperPositionLimit[j], o.velocityLimit[j])
        for name in ARM
        for t, o in [(theirs, ours)]
        for i, j in [(index_of(t, name), index_of(o, name))]
    )
    their_data, our_data = theirs.createData(), ours.createData()
    random = np.random.default_rng(1)
    metres = radians = 0.0
    for _ in range(postures):
        their_q, our_q = pin.neutral(theirs), pin.neutral(ours)
        for name in ARM:
            i = index_of(theirs, name)
            value = random.uniform(theirs.lowerPositionLimit[i], theirs.upperPositionLimit[i])
            their_q[i] = our_q[index_of(ours, name)] = value
        pin.framesForwardKinematics(theirs, their_data, their_q)
        pin.framesForwardKinematics(ours, our_data, our_q)
        for name in frames:
            a = their_data.oMf[theirs.getFrameId(name, pin.FrameType.BODY)]
            b = our_data.oMf[ours.getFrameId(name, pin.FrameType.BODY)]
            metres = max(metres, float(np.linalg.norm(a.translation - b.translation)))
            radians = max(radians, float(np.linalg.norm(pin.log3(a.rotation.T @ b.rotation))))
    return metres, radians, frames, limits


def cylinders_of(link):
    """(link_from_cylinder, radius, half length) of each shape of one of our arm's links."""
    found = []
    for collision in ElementTree.parse(OURS).findall(f"link[@name='{link}']/collision"):
        origin, cylinder = collision.find("origin"), collision.find("geometry/cylinder")
        rotation = pin.rpy.rpyToMatrix(np.array([float(x) for x in origin.get("rpy").split()]))
        place = pin.SE3(rotation, np.array([float(x) for x in origin.get("xyz").split()]))
        found.append((place, float(cylinder.get("radius")), float(cylinder.get("length")) / 2))
    return found


def signed_distance(points, cylinders):
    """Metres from each point to the nearest cylinder, less than 0 inside."""
    distances = []
    for place, radius, half in cylinders:
        local = (points - place.translation) @ place.rotation
        side = np.hypot(local[:, 0], local[:, 1]) - radius
        end = np.abs(local[:, 2]) - half
        corner = np.hypot(np.maximum(side, 0), np.maximum(end, 0))
        distances.append(np.where((side > 0) | (end > 0), corner, np.maximum(side, end)))
    return np.min(distances, axis=0)


def mesh_points(name, spacing=0.003):
    """Points of a collision mesh's surface, no two neighbours farther apart than `spacing`."""
    data = (official_directory() / "meshes" / "ur10" / "collision" / f"{name}.stl").read_bytes()
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


def surface_points(cylinders, spacing=0.004):
    """Points of the surface of the cylinders' union."""
    points = []
    for place, radius, half in cylinders:
        around = np.linspace(0, 2 * math.pi, int(2 * math.pi * radius / spacing) + 2)
        along = np.linspace(-half, half, int(2 * half / spacing) + 2)
        out = np.linspace(0, radius, int(radius / spacing) + 2)
        side = [(radius, a, z) for a in around for z in along]
        caps = [(r, a, z) for a in around for r in out for z in (-half, half)]
        r, a, z = np.array(side + caps).T
        local = np.column_stack([r * np.cos(a), r * np.sin(a), z])
        points.append(local @ place.rotation.T + place.translation)
    points = np.vstack(points)
    return points[signed_distance(points, cylinders) > -1e-6]


def distance(shape_a, at_a, shape_b, at_b):
    """Metres between two of coal's shapes, less than 0 if they overlap."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    return coal.distance(shape_a, at_a, shape_b, at_b, request, result)


def excess(link):
    """How far the mesh sticks out of our shapes, and ours out of it (most, mean): metres."""
    cylinders, name = cylinders_of(link), MESHES[link]
    outside = float(signed_distance(mesh_points(name), cylinders).max())
    mesh = coal.MeshLoader().load(
        str(official_directory() / "meshes" / "ur10" / "collision" / f"{name}.stl")
    )
    grain = coal.Sphere(1e-6)
    origin = coal.Transform3s()
    beyond = [
        distance(mesh, origin, grain, coal.Transform3s(np.eye(3), p))
        for p in surface_points(cylinders)
    ]
    return outside, max(beyond), float(np.mean(beyond))


def touching(postures):
    """For each pair of our links: in what part of postures they overlap by more than 0.1 mm."""
    model = pin.buildModelFromUrdf(str(OURS))
    shapes = pin.buildGeomFromUrdf(model, str(OURS), pin.GeometryType.COLLISION)
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
        opening = random.uniform(0, 0.65)
        for name in model.names[1:]:
            i = index_of(model, name)
            if name in ARM:
                q[i] = random.uniform(model.lowerPositionLimit[i], model.upperPositionLimit[i])
            else:
                q[i] = opening if name in ("finger_joint", "right_knuckle_joint") else -opening
        pin.updateGeometryPlacements(model, data, shapes, placed, q)
        at = [coal.Transform3s(pose.rotation, pose.translation) for pose in placed.oMg]
        for pair, parts in by_pair.items():
            gaps = (distance(shape[i], at[i], shape[j], at[j]) for i, j in parts)
            counts[pair] += any(gap < -1e-4 for gap in gaps)
    return {pair: count / postures for pair, count in counts.items()}


def unchecked_pairs():
    rows = ElementTree.parse(OUR_SRDF).getroot().findall("disable_collisions")
    return [frozenset((row.get("link1"), row.get("link2"))) for row in rows]


def test_kinematics_are_the_official_ones():
    metres, radians, frames, limits = kinematics_error(10_000)
    assert set(MESHES) | {"ee_link", "tool0"} <= set(frames)
    assert metres <= 1e-6 and radians <= 1e-6
    assert limits


def test_our_shapes_contain_the_official_meshes():
    for link in MESHES:
        outside, most, mean = excess(link)
        assert outside <= 0, f"{link} sticks out by {outside * 1e3:.2f} mm"
        assert most <= 0.025 and mean <= 0.006, f"{link} is too large: {most}, {mean}"


def test_unchecked_pairs_are_adjacent_or_in_the_hand_or_always_touch():
    joints = ElementTree.parse(OURS).getroot().findall("joint")
    ends = ("parent", "child")
    adjacent = {frozenset(joint.find(end).get("link") for end in ends) for joint in joints}
    share = touching(300)
    for pair in unchecked_pairs():
        assert pair in adjacent or pair <= HAND or share[pair] >= 0.7, sorted(pair)
    # And no pair that always touches was forgotten: it would make every posture a collision.
    for pair, part in share.items():
        assert part < 0.7 or pair in unchecked_pairs(), sorted(pair)


if __name__ == "__main__":
    metres, radians, frames, _ = kinematics_error(10_000)
    print(f"kinematics: {metres:.1e} m, {radians:.1e} rad over {len(frames)} frames")
    for link in MESHES:
        outside, most, mean = excess(link)
        beyond = f"ours beyond it {most * 1e3:.1f} mm, mean {mean * 1e3:.1f} mm"
        print(f"{link}: mesh outside {outside * 1e3:+.2f} mm, {beyond}")
    for pair, part in sorted(touching(2000).items(), key=lambda item: -item[1]):
        if part > 0:
            unchecked = ", unchecked" if pair in unchecked_pairs() else ""
            print(f"{' – '.join(sorted(pair))}: {part:.1%}{unchecked}")
