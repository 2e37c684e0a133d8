//! A URDF's links and joints as a tree: what is left of the file once it was found sound.

use clearway_geometry::{Pose, Solid, Vec3};
use std::path::PathBuf;

/// Links and joints, parents before children.
#[derive(Clone, Debug)]
pub struct Model {
    pub name: String,
    /// The root is first.
    pub links: Vec<Link>,
    /// The joint of each link but the root, in the order of `links`.
    pub joints: Vec<Joint>,
    pub meshes: Vec<MeshSource>,
}

#[derive(Clone, Debug)]
pub struct Link {
    pub name: String,
    /// None for the root.
    pub parent_joint: Option<usize>,
    /// What may touch, in the link's frame; without parts if the link has no collision shape.
    pub collision: Solid,
    /// What each of the URDF's `<collision>` elements was, in order, and how many parts it became.
    pub collision_kinds: Vec<(CollisionKind, usize)>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CollisionKind {
    Box,
    Cylinder,
    Sphere,
    Capsule,
    /// By its URI; taken as the convex hulls of its connected parts.
    Mesh(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    Fixed,
    Revolute,
    Continuous,
    Prismatic,
}

#[derive(Clone, Debug)]
pub struct Joint {
    pub name: String,
    pub kind: JointKind,
    /// Links.
    pub parent: usize,
    pub child: usize,
    /// At joint value 0, the child's frame is this one.
    pub parent_from_joint: Pose,
    /// In the joint's frame, of unit length.
    pub axis: Vec3,
    /// Radians or metres; infinite for a continuous joint, both 0 for a fixed one.
    pub lower: f64,
    pub upper: f64,
    /// rad/s or m/s; infinite if the URDF gives none.
    pub velocity: f64,
    pub mimic: Option<Mimic>,
}

impl Joint {
    pub fn moves(&self) -> bool {
        self.kind != JointKind::Fixed
    }

    /// 0, or the limit nearest to it.
    pub fn rest(&self) -> f64 {
        0.0_f64.clamp(self.lower, self.upper)
    }

    pub fn allows(&self, value: f64) -> bool {
        // Limits are often written with fewer digits than the values that are meant to reach them.
        const ROUNDING: f64 = 1e-9;
        (self.lower - ROUNDING..=self.upper + ROUNDING).contains(&value)
    }
}

/// The joint's value is `multiplier · value of joint + offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mimic {
    pub joint: usize,
    pub multiplier: f64,
    pub offset: f64,
}

/// A mesh file that collision shapes came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshSource {
    /// As the URDF names it.
    pub uri: String,
    pub path: PathBuf,
    /// Of the file's bytes, in lower-case hexadecimal.
    pub sha256: String,
}
