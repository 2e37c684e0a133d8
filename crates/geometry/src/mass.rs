//! How much space a solid fills, and the middle of it: its mass and centre of mass at density 1.
//!
//! One convex part is exact. Where parts of a solid overlap, the space counts once; how much is shared
//! is summed over a grid of rays, exact for boxes along the solid's axes, else to some thousandths.

use crate::convex::Hull;
use crate::ray::stretch;
use crate::{Convex, Pose, Solid};
use glam::DVec3;
use std::f64::consts::PI;

/// Rays along each side of a grid, when few parts overlap.
const FINEST: usize = 48;
/// And when many do; where they are more still, parts count in full.
const COARSEST: usize = 4;
/// Rays for each part of a solid, about.
const RAYS: usize = 2500;
/// Parts that share less than this along an axis (metres) only touch.
const TOUCH: f64 = 1e-6;

/// A volume, m³, and its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mass {
    pub volume: f64,
    pub centre: DVec3,
}

impl Convex {
    /// Of the shape in its own frame.
    pub fn mass(&self) -> Mass {
        let ball = |radius: f64| 4.0 / 3.0 * PI * radius.powi(3);
        let volume = match self {
            Convex::Sphere { radius } => ball(*radius),
            Convex::Capsule { radius, half } => ball(*radius) + 2.0 * half * PI * radius * radius,
            Convex::Cylinder { radius, half } => 2.0 * half * PI * radius * radius,
            Convex::Box { half } => 8.0 * half.x * half.y * half.z,
            Convex::Hull(hull) => return of_hull(hull),
        };
        Mass { volume, centre: DVec3::ZERO }
    }
}

/// Tetrahedra from a point inside to each face.
fn of_hull(hull: &Hull) -> Mass {
    let inside = hull.points.iter().sum::<DVec3>() / hull.points.len().max(1) as f64;
    let (mut volume, mut moment) = (0.0, DVec3::ZERO);
    for triangle in &hull.triangles {
        let [a, b, c] = triangle.map(|i| hull.points[i as usize] - inside);
        let piece = a.dot(b.cross(c)) / 6.0;
        volume += piece;
        moment += piece / 4.0 * (a + b + c);
    }
    if volume > 0.0 { Mass { volume, centre: inside + moment / volume } } else { Mass { volume: 0.0, centre: inside } }
}

impl Solid {
    /// Of all parts together, in the solid's frame.
    pub fn mass(&self) -> Mass {
        let placed = |(pose, convex): &(Pose, Convex)| {
            let mass = convex.mass();
            Mass { centre: pose.point(mass.centre), ..mass }
        };
        let sum = self.parts.iter().map(placed).fold((0.0, DVec3::ZERO), add);
        let shared = if self.parts.len() > 1 { self.shared() } else { (0.0, DVec3::ZERO) };
        let (volume, moment) = (sum.0 - shared.0, sum.1 - shared.1);
        // No parts, or parts without an inside.
        if volume.is_nan() || volume <= 1e-6 * sum.0 {
            let middle = self.parts.iter().map(|(pose, _)| pose.translation).sum::<DVec3>();
            return Mass { volume: sum.0, centre: middle / self.parts.len().max(1) as f64 };
        }
        Mass { volume, centre: moment / volume }
    }

    /// Volume and moment of what parts have in common with those before them.
    fn shared(&self) -> (f64, DVec3) {
        let boxes: Vec<(DVec3, DVec3)> = self.parts.iter().map(|(pose, convex)| convex.aabb(pose)).collect();
        let meet = |a: usize, b: usize| {
            let (low, high) = (boxes[a].0.max(boxes[b].0), boxes[a].1.min(boxes[b].1));
            (high - low).min_element() > TOUCH
        };
        let rays = RAYS * self.parts.len();
        let mut before: Vec<(usize, Vec<usize>)> = Vec::new();
        let mut casts = 1;
        for i in 0..boxes.len() {
            let those: Vec<usize> = (0..i).filter(|j| meet(i, *j)).collect();
            if !those.is_empty() {
                casts += those.len() + 1;
                before.push((i, those));
            }
            if casts * COARSEST * COARSEST > rays {
                return (0.0, DVec3::ZERO);
            }
        }
        let side = ((rays / casts).isqrt()).min(FINEST);
        let (mut volume, mut moment) = (0.0, DVec3::ZERO);
        for (i, before) in &before {
            let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            let around = before.iter().fold(none, |(low, high), j| (low.min(boxes[*j].0), high.max(boxes[*j].1)));
            let (low, high) = (around.0.max(boxes[*i].0), around.1.min(boxes[*i].1));
            let cell = (high - low) / side as f64;
            for k in 0..side * side {
                let (x, y) = ((k % side) as f64 + 0.5, (k / side) as f64 + 0.5);
                let foot = DVec3::new(low.x + x * cell.x, low.y + y * cell.y, 0.0);
                for (from, to) in self.covered(*i, before, foot) {
                    let piece = cell.x * cell.y * (to - from);
                    volume += piece;
                    moment += piece * foot.with_z((from + to) / 2.0);
                }
            }
        }
        (volume, moment)
    }

