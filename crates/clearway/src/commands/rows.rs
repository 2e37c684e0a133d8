//! Where an experiment's rows go: to stdout, or to files in a directory, each row whole and kept as
//! soon as it is there.

use super::output;
use crate::exit::Failure;
use crate::interrupt;
use clearway::FileError;
use clearway_files::{Limits, read_text};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// The rows' end of one experiment.
pub struct Rows {
    file: Option<(PathBuf, File)>,
    summary: Option<PathBuf>,
}

impl Rows {
    pub fn on_stdout() -> Rows {
        Rows { file: None, summary: None }
    }

    /// Without a directory: stdout. With one: NAME.jsonl and summary.json in it, which must not be there.
    pub fn open(directory: Option<&Path>, name: &str) -> Result<Rows, Failure> {
        let Some(directory) = directory else { return Ok(Self::on_stdout()) };
        make(directory)?;
        let summary = directory.join("summary.json");
        if summary.exists() {
            return Err(taken(&summary, ANEW).into());
        }
        let file = create(&directory.join(name).with_extension("jsonl"), ANEW)?;
        Ok(Rows { file: Some(file), summary: Some(summary) })
    }

    /// NAME.jsonl in a directory, which must not be there, and beside it what it is made with.
    pub fn begin(directory: &Path, name: &str, settings: &Value) -> Result<Rows, Failure> {
        make(directory)?;
        let path = directory.join(name).with_extension("jsonl");
        if path.exists() {
            return Err(taken(&path, GO_ON).into());
        }
        output::write(&settings_of(&path), line(settings)?.as_bytes())?;
        let file = create(&path, GO_ON)?;
        Self::alone(file)
    }

    /// Goes on with NAME.jsonl, and hands its rows on. A last line that was cut short is taken away.
    pub fn resume<T: DeserializeOwned>(
        directory: &Path,
        name: &str,
        settings: &Value,
    ) -> Result<(Rows, Vec<T>), Failure> {
        let path = directory.join(name).with_extension("jsonl");
        let known = settings_of(&path);
        if !known.exists() && !path.exists() {
            // It was ended before it began.
            return Ok((Self::begin(directory, name, settings)?, Vec::new()));
        }
        let text = read_text(&known, &Limits::DOCUMENT)?;
        let made: Value = serde_json::from_str(&text)
            .map_err(|e| FileError::new(&known, format!("is not what an earlier run wrote: {e}")).help(ANEW))?;
        if made != *settings {
            return Err(FileError::new(
                &known,
                format!("the earlier run was made with {made}, this one would be with {settings}"),
            )
            .help("give the same options, or name another directory")
            .into());
        }
        let file = OpenOptions::new().append(true).create(true).open(&path).map_err(|e| unwritable(&path, &e))?;
        let rows = Self::alone((path.clone(), file))?;
        let (found, whole) = read(&path)?;
        if let Some((_, file)) = &rows.file {
            file.set_len(whole).and_then(|()| file.sync_all()).map_err(|e| unwritable(&path, &e))?;
        }
        Ok((rows, found))
    }

    /// Nobody else may add rows.
    fn alone((path, file): (PathBuf, File)) -> Result<Rows, Failure> {
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Err(FileError::new(&path, "another run is writing to it")
                .help("wait for its end, or name another directory")
                .into()),
            // A file system without locks is no reason not to work.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Rows { file: Some((path, file)), summary: None }),
        }
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

const ANEW: &str = "name another directory, or delete the file";
const GO_ON: &str = "go on with --resume, name another directory, or delete the file";

/// A file's rows, and how many bytes of it they are: a last line without an end was cut short and is none.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<(Vec<T>, u64), Failure> {
    let text = fs::read(path).map_err(|e| FileError::new(path, format!("cannot be read: {e}")))?;
    let whole = text.iter().rposition(|b| *b == b'\n').map_or(0, |last| last + 1);
    let mut rows = Vec::new();
    for (number, line) in text[..whole].split(|b| *b == b'\n').enumerate().filter(|(_, line)| !line.is_empty()) {
        let row = serde_json::from_slice(line).map_err(|e| {
            FileError::new(path, format!("is no row of this experiment: {e}"))
                .at_position(Some((number + 1, e.column())))
                .help("delete the line, and what it holds is run again with --resume")
        })?;
        rows.push(row);
    }
    Ok((rows, whole as u64))
}

fn settings_of(path: &Path) -> PathBuf {
    path.with_extension("settings.json")
}

fn make(directory: &Path) -> Result<(), FileError> {
    let impossible =
        |e| FileError::new(directory, format!("cannot be made a directory: {e}")).help("choose another one for --out");
    fs::create_dir_all(directory).map_err(impossible)
}

fn create(path: &Path, help: &str) -> Result<(PathBuf, File), FileError> {
    match OpenOptions::new().write(true).create_new(true).open(path) {
        Ok(file) => Ok((path.to_owned(), file)),
        Err(e) if e.kind() == ErrorKind::AlreadyExists => Err(taken(path, help)),
        Err(e) => Err(unwritable(path, &e)),
    }
}

fn taken(path: &Path, help: &str) -> FileError {
    FileError::new(path, "is there already, from an earlier run").help(help)
}

fn unwritable(path: &Path, error: &std::io::Error) -> FileError {
    FileError::new(path, format!("cannot be written: {error}")).help("choose another directory for --out")
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
