//! What the layer below the planners costs: forward kinematics, configurations, motions, inverse
//! kinematics; on the built-in robots, so that a fresh clone can run it.
//!
//! `cargo bench -p clearway-motion`; one thread. *elem/s* are configurations.

use clearway_collision::lanes::{LANES, Lanes};
use clearway_geometry::{Convex, Pose, Solid, Vec3};
use clearway_motion::{
    Halton, MotionPlanner, MotionSettings, MotionValidator, Obstacle, Posture, Sampler, SphereSpace, Surroundings,
    distance,
};
use clearway_robot::{Group, InverseKinematics, Kinematics, Robot, description::BUILT_IN};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;

/// Motions measured, and postures.
const COUNT: usize = 256;
/// Longest motion, radians of joint distance.
const RANGE: f64 = 1.0;

fn robot(name: &str) -> Robot {
    Robot::load(name, Path::new("."), &[]).unwrap_or_else(|e| panic!("{e}"))
}

/// A cabinet of five boards with three bottles and a ball, before the robot; the root frame.
fn cabinet() -> Surroundings {
    let board = |x, y, z| Convex::Box { half: Vec3::new(x, y, z) };
    let bottle = Convex::Cylinder { radius: 0.04, half: 0.13 };
    let things = [
        (board(0.3, 0.45, 0.01), [0.95, 0.0, 0.29]),
        (board(0.3, 0.45, 0.01), [0.95, 0.0, 0.79]),
        (board(0.3, 0.01, 0.25), [0.95, 0.46, 0.54]),
        (board(0.3, 0.01, 0.25), [0.95, -0.46, 0.54]),
        (board(0.01, 0.45, 0.25), [1.26, 0.0, 0.54]),
        (bottle.clone(), [0.75, 0.1, 0.43]),
        (bottle.clone(), [0.8, -0.12, 0.43]),
        (bottle, [0.95, 0.0, 0.43]),
        (Convex::Sphere { radius: 0.08 }, [0.4, 0.5, 0.7]),
    ];
    let obstacle = |(convex, at)| Obstacle {
        name: String::new(),
        root_from_solid: Pose::from_translation(Vec3::from_array(at)),
        solid: Solid::new(convex),
    };
    Surroundings::new(things.map(obstacle).to_vec())
}

/// The first postures of Halton's sequence.
fn postures(space: &SphereSpace, count: usize) -> Vec<Posture> {
    let mut sampler = Halton::new(space, 0);
    let sample = |_| {
        let mut q = vec![0.0; space.lower().len()];
        sampler.sample(&mut q);
        q
    };
    (0..count).map(sample).collect()
}

/// Motions of at most [`RANGE`] from free postures towards others: free ones, and others.
fn motions(space: &mut SphereSpace) -> [Vec<(Posture, Posture)>; 2] {
    let all = postures(space, 40 * COUNT);
    let mut found = [Vec::new(), Vec::new()];
    for w in all.windows(2) {
        if found.iter().all(|f| f.len() >= COUNT) {
            break;
        }
        let part = (RANGE / distance(&w[0], &w[1])).min(1.0);
        let to: Posture = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * part).collect();
        if space.state_free(&w[0]) {
            let free = space.motion_free(&w[0], &to);
            let kind = &mut found[usize::from(!free)];
            if kind.len() < COUNT {
                kind.push((w[0].clone(), to));
            }
        }
    }
    assert!(found.iter().all(|f| !f.is_empty()), "no motion of one kind");
    found
}

