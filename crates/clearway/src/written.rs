//! Plans on their way to files: mesh paths, JSON, the page.

use clearway_files::{FileError, mesh};
use clearway_plan::PlanFile;
use clearway_viewer::{EmbeddedMesh, PageError, page_with_meshes};
use std::path::{Component, Path, PathBuf};

/// The plan with its mesh files named relative to the directory that it will be written to.
pub fn with_meshes_relative_to(mut plan: PlanFile, directory: &Path) -> PlanFile {
    let base = directory.canonicalize().unwrap_or_else(|_| directory.to_owned());
    for entry in &mut plan.robot.meshes {
        let path = Path::new(&entry.file);
        let path = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        entry.file = relative(&path, &base).to_string_lossy().into_owned();
    }
    plan
}

fn relative(path: &Path, base: &Path) -> PathBuf {
    let (path_parts, base_parts): (Vec<Component>, Vec<Component>) = (path.components().collect(), base.components().collect());
    let shared = path_parts.iter().zip(&base_parts).take_while(|(a, b)| a == b).count();
    let mut out: PathBuf = base_parts[shared..].iter().map(|_| Component::ParentDir).collect();
    out.extend(&path_parts[shared..]);
    out
}

/// The plan as a file's content: one line of JSON.
pub fn to_json(plan: &PlanFile) -> Result<Vec<u8>, serde_json::Error> {
    let mut text = serde_json::to_vec(plan)?;
    text.push(b'\n');
    Ok(text)
}

/// The plan's page, with the meshes that it names; those that cannot be read are left out and told.
pub fn page(plan: &PlanFile, directory: &Path) -> Result<(String, Vec<FileError>), PageError> {
    let mut budget = mesh::MeshBudget::default();
    let mut missing = Vec::new();
    let mut meshes = Vec::new();
    for entry in &plan.robot.meshes {
        match mesh::load(&directory.join(&entry.file), &mut budget) {
            Ok(mesh) => meshes.push(EmbeddedMesh {
                uri: entry.uri.clone(),
                vertices: mesh.vertices.iter().map(|v| v.map(|c| c as f32)).collect(),
                triangles: mesh.triangles,
            }),
            Err(error) => missing.push(error),
        }
    }
    Ok((page_with_meshes(plan, &meshes)?, missing))
}
