//! Attributes of XML elements as names and numbers, with errors that point at them.

use clearway_files::{FileError, quoted, xml};
use roxmltree::Node;
use std::path::Path;

/// Beyond this no metre or radian is meant, and products of them would overflow.
const LARGEST: f64 = 1e18;

/// The document that is read, by the name used in messages.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    pub path: &'a Path,
}

impl<'a> Source<'a> {
    /// An error that points at an element.
    pub fn wrong(&self, node: Node, found: impl Into<String>) -> FileError {
        FileError::new(self.path, found).at_position(Some(xml::position(node)))
    }

    /// An error that points at an attribute, or at the element if it lacks it.
    pub fn wrong_attribute(&self, node: Node, name: &str, found: impl Into<String>) -> FileError {
        let place = node.attribute_node(name).map(|a| node.document().text_pos_at(a.range().start));
        match place {
            Some(at) => FileError::new(self.path, found).at(at.row as usize, at.col as usize),
            None => self.wrong(node, found),
        }
    }

    /// An attribute that must be there and not be empty.
    pub fn name(&self, node: Node<'a, 'a>, attribute: &str) -> Result<&'a str, FileError> {
        match node.attribute(attribute).map(str::trim) {
            Some("") => {
                Err(self.wrong_attribute(node, attribute, format!("`{attribute}` is empty")).expected("a name"))
            }
            Some(name) => Ok(name),
            None => Err(self
                .wrong(node, format!("<{}> without `{attribute}`", node.tag_name().name()))
                .help(format!("add `{attribute}=\"…\"`"))),
        }
    }

    /// A finite number, or none if the attribute is not there.
    pub fn number(&self, node: Node, attribute: &str) -> Result<Option<f64>, FileError> {
        Ok(self.numbers::<1>(node, attribute)?.map(|[x]| x))
    }

    /// `N` finite numbers between spaces, or none if the attribute is not there.
    pub fn numbers<const N: usize>(&self, node: Node, attribute: &str) -> Result<Option<[f64; N]>, FileError> {
        let Some(text) = node.attribute(attribute) else { return Ok(None) };
        let expected = if N == 1 {
            "a finite number, at most 1e18".to_owned()
        } else {
            format!("{N} finite numbers, at most 1e18")
        };
        let wrong = || {
            self.wrong_attribute(node, attribute, format!("`{attribute}` is {}", quoted(text)))
                .expected(expected.as_str())
        };
        let mut numbers = [0.0; N];
        let mut words = text.split_ascii_whitespace();
        for number in &mut numbers {
            *number =
                words.next().and_then(|w| w.parse().ok()).filter(|x: &f64| x.abs() <= LARGEST).ok_or_else(wrong)?;
        }
        if words.next().is_some() { Err(wrong()) } else { Ok(Some(numbers)) }
    }

    /// Numbers that must be there and be greater than 0.
    pub fn sizes<const N: usize>(&self, node: Node, attribute: &str) -> Result<[f64; N], FileError> {
        match self.numbers::<N>(node, attribute)? {
            Some(sizes) if sizes.iter().all(|&x| x > 0.0) => Ok(sizes),
            Some(sizes) => {
                let shown: Vec<String> = sizes.iter().map(f64::to_string).collect();
                Err(self
                    .wrong_attribute(
                        node,
                        attribute,
                        format!("`{attribute}` of <{}> is {}", node.tag_name().name(), shown.join(" ")),
                    )
                    .expected("sizes greater than 0, in metres")
                    .help("give the shape its true size, or delete its <collision> if it has none"))
            }
            None => Err(self
                .wrong(node, format!("<{}> without `{attribute}`", node.tag_name().name()))
                .help(format!("add `{attribute}=\"…\"`, in metres"))),
        }
    }
}

/// The first child element of this name, whatever its namespace.
pub fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    children(node, name).next()
}

/// All child elements of this name.
pub fn children<'a, 'n>(node: Node<'a, 'a>, name: &'n str) -> impl Iterator<Item = Node<'a, 'a>> + use<'a, 'n> {
    node.children().filter(move |n| n.is_element() && n.tag_name().name() == name)
}
