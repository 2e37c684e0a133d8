//! What is written: to files, whole and only where that destroys nothing; to stdout and stderr.

use super::directory_of;
use crate::exit::{Exit, Failure};
use crate::interrupt;
use clearway::{FileError, PlanFile};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Before any work: every output can be written, and none is an input or another output.
pub fn check<'a>(outputs: impl IntoIterator<Item = &'a Path>, inputs: &[&Path]) -> Result<(), Failure> {
    let mut taken: Vec<(&Path, &str)> = inputs.iter().map(|p| (*p, "the input")).collect();
    for output in outputs {
        if let Some((_, what)) = taken.iter().find(|(other, _)| same_file(output, other)) {
            return Err(FileError::new(output, format!("would be written over {what}"))
                .help("name another file")
                .into());
        }
        clearway_files::check_writable(output)?;
        taken.push((output, "another output"));
    }
    Ok(())
}

/// Devices and pipes, `/dev/null` say, are never in each other's way.
fn same_file(a: &Path, b: &Path) -> bool {
    let special = a.metadata().is_ok_and(|m| !m.is_file());
    !special && whole(a).is_some_and(|a| whole(b).is_some_and(|b| a == b))
}

/// The path without links and dots, whether or not there is a file yet.
fn whole(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok().or_else(|| Some(directory_of(path).canonicalize().ok()?.join(path.file_name()?)))
}

/// Writes a file whole, unless Ctrl-C was pressed.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let _undisturbed = interrupt::writing();
    if interrupt::raised() {
        return Err(Failure {
            exit: Exit::Interrupted,
            message: format!("interrupted; {} was not written", path.display()),
        });
    }
    Ok(clearway_files::write_atomic(path, bytes)?)
}

/// Prints to stdout. A reader that went away is no error.
pub fn print(bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(bytes.as_ref()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::bad_input(format!("stdout cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Tells on stderr; there is nowhere to say that this failed.
pub fn tell(text: &str) {
    let _ = writeln!(io::stderr(), "{}", text.trim_end());
}

pub fn write_plan(path: &Path, plan: &PlanFile) -> Result<(), Failure> {
    let json = clearway::to_json(plan).map_err(|e| Failure::internal(format!("the plan is no JSON: {e}")))?;
    write(path, &json)
}

pub fn write_page(path: &Path, plan: &PlanFile, plan_directory: &Path) -> Result<(), Failure> {
    let (page, missing) = clearway::page(plan, plan_directory).map_err(|e| Failure::bad_input(e.to_string()))?;
    for error in missing {
        tell(&format!("warning: drawn without a mesh: {error}"));
    }
    write(path, page.as_bytes())
}
