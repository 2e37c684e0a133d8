//! Wavefront OBJ: corners and faces. Polygons are cut into fans; everything else is passed over.

use super::{MAX_TRIANGLES, Soup, too_many_triangles};
use crate::error::{FileError, quoted};
use std::path::Path;

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Soup, FileError> {
    let mut soup = Soup::default();
    let mut face: Vec<u32> = Vec::new();
    let mut known_words = false;
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        // Names of materials may be in any encoding; they are not used.
        let line = String::from_utf8_lossy(line);
        let wrong = |found: String| FileError::new(path, found).at(i + 1, 1);
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let mut vertex = [0.0; 3];
                for x in &mut vertex {
                    let word = words.next().unwrap_or_default();
                    *x = word
                        .parse()
                        .map_err(|_| wrong(format!("found {}", quoted(word))).expected("three numbers after `v`"))?;
                }
                soup.vertices.push(vertex);
            }
            Some("f") => {
                face.clear();
                for word in words.take_while(|w| !w.starts_with('#')) {
                    // `corner/texture/normal`: only the first matters.
                    let index = word.split('/').next().unwrap_or_default();
                    face.push(corner(index, soup.vertices.len()).ok_or_else(|| {
                        wrong(format!("a face names corner {} of {}", quoted(index), soup.vertices.len()))
                            .expected("a corner defined above it, counted from 1, or from -1 backwards")
                    })?);
                }
                let [first, rest @ ..] = &face[..] else {
                    return Err(wrong("a face without corners".to_owned()));
                };
                if rest.len() < 2 {
                    return Err(wrong(format!("a face of {} corners", face.len())).expected("three or more"));
                }
                if soup.triangles.len() + rest.len() > MAX_TRIANGLES {
                    return Err(too_many_triangles(path));
                }
                soup.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
            }
            Some("vn" | "vt" | "g" | "o" | "usemtl" | "mtllib" | "s") => known_words = true,
            _ => {}
        }
    }
    if soup.vertices.is_empty() && !known_words {
        return Err(FileError::new(path, "no corners (`v x y z`)")
            .expected("a Wavefront OBJ file")
            .help("is this the right file?"));
    }
    Ok(soup)
}

/// From OBJ's index, which counts from 1, or from -1 backwards.
fn corner(index: &str, count: usize) -> Option<u32> {
    let index: i64 = index.parse().ok()?;
    let zero_based = if index > 0 { index - 1 } else { i64::try_from(count).ok()?.checked_add(index)? };
    let in_range = index != 0 && (0..i64::try_from(count).ok()?).contains(&zero_based);
    if in_range { u32::try_from(zero_based).ok() } else { None }
}
