//! Plays a plan in a physics engine: what moved that should not, what was touched, what fell.
//!
//! Fixtures stand still; objects have mass and friction; the robot's links follow the plan's rows through
//! controllers that lag, and push whatever they meet; a parallel hand closes until its pads press as asked, and
//! holds by friction alone; a suction cup holds what it reaches. SI units, world frame with z up.
//!
//! ```no_run
//! use clearway_plan::Budget;
//! use clearway_simulate::{Settings, simulate};
//! let plan = clearway_verify::read_plan("plan.json".as_ref())?;
//! let outcome = simulate(&plan, ".".as_ref(), &Settings::default(), &Budget::unlimited())?;
//! print!("{outcome}");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The outline is `run`. `bodies` says what there is, `world` is the only file that knows the engine's solver,
//! `servo` and `grip` are the controllers, `touches` and `ends` judge. A step of the physics, a millisecond, takes
//! some 50 µs for a shelf of a dozen objects.
//!
//! It does not model: the robot's own dynamics (its links go where their controllers say, whatever they meet),
//! bending, a limit to what a suction cup holds, air.

mod bodies;
mod caps;
mod ends;
mod error;
mod grip;
mod hand;
mod noise;
mod outcome;
mod run;
mod servo;
mod settings;
mod told;
mod touches;
mod trials;
mod world;

pub use error::CannotSimulate;
pub use outcome::{Assumed, End, Hold, Outcome, Thing, ThingKind, Touch};
pub use run::simulate;
pub use settings::{Noise, Settings, Tolerance};
pub use trials::{Failing, Trial, Trials, trials};
