//! Poses, convex shapes, footprints, and the distances between them.
//!
//! Everything is in metres and radians, right-handed, z up, `f64`. A shape's own frame sits at its
//! centre; cylinders and capsules stand along their own z.

pub mod convex;
pub mod distance;
pub mod footprint;
pub mod hull;
pub mod mass;
pub mod polygon;
pub mod pose;
pub mod ray;
pub mod section;
pub mod signed_distance;

pub use convex::{Convex, Solid};
pub use footprint::Circle;
pub use mass::Mass;
pub use pose::Pose;

pub use glam::{DMat3 as Mat3, DQuat as Quat, DVec2 as Vec2, DVec3 as Vec3};
