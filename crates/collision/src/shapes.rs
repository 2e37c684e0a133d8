//! Exact answers about a planning group's own shapes, where the spheres that cover them touch.

use crate::between::{Exact, rows_clear};
use crate::directions::Directions;
use crate::lanes::body::reach_of_link;
use crate::lanes::exact::Contact;
use crate::lanes::{Suspect, Suspects};
use crate::model::{LinkBody, TAGS_PER_LINK};
use crate::obstacle::Obstacle;
use crate::query::{Scratch, link_near, links_near};
use crate::world::moving_parts;
use clearway_geometry::{Convex, Pose, Vec3};
use clearway_robot::{Group, Sphere, bounding_sphere};

/// A group's links with their own shapes.
#[derive(Clone, Debug)]
pub struct Shapes {
    links: Vec<Option<LinkBody>>,
    /// By link, then joint: how far a unit of it moves any point of the link, at most.
    reach: Vec<Vec<f64>>,
}

/// What the shapes are asked among.
#[derive(Clone, Copy, Debug)]
pub struct Among<'a> {
    pub group: &'a Group,
    pub shapes: &'a Shapes,
    pub obstacles: &'a [Obstacle],
    /// Closer than this to an obstacle is touching, metres.
    pub margin: f64,
}

/// Nothing moves farther than this between two postures looked at, metres. All shapes are taken to be
/// larger by half of it, so that what is called free is free in between as well.
pub const STEP: f64 = 5e-4;

impl Shapes {
    /// `None` where all links are made of spheres: then the kernel's answers are exact.
    pub fn of(group: &Group, spheres: &[Vec<Sphere>]) -> Option<Shapes> {
        let all_spheres =
            |l: &clearway_robot::Link| l.collision.parts.iter().all(|(_, c)| matches!(c, Convex::Sphere { .. }));
        if group.links.iter().all(all_spheres) {
            return None;
        }
        let body = |(index, link): (usize, &clearway_robot::Link)| {
            (!spheres[index].is_empty()).then(|| LinkBody {
                parts: moving_parts(&link.collision, index * TAGS_PER_LINK),
                spheres: Vec::new(),
                bound: bounding_sphere(&spheres[index]),
                hand: false,
                still: false,
                turns: false,
            })
        };
        let links: Vec<Option<LinkBody>> = group.links.iter().enumerate().map(body).collect();
        let reach = (0..links.len()).map(|link| reach_of_link(group, link)).collect();
        Some(Shapes { links, reach })
    }
}

impl<'a> Among<'a> {
    /// What a posture touches first, exactly.
    pub fn contact(&self, q: &[f64], unchecked: &[(usize, usize)], scratch: &mut Scratch) -> Option<Contact> {
        self.place(q, &mut scratch.frames);
        let Scratch { frames, directions, .. } = scratch;
        let moves = |l: usize| !self.group.kinematics.is_still(l);
        let links = self.shapes.links.iter().enumerate().filter_map(|(i, l)| Some((i, l.as_ref()?)));
        for (number, obstacle) in self.obstacles.iter().enumerate() {
            for (index, link) in links.clone().filter(|(l, _)| moves(*l)) {
                let centre = frames[index].point(link.bound.centre);
                if link_near(link, &frames[index], centre, obstacle, self.margin, directions) {
                    return Some(Contact::Obstacle(index, number));
                }
            }
        }
        for (a, _) in links.clone() {
            for (b, _) in links.clone().filter(|(b, _)| *b > a && !unchecked.contains(&(a, *b))) {
                if self.links_near(a, b, frames, 0.0, directions) {
                    return Some(Contact::Links(a, b));
                }
            }
        }
        None
    }

    /// Whether up to sixteen rows, and the straight lines between them, are free of `suspects`, which
    /// were found for these rows.
    pub fn rows_clear(&self, rows: &[Vec<f64>], suspects: &Suspects, scratch: &mut Scratch) -> bool {
        if suspects.any_sure() {
            return false;
        }
        let obstacles = suspects.obstacles.iter().map(|s| (Asked::Obstacle(*s), s.lanes));
        let questions: Vec<(Asked, u16)> =
            obstacles.chain(suspects.pairs.iter().map(|s| (Asked::Pair(*s), s.lanes))).collect();
        rows_clear(self, &questions, rows, STEP, scratch)
    }

    fn links_near(&self, a: usize, b: usize, frames: &[Pose], margin: f64, directions: &mut Directions) -> bool {
        let (Some(la), Some(lb)) = (&self.shapes.links[a], &self.shapes.links[b]) else { return false };
        let (fa, fb) = (&frames[a], &frames[b]);
        links_near((la, fa, fa.point(la.bound.centre)), (lb, fb, fb.point(lb.bound.centre)), margin, directions)
    }
}

/// What spheres suspect.
#[derive(Clone, Copy)]
pub(crate) enum Asked {
    Obstacle(Suspect),
    Pair(Suspect),
}

impl Exact for Among<'_> {
    type Question = Asked;

    fn place(&self, q: &[f64], frames: &mut Vec<Pose>) {
        self.group.kinematics.frames(q, self.group.hand[0], frames);
    }

    fn near(&self, question: &Asked, frames: &[Pose], more: f64, directions: &mut Directions) -> bool {
        let more = more + STEP / 2.0;
        match question {
            Asked::Obstacle(s) => {
                let (Some(link), Some(obstacle)) = (&self.shapes.links[s.link], self.obstacles.get(s.other)) else {
                    return false;
                };
                let frame = &frames[s.link];
                link_near(link, frame, frame.point(link.bound.centre), obstacle, self.margin + more, directions)
            }
            Asked::Pair(s) => self.links_near(s.link, s.other, frames, more, directions),
        }
    }

    fn bodies(&self, question: &Asked) -> (usize, Option<usize>) {
        match question {
            Asked::Obstacle(s) => (s.link, None),
            Asked::Pair(s) => (s.link, Some(s.other)),
        }
    }

    fn frame(&self, body: usize, frames: &[Pose]) -> Pose {
        frames[body]
    }

    fn bound(&self, body: usize) -> Sphere {
        self.shapes.links[body].as_ref().map_or(Sphere { centre: Vec3::ZERO, radius: 0.0 }, |l| l.bound)
    }

    fn swing(&self, body: usize, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.shapes.reach[body]).map(|((a, b), r)| (a - b).abs() * r).sum()
    }
}
