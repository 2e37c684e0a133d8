//! Text as names and lists of them, each with its place.
//!
//! Knows no PDDL. Names stay as written. What is read is bounded in depth and in number, so that whoever walks it
//! may recurse.

use clearway_files::{FileError, quoted};
use std::fmt;
use std::path::Path;

/// Lists within each other.
pub(super) const MAX_DEPTH: usize = 100;
/// Names and lists in one text.
pub(super) const MAX_NODES: usize = 200_000;

/// Line and column, from 1; columns count characters.
pub(super) type Place = (usize, usize);

/// The file that is read, for messages.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
}

impl Source<'_> {
    pub fn error(self, (line, column): Place, found: impl Into<String>) -> FileError {
        FileError::new(self.path, found).at(line, column)
    }
}

#[derive(Debug)]
pub(super) struct Sexpr<'t> {
    pub place: Place,
    pub node: Node<'t>,
}

#[derive(Debug)]
pub(super) enum Node<'t> {
    Name(&'t str),
    List(Vec<Sexpr<'t>>),
}

impl<'t> Sexpr<'t> {
    pub fn name(&self) -> Option<&'t str> {
        match self.node {
            Node::Name(name) => Some(name),
            Node::List(_) => None,
        }
    }

    pub fn list(&self) -> Option<&[Sexpr<'t>]> {
        match &self.node {
            Node::Name(_) => None,
            Node::List(items) => Some(items),
        }
    }

    /// The name that a list begins with.
    pub fn head(&self) -> Option<&'t str> {
        self.list()?.first()?.name()
    }

    /// Whether this is the keyword; those may be in upper case.
    pub fn is(&self, keyword: &str) -> bool {
        self.name().is_some_and(|name| name.eq_ignore_ascii_case(keyword))
    }

    /// For messages.
    pub fn quoted(&self) -> String {
        quoted(&self.to_string())
    }
}

impl fmt::Display for Sexpr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.node {
            Node::Name(name) => f.write_str(name),
            Node::List(items) => {
                f.write_str("(")?;
                for (i, item) in items.iter().enumerate() {
                    write!(f, "{}{item}", if i > 0 { " " } else { "" })?;
                }
                f.write_str(")")
            }
        }
    }
}

/// The one list or name that the text holds.
pub(super) fn read<'t>(source: Source, text: &'t str) -> Result<Sexpr<'t>, FileError> {
    let mut tokens = Tokens { source, rest: text, place: (1, 1) };
    let mut open: Vec<(Place, Vec<Sexpr<'t>>)> = Vec::new();
    let mut whole: Option<Sexpr<'t>> = None;
    let mut nodes = 0;
    let mut hint = None;
    while let Some((place, token)) = tokens.next()? {
        if let (true, Some(whole)) = (open.is_empty(), &whole) {
            return Err(after_the_end(source, place, token, whole));
        }
        nodes += usize::from(token != ")");
        if nodes > MAX_NODES {
            let many = source.error(place, format!("more than {MAX_NODES} names and lists"));
            return Err(many.help("is this the right file?"));
        }
        let item = match token {
            "(" if open.len() == MAX_DEPTH => {
                let deep = source.error(place, format!("more than {MAX_DEPTH} lists within each other"));
                return Err(deep.help("is this the right file?"));
            }
            "(" => {
                open.push((place, Vec::new()));
                continue;
            }
            ")" => match open.pop() {
                Some((place, items)) => Sexpr { place, node: Node::List(items) },
                None => return Err(source.error(place, "`)` closes nothing").expected("`(`")),
            },
            name => {
                // A section within a section: most likely the outer one should have ended before.
                if let ([_, (outer, items), .., (inner, first)], true, true) =
                    (&open[..], name.starts_with(':'), hint.is_none())
                    && first.is_empty()
                    && let Some(section) = items.first().and_then(Sexpr::name)
                {
                    hint = Some((*outer, section, *inner, name));
                }
                Sexpr { place, node: Node::Name(name) }
            }
        };
        match open.last_mut() {
            Some((_, items)) => items.push(item),
            None => whole = Some(item),
        }
    }
    if let Some((place, items)) = open.pop() {
        return Err(not_closed(source, place, &items, open.len() + 1, tokens.place, hint));
    }
    whole.ok_or_else(|| source.error((1, 1), "nothing but space").expected("`(`").help("is this the right file?"))
}

fn after_the_end(source: Source, place: Place, token: &str, whole: &Sexpr) -> FileError {
    let (line, column) = whole.place;
    if token == ")" {
        let error = source.error(place, "`)` closes nothing");
        error.help(format!("what begins at {line}:{column} is closed already: there is one too many, here or before"))
    } else {
        let error = source.error(place, format!("{} after the end of what begins at {line}:{column}", quoted(token)));
        error.help("delete it; or did a `)` too many end it too early?")
    }
}

type Hint<'t> = (Place, &'t str, Place, &'t str);

fn not_closed(
    source: Source,
    place: Place,
    items: &[Sexpr],
    depth: usize,
    end: Place,
    hint: Option<Hint>,
) -> FileError {
    if let Some((outer, section, inner, name)) = hint {
        let error = source.error(outer, format!("{} is not closed", quoted(&format!("({section}"))));
        let next = quoted(&format!("({name}"));
        return error.expected(format!("`)` before {next} at {}:{}", inner.0, inner.1));
    }
    let shown = quoted(&format!("({}", items.first().and_then(Sexpr::name).unwrap_or_default()));
    let error = source.error(place, format!("{shown} is not closed")).expected("`)`");
    let lists = if depth == 1 { "list is" } else { "lists are" };
    error.help(format!("the text ends at {}:{}, where {depth} {lists} open", end.0, end.1))
}

struct Tokens<'a, 't> {
    source: Source<'a>,
    rest: &'t str,
    place: Place,
}

impl<'t> Tokens<'_, 't> {
    /// `(`, `)` or a name.
    fn next(&mut self) -> Result<Option<(Place, &'t str)>, FileError> {
        loop {
            let Some(c) = self.rest.chars().next() else { return Ok(None) };
            let place = self.place;
            match c {
                '\n' => {
                    self.rest = &self.rest[1..];
                    self.place = (place.0 + 1, 1);
                }
                ' ' | '\t' | '\r' => _ = self.take(1),
                ';' => _ = self.take(self.rest.find('\n').unwrap_or(self.rest.len())),
                '(' | ')' => return Ok(Some((place, self.take(1)))),
                c if is_of_names(c) => {
                    let length = self.rest.find(|c| !is_of_names(c)).unwrap_or(self.rest.len());
                    return Ok(Some((place, self.take(length))));
                }
                c => {
                    let error = self
                        .source
                        .error(place, format!("the character {} (U+{:04X})", quoted(&c.to_string()), u32::from(c)));
                    return Err(error.expected("names, `(`, `)`, and comments from `;` to the end of the line"));
                }
            }
        }
    }

    /// So many bytes, none of them the end of a line.
    fn take(&mut self, bytes: usize) -> &'t str {
        let (taken, rest) = self.rest.split_at(bytes);
        self.rest = rest;
        self.place.1 += taken.chars().count();
        taken
    }
}

fn is_of_names(c: char) -> bool {
    c.is_alphanumeric() || "-_?:.=/+*<>@#!$%&^~|".contains(c)
}
