//! `clearway` alone: the built-in scene, planned, with its page.

use super::output;
use super::plan::finish;
use super::summary::Progress;
use crate::exit::{Exit, Failure};
use clearway::{Planner, Request, Robot, Scene, Settings};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

const SCENE: &str = include_str!("../../../../examples/shelf.yaml");

pub fn run() -> Result<Exit, Failure> {
    let here = Path::new(".");
    let (plan, page) = (Path::new("clearway-demo.plan.json"), Path::new("clearway-demo.html"));
    output::check([plan, page], &[])?;
    let scene = Scene::from_text(Path::new("examples/shelf.yaml"), SCENE)?;
    let robot = Arc::new(Robot::load(&scene.file.robot.model, here, &[])?);
    let mut planner = Planner::new(scene, robot, Settings::default())
        .map_err(|u| Failure::internal(format!("the demo scene: {u:?}")))?;
    let request = Request::new(1, super::budget(None).with_time(Duration::from_secs(60)));
    let mut progress = Progress::new(true);
    let outcome = clearway::solve(&mut planner, &request, here, &mut progress);
    progress.clear();
    finish(outcome, Some(plan), Some(page), here, false)
}
