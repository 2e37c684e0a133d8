//! Which objects must move, in what order, and how: the planner of Tian, Song, Wang, Zhang and
//! Pan, "Sampling-Based Planning for Retrieving Near-Cylindrical Objects in Cluttered Scenes Using
//! Hierarchical Graphs", a module per idea.
//!
//! | module | paper |
//! |---|---|
//! | [`floor`] | footprint (Appendix B), x_s, x_g |
//! | [`roadmap`] | Algorithm 2 |
//! | [`graph`] | section IV-C, Algorithm 3, Figs. 4 to 6 |
//! | [`feasibility`], and under it [`grasps`], [`ways`], [`carry`] | section IV-D |
//! | [`planner`] | Algorithm 1 |
//! | [`mobile`] | section V-B |
//! | [`push`] | section VI-G, Fig. 16 |
//! | [`handling`] | what symbolic planning asks of the arm (section V-C) |
//!
//! Beyond the paper: `direct`, sequences along the arm's own ways; [`order`], the fewest removals when all ways
//! are known; [`barriers`] and [`bound`], lower bounds and their
//! proofs.

pub mod barriers;
pub mod bound;
pub mod candidates;
pub mod carry;
mod direct;
pub mod feasibility;
pub mod floor;
pub mod graph;
pub mod grasps;
pub mod handling;
pub mod mobile;
pub mod occlusion;
pub mod order;
mod ordered;
pub mod place;
pub mod planner;
pub mod push;
pub mod roadmap;
mod stand;
mod trace;
pub mod ways;

pub use feasibility::{Feasibility, Taking, Unfit};
pub use graph::Search;
pub use planner::{Answer, FirstLimit, Planner, Request, SceneDelta, Settings};
