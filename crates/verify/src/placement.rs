//! Where objects come to rest: upright, inside a place or on what carried them, overlapping nothing.

use crate::case::Case;
use crate::error::CannotJudge;
use crate::report::{Place, Report, ViolationKind};
use crate::rest::{self, REST, Standing};
use crate::shapes::{Piece, extent};
use crate::stability::Stability;
use clearway_plan::Budget;
use clearway_plan::scene_file::PlaceArea;
use parry3d_f64::math::{Pose, Vector};

/// The object's z axis is within this of the world's, radians.
const UPRIGHT: f64 = 0.01;
/// A footprint may reach this far over a place's edge, metres.
const OVER_EDGE: f64 = 1e-3;
const ROUNDING: f64 = 1e-6;

/// On what an object may come to rest.
pub(crate) enum Rest {
    /// In a `place`: the last rest of what is removed.
    InPlace,
    /// In a `place`, or on whatever carries it: what a goal of its own asks for.
    Anywhere,
    /// In a `place`, or on one of these, which carried it before: relocated or pushed.
    InPlaceOrOn(Vec<String>),
}

/// At the start, everything rests, none of it tips and nothing overlaps.
pub(crate) fn check_start(
    case: &Case,
    standing: &Standing,
    stability: &Stability,
    budget: &Budget,
    report: &mut Report,
) -> Result<(), CannotJudge> {
    for (i, object) in case.objects.iter().enumerate() {
        budget.check()?;
        let at = object.pose;
        if !stability.is_carried(i) {
            report
                .plan(ViolationKind::Unsupported, format!("at the start nothing is under {}, within 1 mm", object.id));
        }
        for (other, gap) in rest::overlaps(case, standing, i, &at) {
            // Each pair of objects once.
            if case.object(other).is_none_or(|j| i < j) {
                report.plan(ViolationKind::Overlap, overlap(&object.id, other, gap.distance, gap.point));
            }
        }
    }
    stability.check_start(report);
    Ok(())
}

/// `placed` of a step whose object now is at `at`; everything else stands as `standing` says.
pub(crate) fn check_placed(
    case: &Case,
    standing: &Standing,
    object: usize,
    at: &Pose,
    rest: &Rest,
    place: Place,
    report: &mut Report,
) {
    let thing = &case.objects[object];
    let tilt = (at.rotation * Vector::Z).angle_between(Vector::Z);
    if tilt > UPRIGHT {
        report.at(ViolationKind::Tilted, place, format!("{} is put down {tilt:.3} rad from upright", thing.id));
    }
    for (other, gap) in rest::overlaps(case, standing, object, at) {
        report.at(ViolationKind::Overlap, place, overlap(&thing.id, other, gap.distance, gap.point));
    }
    let carried_as_before = match rest {
        Rest::InPlace => false,
        Rest::Anywhere => !rest::carriers(case, standing, object, at).is_empty(),
        Rest::InPlaceOrOn(before) => {
            rest::carriers(case, standing, object, at).iter().any(|c| before.iter().any(|b| b == c))
        }
    };
    if carried_as_before || place_under(case, &thing.pieces, at, REST).is_some() {
        return;
    }
    let (low, high) = extent(&thing.pieces, at);
    let footprint = format!(
        "its footprint is [{:.4}, {:.4}] to [{:.4}, {:.4}], its bottom at z = {:.4} m",
        low.x, low.y, high.x, high.y, low.z
    );
    let inside = case.places.iter().find(|p| over_edge(p, low, high) <= OVER_EDGE + ROUNDING);
    if let Some(area) = inside {
        let what =
            format!("{} is placed {:.1} mm above {}; {footprint}", thing.id, (low.z - area.position[2]) * 1e3, area.id);
        report.at(ViolationKind::Unsupported, place, what);
    } else {
        let least = case.places.iter().map(|p| over_edge(p, low, high)).fold(f64::INFINITY, f64::min);
        let what =
            format!("{} is placed outside every place, by {:.1} mm at least; {footprint}", thing.id, least * 1e3);
        report.at(ViolationKind::OffPlace, place, what);
    }
}

/// The place whose top face is within `height` of the body's bottom, and inside whose edges it is.
pub(crate) fn place_under<'a>(case: &'a Case, pieces: &[Piece], at: &Pose, height: f64) -> Option<&'a PlaceArea> {
    let (low, high) = extent(pieces, at);
    case.places
        .iter()
        .find(|p| (low.z - p.position[2]).abs() <= height + ROUNDING && over_edge(p, low, high) <= OVER_EDGE + ROUNDING)
}

/// How far a footprint reaches over a place's edges; negative inside.
fn over_edge(place: &PlaceArea, low: Vector, high: Vector) -> f64 {
    let [x, y, _] = place.position;
    let [half_x, half_y] = place.size.map(|s| s / 2.0);
    [x - half_x - low.x, high.x - x - half_x, y - half_y - low.y, high.y - y - half_y]
        .into_iter()
        .fold(f64::NEG_INFINITY, f64::max)
}

fn overlap(a: &str, b: &str, distance: f64, point: Vector) -> String {
    format!("{a} overlaps {b} by {:.2} mm at {}", -distance * 1e3, crate::sweep::point(point))
}
