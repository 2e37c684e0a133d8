//! The kernel against plain f64 answers about the same spheres, on every level of instructions
//! that this machine has.
#![allow(clippy::unwrap_used)]

use clearway_collision::lanes::exact::{Contact, contact, unchecked_pairs};
use clearway_collision::lanes::{Around, Body, Kernel, LANES, Lanes, Obstacles, Piece, Settings, Suspects, levels};
use clearway_geometry::distance::closer_than;
use clearway_geometry::hull::convex_hull;
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_robot::{Group, Robot, Sphere, cover_link};
use rand::{Rng, RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;
use std::sync::Arc;

struct Case {
    group: Group,
    spheres: Vec<Vec<Sphere>>,
    unchecked: Vec<(usize, usize)>,
    body: Body,
}

fn cases() -> Vec<Case> {
    let case = |name: &str| {
        let group = Group::from(&Robot::load(name, Path::new("."), &[]).unwrap());
        let spheres: Vec<Vec<Sphere>> = group.links.iter().map(|l| cover_link(&l.collision)).collect();
        let mut unchecked = unchecked_pairs(&group, &spheres);
        leave_out_neighbours(&group, &spheres, &mut unchecked);
        let body = Body::new(&group, &spheres, &unchecked, &Settings::default());
        Case { group, spheres, unchecked, body }
    };
    vec![case("ur10_ag95"), case("panda")]
}

/// Covers stand out at the ends of links, where neighbours are never far: with those pairs nothing
/// would be free for the spheres alone.
fn leave_out_neighbours(group: &Group, spheres: &[Vec<Sphere>], unchecked: &mut Vec<(usize, usize)>) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(4);
    let mut often = std::collections::BTreeMap::new();
    const POSTURES: usize = 200;
    for _ in 0..POSTURES {
        let range = |j: usize| group.range(j);
        let q: Vec<f64> =
            (0..group.lower.len()).map(|j| range(j).0 + (range(j).1 - range(j).0) * random.random::<f64>()).collect();
        let mut found = unchecked.clone();
        while let Some(Contact::Links(a, b)) = contact(group, spheres, &found, &[], &q, 0.0) {
            *often.entry((a, b)).or_insert(0) += 1;
            found.push((a, b));
        }
    }
    unchecked.extend(often.into_iter().filter(|(_, count)| *count > POSTURES / 5).map(|(pair, _)| pair));
    unchecked.sort_unstable();
}

fn posture(case: &Case, random: &mut impl Rng) -> Vec<f64> {
    (0..case.group.lower.len())
        .map(|j| {
            let (low, high) = case.group.range(j);
            low + (high - low) * random.random::<f64>()
        })
        .collect()
}

fn near(q: &[f64], by: f64, random: &mut impl Rng) -> Vec<f64> {
    q.iter().map(|v| v + by * (random.random::<f64>() - 0.5)).collect()
}

/// One obstacle of every kind, about the robot.
fn obstacles(random: &mut impl Rng) -> Vec<(Pose, Convex)> {
    let mut at = || {
        let mut v = || random.random::<f64>() * 2.0 - 1.0;
        let place = Vec3::new(v(), v(), 0.7 + 0.6 * v());
        let place = if place.truncate().length() < 0.35 { place + Vec3::new(0.5, 0.5, 0.0) } else { place };
        Pose::from_rpy([3.0 * v(), 3.0 * v(), 3.0 * v()], place)
    };
    let corners: Vec<Vec3> = (0..12)
        .map(|i| Vec3::new((i as f64 * 1.7).sin() * 0.1, (i as f64 * 2.3).cos() * 0.08, (i as f64 * 0.9).sin() * 0.12))
        .collect();
    let shapes = vec![
        Convex::Sphere { radius: 0.09 },
        Convex::Capsule { radius: 0.05, half: 0.12 },
        Convex::Cylinder { radius: 0.06, half: 0.15 },
        Convex::Cylinder { radius: 0.15, half: 0.01 },
        Convex::Box { half: Vec3::new(0.25, 0.02, 0.1) },
        Convex::Box { half: Vec3::splat(0.06) },
        Convex::Hull(Arc::new(convex_hull(&corners).unwrap())),
    ];
    let mut all: Vec<(Pose, Convex)> = shapes.into_iter().map(|s| (at(), s)).collect();
    // A box along the root's axes takes another path through the code.
    all.push((Pose::from_translation(Vec3::new(0.7, 0.0, 0.3)), Convex::Box { half: Vec3::new(0.1, 0.4, 0.01) }));
    all
}

