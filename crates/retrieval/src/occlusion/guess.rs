//! Where to look: which object, taken away, is most worth it while the target is not seen.

use clearway_geometry::{Convex, Pose, Solid, Vec3, ray};
use clearway_plan::{ObjectId, ObjectSet};
use clearway_scene::{NOISE, Scene};
use clearway_sight::{Region, View, seen::ENOUGH};

/// How objects to look behind are chosen among those within reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Rule {
    /// The expected number of removals before the target is seen: each place where it could be votes for the objects
    /// known to be before it, the more the fewer of them there are, and the less hidden space in which there may be
    /// others. Something glimpsed behind an object counts as much as all places together.
    #[default]
    Expected,
    /// The paper's: the farthest from where the target comes out (Algorithm 4, line 4).
    Farthest,
    /// That of [3]: what hides the largest volume.
    Largest,
}

impl Rule {
    pub const ALL: [Rule; 3] = [Rule::Expected, Rule::Farthest, Rule::Largest];
}

/// Between places that are tried for the target, metres.
const GRID: f64 = 0.04;
/// The same where the coarser grid has no place: the last to be tried.
const FINE_GRID: f64 = 0.01;
/// One more object is expected for so much hidden space on a line, metres.
const SPACING: f64 = 0.20;
/// Points looked at across the target, and up it.
const ACROSS: [f64; 3] = [-0.8, 0.0, 0.8];
const UP: [f64; 4] = [-0.9, -0.3, 0.3, 0.9];

/// Somewhere the target could be.
#[derive(Clone, Debug)]
pub struct Place {
    /// Rid of these it would be in view; nothing, when no removal helps.
    pub behind: Option<ObjectSet>,
    /// Removals before it is in view, those of objects not known as yet estimated.
    pub removals: f64,
}

/// What may hide the target, and where it may stand.
pub struct Guess<'a> {
    view: &'a View,
    region: &'a Region,
    scene: &'a Scene,
    target: &'a Solid,
    bodies: Vec<Body<'a>>,
}

struct Body<'a> {
    solid: &'a Solid,
    pose: &'a Pose,
    /// `None`: it stays.
    object: Option<ObjectId>,
    low: Vec3,
    high: Vec3,
}

impl<'a> Guess<'a> {
    /// `target`: the object wanted, upright as it would stand.
    pub fn new(view: &'a View, region: &'a Region, scene: &'a Scene, target: &'a Solid) -> Self {
        let body = |solid: &'a Solid, pose: &'a Pose, object| {
            let (low, high) = solid.aabb(*pose);
            Body { solid, pose, object, low, high }
        };
        let objects = scene.objects.iter().enumerate().map(|(i, o)| body(&o.solid, &o.pose, Some(ObjectId(i as u16))));
        let bodies = objects.chain(scene.fixtures.iter().map(|f| body(&f.solid, &f.pose, None))).collect();
        Self { view, region, scene, target, bodies }
    }
}

