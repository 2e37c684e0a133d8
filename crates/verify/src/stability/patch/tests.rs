use super::super::polygon::outside;
use super::*;
use crate::meshes::Triangles;
use crate::rest::rests_on;
use crate::shapes::{balls, capsule_along_z, convex_parts, cuboid, cylinder_along_z, sphere};
use parry3d_f64::math::Rotation;
use parry3d_f64::shape::SharedShape;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

fn thing(pieces: Vec<(Pose, SharedShape)>, pose: Pose) -> Thing {
    let pieces = pieces.into_iter().map(|(at, shape)| Piece::new(at, shape)).collect();
    Thing { id: String::new(), pieces, pose }
}

fn boxed(size: [f64; 3], at: [f64; 3]) -> Thing {
    thing(vec![(Pose::IDENTITY, cuboid(size))], Pose::from_translation(at.into()))
}

fn cylinder(radius: f64, height: f64, at: [f64; 3]) -> Thing {
    thing(vec![cylinder_along_z(radius, height)], Pose::from_translation(at.into()))
}

fn ball(radius: f64, at: [f64; 3]) -> Thing {
    thing(vec![(Pose::IDENTITY, sphere(radius))], Pose::from_translation(at.into()))
}

/// Its top is at 0; its edge along y is at x = 0.
fn table() -> Thing {
    boxed([1.0, 1.0, 0.1], [-0.5, 0.0, -0.05])
}

fn found(upper: &Thing, lower: &Thing) -> Vec<Point> {
    assert!(rests_on(upper, &upper.pose, lower, &lower.pose));
    patch(upper, &upper.pose, lower, &lower.pose)
}

/// How far one hull is from holding the other, both ways.
fn differ(found: &[Point], expected: &[(f64, f64)]) -> f64 {
    let expected = hull(expected.iter().map(|(x, y)| Point::new(*x, *y)).collect());
    let beyond = |a: &[Point], b: &[Point]| a.iter().map(|p| outside(b, *p)).fold(0.0, f64::max);
    assert!(!found.is_empty());
    beyond(found, &expected).max(beyond(&expected, found))
}

fn turned(mut thing: Thing, turn: Rotation) -> Thing {
    thing.pose = Pose::from_parts(thing.pose.translation, turn * thing.pose.rotation);
    thing
}

#[test]
fn a_box_over_an_edge() {
    // Also 0.9 mm above and sunk, and leaning as much as `placed` may.
    for (up, lean) in [(0.0, 0.0), (9e-4, 0.0), (-9e-4, 0.0), (2.5e-4, 0.01), (0.0, 1e-4)] {
        let upper = turned(boxed([0.1, 0.06, 0.2], [0.01, 0.0, 0.1 + up]), Rotation::from_rotation_x(lean));
        // Leaning sets the lower face aside.
        let aside = 0.1 * lean;
        let corners = [(-0.04, aside - 0.03), (0.0, aside - 0.03), (0.0, aside + 0.03), (-0.04, aside + 0.03)];
        assert!(differ(&found(&upper, &table()), &corners) < 5e-5, "{up} {lean}");
    }
    // On its edge there is no more than a line.
    let side = 0.1 / 2f64.sqrt();
    for turn in [0.0, 0.3] {
        let upright = Rotation::from_rotation_z(turn) * Rotation::from_rotation_y(FRAC_PI_4);
        let upper = turned(boxed([0.1, 0.06, 0.1], [-0.2, 0.0, side]), upright);
        let (x, y) = (0.03 * turn.sin(), 0.03 * turn.cos());
        assert!(differ(&found(&upper, &table()), &[(-0.2 - x, y), (-0.2 + x, -y)]) < 5e-5);
    }
}