fn index(shapes: &[(Pose, Convex)]) -> (Obstacles, Vec<u16>) {
    let pieces = shapes.iter().enumerate().flat_map(|(i, (pose, convex))| {
        Piece::of_solid(&Solid::new(convex.clone()), pose, i as u32).collect::<Vec<_>>()
    });
    let obstacles = Obstacles::new(pieces.collect());
    let mut standing = Vec::new();
    obstacles.mask(|_| true, &mut standing);
    (obstacles, standing)
}

fn around<'a>(case: &Case, obstacles: &'a Obstacles, standing: &'a [u16]) -> Around<'a> {
    Around { obstacles, standing, margin: 0.0, hand: case.group.hand[0] as f32, upright: None, never: &[] }
}

fn lanes(q: &[f64]) -> Vec<Lanes> {
    q.iter().map(|v| Lanes::splat(*v as f32)).collect()
}

#[test]
fn a_configuration_is_free_exactly_when_no_sphere_touches() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let (mut free, mut hit) = (0, 0);
    for case in cases() {
        for round in 0..150 {
            let shapes = obstacles(&mut random);
            let (indexed, standing) = index(&shapes);
            for level in levels() {
                let kernel = Kernel::at_level(case.body.clone(), level);
                let mut scratch = kernel.scratch();
                let q = posture(&case, &mut random);
                let said =
                    kernel.configurations_free(&lanes(&q), &around(&case, &indexed, &standing), &mut scratch) != 0;
                let touches = |margin| contact(&case.group, &case.spheres, &case.unchecked, &shapes, &q, margin);
                // The root's own link is not moved by the kernel; it is the same in every posture.
                let of_root =
                    |c: Contact| matches!(c, Contact::Obstacle(l, _) if case.group.kinematics.moved_by[l] == 0);
                if said {
                    let found = touches(-1e-5).filter(|c| !of_root(*c));
                    assert!(found.is_none(), "{} round {round} {level:?}: {found:?} at {q:?}", case.group.robot);
                    free += 1;
                } else {
                    assert!(touches(5e-5).is_some(), "{} round {round} {level:?}: nothing at {q:?}", case.group.robot);
                    hit += 1;
                }
            }
        }
    }
    assert!(free > 100 && hit > 100, "{free} free, {hit} hit");
}

#[test]
fn a_free_motion_is_free_between_its_samples_and_clear_motions_are_free() {
    const FINER: usize = 64;
    let mut random = Xoshiro256PlusPlus::seed_from_u64(17);
    let (mut free, mut refused) = (0, 0);
    for case in cases() {
        for _ in 0..260 {
            let shapes = obstacles(&mut random);
            let (indexed, standing) = index(&shapes);
            let a = posture(&case, &mut random);
            let b = near(&a, 0.8, &mut random);
            let at = |t: f64| -> Vec<f64> { a.iter().zip(&b).map(|(a, b)| a + (b - a) * t).collect() };
            let length = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
            let samples = (length * 32.0).ceil() as usize * FINER / 4;
            let first = |margin: f64| {
                (0..=samples).find_map(|i| {
                    let q = at(i as f64 / samples as f64);
                    contact(&case.group, &case.spheres, &case.unchecked, &shapes, &q, margin)
                        .filter(|c| !matches!(c, Contact::Obstacle(l, _) if case.group.kinematics.moved_by[*l] == 0))
                })
            };
            let mut answers = Vec::new();
            for level in levels() {
                let kernel = Kernel::at_level(case.body.clone(), level);
                let mut scratch = kernel.scratch();
                // What was asked before must not matter.
                let around = around(&case, &indexed, &standing);
                kernel.motion_free(&b, &near(&b, 2.0, &mut random), 32.0, &around, &mut scratch);
                answers.push(kernel.motion_free(&a, &b, 32.0, &around, &mut scratch));
            }
            assert!(answers.windows(2).all(|w| w[0] == w[1]), "levels disagree: {answers:?}");
            if answers[0] {
                assert_eq!(first(-1e-5), None, "{}: from {a:?} to {b:?}", case.group.robot);
                free += 1;
            } else {
                // With a fifth of a millimetre to spare everywhere it would have been free.
                assert!(first(2e-4).is_some(), "{}: refused from {a:?} to {b:?}", case.group.robot);
                refused += 1;
            }
        }
    }
    assert!(free > 30 && refused > 30, "{free} free, {refused} refused");
}

