//! What does a posture touch? All of it, as a set.

use crate::moment::Moment;
use crate::obstacle::Obstacle;
use crate::world::{LinkBody, World};
use clearway_geometry::{Convex, Pose, distance::closer_than};
use clearway_plan::ObjectSet;

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
    /// How many postures were checked with it.
    pub checked: u64,
}

/// Links may come this close to each other, metres.
pub(crate) const SELF_MARGIN: f64 = 0.002;

impl World {
    /// Everything movable that the posture touches, or that it touches something fixed.
    pub fn touched(&self, posture: &[f64], moment: &Moment, scratch: &mut Scratch) -> Touch {
        scratch.checked += 1;
        self.kinematics.frames(posture, moment.hand, &mut scratch.frames);
        let frames = &scratch.frames;
        let margin = moment.margin;
        let mut touched = ObjectSet::EMPTY;
        let moving = || self.moving(frames);
        for (link, frame) in moving() {
            if self.fixtures.iter().any(|f| link_near(link, frame, f, margin)) {
                return Touch::Fixed;
            }
            for (id, placed) in &moment.placed {
                let margin = if link.hand && moment.gripping == Some(*id) { 0.0 } else { margin };
                if link_near(link, frame, placed, margin) {
                    return Touch::Fixed;
                }
            }
        }
        if let Some(held) = &moment.held {
            let root_from_object = frames[self.kinematics.tool] * held.tool_from_object;
            for (part, convex) in &held.solid.parts {
                let pose = root_from_object * *part;
                if self.held_part_meets(convex, &pose, moment, frames, held, &mut touched) {
                    return Touch::Fixed;
                }
            }
        }
        for id in moment.standing.iter() {
            let object = &self.objects[id.index()];
            for (link, frame) in moving() {
                let margin = if link.hand && moment.gripping == Some(id) { 0.0 } else { margin };
                if link_near(link, frame, object, margin) {
                    touched.insert(id);
                    break;
                }
            }
        }
        if self.meets_itself(frames) { Touch::Fixed } else { Touch::Objects(touched) }
    }

    /// The links with shapes that move, with their frames.
    #[inline]
    fn moving<'a>(&'a self, frames: &'a [Pose]) -> impl Iterator<Item = (&'a LinkBody, &'a Pose)> {
        self.links.iter().zip(frames).filter_map(|(l, f)| l.as_ref().filter(|l| !l.still).map(|l| (l, f)))
    }

    /// True when it meets something fixed; objects met are added to `touched`.
    #[inline]
    fn held_part_meets(
        &self,
        convex: &Convex,
        pose: &Pose,
        moment: &Moment,
        frames: &[Pose],
        held: &crate::Held,
        touched: &mut ObjectSet,
    ) -> bool {
        let margin = moment.margin;
        let radius = convex.bounding_radius();
        let near = |o: &Obstacle| {
            o.near_bound(pose.translation, radius, margin)
                && o.parts.iter().any(|p| {
                    p.near_ball(pose.translation, radius, margin) && p.near_convex(convex, pose, margin)
                })
        };
        for (index, fixture) in self.fixtures.iter().enumerate() {
            if !(moment.resting && held.fixtures_below.contains(&index)) && near(fixture) {
                return true;
            }
        }
        if moment.placed.iter().any(|(_, o)| near(o)) {
            return true;
        }
        let carriers = if moment.resting { held.objects_below } else { ObjectSet::EMPTY };
        for id in moment.standing.difference(carriers).difference(ObjectSet::of(held.object)).iter() {
            if near(&self.objects[id.index()]) {
                touched.insert(id);
            }
        }
        self.links.iter().zip(frames).any(|(link, frame)| {
            link.as_ref().is_some_and(|l| {
                !l.hand
                    && frame.point(l.bound.centre).distance(pose.translation) < l.bound.radius + radius + margin
                    && l.parts.iter().any(|(part, c)| closer_than(c, &(*frame * *part), convex, pose, margin))
            })
        })
    }

    /// Whether two links come closer than they should.
    #[inline]
    pub(crate) fn meets_itself(&self, frames: &[Pose]) -> bool {
        self.pairs.iter().any(|&(a, b)| {
            let (Some(la), Some(lb)) = (&self.links[a], &self.links[b]) else { return false };
            links_near(la, &frames[a], lb, &frames[b], SELF_MARGIN)
        })
    }
}

/// Whether a link comes closer to an obstacle than `margin`.
#[inline]
pub(crate) fn link_near(link: &LinkBody, frame: &Pose, obstacle: &Obstacle, margin: f64) -> bool {
    let centre = frame.point(link.bound.centre);
    if !obstacle.near_bound(centre, link.bound.radius, margin) {
        return false;
    }
    obstacle.parts.iter().any(|part| {
        part.near_ball(centre, link.bound.radius, margin)
            && link.spheres.iter().any(|s| part.near_ball(frame.point(s.centre), s.radius, margin))
            && link.parts.iter().any(|(p, c)| part.near_convex(c, &(*frame * *p), margin))
    })
}

/// Whether two links come closer than `margin`.
#[inline]
pub(crate) fn links_near(a: &LinkBody, frame_a: &Pose, b: &LinkBody, frame_b: &Pose, margin: f64) -> bool {
    let (ca, cb) = (frame_a.point(a.bound.centre), frame_b.point(b.bound.centre));
    if ca.distance_squared(cb) > (a.bound.radius + b.bound.radius + margin).powi(2) {
        return false;
    }
    let spheres_meet = a.spheres.iter().any(|sa| {
        let pa = frame_a.point(sa.centre);
        pa.distance_squared(cb) < (sa.radius + b.bound.radius + margin).powi(2)
            && b.spheres
                .iter()
                .any(|sb| pa.distance_squared(frame_b.point(sb.centre)) < (sa.radius + sb.radius + margin).powi(2))
    });
    spheres_meet
        && a.parts.iter().any(|(pa, sa)| {
            let pose_a = *frame_a * *pa;
            b.parts.iter().any(|(pb, sb)| closer_than(sa, &pose_a, sb, &(*frame_b * *pb), margin))
        })
}
