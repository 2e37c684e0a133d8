//! The roadmap M(X, E) of the target with the gripper (section IV-B, Algorithm 2).
//!
//! Nodes may collide with objects, at most as many as the sampling limit *K* allows; *K* rises
//! within each expansion so that open space is sampled before crowded space.

use crate::floor::Floor;
use crate::graph::Cluster;
use clearway_geometry::Vec2;
use clearway_plan::scene_file::Rect;
use clearway_plan::{Budget, ObjectSet, Stop};
use rand::{Rng, RngExt};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};

/// How the roadmap grows. The paper's letters are in parentheses.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Samples per expansion (*T*).
    pub samples: usize,
    /// Samples between raises of the sampling limit (*T_raise*).
    pub raise_every: usize,
    /// Longest edge (*δ*), metres.
    pub longest_edge: f64,
    /// Nodes that a new node is connected with (*k*).
    pub neighbours: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { samples: 300, raise_every: 30, longest_edge: 0.12, neighbours: 8 }
    }
}

impl Settings {
    /// What section VI-A states: T = 1000, T_raise = 100.
    pub fn paper() -> Self {
        Self { samples: 1000, raise_every: 100, ..Self::default() }
    }

    pub fn validate(&self) -> Result<(), String> {
        if self.samples == 0 || self.raise_every == 0 || self.neighbours == 0 {
            return Err("samples, raise_every and neighbours must be at least 1".to_owned());
        }
        if !(self.longest_edge > 0.0) {
            return Err(format!("longest_edge is {}, must be positive", self.longest_edge));
        }
        Ok(())
    }
}

/// Cells in which nodes are looked up, metres.
const CELL: f64 = 0.1;

/// A node x with Col(x).
#[derive(Clone, Copy, Debug)]
pub struct Node {
    pub at: Vec2,
    pub collisions: ObjectSet,
}

/// M(X, E); node 0 is x_s, node 1 is x_g.
#[derive(Clone, Debug)]
pub struct Roadmap {
    pub nodes: Vec<Node>,
    pub edges: Vec<(usize, usize)>,
    /// Samples drawn so far.
    pub samples: usize,
    places: Places,
}

/// Where the nodes are, by the cells of a grid; what lies outside of it counts to its border.
#[derive(Clone, Debug, Default)]
struct Places {
    min: Vec2,
    /// Width of a cell, metres.
    cell: f64,
    /// Cells in a row, and rows.
    count: [i64; 2],
    /// By cell: nodes with their places and |Col(x)|.
    cells: Vec<Vec<(Vec2, usize, usize)>>,
}

impl Places {
    /// For nodes in an area, asked for neighbours as far as `reach`.
    fn new(area: &Rect, reach: f64) -> Self {
        const MOST: f64 = 100.0;
        let (min, size) = (Vec2::from_array(area.min), Vec2::from_array(area.max) - Vec2::from_array(area.min));
        let cell = reach.max(size.max_element() / MOST).max(1e-3);
        let count = (size / cell).ceil().max(Vec2::ONE);
        let count = [count.x as i64, count.y as i64];
        Self { min, cell, count, cells: vec![Vec::new(); (count[0] * count[1]) as usize] }
    }

    fn cell_of(&self, at: Vec2) -> [i64; 2] {
        let place = (at - self.min) / self.cell;
        [(place.x as i64).clamp(0, self.count[0] - 1), (place.y as i64).clamp(0, self.count[1] - 1)]
    }

    fn cell(&self, x: i64, y: i64) -> &[(Vec2, usize, usize)] {
        let inside = (0..self.count[0]).contains(&x) && (0..self.count[1]).contains(&y);
        if inside { &self.cells[(y * self.count[0] + x) as usize] } else { &[] }
    }

    fn push(&mut self, index: usize, node: &Node) {
        let [x, y] = self.cell_of(node.at);
        self.cells[(y * self.count[0] + x) as usize].push((node.at, index, node.collisions.len()));
    }

    /// The node nearest to a point, of those that collide with at most `limit` objects; the first of
    /// equals.
    fn nearest(&self, to: Vec2, limit: usize) -> Option<usize> {
        let [x, y] = self.cell_of(to);
        let mut best: Option<(f64, usize)> = None;
        // Ring by ring: nothing in ring r is nearer than r − 1 cells.
        for ring in 0..self.count[0].max(self.count[1]) {
            if best.is_some_and(|(d, _)| d < ((ring - 1).max(0) as f64 * self.cell).powi(2)) {
                break;
            }
            for j in y - ring..=y + ring {
                let step = if (j - y).abs() == ring { 1 } else { (2 * ring).max(1) };
                for i in (x - ring..=x + ring).step_by(step as usize) {
                    for &(at, index, collisions) in self.cell(i, j) {
                        let found = (at.distance_squared(to), index);
                        if collisions <= limit && best.is_none_or(|b| found < b) {
                            best = Some(found);
                        }
                    }
                }
            }
        }
        best.map(|(_, index)| index)
    }

