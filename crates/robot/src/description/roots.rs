//! Where the files that a robot names may lie: beside the robot file, or in a declared package.
//!
//! A path is followed only if it stays inside one of these directories, over symbolic links too.

use clearway_files::{FileError, Located, Root, closest, quoted};
use clearway_plan::RobotFile;
use std::path::{Component, Path, PathBuf};

/// The declared directories.
#[derive(Clone, Debug, Default)]
pub struct Roots {
    /// The robot file's own directory; a built-in robot has none.
    own: Option<Place>,
    /// Those from the command line first.
    packages: Vec<(String, Place)>,
}

#[derive(Clone, Debug)]
struct Place {
    root: Root,
    /// As it was given, made absolute: a path may be written with the links that `root` resolved.
    given: PathBuf,
}

impl Place {
    fn new(directory: &Path) -> Result<Self, FileError> {
        let root = Root::new(directory)?;
        let given = std::path::absolute(directory).map_or_else(|_| root.directory().to_owned(), |p| without_dots(&p));
        Ok(Self { root, given })
    }
}

impl Roots {
    /// `packages`: name → directory, relative to the current directory.
    pub fn new(own: Option<&Path>, packages: &[(String, PathBuf)]) -> Result<Self, FileError> {
        let own = own.map(Place::new).transpose()?;
        let packages = packages.iter().map(|(name, directory)| {
            let place = Place::new(directory)
                .map_err(|e| e.help(format!("`--package {name}=DIR` takes an existing directory")))?;
            Ok((name.clone(), place))
        });
        Ok(Self { own, packages: packages.collect::<Result<_, FileError>>()? })
    }

    /// Adds the packages that the robot file declares, relative to it.
    pub fn declare(&mut self, file: &Located<RobotFile>) -> Result<(), FileError> {
        let own = self.own.as_ref().map(|o| o.root.directory().to_owned()).unwrap_or_default();
        for (name, directory) in &file.value.packages {
            let place = Place::new(&own.join(directory))
                .map_err(|e| e.referenced_from(file.path(), file.position(&["packages", name])))?;
            self.packages.push((name.clone(), place));
        }
        Ok(())
    }

    /// The file that `uri` names: `package://NAME/…`, `file:///…`, or a path, relative to `base`.
    pub fn resolve(&self, uri: &str, base: &Path) -> Result<PathBuf, FileError> {
        if let Some(rest) = uri.strip_prefix("package://") {
            // Some write three slashes, and their tools let them.
            let rest = rest.trim_start_matches('/');
            let (name, inside) = rest.split_once('/').unwrap_or((rest, ""));
            return match self.packages.iter().find(|(n, _)| n == name) {
                Some((_, place)) => place.root.resolve(inside),
                None => Err(self.unknown_package(uri, name)),
            };
        }
        if let Some(path) = uri.strip_prefix("file://") {
            return self.inside(Path::new(path.strip_prefix("localhost").unwrap_or(path)), base);
        }
        if uri.contains("://") {
            return Err(FileError::new(uri, "neither a file nor in a package")
                .expected("`package://NAME/…`, `file:///…` or a path")
                .help("fetch the file, and name it by its path"));
        }
        self.inside(Path::new(uri), base)
    }

    fn unknown_package(&self, uri: &str, name: &str) -> FileError {
        let error = FileError::new(uri, format!("the package {} is not declared", quoted(name)));
        match closest(name, self.packages.iter().map(|(n, _)| n.as_str())) {
            Some(near) => error.help(format!("did you mean `{near}`?")),
            None => error.help(format!(
                "say where it is: `packages: {{{name}: DIRECTORY}}` in the robot file, or `--package {name}=DIRECTORY`"
            )),
        }
    }

    fn inside(&self, path: &Path, base: &Path) -> Result<PathBuf, FileError> {
        // By its letters first, so that `../../etc` tells nothing about what exists there.
        let wanted = without_dots(&base.join(path));
        let places = self.own.iter().chain(self.packages.iter().map(|(_, place)| place));
        for place in places {
            let rest = wanted.strip_prefix(place.root.directory()).or_else(|_| wanted.strip_prefix(&place.given));
            if let Ok(rest) = rest {
                return place.root.resolve(rest);
            }
        }
        Err(FileError::new(path, "a path that leaves the robot's directory")
            .expected("a file beside the robot file, or in a declared package")
            .help("move the file there, or declare its directory: `packages: {NAME: DIRECTORY}` in the robot file"))
    }
}

/// The path without `.` and `..`, judged by its letters alone.
fn without_dots(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}
