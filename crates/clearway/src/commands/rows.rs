//! Where an experiment's rows go: to stdout, or to files in a directory, each row whole and kept as
//! soon as it is there.

use super::output;
use crate::exit::Failure;
use crate::interrupt;
use clearway::FileError;
use serde::Serialize;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The rows' end of one experiment.
pub struct Rows {
    file: Option<(PathBuf, File)>,
    summary: Option<PathBuf>,
}

impl Rows {
    /// Without a directory: stdout. With one: NAME.jsonl and summary.json in it, which must not be there.
    pub fn open(directory: Option<&Path>, name: &str) -> Result<Rows, Failure> {
        let Some(directory) = directory else { return Ok(Rows { file: None, summary: None }) };
        fs::create_dir_all(directory).map_err(|e| {
            FileError::new(directory, format!("cannot be made a directory: {e}")).help("choose another one for --out")
        })?;
        let taken = |path: &Path| {
            FileError::new(path, "is there already, from an earlier run")
                .help("name another directory, or delete the file")
        };
        let summary = directory.join("summary.json");
        if summary.exists() {
            return Err(taken(&summary).into());
        }
        let path = directory.join(name).with_extension("jsonl");
        let file = OpenOptions::new().write(true).create_new(true).open(&path).map_err(|e| match e.kind() {
            ErrorKind::AlreadyExists => taken(&path),
            _ => FileError::new(&path, format!("cannot be written: {e}")).help("choose another directory for --out"),
        })?;
        Ok(Rows { file: Some((path, file)), summary: Some(summary) })
    }

    /// Adds a row, unless Ctrl-C was pressed.
    pub fn push(&mut self, row: &impl Serialize) -> Result<(), Failure> {
        let line = line(row)?;
        let _undisturbed = interrupt::writing();
        if interrupt::raised() {
            return Err(interrupted());
        }
        match &mut self.file {
            Some((path, file)) => {
                let written = file.write_all(line.as_bytes()).and_then(|()| file.sync_data());
                written.map_err(|e| FileError::new(&path, format!("cannot be written: {e}")).into())
            }
            None => output::print(line),
        }
    }

    /// The last line, or the summary's file.
    pub fn finish(&mut self, summary: &impl Serialize) -> Result<(), Failure> {
        match &self.summary {
            Some(path) => output::write(path, line(summary)?.as_bytes()),
            None => self.push(summary),
        }
    }
}

/// How a run ends that was interrupted; the rows so far stay.
pub fn interrupted() -> Failure {
    Failure { exit: crate::exit::Exit::Interrupted, message: "interrupted; the rows so far are kept".to_owned() }
}

fn line(row: &impl Serialize) -> Result<String, Failure> {
    let mut line = serde_json::to_string(row).map_err(|e| Failure::internal(format!("a row is no JSON: {e}")))?;
    line.push('\n');
    Ok(line)
}