    /// The nodes within a distance of a point, with their squared distances.
    fn within(&self, to: Vec2, most: f64) -> Vec<(f64, usize)> {
        let ([x, y], [right, above]) = (self.cell_of(to - most), self.cell_of(to + most));
        let mut found = Vec::new();
        for j in y..=above {
            for i in x..=right {
                let near = |&(at, index, _): &(Vec2, usize, usize)| (at.distance_squared(to), index);
                found.extend(self.cell(i, j).iter().map(near).filter(|(d, _)| d.sqrt() <= most));
            }
        }
        found
    }
}

impl Roadmap {
    pub fn new(floor: &Floor) -> Self {
        let node = |at: Vec2| Node { at, collisions: floor.collisions(at) };
        let nodes = vec![node(floor.exit), node(floor.goal)];
        let mut places = Places::new(&floor.workspace, CELL);
        nodes.iter().enumerate().for_each(|(index, node)| places.push(index, node));
        Self { nodes, edges: Vec::new(), samples: 0, places }
    }

    /// Algorithm 2: grows the roadmap under the exploration limit *L*.
    pub fn expand(
        &mut self,
        floor: &Floor,
        limit: usize,
        settings: &Settings,
        random: &mut impl Rng,
        budget: &Budget,
    ) -> Result<(), Stop> {
        let most = limit.saturating_sub(1);
        let raises = (settings.samples / settings.raise_every).max(1);
        let mut sampling_limit = 0.0f64;
        for step in 1..=settings.samples {
            if step % 64 == 0 {
                budget.check()?;
            }
            self.samples += 1;
            let k = sampling_limit.floor() as usize;
            self.extend(floor, k.min(most), settings, random);
            if step % settings.raise_every == 0 {
                // Hauser's rule: each raise moves the limit by (most − now) / (raises left).
                let left = (raises - step / settings.raise_every).max(1);
                sampling_limit += (most as f64 - sampling_limit) / left as f64;
            }
        }
        Ok(())
    }

    fn extend(&mut self, floor: &Floor, sampling_limit: usize, settings: &Settings, random: &mut impl Rng) {
        let area = &floor.workspace;
        let draw = |low: f64, high: f64, t: f64| low + (high - low) * t;
        let sample =
            Vec2::new(draw(area.min[0], area.max[0], random.random()), draw(area.min[1], area.max[1], random.random()));
        let Some(nearest) = self.places.nearest(sample, sampling_limit) else { return };
        let nearest = self.nodes[nearest];
        let way = sample - nearest.at;
        let mut step = way.length().min(settings.longest_edge);
        if step < 1e-9 {
            return;
        }
        let along = way / way.length();
        // Bisection back towards the nearest node until the limit is met.
        let mut at = nearest.at + along * step;
        let acceptable = |at: Vec2| {
            floor.walls_free(nearest.at, at) && floor.edge_collisions(nearest.at, at).len() <= sampling_limit
        };
        while !acceptable(at) {
            step /= 2.0;
            if step < 0.005 {
                return;
            }
            at = nearest.at + along * step;
        }
        let new = Node { at, collisions: floor.collisions(at) };
        let index = self.nodes.len();
        // The edge just extended may be δ long to the last digit: rounding must not drop it.
        let mut near = self.places.within(at, settings.longest_edge * (1.0 + 1e-9));
        let nearer = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if near.len() > settings.neighbours {
            near.select_nth_unstable_by(settings.neighbours, nearer);
            near.truncate(settings.neighbours);
        }
        near.sort_unstable_by(nearer);
        self.places.push(index, &new);
        self.nodes.push(new);
        for (_, i) in near {
            let other = self.nodes[i];
            let both = new.collisions.union(other.collisions);
            if floor.edge_collisions(at, other.at).len() == both.len() && floor.walls_free(at, other.at) {
                self.edges.push((i, index));
            }
        }
    }

    /// Clusters connected nodes of equal Col (section IV-C1); x_s and x_g stay alone. Returns the
    /// clusters, their edges, and the nodes n_s and n_g.
    pub fn clusters(&self) -> (Vec<Cluster>, Vec<(usize, usize)>) {
        let mut parent: Vec<usize> = (0..self.nodes.len()).collect();
        fn root(parent: &mut [usize], mut i: usize) -> usize {
            while parent[i] != i {
                parent[i] = parent[parent[i]];
                i = parent[i];
            }
            i
        }
        for &(a, b) in &self.edges {
            if a > 1 && b > 1 && self.nodes[a].collisions == self.nodes[b].collisions {
                let (x, y) = (root(&mut parent, a), root(&mut parent, b));
                parent[x.max(y)] = x.min(y);
            }
        }
        let mut cluster_of: HashMap<usize, usize> = HashMap::new();
        let mut clusters: Vec<Cluster> = Vec::new();
        let member: Vec<usize> = (0..self.nodes.len())
            .map(|i| {
                let r = root(&mut parent, i);
                let c = *cluster_of.entry(r).or_insert_with(|| {
                    clusters.push(Cluster { collisions: self.nodes[r].collisions, roadmap_nodes: Vec::new() });
                    clusters.len() - 1
                });
                clusters[c].roadmap_nodes.push(i);
                c
            })
            .collect();
        let mut edges: Vec<(usize, usize)> = self
            .edges
            .iter()
            .map(|&(a, b)| (member[a].min(member[b]), member[a].max(member[b])))
            .filter(|(a, b)| a != b)
            .collect();
        edges.sort_unstable();
        edges.dedup();
        (clusters, edges)
    }

