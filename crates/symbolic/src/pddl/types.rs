//! `(:types …)`: a tree, of which `object` is the root.

use super::ast::{TypeId, Types};
use super::lists::typed;
use super::names::{Once, given, type_name};
use super::sexpr::{Place, Sexpr, Source};
use clearway_files::{FileError, quoted};
use std::collections::HashMap;

const MAX_TYPES: usize = 1000;

/// A parent that is not declared itself is a child of `object`.
pub(super) fn types(source: Source, items: &[Sexpr]) -> Result<Types, FileError> {
    let listed = typed(source, items)?;
    let mut once = Once::new("type");
    let mut types =
        Tree { source, names: vec!["object"], parents: vec![None], places: vec![(1, 1)], ids: HashMap::new() };
    types.ids.insert("object", Types::OBJECT);
    for typed in &listed {
        let name = given(source, typed.at, "a type")?;
        once.check(source, name, typed.at.place)?;
        if name == "object" {
            if let Some(of) = typed.of.filter(|of| of.name() != Some("object")) {
                let error = source.error(of.place, "a parent of `object`").expected("`object`");
                return Err(error.help("all types are children of `object`, which has no parent"));
            }
        } else {
            types.add(name, typed.at.place)?;
        }
    }
    for typed in &listed {
        let (Some(child), Some(of)) = (typed.at.name().filter(|&n| n != "object"), typed.of) else { continue };
        let name = type_name(source, of)?;
        let parent = match types.ids.get(name) {
            Some(&parent) => parent,
            None => types.add(given(source, of, "a type")?, of.place)?,
        };
        let child = types.ids[child];
        types.parents[child.0] = Some(parent);
    }
    types.check()?;
    Ok(Types { names: types.names.into_iter().map(str::to_owned).collect(), parents: types.parents })
}

struct Tree<'a, 't> {
    source: Source<'a>,
    names: Vec<&'t str>,
    parents: Vec<Option<TypeId>>,
    places: Vec<Place>,
    ids: HashMap<&'t str, TypeId>,
}

impl<'t> Tree<'_, 't> {
    fn add(&mut self, name: &'t str, place: Place) -> Result<TypeId, FileError> {
        if self.names.len() == MAX_TYPES {
            return Err(self.source.error(place, "too many types").expected(format!("at most {MAX_TYPES}")));
        }
        let id = TypeId(self.names.len());
        self.names.push(name);
        self.parents.push(Some(Types::OBJECT));
        self.places.push(place);
        self.ids.insert(name, id);
        Ok(id)
    }

    /// That no type is above itself.
    fn check(&self) -> Result<(), FileError> {
        for start in 0..self.names.len() {
            let mut circle = vec![quoted(self.names[start])];
            let mut at = self.parents[start];
            while let Some(TypeId(above)) = at {
                circle.push(quoted(self.names[above]));
                if above == start {
                    let error =
                        self.source.error(self.places[start], format!("a circle of types: {}", circle.join(" - ")));
                    return Err(error.help("a type cannot be above itself: leave out one of these parents"));
                }
                // One that leads into a circle without being of it.
                if circle.len() > self.names.len() {
                    break;
                }
                at = self.parents[above];
            }
        }
        Ok(())
    }
}
