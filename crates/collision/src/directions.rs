//! Remembers, per pair of convex parts, the direction that last told them apart.
//!
//! A plain table without keys: two pairs that share a slot only give each other poor guesses, and
//! any guess is a valid start.

use clearway_geometry::{Convex, Pose, Vec3, distance::closer_than_along};

const SLOTS: usize = 1 << 11;

/// A shape, where it is, and its name.
type Named<'a> = (&'a Convex, &'a Pose, usize);

#[derive(Clone, Debug, Default)]
pub struct Directions {
    /// None before the first question: most who could ask never do.
    slots: Vec<Vec3>,
}

impl Directions {
    /// Whether two placed convex shapes are closer than `margin`.
    #[inline]
    pub fn closer_than(&mut self, a: Named, b: Named, margin: f64) -> bool {
        if self.slots.is_empty() {
            self.slots.resize(SLOTS, Vec3::ZERO);
        }
        let slot = a.2.wrapping_mul(0x9E37_79B1).wrapping_add(b.2.wrapping_mul(0x85EB_CA6B)) >> 7 & (SLOTS - 1);
        closer_than_along(a.0, a.1, b.0, b.1, margin, &mut self.slots[slot])
    }
}
