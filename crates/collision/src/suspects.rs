//! Exact answers about the few things that the kernel's spheres touch; see [`crate::Quick`].

use crate::between::{Exact, rows_clear};
use crate::directions::Directions;
use crate::lanes::{Suspect, Suspects};
use crate::moment::{Held, Moment};
use crate::obstacle::Obstacle;
use crate::query::{SELF_MARGIN, Scratch, Touch, held_near, held_near_link, link_near, links_near};
use crate::world::{Owner, World};
use clearway_geometry::{Pose, Vec3};
use clearway_plan::ObjectSet;
use clearway_robot::Sphere;

impl World {
    /// The obstacle of an owner; `None` for something that was not placed.
    fn obstacle<'a>(&'a self, moment: &'a Moment, owner: Owner) -> Option<&'a Obstacle> {
        match owner {
            Owner::Fixture(index) => self.fixtures.get(index),
            Owner::Standing(id) => self.objects.get(id.index()),
            Owner::Placed(index) => moment.placed.get(index).map(|(_, o)| &**o),
        }
    }

    /// Closer than this is touching, for a link and an obstacle.
    fn margin(&self, moment: &Moment, owner: Owner, hand: bool) -> f64 {
        let object = match owner {
            Owner::Fixture(_) => None,
            Owner::Standing(id) => Some(id),
            Owner::Placed(index) => moment.placed.get(index).map(|(id, _)| *id),
        };
        if hand && object.is_some() && moment.gripping == object { 0.0 } else { moment.margin }
    }

    /// [`World::touched`], for a posture that is known to touch nothing but the suspects of its
    /// lane, what is held aside.
    pub fn touched_among(
        &self,
        posture: &[f64],
        moment: &Moment,
        suspects: &Suspects,
        lane: usize,
        scratch: &mut Scratch,
    ) -> Touch {
        let of_lane = |s: &&Suspect| s.lanes >> lane & 1 == 1;
        if !suspects.any_in(lane) && moment.held.is_none() {
            return Touch::FREE;
        }
        scratch.checked += 1;
        self.place_links(posture, moment.hand, scratch);
        let mut touched = ObjectSet::EMPTY;
        if self.held_meets(moment, scratch, &mut touched) {
            return Touch::Fixed;
        }
        let Scratch { frames, centres, directions, .. } = scratch;
        for suspect in suspects.obstacles.iter().filter(of_lane) {
            let owner = self.owner(suspect.other);
            let (Some(link), Some(obstacle)) = (&self.model.links[suspect.link], self.obstacle(moment, owner)) else {
                continue;
            };
            if matches!(owner, Owner::Standing(id) if touched.contains(id)) {
                continue;
            }
            let margin = self.margin(moment, owner, link.hand);
            if suspect.sure >> lane & 1 == 1
                || link_near(link, &frames[suspect.link], centres[suspect.link], obstacle, margin, directions)
            {
                match owner {
                    Owner::Standing(id) => touched.insert(id),
                    Owner::Fixture(_) | Owner::Placed(_) => return Touch::Fixed,
                }
            }
        }
        let meets = |s: &Suspect| {
            let (a, b) = (s.link, s.other);
            let (Some(la), Some(lb)) = (&self.model.links[a], &self.model.links[b]) else { return false };
            s.sure >> lane & 1 == 1
                || links_near((la, &frames[a], centres[a]), (lb, &frames[b], centres[b]), SELF_MARGIN, directions)
        };
        if suspects.pairs.iter().filter(of_lane).any(meets) { Touch::Fixed } else { Touch::Objects(touched) }
    }

    /// Whether a posture is free that is known to touch nothing but the suspects of the first lane.
    pub fn free_among(&self, posture: &[f64], moment: &Moment, suspects: &Suspects, scratch: &mut Scratch) -> bool {
        if suspects.any_sure() {
            return false;
        }
        if suspects.is_empty() {
            return true;
        }
        scratch.checked += 1;
        let asked = At { world: self, moment };
        asked.place(posture, &mut scratch.frames);
        let Scratch { frames, directions, .. } = scratch;
        !asked.questions(suspects).any(|(question, _)| asked.near(&question, frames, 0.0, directions))
    }

    /// Whether up to sixteen rows, and the straight lines between them, are free of `suspects`, which
    /// were found for these rows. A stretch in which nothing moves farther than `step` (metres) is
    /// taken to be free where its ends are.
    pub fn rows_clear(
        &self,
        rows: &[Vec<f64>],
        moment: &Moment,
        suspects: &Suspects,
        step: f64,
        scratch: &mut Scratch,
    ) -> bool {
        if suspects.any_sure() {
            return false;
        }
        let asked = At { world: self, moment };
        let questions: Vec<(Question, u16)> = asked.questions(suspects).collect();
        rows_clear(&asked, &questions, rows, step, scratch)
    }
}

