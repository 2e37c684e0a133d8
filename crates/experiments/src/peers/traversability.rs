//! The traversability graph: a planner that decides what to remove from discs alone, without an arm.
//!
//! Nam et al., "Fast and resilient manipulation planning for target retrieval in clutter" (ICRA
//! 2020), and its successors; built anew from a description of the rules. Two bodies share an edge
//! when a disc as large as the largest object can set out from either toward the other: of the 1°
//! sectors within 15° of the direction, one is left open by all that stands no farther than the
//! other body (VFH+). What to remove is read off a least-hop path from the robot to the target.
//!
//! Seen from above: metres in the plane of the workspace, angles in degrees.
//!
//! Where the rules are loose, these readings give all results known of the tests' first scene:
//! * The two bodies of a pair are no obstacles to each other (else no pair has an edge); all others
//!   are, the robot among them.
//! * 30 sectors with centres at odd multiples of 0.5°; an obstacle shuts those whose centre lies
//!   within its half-angle, border included. Of 31 sectors at whole degrees, the outermost would
//!   let through the edge 1–7, which should not be.
//! * Wall discs are centred on the walls, ends included, evenly, at most two mean radii apart. Set
//!   back they would let through 2–4; half a step from the ends they would shut 4–9.
//! * "No farther" is measured from centre to centre.
//!
//! The scene leaves open whether the robot is an obstacle (it is, as the rules are worded), and
//! whose radii make the mean and the largest: here those of the objects that stand.

use clearway_geometry::Vec2;
use clearway_plan::{ObjectId, ObjectSet};

const SECTORS: usize = 30;
const ALL_SHUT: u32 = (1 << SECTORS) - 1;
/// From the direction to the centre of the first sector, in degrees.
const FIRST_CENTRE: f64 = -14.5;
/// What an obstacle's radius grows by, apart from the moving body's: a distance kept, and a margin.
const CLEARANCE: f64 = 0.05 + 0.001;
/// Keeps the number of wall discs finite when the objects have next to no radius.
const LEAST_SPACING: f64 = 0.001;

/// An object or the robot, seen from above.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    pub at: Vec2,
    pub radius: f64,
}

/// One side of a rectangle along the axes, counterclockwise from the left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    MinX,
    MinY,
    MaxX,
    MaxY,
}

/// The workspace box seen from above. All its sides but one are walls.
#[derive(Clone, Copy, Debug)]
pub struct Workspace {
    pub min: Vec2,
    pub max: Vec2,
    pub open: Side,
}

impl Workspace {
    /// The ends of the three walls, one after the other.
    fn corners(&self) -> [Vec2; 4] {
        let around = [self.min, Vec2::new(self.max.x, self.min.y), self.max, Vec2::new(self.min.x, self.max.y)];
        std::array::from_fn(|i| around[(self.open as usize + i) % 4])
    }

    /// Appends the walls as chains of discs.
    fn add_walls(&self, mean_radius: f64, discs: &mut Vec<Disc>) {
        let spacing = (2.0 * mean_radius).max(LEAST_SPACING);
        let radius = std::f64::consts::SQRT_2 * mean_radius;
        let corners = self.corners();
        discs.push(Disc { at: corners[0], radius });
        for wall in corners.windows(2) {
            let steps = (wall[0].distance(wall[1]) / spacing).ceil() as usize;
            discs.extend((1..=steps).map(|i| Disc { at: wall[0].lerp(wall[1], i as f64 / steps as f64), radius }));
        }
    }
}

/// A disc as seen from the centre of another.
struct View {
    /// Its place in the list of discs.
    disc: usize,
    distance: f64,
    bearing: f64,
    /// Half of the angle that it shuts.
    half_angle: f64,
}

/// Lists all other discs as seen from disc `from`, the nearest first. `reach`: what radii grow by.
fn look_around(discs: &[Disc], from: usize, reach: f64, views: &mut Vec<View>) {
    views.clear();
    let eye = discs[from].at;
    views.extend(discs.iter().enumerate().filter(|&(i, _)| i != from).map(|(disc, d)| {
        let (offset, radius) = (d.at - eye, d.radius + reach);
        let distance = offset.length();
        let half_angle = if distance < radius { 90.0 } else { (radius / distance).asin().to_degrees() };
        View { disc, distance, bearing: offset.y.atan2(offset.x).to_degrees(), half_angle }
    }));
    views.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance));
}

