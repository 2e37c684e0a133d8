//! Spheres that cover a link, for quick answers: what no sphere meets, the link does not touch.
//!
//! Every point of the solid, inside included, lies in a sphere. A primitive is cut into cells
//! along its axes, a cell's bounding sphere covers it; the excess is about 0.4 of a cell's width.

use clearway_geometry::{Convex, Pose, Solid, Vec3};

/// A ball in the link's frame, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub centre: Vec3,
    pub radius: f64,
}

/// Covers a solid, with cells no wider than `cell` (metres) where the shape is wider than that.
pub fn cover(solid: &Solid, cell: f64) -> Vec<Sphere> {
    let mut spheres = Vec::new();
    for (pose, convex) in &solid.parts {
        for s in cover_convex(convex, cell) {
            spheres.push(Sphere { centre: pose.point(s.centre), radius: s.radius });
        }
    }
    spheres
}

/// Covers a link of any robot: small links, such as fingers, with small cells, large ones coarsely.
/// A link that is made of spheres keeps them as they are.
pub fn cover_link(solid: &Solid) -> Vec<Sphere> {
    const FINEST: f64 = 0.02;
    const COARSEST: f64 = 0.08;
    if solid.parts.is_empty() {
        return Vec::new();
    }
    let (min, max) = solid.aabb(Pose::IDENTITY);
    cover(solid, ((max - min).max_element() / 5.0).clamp(FINEST, COARSEST))
}

/// One sphere round all of them.
pub fn bounding(spheres: &[Sphere]) -> Sphere {
    let Some(first) = spheres.first() else { return Sphere { centre: Vec3::ZERO, radius: 0.0 } };
    // Ritter's: start with a far pair, then grow.
    let far = |from: Vec3| {
        spheres
            .iter()
            .max_by(|a, b| (a.centre.distance(from) + a.radius).total_cmp(&(b.centre.distance(from) + b.radius)))
    };
    let a = far(first.centre).unwrap_or(first);
    let b = far(a.centre).unwrap_or(first);
    let centre = (a.centre + b.centre) / 2.0;
    let mut ball = Sphere { centre, radius: 0.0 };
    for s in spheres {
        ball.radius = ball.radius.max(s.centre.distance(ball.centre) + s.radius);
    }
    ball
}

/// Along a round part spheres stand this part of its radius apart at least: closer ones would stick
/// out hardly less.
const CLOSER: f64 = 0.6;

fn cover_convex(convex: &Convex, cell: f64) -> Vec<Sphere> {
    let along = |half: f64, width: f64, radius: f64| -> Vec<Sphere> {
        let count = ((2.0 * half / width).ceil() as usize).max(1);
        let step = 2.0 * half / count as f64;
        (0..count)
            .map(|i| Sphere {
                centre: Vec3::new(0.0, 0.0, -half + step * (i as f64 + 0.5)),
                radius: radius.hypot(step / 2.0),
            })
            .collect()
    };
    match convex {
        Convex::Sphere { radius } => vec![Sphere { centre: Vec3::ZERO, radius: *radius }],
        Convex::Capsule { radius, half } => {
            let mut spheres = along(*half, cell.max(CLOSER * radius), *radius);
            for end in [-half, *half] {
                spheres.push(Sphere { centre: Vec3::new(0.0, 0.0, end), radius: *radius });
            }
            spheres
        }
        Convex::Cylinder { radius, half } if *radius <= 2.0 * half => along(*half, cell.max(CLOSER * radius), *radius),
        Convex::Cylinder { radius, half } => grid(Vec3::new(*radius, *radius, *half), Vec3::ZERO, cell, convex),
        Convex::Box { half } => grid(*half, Vec3::ZERO, cell, convex),
        Convex::Hull(hull) => {
            let (min, max) =
                hull.points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
            grid((max - min) / 2.0, (max + min) / 2.0, cell, convex)
        }
    }
}

/// Metres.
const THICK: f64 = 0.1;

/// Cells of a box, those kept that meet the shape.
fn grid(half: Vec3, centre: Vec3, cell: f64, convex: &Convex) -> Vec<Sphere> {
    // A plate is one layer of spheres; what is thicker than that has several, or they would stick out far.
    let thin = half.min_element() * 2.0;
    let layers = if thin > THICK { 3.0 } else { 1.0 };
    let width = cell.max(thin / layers);
    let count = (half * 2.0 / width).ceil().max(Vec3::ONE).min(Vec3::splat(16.0));
    let step = half * 2.0 / count;
    let radius = step.length() / 2.0;
    let brick = Convex::Box { half: step / 2.0 };
    let mut spheres = Vec::new();
    for i in 0..count.x as usize {
        for j in 0..count.y as usize {
            for k in 0..count.z as usize {
                let at = centre - half + step * (Vec3::new(i as f64, j as f64, k as f64) + 0.5);
                if clearway_geometry::distance::closer_than(
                    convex,
                    &Pose::IDENTITY,
                    &brick,
                    &Pose::from_translation(at),
                    1e-9,
                ) {
                    spheres.push(Sphere { centre: at, radius });
                }
            }
        }
    }
    spheres
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_is_covered() {
        let cube: Vec<Vec3> =
            (0..8).map(|i| Vec3::new((i & 1) as f64 * 0.1, (i >> 1 & 1) as f64 * 0.2, (i >> 2) as f64 * 0.3)).collect();
        let hull = clearway_geometry::hull::convex_hull(&cube).expect("a box");
        let shapes = [
            Convex::Capsule { radius: 0.05, half: 0.2 },
            Convex::Cylinder { radius: 0.07, half: 0.25 },
            Convex::Cylinder { radius: 0.2, half: 0.01 },
            Convex::Box { half: Vec3::new(0.3, 0.02, 0.08) },
            Convex::Hull(std::sync::Arc::new(hull)),
        ];
        for shape in shapes {
            let spheres = cover(&Solid::new(shape.clone()), 0.05);
            assert!(!spheres.is_empty() && spheres.len() < 200, "{shape:?}: {}", spheres.len());
            let ball = bounding(&spheres);
            for i in 0..4000 {
                let t = i as f64;
                let d = Vec3::new((t * 0.37).sin(), (t * 0.73).cos(), (t * 1.31).sin());
                // From deep inside to the surface.
                let p = shape.support(d) * (1.0 - 0.9 * (t * 0.11).sin().abs().powi(4));
                if shape.point_distance(p) > 1e-9 {
                    continue;
                }
                assert!(spheres.iter().any(|s| s.centre.distance(p) <= s.radius + 1e-9), "{shape:?} at {p}");
                assert!(ball.centre.distance(p) <= ball.radius + 1e-9);
            }
        }
    }
}
