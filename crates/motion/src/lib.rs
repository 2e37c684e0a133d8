//! From posture to posture without touching: RRT-Connect, shortcuts, curves and timing.
//!
//! Postures are rows of joint values (radians, metres) in the arm's order. Collisions are asked of
//! [`clearway_collision::World`] at one [`clearway_collision::Moment`].

mod curve;
mod differences;
mod ends;
mod law;
mod pace;
mod planner;
mod problem;
mod rates;
mod reach;
mod rows;
mod rrt_connect;
mod sampler;
mod shortcut;
mod simplify;
mod smooth;
mod space;
mod sphere_space;
mod time_path;
mod timing;
mod tree;
mod validator;

pub use curve::{Corners, Curve};
pub use differences::slowdowns;
pub use planner::{MotionPlanner, Obstacle, Settings as MotionSettings, Solution, Surroundings};
pub use problem::MotionProblem;
pub use rrt_connect::{Settings as RrtSettings, Trees, connect};
pub use sampler::{Halton, NearEnds, Sampler};
pub use shortcut::shorten;
pub use simplify::{Settings as SimplifySettings, simplify};
pub use smooth::{rounded, smooth};
pub use space::{Space, Surely};
pub use sphere_space::SphereSpace;
pub use time_path::time_path;
pub use timing::{Limits, Timed, time_curve};
pub use validator::MotionValidator;

/// A row of joint values.
pub type Posture = Vec<f64>;

/// Straight lines between postures.
pub type Path = Vec<Posture>;

/// The sum over a path of the Euclidean joint distances between its postures.
pub fn length(path: &[Posture]) -> f64 {
    path.windows(2).map(|w| distance(&w[0], &w[1])).sum()
}

/// The posture so far (0 to 1) on the straight line from `a` to `b`.
pub fn between(a: &[f64], b: &[f64], part: f64) -> Posture {
    a.iter().zip(b).map(|(a, b)| a + (b - a) * part).collect()
}

/// Euclidean distance in joint space.
#[inline]
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
