//! Triangle meshes: STL (binary and ASCII), Wavefront OBJ, COLLADA (DAE).
//!
//! Only the geometry is read: no materials, textures, normals, and no other file than the one
//! named. Coordinates come in metres as the file means them: STL and OBJ as they stand; DAE after
//! its nodes' transforms and times its `unit`, but with `up_axis` ignored, as RViz and MoveIt do
//! (see [`dae`]). The readers are our own because a mesh may come from anywhere: they allocate in
//! proportion to the bytes read, never to a count that the file claims, and cannot panic.

mod dae;
mod obj;
mod stl;

use crate::error::FileError;
use crate::read::{Limits, read_bytes};
use std::path::Path;

/// Triangles in one file.
pub const MAX_TRIANGLES: usize = 2_000_000;
/// Metres from the origin: beyond this the file is broken, and arithmetic would be.
const FARTHEST: f64 = 1e7;

/// Triangles of which at least one is there, all corners finite, all indices in range.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    pub vertices: Vec<[f64; 3]>,
    /// Indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
    /// Of the file's bytes, in lower-case hexadecimal.
    pub sha256: String,
}

/// What all meshes of one scene or robot may cost together.
#[derive(Clone, Debug)]
pub struct MeshBudget {
    bytes: u64,
    triangles: usize,
}

impl Default for MeshBudget {
    /// 512 MiB in files, ten million triangles.
    fn default() -> Self {
        Self { bytes: 512 * 1024 * 1024, triangles: 10_000_000 }
    }
}

/// Reads one mesh, and takes what it cost from the budget.
pub fn load(path: &Path, budget: &mut MeshBudget) -> Result<Mesh, FileError> {
    let format = Format::of(path)?;
    let bytes = read_bytes(path, &Limits { bytes: Limits::MESH.bytes.min(budget.bytes) })?;
    budget.bytes -= bytes.len() as u64;
    let soup = from_bytes(path, format, &bytes)?;
    budget.triangles = budget.triangles.checked_sub(soup.triangles.len()).ok_or_else(|| {
        FileError::new(path, "the meshes together have too many triangles")
            .expected("at most ten million in one scene or robot")
            .help("use simplified collision meshes")
    })?;
    let sha256 = crate::read::sha256(&bytes);
    Ok(Mesh { vertices: soup.vertices, triangles: soup.triangles, sha256 })
}

/// By the name's extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Stl,
    Obj,
    Dae,
}

impl Format {
    fn of(path: &Path) -> Result<Format, FileError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("stl") => Ok(Format::Stl),
            Some("obj") => Ok(Format::Obj),
            Some("dae") => Ok(Format::Dae),
            other => Err(FileError::new(
                path,
                other.map_or_else(
                    || "a mesh file without extension".to_owned(),
                    |e| format!("a mesh file of type `.{e}`"),
                ),
            )
            .expected("`.stl`, `.obj` or `.dae`")
            .help("convert the mesh to one of these formats")),
        }
    }
}

/// What a reader of one format gives back.
#[derive(Debug, Default)]
struct Soup {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    /// Three corners of its own for each triangle, as STL has it.
    fn push_triangle(&mut self, corners: [[f64; 3]; 3]) {
        // No file within the limits holds 2³² corners.
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.triangles.push([first, first + 1, first + 2]);
    }
}

fn from_bytes(path: &Path, format: Format, bytes: &[u8]) -> Result<Soup, FileError> {
    let soup = match format {
        Format::Stl => stl::read(path, bytes)?,
        Format::Obj => obj::read(path, bytes)?,
        Format::Dae => dae::read(path, bytes)?,
    };
    if soup.triangles.is_empty() {
        return Err(FileError::new(path, "a mesh without triangles").help("export the mesh again, triangulated"));
    }
    if soup.triangles.len() > MAX_TRIANGLES {
        return Err(too_many_triangles(path));
    }
    for t in &soup.triangles {
        for &i in t {
            let Some(v) = soup.vertices.get(i as usize) else {
                return Err(FileError::new(path, format!("a triangle names corner {i} of {}", soup.vertices.len())));
            };
            // Written so that NaN fails too.
            if !v.iter().all(|x| x.abs() <= FARTHEST) {
                return Err(FileError::new(path, format!("a corner at [{}, {}, {}]", v[0], v[1], v[2]))
                    .expected("finite coordinates in metres"));
            }
        }
    }
    Ok(soup)
}

fn too_many_triangles(path: &Path) -> FileError {
    FileError::new(path, format!("more than {MAX_TRIANGLES} triangles")).help("use a simplified collision mesh")
}
