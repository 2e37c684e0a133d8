"""Our UR10 against the one in the wheel `example-robot-data`. Run with pytest, or alone to print the
measured numbers."""

import model_checks as checks

OURS = checks.REPOSITORY / "robots" / "ur10_ag95" / "ur10_ag95.urdf"
OUR_SRDF = checks.REPOSITORY / "robots" / "ur10_ag95" / "ur10_ag95.srdf"
THEIRS = checks.official_directory("ur_description")
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


def kinematics_error(postures):
    return checks.kinematics_error(THEIRS / "urdf" / "ur10_robot.urdf", OURS, ARM, postures)


def excess(link):
    mesh = THEIRS / "meshes" / "ur10" / "collision" / f"{MESHES[link]}.stl"
    return checks.excess(checks.shapes_of(OURS, link), mesh)


def values(random, model):
    """The hand's other joints follow the first, which the URDF reader does not see to."""
    opening = random.uniform(0, 0.65)
    return checks.within_limits(random, model, ARM) | {
        "finger_joint": opening,
        "right_knuckle_joint": opening,
        "left_finger_joint": -opening,
        "right_finger_joint": -opening,
    }


def touching(postures):
    return checks.touching(OURS, values, postures)


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
    checks.check_unchecked_pairs(OURS, OUR_SRDF, HAND, touching(300))


if __name__ == "__main__":
    metres, radians, frames, _ = kinematics_error(10_000)
    print(f"kinematics: {metres:.1e} m, {radians:.1e} rad over {len(frames)} frames")
    for link in MESHES:
        outside, most, mean = excess(link)
        beyond = f"ours beyond it {most * 1e3:.1f} mm, mean {mean * 1e3:.1f} mm"
        print(f"{link}: mesh outside {outside * 1e3:+.2f} mm, {beyond}")
    checks.print_touching(touching(2000), OUR_SRDF)
