//! One file per command.

pub mod demo;
pub mod explain;
pub mod export;
pub mod generate;
pub mod plan;
pub mod robot;
pub mod schema;
mod summary;
pub mod verify;
pub mod view;

use crate::exit::Failure;
use clearway::PlanFile;
use std::path::{Path, PathBuf};

/// The directory of a file to be written or read, for paths relative to it.
fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    Ok(clearway_files::write_atomic(path, bytes)?)
}

/// Prints to stdout; a reader that went away is no error.
fn print(text: &str) {
    use std::io::Write;
    let _ = std::io::stdout().write_all(text.as_bytes());
}

fn write_plan(path: &Path, plan: &PlanFile) -> Result<(), Failure> {
    let json = clearway::to_json(plan).map_err(|e| Failure::internal(format!("the plan is no JSON: {e}")))?;
    write(path, &json)
}

fn write_page(path: &Path, plan: &PlanFile, plan_directory: &Path) -> Result<(), Failure> {
    let (page, missing) = clearway::page(plan, plan_directory).map_err(|e| Failure::bad_input(e.to_string()))?;
    for error in missing {
        eprintln!("warning: drawn without a mesh: {error}");
    }
    write(path, page.as_bytes())
}
