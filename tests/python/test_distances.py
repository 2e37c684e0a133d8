"""The checker's distances against closed forms, and the files it reads shapes from."""

import struct
from pathlib import Path

import numpy as np
import pytest

from box_stl import write_box_stl
from plan_checker import meshes, poses, shapes
from plan_checker.distance import signed_distance
from plan_checker.sweep import Mover, Still, against_still

# --- distances against closed forms -------------------------------------------------------------


def random_pose(draw) -> np.ndarray:
    quaternion = draw.normal(size=4)
    rotation = poses.rotation_from_quaternion(quaternion / np.linalg.norm(quaternion))
    return poses.pose(rotation, draw.normal(size=3))


def shifted(*position) -> np.ndarray:
    return poses.pose(np.eye(3), position)


QUARTER = poses.rotation_from_rpy([np.pi / 2, 0, 0])


def side_by_side(gap):
    yield (
        "cylinders, axes parallel",
        (
            shapes.cylinder(0.037, 0.26),
            shapes.cylinder(0.03, 0.2),
            shifted(*(np.array([0.6, 0.8]) * (0.067 + gap)), 0.02),
        ),
    )
    yield (
        "cylinders, axes crossing",
        (
            shapes.cylinder(0.037, 0.4),
            shapes.cylinder(0.03, 0.4),
            poses.pose(QUARTER, [0.067 + gap, 0.01, 0.02]),
        ),
    )
    yield (
        "cylinders, stacked",
        (
            shapes.cylinder(0.037, 0.26),
            shapes.cylinder(0.03, 0.2),
            shifted(0.01, -0.02, 0.23 + gap),
        ),
    )
    yield (
        "box and cylinder's side",
        (
            shapes.box([0.1, 0.3, 0.4]),
            shapes.cylinder(0.037, 0.26),
            shifted(0.05 + 0.037 + gap, 0.02, 0.01),
        ),
    )
    yield (
        "box and standing cylinder",
        (
            shapes.box([0.6, 0.9, 0.02]),
            shapes.cylinder(0.037, 0.26),
            shifted(0.1, 0.2, 0.01 + 0.13 + gap),
        ),
    )
    yield (
        "sphere and box",
        (
            shapes.sphere(0.05),
            shapes.box([0.2, 0.2, 0.2]),
            shifted(0.15 + gap, 0.03, -0.02),
        ),
    )
    yield (
        "capsule and cylinder",
        (
            shapes.capsule(0.04, 0.3),
            shapes.cylinder(0.03, 0.2),
            poses.pose(QUARTER, [0.07 + gap, 0.0, 0.05]),
        ),
    )
    yield (
        "capsule's cap and box",
        (
            shapes.capsule(0.04, 0.3),
            shapes.box([0.2, 0.2, 0.2]),
            shifted(0.0, 0.0, 0.15 + 0.04 + 0.1 + gap),
        ),
    )
    yield (
        "boxes",
        (
            shapes.box([0.2, 0.3, 0.1]),
            shapes.box([0.1, 0.1, 0.1]),
            shifted(0.15 + gap, 0.05, 0.01),
        ),
    )
    yield (
        "hull and cylinder",
        (
            shapes.hull(shapes.SIGNS * 0.1),
            shapes.cylinder(0.037, 0.26),
            shifted(0.1 + 0.037 + gap, 0.01, 0.03),
        ),
    )
    yield (
        "points and cylinder",
        (
            shapes.cloud(np.array([[0.0, 0, 0], [-0.1, 0.02, 0.05], [-0.3, 0, 0]]), 0.01),
            shapes.cylinder(0.037, 0.26),
            shifted(0.047 + gap, 0.0, 0.03),
        ),
    )


@pytest.mark.parametrize("gap", [0.05, 2e-3, 1.5e-4, 5e-5, 0.0, -5e-5, -9e-5, -1.5e-4, -2e-3])
def test_distances_match_closed_forms(gap):
    draw = np.random.default_rng(7)
    for name, (first, second, first_from_second) in side_by_side(gap):
        for _ in range(40):
            world = random_pose(draw)
            found = signed_distance(first, world, second, world @ first_from_second)
            assert abs(found - gap) < 2e-6, name
            found = signed_distance(second, world @ first_from_second, first, world)
            assert abs(found - gap) < 2e-6, name


def test_distance_to_edges_and_rims():
    box, cylinder, sphere = (
        shapes.box([0.2, 0.2, 0.4]),
        shapes.cylinder(0.03, 0.3),
        shapes.sphere(0.05),
    )
    beyond_edge = shifted(0.1 + 0.06, 0.1 + 0.08, 0.0)
    assert abs(signed_distance(box, np.eye(4), cylinder, beyond_edge) - 0.07) < 1e-6
    beyond_rim = shifted(0.03 + 0.06, 0.0, 0.15 + 0.08)
    assert abs(signed_distance(cylinder, np.eye(4), sphere, beyond_rim) - 0.05) < 1e-6
    beyond_corner = shifted(0.1 + 0.2, 0.1 + 0.2, 0.2 + 0.1)
    assert abs(signed_distance(box, np.eye(4), sphere, beyond_corner) - 0.25) < 1e-6


def prism(radius: float, height: float, sides: int) -> shapes.Part:
    """As good as a cylinder: its corners lie on the rims."""
    turns = np.arange(sides) * 2 * np.pi / sides
    ring = np.stack([radius * np.cos(turns), radius * np.sin(turns), 0 * turns], axis=1)
    up = np.array([0, 0, height / 2])
    return shapes.hull(np.concatenate([ring - up, ring + up]))


