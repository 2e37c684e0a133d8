//! What stands around the robot, in the root frame: shapes in groups of sixteen, each group with
//! its boxes, so that one look tells which of sixteen obstacles a moving link could reach.
//!
//! Which obstacles stand is a mask beside this structure: clearing bits rebuilds nothing.

use super::shape::{Shape, from_boxes};
use super::vector::{LANES, Lanes, bits, splat};
use clearway_geometry::{Pose, Solid, Vec3};
use fearless_simd::{Simd, SimdBase};

/// Boxes of sixteen things.
#[derive(Clone, Debug)]
struct Group {
    min: [Lanes; 3],
    max: [Lanes; 3],
}

impl Group {
    fn of(boxes: &[(Vec3, Vec3)]) -> Group {
        // Lanes without a thing are never near.
        let mut group = Group { min: [Lanes::splat(f32::MAX); 3], max: [Lanes::splat(f32::MIN); 3] };
        for (lane, (min, max)) in boxes.iter().enumerate() {
            for axis in 0..3 {
                group.min[axis].0[lane] = (min[axis] - ROUNDING) as f32;
                group.max[axis].0[lane] = (max[axis] + ROUNDING) as f32;
            }
        }
        group
    }

    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, lo: [f32; 3], hi: [f32; 3], reach: f32) -> u32 {
        bits(from_boxes(simd, &self.min, &self.max, lo, hi).simd_le(splat(simd, reach * reach)))
    }
}

/// Larger than what is lost from f64 to f32 at arm's length, metres.
const ROUNDING: f64 = 1e-6;

/// Owners from here on are links of the robot that stand still.
const LINKS: u32 = 1 << 30;

/// The owner's number of a link that stands still.
pub fn link_owner(link: usize) -> u32 {
    LINKS + link as u32
}

/// The link of such a number.
pub fn owner_link(owner: u32) -> Option<usize> {
    owner.checked_sub(LINKS).map(|link| link as usize)
}

/// Shapes and who they belong to. The caller numbers the owners, below 2³⁰.
#[derive(Clone, Debug, Default)]
pub struct Obstacles {
    /// In the order of the groups.
    pub(super) shapes: Vec<Shape>,
    owners: Vec<u32>,
    groups: Vec<Group>,
    /// By group: the box that holds it.
    boxes: Vec<(Vec3, Vec3)>,
    /// Boxes of sixteen groups each.
    tops: Vec<Group>,
}

/// A solid or a cloud on its way into [`Obstacles`].
#[derive(Clone, Debug)]
pub struct Piece {
    pub shape: Shape,
    pub owner: u32,
    /// The axis-aligned box that holds it.
    pub min: Vec3,
    pub max: Vec3,
}

impl Piece {
    /// The convex parts of a solid.
    pub fn of_solid(solid: &Solid, root_from_solid: &Pose, owner: u32) -> impl Iterator<Item = Piece> {
        solid.parts.iter().map(move |(pose, convex)| {
            let pose = *root_from_solid * *pose;
            let (min, max) = Solid::new(convex.clone()).aabb(pose);
            Piece { shape: Shape::new(convex, &pose), owner, min, max }
        })
    }

    /// A point cloud in the root frame: balls of one radius, by sixteen neighbours each.
    pub fn of_points(points: &[Vec3], radius: f64, owner: u32) -> Vec<Piece> {
        let mut sorted = points.to_vec();
        let mut pieces = Vec::with_capacity(points.len().div_ceil(LANES));
        split(&mut sorted, &|p| *p, &mut |part| {
            let (min, max) = part.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
            let r = Vec3::splat(radius);
            pieces.push(Piece { shape: Shape::points(part, radius), owner, min: min - r, max: max + r });
        });
        pieces
    }
}

impl Obstacles {
    pub fn new(pieces: Vec<Piece>) -> Self {
        let mut obstacles = Self::default();
        obstacles.add(pieces);
        obstacles
    }

