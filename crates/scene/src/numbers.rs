//! Numbers that mean lengths and angles.

use crate::source::Source;
use clearway_files::FileError;

/// Metres from the world's origin.
const FARTHEST: f64 = 10_000.0;
/// Metres that something can measure, from a micrometre.
const LARGEST: f64 = 1_000.0;
const SMALLEST: f64 = 1e-6;
/// Radians: two turns, which angles in degrees soon exceed.
const WIDEST: f64 = 4.0 * std::f64::consts::PI;

/// The length, radius or height at `keys`, which has to be a size that things have.
pub(crate) fn size(source: &Source, keys: &str, what: &str, value: f64) -> Result<f64, FileError> {
    if (SMALLEST..=LARGEST).contains(&value) {
        return Ok(value);
    }
    let error = source.error(keys, format!("{what} is {}", shown(value)));
    Err(if value.is_finite() && value > LARGEST {
        error.expected("at most 1000 m").help("lengths are in metres")
    } else {
        error.expected("a positive, finite number of metres")
    })
}

/// The coordinates at `keys`, metres.
pub(crate) fn coordinates<const N: usize>(
    source: &Source,
    keys: &str,
    what: &str,
    values: [f64; N],
) -> Result<(), FileError> {
    for (i, value) in values.iter().enumerate() {
        if !(-FARTHEST..=FARTHEST).contains(value) {
            let error = source.error(&format!("{keys}.{i}"), format!("{what} holds {}", shown(*value)));
            return Err(if value.is_finite() {
                error.expected("coordinates within 10 km of the origin").help("lengths are in metres")
            } else {
                error.expected("finite numbers of metres")
            });
        }
    }
    Ok(())
}

/// The angles at `keys`, radians.
pub(crate) fn angles(source: &Source, keys: &str, what: &str, values: &[f64]) -> Result<(), FileError> {
    finite(source, keys, what, values)?;
    match values.iter().position(|v| v.abs() > WIDEST) {
        None => Ok(()),
        Some(i) => Err(source
            .error(&format!("{keys}.{i}"), format!("{what} holds {}", shown(values[i])))
            .expected("radians, two turns at most")
            .help("90° are 1.5708")),
    }
}

/// As a person would write it: not three hundred digits.
pub(crate) fn shown(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-4..1e7).contains(&value.abs());
    if plain { format!("{value}") } else { format!("{value:e}") }
}

/// The numbers at `keys`, which only have to be finite.
pub(crate) fn finite(source: &Source, keys: &str, what: &str, values: &[f64]) -> Result<(), FileError> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(i) => {
            Err(source.error(&format!("{keys}.{i}"), format!("{what} holds {}", values[i])).expected("finite numbers"))
        }
    }
}
