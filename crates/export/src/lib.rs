//! Plans in other programs' formats: one [`Exporter`], one file per format.
//!
//! Everything is read from the [`PlanFile`] alone, but for the meshes that MCAP draws. Metres, radians, seconds; time counts from the
//! plan's first row and rises strictly. A plan that cannot be put in order (rows that do not fit
//! the joints, a clock that stands still) is an [`ExportError`] that names the place.

use clearway_plan::PlanFile;

pub mod csv;
mod differences;
mod error;
mod gap;
pub mod joint_trajectory;
mod kinds;
pub mod mcap;
mod mesh;
mod rename;
mod rows;
mod sequence;
mod urdf;

pub use csv::{Csv, csv};
pub use error::ExportError;
pub use joint_trajectory::{JointTrajectory, Layout, joint_trajectory};
pub use mcap::{Mcap, mcap};
pub use mesh::Mesh;
pub use rename::rename_joints;

/// Writes a plan in one format.
pub trait Exporter {
    /// What `--to` calls it.
    fn name(&self) -> &'static str;

    /// What its files end in, without the dot.
    fn extension(&self) -> &'static str;

    /// The file's content.
    fn export(&self, plan: &PlanFile) -> Result<Vec<u8>, ExportError>;
}

/// All formats, with their defaults.
pub fn exporters() -> Vec<Box<dyn Exporter>> {
    vec![Box::new(JointTrajectory::default()), Box::new(Mcap::default()), Box::new(Csv)]
}
