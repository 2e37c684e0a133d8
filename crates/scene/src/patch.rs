//! Where one solid can press on another that carries it: a convex polygon seen from above.
//!
//! Of two convex parts that touch it is what their cross-sections share: the upper one's a hair above
//! the height where they touch, the lower one's a hair below. Of two bodies it is the hull of those of
//! their parts, since a force may be split between parts.
//!
//! A face or an edge that is level but for noise is taken as level: things stand flat, however their
//! tilt was measured.

use crate::NOISE;
use crate::contact::{Part, Placed, clearance, support};
use clearway_geometry::distance::between;
use clearway_geometry::{Convex, Pose, Quat, Vec2, Vec3, polygon};

/// Cross-sections are taken this far (metres) from where two parts touch, and farther where they miss.
const HAIR: f64 = 1e-7;
/// Of a mesh, whose corners are rounded numbers.
const MESH_HAIR: f64 = 2e-5;
/// And never farther than this.
const FARTHEST: f64 = 1e-4;
/// The direction in which two parts touch is looked at with this much between them.
const GAP: f64 = 1e-5;
/// What touches over less of a height than this (metres) does so at one height.
const SLOPE: f64 = 1e-4;
/// A contact steeper than this, as the height of its unit normal, carries nothing.
const STEEP: f64 = 0.1;
/// No tilt beyond this, radians, is noise.
const TILT: f64 = 0.05;
/// Triangles of a mesh that differ by less (radians) are of one face.
const FOLD: f64 = 1e-3;
/// How far (radians) to look aside for the other end of a face or edge that touches.
const ASIDE: f64 = 1e-3;

/// Where *a* can press on *b*, when it stands within so much (metres) of touching it from above.
pub(crate) fn patch(a: &Placed, b: &Placed, within: f64) -> Vec<Vec2> {
    let mut corners = Vec::new();
    for (a, b) in a.pairs(b) {
        if a.min.z - b.max.z > within || a.max.z < b.min.z {
            continue;
        }
        if clearance(a, b).is_some_and(|c| c.abs() <= within) {
            corners.extend(touch(a, b));
        }
    }
    polygon::hull(corners)
}

/// The patch of two parts, the upper one let down until it touches.
fn touch(a: &Part, b: &Part) -> Vec<Vec2> {
    let extent = |p: &Part| (p.max - p.min).truncate().max_element();
    let reach = extent(a).min(extent(b));
    let flat_a = Part::new(a.convex, levelled(a.convex, a.pose, -1.0, reach));
    let flat_b = Part::new(b.convex, levelled(b.convex, b.pose, 1.0, reach));
    // A part that only just reaches another may miss it when it is level.
    match clearance(&flat_a, &flat_b) {
        Some(fall) => shared(&flat_a, &flat_b, fall),
        None => clearance(a, b).map_or_else(Vec::new, |fall| shared(a, b, fall)),
    }
}

fn shared(a: &Part, b: &Part, fall: f64) -> Vec<Vec2> {
    let lowered = |by: f64| Pose::new(a.pose.rotation, a.pose.translation - by * Vec3::Z);
    let Some(normal) = between(a.convex, &lowered(fall - GAP), b.convex, &b.pose).and_then(Vec3::try_normalize) else {
        return Vec::new();
    };
    if normal.z < STEEP {
        return Vec::new();
    }
    let down = lowered(fall);
    let heights = heights(&|d| support(a.convex, &down, -d).z, &|d| support(b.convex, &b.pose, d).z, normal);
    let hair = |p: &Part| if matches!(p.convex, Convex::Hull(_)) { MESH_HAIR } else { HAIR };
    for times in [1.0, 10.0, 100.0, 1000.0] {
        let (up, low) = ((times * hair(a)).min(FARTHEST), (times * hair(b)).min(FARTHEST));
        let slice = |z: &f64| polygon::clip(&a.convex.section(&down, z + up), &b.convex.section(&b.pose, z - low));
        let corners: Vec<Vec2> = heights.iter().flat_map(slice).collect();
        if !corners.is_empty() {
            return corners;
        }
    }
    Vec::new()
}

/// The heights at which to cut two parts that touch along `normal`: one, unless they do so along a slope.
fn heights(of_a: &dyn Fn(Vec3) -> f64, of_b: &dyn Fn(Vec3) -> f64, normal: Vec3) -> Vec<f64> {
    let Some(slope) = (Vec3::Z - normal.z * normal).try_normalize() else {
        return vec![(of_a(normal) + of_b(normal)) / 2.0];
    };
    let span = |of: &dyn Fn(Vec3) -> f64| {
        let (x, y) = (of(normal + ASIDE * slope), of(normal - ASIDE * slope));
        (x.min(y), x.max(y))
    };
    let (a, b) = (span(of_a), span(of_b));
    let (low, high) = (a.0.max(b.0), a.1.min(b.1));
    let middle = (low + high) / 2.0;
    if high - low > SLOPE { vec![low, middle, high] } else { vec![middle] }
}

