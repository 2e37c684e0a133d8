"""Our PR2 against the one in the wheel `example-robot-data`. Run with pytest, or alone to print the
measured numbers."""

import math
import re

import coal
import model_checks as checks
import numpy as np
import pinocchio as pin

FOLDER = checks.REPOSITORY / "robots" / "pr2_left"
OURS, OUR_SRDF = FOLDER / "pr2_left.urdf", FOLDER / "pr2_left.srdf"
ROBOT = (FOLDER / "robot.yaml").read_text()
THEIRS = checks.official_directory("pr2_description")
THEIR_URDF = THEIRS / "urdf" / "pr2.urdf"
LEAD = "l_gripper_l_finger_joint"
HAND = {"l_gripper_palm_link"} | {
    f"l_gripper_{side}_{part}_link" for side in "lr" for part in ("finger", "finger_tip")
}
PAD = 0.0158
"""The pads' faces lie this far from the tips' frames, metres."""

# Link → official mesh. Links fixed to each other have their shapes in one of ours.
MESHES = {
    "base_link": ["base_v0/base_L"],
    "torso_lift_link": ["torso_v0/torso_lift_L"],
    "head_pan_link": ["head_v0/head_pan_L"],
    "head_tilt_link": ["head_v0/head_tilt_L"],
    "laser_tilt_mount_link": ["tilting_laser_v0/tilting_hokuyo_L"],
    "l_shoulder_pan_link": ["shoulder_v0/shoulder_pan"],
    "l_shoulder_lift_link": ["shoulder_v0/shoulder_lift"],
    "l_upper_arm_link": ["shoulder_v0/upper_arm_roll_L", "upper_arm_v0/upper_arm"],
    "l_elbow_flex_link": ["upper_arm_v0/elbow_flex"],
    "l_forearm_link": ["upper_arm_v0/forearm_roll_L", "forearm_v0/forearm"],
    "l_wrist_flex_link": ["forearm_v0/wrist_flex"],
    "l_gripper_palm_link": ["gripper_v0/gripper_palm"],
    "l_gripper_l_finger_link": ["gripper_v0/l_finger"],
    "l_gripper_r_finger_link": ["gripper_v0/l_finger"],
    "l_gripper_l_finger_tip_link": ["gripper_v0/l_finger_tip"],
    "l_gripper_r_finger_tip_link": ["gripper_v0/l_finger_tip"],
}


def numbers(key):
    """The mapping from names or numbers to numbers that stands under a key of the robot file."""
    block = re.search(rf"^( *){key}:.*\n((?:\1 +.*\n)+)", ROBOT, re.MULTILINE)[2]
    rows = re.findall(r'^ *"?([\w.]+)"?: (\S+)$', block, re.MULTILINE)
    return {name: float(value) for name, value in rows}


FIXED, HOME, OPENING = numbers("fixed"), numbers("home"), numbers("opening")
ARM = list(HOME)


def movable():
    model = pin.buildModelFromUrdf(str(OURS))
    return [name for name in model.names if name != "universe"]


def kinematics_error(postures):
    return checks.kinematics_error(THEIR_URDF, OURS, movable(), postures)


def excess(link):
    """How far the meshes stick out of our shapes, and ours out of them (most, mean), metres."""
    shapes = checks.shapes_of(OURS, link)
    # The right finger's mesh is the left one's, turned about x.
    turn = np.array([1, -1, -1]) if "_r_finger" in link else np.ones(3)
    grain, origin = coal.Sphere(1e-6), coal.Transform3s()
    ours = checks.surface_points(shapes, 0.006 if "base" in link or "torso" in link else 0.004)
    outside, beyond = -math.inf, []
    for name in MESHES[link]:
        path = THEIRS / "meshes" / f"{name}.stl"
        points = checks.mesh_points(path)
        # The pins inside the upper arm's and forearm's joints, within other links, are left out.
        points = points[points[:, 0] >= LEAST_X.get(name, -math.inf)]
        outside = max(outside, float(checks.signed_distance(points * turn, shapes).max()))
        solid = coal.MeshLoader().load(str(path))
        if name in SHELLS:
            solid.buildConvexRepresentation(False)
            solid = solid.convex
        gaps = [
            checks.distance(solid, origin, grain, coal.Transform3s(np.eye(3), p * turn)) for p in ours
        ]
        beyond.append(gaps)
    nearest = np.min(beyond, axis=0)
    return outside, float(nearest.max()), float(np.maximum(nearest, 0).mean())


