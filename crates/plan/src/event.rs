//! What happens while planning, told to whoever listens.

use crate::object_set::ObjectId;
use serde::Serialize;

/// One thing that happened. Objects are named.
#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case", tag = "event")]
pub enum Event {
    /// A new round of Algorithm 1 with this exploration limit *L*.
    Iteration { exploration_limit: usize, roadmap_nodes: usize, retrieval_nodes: usize },
    /// A removal sequence goes to the feasibility check.
    Sequence { objects: Vec<String> },
    /// An object cannot be taken yet; any one of `blocked_by` would have to go first.
    Blocked { object: String, removed_before: Vec<String>, blocked_by: Vec<Vec<String>> },
    /// An object's whole motion was found.
    Taken { object: String },
}

/// Receives events as they happen, on the planning thread.
pub trait Observer {
    fn event(&mut self, event: Event);
}

/// Listens to nothing.
pub struct Silent;

impl Observer for Silent {
    fn event(&mut self, _: Event) {}
}

impl<F: FnMut(Event)> Observer for F {
    fn event(&mut self, event: Event) {
        self(event)
    }
}

/// Names by id, for events and messages.
pub fn name(names: &[String], id: ObjectId) -> String {
    names[id.index()].clone()
}
