//! Reads goals, against a domain and what there is.

use super::ast::{Constant, Domain, Goal};
use super::contradiction;
use super::domain::requirements;
use super::formula::Reader;
use super::lists::{define, section};
use super::names::{Names, Once};
use super::sexpr::{self, Sexpr, Source};
use clearway_files::{FileError, quoted};
use std::path::Path;

const SECTIONS: [&str; 5] = [":domain", ":requirements", ":objects", ":init", ":goal"];

impl Goal {
    /// Reads `text`, of which `path` is the name for messages: a formula, `(:goal formula)`, or a problem that
    /// says nothing but its goal. It may name what is `known`, and the constants of the domain.
    pub fn read(path: &Path, text: &str, domain: &Domain, known: &[Constant]) -> Result<Goal, FileError> {
        let source = Source { path };
        let whole = sexpr::read(source, text)?;
        let names = Names::new(source, &domain.types, &domain.predicates, known.iter().chain(&domain.constants));
        let at = match whole.list() {
            Some([head, ..]) if head.is("define") => problem(source, &whole, domain)?,
            Some([head, rest @ ..]) if head.is(":goal") => only(source, &whole, rest)?,
            _ => &whole,
        };
        let mut reader = Reader::new(&names);
        let formula = reader.formula(at)?;
        match contradiction::find(&names, &formula, reader.slots, &reader.places, at.place) {
            Some(error) => Err(error),
            None => Ok(Goal { slots: reader.slots, formula, text: text.trim().to_owned() }),
        }
    }
}

/// The goal of `(define (problem …) …)`.
fn problem<'s, 't>(source: Source, whole: &'s Sexpr<'t>, domain: &Domain) -> Result<&'s Sexpr<'t>, FileError> {
    let (_, rest) = define(source, whole, "problem")?;
    let mut once = Once::new("section");
    let (mut of, mut goal) = (None, None);
    for at in rest {
        let (keyword, rest) = section(source, at, &SECTIONS)?;
        once.check(source, keyword, at.place)?;
        match keyword {
            ":goal" => goal = Some(only(source, at, rest)?),
            ":requirements" => requirements(source, rest)?,
            ":domain" => match rest {
                [name] if name.name() == Some(&domain.name) => of = Some(name),
                [name] => {
                    let error = source.error(name.place, format!("a problem of the domain {}", name.quoted()));
                    return Err(error
                        .expected(quoted(&domain.name))
                        .help("is this the right file, and the right domain?"));
                }
                _ => return Err(source.error(at.place, at.quoted()).expected("`(:domain name)`")),
            },
            _ => {
                let error =
                    source.error(at.place, format!("`{keyword}` in a goal")).expected("`:domain` and `:goal` alone");
                return Err(error.help("the scene file gives what there is and how it stands: leave this out"));
            }
        }
    }
    let missing = |what: &str| source.error(whole.place, format!("a problem without its {what}"));
    match (of, goal) {
        (Some(_), Some(goal)) => Ok(goal),
        (None, _) => Err(missing("domain").help(format!("add {}", quoted(&format!("(:domain {})", domain.name))))),
        (_, None) => Err(missing("goal").help("add `(:goal formula)`")),
    }
}

fn only<'s, 't>(source: Source, at: &'s Sexpr<'t>, rest: &'s [Sexpr<'t>]) -> Result<&'s Sexpr<'t>, FileError> {
    match rest {
        [goal] => Ok(goal),
        [_, second, ..] => {
            let error = source.error(second.place, "a second formula").expected("one formula");
            Err(error.help("join them: `(:goal (and …))`"))
        }
        [] => Err(source.error(at.place, "no formula").expected("`(:goal formula)`")),
    }
}
