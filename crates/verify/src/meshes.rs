//! The files a plan names: meshes and point clouds, found through `robot.meshes` and checked by
//! their sha256. Reading is bounded by `clearway-files`.

use crate::error::CannotJudge;
use clearway_files::read::{Limits, read_bytes, text_from_bytes};
use clearway_files::{MeshBudget, mesh, points};
use clearway_plan::plan_file::MeshFile;
use parry3d_f64::math::Vector;
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};

/// A triangle soup, metres.
#[derive(Clone, Debug, Default)]
pub(crate) struct Triangles {
    pub vertices: Vec<Vector>,
    pub faces: Vec<[u32; 3]>,
}

impl Triangles {
    pub fn scaled(&self, scale: Vector) -> Self {
        Self { vertices: self.vertices.iter().map(|v| *v * scale).collect(), faces: self.faces.clone() }
    }

    /// Parts that share no vertex position (bit for bit).
    pub fn connected_parts(&self) -> Vec<Triangles> {
        let mut ids: HashMap<[u64; 3], usize> = HashMap::new();
        let welded: Vec<usize> = self
            .vertices
            .iter()
            .map(|v| {
                let next = ids.len();
                *ids.entry(v.to_array().map(|x| (x + 0.0).to_bits())).or_insert(next)
            })
            .collect();
        let mut parent: Vec<usize> = (0..ids.len()).collect();
        for face in &self.faces {
            let [a, b, c] = face.map(|i| welded[i as usize]);
            for other in [b, c] {
                let (x, y) = (root(&mut parent, a), root(&mut parent, other));
                parent[x.max(y)] = x.min(y);
            }
        }
        let mut parts: BTreeMap<usize, Triangles> = BTreeMap::new();
        for face in &self.faces {
            let part = parts.entry(root(&mut parent, welded[face[0] as usize])).or_default();
            let first = part.vertices.len() as u32;
            part.vertices.extend(face.map(|i| self.vertices[i as usize]));
            part.faces.push([first, first + 1, first + 2]);
        }
        parts.into_values().collect()
    }
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Reads and remembers the files of one plan.
pub(crate) struct Meshes<'a> {
    listed: &'a [MeshFile],
    directory: &'a Path,
    budget: MeshBudget,
    read: HashMap<String, Triangles>,
}

impl<'a> Meshes<'a> {
    /// `directory` is the plan file's.
    pub fn new(listed: &'a [MeshFile], directory: &'a Path) -> Self {
        Self { listed, directory, budget: MeshBudget::default(), read: HashMap::new() }
    }

    /// The triangles of the mesh that `user` names by `uri`.
    pub fn triangles(&mut self, uri: &str, user: &str) -> Result<&Triangles, CannotJudge> {
        if !self.read.contains_key(uri) {
            let (path, expected) = self.find(uri, user)?;
            let mesh = mesh::load(&path, &mut self.budget)?;
            same(&path, mesh.sha256, expected)?;
            let vertices = mesh.vertices.into_iter().map(Vector::from).collect();
            self.read.insert(uri.to_owned(), Triangles { vertices, faces: mesh.triangles });
        }
        Ok(&self.read[uri])
    }

    /// The points of a cloud.
    pub fn points(&self, uri: &str, user: &str) -> Result<Vec<Vector>, CannotJudge> {
        let (path, expected) = self.find(uri, user)?;
        let bytes = read_bytes(&path, &Limits::MESH)?;
        same(&path, Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect(), expected)?;
        let text = text_from_bytes(&path, bytes)?;
        Ok(points::from_str(&path, &text)?.into_iter().map(Vector::from).collect())
    }

    fn find(&self, uri: &str, user: &str) -> Result<(PathBuf, &'a str), CannotJudge> {
        let listed = self.listed.iter().find(|m| m.uri == uri);
        let listed = listed.ok_or_else(|| CannotJudge::MeshNotListed { uri: uri.to_owned(), user: user.to_owned() })?;
        Ok((self.directory.join(&listed.file), &listed.sha256))
    }
}

fn same(path: &Path, found: String, expected: &str) -> Result<(), CannotJudge> {
    if found.eq_ignore_ascii_case(expected) {
        Ok(())
    } else {
        Err(CannotJudge::MeshChanged { path: path.to_owned(), found, expected: expected.to_owned() })
    }
}