    /// Where the vertical line through `foot` is within part `i` and one of those before.
    fn covered(&self, i: usize, before: &[usize], foot: DVec3) -> Vec<(f64, f64)> {
        let along = |part: usize| {
            let (pose, convex) = &self.parts[part];
            stretch(convex, pose.inverse_point(foot), pose.rotation.transpose() * DVec3::Z)
        };
        let Some((low, high)) = along(i) else { return Vec::new() };
        let mut pieces: Vec<(f64, f64)> = before.iter().filter_map(|j| along(*j)).collect();
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut top = low;
        let once = pieces.into_iter().map(|(from, to)| {
            let piece = (from.max(top), to.min(high));
            top = top.max(piece.1);
            piece
        });
        once.filter(|(from, to)| from < to).collect()
    }
}

fn add(sum: (f64, DVec3), mass: Mass) -> (f64, DVec3) {
    (sum.0 + mass.volume, sum.1 + mass.volume * mass.centre)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::convex_hull;
    use std::sync::Arc;

    fn at(x: f64, y: f64, z: f64) -> Pose {
        Pose::from_translation(DVec3::new(x, y, z))
    }

    fn cuboid(x: f64, y: f64, z: f64) -> Convex {
        Convex::Box { half: DVec3::new(x, y, z) / 2.0 }
    }

    #[test]
    fn shapes() {
        assert!((Convex::Sphere { radius: 0.1 }.mass().volume - 4.0 / 3.0 * PI * 1e-3).abs() < 1e-15);
        assert!((cuboid(0.1, 0.2, 0.3).mass().volume - 0.006).abs() < 1e-15);
        // A pyramid: its centre is a quarter of the way up.
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0], [1.0, 1.0, 4.0]];
        let hull = convex_hull(&corners.map(DVec3::from_array)).unwrap();
        let mass = Convex::Hull(Arc::new(hull)).mass();
        assert!((mass.volume - 16.0 / 3.0).abs() < 1e-9 && mass.centre.distance(DVec3::new(1.0, 1.0, 1.0)) < 1e-9);
    }

    #[test]
    fn parts_that_touch_add_up() {
        let solid = Solid {
            parts: vec![(at(0.0, 0.0, 0.0), cuboid(2.0, 1.0, 1.0)), (at(2.0, 0.0, 0.0), cuboid(2.0, 1.0, 0.5))],
        };
        let mass = solid.mass();
        assert!((mass.volume - 3.0).abs() < 1e-12 && (mass.centre.x - 2.0 / 3.0).abs() < 1e-12, "{mass:?}");
    }

    #[test]
    fn what_parts_share_counts_once() {
        // A bar through a block: together as if they ended at each other's faces.
        let solid = Solid {
            parts: vec![(at(0.0, 0.0, 0.0), cuboid(0.1, 0.1, 0.1)), (at(0.2, 0.0, 0.0), cuboid(0.5, 0.02, 0.02))],
        };
        let mass = solid.mass();
        let bar = 0.4 * 0.02 * 0.02;
        assert!((mass.volume - 0.001 - bar).abs() < 1e-12, "{mass:?}");
        assert!((mass.centre.x - bar * 0.25 / (0.001 + bar)).abs() < 1e-9, "{mass:?}");
        // Twice the same is the same as once, three times too.
        let ball = (at(0.1, 0.2, 0.3), Convex::Sphere { radius: 0.1 });
        let thrice = Solid { parts: vec![ball.clone(), ball.clone(), ball.clone()] }.mass();
        assert!((thrice.volume / ball.1.mass().volume - 1.0).abs() < 2e-3, "{thrice:?}");
        assert!(thrice.centre.distance(DVec3::new(0.1, 0.2, 0.3)) < 1e-4);
        // Half of a ball in a slab.
        let slab = (at(0.0, 0.0, -0.5), cuboid(1.0, 1.0, 1.0));
        let dome = Solid { parts: vec![slab, (at(0.3, 0.0, 0.0), Convex::Sphere { radius: 0.1 })] }.mass();
        assert!((dome.volume - 1.0 - 2.0 / 3.0 * PI * 1e-3).abs() < 1e-5, "{dome:?}");
    }

    #[test]
    fn nothing_is_nowhere() {
        assert_eq!(Solid::default().mass(), Mass { volume: 0.0, centre: DVec3::ZERO });
    }
}
