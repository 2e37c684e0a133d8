//! Names: of objects, fixtures and places, and of the one that is wanted.

use crate::MAX_FIXTURES;
use crate::source::Source;
use clearway_files::{FileError, closest, quoted};
use clearway_plan::{ObjectId, ObjectSet, SceneFile};
use std::collections::{HashMap, HashSet};

const LONGEST: usize = 64;

/// How many there are, and that each name is usable and stands for one thing.
pub(crate) fn check(source: &Source, file: &SceneFile) -> Result<(), FileError> {
    let count = |keys: &str, found: usize, most: usize| {
        if found <= most {
            return Ok(());
        }
        Err(source.error(&format!("{keys}.{most}"), format!("{found} {keys}")).expected(format!("at most {most}")))
    };
    if file.objects.is_empty() {
        return Err(source.error("objects", "no objects").expected("at least one, the target"));
    }
    count("objects", file.objects.len(), ObjectSet::CAPACITY)?;
    count("fixtures", file.fixtures.len(), MAX_FIXTURES)?;
    count("place", file.place.len(), MAX_FIXTURES)?;

    let mut taken = HashMap::new();
    let fixtures = file.fixtures.iter().enumerate().map(|(i, b)| (format!("fixtures.{i}"), "fixture", &b.id));
    let objects = file.objects.iter().enumerate().map(|(i, b)| (format!("objects.{i}"), "object", &b.id));
    for (keys, kind, id) in fixtures.chain(objects) {
        usable(source, &keys, kind, id)?;
        if let Some(other) = taken.insert(id.as_str(), kind) {
            return Err(source
                .error(&format!("{keys}.id"), format!("the id {} is taken by another {other}", quoted(id)))
                .expected("ids that are unique over objects and fixtures")
                .help("rename one of the two"));
        }
    }
    unique(source, "place", "place", file.place.iter().map(|p| p.id.as_str()))
}

/// That each name of the list at `keys` is usable, and stands for one thing.
pub(crate) fn unique<'i>(
    source: &Source,
    keys: &str,
    kind: &str,
    ids: impl Iterator<Item = &'i str>,
) -> Result<(), FileError> {
    let mut taken = HashSet::new();
    for (i, id) in ids.enumerate() {
        usable(source, &format!("{keys}.{i}"), kind, id)?;
        if !taken.insert(id) {
            return Err(source
                .error(&format!("{keys}.{i}.id"), format!("the id {} is taken by another {kind}", quoted(id)))
                .help("rename one of the two"));
        }
    }
    Ok(())
}

pub(crate) fn usable(source: &Source, keys: &str, kind: &str, id: &str) -> Result<(), FileError> {
    let wrong = |found: String| {
        Err(source.error(&format!("{keys}.id"), found).expected(format!("1 to {LONGEST} printable characters")))
    };
    if id.trim().is_empty() {
        wrong(format!("{} {kind} with an empty id", if kind.starts_with(['a', 'o']) { "an" } else { "a" }))
    } else if id.chars().count() > LONGEST {
        wrong(format!("the id {} has {} characters", quoted(id), id.chars().count()))
    } else if id.trim() != id || id.chars().any(char::is_control) {
        wrong(format!("the id {} holds control characters or outer spaces", quoted(id)))
    } else {
        Ok(())
    }
}

/// The object wanted.
pub(crate) fn target(source: &Source, file: &SceneFile) -> Result<ObjectId, FileError> {
    if let Some(i) = file.objects.iter().position(|o| o.id == file.target) {
        return Ok(ObjectId(i as u16));
    }
    let error = source.error("target", format!("the target {} is no object", quoted(&file.target)));
    if file.fixtures.iter().any(|f| f.id == file.target) {
        return Err(error
            .expected("the id of an object")
            .help("it is a fixture, which nobody may move: list it under `objects`"));
    }
    let ids = || file.objects.iter().map(|o| o.id.as_str());
    let error = error.expected(match file.objects.len() {
        0..=12 => format!("one of `{}`", ids().collect::<Vec<_>>().join("`, `")),
        many => format!("the id of one of the {many} objects"),
    });
    Err(match closest(&file.target, ids()) {
        Some(near) => error.help(format!("did you mean `{near}`?")),
        None => error,
    })
}
