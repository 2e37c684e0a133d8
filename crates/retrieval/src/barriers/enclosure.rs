//! How high what the target is held by can be lifted while it is between a floor and a ceiling, and
//! what then stands in its way at any height.
//!
//! Upright, the target holds a cylinder of radius *r* and height *h*. Let it lean by no more than θ, where
//! sin θ = (r − [`SLACK`]) / h, and let *c* be the point on its axis r sin θ above its foot. Then the
//! level disc of radius *r* about *c* is in the target, and so is the upright line from *c* up over
//! f = h − r sin θ − [`SLACK`], and all within [`SLACK`] of it. So while *c* is between the floor
//! and the ceiling it is no higher than f below the ceiling, and what reaches from the floor up to there is in
//! the way of the disc, however high the target is lifted.

use super::planar::{Prism, Rounded};
use clearway_geometry::{Pose, Solid, Vec2};
use clearway_plan::proof;
use clearway_scene::{NOISE, Scene};

/// Metres: how far beyond floor and ceiling *c* may be all the same.
const SLACK: f64 = 0.0015;
/// Of that, by the side: at a corner it is 1.4 times as much.
const SIDE: f64 = 0.0007;
/// Overlaps that plans may have, and rounding, metres.
const EXACT: f64 = 2e-4;

/// Where the target is shut in.
pub struct Enclosure {
    /// The target's axis from above.
    pub target: Vec2,
    pub radius: f64,
    height: f64,
    lean: f64,
    floor: (usize, f64),
    ceiling: (usize, f64),
    /// Under the ceiling, over the floor.
    region: Rounded,
}

impl Enclosure {
    /// `None` where the target can be lifted out, has no upright core, or could be put down inside.
    pub fn of(scene: &Scene) -> Option<Self> {
        let object = &scene.objects[scene.target.index()];
        let (core, target, radius) = prisms(&object.solid, &object.pose)
            .map(|prism| {
                let (centre, radius) = prism.inscribed();
                (prism, centre, radius)
            })
            .max_by(|a, b| a.2.total_cmp(&b.2))?;
        let height = core.top - core.bottom;
        let above_below = |fixture: usize| {
            let fixture = &scene.fixtures[fixture];
            prisms(&fixture.solid, &fixture.pose).filter(|p| p.outline.holds(target)).collect::<Vec<_>>()
        };
        let all = || (0..scene.fixtures.len()).flat_map(|f| above_below(f).into_iter().map(move |p| (f, p)));
        let floor = all().filter(|(_, p)| p.top <= core.bottom + NOISE).max_by(|a, b| a.1.top.total_cmp(&b.1.top))?;
        let ceiling =
            all().filter(|(_, p)| p.bottom >= core.top - NOISE).min_by(|a, b| a.1.bottom.total_cmp(&b.1.bottom))?;
        let region = floor.1.outline.clipped(&ceiling.1.outline, 0.0)?;
        let sine = (radius - SLACK) / height;
        let places_outside = scene.places.iter().all(|place| {
            let half = place.size / 2.0;
            let area = Rounded::rectangle(place.centre.truncate(), half.with_y(0.0), half.with_x(0.0));
            let (p, q) = region.nearest(&area);
            p.distance(q) > 2.0 * SLACK
        });
        (sine > 0.0 && sine < 1.0 && places_outside).then(|| Self {
            target,
            radius,
            height,
            lean: sine.asin(),
            floor: (floor.0, floor.1.top),
            ceiling: (ceiling.0, ceiling.1.bottom),
            region,
        })
    }

    /// How near the chain runs to its bodies.
    pub fn reach(&self) -> f64 {
        self.radius - EXACT
    }

    /// What of a prism the target does not get over.
    pub fn barred(&self, prism: &Prism) -> Option<Rounded> {
        let foot = self.radius * self.lean.sin();
        let lowest = self.floor.1 + foot * self.lean.cos();
        let highest = self.ceiling.1 - (self.height - foot - SLACK);
        if prism.bottom > lowest - EXACT || prism.top < highest + EXACT {
            return None;
        }
        let outline = prism.outline.clipped(&self.region, SIDE)?;
        (outline.distance(self.target) > outline.radius + self.reach()).then_some(outline)
    }

    pub fn inside(&self, p: Vec2) -> bool {
        Rounded { corners: vec![p], radius: 0.0 }.clipped(&self.region, SIDE).is_some()
    }

    pub fn told(&self, scene: &Scene) -> proof::Enclosure {
        let level = |(fixture, z): (usize, f64)| proof::Level { fixture: scene.fixtures[fixture].id.clone(), z };
        proof::Enclosure {
            radius: self.radius,
            height: self.height,
            lean: self.lean,
            floor: level(self.floor),
            ceiling: level(self.ceiling),
        }
    }
}

/// The upright parts of a solid.
pub fn prisms(solid: &Solid, pose: &Pose) -> impl Iterator<Item = Prism> {
    solid.parts.iter().filter_map(move |(part, convex)| Prism::of(convex, &(*pose * *part)))
}
