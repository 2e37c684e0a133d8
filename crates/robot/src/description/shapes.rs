//! Collision shapes: a URDF's `<collision>` elements as convex parts in the link's frame.
//!
//! A mesh becomes the convex hulls of its connected parts, which hold every corner of it. The
//! hollow of a part is filled by that: a link bent like a hook should be cut into pieces.

use super::element::{Source, child, children};
use super::model::{CollisionKind, MeshSource};
use super::roots::Roots;
use super::urdf::origin;
use clearway_files::{FileError, Mesh, MeshBudget, mesh, quoted};
use clearway_geometry::convex::Hull;
use clearway_geometry::hull::{connected_hulls, convex_hull};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use roxmltree::Node;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// `<collision>` elements in a file.
const MOST: usize = 20_000;
/// How far a corner of a mesh may lie outside of its hulls, metres: "touching" begins here.
const OUTSIDE: f64 = 1e-4;

/// Reads shapes, each mesh file once.
pub struct Shapes<'a> {
    source: Source<'a>,
    roots: &'a Roots,
    /// Relative mesh paths start here.
    base: &'a Path,
    budget: MeshBudget,
    read: HashMap<PathBuf, Mesh>,
    count: usize,
    pub meshes: Vec<MeshSource>,
}

impl<'a> Shapes<'a> {
    pub fn new(source: Source<'a>, roots: &'a Roots, base: &'a Path) -> Self {
        Self { source, roots, base, budget: MeshBudget::default(), read: HashMap::new(), count: 0, meshes: Vec::new() }
    }

    /// The shapes of one `<link>`, and what each of its `<collision>` elements was.
    pub fn of_link(
        &mut self,
        link: &str,
        node: Node<'a, 'a>,
    ) -> Result<(Solid, Vec<(CollisionKind, usize)>), FileError> {
        let mut solid = Solid::default();
        let mut kinds = Vec::new();
        for collision in children(node, "collision") {
            self.count += 1;
            if self.count > MOST {
                return Err(self.source.wrong(collision, format!("more than {MOST} <collision> elements")));
            }
            let link_from_shape = origin(self.source, collision)?;
            let shape = child(collision, "geometry").and_then(|g| g.children().find(Node::is_element));
            let Some(shape) = shape else {
                return Err(self
                    .source
                    .wrong(collision, format!("a <collision> of link {} without a shape", quoted(link)))
                    .expected("`<geometry>` with a box, cylinder, sphere, capsule or mesh inside")
                    .help("add the shape, or delete the element"));
            };
            let (kind, parts) = self.shape(link, shape)?;
            kinds.push((kind, parts.len()));
            solid.parts.extend(parts.into_iter().map(|(pose, convex)| (link_from_shape * pose, convex)));
        }
        Ok((solid, kinds))
    }

    fn shape(&mut self, link: &str, node: Node<'a, 'a>) -> Result<(CollisionKind, Vec<(Pose, Convex)>), FileError> {
        let source = self.source;
        let length = |attribute| source.sizes::<1>(node, attribute).map(|[x]| x);
        let (kind, convex) = match node.tag_name().name() {
            "box" => {
                (CollisionKind::Box, Convex::Box { half: Vec3::from_array(source.sizes::<3>(node, "size")?) / 2.0 })
            }
            "sphere" => (CollisionKind::Sphere, Convex::Sphere { radius: length("radius")? }),
            "cylinder" => {
                (CollisionKind::Cylinder, Convex::Cylinder { radius: length("radius")?, half: length("length")? / 2.0 })
            }
            // Not URDF's, but many programs write it.
            "capsule" => {
                (CollisionKind::Capsule, Convex::Capsule { radius: length("radius")?, half: length("length")? / 2.0 })
            }
            "mesh" => return self.mesh(link, node),
            other => {
                return Err(source
                    .wrong(node, format!("link {} has the shape <{other}>", quoted(link)))
                    .expected("`box`, `cylinder`, `sphere`, `capsule` or `mesh`"));
            }
        };
        Ok((kind, vec![(Pose::IDENTITY, convex)]))
    }

    fn mesh(&mut self, link: &str, node: Node<'a, 'a>) -> Result<(CollisionKind, Vec<(Pose, Convex)>), FileError> {
        let source = self.source;
        let uri = source.name(node, "filename")?;
        let scale = Vec3::from_array(source.numbers::<3>(node, "scale")?.unwrap_or([1.0; 3]));
        if scale.abs().min_element() < 1e-9 {
            return Err(source.wrong_attribute(node, "scale", "a scale of 0").expected("three numbers other than 0"));
        }
        let here = |error: FileError| {
            let place = node.attribute_node("filename").map(|a| node.document().text_pos_at(a.range().start));
            error.referenced_from(source.path, place.map(|p| (p.row as usize, p.col as usize)))
        };
        let path = self.roots.resolve(uri, self.base).map_err(here)?;
        if !self.read.contains_key(&path) {
            let mesh = mesh::load(&path, &mut self.budget).map_err(here)?;
            self.read.insert(path.clone(), mesh);
        }
        let Some(mesh) = self.read.get(&path) else { return Err(source.wrong(node, "the mesh was not kept")) };
        if !self.meshes.iter().any(|m| m.uri == uri) {
            self.meshes.push(MeshSource { uri: uri.to_owned(), path: path.clone(), sha256: mesh.sha256.clone() });
        }
        let corners: Vec<Vec3> = mesh.vertices.iter().map(|&v| Vec3::from_array(v) * scale).collect();
        let hulls = hulls_of(&corners, &mesh.triangles).ok_or_else(|| {
            source
                .wrong_attribute(node, "filename", format!("the mesh {} of link {} is flat", quoted(uri), quoted(link)))
                .expected("a mesh that encloses a volume")
                .help("give the sheet some thickness, or use a thin box")
        })?;
        Ok((CollisionKind::Mesh(uri.to_owned()), hulls.into_iter().map(centred).collect()))
    }
}

/// The hulls of the connected parts, and one more round the corners that are in none of them: those
/// of flat parts, which enclose something only together. None if all is flat.
fn hulls_of(corners: &[Vec3], triangles: &[[u32; 3]]) -> Option<Vec<Hull>> {
    let mut hulls = connected_hulls(corners, triangles).ok()?;
    let mut used: Vec<Vec3> = triangles.iter().flatten().filter_map(|&i| corners.get(i as usize).copied()).collect();
    used.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    used.dedup();
    let holds = |hull: &Hull, p: Vec3| hull.planes.iter().all(|(normal, offset)| normal.dot(p) <= offset + OUTSIDE);
    let outside: Vec<Vec3> = used.iter().copied().filter(|&p| !hulls.iter().any(|h| holds(h, p))).collect();
    if !outside.is_empty() {
        match convex_hull(&outside) {
            Ok(hull) => hulls.push(hull),
            // A single sheet beside parts with volume: only a hull round everything holds it.
            Err(_) => hulls = vec![convex_hull(&used).ok()?],
        }
    }
    Some(hulls)
}

/// The hull in a frame at its own centre, and that frame's pose.
fn centred(mut hull: Hull) -> (Pose, Convex) {
    let (min, max) = hull.points.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
    let centre = (min + max) / 2.0;
    for point in &mut hull.points {
        *point -= centre;
    }
    for (normal, offset) in &mut hull.planes {
        *offset -= normal.dot(centre);
    }
    (Pose::from_translation(centre), Convex::Hull(Arc::new(hull)))
}