/// A suspicion, to be asked exactly. A body is a link's index, or [`crate::CollisionModel::held_index`].
#[derive(Clone, Copy)]
enum Question<'a> {
    Obstacle {
        body: usize,
        obstacle: &'a Obstacle,
        margin: f64,
    },
    /// What is held comes last.
    Pair {
        a: usize,
        b: usize,
    },
}

/// The world at a moment, with exact answers.
struct At<'a> {
    world: &'a World,
    moment: &'a Moment,
}

impl<'a> At<'a> {
    /// What suspects are suspected of, and in which lanes.
    fn questions(&self, suspects: &'a Suspects) -> impl Iterator<Item = (Question<'a>, u16)> {
        let (world, moment) = (self.world, self.moment);
        let obstacles = suspects.obstacles.iter().filter_map(move |s| {
            let owner = world.owner(s.other);
            let obstacle = world.obstacle(moment, owner)?;
            let margin = match world.model.links.get(s.link) {
                Some(Some(link)) => world.margin(moment, owner, link.hand),
                Some(None) => return None,
                None => match owner {
                    Owner::Fixture(index) => moment.held_margin_to_fixture(index),
                    Owner::Standing(id) => moment.held_margin_to_object(id),
                    Owner::Placed(_) => moment.held_margin,
                },
            };
            Some((Question::Obstacle { body: s.link, obstacle, margin }, s.lanes))
        });
        obstacles.chain(suspects.pairs.iter().map(|s| (Question::Pair { a: s.link, b: s.other }, s.lanes)))
    }
}

impl<'a> Exact for At<'a> {
    type Question = Question<'a>;

    fn place(&self, q: &[f64], frames: &mut Vec<Pose>) {
        self.world.model.kinematics.frames(q, self.moment.hand, frames);
    }

    fn near(&self, question: &Question, frames: &[Pose], more: f64, directions: &mut Directions) -> bool {
        let link = |index: usize| self.world.model.links.get(index).and_then(Option::as_ref);
        match *question {
            Question::Obstacle { body, obstacle, margin } => match (link(body), &self.moment.held) {
                (Some(link), _) => {
                    let frame = &frames[body];
                    link_near(link, frame, frame.point(link.bound.centre), obstacle, margin + more, directions)
                }
                (None, Some(held)) => {
                    let frame = self.frame(body, frames);
                    held.parts.iter().any(|part| held_near(part, &frame, obstacle, margin + more, directions))
                }
                (None, None) => false,
            },
            Question::Pair { a, b } => match (link(a), link(b), &self.moment.held) {
                (Some(la), Some(lb), _) => {
                    let (fa, fb) = (&frames[a], &frames[b]);
                    let (ca, cb) = (fa.point(la.bound.centre), fb.point(lb.bound.centre));
                    links_near((la, fa, ca), (lb, fb, cb), SELF_MARGIN + more, directions)
                }
                (Some(la), None, Some(held)) => {
                    let frame = self.frame(b, frames);
                    let margin = self.moment.held_margin + more;
                    held.parts.iter().any(|part| held_near_link(part, &frame, la, &frames[a], margin, directions))
                }
                _ => false,
            },
        }
    }

    fn bodies(&self, question: &Question) -> (usize, Option<usize>) {
        match *question {
            Question::Obstacle { body, .. } => (body, None),
            Question::Pair { a, b } => (a, Some(b)),
        }
    }

    fn frame(&self, body: usize, frames: &[Pose]) -> Pose {
        match (&self.moment.held, frames.get(body)) {
            (_, Some(frame)) => *frame,
            (Some(held), None) => frames[self.world.model.kinematics.tool] * held.tool_from_object,
            (None, None) => Pose::IDENTITY,
        }
    }

    fn bound(&self, body: usize) -> Sphere {
        let nothing = Sphere { centre: Vec3::ZERO, radius: 0.0 };
        match self.world.model.links.get(body) {
            Some(link) => link.as_ref().map_or(nothing, |l| l.bound),
            None => Sphere { radius: self.moment.held.as_ref().map_or(0.0, |held| held.radius()), ..nothing },
        }
    }

    fn swing(&self, body: usize, a: &[f64], b: &[f64]) -> f64 {
        let model = &self.world.model;
        let far = |held: &Held| held.tool_from_object.translation.length() + held.radius();
        let (reach, longer) = match model.link_reach.get(body) {
            Some(reach) => (reach, 0.0),
            None => (&model.tool_reach, self.moment.held.as_ref().map_or(0.0, far)),
        };
        let swing = |((a, b), r): ((&f64, &f64), &f64)| if *r > 0.0 { (a - b).abs() * (r + longer) } else { 0.0 };
        a.iter().zip(b).zip(reach).map(swing).sum()
    }
}