impl Guess<'_> {
    /// All places, on a grid fine enough that there are some, where the target could be out of view. Empty: it is nowhere.
    pub fn places(&self, standing: &ObjectSet) -> Vec<Place> {
        let hidden = |places: &Vec<Place>| places.iter().any(|p| p.behind.is_some());
        let coarse = self.places_on(GRID, ENOUGH, standing);
        // What is hardly in view might not be seen for what it is.
        if hidden(&coarse) { coarse } else { self.places_on(FINE_GRID, 2.0 * ENOUGH, standing) }
    }

    /// All places on a grid where the target would stand clear of everything known and not be in view. `standing`: objects that
    /// could be taken away.
    fn places_on(&self, grid: f64, enough: f64, standing: &ObjectSet) -> Vec<Place> {
        let Region { low, high } = *self.region;
        let (own_low, own_high) = self.target.aabb(Pose::IDENTITY);
        let half = (own_high - own_low) / 2.0;
        let radius = half.x.min(half.y);
        let steps = |from: f64, to: f64| (((to - from) / grid).floor().max(0.0) as usize, from);
        let (nx, x0) = steps(low.x + radius, high.x - radius);
        let (ny, y0) = steps(low.y + radius, high.y - radius);
        let z = low.z + half.z;
        let mut places = Vec::new();
        for (i, j) in (0..=nx).flat_map(|i| (0..=ny).map(move |j| (i, j))) {
            let at = Vec3::new(x0 + i as f64 * grid, y0 + j as f64 * grid, z);
            if self.is_free(at, radius, half.z) && self.is_carried(at) {
                if let Some(behind) = self.behind(at, radius, half.z, enough, standing) {
                    places.push(Place { behind, removals: behind.map_or(0.0, |b| self.removals(at, &b)) });
                }
            }
        }
        places
    }

    /// Whether an upright core of the target is outside of all that is known: its axis, and eight lines round it.
    fn is_free(&self, at: Vec3, radius: f64, half: f64) -> bool {
        let line = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 8.0;
            if k == 8 { Vec3::ZERO } else { Vec3::new(angle.cos(), angle.sin(), 0.0) * (0.9 * radius) }
        };
        let points = (0..9).flat_map(|k| [-0.8, 0.0, 0.8].map(|up| at + line(k) + Vec3::Z * (up * half)));
        let reach = Vec3::new(radius, radius, half);
        let near = |b: &&Body| (at + reach).cmpge(b.low).all() && (at - reach).cmple(b.high).all();
        let near: Vec<&Body> = self.bodies.iter().filter(near).collect();
        points.into_iter().all(|p| near.iter().all(|b| b.solid.depth(b.pose.inverse_point(p)) <= 0.0))
    }

    /// Whether a fixture is under its middle.
    fn is_carried(&self, at: Vec3) -> bool {
        let foot = self.region.low.z;
        let under = at.with_z(foot + 0.01);
        self.scene
            .fixtures
            .iter()
            .any(|f| ray::meets_solid(&f.solid, &f.pose, under, -Vec3::Z).is_some_and(|t| t < 0.01 + 2.0 * NOISE))
    }

    /// What has to go for enough of it to be in view; `None`: it is in view already; `Some(None)`: nothing helps.
    fn behind(&self, at: Vec3, radius: f64, half: f64, enough: f64, standing: &ObjectSet) -> Option<Option<ObjectSet>> {
        let towards = (at - self.view.eye).with_z(0.0).normalize_or_zero();
        let across = Vec3::new(-towards.y, towards.x, 0.0);
        let mut needs: Vec<ObjectSet> = Vec::new();
        for (s, u) in ACROSS.iter().flat_map(|s| UP.iter().map(move |u| (s, u))) {
            let point = at + across * (s * radius) - towards * (radius * (1.0 - s * s).sqrt()) + Vec3::Z * (u * half);
            needs.extend(self.before(point, standing));
        }
        needs.sort_by_key(ObjectSet::len);
        let enough = (enough * (ACROSS.len() * UP.len()) as f64).ceil() as usize;
        let Some(all) = needs.get(..enough) else { return Some(None) };
        let behind = all.iter().fold(ObjectSet::EMPTY, |a, b| a.union(*b));
        (!behind.is_empty()).then_some(Some(behind))
    }

    /// Of the objects known to be before a place, and of those that may be there besides.
    fn removals(&self, at: Vec3, behind: &ObjectSet) -> f64 {
        let far = |p: Vec3| (p - self.view.eye).truncate().length();
        let extent = |o: ObjectId| {
            let object = &self.scene.objects[o.index()];
            let (low, high) = object.solid.aabb(object.pose);
            (far(object.pose.translation), (high - low).truncate().min_element())
        };
        let first = behind.iter().map(|o| extent(o).0).fold(f64::INFINITY, f64::min);
        let filled: f64 = behind.iter().map(|o| extent(o).1).sum();
        behind.len() as f64 + (far(at) - first - filled).max(0.0) / SPACING
    }

    /// The objects before a point; `None` when something that stays is.
    fn before(&self, point: Vec3, standing: &ObjectSet) -> Option<ObjectSet> {
        let line = point - self.view.eye;
        let (far, direction) = (line.length(), line.normalize_or_zero());
        if !self.view.holds(line) {
            return None;
        }
        let mut before = ObjectSet::EMPTY;
        for body in &self.bodies {
            // Whether the line comes near it at all.
            let (middle, around) = ((body.low + body.high) / 2.0 - self.view.eye, body.low.distance(body.high) / 2.0);
            let along = middle.dot(direction);
            if along - around > far || (middle - direction * along).length() > around {
                continue;
            }
            if ray::meets_solid(body.solid, body.pose, self.view.eye, direction).is_some_and(|t| t < far - 1e-3) {
                before.insert(body.object.filter(|o| standing.contains(*o))?);
            }
        }
        Some(before)
    }

    /// The objects to look behind, the most worthwhile first; `exit`: where the target comes out.
    pub fn ranked(&self, rule: Rule, places: &[Place], standing: &ObjectSet, exit: Vec3) -> Vec<ObjectId> {
        let all: f64 = places.iter().filter(|p| p.behind.is_some()).map(|p| 1.0 / p.removals).sum::<f64>().max(1e-9);
        let worth = |o: ObjectId| -> f64 {
            match rule {
                Rule::Expected => {
                    let votes = places.iter().filter(|p| p.behind.is_some_and(|b| b.contains(o)));
                    let chance = votes.map(|p| 1.0 / p.removals).sum::<f64>() / all;
                    // Something was glimpsed behind it: what is there may be the target, and is not empty space.
                    let glimpsed = self.scene.hidden.iter().filter(|h| h.behind == o && h.glimpsed).count();
                    chance + glimpsed as f64
                }
                Rule::Farthest => self.scene.objects[o.index()].pose.translation.truncate().distance(exit.truncate()),
                Rule::Largest => {
                    let own = self.scene.hidden.iter().filter(|h| h.behind == o);
                    own.map(|h| h.space.parts.iter().map(|(_, convex)| volume(convex)).sum::<f64>()).sum()
                }
            }
        };
        let mut ranked: Vec<(f64, ObjectId)> = standing.iter().map(|o| (worth(o), o)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        ranked.into_iter().map(|(_, o)| o).collect()
    }
}

/// Of a hull, cubic metres.
fn volume(convex: &Convex) -> f64 {
    let Convex::Hull(hull) = convex else { return 0.0 };
    let corner = |i: u32| hull.points[i as usize];
    hull.triangles.iter().map(|[a, b, c]| corner(*a).dot(corner(*b).cross(corner(*c))) / 6.0).sum::<f64>().abs()
}
