//! Exact answers about the few things that the kernel's spheres touch; see [`crate::Quick`].

use crate::lanes::{Suspect, Suspects};
use crate::moment::Moment;
use crate::obstacle::Obstacle;
use crate::probe::{Probe, Slack};
use crate::query::{SELF_MARGIN, Scratch, Touch, held_near, held_near_link, link_near, links_near};
use crate::world::World;
use clearway_plan::{ObjectId, ObjectSet};

/// Whose an obstacle is.
enum Owner {
    Fixture,
    Standing(ObjectId),
    Placed(ObjectId),
}

impl World {
    /// The obstacle that a suspect names, numbered fixtures first, then objects, then what was placed.
    fn owner<'a>(&'a self, moment: &'a Moment, number: usize) -> Option<(Owner, &'a Obstacle)> {
        let (fixtures, objects) = (self.fixtures.len(), self.objects.len());
        if number < fixtures {
            return Some((Owner::Fixture, &self.fixtures[number]));
        }
        if let Some(object) = self.objects.get(number - fixtures) {
            return Some((Owner::Standing(ObjectId((number - fixtures) as u16)), object));
        }
        moment.placed.get(number - fixtures - objects).map(|(id, o)| (Owner::Placed(*id), &**o))
    }

    /// Closer than this is touching, for a link and an obstacle.
    fn margin(&self, moment: &Moment, owner: &Owner, hand: bool) -> f64 {
        match owner {
            Owner::Standing(id) | Owner::Placed(id) if hand && moment.gripping == Some(*id) => 0.0,
            _ => moment.margin,
        }
    }

    /// [`World::touched`], for a posture that is known to touch nothing but the suspects of its
    /// lane, what is held aside.
    pub fn touched_among(&self, posture: &[f64], moment: &Moment, suspects: &Suspects, lane: usize, scratch: &mut Scratch) -> Touch {
        let of_lane = |s: &&Suspect| s.lanes >> lane & 1 == 1;
        let any = suspects.obstacles.iter().chain(&suspects.pairs).any(|s| of_lane(&s));
        if !any && moment.held.is_none() {
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
            let (Some(link), Some((owner, obstacle))) = (&self.model.links[suspect.link], self.owner(moment, suspect.other)) else {
                continue;
            };
            if matches!(owner, Owner::Standing(id) if touched.contains(id)) {
                continue;
            }
            let margin = self.margin(moment, &owner, link.hand);
            if suspect.sure >> lane & 1 == 1
                || link_near(link, &frames[suspect.link], centres[suspect.link], obstacle, margin, directions)
            {
                match owner {
                    Owner::Standing(id) => touched.insert(id),
                    Owner::Fixture | Owner::Placed(_) => return Touch::Fixed,
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

    /// [`World::probe`], for a posture that is known to touch nothing but the suspects, nor anywhere
    /// in the motion asked about. What the posture leans is not looked at.
    pub fn probe_among(
        &self,
        posture: &[f64],
        moment: &Moment,
        slack: Option<&Slack>,
        suspects: &Suspects,
        scratch: &mut Scratch,
    ) -> Probe {
        scratch.checked += 1;
        self.place_links(posture, moment.hand, scratch);
        let Scratch { frames, centres, directions, .. } = scratch;
        let held_index = self.model.held_index();
        let held = moment.held.as_ref().map(|held| (held, frames[self.model.kinematics.tool] * held.tool_from_object));
        let mut around = slack;
        for suspect in &suspects.obstacles {
            let index = suspect.link;
            let Some((owner, obstacle)) = self.owner(moment, suspect.other) else { continue };
            let mut near = |more: f64| match (self.model.links.get(index), &held) {
                (Some(Some(link)), _) => {
                    let margin = self.margin(moment, &owner, link.hand) + more;
                    link_near(link, &frames[index], centres[index], obstacle, margin, directions)
                }
                (None, Some((held, frame))) => {
                    let margin = moment.held_margin + more;
                    held.parts.iter().any(|part| held_near(part, frame, obstacle, margin, directions))
                }
                _ => false,
            };
            if around.is_none_or(|s| near(s.link(index))) {
                around = None;
                if near(0.0) {
                    return Probe::Hit;
                }
            }
        }
        for suspect in &suspects.pairs {
            // What is held comes last.
            let (a, b) = (suspect.link, suspect.other);
            let Some(la) = &self.model.links[a] else { continue };
            let mut near = |more: f64| match (self.model.links.get(b), &held) {
                (Some(Some(lb)), _) => {
                    links_near((la, &frames[a], centres[a]), (lb, &frames[b], centres[b]), SELF_MARGIN + more, directions)
                }
                (None, Some((held, frame))) => {
                    let margin = moment.held_margin + more;
                    held.parts.iter().any(|part| held_near_link(part, frame, la, &frames[a], margin, directions))
                }
                _ => false,
            };
            let moved = |s: &Slack| if b == held_index { s.link(a) + s.link(b) } else { s.between(self, a, b) };
            if around.is_none_or(|s| near(moved(s))) {
                around = None;
                if near(0.0) {
                    return Probe::Hit;
                }
            }
        }
        if around.is_some() { Probe::Around } else { Probe::Here }
    }
}
