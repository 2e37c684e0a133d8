//! Nothing touches anything: which shapes are watched in a segment, and what is forgiven.
//!
//! Not watched: unchecked pairs of links; the mounted root against fixtures; links of the hand
//! against the object that they grip, let go of or push. Forgiven: up to 1 mm between what is held
//! and what carried it, or will carry it, within 5 mm of where it stood or will stand.

use crate::carry::{Held, Stage};
use crate::case::{Case, Track};
use crate::error::CannotJudge;
use crate::names::Names;
use crate::report::{Report, ViolationKind};
use crate::rest::{REST, TOUCH};
use crate::sweep::{self, Forgiven, Mover, Other, Pair, Sweep, Touch};
use clearway_plan::Budget;
use parry3d_f64::math::Pose;
use std::collections::HashMap;

/// Metres from where it stood within which overlap with a carrier is forgiven.
const NEAR_REST: f64 = 5e-3;

/// Whose shape it is.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Owner {
    Link(usize),
    Held(usize),
    Fixture(usize),
    Object(usize),
}

pub(crate) fn check(
    case: &Case,
    names: &Names,
    track: &Track,
    stage: &Stage,
    budget: &Budget,
    report: &mut Report,
) -> Result<(), CannotJudge> {
    let mut watch = Watch {
        case,
        names,
        stage,
        movers: Vec::new(),
        owners: Vec::new(),
        pairs: Vec::new(),
        subjects: Vec::new(),
        index: HashMap::new(),
    };
    watch.fill();
    let Watch { movers, pairs, subjects, .. } = watch;
    let mut sweep = Sweep::new(case, track, &movers);
    let touches = sweep.run(&pairs, budget)?;
    report.checked.pairs += pairs.len();
    report.checked.distances += sweep.distances;
    for touch in touches {
        let (kind, what) = describe(case, subjects[touch.subject], &touch);
        let times = &track.segment.times;
        let mut place = track.at(touch.row);
        if let (Some(from), Some(to)) = (times.get(touch.row), times.get(touch.row + 1)) {
            place.time += touch.fraction * (to - from);
        }
        report.at(kind, place, what);
    }
    Ok(())
}

struct Watch<'a> {
    case: &'a Case,
    names: &'a Names,
    stage: &'a Stage,
    movers: Vec<Mover<'a>>,
    /// Of each mover.
    owners: Vec<Owner>,
    pairs: Vec<Pair<'a>>,
    subjects: Vec<(Owner, Owner)>,
    index: HashMap<(Owner, Owner), usize>,
}

impl<'a> Watch<'a> {
    fn fill(&mut self) {
        let (case, stage) = (self.case, self.stage);
        for (l, link) in case.model.links.iter().enumerate() {
            for piece in &link.pieces {
                self.movers.push(Mover { piece, link: l, link_from_owner: Pose::IDENTITY });
                self.owners.push(Owner::Link(l));
            }
        }
        if let Some(held) = &stage.held {
            for piece in &case.objects[held.object].pieces {
                self.movers.push(Mover { piece, link: held.tool, link_from_owner: held.tool_from_object });
                self.owners.push(Owner::Held(held.object));
            }
        }
        let still: Vec<(Owner, &'a [crate::shapes::Piece], Pose)> = case
            .fixtures
            .iter()
            .enumerate()
            .map(|(i, f)| (Owner::Fixture(i), &f.pieces[..], f.pose))
            .chain(
                case.objects
                    .iter()
                    .zip(&stage.standing)
                    .enumerate()
                    .filter_map(|(i, (o, pose))| Some((Owner::Object(i), &o.pieces[..], (*pose)?))),
            )
            .collect();
        for first in 0..self.movers.len() {
            let owner = self.owners[first];
            for &(other, pieces, world_from_owner) in &still {
                if self.may_touch(owner, other) {
                    continue;
                }
                let forgiven = stage
                    .held
                    .as_ref()
                    .filter(|_| matches!(owner, Owner::Held(_)))
                    .and_then(|held| self.forgiven(held, other));
                let subject = self.subject(owner, other);
                for piece in pieces {
                    self.pairs.push(Pair {
                        first,
                        second: Other::Still { piece, world_from_owner },
                        subject,
                        forgiven: forgiven.clone(),
                    });
                }
            }
            for second in first + 1..self.movers.len() {
                let other = self.owners[second];
                if !self.may_touch(owner, other) {
                    let subject = self.subject(owner, other);
                    self.pairs.push(Pair { first, second: Other::Mover(second), subject, forgiven: None });
                }
            }
        }
    }

    fn subject(&mut self, first: Owner, second: Owner) -> usize {
        let next = self.subjects.len();
        let subject = *self.index.entry((first, second)).or_insert(next);
        if subject == next {
            self.subjects.push((first, second));
        }
        subject
    }

    fn may_touch(&self, first: Owner, second: Owner) -> bool {
        match (first, second) {
            (Owner::Link(a), Owner::Link(b)) => a == b || self.names.unchecked.contains(&(a.min(b), a.max(b))),
            (Owner::Link(link), Owner::Fixture(_)) => self.case.model.mounted(link),
            (Owner::Link(link), Owner::Held(object) | Owner::Object(object)) => {
                self.names.in_hand[link] && self.stage.gripping == Some(object)
            }
            (a, b) => a == b,
        }
    }

    fn forgiven(&self, held: &Held, other: Owner) -> Option<Forgiven> {
        let name = name(self.case, other);
        let near: Vec<_> = [&held.lifted_from, &held.put_on]
            .into_iter()
            .filter(|(_, carriers)| carriers.iter().any(|c| c == name))
            .map(|(pose, _)| pose.translation)
            .collect();
        (!near.is_empty()).then_some(Forgiven { near, within: NEAR_REST, overlap: REST + TOUCH })
    }
}

fn name(case: &Case, owner: Owner) -> &str {
    match owner {
        Owner::Link(i) => &case.model.links[i].name,
        Owner::Held(i) | Owner::Object(i) => &case.objects[i].id,
        Owner::Fixture(i) => &case.fixtures[i].id,
    }
}

fn describe(case: &Case, (first, second): (Owner, Owner), touch: &Touch) -> (ViolationKind, String) {
    let says = |owner: Owner| match owner {
        Owner::Link(_) => format!("link {}", name(case, owner)),
        Owner::Held(_) => format!("held {}", name(case, owner)),
        Owner::Fixture(_) => format!("fixture {}", name(case, owner)),
        Owner::Object(_) => format!("object {}", name(case, owner)),
    };
    let kind = match (first, second) {
        (Owner::Link(_), Owner::Link(_)) => ViolationKind::SelfCollision,
        (Owner::Held(_), _) | (_, Owner::Held(_)) => ViolationKind::HeldCollision,
        _ => ViolationKind::Collision,
    };
    let (a, b, at) = (says(first), says(second), sweep::point(touch.point));
    let what = if touch.enclosed {
        format!("{a} and {b}: one is inside the other's mesh, near {at}")
    } else {
        format!("{a} is {:.2} mm inside {b} at {at}", touch.depth * 1e3)
    };
    (kind, what)
}
