//! Plans on their way to files: mesh paths, JSON, the page.

use clearway_export::Mesh;
use clearway_files::{FileError, mesh, points};
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
    let (path_parts, base_parts): (Vec<Component>, Vec<Component>) =
        (path.components().collect(), base.components().collect());
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
    let (meshes, missing) = named_meshes(plan, directory, |_| true);
    let embedded = meshes.into_iter().map(|mesh| EmbeddedMesh {
        uri: mesh.uri,
        vertices: mesh.vertices.iter().map(|v| v.map(|c| c as f32)).collect(),
        triangles: mesh.triangles,
    });
    Ok((page_with_meshes(plan, &embedded.collect::<Vec<_>>())?, missing))
}

/// What is in the files that the plan's scene names; those that cannot be read are told.
pub fn scene_meshes(plan: &PlanFile, directory: &Path) -> (Vec<Mesh>, Vec<FileError>) {
    let bodies = || plan.scene.fixtures.iter().chain(&plan.scene.objects);
    let own = bodies().filter_map(|b| b.mesh.as_ref().map(|m| &m.file).or(b.points.as_ref().map(|p| &p.file)));
    let parts = bodies().flat_map(|b| b.compound.iter().flatten()).filter_map(|p| p.mesh.as_ref().map(|m| &m.file));
    let files: Vec<&String> = own.chain(parts).collect();
    named_meshes(plan, directory, |uri| files.iter().any(|file| *file == uri))
}

/// The files that the plan names, relative to its directory, if they are wanted.
fn named_meshes(plan: &PlanFile, directory: &Path, wanted: impl Fn(&str) -> bool) -> (Vec<Mesh>, Vec<FileError>) {
    let mut budget = mesh::MeshBudget::default();
    let clouds: Vec<&str> = plan.scene.fixtures.iter().filter_map(|f| Some(f.points.as_ref()?.file.as_str())).collect();
    let (mut meshes, mut missing) = (Vec::new(), Vec::new());
    for entry in plan.robot.meshes.iter().filter(|entry| wanted(&entry.uri)) {
        let path = directory.join(&entry.file);
        let read = if clouds.contains(&entry.uri.as_str()) {
            points::load(&path).map(|vertices| (vertices, Vec::new()))
        } else {
            mesh::load(&path, &mut budget).map(|mesh| (mesh.vertices, mesh.triangles))
        };
        match read {
            Ok((vertices, triangles)) => meshes.push(Mesh { uri: entry.uri.clone(), vertices, triangles }),
            Err(error) => missing.push(error),
        }
    }
    (meshes, missing)
}
