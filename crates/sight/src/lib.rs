//! What a camera sees of a scene, and what space it does not.
//!
//! An object is *seen* when at least a quarter of it is in view ([`seen::ENOUGH`]), by casting rays at exact
//! shapes. Space is *hidden* where the line from the camera meets something before, or leaves the
//! picture; it counts within a [`Region`] only, the room outside is taken as free. What every body
//! hides is a convex set, so hidden space is a list of hulls, each with what it is behind.
//!
//! The robot itself is not looked at: it is out of the picture when the camera looks.

pub mod seen;
pub mod shadow;
mod view;

pub use view::{Region, Standing, View, blind};

use clearway_geometry::Solid;
use seen::look_at;
use shadow::{Begins, out_of_view, shadow};

/// Of an object that is not seen: less in view than this is nothing.
const NOTHING: f64 = 0.002;
/// What an object hides begins so far behind it when it is taken, metres.
pub const BEHIND: f64 = 0.001;

/// Something that may be seen.
#[derive(Clone, Copy)]
pub struct Thing<'a> {
    pub standing: Standing<'a>,
    /// It was seen before.
    pub known: bool,
}

/// Space that is not in view, and that no known thing hides by itself.
#[derive(Clone, Debug)]
pub struct Hidden {
    /// The known thing to which it is due: something unknown is there, mostly behind it. `None`: a fixture hides
    /// it, or the picture ends.
    pub behind: Option<usize>,
    /// In the world.
    pub space: Solid,
}

/// One look.
#[derive(Clone, Debug, Default)]
pub struct Sight {
    /// The things not known before of which enough is in view.
    pub new: Vec<usize>,
    /// Besides what known things hide ([`shadow`](mod@shadow)).
    pub hidden: Vec<Hidden>,
}

/// Looks at what stands.
pub fn look(view: &View, region: &Region, fixtures: &[Standing], things: &[Thing]) -> Sight {
    let all: Vec<Standing> = things.iter().map(|t| t.standing).chain(fixtures.iter().copied()).collect();
    let mut sight = Sight::default();
    let mut hide = |behind: Option<usize>, space: Solid| {
        if !space.parts.is_empty() {
            sight.hidden.push(Hidden { behind, space });
        }
    };
    hide(None, out_of_view(view, region));
    for fixture in fixtures {
        hide(None, shadow(view, region, fixture.solid, fixture.pose, Begins::Front));
    }
    let mut partly = Vec::new();
    let mut new = Vec::new();
    for (index, thing) in things.iter().enumerate().filter(|(_, t)| !t.known) {
        let others: Vec<Standing> = all.iter().enumerate().filter(|(i, _)| *i != index).map(|(_, s)| *s).collect();
        let seen = look_at(view, thing.standing, &others);
        if seen.part >= seen::ENOUGH {
            new.push(index);
        } else if seen.part > NOTHING {
            // Numbers beyond the object itself are one less among the others.
            partly.push((index, seen.mostly_behind.map(|i| i + usize::from(i >= index))));
        }
    }
    let known = |index: usize| things.get(index).is_some_and(|t| t.known) || new.contains(&index);
    // Something is there, but not what.
    for (index, behind) in partly {
        let Standing { solid, pose } = things[index].standing;
        hide(behind.filter(|b| known(*b)), shadow(view, region, solid, pose, Begins::Front));
    }
    sight.new = new;
    sight
}
