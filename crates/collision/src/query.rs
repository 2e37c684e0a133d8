//! What does a posture touch? All of it, as a set.

use crate::directions::Directions;
use crate::model::LinkBody;
use crate::moment::Moment;
use crate::obstacle::{MovingPart, Obstacle};
use crate::world::World;
use clearway_geometry::{Pose, Vec3};
use clearway_plan::ObjectSet;
use clearway_robot::Sphere;

/// What a posture touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touch {
    /// The robot itself, a fixture, or something put down: nothing that could be cleared away.
    Fixed,
    /// These standing objects; none means that the posture is free.
    Objects(ObjectSet),
}

impl Touch {
    pub const FREE: Touch = Touch::Objects(ObjectSet::EMPTY);
}

/// Room for one query; reuse it to allocate nothing.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    pub(crate) frames: Vec<Pose>,
    /// By link: the middle of its bounding sphere.
    pub(crate) centres: Vec<Vec3>,
    pub(crate) directions: Directions,
    /// How many postures were checked with it.
    pub checked: u64,
}

/// Where the links are at one posture, for many questions about it.
#[derive(Clone, Debug)]
pub struct LinksAt {
    frames: Vec<Pose>,
    centres: Vec<Vec3>,
}

/// Links may come this close to each other, metres.
pub(crate) const SELF_MARGIN: f64 = 0.002;

impl World {
    /// Everything movable that the posture touches, or that it touches something fixed.
    pub fn touched(&self, posture: &[f64], moment: &Moment, scratch: &mut Scratch) -> Touch {
        self.touched_by(|_| true, posture, moment, scratch)
    }

    /// What those links touch that the hand's own joint moves, and what is held: enough where no other joint moved.
    pub fn touched_by_hand(&self, posture: &[f64], moment: &Moment, scratch: &mut Scratch) -> Touch {
        self.touched_by(|link| link.turns, posture, moment, scratch)
    }

    fn touched_by(
        &self,
        counts: impl Fn(&LinkBody) -> bool + Copy,
        posture: &[f64],
        moment: &Moment,
        scratch: &mut Scratch,
    ) -> Touch {
        scratch.checked += 1;
        self.place_links(posture, moment.hand, scratch);
        let Scratch { frames, centres, directions, .. } = scratch;
        let (frames, centres): (&[Pose], &[Vec3]) = (frames, centres);
        let margin = moment.margin;
        let mut touched = ObjectSet::EMPTY;
        let moving = || self.moving(frames, centres).filter(|(link, ..)| counts(link));
        for (link, frame, centre) in moving() {
            if self.fixtures.iter().any(|f| link_near(link, frame, centre, f, margin, directions)) {
                return Touch::Fixed;
            }
            for (id, placed) in &moment.placed {
                let margin = if link.hand && moment.gripping == Some(*id) { 0.0 } else { margin };
                if link_near(link, frame, centre, placed, margin, directions) {
                    return Touch::Fixed;
                }
            }
        }
        if self.held_meets_placed(moment, frames, directions, &mut touched) {
            return Touch::Fixed;
        }
        for id in moment.standing.iter() {
            let object = &self.objects[id.index()];
            for (link, frame, centre) in moving() {
                let margin = if link.hand && moment.gripping == Some(id) { 0.0 } else { margin };
                if link_near(link, frame, centre, object, margin, directions) {
                    touched.insert(id);
                    break;
                }
            }
        }
        if self.meets_itself(counts, frames, centres, directions) { Touch::Fixed } else { Touch::Objects(touched) }
    }

    /// Where the links are at a posture of the arm and a value of the hand's joint.
    pub fn links_at(&self, posture: &[f64], hand: f64) -> LinksAt {
        let mut scratch = Scratch::default();
        self.place_links(posture, hand, &mut scratch);
        LinksAt { frames: scratch.frames, centres: scratch.centres }
    }