    /// The shortest way from x_g to x_s through nodes that collide with nothing but `removed`, as
    /// node indices from x_s to x_g.
    pub fn path(&self, removed: &ObjectSet) -> Option<Vec<usize>> {
        self.path_from(1, removed)
    }

    /// The same from another node to x_s.
    pub fn path_from(&self, start: usize, removed: &ObjectSet) -> Option<Vec<usize>> {
        let clear = |i: usize| self.nodes[i].collisions.is_subset(removed);
        if !clear(start) {
            return None;
        }
        let mut near: Vec<Vec<usize>> = vec![Vec::new(); self.nodes.len()];
        for &(a, b) in &self.edges {
            if clear(a) && clear(b) {
                near[a].push(b);
                near[b].push(a);
            }
        }
        let mut best = vec![f64::INFINITY; self.nodes.len()];
        let mut from = vec![usize::MAX; self.nodes.len()];
        let mut queue = BinaryHeap::new();
        best[start] = 0.0;
        queue.push((Reverse(0u64), start));
        while let Some((Reverse(d), i)) = queue.pop() {
            if i == 0 {
                let mut path = vec![0];
                let mut at = 0;
                while at != start {
                    at = from[at];
                    path.push(at);
                }
                return Some(path);
            }
            if d > nanometres(best[i]) {
                continue;
            }
            for &j in &near[i] {
                let next = best[i] + self.nodes[i].at.distance(self.nodes[j].at);
                if next < best[j] {
                    best[j] = next;
                    from[j] = i;
                    queue.push((Reverse(nanometres(next)), j));
                }
            }
        }
        None
    }

    /// A route out for something that stands at `at`, once `removed` (itself included) is gone:
    /// world points from `at` to x_s, corners left out where the disc passes without them.
    pub fn route(&self, floor: &Floor, at: Vec2, removed: &ObjectSet) -> Option<Vec<Vec2>> {
        let free = |a: Vec2, b: Vec2| floor.walls_free(a, b) && floor.edge_collisions(a, b).is_subset(removed);
        let start = (0..self.nodes.len())
            .filter(|&i| self.nodes[i].collisions.is_subset(removed))
            .min_by(|&i, &j| self.nodes[i].at.distance_squared(at).total_cmp(&self.nodes[j].at.distance_squared(at)))?;
        if self.nodes[start].at.distance(at) > 0.15 {
            return None;
        }
        let path = self.path_from(start, removed)?;
        let points: Vec<Vec2> = std::iter::once(at).chain(path.iter().rev().map(|&i| self.nodes[i].at)).collect();
        let mut route = vec![at];
        let mut i = 0;
        while i + 1 < points.len() {
            let next = (i + 2..points.len()).rev().find(|&j| free(points[i], points[j])).unwrap_or(i + 1);
            route.push(points[next]);
            i = next;
        }
        Some(route)
    }
}

/// Lengths as whole numbers, so that they can be ordered.
fn nanometres(length: f64) -> u64 {
    (length * 1e9) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn cells_find_what_a_scan_finds() {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(2);
        let area = Rect { min: [-0.4, 0.3], max: [0.5, 0.75] };
        let mut places = Places::new(&area, CELL);
        let mut nodes: Vec<Node> = Vec::new();
        for round in 0..600 {
            // Some lie outside of the area, as x_s may.
            let mut at = || Vec2::new(1.4 * random.random::<f64>() - 0.7, random.random::<f64>());
            let (node, to) = (at(), at());
            let collisions = ObjectSet::first(round % 4);
            places.push(nodes.len(), &Node { at: node, collisions });
            nodes.push(Node { at: node, collisions });
            let squared = |i: &usize| nodes[*i].at.distance_squared(to);
            for limit in 0..4 {
                let scan = (0..nodes.len())
                    .filter(|&i| nodes[i].collisions.len() <= limit)
                    .min_by(|a, b| squared(a).total_cmp(&squared(b)));
                assert_eq!(places.nearest(to, limit), scan);
            }
            let mut found: Vec<usize> = places.within(to, 0.12).into_iter().map(|(_, i)| i).collect();
            found.sort_unstable();
            let scan: Vec<usize> = (0..nodes.len()).filter(|i| squared(i).sqrt() <= 0.12).collect();
            assert_eq!(found, scan);
        }
    }
}
