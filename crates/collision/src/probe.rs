//! Is a posture free, and how far around? A probe answers for a posture and, when everything is
//! far enough, for all postures that a given motion reaches from it: then none of those need be
//! looked at. That is conservative advancement with a yes or no in place of a distance.

use crate::directions::Directions;
use crate::moment::{Lean, Moment};
use crate::obstacle::{MovingPart, Obstacle};
use crate::query::{SELF_MARGIN, Scratch, held_near, held_near_link, link_near, links_near};
use crate::world::World;
use clearway_geometry::{Pose, Vec3};
use clearway_plan::ObjectSet;

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
        self.links.extend(world.model.link_reach.iter().map(|reach| moved(reach, 0.0)));
        let held = moment.held.as_ref().map_or(0.0, |h| {
            let far = |p: &MovingPart| h.tool_from_object.point(p.pose.translation).length() + p.radius;
            moved(&world.model.tool_reach, h.parts.iter().map(far).fold(0.0, f64::max))
        });
        self.links.push(held);
    }

    /// The farthest that any point moves, metres.
    pub fn most(&self) -> f64 {
        self.links.iter().copied().fold(0.0, f64::max)
    }

    /// How far link `b` moves as seen from link `a`: only joints between them count.
    pub(crate) fn between(&self, world: &World, a: usize, b: usize) -> f64 {
        let apart = world.model.kinematics.moved_by[a] ^ world.model.kinematics.moved_by[b];
        let reach = |j: usize| world.model.link_reach[a][j].max(world.model.link_reach[b][j]);
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
        self.place_links(posture, moment.hand, scratch);
        let Scratch { frames, centres, directions, .. } = scratch;
        let (frames, centres): (&[Pose], &[Vec3]) = (frames, centres);
        if self.leans(frames, moment) {
            return Probe::Hit;
        }
        // Once something is near, the rest is only asked whether it is hit.
        let mut around = slack;
        macro_rules! check {
            ($slack:expr, $near:expr) => {{
                let mut near = $near;
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
            let last = self.model.links.len();
            let root_from_object = frames[self.model.kinematics.tool] * held.tool_from_object;
            for part in held.parts.iter() {
                check!(|s: &Slack| s.links[last], |more| self.held_near(
                    part,
                    &root_from_object,
                    moment,
                    held,
                    more,
                    directions
                ));
                for (index, link) in self.model.links.iter().enumerate() {
                    let Some(link) = link.as_ref().filter(|l| !l.hand) else { continue };
                    check!(|s: &Slack| s.links[last] + s.links[index], |more: f64| {
                        held_near_link(
                            part,
                            &root_from_object,
                            link,
                            &frames[index],
                            moment.held_margin + more,
                            directions,
                        )
                    });
                }
            }
        }
        for (index, link) in self.model.links.iter().enumerate().rev() {
            let Some(link) = link.as_ref().filter(|l| !l.still) else { continue };
            let (frame, centre) = (&frames[index], centres[index]);
            for fixture in &self.fixtures {
                check!(|s: &Slack| s.links[index], |more: f64| link_near(
                    link,
                    frame,
                    centre,
                    fixture,
                    moment.margin + more,
                    directions
                ));
            }
            for id in moment.standing.iter() {
                let margin = if link.hand && moment.gripping == Some(id) { 0.0 } else { moment.margin };
                let object = &self.objects[id.index()];
                check!(|s: &Slack| s.links[index], |more: f64| link_near(
                    link,
                    frame,
                    centre,
                    object,
                    margin + more,
                    directions
                ));
            }
            for (id, placed) in &moment.placed {
                let margin = if link.hand && moment.gripping == Some(*id) { 0.0 } else { moment.margin };
                check!(|s: &Slack| s.links[index], |more: f64| link_near(
                    link,
                    frame,
                    centre,
                    placed,
                    margin + more,
                    directions
                ));
            }
        }
        for &(a, b) in &self.model.pairs {
            let (Some(la), Some(lb)) = (&self.model.links[a], &self.model.links[b]) else { continue };
            check!(|s: &Slack| s.between(self, a, b), |more: f64| {
                links_near((la, &frames[a], centres[a]), (lb, &frames[b], centres[b]), SELF_MARGIN + more, directions)
            });
        }
        if around.is_some() { Probe::Around } else { Probe::Here }
    }

    /// Whether the tool leans farther than the moment allows.
    fn leans(&self, frames: &[Pose], moment: &Moment) -> bool {
        let up = |lean: &Lean| (frames[self.model.kinematics.tool].rotation * lean.axis).dot(lean.upward);
        moment.lean.as_ref().is_some_and(|lean| up(lean) < lean.least)
    }

    /// Whether any of these postures leans too far.
    pub fn any_leans(&self, postures: &[Vec<f64>], moment: &Moment, scratch: &mut Scratch) -> bool {
        moment.lean.is_some()
            && postures.iter().any(|q| {
                self.model.kinematics.frames(q, moment.hand, &mut scratch.frames);
                self.leans(&scratch.frames, moment)
            })
    }

    /// Whether a part of what is held comes closer to anything but the robot than it may, or by `more` less.
    fn held_near(
        &self,
        part: &MovingPart,
        root_from_object: &Pose,
        moment: &Moment,
        held: &crate::Held,
        more: f64,
        directions: &mut Directions,
    ) -> bool {
        let mut near = |o: &Obstacle, margin: f64| held_near(part, root_from_object, o, margin + more, directions);
        let resting = moment.resting;
        let below = if resting { held.objects_below } else { ObjectSet::EMPTY };
        self.fixtures
            .iter()
            .enumerate()
            .any(|(i, f)| !(resting && held.fixtures_below.contains(&i)) && near(f, moment.held_margin_to_fixture(i)))
            || moment
                .standing
                .difference(below.with(held.object))
                .iter()
                .any(|id| near(&self.objects[id.index()], moment.held_margin_to_object(id)))
            || moment.placed.iter().any(|(id, o)| !below.contains(*id) && near(o, moment.held_margin))
    }
}