    /// Whether the moving links, or what is held, come closer to one obstacle than the moment's margins.
    pub fn meets(&self, at: &LinksAt, moment: &Moment, obstacle: &Obstacle, scratch: &mut Scratch) -> bool {
        let (LinksAt { frames, centres }, directions) = (at, &mut scratch.directions);
        self.moving(frames, centres)
            .any(|(link, frame, centre)| link_near(link, frame, centre, obstacle, moment.margin, directions))
            || moment.held.as_ref().is_some_and(|held| {
                let root_from_object = frames[self.model.kinematics.tool] * held.tool_from_object;
                held.parts
                    .iter()
                    .any(|part| held_near(part, &root_from_object, obstacle, moment.held_margin, directions))
            })
    }

    /// Whether what is held meets anything fixed, the links being placed; objects met are added.
    pub(crate) fn held_meets(&self, moment: &Moment, scratch: &mut Scratch, touched: &mut ObjectSet) -> bool {
        let Scratch { frames, directions, .. } = scratch;
        self.held_meets_placed(moment, frames, directions, touched)
    }

    fn held_meets_placed(
        &self,
        moment: &Moment,
        frames: &[Pose],
        directions: &mut Directions,
        touched: &mut ObjectSet,
    ) -> bool {
        moment.held.as_ref().is_some_and(|held| {
            let root_from_object = frames[self.model.kinematics.tool] * held.tool_from_object;
            held.parts
                .iter()
                .any(|part| self.held_part_meets(part, &root_from_object, moment, frames, held, directions, touched))
        })
    }

    /// Computes the links' frames and middles for a posture.
    #[inline]
    pub(crate) fn place_links(&self, posture: &[f64], hand: f64, scratch: &mut Scratch) {
        self.model.kinematics.frames(posture, hand, &mut scratch.frames);
        scratch.centres.clear();
        let middle = |(link, frame): (&Option<LinkBody>, &Pose)| {
            link.as_ref().map_or(Vec3::ZERO, |l| frame.point(l.bound.centre))
        };
        scratch.centres.extend(self.model.links.iter().zip(&scratch.frames).map(middle));
    }

    /// The links with shapes that move, with their frames and middles.
    #[inline]
    fn moving<'a>(
        &'a self,
        frames: &'a [Pose],
        centres: &'a [Vec3],
    ) -> impl Iterator<Item = (&'a LinkBody, &'a Pose, Vec3)> {
        self.model
            .links
            .iter()
            .zip(frames.iter().zip(centres))
            .filter_map(|(l, (f, c))| l.as_ref().filter(|l| !l.still).map(|l| (l, f, *c)))
    }

    /// True when it meets something fixed; objects met are added to `touched`.
    #[allow(clippy::too_many_arguments)]
    fn held_part_meets(
        &self,
        part: &MovingPart,
        root_from_object: &Pose,
        moment: &Moment,
        frames: &[Pose],
        held: &crate::Held,
        directions: &mut Directions,
        touched: &mut ObjectSet,
    ) -> bool {
        let margin = moment.held_margin;
        let aabb = part.convex.aabb(&(*root_from_object * part.pose));
        let mut near = |o: &Obstacle, margin: f64| {
            o.near_aabb(aabb, margin) && held_near(part, root_from_object, o, margin, directions)
        };
        for (index, fixture) in self.fixtures.iter().enumerate() {
            if !(moment.resting && held.fixtures_below.contains(&index))
                && near(fixture, moment.held_margin_to_fixture(index))
            {
                return true;
            }
        }
        let carriers = if moment.resting { held.objects_below } else { ObjectSet::EMPTY };
        if moment.placed.iter().any(|(id, o)| !carriers.contains(*id) && near(o, moment.held_margin)) {
            return true;
        }
        for id in moment.standing.difference(carriers).difference(ObjectSet::of(held.object)).iter() {
            if near(&self.objects[id.index()], moment.held_margin_to_object(id)) {
                touched.insert(id);
            }
        }
        self.model.links.iter().zip(frames).any(|(link, frame)| {
            link.as_ref()
                .is_some_and(|l| !l.hand && held_near_link(part, root_from_object, l, frame, margin, directions))
        })
    }

    /// Whether two links come closer than they should.
    #[inline]
    fn meets_itself(
        &self,
        counts: impl Fn(&LinkBody) -> bool,
        frames: &[Pose],
        centres: &[Vec3],
        directions: &mut Directions,
    ) -> bool {
        self.model.pairs.iter().any(|&(a, b)| {
            let (Some(la), Some(lb)) = (&self.model.links[a], &self.model.links[b]) else { return false };
            (counts(la) || counts(lb))
                && links_near((la, &frames[a], centres[a]), (lb, &frames[b], centres[b]), SELF_MARGIN, directions)
        })
    }
}