SHELLS = {"shoulder_v0/shoulder_lift", "upper_arm_v0/elbow_flex"}
"""Without walls where the next link begins: measured against their convex hulls."""

COARSE = {
    "base_link": (0.050, 0.021),
    "torso_lift_link": (0.082, 0.014),
    "head_pan_link": (0.045, 0.016),
    "l_shoulder_pan_link": (0.080, 0.012),
    "l_shoulder_lift_link": (0.058, 0.014),
}
"""Where our surface is farther from the mesh: the casters, hollows that we fill. Metres, most, mean."""

NEAR = {
    frozenset((f"l_{a}_link", f"l_{b}_link")): metres
    for a, b, metres in [
        ("upper_arm", "forearm", 0.006),
        ("wrist_flex", "gripper_l_finger", 0.012),
        ("wrist_flex", "gripper_r_finger", 0.012),
        ("forearm", "gripper_l_finger", 0.012),
        ("forearm", "gripper_r_finger", 0.012),
    ]
}
"""Pairs with one link between them, near in every posture: metres that they keep at home."""

LEAST_X = {"upper_arm_v0/upper_arm": 0.118, "upper_arm_v0/forearm_roll_L": 0.093}


def gap(value):
    """Between the pads, metres, out of the official URDF's kinematics."""
    model = pin.buildModelFromUrdf(str(THEIR_URDF))
    q = pin.neutral(model)
    for finger in ("l_finger", "r_finger", "l_finger_tip", "r_finger_tip"):
        checks.set_value(model, q, f"l_gripper_{finger}_joint", value)
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    left, right = (
        data.oMf[model.getFrameId(f"l_gripper_{side}_finger_tip_link", pin.FrameType.BODY)]
        for side in "lr"
    )
    apart = left.rotation.T @ (left.translation - right.translation)
    assert np.linalg.norm(pin.log3(left.rotation.T @ right.rotation)) <= 1e-9, "not parallel"
    assert abs(apart[0]) <= 1e-9 and abs(apart[2]) <= 1e-9
    return apart[1] - 2 * PAD


def values(random, model):
    """The arm and the hand anywhere; what the robot file holds, as it says."""
    opening = random.uniform(*checks.limits_of(model, LEAD)[:2])
    fingers = {name: opening for name in movable() if name.startswith("l_gripper")}
    return checks.within_limits(random, model, ARM) | FIXED | fingers


def touching(postures):
    return checks.touching(OURS, values, postures)


def gaps_at_home():
    """Metres between the links of each pair that is checked and moves, the hand open."""
    model = pin.buildModelFromUrdf(str(OURS))
    shapes = pin.buildGeomFromUrdf(model, str(OURS), pin.GeometryType.COLLISION)
    shapes.addAllCollisionPairs()
    q = pin.neutral(model)
    opening = {name: max(map(float, OPENING)) for name in movable() if name.startswith("l_gripper")}
    for name, value in (HOME | FIXED | opening).items():
        checks.set_value(model, q, name, value)
    data, placed = model.createData(), pin.GeometryData(shapes)
    pin.computeDistances(model, data, shapes, placed, q)
    unchecked, gaps = checks.unchecked_pairs(OUR_SRDF), {}
    for pair, result in zip(shapes.collisionPairs, placed.distanceResults, strict=True):
        of = [shapes.geometryObjects[i].parentFrame for i in (pair.first, pair.second)]
        names = frozenset(model.frames[i].name for i in of)
        moves = any(name.startswith("l_") for name in names)
        if moves and len(names) == 2 and names not in unchecked:
            gaps[names] = min(gaps.get(names, math.inf), result.min_distance)
    return gaps


