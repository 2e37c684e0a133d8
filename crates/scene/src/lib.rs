//! Shelf, objects, target and places: what a scene file says, checked.
//!
//! A [`Scene`] that exists is sound. All numbers are finite and all sizes positive; ids are unique
//! and the target is one of them; no object reaches more than a millimetre into another or into a
//! fixture; each rests on something, exactly, and stays there, as does every stack; every mesh was
//! there. Whatever is not so is a [`FileError`] that points at the line.
//!
//! Metres and radians in the world frame, z up. Reading costs a few milliseconds for some hundred
//! objects; meshes cost their convex hulls. Whether the robot exists, and whether its start is
//! free, is not judged here.

mod bodies;
mod contact;
mod equilibrium;
mod feasible;
mod ids;
mod numbers;
mod overlap;
mod patch;
mod physics;
mod pose;
mod shape;
mod source;
mod stability;
mod standing;
mod support;
mod surroundings;

pub use bodies::Bodies;
pub use stability::EDGE;
pub use standing::TOUCH;

use clearway_files::{FileError, Limits, read_text, yaml};
use clearway_geometry::{Mass, Pose, Solid, Vec2, Vec3};
use clearway_plan::scene_file::{Assumed, FORMAT};
use clearway_plan::{ObjectId, ObjectSet, SceneFile};
use source::Source;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Up to this far (metres) a gap or overlap is measurement noise.
pub const NOISE: f64 = 0.001;
/// The same with room for rounding, which must not make an error of exactly a millimetre.
const FORGIVEN: f64 = NOISE + 1e-6;
/// How many fixtures a scene can have.
pub const MAX_FIXTURES: usize = 1024;
/// How many convex parts and points all bodies of a scene can have together.
pub const MAX_PARTS: usize = 100_000;
/// How many of them the objects can have together.
pub const MAX_OBJECT_PARTS: usize = 4096;

/// A sound scene.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What was read, defaults filled in and supports snapped: what goes into a plan file.
    pub file: SceneFile,
    /// Which masses and frictions the file did not give.
    pub assumed: Assumed,
    /// Where relative paths start.
    pub directory: PathBuf,
    /// The objects' ids as written, by [`ObjectId`].
    pub names: Vec<String>,
    /// By [`ObjectId`].
    pub objects: Vec<Object>,
    pub fixtures: Vec<Fixture>,
    pub target: ObjectId,
    pub places: Vec<Place>,
    /// World from the robot's root link.
    pub base: Pose,
    /// The mesh and point files that the scene names, each once.
    pub meshes: Vec<MeshSource>,
    /// Space that objects hide, in a scene that is partly observed: motions keep out of it.
    pub hidden: Vec<Hidden>,
}

/// Space that is not seen for an object, in the world; with the object gone it will be.
#[derive(Clone, Debug)]
pub struct Hidden {
    pub behind: ObjectId,
    pub space: Solid,
    /// That of it which counts while the object is being taken.
    pub beyond: Solid,
    /// Something is there, too little of which is seen to tell what.
    pub glimpsed: bool,
}

/// Something that may be moved.
#[derive(Clone, Debug)]
pub struct Object {
    pub id: String,
    pub solid: Arc<Solid>,
    /// Of the solid in its own frame, at density 1.
    pub mass: Mass,
    /// World from object.
    pub pose: Pose,
    pub support: Support,
}

/// What carries an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Support {
    /// Only a fixture, this one of [`Scene::fixtures`].
    Fixture(usize),
    /// These objects, in ascending order, and perhaps a fixture besides. None carry what floats, which
    /// only [`Scene::moved`] can bring about.
    Objects(Vec<ObjectId>),
}

/// Something that nothing may touch and nobody may move. A point cloud is a solid of spheres.
#[derive(Clone, Debug)]
pub struct Fixture {
    pub id: String,
    pub solid: Arc<Solid>,
    /// World from fixture.
    pub pose: Pose,
}

/// A flat rectangle, its sides along world x and y, for putting things down.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    pub id: String,
    /// Full lengths along x and y.
    pub size: Vec2,
    /// The centre of the top face.
    pub centre: Vec3,
}

