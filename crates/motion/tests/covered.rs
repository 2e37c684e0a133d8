//! Robots of primitives and meshes, whose links spheres only cover: the links' own shapes decide.
#![allow(clippy::unwrap_used)]

use clearway_geometry::distance::closer_than;
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_motion::{MotionPlanner, MotionSettings, MotionValidator, Obstacle, Surroundings, Trees, between};
use clearway_plan::Budget;
use clearway_robot::{Group, Robot};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;

fn planner(name: &str) -> MotionPlanner {
    MotionPlanner::new(Group::from(&Robot::load(name, Path::new("."), &[]).unwrap()))
}

fn posture(planner: &MotionPlanner, random: &mut impl Rng) -> Vec<f64> {
    (0..planner.group.lower.len())
        .map(|j| {
            let (low, high) = planner.group.range(j);
            low + (high - low) * random.random::<f64>()
        })
        .collect()
}

fn around(random: &mut impl Rng) -> Vec<Obstacle> {
    (0..6)
        .map(|i| {
            let mut v = || random.random::<f64>() * 2.0 - 1.0;
            let (turn, angle) = ([v(), v(), v()], std::f64::consts::PI * v());
            let at = Vec3::new(0.75 * angle.cos(), 0.75 * angle.sin(), 0.6 + 0.5 * v());
            let convex = match i % 3 {
                0 => Convex::Box { half: Vec3::new(0.15, 0.1, 0.02) },
                1 => Convex::Cylinder { radius: 0.05, half: 0.15 },
                _ => Convex::Sphere { radius: 0.08 },
            };
            Obstacle { name: format!("o{i}"), root_from_solid: Pose::from_rpy(turn, at), solid: Solid::new(convex) }
        })
        .collect()
}

/// Whether any two exact shapes that are checked come closer than `margin`.
fn touches(planner: &MotionPlanner, obstacles: &[Obstacle], q: &[f64], margin: f64) -> bool {
    let group = &planner.group;
    let mut frames = Vec::new();
    group.kinematics.frames(q, group.hand[0], &mut frames);
    let parts = |l: usize| group.links[l].collision.parts.iter().map(|(p, c)| (frames[l] * *p, c)).collect::<Vec<_>>();
    let all: Vec<Vec<(Pose, &Convex)>> = (0..group.links.len()).map(parts).collect();
    let near = |a: &[(Pose, &Convex)], b: &[(Pose, &Convex)]| {
        a.iter().any(|(p, c)| b.iter().any(|(o, d)| closer_than(c, p, d, o, margin)))
    };
    let moved = |l: usize| group.kinematics.moved_by[l] != 0 || group.kinematics.moved_by_hand[l];
    let unchecked = &planner.unchecked;
    (0..all.len()).any(|a| {
        (a + 1..all.len()).any(|b| !unchecked.contains(&(a, b)) && near(&all[a], &all[b]))
            || moved(a)
                && obstacles.iter().any(|o| {
                    let own: Vec<(Pose, &Convex)> =
                        o.solid.parts.iter().map(|(p, c)| (o.root_from_solid * *p, c)).collect();
                    near(&all[a], &own)
                })
    })
}

#[test]
fn pairs_that_are_not_checked_never_touch_or_always_do() {
    for name in ["ur10_ag95", "panda"] {
        let planner = planner(name);
        let group = &planner.group;
        let mut random = Xoshiro256PlusPlus::seed_from_u64(1);
        let pairs: Vec<(usize, usize)> =
            planner.unchecked.iter().copied().filter(|&(a, b)| !group.adjacent(a, b)).collect();
        let mut touched = vec![0; pairs.len()];
        const POSTURES: usize = 3000;
        for _ in 0..POSTURES {
            let q = posture(&planner, &mut random);
            let mut frames = Vec::new();
            group.kinematics.frames(&q, group.hand[0], &mut frames);
            for (count, &(a, b)) in touched.iter_mut().zip(&pairs) {
                let hit = group.links[a].collision.parts.iter().any(|(p, c)| {
                    let others = &group.links[b].collision.parts;
                    others.iter().any(|(o, d)| closer_than(c, &(frames[a] * *p), d, &(frames[b] * *o), 0.0))
                });
                *count += usize::from(hit);
            }
        }
        for (count, (a, b)) in touched.into_iter().zip(pairs) {
            let names = (&group.links[a].name, &group.links[b].name);
            let named = group.disabled_pairs.contains(&(a, b));
            assert!(named || count == 0 || count == POSTURES, "{name}: {names:?} touch in {count} of {POSTURES}");
        }
    }
}

#[test]
fn a_posture_is_free_when_its_shapes_are() {
    for name in ["ur10_ag95", "panda"] {
        let planner = planner(name);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
        let (mut free, mut touching) = (0, 0);
        for _ in 0..40 {
            let obstacles = around(&mut random);
            let around = Surroundings::new(obstacles.clone());
            let settings = MotionSettings::default();
            let mut space = planner.space(&around, &settings);
            for _ in 0..25 {
                let q = posture(&planner, &mut random);
                let refused = planner.refusal(&q, &around, 0.0);
                if space.state_free(&q) {
                    assert!(!touches(&planner, &obstacles, &q, 0.0) && refused.is_none(), "{name} {q:?}");
                    free += 1;
                } else {
                    assert!(touches(&planner, &obstacles, &q, 3e-4), "{name} {q:?}");
                    touching += 1;
                }
                assert_eq!(refused.is_some(), touches(&planner, &obstacles, &q, 0.0), "{name} {q:?}: {refused:?}");
            }
        }
        assert!(free > 100 && touching > 100, "{name}: {free} free, {touching} not");
    }
}

#[test]
fn paths_are_free_in_the_exact_shapes() {
    for name in ["ur10_ag95", "panda"] {
        let planner = planner(name);
        let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
        let (mut asked, mut solved) = (0, 0);
        while asked < 20 {
            let obstacles = around(&mut random);
            let around = Surroundings::new(obstacles.clone());
            let settings = MotionSettings::default();
            let mut space = planner.space(&around, &settings);
            let (start, goal) = (posture(&planner, &mut random), posture(&planner, &mut random));
            if !space.state_free(&start) || !space.state_free(&goal) {
                continue;
            }
            asked += 1;
            let budget = Budget::unlimited().with_time(std::time::Duration::from_secs(20));
            let found = planner.plan(&mut space, &start, &[goal], &settings, &mut Trees::default(), &budget);
            let Ok(Some(found)) = found else { continue };
            solved += 1;
            for line in found.path.windows(2) {
                for i in 0..=400 {
                    let q = between(&line[0], &line[1], i as f64 / 400.0);
                    assert!(!touches(&planner, &obstacles, &q, 0.0), "{name}: {q:?}");
                }
            }
        }
        assert!(solved >= 19, "{name}: {solved} of {asked}");
    }
}