/// The pose with the face or the edge that looks up (1) or down (-1) made level, if over a length of
/// `reach` it rises by no more than noise.
fn levelled(convex: &Convex, pose: Pose, up: f64, reach: f64) -> Pose {
    let most = (NOISE / reach.max(NOISE)).min(TILT);
    let rotation = &pose.rotation;
    let turn = |from: Vec3, to: Vec3| {
        let turned = clearway_geometry::Mat3::from_quat(Quat::from_rotation_arc(from, to));
        Pose::new(turned * *rotation, pose.translation)
    };
    let upright = |axis: Vec3| axis.truncate().length() <= most && axis.truncate().length() > 0.0;
    let lying = |axis: Vec3| axis.z.abs() <= most && axis.z != 0.0;
    let stand = |axis: Vec3| turn(axis, Vec3::Z * axis.z.signum());
    let lie = |axis: Vec3| turn(axis, axis.with_z(0.0).normalize());
    match convex {
        Convex::Sphere { .. } => pose,
        Convex::Cylinder { .. } if upright(rotation.z_axis) => stand(rotation.z_axis),
        Convex::Cylinder { .. } | Convex::Capsule { .. } if lying(rotation.z_axis) => lie(rotation.z_axis),
        Convex::Cylinder { .. } | Convex::Capsule { .. } => pose,
        Convex::Box { .. } => {
            let axes = [rotation.x_axis, rotation.y_axis, rotation.z_axis];
            let standing = axes.into_iter().find(|a| a.truncate().length() <= most);
            let edge = || axes.into_iter().find(|a| lying(*a)).map_or(pose, lie);
            standing.map_or_else(edge, |axis| if upright(axis) { stand(axis) } else { pose })
        }
        Convex::Hull(hull) => {
            // The largest of the faces that are nearly level, as the sums of their triangles' normals,
            // which are as long as those are large.
            let mut faces: Vec<Vec3> = Vec::new();
            for [a, b, c] in hull.triangles.iter().map(|t| t.map(|i| hull.points[i as usize])) {
                let normal = *rotation * (b - a).cross(c - a);
                if normal.z * up <= normal.length() * (1.0 - most * most).sqrt() {
                    continue;
                }
                match faces.iter_mut().find(|n| n.angle_between(normal) < FOLD) {
                    Some(sum) => *sum += normal,
                    None => faces.push(normal),
                }
            }
            let largest = faces.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
            largest.map(Vec3::normalize).filter(|n| upright(*n)).map_or(pose, stand)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clearway_geometry::Solid;
    use clearway_geometry::hull::convex_hull;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    use std::sync::Arc;

    fn cuboid(x: f64, y: f64, z: f64) -> Convex {
        Convex::Box { half: Vec3::new(x, y, z) / 2.0 }
    }

    fn tilted(roll: f64, pitch: f64, z: f64) -> Pose {
        Pose::from_rpy([roll, pitch, 0.0], Vec3::new(0.0, 0.0, z))
    }

    /// From where to where, along x and y.
    fn extent(a: &Convex, pa: Pose, b: &Convex, pb: Pose) -> Option<(Vec2, Vec2)> {
        let (a, b) = (Solid::new(a.clone()), Solid::new(b.clone()));
        let found = patch(&Placed::new(&a, pa), &Placed::new(&b, pb), 1e-3);
        let low = found.iter().copied().reduce(Vec2::min)?;
        Some((low, found.into_iter().reduce(Vec2::max)?))
    }

    #[track_caller]
    fn is(found: Option<(Vec2, Vec2)>, low: [f64; 2], high: [f64; 2], by: f64) {
        let Some((l, h)) = found else { panic!("no patch") };
        assert!(l.distance(low.into()) < by && h.distance(high.into()) < by, "{l} {h}");
    }

    #[test]
    fn flat_on_flat_is_what_both_have() {
        let table = cuboid(1.0, 1.0, 0.02);
        let at = |x: f64, z: f64| Pose::from_translation(Vec3::new(x, 0.0, z));
        for gap in [0.0, 5e-4, -5e-4] {
            let found = extent(&cuboid(0.2, 0.1, 0.1), at(0.45, 0.06 + gap), &table, at(0.0, 0.0));
            is(found, [0.35, -0.05], [0.5, 0.05], 1e-6);
        }
        assert_eq!(extent(&cuboid(0.2, 0.1, 0.1), at(0.45, 0.062), &table, at(0.0, 0.0)), None);
        assert_eq!(extent(&cuboid(0.2, 0.1, 0.1), at(0.61, 0.06), &table, at(0.0, 0.0)), None);
        let can = Convex::Cylinder { radius: 0.04, half: 0.1 };
        is(extent(&can, at(0.0, 0.11), &table, at(0.0, 0.0)), [-0.04; 2], [0.04; 2], 1e-4);
        is(extent(&can, at(0.0, 0.2), &can, at(0.05, 0.0)), [0.01, -0.0312], [0.04, 0.0312], 2e-4);
    }

    #[test]
    fn edges_lines_and_points() {
        let table = (cuboid(1.0, 1.0, 0.02), tilted(0.0, 0.0, -0.01));
        let lying = Convex::Cylinder { radius: 0.04, half: 0.1 };
        is(extent(&lying, tilted(FRAC_PI_2, 0.0, 0.04), &table.0, table.1), [0.0, -0.1], [0.0, 0.1], 1e-4);
        let edge = extent(&cuboid(0.2, 0.1, 0.1), tilted(FRAC_PI_4, 0.0, 0.005_f64.sqrt()), &table.0, table.1);
        is(edge, [-0.1, 0.0], [0.1, 0.0], 1e-5);
        let ball = Convex::Sphere { radius: 0.05 };
        is(extent(&ball, tilted(0.0, 0.0, 0.05), &table.0, table.1), [0.0; 2], [0.0; 2], 2e-4);
        // A ball on the shoulder of another touches between the centres.
        let shoulder = Pose::from_translation(Vec3::new(0.06, 0.0, 0.08));
        is(extent(&ball, shoulder, &ball, Pose::IDENTITY), [0.03, 0.0], [0.03, 0.0], 5e-4);
        // Beside it, it is not carried.
        assert_eq!(extent(&ball, Pose::from_translation(Vec3::new(0.09999, 0.0, 5e-4)), &ball, Pose::IDENTITY), None);
        // A board across an edge of a leaning box.
        let roof = tilted(FRAC_PI_4, 0.0, 0.0);
        let found =
            extent(&cuboid(0.05, 0.3, 0.02), tilted(0.0, 0.0, 0.01 + 0.005_f64.sqrt()), &cuboid(1.0, 0.1, 0.1), roof);
        is(found, [-0.025, 0.0], [0.025, 0.0], 1e-5);
    }

    #[test]
    fn a_slope_is_touched_along_all_of_it() {
        let (upper, lower) = (cuboid(0.1, 0.1, 0.02), cuboid(0.3, 0.3, 0.02));
        let up = 0.02 / 0.5_f64.cos();
        let found = extent(&upper, tilted(0.0, 0.5, up), &lower, tilted(0.0, 0.5, 0.0));
        // The middle of its lower face lies off its own by as much as it leans.
        let middle = -0.01 * 0.5_f64.sin();
        let reach = 0.05 * 0.5_f64.cos();
        is(found, [middle - reach, -0.05], [middle + reach, 0.05], 1e-4);
    }

    #[test]
    fn what_leans_by_noise_stands_flat() {
        let table = (cuboid(1.0, 1.0, 0.02), tilted(0.0, 0.0, -0.01));
        let mut hull: Vec<Vec3> = Vec::new();
        for i in 0..8 {
            hull.push(Vec3::new(f64::from(i & 1) - 0.5, f64::from(i >> 1 & 1) - 0.5, f64::from(i >> 2) - 0.5) * 0.1);
        }
        hull.push(Vec3::new(0.0, 0.0, 0.08));
        let Ok(hull) = convex_hull(&hull) else { panic!("no hull") };
        for shape in [cuboid(0.1, 0.1, 0.1), Convex::Hull(Arc::new(hull))] {
            for (roll, pitch) in [(0.005, 0.0), (0.0, -0.005), (1e-5, 1e-9), (0.003, 0.003)] {
                let pose = tilted(roll, pitch, 0.05 + 0.05 * (f64::abs(roll) + f64::abs(pitch)));
                is(extent(&shape, pose, &table.0, table.1), [-0.05; 2], [0.05; 2], 1e-3);
            }
            let Some((low, high)) = extent(&shape, tilted(0.03, 0.0, 0.0515), &table.0, table.1) else {
                panic!("no patch")
            };
            assert!((high - low).y < 1e-3, "{low} {high}");
        }
    }
}
