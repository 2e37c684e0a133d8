//! Motion planning problems as MotionBenchMaker's sets are handed on: JSON with a list per set.
//!
//! `{robot, joints: [name …], problems: {set: [{index, start, goals, valid, sphere, box, cylinder}]}}`,
//! shapes with `position`, `orientation_quat_xyzw` (or `orientation_euler_xyz`), `radius`,
//! `half_extents`, `length` (along z), in the frame of the URDF's root link. Other keys are ignored.

use clearway_files::{FileError, Limits, json, quoted, read_text};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_motion::Obstacle;
use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use std::fmt;
use std::path::Path;

#[derive(Debug, Deserialize)]
struct File {
    joints: Vec<String>,
    problems: Sets,
}

/// By name, in the file's order.
#[derive(Debug)]
struct Sets(Vec<(String, Vec<Row>)>);

impl<'de> Deserialize<'de> for Sets {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = Sets;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str("a mapping from the name of a set to its problems")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Sets, A::Error> {
                let mut sets = Vec::new();
                while let Some(set) = map.next_entry()? {
                    sets.push(set);
                }
                Ok(Sets(sets))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

#[derive(Debug, Deserialize)]
struct Row {
    index: Option<usize>,
    start: Vec<f64>,
    goals: Vec<Vec<f64>>,
    #[serde(default)]
    sphere: Vec<Shape>,
    #[serde(default, rename = "box")]
    boxes: Vec<Shape>,
    #[serde(default)]
    cylinder: Vec<Shape>,
}

#[derive(Debug, Deserialize)]
struct Shape {
    #[serde(default)]
    name: String,
    position: [f64; 3],
    orientation_quat_xyzw: Option<[f64; 4]>,
    orientation_euler_xyz: Option<[f64; 3]>,
    radius: Option<f64>,
    length: Option<f64>,
    half_extents: Option<[f64; 3]>,
}

/// What a cylinder counts as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cylinders {
    /// As VAMP's scripts take them: a capsule of the cylinder's length and caps beyond it; in the
    /// set `box`, the cuboid round it.
    Peer,
    True,
}

impl Cylinders {
    /// In words, for summaries.
    pub fn describe(self) -> &'static str {
        match self {
            Cylinders::Peer => "cylinders as the peer takes them: capsules, in the set `box` cuboids",
            Cylinders::True => "true cylinders",
        }
    }
}

#[derive(Clone, Debug)]
pub struct Problem {
    pub set: String,
    pub index: usize,
    pub start: Vec<f64>,
    pub goals: Vec<Vec<f64>>,
    pub obstacles: Vec<Obstacle>,
}

/// All problems of a file, in its order.
#[derive(Clone, Debug)]
pub struct Problems {
    pub joints: Vec<String>,
    pub problems: Vec<Problem>,
}

impl Problems {
    pub fn read(path: &Path, cylinders: Cylinders) -> Result<Problems, FileError> {
        let file: File = json::from_str(path, &read_text(path, &Limits::PLAN)?)?;
        let mut problems = Vec::new();
        for (set, rows) in file.problems.0 {
            for (number, row) in rows.into_iter().enumerate() {
                let index = row.index.unwrap_or(number + 1);
                let wrong =
                    |what: String| FileError::new(path, format!("set {}, problem {index}: {what}", quoted(&set)));
                problems.push(problem(&set, index, row, file.joints.len(), cylinders).map_err(wrong)?);
            }
        }
        if problems.is_empty() {
            return Err(FileError::new(path, "no problems").expected("at least one set with a problem in it"));
        }
        Ok(Problems { joints: file.joints, problems })
    }
}

fn problem(set: &str, index: usize, row: Row, joints: usize, cylinders: Cylinders) -> Result<Problem, String> {
    if row.goals.is_empty() {
        return Err("no goal".to_owned());
    }
    for (what, q) in std::iter::once(("start", &row.start)).chain(row.goals.iter().map(|g| ("goal", g))) {
        if q.len() != joints {
            return Err(format!("a {what} of {} values for {joints} joints", q.len()));
        }
        if let Some(bad) = q.iter().find(|v| !v.is_finite()) {
            return Err(format!("a {what} with the value {bad}"));
        }
    }
    let mut obstacles = Vec::new();
    for (kind, shapes) in [("sphere", &row.sphere), ("box", &row.boxes), ("cylinder", &row.cylinder)] {
        for shape in shapes {
            let wrong = |what: &str| format!("{kind} {}: {what}", quoted(&shape.name));
            let convex = shape.convex(kind, set, cylinders).map_err(|e| wrong(&e))?;
            obstacles.push(Obstacle {
                name: shape.name.clone(),
                root_from_solid: shape.pose().map_err(|e| wrong(&e))?,
                solid: Solid::new(convex),
            });
        }
    }
    Ok(Problem { set: set.to_owned(), index, start: row.start, goals: row.goals, obstacles })
}

impl Shape {
    fn pose(&self) -> Result<Pose, String> {
        let finite = |v: &[f64]| v.iter().all(|x| x.is_finite());
        let at = Vec3::from_array(self.position);
        if !finite(&self.position) {
            return Err(format!("position {:?} is not finite", self.position));
        }
        match (self.orientation_quat_xyzw, self.orientation_euler_xyz) {
            (Some(q), _) if finite(&q) && q.iter().map(|x| x * x).sum::<f64>() > 1e-6 => {
                Ok(Pose::from_quaternion(q, at))
            }
            (Some(q), _) => Err(format!("{q:?} is no rotation")),
            (None, Some(rpy)) if finite(&rpy) => Ok(Pose::from_rpy(rpy, at)),
            (None, Some(rpy)) => Err(format!("{rpy:?} is no rotation")),
            (None, None) => Ok(Pose::from_translation(at)),
        }
    }

    fn convex(&self, kind: &str, set: &str, cylinders: Cylinders) -> Result<Convex, String> {
        let positive = |name: &str, value: Option<f64>| match value {
            Some(v) if v.is_finite() && v > 0.0 => Ok(v),
            Some(v) => Err(format!("{name} is {v}, must be positive")),
            None => Err(format!("{name} is missing")),
        };
        match kind {
            "sphere" => Ok(Convex::Sphere { radius: positive("radius", self.radius)? }),
            "box" => {
                let half = self.half_extents.ok_or("half_extents are missing")?;
                for v in half {
                    positive("half_extents", Some(v))?;
                }
                Ok(Convex::Box { half: Vec3::from_array(half) })
            }
            _ => {
                let (radius, half) = (positive("radius", self.radius)?, positive("length", self.length)? / 2.0);
                Ok(match cylinders {
                    Cylinders::True => Convex::Cylinder { radius, half },
                    Cylinders::Peer if set == "box" => Convex::Box { half: Vec3::new(radius, radius, half) },
                    Cylinders::Peer => Convex::Capsule { radius, half },
                })
            }
        }
    }
}
