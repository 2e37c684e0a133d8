//! Any URDF as a robot: kinematic tree, limits, forward and inverse kinematics, hands and their preset grasps.

pub mod description;
pub mod group;
pub mod inverse;
pub mod kinematics;
pub mod reachability;
pub mod report;
pub mod spheres;

pub use description::{Hand, Joint, JointKind, Link, MeshSource, Mimic, Robot};
pub use group::Group;
pub use inverse::InverseKinematics;
pub use kinematics::{Kinematics, LinkStep, Motion};
pub use reachability::{Aim, Placement, Reachability, Root};
pub use spheres::{Sphere, bounding as bounding_sphere, cover, cover_link};
