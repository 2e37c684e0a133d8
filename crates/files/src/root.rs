//! A declared directory, and the files inside it.

use crate::error::{FileError, quoted};
use std::io;
use std::path::{Component, Path, PathBuf};

/// A directory out of which files may be named by other files; nothing outside it may.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Root {
    /// Without symbolic links or `..`.
    directory: PathBuf,
}

impl Root {
    pub fn new(directory: impl AsRef<Path>) -> Result<Root, FileError> {
        let given = directory.as_ref();
        // The directory of `shelf.yaml` is written as the empty path.
        let given = if given.as_os_str().is_empty() { Path::new(".") } else { given };
        let directory = given.canonicalize().map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => FileError::new(given, "no such directory").help("check the spelling"),
            _ => FileError::new(given, format!("cannot be entered: {error}")),
        })?;
        if directory.is_dir() { Ok(Root { directory }) } else { Err(FileError::new(given, "is not a directory")) }
    }

    pub fn directory(&self) -> &Path {
        &self.directory
    }

    /// The existing file that `relative` names. An absolute path is refused, and one that ends
    /// outside the directory, be it by `..` or over a symbolic link.
    pub fn resolve(&self, relative: impl AsRef<Path>) -> Result<PathBuf, FileError> {
        let relative = relative.as_ref();
        let outside = |found: &str| {
            FileError::new(relative, found)
                .expected(format!("a file inside {}", self.directory.display()))
                .help("move the file into that directory, and name it relative to it")
        };
        if relative.as_os_str().is_empty() {
            return Err(FileError::new(&self.directory, "an empty path").expected("the name of a file"));
        }
        let rooted = |c| matches!(c, Component::Prefix(_) | Component::RootDir);
        if relative.is_absolute() || relative.components().any(rooted) {
            return Err(outside("an absolute path"));
        }
        // Judged by its letters first, so that `../../etc` tells nothing about what exists there.
        let mut depth = 0_i64;
        for component in relative.components() {
            match component {
                Component::ParentDir => depth -= 1,
                Component::Normal(_) => depth += 1,
                _ => {}
            }
            if depth < 0 {
                return Err(outside("a path that leaves its directory"));
            }
        }
        let file = self.directory.join(relative).canonicalize().map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => FileError::new(self.directory.join(relative), "no such file").help(format!(
                "the path {} starts at {}",
                quoted(&relative.to_string_lossy()),
                self.directory.display()
            )),
            _ => FileError::new(self.directory.join(relative), format!("cannot be read: {error}")),
        })?;
        if file.starts_with(&self.directory) { Ok(file) } else { Err(outside("a path that leaves its directory")) }
    }
}