/// What the kernel suspects of configurations among obstacles drawn at random.
fn each_suspected(seed: u64, mut check: impl FnMut(&Case, &[(Pose, Convex)], &[Vec<f64>], &Suspects)) {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    for case in cases() {
        let kernel = Kernel::new(case.body.clone());
        let mut scratch = kernel.scratch();
        for _ in 0..60 {
            let shapes = obstacles(&mut random);
            let (indexed, standing) = index(&shapes);
            let configurations: Vec<Vec<f64>> = (0..LANES).map(|_| posture(&case, &mut random)).collect();
            let mut suspects = Suspects::default();
            kernel.configurations_suspects(
                &configurations,
                &around(&case, &indexed, &standing),
                &mut scratch,
                &mut suspects,
            );
            check(&case, &shapes, &configurations, &suspects);
        }
    }
}

#[test]
fn suspects_hold_all_that_touches() {
    let mut found = 0;
    each_suspected(23, |case, shapes, configurations, suspects| {
        for (lane, q) in configurations.iter().enumerate() {
            for (number, shape) in shapes.iter().enumerate() {
                for link in 0..case.spheres.len() {
                    if case.group.kinematics.moved_by[link] == 0 || case.spheres[link].is_empty() {
                        continue;
                    }
                    let mut alone = vec![Vec::new(); case.spheres.len()];
                    alone[link] = case.spheres[link].clone();
                    let one = std::slice::from_ref(shape);
                    if contact(&case.group, &alone, &case.unchecked, one, q, 0.0).is_some() {
                        let known = suspects
                            .obstacles
                            .iter()
                            .any(|s| s.link == link && s.other == number && s.lanes >> lane & 1 == 1);
                        assert!(known, "{} touches {number} at {q:?}", case.group.links[link].name);
                        found += 1;
                    }
                }
            }
            let mut unchecked = case.unchecked.clone();
            while let Some(Contact::Links(a, b)) = contact(&case.group, &case.spheres, &unchecked, &[], q, 0.0) {
                let known = suspects.pairs.iter().any(|s| s.link == a && s.other == b && s.lanes >> lane & 1 == 1);
                assert!(known, "{} touches {} at {q:?}", case.group.links[a].name, case.group.links[b].name);
                unchecked.push((a, b));
                found += 1;
            }
        }
    });
    assert!(found > 200, "{found}");
}

#[test]
fn what_touches_without_doubt_touches_in_the_exact_shapes() {
    let (mut sure, mut suspected) = (0, 0);
    each_suspected(29, |case, shapes, configurations, suspects| {
        for (lane, q) in configurations.iter().enumerate() {
            let mut frames = Vec::new();
            case.group.kinematics.frames(q, case.group.hand[0], &mut frames);
            let parts = |link: usize| {
                let frame = frames[link];
                case.group.links[link].collision.parts.iter().map(move |(pose, c)| (frame * *pose, c))
            };
            for s in suspects.obstacles.iter().filter(|s| s.sure >> lane & 1 == 1) {
                assert!(s.lanes >> lane & 1 == 1);
                let (pose, convex) = &shapes[s.other];
                assert!(parts(s.link).any(|(p, c)| closer_than(c, &p, convex, pose, 0.0)), "{s:?} at {q:?}");
                sure += 1;
            }
            for s in suspects.pairs.iter().filter(|s| s.sure >> lane & 1 == 1) {
                let touch = parts(s.link).any(|(p, c)| parts(s.other).any(|(o, d)| closer_than(c, &p, d, &o, 0.0)));
                assert!(touch, "{s:?} at {q:?}");
                sure += 1;
            }
        }
        let all = suspects.obstacles.iter().chain(&suspects.pairs);
        suspected += all.map(|s| s.lanes.count_ones()).sum::<u32>();
    });
    assert!(sure > 200 && suspected > sure + 100, "{sure} of {suspected}");
}

