//! Point clouds: text lines of `x y z` (`.xyz`, `.txt`, `.csv`), and ASCII PLY.
//!
//! Metres. Numbers are parted by spaces, tabs, commas or semicolons; what follows the third is
//! passed over (colours, normals), and so is what follows `#`.

use crate::error::{FileError, quoted};
use crate::read::{Limits, read_text};
use std::path::Path;

/// Points in one file.
pub const MAX_POINTS: usize = 1_000_000;

/// The points of the file, of which there is at least one, all finite.
pub fn load(path: &Path) -> Result<Vec<[f64; 3]>, FileError> {
    load_with_sha256(path).map(|(points, _)| points)
}

/// The same, with the sha256 of the file's bytes in lower-case hexadecimal.
pub fn load_with_sha256(path: &Path) -> Result<(Vec<[f64; 3]>, String), FileError> {
    let text = read_text(path, &Limits::MESH)?;
    Ok((from_str(path, &text)?, crate::read::sha256(text.as_bytes())))
}

/// The points of `text`, of which `path` is the name for messages.
pub fn from_str(path: &Path, text: &str) -> Result<Vec<[f64; 3]>, FileError> {
    let points =
        if text.lines().next().is_some_and(|l| l.trim() == "ply") { ply(path, text)? } else { plain(path, text)? };
    if points.is_empty() { Err(FileError::new(path, "a point cloud without points")) } else { Ok(points) }
}

fn plain(path: &Path, text: &str) -> Result<Vec<[f64; 3]>, FileError> {
    let mut points = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or_default();
        if !line.trim().is_empty() {
            push(path, &mut points, i + 1, line, [0, 1, 2])?;
        }
    }
    Ok(points)
}

fn ply(path: &Path, text: &str) -> Result<Vec<[f64; 3]>, FileError> {
    let wrong = |line: usize, found: String| FileError::new(path, found).at(line, 1);
    let mut lines = text.lines().enumerate().map(|(i, line)| (i + 1, line)).skip(1);
    let mut ascii = false;
    // Elements before the vertices take a line each, too.
    let mut lines_before = 0_usize;
    let mut vertices: Option<usize> = None;
    let mut in_vertex = false;
    let mut columns: Vec<&str> = Vec::new();
    loop {
        let Some((number, line)) = lines.next() else {
            return Err(
                FileError::new(path, "a PLY header without `end_header`").help("the file is cut off: fetch it again")
            );
        };
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            ["end_header"] => break,
            ["format", "ascii", ..] => ascii = true,
            ["format", other, ..] => {
                return Err(wrong(number, format!("a PLY of format {}", quoted(other)))
                    .expected("`ascii`")
                    .help("save the cloud as ASCII PLY or as `x y z` lines"));
            }
            ["element", name, count] => {
                let count: usize =
                    count.parse().map_err(|_| wrong(number, format!("found {}", quoted(count))).expected("a count"))?;
                in_vertex = name == "vertex";
                if in_vertex {
                    vertices = Some(count);
                } else if vertices.is_none() {
                    lines_before = lines_before.saturating_add(count);
                }
            }
            ["property", "list", ..] if in_vertex => {
                return Err(wrong(number, "a list among the properties of a vertex".to_owned()));
            }
            ["property", _, name] if in_vertex => columns.push(name),
            _ => {}
        }
    }
    let column = |name: &str| columns.iter().position(|c| *c == name);
    let (Some(x), Some(y), Some(z), Some(count), true) = (column("x"), column("y"), column("z"), vertices, ascii)
    else {
        return Err(FileError::new(path, "a PLY header without a format or without vertices that have x, y and z"));
    };
    let mut points = Vec::new();
    let mut last = 0;
    for (number, line) in lines.skip(lines_before).take(count) {
        push(path, &mut points, number, line, [x, y, z])?;
        last = number;
    }
    if points.len() < count {
        return Err(wrong(last.max(1), format!("{} points where the header says {count}", points.len()))
            .help("the file is cut off: fetch it again"));
    }
    Ok(points)
}

/// Takes the numbers in `columns` of a line.
fn push(
    path: &Path,
    points: &mut Vec<[f64; 3]>,
    number: usize,
    line: &str,
    columns: [usize; 3],
) -> Result<(), FileError> {
    let words: Vec<&str> = line.split([' ', '\t', ',', ';']).filter(|w| !w.is_empty()).collect();
    let mut point = [0.0; 3];
    for (x, column) in point.iter_mut().zip(columns) {
        let word = words.get(column).copied().unwrap_or_default();
        *x = word.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
            FileError::new(path, format!("found {}", quoted(line.trim())))
                .at(number, 1)
                .expected("three finite numbers: x y z, in metres")
        })?;
    }
    if points.len() == MAX_POINTS {
        return Err(FileError::new(path, format!("more than {MAX_POINTS} points"))
            .at(number, 1)
            .help("thin the cloud out, for example to one point per centimetre"));
    }
    points.push(point);
    Ok(())
}
