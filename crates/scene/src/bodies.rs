//! A scene file's shapes and poses for other documents: motion problems list their obstacles so.

use crate::source::Source;
use crate::{Fixture, ids, numbers, pose, shape};
use clearway_files::{FileError, Located};
use clearway_geometry::{Pose, Solid};
use clearway_plan::scene_file::{Body, PoseKeys};
use std::path::Path;
use std::sync::Arc;

/// Reads bodies out of one document. `keys` say where in it they stand, with dots: `obstacles.3`.
/// Files that a shape names lie below `directory`.
pub struct Bodies<'a> {
    source: Source<'a>,
    directory: &'a Path,
}

impl<'a> Bodies<'a> {
    pub fn new<T>(document: &'a Located<T>, directory: &'a Path) -> Self {
        Self { source: Source::text(document), directory }
    }

    /// What stands around the robot; ids are names that can be told apart.
    pub fn obstacles(&self, keys: &str, bodies: &[Body]) -> Result<Vec<Fixture>, FileError> {
        ids::unique(&self.source, keys, "obstacle", bodies.iter().map(|b| b.id.as_str()))?;
        let mut reader = shape::Reader::new(&self.source, self.directory);
        let read = bodies.iter().enumerate().map(|(i, body)| {
            let (solid, pose) = reader.body(&format!("{keys}.{i}"), body, shape::Role::Obstacle)?;
            Ok(Fixture { id: body.id.clone(), solid: Arc::new(solid), pose })
        });
        read.collect()
    }

    /// What a robot holds: its solid, and where that is in the frame of what holds it.
    pub fn held(&self, keys: &str, body: &Body) -> Result<(Solid, Pose), FileError> {
        ids::usable(&self.source, keys, "attached", &body.id)?;
        shape::Reader::new(&self.source, self.directory).body(keys, body, shape::Role::Held)
    }

    pub fn pose(&self, keys: &str, pose: &PoseKeys) -> Result<Pose, FileError> {
        pose::of_keys(&self.source, keys, pose)
    }

    /// The number at `keys`, which has to be a size that things have, metres.
    pub fn size(&self, keys: &str, what: &str, value: f64) -> Result<f64, FileError> {
        numbers::size(&self.source, keys, what, value)
    }

    /// An error about the value at `keys`.
    pub fn error(&self, keys: &str, found: impl Into<String>) -> FileError {
        self.source.error(keys, found)
    }
}
