"""Our Panda against the one in the wheel `example-robot-data`. Run with pytest, or alone to print the
measured numbers."""

import model_checks as checks
import numpy as np

OURS = checks.REPOSITORY / "robots" / "panda" / "panda.urdf"
OUR_SRDF = checks.REPOSITORY / "robots" / "panda" / "panda.srdf"
THEIRS = checks.official_directory("panda_description")
THEIR_URDF = THEIRS / "urdf" / "panda.urdf"
ARM = [f"panda_joint{i}" for i in range(1, 8)]
FINGERS = ["panda_finger_joint1", "panda_finger_joint2"]
MESHES = {f"panda_link{i}": f"link{i}" for i in range(8)} | {
    "panda_hand": "hand",
    "panda_leftfinger": "finger",
}
HAND = {"panda_hand", "panda_leftfinger", "panda_rightfinger"}
PAD = 1.5e-4
"""The finger's mesh passes the middle by this much, metres; our pads end there."""


def kinematics_error(postures):
    return checks.kinematics_error(THEIR_URDF, OURS, ARM + FINGERS, postures)


def excess(link):
    mesh = THEIRS / "meshes" / "collision" / f"{MESHES[link]}.stl"
    return checks.excess(checks.shapes_of(OURS, link), mesh)


def values(random, model):
    """The right finger follows the left, which the URDF reader does not see to."""
    opening = random.uniform(0, 0.04)
    return checks.within_limits(random, model, ARM) | dict.fromkeys(FINGERS, opening)


def touching(postures):
    return checks.touching(OURS, values, postures)


def test_kinematics_are_the_official_ones():
    metres, radians, frames, limits = kinematics_error(10_000)
    links = {f"panda_link{i}" for i in range(9)}
    assert links | HAND | {"panda_hand_tcp"} <= set(frames)
    assert metres <= 1e-6 and radians <= 1e-6
    assert limits


def test_our_shapes_contain_the_official_meshes():
    for link in MESHES:
        outside, most, mean = excess(link)
        room = PAD if link == "panda_leftfinger" else 0
        assert outside <= room, f"{link} sticks out by {outside * 1e3:.2f} mm"
        limit = 0.05 if link == "panda_link0" else 0.027
        assert most <= limit and mean <= 0.010, f"{link} is too large: {most}, {mean}"


def test_our_fingers_contain_the_official_boxes():
    for link in ("panda_leftfinger", "panda_rightfinger"):
        theirs = checks.shapes_of(THEIR_URDF, link)
        outside = checks.signed_distance(
            checks.surface_points(theirs, 0.001), checks.shapes_of(OURS, link)
        )
        assert outside.max() <= PAD, f"{link} sticks out by {outside.max() * 1e3:.2f} mm"


def test_pads_are_as_far_apart_as_the_joint_says():
    """Their faces are at the fingers' frames, which part by twice the joint's value."""
    for link, side in (("panda_leftfinger", 1), ("panda_rightfinger", -1)):
        points = checks.surface_points(checks.shapes_of(OURS, link), 0.002)
        assert abs((points[:, 1] * side).min()) <= 1e-9
        # The grasp's centre is on the pads: 0.1034 - 0.0584 above the fingers' frames.
        pad = points[np.abs(points[:, 1]) <= 1e-9]
        assert pad[:, 2].max() >= 0.053 and pad[:, 2].min() <= 0.0375


def test_unchecked_pairs_are_adjacent_or_in_the_hand_or_always_touch():
    share = touching(300)
    checks.check_unchecked_pairs(OURS, OUR_SRDF, HAND, share)
    # Nothing but the wrist folded back meets often: other pairs would cost the planner its room.
    for pair, part in share.items():
        assert part < 0.25 or pair in checks.unchecked_pairs(OUR_SRDF), (sorted(pair), part)


if __name__ == "__main__":
    metres, radians, frames, _ = kinematics_error(10_000)
    print(f"kinematics: {metres:.1e} m, {radians:.1e} rad over {len(frames)} frames")
    for link in MESHES:
        outside, most, mean = excess(link)
        beyond = f"ours beyond it {most * 1e3:.1f} mm, mean {mean * 1e3:.1f} mm"
        print(f"{link}: mesh outside {outside * 1e3:+.2f} mm, {beyond}")
    checks.print_touching(touching(2000), OUR_SRDF)
