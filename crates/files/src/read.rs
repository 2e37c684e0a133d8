//! Bytes and text out of regular files, at most so many.

use crate::error::FileError;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

const MIB: u64 = 1024 * 1024;

/// How large a file may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Bytes.
    pub bytes: u64,
}

impl Limits {
    /// Scene and robot files, URDF and SRDF: 8 MiB, some thousand times what they need.
    pub const DOCUMENT: Limits = Limits { bytes: 8 * MIB };
    /// One mesh or point file.
    pub const MESH: Limits = Limits { bytes: 64 * MIB };
    /// A plan file, which carries its robot and its trace.
    pub const PLAN: Limits = Limits { bytes: 256 * MIB };
}

impl Default for Limits {
    fn default() -> Self {
        Self::DOCUMENT
    }
}

/// The whole file. Only regular files are opened: a directory, a pipe or a device is an error, so
/// that nothing waits for a writer or reads for ever.
pub fn read_bytes(path: &Path, limits: &Limits) -> Result<Vec<u8>, FileError> {
    let regular = |metadata: &fs::Metadata| {
        if metadata.is_dir() {
            Err(FileError::new(path, "is a directory").expected("a file").help("name the file inside it"))
        } else if !metadata.is_file() {
            Err(FileError::new(path, "is not a regular file").expected("a file on disk, no pipe and no device"))
        } else if metadata.len() > limits.bytes {
            Err(too_large(path, metadata.len(), limits))
        } else {
            Ok(metadata.len())
        }
    };
    // Asked before opening, since opening a pipe would wait; and again of what was opened, since
    // the name may mean another file by then.
    regular(&fs::metadata(path).map_err(|e| unreadable(path, &e))?)?;
    let file = File::open(path).map_err(|e| unreadable(path, &e))?;
    let length = regular(&file.metadata().map_err(|e| unreadable(path, &e))?)?;
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    // A file can grow while it is read, and some that are not on a disk say that they are empty.
    file.take(limits.bytes + 1).read_to_end(&mut bytes).map_err(|e| unreadable(path, &e))?;
    if bytes.len() as u64 > limits.bytes {
        return Err(too_large(path, bytes.len() as u64, limits));
    }
    Ok(bytes)
}

/// The whole file as text, which must be UTF-8; a byte order mark is left out.
pub fn read_text(path: &Path, limits: &Limits) -> Result<String, FileError> {
    text_from_bytes(path, read_bytes(path, limits)?)
}

/// Bytes as text, which must be UTF-8; a byte order mark is left out.
pub fn text_from_bytes(path: &Path, bytes: Vec<u8>) -> Result<String, FileError> {
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let (line, column) = position_of_byte(bytes, good);
        FileError::new(path, format!("byte 0x{:02x} is not UTF-8", bytes.get(good).copied().unwrap_or_default()))
            .at(line, column)
            .expected("text in UTF-8")
            .help("is this the right file? If it is text, save it as UTF-8")
    })?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

/// Line and column (in characters, both from 1) of the byte at `offset`.
pub(crate) fn position_of_byte(bytes: &[u8], offset: usize) -> (usize, usize) {
    let before = bytes.get(..offset).unwrap_or(bytes);
    let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
    let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
    // All but UTF-8's continuation bytes.
    let column = 1 + before[line_start..].iter().filter(|&&b| b & 0xc0 != 0x80).count();
    (line, column)
}

fn unreadable(path: &Path, error: &io::Error) -> FileError {
    match error.kind() {
        io::ErrorKind::NotFound => {
            let missing = FileError::new(path, "no such file");
            match path.parent().filter(|p| !p.as_os_str().is_empty() && !p.exists()) {
                Some(parent) => missing.help(format!("the directory {} does not exist either", parent.display())),
                None => missing.help("check the spelling; relative paths start at the current directory, and inside a file at that file's directory"),
            }
        }
        io::ErrorKind::PermissionDenied => FileError::new(path, "may not be read")
            .help("give yourself read permission on the file and its directories"),
        _ => FileError::new(path, format!("cannot be read: {error}")),
    }
}

fn too_large(path: &Path, found: u64, limits: &Limits) -> FileError {
    let mib = |bytes: u64| bytes as f64 / MIB as f64;
    FileError::new(path, format!("holds {:.1} MiB", mib(found)))
        .expected(format!("at most {:.0} MiB", mib(limits.bytes)))
        .help("is this the right file?")
}

/// Of some bytes, in lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    use sha2::{Digest, Sha256};
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
