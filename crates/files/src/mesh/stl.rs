//! STL. Binary if the size says so, whatever the header's first word is; else ASCII.

use super::Soup;
use crate::error::{FileError, quoted};
use std::path::Path;

const HEADER: usize = 80;
const START: usize = HEADER + 4;
const TRIANGLE: usize = 50;

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Soup, FileError> {
    let claimed = bytes.get(HEADER..START).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let body = bytes.get(START..).unwrap_or_default();
    let says_solid = bytes.trim_ascii_start().starts_with(b"solid");
    match claimed {
        // Exporters of binary files write `solid` too; the size tells them apart.
        Some(count) if (count as usize).checked_mul(TRIANGLE) == Some(body.len()) => Ok(binary(body)),
        _ if says_solid => ascii(path, bytes),
        // Some exporters leave bytes behind the last triangle.
        Some(count) if (count as usize) <= body.len() / TRIANGLE => Ok(binary(&body[..count as usize * TRIANGLE])),
        Some(count) => Err(FileError::new(
            path,
            format!("a binary STL that claims {count} triangles and holds {}", body.len() / TRIANGLE),
        )
        .help("the file is cut off, or is no STL: fetch or export it again")),
        None => Err(FileError::new(path, format!("only {} bytes", bytes.len()))
            .expected("an STL file")
            .help("the file is cut off, or is no STL: fetch or export it again")),
    }
}

/// `body` is whole triangles: normal, three corners, two bytes of attributes.
fn binary(body: &[u8]) -> Soup {
    let mut soup = Soup::default();
    for triangle in body.chunks_exact(TRIANGLE) {
        let mut numbers = triangle.as_chunks::<4>().0.iter().map(|b| f64::from(f32::from_le_bytes(*b))).skip(3);
        let mut corner = || std::array::from_fn(|_| numbers.next().unwrap_or(f64::NAN));
        soup.push_triangle([corner(), corner(), corner()]);
    }
    soup
}

/// Only the `vertex` lines matter, three to a `facet`; the other words must be in place.
fn ascii(path: &Path, bytes: &[u8]) -> Result<Soup, FileError> {
    let mut soup = Soup::default();
    let mut corners: Vec<[f64; 3]> = Vec::with_capacity(3);
    let mut ended = false;
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let wrong = |found: String| FileError::new(path, found).at(i + 1, 1);
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("vertex") => {
                let mut corner = [0.0; 3];
                for x in &mut corner {
                    let word = words.next().unwrap_or_default();
                    *x = word.parse().map_err(|_| {
                        wrong(format!("found {}", quoted(word))).expected("three numbers after `vertex`")
                    })?;
                }
                if corners.len() == 3 {
                    return Err(wrong("a facet with more than three corners".to_owned()));
                }
                corners.push(corner);
            }
            Some("endfacet") => match corners[..] {
                [a, b, c] => {
                    soup.push_triangle([a, b, c]);
                    corners.clear();
                }
                _ => return Err(wrong(format!("a facet with {} corners", corners.len())).expected("three")),
            },
            Some("endsolid") => ended = true,
            // Names and remarks after `solid` may hold anything.
            None | Some("solid" | "facet" | "outer" | "endloop") => {}
            Some(other) => {
                return Err(wrong(format!("found {}", quoted(other)))
                    .expected("a line of ASCII STL")
                    .help("the file is cut off, or is no STL: fetch or export it again"));
            }
        }
    }
    if !ended || !corners.is_empty() {
        return Err(FileError::new(path, "an ASCII STL that ends before its `endsolid`")
            .help("the file is cut off: fetch or export it again"));
    }
    Ok(soup)
}