def outline():
    """Points round the shapes at home, in the base's footprint, by link."""
    model = pin.buildModelFromUrdf(str(OURS))
    q = pin.neutral(model)
    opening = {name: max(map(float, OPENING)) for name in movable() if name.startswith("l_gripper")}
    for name, value in (HOME | FIXED | opening).items():
        checks.set_value(model, q, name, value)
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    points = {}
    for frame in model.frames:
        shapes = checks.shapes_of(OURS, frame.name) if frame.type == pin.FrameType.BODY else []
        if shapes:
            at = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)]
            surface = checks.surface_points(shapes, 0.02)
            points[frame.name] = surface @ at.rotation.T + at.translation
    return points


def test_kinematics_are_the_official_ones():
    metres, radians, frames, limits = kinematics_error(10_000)
    model = pin.buildModelFromUrdf(str(OURS))
    ours = {f.name for f in model.frames if f.type == pin.FrameType.BODY} - {"universe"}
    assert ours - set(frames) == {"grasp_center"}
    assert metres <= 1e-6 and radians <= 1e-6
    assert limits


def test_our_shapes_contain_the_official_meshes():
    for link in MESHES:
        outside, most, mean = excess(link)
        assert outside <= 5e-5, f"{link} sticks out by {outside * 1e3:.2f} mm"
        most_allowed, mean_allowed = COARSE.get(link, (0.055, 0.014))
        assert most <= most_allowed and mean <= mean_allowed, f"{link} is too large: {most}, {mean}"


def test_the_right_arm_has_the_left_ones_shapes():
    for link in MESHES:
        if link.startswith("l_"):
            left, right = (checks.shapes_of(OURS, side + link[1:]) for side in "lr")
            for (kind, at, size), (kind2, at2, size2) in zip(left, right, strict=True):
                assert kind == kind2 and at == at2 and np.array_equal(size, size2)


def test_opening_table_is_the_linkage():
    table = sorted((float(joint), gap) for joint, gap in OPENING.items())
    joints, gaps = np.array(table).T
    at = np.linspace(joints[0], joints[-1], 200)
    off = np.abs(np.interp(at, joints, gaps) - [gap(value) for value in at])
    assert off.max() <= 1e-4, off.max()
    assert gaps[0] == 0 and joints[-1] == 0.548


def test_unchecked_pairs_are_adjacent_or_in_the_hand_or_always_touch():
    share = touching(100)
    unchecked = checks.unchecked_pairs(OUR_SRDF)
    shaped = {name for pair in share for name in pair}
    parents = checks.shaped_parents(OURS, shaped)
    for pair in unchecked:
        a, b = pair
        adjacent = parents.get(a) == b or parents.get(b) == a
        assert adjacent or pair <= HAND or share[pair] >= 0.7, sorted(pair)
    for pair, part in share.items():
        assert part < 0.25 or pair in unchecked, (sorted(pair), part)


def test_home_is_free_and_beside_the_base():
    for pair, metres in gaps_at_home().items():
        assert metres >= NEAR.get(pair, 0.02), (sorted(pair), metres)
    points = outline()
    reach = {link: np.hypot(*at[:, :2].T).max() for link, at in points.items()}
    assert max(reach.values()) <= 0.51 and reach["base_link"] <= 0.432
    assert min(at[:, 2].min() for at in points.values()) >= 0.01


if __name__ == "__main__":
    metres, radians, frames, _ = kinematics_error(10_000)
    print(f"kinematics: {metres:.1e} m, {radians:.1e} rad over {len(frames)} frames")
    for link in MESHES:
        outside, most, mean = excess(link)
        beyond = f"ours beyond it {most * 1e3:.1f} mm, mean {mean * 1e3:.1f} mm"
        print(f"{link}: mesh outside {outside * 1e3:+.2f} mm, {beyond}")
    for pair, metres in sorted(gaps_at_home().items(), key=lambda item: item[1])[:12]:
        print(f"home: {' - '.join(sorted(pair))} {metres * 1e3:.1f} mm")
    reach = {link: np.hypot(*at[:, :2].T).max() for link, at in outline().items()}
    for link, metres in sorted(reach.items(), key=lambda item: -item[1])[:6]:
        print(f"home: {link} reaches {metres:.3f} m from the base's centre")
    checks.print_touching(touching(300), OUR_SRDF)
