//! Any URDF as a robot: kinematic tree, limits, forward and inverse kinematics, hands and their preset grasps.

pub mod description;
pub mod inverse;
pub mod kinematics;
pub mod report;
pub mod spheres;

pub use description::{Hand, Joint, JointKind, Link, MeshSource, Mimic, Robot};
pub use inverse::InverseKinematics;
pub use kinematics::Kinematics;
pub use spheres::{Sphere, bounding as bounding_sphere, cover};