fn kernel(c: &mut Criterion) {
    for name in BUILT_IN {
        let robot = robot(name);
        let planner = MotionPlanner::new(Group::from(&robot));
        let around = cabinet();
        let mut space = planner.space(&around, &MotionSettings::default());
        let some = postures(&space, COUNT);
        let mut group = c.benchmark_group(name);

        group.throughput(Throughput::Elements(LANES as u64));
        let hand = planner.group.hand[0];
        let joints: Vec<Lanes> = (0..some[0].len())
            .map(|j| {
                let mut lanes = Lanes::ZERO;
                lanes.0.iter_mut().zip(&some).for_each(|(lane, q)| *lane = q[j] as f32);
                lanes
            })
            .collect();
        group.bench_function("forward kinematics, kernel, 16 at once", |b| {
            b.iter(|| planner.kernel.place(black_box(&joints), hand as f32, &mut space.scratch));
        });
        group.throughput(Throughput::Elements(1));
        let mut frames = Vec::new();
        group.bench_function("forward kinematics, f64", |b| {
            let mut next = some.iter().cycle();
            b.iter(|| planner.group.kinematics.frames(black_box(next.next().expect("endless")), hand, &mut frames));
        });
        group.bench_function("one configuration", |b| {
            let mut next = some.iter().cycle();
            b.iter(|| space.state_free(black_box(next.next().expect("endless"))));
        });
        for (kind, motions) in ["free motions", "motions that touch"].into_iter().zip(motions(&mut space)) {
            let before = space.scratch.configurations;
            for (a, b) in &motions {
                space.motion_free(a, b);
            }
            group.throughput(Throughput::Elements(space.scratch.configurations - before));
            group.bench_function(format!("{} {kind}", motions.len()), |b| {
                b.iter(|| motions.iter().filter(|(from, to)| space.motion_free(black_box(from), to)).count());
            });
        }
        group.finish();
    }
}

/// Many small things all about the arm, spread evenly, the nearest 0.35 m from its axis.
fn clutter(count: usize) -> Surroundings {
    let spread = |i: usize, by: f64| (0.5 + (i + 1) as f64 * by).fract();
    let thing = |i: usize| {
        let (angle, far, high) = (spread(i, 0.819_172_51), spread(i, 0.671_043_61), spread(i, 0.549_700_48));
        let angle = std::f64::consts::TAU * angle;
        let at = Vec3::new(angle.cos(), angle.sin(), 0.0) * (0.35 + 0.65 * far) + Vec3::Z * (1.3 * high - 0.2);
        let convex = match i % 3 {
            0 => Convex::Sphere { radius: 0.02 },
            1 => Convex::Cylinder { radius: 0.015, half: 0.03 },
            _ => Convex::Box { half: Vec3::new(0.02, 0.015, 0.01) },
        };
        let root_from_solid = Pose::from_rpy([angle, 3.0 * far, high], at);
        Obstacle { name: String::new(), root_from_solid, solid: Solid::new(convex) }
    };
    Surroundings::new((0..count).map(thing).collect())
}

/// The same free motions among ever more things.
fn obstacles(c: &mut Criterion) {
    let planner = MotionPlanner::new(Group::from(&robot("panda")));
    let settings = MotionSettings::default();
    let most = clutter(1000);
    let [free, _] = motions(&mut planner.space(&most, &settings));
    let mut group = c.benchmark_group("panda, the same free motions");
    for count in [20, 100, 1000] {
        let around = clutter(count);
        let mut space = planner.space(&around, &settings);
        assert!(free.iter().all(|(a, b)| space.motion_free(a, b)), "free among more, so among fewer");
        group.bench_function(format!("{} motions, {count} obstacles", free.len()), |b| {
            b.iter(|| free.iter().filter(|(from, to)| space.motion_free(black_box(from), to)).count());
        });
    }
    group.finish();
}

fn inverse(c: &mut Criterion) {
    let robot = robot("ur10_ag95");
    let kinematics = Kinematics::new(&robot);
    let planner = MotionPlanner::new(Group::from(&robot));
    let around = Surroundings::new(Vec::new());
    let space = planner.space(&around, &MotionSettings::default());
    let poses: Vec<Pose> = postures(&space, COUNT).iter().map(|q| kinematics.tool(q, robot.hand.ends()[0])).collect();
    let mut group = c.benchmark_group("ur10_ag95, inverse kinematics, all solutions");
    let methods = [
        ("closed form", InverseKinematics::new(&robot, &kinematics)),
        ("numeric", InverseKinematics::numeric(&robot, &kinematics)),
    ];
    for (name, solver) in methods {
        group.bench_function(name, |b| {
            let mut next = poses.iter().cycle();
            b.iter(|| solver.solve(black_box(next.next().expect("endless")), &robot.home));
        });
    }
    group.finish();
}

criterion_group!(benches, kernel, obstacles, inverse);
criterion_main!(benches);
