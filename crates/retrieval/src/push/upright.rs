//! Near-cylinders: what slides straight before a hand, and when it tips.

use clearway_geometry::{Convex, Pose, Solid, Vec3};

/// Cylinders that stand upright on one axis, like a bottle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upright {
    /// Of the bottom face, metres.
    pub radius: f64,
    /// Of the bottom face, along up.
    pub bottom: f64,
}

/// How far axes may be off each other, metres, and their directions from up.
const OFF_AXIS: f64 = 1e-6;
/// Bottom faces within this of the lowest are the bottom, metres.
const LEVEL: f64 = 1e-4;

impl Upright {
    /// `None` for anything else.
    pub fn of(solid: &Solid, pose: &Pose, up: Vec3) -> Option<Self> {
        let mut cylinders = Vec::new();
        for (part, convex) in &solid.parts {
            let Convex::Cylinder { radius, half } = convex else { return None };
            let placed = *pose * *part;
            if placed.rotation.z_axis.dot(up).abs() < 1.0 - OFF_AXIS {
                return None;
            }
            cylinders.push((placed.translation, *radius, placed.translation.dot(up) - half));
        }
        let (axis, ..) = *cylinders.first()?;
        if cylinders.iter().any(|(at, ..)| (*at - axis).reject_from(up).length() > OFF_AXIS) {
            return None;
        }
        let bottom = cylinders.iter().map(|c| c.2).fold(f64::INFINITY, f64::min);
        let radius = cylinders.iter().filter(|c| c.2 <= bottom + LEVEL).map(|c| c.1).fold(0.0, f64::max);
        Some(Self { radius, bottom })
    }

    /// Pushed level and higher than this above its bottom, it tips before it slides: the push, µ·m·g at height h,
    /// then turns it over its edge more than its weight holds it, m·g at r.
    pub fn tips_at(&self, friction: f64) -> f64 {
        self.radius / friction
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use clearway_geometry::Mat3;

    fn cylinder(radius: f64, half: f64, at: [f64; 3]) -> (Pose, Convex) {
        (Pose::from_translation(Vec3::from_array(at)), Convex::Cylinder { radius, half })
    }

    #[test]
    fn bottles_are_upright_round_their_axis() {
        let bottle = Solid { parts: vec![cylinder(0.035, 0.09, [0.0; 3]), cylinder(0.014, 0.03, [0.0, 0.0, 0.12])] };
        let stands = Pose::from_translation(Vec3::new(0.4, 0.1, 1.09));
        let upright = Upright::of(&bottle, &stands, Vec3::Z).unwrap();
        assert_eq!(upright.radius, 0.035);
        assert!((upright.bottom - 1.0).abs() < 1e-12);
        assert!((upright.tips_at(0.5) - 0.07).abs() < 1e-12);
        // On its head the neck is what it stands on.
        let turned = Pose::new(Mat3::from_rotation_x(std::f64::consts::PI), stands.translation);
        assert_eq!(Upright::of(&bottle, &turned, Vec3::Z).unwrap().radius, 0.014);
    }

    #[test]
    fn others_are_not() {
        let lying = Pose::new(Mat3::from_rotation_x(1.0), Vec3::ZERO);
        let can = Solid { parts: vec![cylinder(0.03, 0.05, [0.0; 3])] };
        assert_eq!(Upright::of(&can, &lying, Vec3::Z), None);
        let cup = Solid { parts: vec![cylinder(0.03, 0.05, [0.0; 3]), cylinder(0.01, 0.02, [0.03, 0.0, 0.0])] };
        assert_eq!(Upright::of(&cup, &Pose::IDENTITY, Vec3::Z), None);
        let cuboid = Solid::new(Convex::Box { half: Vec3::splat(0.03) });
        assert_eq!(Upright::of(&cuboid, &Pose::IDENTITY, Vec3::Z), None);
        assert_eq!(Upright::of(&Solid::new(Convex::Sphere { radius: 0.03 }), &Pose::IDENTITY, Vec3::Z), None);
    }
}
