//! The hand and what it pushes, row by row: it is at the object while that moves, and behind it; it is
//! never deep in it; and it is not so high up that the object tips rather than slides.

use super::round::Round;
use super::{MOVES, Push, ROUNDING, Slide, shifted};
use crate::case::Track;
use crate::report::Report;
use crate::rest::TOUCH;
use crate::shapes::{Piece, body_gap};
use crate::sweep::When;
use clearway_plan::plan_file::SegmentKind;
use parry3d_f64::math::Pose;

/// What is nearer pushes, metres.
const AT_IT: f64 = 1.5e-3;
/// The object moved back by this meets what pushes it, metres.
const BACK: f64 = 3e-3;
/// Deeper in the object no link of the hand may be, metres.
const DEEPEST: f64 = 1e-3;

/// Wherever the hand may touch the object, it is at most 1 mm deep in it: coming, pushing and leaving.
pub(super) fn depth(push: &Push, slides: &[Option<Slide>], report: &mut Report) {
    let object = &push.case.objects[push.object];
    let last = slides.iter().rposition(Option::is_some).unwrap_or(0);
    for (index, (track, slide)) in push.tracks.iter().zip(slides).enumerate() {
        if matches!(track.segment.kind, SegmentKind::Transit) {
            continue;
        }
        for row in 0..track.postures.len() {
            let stands = if index < last { push.from } else { push.to };
            let at = slide.as_ref().map_or(stands, |s| s.at(When { row, fraction: 0.0 }));
            let Some((link, distance)) = nearest(push, track, row, &object.pieces, &at, 0.0) else { continue };
            if distance < -DEEPEST - ROUNDING {
                let what = format!("link {link} is {:.1} mm inside {}, which it pushes", -distance * 1e3, object.id);
                push.fault(track.at(row), what, report);
                return;
            }
        }
    }
}

/// While the object moves, the hand is at it and behind it, and nowhere near it higher than `tips_at`
/// above its bottom.
pub(super) fn pushes(push: &Push, slides: &[Option<Slide>], round: &Round, tips_at: f64, report: &mut Report) {
    let object = &push.case.objects[push.object];
    let too_high = round.above(tips_at + TOUCH);
    let (mut away, mut tips) = (false, false);
    for (track, slide) in push.tracks.iter().zip(slides) {
        let Some(slide) = slide else { continue };
        for row in (1..track.postures.len()).filter(|r| slide.ways[*r] > slide.ways[r - 1] + MOVES) {
            let at = slide.at(When { row, fraction: 0.0 });
            if !away {
                let back = shifted(&at, slide.direction * -BACK);
                let behind = nearest(push, track, row, &object.pieces, &back, 0.0).is_some_and(|n| n.1 < 0.0);
                let at_it = touches(push, track, row, &object.pieces, &at);
                away = !at_it || !behind;
                if away {
                    let what = if at_it { "is not behind" } else { "is more than 1.5 mm from" };
                    push.fault(track.at(row), format!("the hand {what} {}, which it should push", object.id), report);
                }
            }
            let moved = Pose::from_translation(slide.direction * slide.ways[row]);
            if !tips && touches(push, track, row, &too_high, &moved) {
                tips = true;
                let what = format!(
                    "{} tips: it is pushed {:.1} mm above its bottom; it slides if that is below {:.1} mm",
                    object.id,
                    highest(push, track, row, round, &moved) * 1e3,
                    tips_at * 1e3
                );
                push.fault(track.at(row), what, report);
            }
        }
    }
}

/// How high above its bottom the object is pushed: nothing higher of it is near the hand.
fn highest(push: &Push, track: &Track, row: usize, round: &Round, moved: &Pose) -> f64 {
    let (mut low, mut high) = (0.0, round.top - round.bottom);
    while high - low > TOUCH {
        let middle = f64::midpoint(low, high);
        if touches(push, track, row, &round.above(middle), moved) {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

fn touches(push: &Push, track: &Track, row: usize, pieces: &[Piece], at: &Pose) -> bool {
    nearest(push, track, row, pieces, at, AT_IT + ROUNDING).is_some()
}

/// The link of the hand that is nearest to a body at a row, and how near it is; `None` beyond `reach`.
fn nearest<'a>(
    push: &Push<'a>,
    track: &Track,
    row: usize,
    pieces: &[Piece],
    at: &Pose,
    reach: f64,
) -> Option<(&'a str, f64)> {
    let poses = push.case.link_poses(&track.postures[row]);
    let links = push.case.model.links.iter().zip(&poses).zip(&push.names.in_hand);
    links
        .filter(|(_, in_hand)| **in_hand)
        .filter_map(|((link, pose), _)| {
            body_gap(&link.pieces, pose, pieces, at, reach).map(|gap| (link.name.as_str(), gap.distance))
        })
        .min_by(|a, b| a.1.total_cmp(&b.1))
}
