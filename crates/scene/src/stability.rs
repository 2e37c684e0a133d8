//! What stands stays standing: no stack of a scene falls over by itself.
//!
//! Bodies are rigid, solid and of one density, since a scene file tells no masses. They push each other
//! up and down only, and fixtures bear anything: friction may keep things from sliding, but is not asked
//! to keep them from falling. Then a stack stands when there are forces, each within the area in which
//! two bodies touch, that balance all of its bodies. A block may stand by itself and tip under a load on
//! its overhang; two may carry one; a counterweight may hold what would fall without it. What rolls is
//! not looked at: a ball on a board stands.
//!
//! Half a millimetre past an edge is forgiven as noise. Areas are good to a tenth of that.

use crate::contact::Placed;
use crate::equilibrium::{Fall, Push, Weight, fall};
use crate::patch::patch;
use crate::source::Source;
use crate::support::Resting;
use crate::{FORGIVEN, Fixture};
use clearway_files::{FileError, quoted};
use clearway_geometry::{Mass, Pose, Vec2, polygon};

/// This far (metres) outside of what carries it, a centre of mass is still taken to be at the edge.
pub const EDGE: f64 = 0.0005;
/// Names in a message before it says how many more there are.
const NAMES: usize = 3;

/// A body's weight where it stands.
pub(crate) fn weight(mass: &Mass, pose: &Pose) -> Weight {
    // Whatever is there weighs something.
    Weight { mass: mass.volume.max(1e-18), centre: pose.point(mass.centre).truncate() }
}

/// Where fixtures carry a body.
pub(crate) fn on_fixtures<'p>(a: &Placed, fixtures: impl Iterator<Item = &'p Placed<'p>>, within: f64) -> Vec<Vec2> {
    polygon::hull(fixtures.flat_map(|b| patch(a, b, within)).collect())
}

/// An error if something falls.
pub(crate) fn check(
    source: &Source,
    objects: &[Resting],
    placed: &[Placed],
    fixtures: &[Fixture],
    placed_fixtures: &[Placed],
) -> Result<(), FileError> {
    let bodies: Vec<Weight> = objects.iter().map(|o| weight(&o.mass, &o.pose)).collect();
    let mut pushes: Vec<Push> = Vec::new();
    for (i, a) in placed.iter().enumerate() {
        let mut push = |lower, patch: Vec<Vec2>| {
            if !patch.is_empty() {
                pushes.push(Push { upper: i, lower, patch });
            }
        };
        push(None, on_fixtures(a, placed_fixtures.iter(), FORGIVEN));
        for (j, b) in placed.iter().enumerate().filter(|(j, _)| *j != i) {
            push(Some(j), patch(a, b, FORGIVEN));
        }
    }
    let Some(found) = fall(&bodies, &pushes, EDGE) else { return Ok(()) };
    let scene = Told { objects, placed, fixtures, placed_fixtures, pushes: &pushes };
    Err(scene.error(source, &found))
}

/// What a message is made of.
struct Told<'a> {
    objects: &'a [Resting],
    placed: &'a [Placed<'a>],
    fixtures: &'a [Fixture],
    placed_fixtures: &'a [Placed<'a>],
    pushes: &'a [Push],
}

impl Told<'_> {
    fn error(&self, source: &Source, found: &Fall) -> FileError {
        let object = &self.objects[found.body];
        let keys = format!("objects.{}.position", found.body);
        let (id, under) = (quoted(&object.id), self.under(found.body));
        let upon = names(self.pushes.iter().filter(|p| p.lower == Some(found.body)).map(|p| &self.objects[p.upper].id));
        let millimetres = |(from, to): (Vec2, Vec2)| 1000.0 * from.distance(to);
        let error = match found.aside {
            _ if found.loaded => source.error(&keys, format!("object {id} does not stand with {upon} on it")),
            Some(aside) => {
                let by = millimetres(aside);
                source.error(
                    &keys,
                    format!(
                        "object {id} is not stable: its centre of mass is {by:.1} mm outside what carries it ({under})"
                    ),
                )
            }
            None => source.error(&keys, format!("object {id} is not stable: what it touches does not carry it")),
        };
        let help = match found.aside {
            Some(aside) if found.loaded => {
                let by = millimetres(aside);
                format!(
                    "together their centre of mass is {by:.1} mm outside what carries them ({under}): move them, or put something under them"
                )
            }
            _ if found.loaded => format!("move {upon}, or put something under {id}"),
            Some(aside) => match self.beside(found.body, aside.1 - aside.0) {
                Some(pose) => {
                    let [x, y, z] = pose.translation.to_array();
                    format!("at [{x:.4}, {y:.4}, {z:.4}] it would stand; or put something under it")
                }
                None => "lay it on a face, or put something under it".to_owned(),
            },
            None => "lay it on something flat, or put something under it".to_owned(),
        };
        error.expected("objects that stand by themselves, taken as solid and of one density").help(help)
    }

    /// What carries an object.
    fn under(&self, body: usize) -> String {
        let objects =
            self.pushes.iter().filter(|p| p.upper == body).filter_map(|p| p.lower).map(|j| &self.objects[j].id);
        let touches = |b: &Placed| !patch(&self.placed[body], b, FORGIVEN).is_empty();
        let fixtures = self.fixtures.iter().zip(self.placed_fixtures).filter(|(_, b)| touches(b)).map(|(f, _)| &f.id);
        names(objects.chain(fixtures))
    }

    /// Where the object would stand, if moving it by so much helps.
    fn beside(&self, body: usize, by: Vec2) -> Option<Pose> {
        let object = &self.objects[body];
        let pose = Pose::new(object.pose.rotation, object.pose.translation + by.extend(0.0));
        let there = Placed::new(&object.solid, pose);
        let others = self.placed.iter().enumerate().filter(|(j, _)| *j != body).map(|(_, b)| b);
        let patch = on_fixtures(&there, others.chain(self.placed_fixtures), FORGIVEN);
        let centre = weight(&object.mass, &pose).centre;
        polygon::nearest(&patch, centre).filter(|p| p.distance(centre) <= EDGE).map(|_| pose)
    }
}

fn names<'s>(all: impl Iterator<Item = &'s String>) -> String {
    let all: Vec<&String> = all.collect();
    let mut shown: Vec<String> = all.iter().take(NAMES).map(|id| quoted(id)).collect();
    if all.len() > NAMES {
        shown.push(format!("{} more", all.len() - NAMES));
    }
    match shown.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
        _ => shown.concat(),
    }
}