    /// Adds more, in groups of their own.
    pub fn add(&mut self, mut pieces: Vec<Piece>) {
        let mut groups = Vec::new();
        split(&mut pieces, &|p| (p.min + p.max) / 2.0, &mut |part| {
            groups.push((part.iter().map(|p| (p.min, p.max)).collect::<Vec<_>>(), part.len()));
        });
        // Every group but the last of a split may hold fewer than sixteen; slots are padded.
        let mut from = pieces.into_iter();
        for (_, count) in &groups {
            for lane in 0..LANES {
                let piece = if lane < *count { from.next() } else { None };
                self.owners.push(piece.as_ref().map_or(u32::MAX, |p| p.owner));
                self.shapes.push(piece.map_or(Shape::Sphere { centre: [0.0; 3], radius: 0.0 }, |p| p.shape));
            }
        }
        let hold = |boxes: &[(Vec3, Vec3)]| {
            boxes.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), (min, max)| (a.min(*min), b.max(*max)))
        };
        self.groups.extend(groups.iter().map(|(b, _)| Group::of(b)));
        self.boxes.extend(groups.iter().map(|(b, _)| hold(b)));
        self.tops = self.boxes.chunks(LANES).map(Group::of).collect();
    }

    /// Slots, among them those that are not used.
    pub fn slots(&self) -> usize {
        self.shapes.len()
    }

    /// Whose the shape in a slot is; `None` for a slot not used.
    pub fn owner(&self, slot: usize) -> Option<u32> {
        self.owners.get(slot).copied().filter(|&o| o != u32::MAX)
    }

    /// The link in a slot that stands still.
    #[inline(always)]
    pub(super) fn link(&self, slot: usize) -> Option<usize> {
        self.owner(slot).and_then(owner_link)
    }

    /// All that stand, where `stands` says so of the owner.
    pub fn mask(&self, stands: impl Fn(u32) -> bool, mask: &mut Vec<u16>) {
        mask.clear();
        mask.extend(self.owners.chunks(LANES).map(|group| {
            group.iter().enumerate().fold(0, |m, (i, &o)| if o != u32::MAX && stands(o) { m | 1 << i } else { m })
        }));
    }

    /// Calls `found` for every standing shape whose box is within `reach` of the box `lo..hi`.
    #[inline(always)]
    pub fn near<S: Simd>(
        &self,
        simd: S,
        lo: [f32; 3],
        hi: [f32; 3],
        reach: f32,
        standing: impl Fn(usize) -> u16,
        mut found: impl FnMut(usize),
    ) {
        for (t, top) in self.tops.iter().enumerate() {
            let mut groups =
                if self.groups.len() > 2 { top.near(simd, lo, hi, reach) } else { (1 << self.groups.len()) - 1 };
            while groups != 0 {
                let g = t * LANES + groups.trailing_zeros() as usize;
                groups &= groups - 1;
                let standing = u32::from(standing(g));
                if standing == 0 {
                    continue;
                }
                let mut slots = self.groups[g].near(simd, lo, hi, reach) & standing;
                while slots != 0 {
                    found(g * LANES + slots.trailing_zeros() as usize);
                    slots &= slots - 1;
                }
            }
        }
    }
}

/// Halves along the longest side until at most sixteen are left; neighbours stay together.
fn split<T>(items: &mut [T], at: &impl Fn(&T) -> Vec3, leaf: &mut impl FnMut(&[T])) {
    if items.len() <= LANES {
        if !items.is_empty() {
            leaf(items);
        }
        return;
    }
    let (min, max) = items.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), i| (a.min(at(i)), b.max(at(i))));
    let size = max - min;
    let axis = if size.x >= size.y && size.x >= size.z {
        0
    } else if size.y >= size.z {
        1
    } else {
        2
    };
    // A multiple of sixteen on the left keeps the leaves full.
    let half = (items.len() / 2).next_multiple_of(LANES).min(items.len() - 1);
    items.select_nth_unstable_by(half, |a, b| at(a)[axis].total_cmp(&at(b)[axis]));
    let (left, right) = items.split_at_mut(half);
    split(left, at, leaf);
    split(right, at, leaf);
}
