//! Files that are whole or not there.

use crate::error::FileError;
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes beside `path` under another name, syncs, and renames: whoever reads `path` sees the old
/// content or the new, never a part, even if the machine stops meanwhile. After an error nothing
/// is left behind. A device or pipe (`/dev/stdout`) is written to as it is, never replaced.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), FileError> {
    let path = path.as_ref();
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(is_directory(path)),
        Ok(metadata) if !metadata.is_file() => {
            return OpenOptions::new()
                .write(true)
                .open(path)
                .and_then(|mut f| f.write_all(bytes))
                .map_err(|e| unwritable(path, &e));
        }
        _ => {}
    }
    // Through a symbolic link, so that the link stays and the file it names is replaced.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let temporary = name_beside(&target).ok_or_else(|| FileError::new(path, "has no file name"))?;
    let written = (|| {
        let mut file = OpenOptions::new().write(true).create_new(true).open(&temporary)?;
        file.write_all(bytes)?;
        if let Ok(metadata) = fs::metadata(&target) {
            file.set_permissions(metadata.permissions())?;
        }
        file.sync_all()?;
        fs::rename(&temporary, &target)
    })();
    if let Err(error) = written {
        // It may not have been created at all; the first error is the one to tell.
        let _ = fs::remove_file(&temporary);
        return Err(unwritable(path, &error));
    }
    // The rename itself lasts once the directory is synced; not every file system can.
    if let Some(Ok(directory)) = target.parent().map(File::open) {
        let _ = directory.sync_all();
    }
    Ok(())
}

/// Whether [`write_atomic`] could write there now, to be asked before long work. Leaves nothing.
/// Devices and pipes are not tried: opening a pipe may wait for its reader.
pub fn check_writable(path: impl AsRef<Path>) -> Result<(), FileError> {
    let path = path.as_ref();
    match fs::metadata(path) {
        Ok(metadata) if metadata.is_dir() => return Err(is_directory(path)),
        Ok(metadata) if !metadata.is_file() => return Ok(()),
        _ => {}
    }
    let target = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let temporary = name_beside(&target).ok_or_else(|| FileError::new(path, "has no file name"))?;
    OpenOptions::new().write(true).create_new(true).open(&temporary).map_err(|e| unwritable(path, &e))?;
    fs::remove_file(&temporary).map_err(|e| unwritable(path, &e))
}

fn is_directory(path: &Path) -> FileError {
    FileError::new(path, "is a directory").expected("the name of a file to write")
}

fn name_beside(target: &Path) -> Option<PathBuf> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let mut name = OsString::from(".");
    name.push(target.file_name()?);
    name.push(format!(".{}.{}.part", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed)));
    Some(target.with_file_name(name))
}

fn unwritable(path: &Path, error: &io::Error) -> FileError {
    match error.kind() {
        io::ErrorKind::NotFound => {
            let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            FileError::new(path, "cannot be written: its directory does not exist")
                .help(format!("create it first: mkdir -p {}", parent.display()))
        }
        io::ErrorKind::NotADirectory => {
            FileError::new(path, "cannot be written: what should be its directory is a file")
                .help("choose another name")
        }
        io::ErrorKind::ReadOnlyFilesystem => FileError::new(path, "cannot be written: the file system is read-only")
            .help("choose a directory that you may write to"),
        io::ErrorKind::PermissionDenied => FileError::new(path, "cannot be written: permission denied")
            .help("choose a directory that you may write to"),
        _ => FileError::new(path, format!("cannot be written: {error}")),
    }
}
