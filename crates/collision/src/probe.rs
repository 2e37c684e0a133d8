//! Is a posture free, and how far around? A probe answers for a posture and, when everything is
//! far enough, for all postures that a given motion reaches from it: then none of those need be
//! looked at. That is conservative advancement with a yes or no in place of a distance.

use crate::moment::Moment;
use crate::obstacle::Obstacle;
use crate::query::{SELF_MARGIN, Scratch, link_near, links_near};
use crate::world::World;
use clearway_geometry::{Convex, Pose, distance::closer_than};

/// What a probe found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// The posture touches something.
    Hit,
    /// The posture is free; nothing is said of others.
    Here,
    /// The posture is free, and so is every posture within the motion asked about.
    Around,
}

/// A motion about a posture: by how much each arm joint may differ from it.
#[derive(Clone, Debug, Default)]
pub struct Slack {
    joints: Vec<f64>,
    /// By link: no point of it moves farther than this, metres. Last: what is held.
    links: Vec<f64>,
}

impl Slack {
    /// Sets the motion; `joints` are differences without sign.
    pub fn set(&mut self, world: &World, moment: &Moment, joints: &[f64]) {
        self.joints.clear();
        self.joints.extend_from_slice(joints);
        self.links.clear();
        let moved = |reach: &[f64], longer: f64| -> f64 {
            joints.iter().zip(reach).map(|(d, r)| if *r > 0.0 { d * (r + longer) } else { 0.0 }).sum()
        };
        self.links.extend(world.link_reach.iter().map(|reach| moved(reach, 0.0)));
        let held = moment.held.as_ref().map_or(0.0, |h| {
            let far = |(part, convex): &(Pose, Convex)| (h.tool_from_object * *part).translation.length() + convex.bounding_radius();
            moved(&world.tool_reach, h.solid.parts.iter().map(far).fold(0.0, f64::max))
        });
        self.links.push(held);
    }

    /// The farthest that any point moves, metres.
    pub fn most(&self) -> f64 {
        self.links.iter().copied().fold(0.0, f64::max)
    }

    /// How far link `b` moves as seen from link `a`: only joints between them count.
    fn between(&self, world: &World, a: usize, b: usize) -> f64 {
        let apart = world.kinematics.moved_by[a] ^ world.kinematics.moved_by[b];
        let reach = |j: usize| world.link_reach[a][j].max(world.link_reach[b][j]);
        self.joints.iter().enumerate().filter(|(j, _)| apart >> j & 1 == 1).map(|(j, d)| d * reach(j)).sum()
    }
}

impl World {
    /// Whether the posture touches nothing.
    #[inline]
    pub fn free(&self, posture: &[f64], moment: &Moment, scratch: &mut Scratch) -> bool {
        self.probe(posture, moment, None, scratch) != Probe::Hit
    }

    /// Probes a posture; with `slack`, also what lies around it.
    pub fn probe(&self, posture: &[f64], moment: &Moment, slack: Option<&Slack>, scratch: &mut Scratch) -> Probe {
        scratch.checked += 1;
        self.kinematics.frames(posture, moment.hand, &mut scratch.frames);
        let frames = &scratch.frames;
        // Once something is near, the rest is only asked whether it is hit.
        let mut around = slack;
        macro_rules! check {
            ($slack:expr, $near:expr) => {{
                let near = $near;
                if let Some(s) = around {
                    if near($slack(s)) {
                        around = None;
                        if near(0.0) {
                            return Probe::Hit;
                        }
                    }
                } else if near(0.0) {
                    return Probe::Hit;
                }
            }};
        }
        if let Some(held) = &moment.held {
            let last = self.links.len();
            let root_from_object = frames[self.kinematics.tool] * held.tool_from_object;
            for (part, convex) in &held.solid.parts {
                let pose = root_from_object * *part;
                check!(|s: &Slack| s.links[last], |more| self.held_near(convex, &pose, moment, held, moment.margin + more));
                for (index, link) in self.links.iter().enumerate() {
                    let Some(link) = link.as_ref().filter(|l| !l.hand) else { continue };
                    let radius = convex.bounding_radius();
                    let centre = frames[index].point(link.bound.centre);
                    check!(|s: &Slack| s.links[last] + s.links[index], |more: f64| {
                        let margin = moment.margin + more;
                        centre.distance(pose.translation) < link.bound.radius + radius + margin
                            && link.parts.iter().any(|(p, c)| closer_than(c, &(frames[index] * *p), convex, &pose, margin))
                    });
                }
            }
        }
        for (index, link) in self.links.iter().enumerate().rev() {
            let Some(link) = link.as_ref().filter(|l| !l.still) else { continue };
            let frame = &frames[index];
            for fixture in &self.fixtures {
                check!(|s: &Slack| s.links[index], |more: f64| link_near(link, frame, fixture, moment.margin + more));
            }
            for id in moment.standing.iter() {
                let margin = if link.hand && moment.gripping == Some(id) { 0.0 } else { moment.margin };
                let object = &self.objects[id.index()];
                check!(|s: &Slack| s.links[index], |more: f64| link_near(link, frame, object, margin + more));
            }
            for (id, placed) in &moment.placed {
                let margin = if link.hand && moment.gripping == Some(*id) { 0.0 } else { moment.margin };
                check!(|s: &Slack| s.links[index], |more: f64| link_near(link, frame, placed, margin + more));
            }
        }
        for &(a, b) in &self.pairs {
            let (Some(la), Some(lb)) = (&self.links[a], &self.links[b]) else { continue };
            check!(|s: &Slack| s.between(self, a, b), |more: f64| {
                links_near(la, &frames[a], lb, &frames[b], SELF_MARGIN + more)
            });
        }
        if around.is_some() { Probe::Around } else { Probe::Here }
    }

    /// Whether a part of what is held comes closer than `margin` to anything but the robot.
    fn held_near(&self, convex: &Convex, pose: &Pose, moment: &Moment, held: &crate::Held, margin: f64) -> bool {
        let radius = convex.bounding_radius();
        let near = |o: &Obstacle| {
            o.near_bound(pose.translation, radius, margin)
                && o.parts
                    .iter()
                    .any(|p| p.near_ball(pose.translation, radius, margin) && p.near_convex(convex, pose, margin))
        };
        let resting = moment.resting;
        self.fixtures.iter().enumerate().any(|(i, f)| !(resting && held.fixtures_below.contains(&i)) && near(f))
            || moment
                .standing
                .iter()
                .any(|id| id != held.object && !(resting && held.objects_below.contains(id)) && near(&self.objects[id.index()]))
            || moment.placed.iter().any(|(_, o)| near(o))
    }
}