/// Whether a sector toward `views[goal]` stays open.
fn sector_open(views: &[View], goal: usize) -> bool {
    let goal_view = &views[goal];
    let mut shut = 0;
    for (i, view) in views.iter().enumerate() {
        if view.distance > goal_view.distance {
            break;
        }
        if i != goal {
            shut |= sectors_shut(view.bearing - goal_view.bearing, view.half_angle);
            if shut == ALL_SHUT {
                return false;
            }
        }
    }
    true
}

/// The sectors, as bits, with a centre within `half_angle` of `offset` from the direction.
fn sectors_shut(offset: f64, half_angle: f64) -> u32 {
    let offset = offset - 360.0 * (offset / 360.0).round() - FIRST_CENTRE;
    let first = (offset - half_angle).ceil().max(0.0);
    let last = (offset + half_angle).floor().min((SECTORS - 1) as f64);
    if first > last { 0 } else { (ALL_SHUT << first as u32) & (ALL_SHUT >> (SECTORS as u32 - 1 - last as u32)) }
}

/// The graph: undirected, unweighted.
pub struct Traversability {
    /// Of all objects, also of those that do not stand.
    centres: Vec<Vec2>,
    robot: Vec2,
    /// The objects next to each object.
    neighbours: Vec<ObjectSet>,
    reachable: ObjectSet,
}

impl Traversability {
    /// The graph among the objects that stand (indices into `objects`) and the robot.
    pub fn new(objects: &[Disc], standing: &ObjectSet, robot: Disc, workspace: &Workspace) -> Self {
        let mut graph = Self {
            centres: objects.iter().map(|o| o.at).collect(),
            robot: robot.at,
            neighbours: vec![ObjectSet::EMPTY; objects.len()],
            reachable: ObjectSet::EMPTY,
        };
        if standing.is_empty() {
            return graph;
        }
        // The robot is disc 0, object `ids[i]` is disc i + 1, and the walls come last.
        let ids: Vec<ObjectId> = standing.iter().collect();
        let mut discs = vec![robot];
        discs.extend(ids.iter().map(|id| objects[id.index()]));
        let largest = discs[1..].iter().map(|d| d.radius).fold(0.0, f64::max);
        let mean = discs[1..].iter().map(|d| d.radius).sum::<f64>() / ids.len() as f64;
        workspace.add_walls(mean, &mut discs);

        let bodies = ids.len() + 1;
        // Whether `from` may set out toward `to`, at `from * bodies + to`.
        let mut free = vec![false; bodies * bodies];
        let mut views = Vec::with_capacity(discs.len());
        for from in 0..bodies {
            look_around(&discs, from, CLEARANCE + largest, &mut views);
            for (goal, view) in views.iter().enumerate().filter(|(_, v)| v.disc < bodies) {
                let to = view.disc;
                if from < to {
                    free[from * bodies + to] = sector_open(&views, goal);
                } else if free[to * bodies + from] && sector_open(&views, goal) {
                    graph.connect(ids[from - 1], to.checked_sub(1).map(|i| ids[i]));
                }
            }
        }
        graph
    }

    /// Adds the edge between `a` and `b`, or between `a` and the robot.
    fn connect(&mut self, a: ObjectId, b: Option<ObjectId>) {
        let Some(b) = b else { return self.reachable.insert(a) };
        self.neighbours[a.index()].insert(b);
        self.neighbours[b.index()].insert(a);
    }

    /// Every edge once, the smaller index first; the robot's index is the number of objects.
    pub fn edges(&self) -> impl Iterator<Item = (usize, usize)> {
        let robot = self.neighbours.len();
        let of = |(a, next): (usize, &ObjectSet)| next.iter().map(move |b| (a, b.index())).filter(|(a, b)| a < b);
        let to_robot = self.reachable.iter().map(move |a| (a.index(), robot));
        self.neighbours.iter().enumerate().flat_map(of).chain(to_robot)
    }

    /// All objects with an edge to the robot.
    pub fn reachable(&self) -> ObjectSet {
        self.reachable
    }

