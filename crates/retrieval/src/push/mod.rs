//! Pushing an object aside rather than picking it (section VI-G, Fig. 16): "collision-free sampling poses that
//! locate around removal objects and have no collision with the swept volume of the robot motions".
//!
//! The open hand comes in round the object, as to grasp it, goes straight to one side or ahead, and takes the
//! object along. Only what a push does not turn aside or tip is pushed: an upright cylinder, or several on one axis
//! ([`Upright`]), met by the hand so that it stays before it ([`Contact`]), no higher than friction lets it slide.
//! On its way and where it ends everything keeps a margin of error from it ([`course`]).
//!
//! Poses and directions are in the robot's root frame, metres.

mod contact;
pub(crate) mod course;
mod upright;

pub use contact::Contact;
pub use upright::Upright;

/// When objects are pushed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Pushes {
    /// Only picked.
    Never,
    /// Where that takes less time than picking.
    #[default]
    Choose,
    /// Wherever one can be pushed.
    Prefer,
}

/// How objects are pushed.
#[derive(Clone, Debug)]
pub struct Settings {
    pub when: Pushes,
    /// How far an object may end from where it should: everything keeps so much room from it, metres.
    pub margin_of_error: f64,
    /// The hand pushes no higher than this part of the height at which the object tips.
    pub tipping: f64,
    /// Of the tool, m/s.
    pub speed: f64,
    /// Of the tool, as a part of the deceleration µ·g that an object left alone has.
    pub braking: f64,
    /// Ways of the object that are looked at, metres: from, in steps of, up to.
    pub nearest: f64,
    pub step: f64,
    pub farthest: f64,
    /// Directions to come from, ends of the push, and ways along it for which motions are tried.
    pub sides: usize,
    pub ends: usize,
    pub tries: usize,
    /// Ways of each object to be taken later of which one has to stay free.
    pub later_ways: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            when: Pushes::default(),
            margin_of_error: 0.005,
            tipping: 0.9,
            speed: 0.25,
            braking: 0.5,
            nearest: 0.02,
            step: 0.02,
            farthest: 0.4,
            sides: 6,
            ends: 8,
            tries: 4,
            later_ways: 3,
        }
    }
}

/// m/s².
pub const GRAVITY: f64 = 9.81;
