//! A partly observed scene, played through with a simulated camera, and verified.

use crate::outcome::{Outcome, verified};
use clearway_collision::CollisionModel;
use clearway_plan::event::Observer;
use clearway_retrieval::occlusion::guess::Rule;
use clearway_retrieval::occlusion::simulated::play;
use clearway_retrieval::{Request, Settings, Unfit};
use clearway_scene::Scene;
use std::path::Path;
use std::sync::Arc;

/// Looks, plans, acts and looks again until the target is out, and verifies the whole. The scene has a camera, and
/// all its objects, for the camera to see or not.
pub fn solve_observed(
    scene: Scene,
    model: Arc<CollisionModel>,
    settings: Settings,
    rule: Rule,
    request: &Request,
    directory: &Path,
    observer: &mut dyn Observer,
) -> Result<Outcome, Unfit> {
    let (plan, stopped) = play(scene, model, settings, rule, request, observer)?;
    Ok(verified(plan, stopped, request, directory))
}