@pytest.mark.parametrize("reach", [0.06, 0.12, 0.2])
def test_cylinders_match_prisms_at_any_depth(reach):
    """Random poses, from apart to deep inside; the prism is 0.4 µm slimmer than the cylinder."""
    draw = np.random.default_rng(11)
    cylinder, slim = shapes.cylinder(0.03, 0.2), prism(0.03, 0.2, 600)
    others = [
        shapes.box([0.01, 0.02, 0.074]),
        shapes.cylinder(0.046, 0.12),
        shapes.capsule(0.04, 0.1),
    ]
    for _ in range(1500):
        at = random_pose(draw)
        at[:3, 3] *= reach * draw.uniform() / np.linalg.norm(at[:3, 3])
        for other in others:
            found = signed_distance(cylinder, np.eye(4), other, at)
            assert abs(found - signed_distance(slim, np.eye(4), other, at)) < 3e-6


def test_a_skipping_sweep_finds_what_looking_everywhere_finds():
    draw = np.random.default_rng(3)
    part, obstacle = shapes.box([0.04, 0.1, 0.2]), shapes.cylinder(0.05, 0.3)
    for _ in range(60):
        direction = draw.normal(size=3) * 0.4
        turn = poses.rotation_from_rpy(draw.normal(size=3))
        shares = np.linspace(-1, 1, 400)
        at = np.stack([poses.pose(turn, direction * s + draw.normal(size=3) * 0) for s in shares])
        at[:, :3, 3] += draw.normal(size=3) * 0.06
        distances = [signed_distance(part, a, obstacle, np.eye(4)) for a in at]
        still = Still("still", 0, obstacle, np.eye(4))
        found = list(against_still([Mover("mover", part, at)], [still], lambda *_: False))
        deep = np.flatnonzero(np.array(distances) < -1e-4 - 2e-6)
        assert bool(found) == bool(len(deep))
        if found:
            assert found[0][2].first == deep[0]


# --- meshes -------------------------------------------------------------------------------------


def mesh_store(folder: Path, uri: str, digest: str, report=None):
    return meshes.MeshStore([{"uri": uri, "file": uri, "sha256": digest}], folder, report)


@pytest.mark.parametrize("gap", [0.05, 2e-3, 1.5e-4, -5e-5, -1.5e-4, -2e-3])
def test_mesh_distances(tmp_path, gap):
    digest = write_box_stl(tmp_path / "m.stl", ([0, 0, 0], [0.2, 0.2, 0.2]))
    mesh = shapes.triangles(mesh_store(tmp_path, "m.stl", digest).triangles("m.stl", np.ones(3)))
    cylinder = shapes.cylinder(0.03, 0.1)
    found = signed_distance(mesh, np.eye(4), cylinder, shifted(0.13 + gap, 0.01, 0.013))
    assert abs(found - gap) < 1e-5
    found = signed_distance(mesh, np.eye(4), mesh, shifted(0.2 + gap, 0.01, 0.013))
    assert abs(found - gap) < 1e-5


def test_mesh_overlap_is_never_exaggerated(tmp_path):
    """Against the same box as a convex shape, at random poses that overlap a little."""
    digest = write_box_stl(tmp_path / "m.stl", ([0, 0, 0], [0.2, 0.2, 0.2]))
    mesh = shapes.triangles(mesh_store(tmp_path, "m.stl", digest).triangles("m.stl", np.ones(3)))
    box, others = shapes.box([0.2] * 3), [shapes.cylinder(0.03, 0.1), shapes.box([0.05, 0.1, 0.2])]
    draw, seen = np.random.default_rng(5), 0
    for _ in range(3000):
        at = random_pose(draw)
        at[:3, 3] *= 0.17 / np.linalg.norm(at[:3, 3])
        for other in others:
            exact = signed_distance(box, np.eye(4), other, at)
            found = signed_distance(mesh, np.eye(4), other, at)
            if exact > -0.004:
                assert found > exact - 2e-6
                seen += exact < 0
            if exact > 0:
                assert found < exact + 2e-6
            elif exact > -0.004:
                assert found < 0
        if (exact := signed_distance(box, np.eye(4), box, at)) > -0.004:
            found = signed_distance(mesh, np.eye(4), mesh, at)
            assert exact - 2e-6 < found < max(exact + 2e-6, 0.0) + 1e-12
    assert seen > 100


def test_scene_meshes_are_the_hulls_of_their_connected_parts(tmp_path):
    boxes = ([-0.1, 0, 0], [0.05, 0.1, 0.1]), ([0.1, 0, 0], [0.05, 0.1, 0.1])
    digest = write_box_stl(tmp_path / "two.stl", *boxes)
    model = mesh_store(tmp_path, "two.stl", digest).triangles("two.stl", np.full(3, 2.0))
    parts = [shapes.hull(points) for points in meshes.connected_parts(model)]
    assert sorted(round(p.centre[0], 6) for p in parts) == [-0.2, 0.2]
    ball = shapes.sphere(0.05)
    nearest = min(signed_distance(p, np.eye(4), ball, np.eye(4)) for p in parts)
    assert abs(nearest - (0.15 - 0.05)) < 1e-6


@pytest.mark.parametrize("form", ["xyz", "ascii", "binary_little_endian"])
def test_point_files(tmp_path, form):
    points = np.array([[0.5, 0.25, 1.0], [-1.0, 0.0, 2.5]])
    path = tmp_path / "cloud"
    header = (
        f"ply\nformat {form} 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nend_header\n"
    ).encode()
    if form == "xyz":
        path.write_text("# a comment\n0.5 0.25 1.0\n-1.0, 0, 2.5\n")
    elif form == "ascii":
        path.write_bytes(header + b"0.5 0.25 1.0 7\n-1 0 2.5 9\n")
    else:
        path.write_bytes(header + b"".join(struct.pack("<3fB", *p, 7) for p in points))
    assert np.allclose(meshes.read_points(path), points)
