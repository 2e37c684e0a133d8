//! Nothing touches anything, continuously: what is watched (see [`watch`](crate::watch)), what is
//! forgiven, and how it is told.
//!
//! Forgiven: up to 1 mm between what is held and what carried it, or will carry it, within 5 mm of
//! where it stood or will stand; all along between what is pushed and what it slides on.

use crate::carry::Stage;
use crate::case::{Case, Track};
use crate::report::{Report, ViolationKind};
use crate::rest::{REST, TOUCH};
use crate::sweep;
use crate::sweep::touch::{Forgiven, Touch, Touches};
use crate::watch::{Owner, Watch};

/// Metres from where it stood within which overlap with a carrier is forgiven.
const NEAR_REST: f64 = 5e-3;

/// What a segment's sweep is to look for.
pub(crate) fn seek<'a, 'p>(case: &Case, stage: &Stage, watch: &'p Watch<'a>) -> Touches<'a, 'p> {
    let forgiven = watch.subjects.iter().map(|(first, second)| forgiven(case, stage, *first, *second));
    Touches::new(&watch.pairs, forgiven.collect())
}

/// What it found.
pub(crate) fn tell(case: &Case, track: &Track, watch: &Watch, touches: &[Touch], report: &mut Report) {
    for touch in touches {
        let (kind, what) = describe(case, watch.subjects[touch.subject], touch);
        report.at(kind, track.when(touch.when), what);
    }
}

fn forgiven(case: &Case, stage: &Stage, first: Owner, second: Owner) -> Option<Forgiven> {
    let name = second.name(case);
    let overlap = REST + TOUCH;
    match (first, &stage.held, &stage.pushed) {
        (Owner::Held(_), Some(held), _) if second.stands() => {
            let near: Vec<_> = [&held.lifted_from, &held.put_on]
                .into_iter()
                .filter(|(_, carriers)| carriers.iter().any(|c| c == name))
                .map(|(pose, _)| pose.translation)
                .collect();
            (!near.is_empty()).then_some(Forgiven { near, within: NEAR_REST, overlap })
        }
        (Owner::Pushed(_), _, Some(pushed)) if second.stands() => {
            let near = vec![pushed.slide.from.translation];
            pushed.carriers.iter().any(|c| c == name).then_some(Forgiven { near, within: f64::INFINITY, overlap })
        }
        _ => None,
    }
}

fn describe(case: &Case, (first, second): (Owner, Owner), touch: &Touch) -> (ViolationKind, String) {
    let kind = match (first, second) {
        (Owner::Link(_), Owner::Link(_)) => ViolationKind::SelfCollision,
        (Owner::Held(_), _) | (_, Owner::Held(_)) => ViolationKind::HeldCollision,
        (Owner::Pushed(_), _) | (_, Owner::Pushed(_)) => ViolationKind::PushedCollision,
        _ => ViolationKind::Collision,
    };
    let (a, b, at) = (first.says(case), second.says(case), sweep::point(touch.point));
    let what = if touch.enclosed {
        format!("{a} and {b}: one is inside the other's mesh, near {at}")
    } else {
        format!("{a} is {:.2} mm inside {b} at {at}", touch.depth * 1e3)
    };
    (kind, what)
}
