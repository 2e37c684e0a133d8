//! No object reaches into another, or into a fixture, by more than noise.

use crate::contact::{Overlap, Placed, overlap};
use crate::source::Source;
use crate::support::Resting;
use crate::{FORGIVEN, Fixture};
use clearway_files::{FileError, quoted};

pub(crate) fn check(
    source: &Source,
    objects: &[Resting],
    placed: &[Placed],
    fixtures: &[Fixture],
    placed_fixtures: &[Placed],
) -> Result<(), FileError> {
    for (i, (object, a)) in objects.iter().zip(placed).enumerate() {
        for (fixture, b) in fixtures.iter().zip(placed_fixtures) {
            if let Some(found) = overlap(a, b, FORGIVEN) {
                return Err(tell(source, i, object, "fixture", &fixture.id, found));
            }
        }
        for (other, b) in objects.iter().zip(placed).take(i) {
            if let Some(found) = overlap(a, b, FORGIVEN) {
                return Err(tell(source, i, object, "object", &other.id, found));
            }
        }
    }
    Ok(())
}

fn tell(source: &Source, i: usize, object: &Resting, kind: &str, other: &str, found: Overlap) -> FileError {
    let keys = format!("objects.{i}.position");
    let (depth, other) = (1000.0 * found.depth, quoted(other));
    let way_out = object.pose.translation + found.depth * found.direction;
    let id = quoted(&object.id);
    if found.direction.z > 0.999 {
        source
            .error(&keys, format!("object {id} is sunk {depth:.1} mm into the {kind} {other}"))
            .expected("at most 1 mm, which is taken for noise")
            .help(format!("`position` is the shape's centre: at z = {:.4} it would rest", way_out.z))
    } else {
        source
            .error(&keys, format!("object {id} overlaps the {kind} {other} by {depth:.1} mm"))
            .expected("at most 1 mm, which is taken for noise")
            .help(format!("at [{:.4}, {:.4}, {:.4}] it would be clear", way_out.x, way_out.y, way_out.z))
    }
}
