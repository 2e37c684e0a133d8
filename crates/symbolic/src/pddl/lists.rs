//! The lists that PDDL is made of: definitions, properties, names with types.

use super::names::{Once, one_of, unknown};
use super::sexpr::{Place, Sexpr, Source};
use super::unsupported;
use clearway_files::{FileError, quoted};

/// `(define (what name) …)`: the name, and what follows.
pub(super) fn define<'s, 't>(
    source: Source,
    whole: &'s Sexpr<'t>,
    what: &str,
) -> Result<(&'s Sexpr<'t>, &'s [Sexpr<'t>]), FileError> {
    let form = format!("`(define ({what} name) …)`");
    let Some([_, header, rest @ ..]) = whole.list().filter(|l| l.first().is_some_and(|d| d.is("define"))) else {
        return Err(source.error(whole.place, whole.quoted()).expected(form));
    };
    match header.list() {
        Some([kind, name]) if kind.is(what) && name.name().is_some() => Ok((name, rest)),
        Some([kind, ..]) if !kind.is(what) => {
            let error = source.error(header.place, format!("this defines {}", kind.quoted())).expected(form);
            Err(error.help(format!("is this the right file? It should define a {what}")))
        }
        _ => Err(source.error(header.place, header.quoted()).expected(form)),
    }
}

/// The keyword that a section begins with, in lower case, and what follows.
pub(super) fn section<'s, 't>(
    source: Source,
    at: &'s Sexpr<'t>,
    known: &[&'static str],
) -> Result<(&'static str, &'s [Sexpr<'t>]), FileError> {
    let Some([head, rest @ ..]) = at.list() else {
        let list = one_of(known.iter().copied()).unwrap_or_default();
        return Err(source.error(at.place, at.quoted()).expected(format!("a list that begins with {list}")));
    };
    Ok((keyword(source, head, known)?, rest))
}

fn keyword(source: Source, head: &Sexpr, known: &[&'static str]) -> Result<&'static str, FileError> {
    if let Some(keyword) = known.iter().find(|k| head.is(k)) {
        return Ok(keyword);
    }
    let name = head.to_string();
    match unsupported::section(&name) {
        Some(why) => Err(unsupported::error(source, head.place, &name, why)),
        None => {
            let known = known.iter().copied();
            Err(unknown(source, head.place, "keyword", &name, known, "is a parenthesis misplaced before it?"))
        }
    }
}

/// `:key value :key value …`: the value of each of `known`.
pub(super) fn properties<'s, 't, const N: usize>(
    source: Source,
    mut items: &'s [Sexpr<'t>],
    known: [&'static str; N],
) -> Result<[Option<&'s Sexpr<'t>>; N], FileError> {
    let mut values = [None; N];
    let mut once = Once::new("property");
    while let [key, rest @ ..] = items {
        let name = keyword(source, key, &known)?;
        once.check(source, name, key.place)?;
        let value = match rest {
            [value, ..] if value.name().is_none_or(|n| !n.starts_with(':')) => value,
            _ => {
                return Err(source.error(key.place, format!("`{name}` without a value")).help("a list must follow it"));
            }
        };
        for (slot, k) in values.iter_mut().zip(known) {
            if k == name {
                *slot = Some(value);
            }
        }
        items = &rest[1..];
    }
    Ok(values)
}

/// What a list says whose value must be a list; nothing where it is left out.
pub(super) fn items<'s, 't>(
    source: Source,
    value: Option<&'s Sexpr<'t>>,
    what: &str,
) -> Result<&'s [Sexpr<'t>], FileError> {
    let Some(value) = value else { return Ok(&[]) };
    value.list().ok_or_else(|| source.error(value.place, value.quoted()).expected(format!("{what} in parentheses")))
}

/// A name, and what was written after the next `-`.
pub(super) struct Typed<'s, 't> {
    pub at: &'s Sexpr<'t>,
    pub of: Option<&'s Sexpr<'t>>,
}

/// `a b - t c`: of names with types.
pub(super) fn typed<'s, 't>(source: Source, mut items: &'s [Sexpr<'t>]) -> Result<Vec<Typed<'s, 't>>, FileError> {
    let mut all: Vec<Typed> = Vec::new();
    let mut untyped = 0;
    loop {
        items = match items {
            [] => return Ok(all),
            [dash, rest @ ..] if dash.is("-") => {
                if untyped == all.len() {
                    return Err(source.error(dash.place, "`-` with no name before it"));
                }
                let [of, rest @ ..] = rest else {
                    return Err(source.error(dash.place, "no type after `-`").expected("the name of a type"));
                };
                for typed in &mut all[untyped..] {
                    typed.of = Some(of);
                }
                untyped = all.len();
                rest
            }
            [at, rest @ ..] => {
                all.push(Typed { at, of: None });
                rest
            }
        }
    }
}

/// `?a ?b - t c`: variables, each with its name.
pub(super) fn variables<'s, 't>(
    source: Source,
    items: &'s [Sexpr<'t>],
) -> Result<Vec<(&'t str, Typed<'s, 't>)>, FileError> {
    let mut once = Once::new("variable");
    let all = typed(source, items)?.into_iter().map(|typed| {
        let name = variable(source, typed.at)?;
        once.check(source, name, typed.at.place)?;
        Ok((name, typed))
    });
    all.collect()
}

fn variable<'t>(source: Source, at: &Sexpr<'t>) -> Result<&'t str, FileError> {
    match at.name() {
        Some(name) if name.len() > 1 && name.starts_with('?') => Ok(name),
        Some(name) if !name.starts_with(['?', '-', ':']) => {
            let error = source.error(at.place, quoted(name)).expected("a variable");
            Err(error.help(format!("write {}; a type follows a `-`", quoted(&format!("?{name}")))))
        }
        Some(name) if name.len() > 1 && name.starts_with('-') => {
            Err(source.error(at.place, quoted(name)).expected("a variable").help("put a space after the `-`"))
        }
        _ => Err(source.error(at.place, at.quoted()).expected("a variable, which begins with `?`")),
    }
}

/// An error where a list has too few or too many items.
pub(super) fn wrong_number(source: Source, place: Place, of: &str, found: usize, expected: usize) -> FileError {
    let s = if found == 1 { "" } else { "s" };
    source.error(place, format!("{of} has {found} argument{s}")).expected(expected.to_string())
}
