//! Which shapes are watched in a segment: everything that moves against everything it should not touch.
//!
//! Not watched: unchecked pairs of links; the mounted root against fixtures; links of the hand
//! against the object that they grip, let go of or push ([`push`](crate::push) looks at those).

use crate::carry::Stage;
use crate::case::Case;
use crate::names::Names;
use crate::shapes::Piece;
use crate::sweep::{Motion, Mover, Other, Pair};
use parry3d_f64::math::Pose;
use std::collections::HashMap;

/// Whose shape it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Owner {
    Link(usize),
    Held(usize),
    Pushed(usize),
    Fixture(usize),
    Object(usize),
}

impl Owner {
    pub fn name(self, case: &Case) -> &str {
        match self {
            Owner::Link(i) => &case.model.links[i].name,
            Owner::Held(i) | Owner::Pushed(i) | Owner::Object(i) => &case.objects[i].id,
            Owner::Fixture(i) => &case.fixtures[i].id,
        }
    }

    /// A fixture, or an object that stands.
    pub fn stands(self) -> bool {
        matches!(self, Owner::Fixture(_) | Owner::Object(_))
    }

    /// In words.
    pub fn says(self, case: &Case) -> String {
        let what = match self {
            Owner::Link(_) => "link",
            Owner::Held(_) => "held",
            Owner::Pushed(_) => "pushed",
            Owner::Fixture(_) => "fixture",
            Owner::Object(_) => "object",
        };
        format!("{what} {}", self.name(case))
    }
}

/// The shapes of one segment, and the pairs of them to look at.
pub(crate) struct Watch<'a> {
    case: &'a Case,
    names: &'a Names,
    stage: &'a Stage,
    pub movers: Vec<Mover<'a>>,
    /// Of each mover.
    owners: Vec<Owner>,
    pub pairs: Vec<Pair<'a>>,
    /// What moves first, then what it may meet; several pairs of shapes may have the same.
    pub subjects: Vec<(Owner, Owner)>,
    index: HashMap<(Owner, Owner), usize>,
}

impl<'a> Watch<'a> {
    pub fn new(case: &'a Case, names: &'a Names, stage: &'a Stage) -> Self {
        let (movers, owners, pairs, subjects) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut watch = Self { case, names, stage, movers, owners, pairs, subjects, index: HashMap::new() };
        watch.fill();
        watch
    }

    fn fill(&mut self) {
        let (case, stage) = (self.case, self.stage);
        for (l, link) in case.model.links.iter().enumerate() {
            let motion = Motion::Link { link: l, link_from_owner: Pose::IDENTITY };
            self.moves(&link.pieces, motion, Owner::Link(l));
        }
        if let Some(held) = &stage.held {
            let motion = Motion::Link { link: held.tool, link_from_owner: held.tool_from_object };
            self.moves(&case.objects[held.object].pieces, motion, Owner::Held(held.object));
        }
        if let Some(pushed) = &stage.pushed {
            self.moves(&case.objects[pushed.object].pieces, Motion::Slide(&pushed.slide), Owner::Pushed(pushed.object));
        }
        let still: Vec<(Owner, &'a [Piece], Pose)> = case
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
                let subject = self.subject(owner, other);
                for piece in pieces {
                    self.pairs.push(Pair { first, second: Other::Still { piece, world_from_owner }, subject });
                }
            }
            for second in first + 1..self.movers.len() {
                let other = self.owners[second];
                if !self.may_touch(owner, other) {
                    let subject = self.subject(owner, other);
                    self.pairs.push(Pair { first, second: Other::Mover(second), subject });
                }
            }
        }
    }

    fn moves(&mut self, pieces: &'a [Piece], motion: Motion<'a>, owner: Owner) {
        self.movers.extend(pieces.iter().map(|piece| Mover { piece, motion }));
        self.owners.extend(pieces.iter().map(|_| owner));
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
            (Owner::Link(link), Owner::Held(object) | Owner::Pushed(object) | Owner::Object(object)) => {
                self.names.in_hand[link] && self.stage.gripping == Some(object)
            }
            (a, b) => a == b,
        }
    }
}
