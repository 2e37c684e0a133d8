//! What there is in the world: shapes, masses, friction, from the plan's scene, before noise.

use crate::error::CannotSimulate;
use crate::outcome::Assumed;
use clearway_plan::PlanFile;
use clearway_plan::scene_file::{DENSITY, FRICTION};
use clearway_verify::played::{Played, PlayedShape};
use parry3d_f64::math::Pose;

/// An object, made ready for the physics.
#[derive(Clone)]
pub(crate) struct Object {
    pub shapes: Vec<PlayedShape>,
    /// At the start.
    pub world_from_object: Pose,
    /// Kilograms.
    pub mass: f64,
    pub friction: f64,
    /// What of it the scene file did not give.
    pub assumed: Assumed,
}

/// As the scene says, else as the scene file's defaults are.
pub(crate) fn objects(plan: &PlanFile, played: &Played) -> Result<Vec<Object>, CannotSimulate> {
    let of_all = plan.scene.friction;
    plan.scene
        .objects
        .iter()
        .zip(&played.objects)
        .map(|(body, thing)| {
            let mass = body.mass.unwrap_or_else(|| DENSITY * volume(&thing.shapes));
            let friction = body.friction.or(of_all).unwrap_or(FRICTION);
            for (what, value) in [("a mass", mass), ("a friction", friction)] {
                if !(value.is_finite() && value > 0.0) {
                    let what = format!("{what} of {value}; expected a positive number");
                    return Err(CannotSimulate::Object { object: thing.id.clone(), what });
                }
            }
            let told = |ids: &[String]| ids.contains(&body.id);
            let assumed = Assumed {
                mass: body.mass.is_none() || told(&plan.assumed.mass),
                friction: body.friction.or(of_all).is_none() || told(&plan.assumed.friction),
            };
            let shapes = thing.shapes.clone();
            Ok(Object { shapes, world_from_object: thing.world_from_body, mass, friction, assumed })
        })
        .collect()
}

/// m³; parts that overlap count twice.
pub(crate) fn volume(shapes: &[PlayedShape]) -> f64 {
    shapes.iter().map(|s| s.shape.mass_properties(1.0).mass()).filter(|v| v.is_finite()).sum()
}