/// A mesh file that the scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshSource {
    /// As written in the scene.
    pub uri: String,
    /// Where it was found.
    pub path: PathBuf,
    /// Of its bytes, in lower-case hexadecimal.
    pub sha256: String,
}

impl Scene {
    /// Reads a scene file.
    pub fn load(path: &Path) -> Result<Scene, FileError> {
        Self::from_text(path, &read_text(path, &Limits::DOCUMENT)?)
    }

    /// Reads a scene file's text; `path` is its name for messages, and relative paths start at its
    /// directory.
    pub fn from_text(path: &Path, text: &str) -> Result<Scene, FileError> {
        let located = yaml::from_str::<SceneFile>(path, text)?;
        let directory = path.parent().unwrap_or(Path::new(""));
        Self::build(&Source::text(&located), located.value.clone(), directory)
    }

    /// The same checks for a scene that was made, or that came inside a plan file. Errors name no
    /// line.
    pub fn from_file_struct(file: SceneFile, directory: &Path) -> Result<Scene, FileError> {
        Self::build(&Source::unwritten(), file, directory)
    }

    fn build(source: &Source, mut file: SceneFile, directory: &Path) -> Result<Scene, FileError> {
        if file.format != FORMAT {
            let found = clearway_files::quoted(&file.format);
            return Err(source
                .error("format", format!("found the format {found}"))
                .expected(format!("`{FORMAT}`"))
                .help("is this a scene file of this version?"));
        }
        surroundings::check(source, &file)?;
        physics::check(source, &file)?;
        ids::check(source, &file)?;
        let target = ids::target(source, &file)?;
        let base = pose::of_keys(source, "robot.base", &file.robot.base)?;

        let mut reader = shape::Reader::new(source, directory);
        let mut fixtures = Vec::with_capacity(file.fixtures.len());
        for (i, body) in file.fixtures.iter().enumerate() {
            let (solid, pose) = reader.body(&format!("fixtures.{i}"), body, shape::Role::Fixture)?;
            fixtures.push(Fixture { id: body.id.clone(), solid: Arc::new(solid), pose });
        }
        let mut bodies = Vec::with_capacity(file.objects.len());
        for (i, body) in file.objects.iter().enumerate() {
            let (solid, pose) = reader.body(&format!("objects.{i}"), body, shape::Role::Object)?;
            bodies.push(support::Resting { id: body.id.clone(), mass: solid.mass(), solid: Arc::new(solid), pose });
        }
        let meshes = reader.into_meshes();

        let supports = support::settle(source, &mut bodies, &fixtures)?;
        for (written, settled) in file.objects.iter_mut().zip(&bodies) {
            written.position[2] = settled.pose.translation.z;
        }
        let assumed = physics::fill_in(&mut file, bodies.iter().map(|b| b.mass));
        let objects = bodies
            .into_iter()
            .zip(supports)
            .map(|(body, support)| Object { id: body.id, solid: body.solid, mass: body.mass, pose: body.pose, support })
            .collect::<Vec<_>>();
        let places = file
            .place
            .iter()
            .map(|p| Place { id: p.id.clone(), size: Vec2::from(p.size), centre: Vec3::from(p.position) })
            .collect();
        let names = objects.iter().map(|o| o.id.clone()).collect();
        Ok(Scene {
            file,
            assumed,
            directory: directory.to_owned(),
            names,
            objects,
            fixtures,
            target,
            places,
            base,
            meshes,
            hidden: Vec::new(),
        })
    }

    /// All objects.
    pub fn all(&self) -> ObjectSet {
        ObjectSet::first(self.objects.len())
    }

    /// Room that every motion keeps, metres.
    pub fn clearance(&self) -> f64 {
        self.file.clearance.unwrap_or_default()
    }

    /// The object of this name.
    pub fn object(&self, id: &str) -> Option<ObjectId> {
        self.names.iter().position(|n| n == id).map(|i| ObjectId(i as u16))
    }
}
