//! Which objects must move, in what order, and how, so that the robot can take the one it wants.
//!
//! ```no_run
//! let (scene, robot) = clearway::open("examples/shelf.yaml".as_ref(), &[])?;
//! let mut planner = clearway::Planner::new(scene, robot, clearway::Settings::default()).unwrap();
//! let request = clearway::Request::new(1, clearway::Budget::unlimited());
//! match clearway::solve(&mut planner, &request, ".".as_ref(), &mut clearway::Silent) {
//!     clearway::Outcome::Solved(plan) => println!("{:?}", plan.plan().removed),
//!     other => println!("{other:?}"),
//! }
//! # Ok::<(), clearway::FileError>(())
//! ```

mod goal;
mod motion;
mod observed;
mod outcome;
mod written;

pub use clearway_collision::CollisionModel;
pub use clearway_export as export;
pub use clearway_files::FileError;
pub use clearway_motion::{MotionPlanner, MotionProblem, MotionSettings, Surroundings};
pub use clearway_plan::event::{Event, Observer, Silent};
pub use clearway_plan::{Budget, MotionAnswer, MotionFile, PlanFile, RobotFile, SceneFile, Stop};
pub use clearway_retrieval::occlusion::guess::Rule as LookRule;
pub use clearway_retrieval::push::Pushes;
pub use clearway_retrieval::{FirstLimit, Planner, Request, SceneDelta, Search, Settings, Unfit};
pub use clearway_robot::Robot;
pub use clearway_scenarios as scenarios;
pub use clearway_scene::Scene;
pub use clearway_simulate as simulate;
pub use clearway_verify::{Report, VerifiedPlan, read_plan, verify, verify_file};
pub use goal::solve_goal;
pub use motion::{MotionOutcome, plan_motion};
pub use observed::solve_observed;
pub use outcome::{Outcome, improve, solve};
pub use written::{page, scene_meshes, to_json, with_meshes_relative_to};

/// PDDL with streams (section V-C).
pub mod pddl {
    pub use clearway_retrieval::handling::Handling;
    pub use clearway_symbolic::arm::PROVIDED;
    pub use clearway_symbolic::engine::{Engine, FastDownward, Ferroplan};
    pub use clearway_symbolic::pddl::{Constant, Domain, Goal, Stream};
    pub use clearway_symbolic::problem::{Answer, Asked, retrieval};
    pub use clearway_symbolic::search::Algorithm;
    pub use clearway_symbolic::telling::{check, check_goal, constants};
    pub use clearway_symbolic::{DOMAIN, STREAMS, domain, streams};
}

use clearway_files::{Limits, read_text, yaml};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads a scene file and the robot that it names. `packages`: where `package://NAME` leads.
pub fn open(path: &Path, packages: &[(String, PathBuf)]) -> Result<(Scene, Arc<Robot>), FileError> {
    let text = read_text(path, &Limits::DOCUMENT)?;
    let scene = Scene::from_text(path, &text)?;
    let robot = Robot::load(&scene.file.robot.model, &scene.directory, packages)
        .map_err(|error| error.referenced_from(path, yaml::position(&text, &["robot", "model"])))?;
    if scene.file.robot.region.is_some() && robot.planar_base.is_none() {
        return Err(FileError::new(path, "`robot.region` is given, but the robot's base does not drive")
            .at_position(yaml::position(&text, &["robot", "region"]))
            .help("delete the key, or let the robot file say `mobile: {planar: …}`"));
    }
    Ok((scene, Arc::new(robot)))
}
