//! A moment as the kernel sees it: quick answers that err towards *touching*.
//!
//! What is called free here is free of the exact shapes, too, margins included, for the spheres
//! cover the links and what is held. Where the answer is *touching*, ask [`World`].

use crate::lanes::{Around, Kernel, LANES, Lanes, Obstacles, Piece, Scratch, Suspects, Upright, owner_link};
use crate::moment::{Held, Moment};
use crate::obstacle::Obstacle;
use crate::world::{Owner, World};
use clearway_geometry::Pose;
use std::sync::Arc;

/// What the kernel is asked with; a macro, so that only these fields are borrowed.
macro_rules! around {
    ($quick:expr) => {
        Around {
            obstacles: &$quick.obstacles,
            standing: &$quick.standing,
            margin: $quick.margin,
            hand: $quick.hand,
            upright: $quick.upright,
            never: &$quick.never,
        }
    };
}

/// An obstacle's parts, as the kernel takes them.
pub(crate) fn pieces(obstacle: &Obstacle, owner: usize) -> Vec<Piece> {
    Piece::of_solid(&obstacle.solid(), &Pose::IDENTITY, owner as u32).collect()
}

/// The world at one moment. Cheap to make: a microsecond per shape. What is held is left out where it
/// brings no kernel of its own.
pub struct Quick {
    kernel: Arc<Kernel>,
    obstacles: Arc<Obstacles>,
    standing: Vec<u16>,
    margin: f32,
    hand: f32,
    upright: Option<Upright>,
    never: Arc<Vec<Vec<u16>>>,
    pub scratch: Scratch,
    joints: Vec<Lanes>,
}

impl Drop for Quick {
    fn drop(&mut self) {
        self.kernel.give_back(std::mem::take(&mut self.scratch));
    }
}

impl Quick {
    /// The links alone, what is held left out.
    pub fn links(world: &World, moment: &Moment) -> Self {
        Self::of(world, moment, None)
    }

    pub fn new(world: &World, moment: &Moment) -> Self {
        Self::of(world, moment, moment.held.as_ref().and_then(|held| Some((held, held.kernel.as_ref()?))))
    }

    fn of(world: &World, moment: &Moment, held: Option<(&Held, &Arc<Kernel>)>) -> Self {
        let obstacles = if moment.placed.is_empty() {
            world.obstacles.clone()
        } else {
            let mut obstacles = Obstacles::clone(&world.obstacles);
            let placed = moment.placed.iter().zip(world.fixtures.len() + world.objects.len()..);
            obstacles.add(placed.flat_map(|((_, o), number)| pieces(o, number)).collect());
            Arc::new(obstacles)
        };
        let mut standing = Vec::new();
        let stands = |number: u32| match world.owner(number as usize) {
            _ if owner_link(number).is_some() => true,
            Owner::Standing(id) => moment.standing.contains(id),
            Owner::Fixture(_) | Owner::Placed(_) => true,
        };
        obstacles.mask(stands, &mut standing);
        let kernel = held.map_or(&world.model.kernel, |(_, kernel)| kernel).clone();
        let upright = moment.lean.map(|lean| {
            let seat = kernel.body.chain.seats[world.model.kinematics.tool];
            Upright {
                frame: seat.frame,
                axis: (seat.frame_from_link.rotation * lean.axis).to_array().map(|x| x as f32),
                upward: lean.upward.to_array().map(|x| x as f32),
                least: lean.least as f32,
            }
        });
        let mut never = world.never.clone();
        if let Some((held, _)) = held.filter(|_| moment.resting) {
            let below = |number: u32| match world.owner(number as usize) {
                _ if owner_link(number).is_some() => false,
                Owner::Fixture(index) => held.fixtures_below.contains(&index),
                Owner::Standing(id) => held.objects_below.contains(id),
                Owner::Placed(index) => {
                    moment.placed.get(index).is_some_and(|(id, _)| held.objects_below.contains(*id))
                }
            };
            let mut mask = Vec::new();
            obstacles.mask(below, &mut mask);
            // What is held comes after the links.
            Arc::make_mut(&mut never).resize(kernel.body.parts.len(), mask);
        }
        let joints = vec![Lanes::ZERO; world.model.kinematics.arm_joints];
        let scratch = kernel.lend();
        Self {
            kernel,
            obstacles,
            standing,
            margin: moment.margin as f32,
            hand: moment.hand as f32,
            upright,
            never,
            scratch,
            joints,
        }
    }

    /// Whether the posture is surely free.
    pub fn free(&mut self, q: &[f64]) -> bool {
        for (lanes, q) in self.joints.iter_mut().zip(q) {
            lanes.0 = [*q as f32; LANES];
        }
        let around = around!(self);
        self.kernel.configurations_free(&self.joints, &around, &mut self.scratch) != 0
    }

    /// Whether the straight motion is surely free, with at least `per_radian` samples per radian.
    pub fn motion_free(&mut self, a: &[f64], b: &[f64], per_radian: f64) -> bool {
        let around = around!(self);
        self.kernel.motion_free(a, b, per_radian, &around, &mut self.scratch)
    }

    /// What up to sixteen rows, and the straight lines between them, may touch; owners of obstacles
    /// are numbered fixtures first, then objects, then what was placed.
    pub fn rows_suspects(&mut self, rows: &[Vec<f64>], suspects: &mut Suspects) {
        let around = around!(self);
        self.kernel.rows_suspects(rows, &around, &mut self.scratch, suspects);
    }

    /// What up to sixteen postures may touch.
    pub fn suspects(&mut self, postures: &[Vec<f64>], suspects: &mut Suspects) {
        let around = around!(self);
        self.kernel.configurations_suspects(postures, &around, &mut self.scratch, suspects);
    }
}
