//! The bound on travel is a bound; and the sweep agrees with brute force.

use super::touch::Touches;
use super::*;
use crate::meshes::Meshes;
use crate::shapes::{cuboid, sphere};
use crate::urdf;
use clearway_plan::plan_file::{Segment, SegmentKind};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use std::path::Path;

/// An arm of `n` joints, every fourth of them sliding, with crooked offsets and axes.
fn arm(n: usize, random: &mut Xoshiro256PlusPlus) -> Case {
    let mut text = "<robot name='arm'><link name='l0'/>".to_owned();
    for i in 0..n {
        let mut numbers = |size: f64| [(); 3].map(|()| random.random_range(-size..size).to_string()).join(" ");
        let kind = if i % 4 == 3 { "prismatic" } else { "revolute" };
        let (xyz, rpy, axis) = (numbers(0.4), numbers(3.0), numbers(1.0));
        let next = i + 1;
        text += &format!(
            "<joint name='j{i}' type='{kind}'><parent link='l{i}'/><child link='l{next}'/><origin xyz='{xyz}' rpy='{rpy}'/>\
             <axis xyz='{axis}'/><limit lower='-3' upper='3'/></joint><link name='l{next}'/>"
        );
    }
    let model = urdf::read(&(text + "</robot>"), &mut Meshes::new(&[], Path::new(""))).expect("a URDF");
    Case { model, world_from_root: Pose::IDENTITY, fixtures: Vec::new(), objects: Vec::new(), places: Vec::new() }
}

fn segment(rows: usize) -> Segment {
    Segment {
        kind: SegmentKind::Transit,
        times: (0..rows).map(|r| r as f64 * 0.02).collect(),
        positions: Vec::new(),
        gripper: Default::default(),
        attached: None,
    }
}

fn draw(random: &mut Xoshiro256PlusPlus, n: usize, size: f64) -> Vec<f64> {
    (0..n).map(|_| random.random_range(-size..size)).collect()
}

#[test]
fn nothing_travels_farther_than_its_bound() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(5);
    let mut nearest: f64 = 0.0;
    for _ in 0..300 {
        let n = random.random_range(1..8);
        let case = arm(n, &mut random);
        let from = draw(&mut random, n, 3.0);
        let size = if random.random_bool(0.5) { 0.05 } else { 1.0 };
        let to = from.iter().zip(draw(&mut random, n, size)).map(|(a, b)| a + b).collect();
        let held = segment(2);
        let track = Track { step: 0, index: 0, segment: &held, start: 0.0, postures: vec![from, to] };
        let piece = Piece::new(Pose::translation(0.1, -0.05, 0.2), cuboid([0.1, 0.2, 0.3]));
        let in_link = Pose::translation(0.0, 0.1, 0.0);
        let movers = [Mover { piece: &piece, motion: Motion::Link { link: n, link_from_owner: in_link } }];
        let mut sweep = Sweep::new(&case, &track, &movers);
        let mut travel = vec![vec![0.0; n + 1]];
        sweep.bound_travel(0, &mut travel);
        for _ in 0..100 {
            let (s, t) = (random.random_range(0.0..1.0), random.random_range(0.0..1.0));
            let corner = Vector::from([0.05, 0.1, 0.15].map(|h| if random.random_bool(0.5) { h } else { -h }));
            let point = in_link * piece.pose * corner;
            for (k, bound) in travel[0].iter().enumerate() {
                // Seen from the link above the nearest k joints.
                let mut at = |share: f64| {
                    let poses = sweep.poses(When { row: 0, fraction: share });
                    poses[n - k].inverse_transform_point(poses[n].transform_point(point))
                };
                let moved = (at(s) - at(t)).length();
                assert!(moved <= bound * (s - t).abs() + 1e-12, "{moved} > {bound} · {}", (s - t).abs());
                if k > 0 {
                    nearest = nearest.max(moved / (bound * (s - t).abs()));
                }
            }
        }
    }
    assert!(nearest > 0.5, "the bound is too wide to be of use: {nearest}");
}

/// The deepest overlap on a fine grid, against the sweep's verdict.
#[test]
fn agrees_with_brute_force() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(6);
    let (mut touching, mut clear) = (0, 0);
    for _ in 0..400 {
        let n = 6;
        let case = arm(n, &mut random);
        let (from, step) = (draw(&mut random, n, 3.0), draw(&mut random, n, 0.05));
        let rows = 6;
        let row = |r: usize| from.iter().zip(&step).map(|(a, b)| a + r as f64 * b).collect::<Vec<_>>();
        let held = segment(rows);
        let track = Track { step: 0, index: 0, segment: &held, start: 0.0, postures: (0..rows).map(row).collect() };
        let (piece, ball) =
            (Piece::new(Pose::IDENTITY, cuboid([0.05, 0.08, 0.2])), Piece::new(Pose::IDENTITY, sphere(0.03)));
        let movers = [
            Mover { piece: &piece, motion: Motion::Link { link: n, link_from_owner: Pose::IDENTITY } },
            Mover { piece: &piece, motion: Motion::Link { link: 2, link_from_owner: Pose::IDENTITY } },
        ];
        // Near where the last link passes.
        let near =
            case.link_poses(&row(2))[n].translation + Vector::from([(); 3].map(|()| random.random_range(-0.1..0.1)));
        let pairs = [
            Pair {
                first: 0,
                second: Other::Still { piece: &ball, world_from_owner: Pose::from_translation(near) },
                subject: 0,
            },
            Pair { first: 0, second: Other::Mover(1), subject: 1 },
        ];
        let mut sweep = Sweep::new(&case, &track, &movers);
        let mut touches = Touches::new(&pairs, vec![None, None]);
        sweep.run(&pairs, &mut [&mut touches], &Budget::unlimited()).expect("within budget");
        let found = touches.deepest(&mut sweep);
        for pair in &pairs {
            let mut probe = Sweep::new(&case, &track, &movers);
            let mut deepest = f64::NEG_INFINITY;
            for r in 0..rows - 1 {
                probe.between.clear();
                for i in 0..200 {
                    let when = When { row: r, fraction: f64::from(i) / 200.0 };
                    deepest = deepest.max(-probe.measure(pair, when, 1.0).gap.distance);
                }
            }
            let touch = found.iter().find(|t| t.subject == pair.subject);
            if deepest > 2e-4 {
                assert!(touch.is_some(), "missed an overlap of {deepest}");
                touching += 1;
            } else if deepest < 0.0 {
                assert!(touch.is_none(), "{touch:?}, but the nearest is {deepest}");
                clear += 1;
            }
        }
    }
    assert!(touching > 50 && clear > 50, "{touching} touch, {clear} do not");
}