#[test]
fn what_is_removed_is_gone_without_rebuilding() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(3);
    for case in cases() {
        let kernel = Kernel::new(case.body.clone());
        let mut scratch = kernel.scratch();
        let shapes = obstacles(&mut random);
        let (indexed, mut standing) = index(&shapes);
        for _ in 0..120 {
            let gone = random.random::<u32>();
            indexed.mask(|owner| gone >> owner & 1 == 0, &mut standing);
            let left: Vec<(Pose, Convex)> =
                shapes.iter().enumerate().filter(|(i, _)| gone >> i & 1 == 0).map(|(_, s)| s.clone()).collect();
            let (fresh, all) = index(&left);
            let a = posture(&case, &mut random);
            let b = near(&a, 1.0, &mut random);
            let masked = kernel.motion_free(&a, &b, 32.0, &around(&case, &indexed, &standing), &mut scratch);
            let built = kernel.motion_free(&a, &b, 32.0, &around(&case, &fresh, &all), &mut scratch);
            assert_eq!(masked, built);
        }
    }
}

#[test]
fn what_is_added_later_counts_like_the_rest() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(37);
    let case = &cases()[0];
    let kernel = Kernel::new(case.body.clone());
    let mut scratch = kernel.scratch();
    let (mut free, mut hit) = (0, 0);
    for _ in 0..60 {
        let shapes: Vec<(Pose, Convex)> = (0..4).flat_map(|_| obstacles(&mut random)).collect();
        let (whole, all) = index(&shapes);
        let (mut grown, mut standing) = index(&shapes[..7]);
        for (i, (pose, convex)) in shapes.iter().enumerate().skip(7) {
            grown.add(Piece::of_solid(&Solid::new(convex.clone()), pose, i as u32).collect());
        }
        grown.mask(|_| true, &mut standing);
        for _ in 0..20 {
            let a = posture(case, &mut random);
            let b = near(&a, 0.5, &mut random);
            let one = kernel.motion_free(&a, &b, 32.0, &around(case, &whole, &all), &mut scratch);
            let other = kernel.motion_free(&a, &b, 32.0, &around(case, &grown, &standing), &mut scratch);
            assert_eq!(one, other);
            if one { free += 1 } else { hit += 1 }
        }
    }
    assert!(free > 20 && hit > 20, "{free} free, {hit} hit");
}

#[test]
fn a_cloud_is_its_balls() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(31);
    let case = &cases()[0];
    let kernel = Kernel::new(case.body.clone());
    let mut scratch = kernel.scratch();
    let points: Vec<Vec3> = (0..150)
        .map(|_| {
            let mut v = || random.random::<f64>() - 0.5;
            Vec3::new(0.7 + 0.5 * v(), 1.6 * v(), 0.6 + v())
        })
        .collect();
    let cloud = Obstacles::new(Piece::of_points(&points, 0.015, 0));
    let balls: Vec<(Pose, Convex)> =
        points.iter().map(|p| (Pose::from_translation(*p), Convex::Sphere { radius: 0.015 })).collect();
    let (separate, standing) = index(&balls);
    let mut whole = Vec::new();
    cloud.mask(|_| true, &mut whole);
    let (mut free, mut hit) = (0, 0);
    for _ in 0..400 {
        let q = posture(case, &mut random);
        let one = kernel.configurations_free(&lanes(&q), &around(case, &cloud, &whole), &mut scratch);
        let other = kernel.configurations_free(&lanes(&q), &around(case, &separate, &standing), &mut scratch);
        assert_eq!(one, other);
        if one == 0 { hit += 1 } else { free += 1 }
    }
    assert!(free > 20 && hit > 20, "{free} {hit}");
}
