//! How an object is pushed: what a step of a plan file says about it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A straight push by the open hand. In its `push` segment the tool goes along `direction` without turning; once
/// it has gone `free` metres a link of the hand meets the object, which from then on goes with it, until it has
/// gone `distance` metres. Where it then stands is `placed`. The hand stays round it as a cage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Push {
    /// Unit, in the world, level.
    pub direction: [f64; 3],
    /// The way of the object, metres.
    pub distance: f64,
    /// The way of the hand before it meets the object, metres.
    pub free: f64,
    /// Above what carries the object: the highest point at which the hand pushes, metres.
    pub height: f64,
    /// Above the same: pushed higher than this, an object so wide and so rough tips, metres: r / µ.
    pub tips_at: f64,
    /// Everything keeps this much more room from the object on its way and where it then stands, metres: it may
    /// end so far from `placed`.
    pub margin_of_error: f64,
}