/// Whether a part of what is held comes closer to an obstacle than `margin`.
#[inline]
pub(crate) fn held_near(
    part: &MovingPart,
    frame: &Pose,
    obstacle: &Obstacle,
    margin: f64,
    directions: &mut Directions,
) -> bool {
    obstacle.near_bound(frame.point(part.pose.translation), part.radius, margin)
        && obstacle.parts.iter().any(|other| part.near(frame, other, margin, directions))
}

/// Whether a part of what is held comes closer to a link than `margin`.
#[inline]
pub(crate) fn held_near_link(
    part: &MovingPart,
    root_from_object: &Pose,
    link: &LinkBody,
    frame: &Pose,
    margin: f64,
    directions: &mut Directions,
) -> bool {
    let centre = root_from_object.point(part.pose.translation);
    if frame.point(link.bound.centre).distance_squared(centre) > (link.bound.radius + part.radius + margin).powi(2) {
        return false;
    }
    let pose = *root_from_object * part.pose;
    link.parts.iter().any(|p| {
        directions.closer_than((&p.convex, &(*frame * p.pose), p.tag), (&part.convex, &pose, part.tag), margin)
    })
}

/// Whether a link, the middle of its bounding sphere at `centre`, comes closer to an obstacle than
/// `margin`.
#[inline]
pub(crate) fn link_near(
    link: &LinkBody,
    frame: &Pose,
    centre: Vec3,
    obstacle: &Obstacle,
    margin: f64,
    directions: &mut Directions,
) -> bool {
    if !obstacle.near_bound(centre, link.bound.radius, margin) {
        return false;
    }
    obstacle.parts.iter().any(|part| {
        part.near_ball(centre, link.bound.radius, margin)
            && (link.spheres.is_empty()
                || link.spheres.iter().any(|s| part.near_ball(frame.point(s.centre), s.radius, margin)))
            && link.parts.iter().any(|p| p.near(frame, part, margin, directions))
    })
}

/// Whether two links, each with its frame and the middle of its bounding sphere, come closer than
/// `margin`.
#[inline]
pub(crate) fn links_near(
    (a, frame_a, ca): (&LinkBody, &Pose, Vec3),
    (b, frame_b, cb): (&LinkBody, &Pose, Vec3),
    margin: f64,
    directions: &mut Directions,
) -> bool {
    if ca.distance_squared(cb) > (a.bound.radius + b.bound.radius + margin).powi(2) {
        return false;
    }
    let apart = |s: &Sphere, frame: &Pose, centre: Vec3, radius: f64| {
        frame.point(s.centre).distance_squared(centre) > (s.radius + radius + margin).powi(2)
    };
    if !a.spheres.is_empty() && a.spheres.iter().all(|s| apart(s, frame_a, cb, b.bound.radius))
        || !b.spheres.is_empty() && b.spheres.iter().all(|s| apart(s, frame_b, ca, a.bound.radius))
    {
        return false;
    }
    a.parts.iter().any(|pa| {
        let pose_a = *frame_a * pa.pose;
        b.parts.iter().any(|pb| {
            let pose_b = *frame_b * pb.pose;
            pose_a.translation.distance_squared(pose_b.translation) < (pa.radius + pb.radius + margin).powi(2)
                && directions.closer_than((&pa.convex, &pose_a, pa.tag), (&pb.convex, &pose_b, pb.tag), margin)
        })
    })
}
