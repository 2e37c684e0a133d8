//! XML (URDF, SRDF, COLLADA) within bounds.
//!
//! The text is first walked once, linearly and without recursion, to bound what the parser will
//! meet: depth, elements, attributes of one element, namespaces. Document types are refused, and
//! with them entities. Costs a few milliseconds per megabyte.

use crate::error::{FileError, quoted};
use crate::read::position_of_byte;
use roxmltree::{Document, Node, ParsingOptions};
use std::path::Path;

/// Elements within elements.
pub const MAX_DEPTH: usize = 256;
/// Elements in a file.
pub const MAX_ELEMENTS: usize = 200_000;
/// Attributes of one element: the parser compares each with each.
const MAX_ATTRIBUTES: usize = 256;
/// `xmlns` in a file: the parser copies what is inherited.
const MAX_NAMESPACES: usize = 256;

/// Parses `text`, of which `path` is the name for messages.
pub fn parse<'t>(path: &Path, text: &'t str) -> Result<Document<'t>, FileError> {
    within_bounds(path, text)?;
    let options =
        ParsingOptions { allow_dtd: false, nodes_limit: 4 * MAX_ELEMENTS as u32, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let pos = error.pos();
        let message = error.to_string();
        let found = message.rsplit_once(" at ").map_or(message.as_str(), |(before, _)| before);
        FileError::new(path, format!("not well-formed XML: {found}"))
            .at(pos.row as usize, pos.col as usize)
            .help("is this the right file? `xmllint --noout FILE` explains XML errors at length")
    })
}

/// Line and column of a node, from 1. Linear in the text before it: for error messages.
pub fn position(node: Node) -> (usize, usize) {
    let pos = node.document().text_pos_at(node.range().start);
    (pos.row as usize, pos.col as usize)
}

/// Walks over the markup alone. What is not well-formed is left for the parser to tell.
fn within_bounds(path: &Path, text: &str) -> Result<(), FileError> {
    let bytes = text.as_bytes();
    let place = |offset: usize, found: String| {
        let (line, column) = position_of_byte(bytes, offset);
        FileError::new(path, found).at(line, column)
    };
    let (mut depth, mut elements, mut namespaces) = (0_usize, 0_usize, 0_usize);
    let mut at = 0;
    while let Some(offset) = find(bytes, at, b"<") {
        let rest = &bytes[offset..];
        at = if rest.starts_with(b"<!--") {
            end_of(bytes, offset + 4, b"-->")
        } else if rest.starts_with(b"<![CDATA[") {
            end_of(bytes, offset + 9, b"]]>")
        } else if rest.starts_with(b"<?") {
            end_of(bytes, offset + 2, b"?>")
        } else if rest.starts_with(b"<!") {
            return Err(place(offset, "a document type or entity declaration".to_owned())
                .expected("XML without a DTD")
                .help("delete the declaration, and write out the entities that it defines"));
        } else if rest.starts_with(b"</") {
            depth = depth.saturating_sub(1);
            end_of(bytes, offset + 2, b">")
        } else {
            let tag = Tag::scan(bytes, offset + 1);
            elements += 1;
            namespaces += tag.namespaces;
            if elements > MAX_ELEMENTS {
                return Err(place(offset, format!("more than {MAX_ELEMENTS} elements")).help("is this the right file?"));
            }
            if !tag.closes_itself {
                depth += 1;
            }
            if depth > MAX_DEPTH {
                return Err(place(offset, format!("elements nested more than {MAX_DEPTH} deep"))
                    .help("is this the right file? No model needs such depth"));
            }
            if tag.attributes > MAX_ATTRIBUTES {
                return Err(place(offset, format!("an element with more than {MAX_ATTRIBUTES} attributes")));
            }
            if namespaces > MAX_NAMESPACES {
                return Err(place(offset, format!("more than {MAX_NAMESPACES} namespace declarations")));
            }
            tag.end
        };
    }
    if elements == 0 {
        let start: String = text.trim_start().chars().take(20).collect();
        let found = if start.is_empty() {
            "an empty file".to_owned()
        } else {
            format!("text that starts with {}", quoted(&start))
        };
        return Err(FileError::new(path, found).at(1, 1).expected("XML").help("is this the right file?"));
    }
    Ok(())
}

/// A start tag, seen from outside.
struct Tag {
    /// The byte after `>`.
    end: usize,
    closes_itself: bool,
    attributes: usize,
    namespaces: usize,
}

impl Tag {
    /// `start` is the byte after `<`.
    fn scan(bytes: &[u8], start: usize) -> Tag {
        let mut tag = Tag { end: bytes.len(), closes_itself: false, attributes: 0, namespaces: 0 };
        let mut quote = None;
        for (i, &b) in bytes.iter().enumerate().skip(start) {
            match (quote, b) {
                (Some(q), _) if q == b => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(b),
                (None, b'=') => tag.attributes += 1,
                (None, b'x') if bytes[i..].starts_with(b"xmlns") => tag.namespaces += 1,
                (None, b'>') => {
                    tag.end = i + 1;
                    tag.closes_itself = bytes[i - 1] == b'/';
                    break;
                }
                _ => {}
            }
        }
        tag
    }
}

/// Where `needle` begins at or after `from`.
fn find(bytes: &[u8], from: usize, needle: &[u8]) -> Option<usize> {
    bytes.get(from..)?.windows(needle.len()).position(|w| w == needle).map(|i| from + i)
}

/// The byte after the next `needle`, or the end.
fn end_of(bytes: &[u8], from: usize, needle: &[u8]) -> usize {
    find(bytes, from, needle).map_or(bytes.len(), |i| i + needle.len())
}