    /// The least-hop path from the robot to `target`, of equals the shortest: objects in order, the
    /// target last. `closed`: the edges from the robot into these are deleted (motion failed).
    pub fn path(&self, target: ObjectId, closed: &ObjectSet) -> Option<Vec<ObjectId>> {
        let mut layer = self.reachable.difference(*closed);
        let mut reached = layer;
        // The length of the best path to each object that was reached, and the object before it.
        let mut best: Vec<(f64, Option<ObjectId>)> =
            self.centres.iter().map(|c| (c.distance(self.robot), None)).collect();
        while !layer.contains(target) {
            if layer.is_empty() {
                return None;
            }
            let mut next = ObjectSet::EMPTY;
            for a in layer.iter() {
                for b in self.neighbours[a.index()].difference(reached).iter() {
                    let length = best[a.index()].0 + self.centres[a.index()].distance(self.centres[b.index()]);
                    if !next.contains(b) || length < best[b.index()].0 {
                        best[b.index()] = (length, Some(a));
                    }
                    next.insert(b);
                }
            }
            reached = reached.union(next);
            layer = next;
        }
        let mut path: Vec<ObjectId> = std::iter::successors(Some(target), |id| best[id.index()].1).collect();
        path.reverse();
        Some(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Workspace =
        Workspace { min: Vec2::new(0.063, -0.06575), max: Vec2::new(0.583, 0.51775), open: Side::MinY };
    const ROBOT: Disc = Disc { at: Vec2::new(0.323, -0.06575), radius: 0.03 };

    fn fixture() -> Vec<Disc> {
        let radii = [0.025, 0.026, 0.03, 0.028, 0.026, 0.025, 0.03, 0.03, 0.029, 0.025];
        let x = [0.475, 0.306, 0.475, 0.36405, 0.306, 0.171, 0.43005, 0.20405, 0.209, 0.171];
        let y = [0.19475, 0.14075, 0.36975, 0.26625, 0.40975, 0.16075, 0.27425, 0.28725, 0.04225, 0.38375];
        (0..10).map(|i| Disc { at: Vec2::new(x[i], y[i]), radius: radii[i] }).collect()
    }

    fn build(objects: &[Disc], standing: &ObjectSet) -> Traversability {
        Traversability::new(objects, standing, ROBOT, &BOX)
    }

    /// Up to 24 discs anywhere in the box, from a linear congruence.
    fn random_scene(seed: u64) -> Vec<Disc> {
        let mut state = seed;
        let mut draw = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let extent = BOX.max - BOX.min;
        let disc = |_| Disc { at: BOX.min + extent * Vec2::new(draw(), draw()), radius: 0.02 + 0.01 * draw() };
        (0..seed as usize % 25).map(disc).collect()
    }

    fn sorted(edges: impl Iterator<Item = (usize, usize)>) -> Vec<(usize, usize)> {
        let mut edges: Vec<_> = edges.map(|(a, b)| (a.min(b), a.max(b))).collect();
        edges.sort_unstable();
        edges
    }

    #[test]
    fn the_known_scene_comes_out() {
        let graph = build(&fixture(), &ObjectSet::first(10));
        assert_eq!(graph.reachable(), [0, 1, 8].into_iter().map(ObjectId).collect());
        assert_eq!(graph.edges().count(), 16);
        let paths: [&[u16]; 10] =
            [&[0], &[1], &[0, 6, 2], &[1, 3], &[1, 3, 4], &[8, 5], &[0, 6], &[8, 5, 7], &[8], &[8, 5, 7, 9]];
        for (target, expected) in (0..).map(ObjectId).zip(paths) {
            let path = graph.path(target, &ObjectSet::EMPTY).unwrap_or_default();
            assert_eq!(path.iter().map(|id| id.0).collect::<Vec<_>>(), expected);
        }
        let eight = ObjectSet::of(ObjectId(8));
        assert_eq!(graph.path(ObjectId(8), &eight), Some(vec![ObjectId(1), ObjectId(8)]));
        assert_eq!(graph.path(ObjectId(8), &graph.reachable()), None);
    }

    #[test]
    fn the_open_side_may_be_any() {
        // A quarter turn to the left carries (x, y) to (-y, x).
        let (mut workspace, mut robot, mut objects) = (BOX, ROBOT, fixture());
        for open in [Side::MaxX, Side::MaxY, Side::MinX, Side::MinY] {
            let (min, max) = (workspace.min.perp(), workspace.max.perp());
            workspace = Workspace { min: min.min(max), max: min.max(max), open };
            robot.at = robot.at.perp();
            objects.iter_mut().for_each(|o| o.at = o.at.perp());
            let turned = Traversability::new(&objects, &ObjectSet::first(10), robot, &workspace);
            assert_eq!(sorted(turned.edges()), sorted(build(&fixture(), &ObjectSet::first(10)).edges()));
        }
    }

    #[test]
    fn paths_have_the_fewest_hops_then_the_least_length_on_random_scenes() {
        for seed in 0..150 {
            let objects = random_scene(seed);
            let n = objects.len();
            let graph = build(&objects, &ObjectSet::first(n));
            let edges = sorted(graph.edges());
            assert!(edges.iter().all(|&(a, b)| a < b && b <= n) && edges.windows(2).all(|e| e[0] != e[1]));
            for (a, next) in (0..).map(ObjectId).zip(&graph.neighbours) {
                assert!(next.iter().all(|b| graph.neighbours[b.index()].contains(a)));
            }
            let at = |i: usize| objects.get(i).map_or(ROBOT.at, |o| o.at);
            // Every edge is tried until nothing gets better: (hops, length) in dictionary order.
            let mut best = vec![(usize::MAX, 0.0); n];
            best.push((0, 0.0));
            for _ in 0..=n {
                for (a, b) in edges.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).filter(|e| e.1 != n) {
                    let through = (best[a].0.saturating_add(1), best[a].1 + at(a).distance(at(b)));
                    if best[a].0 != usize::MAX && through < best[b] {
                        best[b] = through;
                    }
                }
            }
            for (target, &(hops, length)) in best[..n].iter().enumerate() {
                let path = graph.path(ObjectId(target as u16), &ObjectSet::EMPTY).unwrap_or_default();
                assert_eq!(path.len(), if hops == usize::MAX { 0 } else { hops });
                let nodes: Vec<usize> = std::iter::once(n).chain(path.iter().map(|id| id.index())).collect();
                let step = |s: &[usize]| edges.contains(&(s[0].min(s[1]), s[0].max(s[1])));
                assert!(nodes.windows(2).all(step));
                let walked: f64 = nodes.windows(2).map(|s| at(s[0]).distance(at(s[1]))).sum();
                assert!((walked - length).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn neither_the_order_nor_the_absent_matter() {
        for seed in 0..150 {
            let objects = random_scene(seed);
            let n = objects.len();
            let edges = sorted(build(&objects, &ObjectSet::first(n)).edges());
            let backward: Vec<Disc> = objects.iter().rev().copied().collect();
            let rename = |i: usize| if i == n { n } else { n - 1 - i };
            let renamed = build(&backward, &ObjectSet::first(n));
            assert_eq!(sorted(renamed.edges().map(|(a, b)| (rename(a), rename(b)))), edges);

            let standing: ObjectSet = (0..n as u16).filter(|i| i % 3 != 0).map(ObjectId).collect();
            let kept: Vec<usize> = standing.iter().map(ObjectId::index).chain([n]).collect();
            let alone: Vec<Disc> = standing.iter().map(|id| objects[id.index()]).collect();
            let fewer = build(&objects, &standing);
            let only = build(&alone, &ObjectSet::first(alone.len()));
            assert_eq!(sorted(fewer.edges()), sorted(only.edges().map(|(a, b)| (kept[a], kept[b]))));
            assert_eq!(fewer.path(ObjectId(0), &ObjectSet::EMPTY), None);
        }
    }

    #[test]
    fn nothing_and_coincident_or_pointlike_discs_are_no_trouble() {
        let graph = build(&[], &ObjectSet::EMPTY);
        assert!(graph.edges().next().is_none() && graph.path(ObjectId(0), &ObjectSet::EMPTY).is_none());
        let (point, twin) = (Disc { at: ROBOT.at, radius: 0.0 }, ROBOT);
        for discs in [[point; 3], [twin; 3], [twin, point, fixture()[4]]] {
            let graph = build(&discs, &ObjectSet::first(3));
            assert!(graph.path(ObjectId(2), &ObjectSet::EMPTY).is_none_or(|p| p.last() == Some(&ObjectId(2))));
        }
    }
}
