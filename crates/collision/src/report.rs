//! Contacts by name, for messages: slow, thorough.

use crate::directions::Directions;
use crate::model::LinkBody;
use crate::moment::Moment;
use crate::query::{link_near, links_near};
use crate::world::World;
use clearway_geometry::Pose;
use clearway_scene::Scene;
use std::fmt;

/// Two things that touch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Contact {
    Links(String, String),
    Fixture { link: String, fixture: String },
    Object { link: String, object: String },
}

impl Contact {
    /// Whether it is not the robot with itself.
    pub fn is_with_scene(&self) -> bool {
        !matches!(self, Contact::Links(..))
    }

    /// What the link touches, by name.
    pub fn other(self) -> String {
        match self {
            Contact::Links(_, other)
            | Contact::Fixture { fixture: other, .. }
            | Contact::Object { object: other, .. } => other,
        }
    }
}

impl fmt::Display for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Contact::Links(a, b) => write!(f, "link `{a}` touches link `{b}`"),
            Contact::Fixture { link, fixture } => write!(f, "link `{link}` touches fixture `{fixture}`"),
            Contact::Object { link, object } => write!(f, "link `{link}` touches object `{object}`"),
        }
    }
}

impl World {
    /// Every contact of a posture, links with each other, fixtures and standing objects. `margin`
    /// 0 means exact touching. The root link may meet what it is mounted on.
    pub fn contacts(&self, scene: &Scene, posture: &[f64], moment: &Moment, margin: f64) -> Vec<Contact> {
        let mut frames = Vec::new();
        self.model.kinematics.frames(posture, moment.hand, &mut frames);
        let mut contacts = Vec::new();
        let directions = &mut Directions::default();
        let middle = |link: &LinkBody, frame: &Pose| frame.point(link.bound.centre);
        let name = |i: usize| self.model.robot.links[i].name.clone();
        for &(a, b) in &self.model.pairs {
            if let (Some(la), Some(lb)) = (&self.model.links[a], &self.model.links[b])
                && links_near(
                    (la, &frames[a], middle(la, &frames[a])),
                    (lb, &frames[b], middle(lb, &frames[b])),
                    margin,
                    directions,
                )
            {
                contacts.push(Contact::Links(name(a), name(b)));
            }
        }
        for (index, (link, frame)) in self.model.links.iter().zip(&frames).enumerate() {
            let Some(link) = link.as_ref().filter(|_| !self.model.robot.mounted(index)) else { continue };
            for (fixture, obstacle) in scene.fixtures.iter().zip(&self.fixtures) {
                if link_near(link, frame, middle(link, frame), obstacle, margin, directions) {
                    contacts.push(Contact::Fixture { link: name(index), fixture: fixture.id.clone() });
                }
            }
            for id in moment.standing.iter() {
                if link_near(link, frame, middle(link, frame), &self.objects[id.index()], margin, directions) {
                    contacts.push(Contact::Object { link: name(index), object: scene.names[id.index()].clone() });
                }
            }
        }
        contacts
    }
}