#[test]
fn round_feet() {
    let circle = |x: f64, y: f64, r: f64| {
        (0..360).map(move |i| f64::from(i).to_radians()).map(move |a| (x + r * a.cos(), y + r * a.sin()))
    };
    let upper = cylinder(0.04, 0.2, [-0.3, 0.1, 0.1]);
    assert!(differ(&found(&upper, &table()), &circle(-0.3, 0.1, 0.04).collect::<Vec<_>>()) < 1.1e-4);
    // Cylinder on cylinder, not in line: a lens.
    let upper = cylinder(0.03, 0.2, [-0.27, 0.1, 0.3]);
    let lower = cylinder(0.04, 0.2, [-0.3, 0.1, 0.1]);
    let both = circle(-0.3, 0.1, 0.04).chain(circle(-0.27, 0.1, 0.03));
    let lens: Vec<(f64, f64)> = both
        .filter(|(x, y)| {
            let from = |at: f64| (x - at).hypot(y - 0.1);
            from(-0.3) < 0.0401 && from(-0.27) < 0.0301
        })
        .collect();
    assert!(differ(&found(&upper, &lower), &lens) < 1e-3);
    let middle = found(&upper, &lower).iter().copied().sum::<Point>();
    assert!(middle.is_finite());
}

#[test]
fn what_is_round_below_has_a_point_or_a_line() {
    let lie = Rotation::from_rotation_y(FRAC_PI_2);
    let lines: [(Thing, f64); 3] = [
        (ball(0.05, [-0.2, 0.1, 0.05]), 0.0),
        (turned(cylinder(0.05, 0.2, [-0.2, 0.1, 0.05]), lie), 0.1),
        (
            turned(thing(vec![(Pose::IDENTITY, capsule_along_z(0.05, 0.2))], Pose::translation(-0.2, 0.1, 0.05)), lie),
            0.1,
        ),
    ];
    for (mut upper, half) in lines {
        for up in [0.0, 9e-4, -9e-4] {
            upper.pose.translation.z = 0.05 + up;
            assert!(differ(&found(&upper, &table()), &[(-0.2 - half, 0.1), (-0.2 + half, 0.1)]) < 5e-5);
        }
    }
    // A board on a lying cylinder, a capsule upright, a cylinder tilted onto its rim.
    let log = turned(cylinder(0.05, 0.2, [0.0, 0.0, 0.05]), lie);
    let board = boxed([0.1, 0.3, 0.01], [0.0, 0.02, 0.105]);
    assert!(differ(&found(&board, &log), &[(-0.05, 0.0), (0.05, 0.0)]) < 5e-5);
    let pill = thing(vec![(Pose::IDENTITY, capsule_along_z(0.05, 0.2))], Pose::translation(-0.2, 0.1, 0.15));
    assert!(differ(&found(&pill, &table()), &[(-0.2, 0.1)]) < 5e-5);
    let (tilt, reach): (f64, f64) = (0.3, 0.1 * 0.3f64.cos() + 0.04 * 0.3f64.sin());
    let tilted = turned(cylinder(0.04, 0.2, [-0.3, 0.0, reach]), Rotation::from_rotation_y(tilt));
    let rim = -0.3 - 0.1 * tilt.sin() + 0.04 * tilt.cos();
    assert!(differ(&found(&tilted, &table()), &[(rim, 0.0)]) < 5e-5);
    // Crossed logs, and a ball on a ball.
    let across = turned(cylinder(0.02, 0.2, [0.03, 0.01, 0.12]), Rotation::from_rotation_x(FRAC_PI_2));
    assert!(differ(&found(&across, &log), &[(0.03, 0.0)]) < 1e-4);
    let (below, above) = (ball(0.05, [0.0, 0.0, 0.05]), ball(0.03, [0.0, 0.0, 0.13]));
    assert!(differ(&found(&above, &below), &[(0.0, 0.0)]) < 1e-4);
}

