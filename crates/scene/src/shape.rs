//! Shape keys as solids: one key per body, its sizes checked, its files read.

use crate::source::Source;
use crate::{MAX_OBJECT_PARTS, MAX_PARTS, MeshSource, numbers, physics, pose};
use clearway_files::{FileError, MeshBudget, Root, mesh, points, quoted};
use clearway_geometry::convex::Hull;
use clearway_geometry::hull::{HullError, connected_hulls};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_plan::scene_file::{Body, BoxKeys, CylinderKeys, MeshKeys, Part, PointsKeys, Scale, SphereKeys};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Metres; what is larger was measured in other units.
const LONGEST_MOVED: f64 = 10.0;

/// Which shapes a body may have depends on what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    Fixture,
    Object,
    /// What a motion problem's robot keeps clear of.
    Obstacle,
    /// What a motion problem's robot holds.
    Held,
}

impl Role {
    fn name(self) -> &'static str {
        match self {
            Role::Fixture => "fixture",
            Role::Object => "object",
            Role::Obstacle => "obstacle",
            Role::Held => "attached",
        }
    }

    /// Whether it is moved, and so has to have an inside, and few parts.
    fn moves(self) -> bool {
        matches!(self, Role::Object | Role::Held)
    }
}

/// The one shape key that a body or a part of a compound has.
enum Key<'a> {
    Box(&'a BoxKeys),
    Cylinder(&'a CylinderKeys),
    Sphere(&'a SphereKeys),
    Capsule(&'a CylinderKeys),
    Mesh(&'a MeshKeys),
    Points(&'a PointsKeys),
    Compound(&'a [Part]),
}

impl Key<'_> {
    fn name(&self) -> &'static str {
        match self {
            Key::Box(_) => "box",
            Key::Cylinder(_) => "cylinder",
            Key::Sphere(_) => "sphere",
            Key::Capsule(_) => "capsule",
            Key::Mesh(_) => "mesh",
            Key::Points(_) => "points",
            Key::Compound(_) => "compound",
        }
    }
}

/// Reads bodies one after the other, keeping count of what they cost.
pub(crate) struct Reader<'a> {
    source: &'a Source<'a>,
    directory: &'a Path,
    /// Opened when the first file is named: a scene without files needs no directory.
    root: Option<Root>,
    budget: MeshBudget,
    parts: usize,
    object_parts: usize,
    meshes: Vec<MeshSource>,
    /// Convex parts of the meshes read so far, by path.
    hulls: HashMap<PathBuf, Vec<Hull>>,
}

impl<'a> Reader<'a> {
    pub(crate) fn new(source: &'a Source<'a>, directory: &'a Path) -> Self {
        Self {
            source,
            directory,
            root: None,
            budget: MeshBudget::default(),
            parts: 0,
            object_parts: 0,
            meshes: Vec::new(),
            hulls: HashMap::new(),
        }
    }

    pub(crate) fn into_meshes(self) -> Vec<MeshSource> {
        self.meshes
    }

    /// The solid in its own frame, and world from that frame.
    pub(crate) fn body(&mut self, keys: &str, body: &Body, role: Role) -> Result<(Solid, Pose), FileError> {
        let pose = pose::read(self.source, keys, body.position, body.rpy, body.quaternion)?;
        if role != Role::Object {
            physics::not_given(self.source, keys, body)?;
        }
        let given = [
            body.r#box.as_ref().map(Key::Box),
            body.cylinder.as_ref().map(Key::Cylinder),
            body.sphere.as_ref().map(Key::Sphere),
            body.capsule.as_ref().map(Key::Capsule),
            body.mesh.as_ref().map(Key::Mesh),
            body.points.as_ref().map(Key::Points),
            body.compound.as_deref().map(Key::Compound),
        ];
        let whose = format!("{} {}", role.name(), quoted(&body.id));
        let key = self.only(keys, &whose, given.into_iter().flatten().collect())?;
        if role.moves() && matches!(key, Key::Points(_)) {
            return Err(self
                .source
                .error(&format!("{keys}.points"), format!("{whose} is a point cloud"))
                .expected("a shape that has an inside")
                .help("only fixtures can be `points`: give the object's shape, or list it under `fixtures`"));
        }
        let parts = self.shape(keys, &whose, &key)?;
        let solid = Solid { parts };
        if role.moves() {
            let (low, high) = solid.aabb(Pose::IDENTITY);
            let longest = (high - low).max_element();
            if longest > LONGEST_MOVED {
                return Err(self
                    .source
                    .error(&format!("{keys}.{}", key.name()), format!("{whose} measures {} m", numbers::shown(longest)))
                    .expected(format!("at most {LONGEST_MOVED} m of what is moved"))
                    .help("lengths are in metres; a mesh in millimetres has the scale 0.001"));
            }
            self.object_parts += solid.parts.len();
            if self.object_parts > MAX_OBJECT_PARTS {
                return Err(self
                    .source
                    .error(
                        &format!("{keys}.{}", key.name()),
                        format!("more than {MAX_OBJECT_PARTS} convex parts with those of {whose}"),
                    )
                    .help("use simplified collision meshes"));
            }
        }
        Ok((solid, pose))
    }

    /// Exactly one shape key.
    fn only<'k>(&self, keys: &str, whose: &str, mut given: Vec<Key<'k>>) -> Result<Key<'k>, FileError> {
        const EXPECTED: &str = "exactly one of `box`, `cylinder`, `sphere`, `capsule`, `mesh`, `points`, `compound`";
        match (given.pop(), given.last()) {
            (Some(one), None) => Ok(one),
            (None, _) => Err(self.source.error(keys, format!("{whose} has no shape")).expected(EXPECTED)),
            (Some(last), Some(_)) => {
                given.push(last);
                let names: Vec<_> = given.iter().map(|k| format!("`{}`", k.name())).collect();
                let second = given.get(1).map_or("", Key::name);
                Err(self
                    .source
                    .error(
                        &format!("{keys}.{second}"),
                        format!("{whose} has {} shapes: {}", names.len(), names.join(", ")),
                    )
                    .expected(EXPECTED)
                    .help("several shapes joined are a `compound`"))
            }
        }
    }

    /// The convex parts, each with its pose in the body.
    fn shape(&mut self, keys: &str, whose: &str, key: &Key) -> Result<Vec<(Pose, Convex)>, FileError> {
        let keys = format!("{keys}.{}", key.name());
        let size = |name: &str, value| {
            numbers::size(self.source, &format!("{keys}.{name}"), &format!("the {name} of {whose}"), value)
        };
        let one = |convex| Ok(vec![(Pose::IDENTITY, convex)]);
        let parts = match key {
            Key::Box(b) => {
                for (i, length) in b.size.iter().enumerate() {
                    numbers::size(self.source, &format!("{keys}.size.{i}"), &format!("the size of {whose}"), *length)?;
                }
                one(Convex::Box { half: Vec3::from(b.size) / 2.0 })
            }
            Key::Cylinder(c) => {
                one(Convex::Cylinder { radius: size("radius", c.radius)?, half: size("height", c.height)? / 2.0 })
            }
            Key::Capsule(c) => {
                one(Convex::Capsule { radius: size("radius", c.radius)?, half: size("height", c.height)? / 2.0 })
            }
            Key::Sphere(s) => one(Convex::Sphere { radius: size("radius", s.radius)? }),
            Key::Points(p) => {
                let radius = size("radius", p.radius)?;
                self.points(&keys, whose, p, radius)
            }
            Key::Mesh(m) => self.mesh(&keys, whose, m),
            Key::Compound(parts) => self.compound(&keys, whose, parts),
        }?;
        if !matches!(key, Key::Compound(_)) {
            self.parts += parts.len();
        }
        if self.parts > MAX_PARTS {
            return Err(self
                .source
                .error(&keys, format!("more than {MAX_PARTS} convex parts and points with those of {whose}"))
                .help("thin point clouds out, and use simplified collision meshes"));
        }
        Ok(parts)
    }

    fn compound(&mut self, keys: &str, whose: &str, parts: &[Part]) -> Result<Vec<(Pose, Convex)>, FileError> {
        if parts.is_empty() {
            return Err(self
                .source
                .error(keys, format!("the compound of {whose} is empty"))
                .expected("at least one shape"));
        }
        let mut all = Vec::new();
        for (i, part) in parts.iter().enumerate() {
            let keys = format!("{keys}.{i}");
            let whose = format!("part {} of {whose}", i + 1);
            let pose = pose::read(self.source, &keys, part.position, part.rpy, part.quaternion)?;
            let given = [
                part.r#box.as_ref().map(Key::Box),
                part.cylinder.as_ref().map(Key::Cylinder),
                part.sphere.as_ref().map(Key::Sphere),
                part.capsule.as_ref().map(Key::Capsule),
                part.mesh.as_ref().map(Key::Mesh),
            ];
            let key = self.only(&keys, &whose, given.into_iter().flatten().collect())?;
            let shape = self.shape(&keys, &whose, &key)?;
            all.extend(shape.into_iter().map(|(inner, convex)| (pose * inner, convex)));
        }
        Ok(all)
    }

    /// The file that the key `file` of the mapping at `keys` names.
    fn resolve(&mut self, keys: &str, whose: &str, file: &str) -> Result<PathBuf, FileError> {
        let keys = format!("{keys}.file");
        let wrong = |error| self.source.reference(&keys, error).about(whose);
        let root = match self.root.take() {
            Some(root) => root,
            None => Root::new(self.directory).map_err(wrong)?,
        };
        let path = root.resolve(file).map_err(wrong);
        self.root = Some(root);
        path
    }

    fn points(
        &mut self,
        keys: &str,
        whose: &str,
        cloud: &PointsKeys,
        radius: f64,
    ) -> Result<Vec<(Pose, Convex)>, FileError> {
        let path = self.resolve(keys, whose, &cloud.file)?;
        let (points, sha256) = points::load_with_sha256(&path)
            .map_err(|e| self.source.reference(&format!("{keys}.file"), e).about(whose))?;
        if !self.meshes.iter().any(|m| m.uri == cloud.file) {
            self.meshes.push(MeshSource { uri: cloud.file.clone(), path, sha256 });
        }
        Ok(points.into_iter().map(|p| (Pose::from_translation(Vec3::from(p)), Convex::Sphere { radius })).collect())
    }

    /// The hulls of the mesh's connected parts, each about its own middle.
    fn mesh(&mut self, keys: &str, whose: &str, named: &MeshKeys) -> Result<Vec<(Pose, Convex)>, FileError> {
        let scale = match named.scale {
            None => Vec3::ONE,
            Some(Scale::Uniform(s)) => Vec3::splat(s),
            Some(Scale::PerAxis(s)) => Vec3::from(s),
        };
        for s in scale.to_array() {
            if !(1e-6..=1e6).contains(&s) {
                return Err(self
                    .source
                    .error(&format!("{keys}.scale"), format!("the scale of {whose} is {}", numbers::shown(s)))
                    .expected("a positive, finite factor")
                    .help("a mesh in millimetres has the scale 0.001"));
            }
        }
        let path = self.resolve(keys, whose, &named.file)?;
        if !self.hulls.contains_key(&path) {
            let wrong = |error| self.source.reference(&format!("{keys}.file"), error).about(whose);
            let mesh = mesh::load(&path, &mut self.budget).map_err(wrong)?;
            let vertices: Vec<Vec3> = mesh.vertices.into_iter().map(Vec3::from).collect();
            let hulls = connected_hulls(&vertices, &mesh.triangles).map_err(|error| {
                wrong(match error {
                    HullError::Flat => FileError::new(&path, "a mesh without volume")
                        .help("give the mesh a thickness, or use a thin `box`"),
                    HullError::Invalid => FileError::new(&path, "a mesh with broken corners"),
                })
            })?;
            self.meshes.push(MeshSource { uri: named.file.clone(), path: path.clone(), sha256: mesh.sha256 });
            self.hulls.insert(path.clone(), hulls);
        }
        let hulls = self.hulls.get(&path).map(Vec::as_slice).unwrap_or_default();
        let parts: Vec<_> = hulls.iter().map(|hull| about_its_middle(hull, scale)).collect();
        for (pose, convex) in &parts {
            let reach = pose.translation.length() + convex.bounding_radius();
            if !(1e-6..=1_000.0).contains(&convex.bounding_radius()) || reach > 10_000.0 {
                return Err(self
                    .source
                    .error(keys, format!("the mesh of {whose} reaches {reach:.1} m from its origin"))
                    .expected("at most 1000 m")
                    .help("a mesh in millimetres has the scale 0.001"));
            }
        }
        Ok(parts)
    }
}

/// The scaled hull in a frame at the middle of its extent, and where that is.
fn about_its_middle(hull: &Hull, scale: Vec3) -> (Pose, Convex) {
    let scaled = || hull.points.iter().map(|p| *p * scale);
    let low = scaled().fold(Vec3::INFINITY, Vec3::min);
    let high = scaled().fold(Vec3::NEG_INFINITY, Vec3::max);
    let middle = (low + high) / 2.0;
    let planes = hull.planes.iter().map(|(normal, offset)| {
        // n·p ≤ d for p = q/s: the normal scales by the inverse, and is made unit again.
        let stretched = *normal / scale;
        let length = stretched.length();
        let unit = stretched / length;
        (unit, offset / length - unit.dot(middle))
    });
    let hull = Hull {
        points: scaled().map(|p| p - middle).collect(),
        triangles: hull.triangles.clone(),
        planes: planes.collect(),
    };
    (Pose::from_translation(middle), Convex::Hull(Arc::new(hull)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clearway_geometry::hull::convex_hull;

    #[test]
    fn a_scaled_hull_keeps_its_planes() {
        let corners: Vec<Vec3> = (0..8)
            .map(|i| Vec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) + Vec3::splat(5.0))
            .chain([Vec3::new(5.5, 5.5, 7.0)])
            .collect();
        let Ok(hull) = convex_hull(&corners) else { panic!("no hull") };
        let (pose, Convex::Hull(scaled)) = about_its_middle(&hull, Vec3::new(2.0, 0.5, 3.0)) else { panic!("no hull") };
        assert!((pose.translation - Vec3::new(11.0, 2.75, 18.0)).length() < 1e-9);
        for (normal, offset) in &scaled.planes {
            assert!((normal.length() - 1.0).abs() < 1e-12);
            let most = scaled.points.iter().map(|p| p.dot(*normal)).fold(f64::NEG_INFINITY, f64::max);
            // Hulls lie a hair inside their planes.
            assert!((0.0..1e-7).contains(&(offset - most)), "{most} {offset}");
        }
    }
}
