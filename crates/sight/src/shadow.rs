//! What cannot be seen for something that stands in between.
//!
//! The points that a convex body hides, it included, are a convex set: the body, and all that is beyond
//! it seen from the eye. Cut off at the region it is the hull of a few points.

use crate::view::{Region, View};
use clearway_geometry::convex::Hull;
use clearway_geometry::hull::convex_hull;
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Sides of the polygon round a circle.
const SIDES: usize = 12;

/// Where a shadow begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Begins {
    /// With the body.
    Front,
    /// At the middle of a round body, as the points of its front are in view; with any other.
    Middle,
    /// Behind the body, by this much, metres.
    Behind(f64),
}

/// The parts of a placed solid's shadow within the region, in the world.
pub fn shadow(view: &View, region: &Region, solid: &Solid, pose: &Pose, begins: Begins) -> Solid {
    let part = |(part, convex): &(Pose, Convex)| hull_of_shadow(view, region, convex, &(*pose * *part), begins);
    Solid { parts: solid.parts.iter().filter_map(part).collect() }
}

/// The region's parts outside of the picture.
pub fn out_of_view(view: &View, region: &Region) -> Solid {
    let part = |inward: Vec3| {
        let outside = (inward, inward.dot(view.eye));
        hull_within(region.corners().to_vec(), &[outside])
    };
    Solid { parts: view.sides().into_iter().filter_map(part).collect() }
}

fn hull_of_shadow(
    view: &View,
    region: &Region,
    convex: &Convex,
    pose: &Pose,
    begins: Begins,
) -> Option<(Pose, Convex)> {
    let body = corners(convex, pose);
    let middle = pose.translation - view.eye;
    let level = middle.with_z(0.0);
    let away = if level.length() > 0.1 * middle.length() { level.normalize() } else { middle.normalize_or_zero() };
    let along = || body.iter().map(|p| p.dot(away));
    let (front, back) = (along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max));
    let round = !matches!(convex, Convex::Box { .. } | Convex::Hull(_));
    let from = match begins {
        Begins::Front => front,
        Begins::Middle if round => pose.translation.dot(away),
        Begins::Middle => front,
        Begins::Behind(gap) => back + gap,
    };
    let mut faces = region.faces().to_vec();
    let near = match outlined(view, &body, away, from) {
        Some(outline) if round => outline,
        _ => {
            faces.push((-away, -from));
            body
        }
    };
    let farthest = region.corners().iter().map(|c| c.distance(view.eye)).fold(0.0, f64::max);
    let nearest = near.iter().map(|p| p.distance(view.eye)).fold(f64::INFINITY, f64::min);
    // As long as the shadow widens, its end is beyond the region.
    let times = 1.0 + 4.0 * farthest / nearest.max(1e-3);
    let beyond = near.iter().map(|p| view.eye + (*p - view.eye) * times);
    hull_within(near.iter().copied().chain(beyond).collect(), &faces)
}

/// The corners of a rectangle `from` the origin along `away` that hides all that the body hides beyond it: of few
/// faces, and hardly larger for what stands upright. `None` when the body is not before the eye.
fn outlined(view: &View, body: &[Vec3], away: Vec3, from: f64) -> Option<Vec<Vec3>> {
    let side = if away.z.abs() < 0.9 { away.cross(Vec3::Z).normalize() } else { Vec3::X };
    let up = side.cross(away);
    let depth = from - view.eye.dot(away);
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for p in body {
        let line = *p - view.eye;
        let reach = line.dot(away);
        if reach < 1e-3 || depth < 1e-3 {
            return None;
        }
        let at = view.eye + line * (depth / reach);
        let at = Vec3::new(at.dot(side), at.dot(up), 0.0);
        (low, high) = (low.min(at), high.max(at));
    }
    let corner = |x: f64, y: f64| away * from + side * x + up * y;
    Some(vec![corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)])
}

/// The hull of the points, cut off at the faces, about its middle.
fn hull_within(points: Vec<Vec3>, faces: &[(Vec3, f64)]) -> Option<(Pose, Convex)> {
    let mut hull = convex_hull(&points).ok()?;
    for &(normal, offset) in faces {
        let over = |p: &Vec3| p.dot(normal) - offset;
        if hull.points.iter().all(|p| over(p) <= 0.0) {
            continue;
        }
        let mut kept: Vec<Vec3> = hull.points.iter().filter(|p| over(p) <= 0.0).copied().collect();
        for [a, b, c] in &hull.triangles {
            for (i, j) in [(a, b), (b, c), (c, a)] {
                let (p, q) = (hull.points[*i as usize], hull.points[*j as usize]);
                let (at_p, at_q) = (over(&p), over(&q));
                if i < j && (at_p < 0.0) != (at_q < 0.0) && at_p != at_q {
                    kept.push(p + (q - p) * (at_p / (at_p - at_q)));
                }
            }
        }
        hull = convex_hull(&kept).ok()?;
    }
    let (low, high) = hull.points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    // Thinner than a millimetre it hides nothing.
    ((high - low).min_element() > 1e-3).then(|| centred(hull, (low + high) / 2.0))
}

fn centred(hull: Hull, middle: Vec3) -> (Pose, Convex) {
    let points = hull.points.iter().map(|p| *p - middle).collect();
    let planes = hull.planes.iter().map(|(n, d)| (*n, d - n.dot(middle))).collect();
    let hull = Hull { points, triangles: hull.triangles, planes };
    (Pose::from_translation(middle), Convex::Hull(Arc::new(hull)))
}

/// Points whose hull holds the shape.
fn corners(convex: &Convex, pose: &Pose) -> Vec<Vec3> {
    let ring = |radius: f64, z: f64| {
        let round = radius / (TAU / (2 * SIDES) as f64).cos();
        (0..SIDES).map(move |i| {
            let angle = TAU * i as f64 / SIDES as f64;
            Vec3::new(round * angle.cos(), round * angle.sin(), z)
        })
    };
    let box_of = |half: Vec3| (0..8).map(move |i| half * Vec3::new(sign(i), sign(i >> 1), sign(i >> 2)));
    let own: Vec<Vec3> = match convex {
        Convex::Cylinder { radius, half } => ring(*radius, -half).chain(ring(*radius, *half)).collect(),
        Convex::Capsule { radius, half } => ring(*radius, -half - radius).chain(ring(*radius, half + radius)).collect(),
        Convex::Sphere { radius } => ring(*radius, -radius).chain(ring(*radius, *radius)).collect(),
        Convex::Box { half } => box_of(*half).collect(),
        Convex::Hull(hull) => hull.points.clone(),
    };
    own.into_iter().map(|p| pose.point(p)).collect()
}

fn sign(i: usize) -> f64 {
    if i & 1 == 1 { 1.0 } else { -1.0 }
}