#[test]
fn slanted_faces_touch_too() {
    // A ball between two blocks touches the edge of each.
    let radius: f64 = 0.05;
    for (edge, up) in [(0.02, 0.0), (0.03, 0.0), (0.02, 5e-4), (0.02, -5e-4)] {
        let z = (radius * radius - edge * edge).sqrt();
        let upper = ball(radius, [edge, 0.1, z + up]);
        assert!(differ(&found(&upper, &table()), &[(0.0, 0.1)]) < 2e-4, "{edge} {up}");
    }
    // A log in the same way has a line.
    let lie = Rotation::from_rotation_x(FRAC_PI_2);
    let log = turned(cylinder(radius, 0.2, [0.03, 0.1, 0.04]), lie);
    assert!(differ(&found(&log, &table()), &[(0.0, 0.0), (0.0, 0.2)]) < 2e-4);
    // A ball on the flank of a ball.
    let (below, above) = (ball(0.05, [0.0, 0.0, 0.0]), ball(0.05, [0.06, 0.0, 0.08]));
    assert!(differ(&found(&above, &below), &[(0.03, 0.0)]) < 2e-4);
    // A box flush on a ramp.
    let turn = Rotation::from_rotation_y(0.2);
    let ramp = turned(boxed([1.0, 1.0, 0.1], [0.0; 3]), turn);
    let block = turned(boxed([0.1, 0.1, 0.1], (turn * Vector::Z * 0.1).to_array()), turn);
    let corner = |x: f64, y: f64| (turn * Vector::new(x, y, 0.05)).truncate();
    let corners = [(-0.05, -0.05), (0.05, -0.05), (0.05, 0.05), (-0.05, 0.05)].map(|(x, y)| corner(x, y));
    assert!(differ(&found(&block, &ramp), &corners.map(|c| (c.x, c.y))) < 2e-4);
}

#[test]
fn meshes_clouds_and_compounds() {
    // A cube as a mesh, on the table's edge.
    let corner = |i: u32| Vector::from([0, 1, 2].map(|a| if i >> a & 1 == 1 { 0.05 } else { -0.05 }));
    let faces = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let mesh = Triangles { vertices: (0..8).map(corner).collect(), faces: faces.to_vec() };
    let parts: Vec<_> = convex_parts(&mesh).expect("parts").into_iter().map(|p| (Pose::IDENTITY, p)).collect();
    let cube = thing(parts, Pose::translation(0.01, 0.0, 0.05));
    let square = [(-0.04, -0.05), (0.0, -0.05), (0.0, 0.05), (-0.04, 0.05)];
    assert!(differ(&found(&cube, &table()), &square) < 5e-5);
    assert!(
        differ(
            &found(&boxed([0.2, 0.2, 0.1], [0.01, 0.0, 0.15]), &cube),
            &[(-0.04, -0.05), (0.06, -0.05), (0.06, 0.05), (-0.04, 0.05)]
        ) < 5e-5
    );
    // A table of one sheet, and one of points.
    let sheet = Triangles {
        vertices: [(-0.3, -0.3), (0.0, -0.3), (0.0, 0.3), (-0.3, 0.3)].map(|(x, y)| Vector::new(x, y, 0.0)).to_vec(),
        faces: vec![[0, 1, 2], [0, 2, 3]],
    };
    let parts: Vec<_> = convex_parts(&sheet).expect("parts").into_iter().map(|p| (Pose::IDENTITY, p)).collect();
    let upper = boxed([0.1, 0.1, 0.1], [0.01, 0.0, 0.05]);
    assert!(differ(&found(&upper, &thing(parts, Pose::IDENTITY)), &square) < 5e-5);
    let points: Vec<Vector> =
        (0..400).map(|i| Vector::new(f64::from(i % 20) * -0.01, f64::from(i / 20) * 0.01 - 0.1, -0.002)).collect();
    let cloud = thing(vec![(Pose::IDENTITY, balls(&points, 0.002))], Pose::IDENTITY);
    assert!(differ(&found(&upper, &cloud), &square) < 5e-5);
    // Three legs, one of them 0.5 mm short, under a heavy top.
    let legs = [(0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 5e-4)];
    let leg = |(x, y, short): (f64, f64, f64)| {
        let (turn, shape) = cylinder_along_z(1e-3, 0.1 - short);
        (Pose::translation(x, y, 0.05 + short / 2.0) * turn, shape)
    };
    let mut pieces: Vec<_> = legs.map(leg).to_vec();
    pieces.push((Pose::translation(0.05, 0.05, 0.11), cuboid([0.2, 0.2, 0.02])));
    let stool = thing(pieces, Pose::translation(-0.3, 0.0, 0.0));
    assert!(differ(&found(&stool, &table()), &[(-0.3, 0.0), (-0.2, 0.0), (-0.3, 0.1)]) < 1.5e-3);
}
