//! The retrieval graph (section IV-C): clusters of the roadmap, and what failures have taught.
//!
//! No geometry here. A cluster node carries NodeCol, the objects that the target with the gripper
//! collides with there. A failed feasibility check adds nodes as in Fig. 5: one for each set of
//! objects of which the robot would have to be rid first. A failure belongs to an object and what
//! was removed before it, not to one edge, so it holds wherever a path meets that object.
//!
//! The search is label-setting: a label is a node with the sequence of objects removed on the way.
//! A label dies when another at its node has removed a subset. With [`Search::Greedy`] a node
//! keeps its first label only, which is the paper's Algorithm 3.

use crate::ordered::Ordered;
use clearway_plan::{ObjectId, ObjectSet};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

pub type NodeId = usize;

/// A cluster of the roadmap.
#[derive(Clone, Debug, Default)]
pub struct Cluster {
    /// NodeCol.
    pub collisions: ObjectSet,
    /// ClusterNodes: indices into the roadmap's nodes.
    pub roadmap_nodes: Vec<usize>,
}

/// What is known about taking one object.
#[derive(Clone, Debug, Default)]
pub struct Knowledge {
    /// Each set is one way in: with all of it gone (and nothing else), the object can be had. The
    /// nodes n¹, n² … of Fig. 5.
    pub ways: Vec<ObjectSet>,
    /// It could not be had with just these removed, hence not with fewer.
    pub refuted: Vec<ObjectSet>,
    /// There is no other way than `ways`.
    pub complete: bool,
}

impl Knowledge {
    /// Whether the object may be had with `removed` gone, for all that is known.
    fn allows(&self, removed: &ObjectSet) -> bool {
        !self.refuted.iter().any(|r| removed.is_subset(r))
            && (!self.complete || self.ways.iter().any(|w| w.is_subset(removed)))
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// All labels that could still be best.
    #[default]
    Exact,
    /// One label per node: Algorithm 3.
    Greedy,
}

/// A candidate R = {O_r, N_r}.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// O_r, the target last.
    pub objects: Vec<ObjectId>,
    /// N_r: cluster nodes from start to goal; empty when the way is the arm's own, not the roadmap's.
    pub nodes: Vec<NodeId>,
    /// Euclidean distance between consecutive objects, metres; breaks ties.
    pub distance: f64,
}

/// G(N, H).
#[derive(Clone, Debug)]
pub struct RetrievalGraph {
    pub clusters: Vec<Cluster>,
    /// By node, ascending.
    pub edges: Vec<Vec<NodeId>>,
    pub start: NodeId,
    pub goal: NodeId,
    target: ObjectId,
    /// Where the objects stand, for tie-breaking.
    positions: Vec<[f64; 2]>,
    knowledge: BTreeMap<ObjectId, Knowledge>,
    /// Ways to the target that the arm itself has shown: it need not follow the roadmap there.
    direct: Vec<ObjectSet>,
}

/// Sequences looked at per search, beyond any real scene's; then the best so far is returned.
const MOST_LABELS: usize = 20_000;

impl RetrievalGraph {
    pub fn new(target: ObjectId, positions: Vec<[f64; 2]>) -> Self {
        Self {
            clusters: vec![Cluster::default(); 2],
            edges: vec![Vec::new(); 2],
            start: 0,
            goal: 1,
            target,
            positions,
            knowledge: BTreeMap::new(),
            direct: Vec::new(),
        }
    }

    /// Replaces the clusters; what failures have taught stays. Edges are `(a, b)` pairs.
    pub fn set_clusters(&mut self, clusters: Vec<Cluster>, edges: &[(NodeId, NodeId)], start: NodeId, goal: NodeId) {
        self.edges = vec![Vec::new(); clusters.len()];
        for &(a, b) in edges {
            self.edges[a].push(b);
            self.edges[b].push(a);
        }
        for list in &mut self.edges {
            list.sort_unstable();
            list.dedup();
        }
        self.clusters = clusters;
        self.start = start;
        self.goal = goal;
    }

    /// The check of `object` failed with `removed` gone. `ways`: sets of which any one, gone as
    /// well, might help (Fig. 5). `complete`: nothing else could.
    pub fn add_failure(&mut self, object: ObjectId, removed: ObjectSet, ways: &[ObjectSet], complete: bool) {
        let known = self.knowledge.entry(object).or_default();
        known.refuted.retain(|r| !r.is_subset(&removed));
        known.refuted.push(removed);
        known.ways.extend_from_slice(ways);
        known.ways = ObjectSet::minimal(std::mem::take(&mut known.ways));
        known.complete |= complete;
    }

    /// Tells ways to an object; there are no others with so few objects in them.
    pub fn add_ways(&mut self, object: ObjectId, ways: &[ObjectSet]) {
        let known = self.knowledge.entry(object).or_default();
        known.ways.extend_from_slice(ways);
        known.ways = ObjectSet::minimal(std::mem::take(&mut known.ways));
        known.complete = true;
    }

    /// The objects to which there are no other ways than those known.
    pub fn complete(&self) -> Vec<ObjectId> {
        self.knowledge.iter().filter(|(_, k)| k.complete).map(|(&object, _)| object).collect()
    }

    /// What is known of an object, if anything failed.
    pub fn knowledge(&self, object: ObjectId) -> Option<&Knowledge> {
        self.knowledge.get(&object)
    }

    /// Forgets everything about the robot; the clusters stay.
    pub fn forget(&mut self) {
        self.knowledge.clear();
        self.direct.clear();
    }

    /// Tells that the arm can have the target when any one of these sets is gone.
    pub fn add_direct(&mut self, ways: &[ObjectSet]) {
        self.direct.extend_from_slice(ways);
        self.direct = ObjectSet::minimal(std::mem::take(&mut self.direct));
    }

    /// How many nodes there are: clusters, and those made from failures.
    pub fn len(&self) -> usize {
        self.clusters.len() + self.failure_nodes().count()
    }

    pub fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// The nodes made from failures: the object that was blocked, and NodeCol.
    pub fn failure_nodes(&self) -> impl Iterator<Item = (ObjectId, ObjectSet)> {
        self.knowledge
            .iter()
            .flat_map(|(&object, k)| k.ways.iter().filter(|w| !w.is_empty()).map(move |&w| (object, w)))
    }

    /// The best sequence with |O_r| ≤ `limit`: fewest objects, then least distance between them.
    pub fn best_sequence(&self, limit: usize, search: Search) -> Option<Sequence> {
        let done = self.clusters.len();
        let mut frontier = Frontier {
            labels: Vec::new(),
            queue: BinaryHeap::new(),
            alive: vec![Vec::new(); done + 1],
            search,
            limit,
            target: self.target,
            goal_cover: self.clusters[self.goal].collisions,
        };
        let empty = Label {
            node: self.start,
            removed: ObjectSet::EMPTY,
            objects: Vec::new(),
            distance: 0.0,
            parent: None,
            direct: false,
        };
        for way in &self.direct {
            for next in self.remove(&empty, *way, limit) {
                for next in self.remove(&next, ObjectSet::of(self.target), limit) {
                    frontier.push(Label { node: done, direct: true, ..next });
                }
            }
        }
        for first in self.remove(&empty, self.clusters[self.start].collisions, limit) {
            frontier.push(first);
        }
        while let Some(index) = frontier.pop() {
            let label = frontier.labels[index].clone();
            if label.node == done {
                return Some(extract(&frontier.labels, index));
            }
            if label.node == self.goal {
                for next in self.remove(&label, ObjectSet::of(self.target), limit) {
                    frontier.push(Label { node: done, parent: Some(index), ..next });
                }
                continue;
            }
            for &neighbour in &self.edges[label.node] {
                for next in self.remove(&label, self.clusters[neighbour].collisions, limit) {
                    frontier.push(Label { node: neighbour, parent: Some(index), ..next });
                }
            }
        }
        None
    }

    /// The label after also removing `objects`, in every order of ways in that could be best.
    fn remove(&self, label: &Label, objects: ObjectSet, limit: usize) -> Vec<Label> {
        let mut results = Vec::new();
        self.remove_pending(label.clone(), objects, ObjectSet::EMPTY, limit, &mut results);
        results
    }

    fn remove_pending(
        &self,
        mut label: Label,
        objects: ObjectSet,
        pending: ObjectSet,
        limit: usize,
        results: &mut Vec<Label>,
    ) {
        let mut rest = objects.difference(label.removed);
        // Whatever may be had as things are is taken now, nearest first.
        loop {
            let last = label.objects.last().copied();
            let next = rest
                .iter()
                .filter(|&o| self.allows(o, &label.removed))
                .min_by(|&a, &b| self.apart(last, a).total_cmp(&self.apart(last, b)));
            let Some(next) = next else { break };
            label.distance += self.apart(last, next);
            label.objects.push(next);
            label.removed.insert(next);
            rest.remove(next);
        }
        let count = label.removed.union(rest).difference(ObjectSet::of(self.target)).len() + 1;
        if count > limit {
            return;
        }
        let Some(blocked) = rest.iter().next() else {
            results.push(label);
            return;
        };
        // One of its ways in has to be opened first; what waits for it cannot be part of that.
        let waiting = pending.with(blocked);
        let Some(known) = self.knowledge.get(&blocked) else { return };
        for way in &known.ways {
            let missing = way.difference(label.removed);
            if missing.is_empty() || !missing.intersection(waiting).is_empty() || missing.contains(self.target) {
                continue;
            }
            let mut opened = Vec::new();
            self.remove_pending(label.clone(), missing, waiting, limit, &mut opened);
            for label in opened {
                if self.allows(blocked, &label.removed) {
                    self.remove_pending(label, rest, pending, limit, results);
                }
            }
        }
    }

    /// Whether each object may be had with those before it gone, for all that is known.
    pub fn allows_all(&self, sequence: &[ObjectId]) -> bool {
        let mut removed = ObjectSet::EMPTY;
        sequence.iter().all(|&object| {
            let allowed = self.allows(object, &removed);
            removed.insert(object);
            allowed
        })
    }

    fn allows(&self, object: ObjectId, removed: &ObjectSet) -> bool {
        self.knowledge.get(&object).is_none_or(|k| k.allows(removed))
    }

    fn apart(&self, a: Option<ObjectId>, b: ObjectId) -> f64 {
        let Some(a) = a else { return 0.0 };
        let (p, q) = (self.positions[a.index()], self.positions[b.index()]);
        (p[0] - q[0]).hypot(p[1] - q[1])
    }
}

fn extract(labels: &[Label], index: usize) -> Sequence {
    let label = &labels[index];
    let mut nodes = Vec::new();
    let mut at = label.parent;
    while let Some(i) = at {
        nodes.push(labels[i].node);
        at = labels[i].parent;
    }
    nodes.reverse();
    Sequence { objects: label.objects.clone(), nodes, distance: label.distance }
}

/// The labels of one search, best first.
struct Frontier {
    labels: Vec<Label>,
    queue: BinaryHeap<Reverse<(usize, Ordered, usize)>>,
    /// Per node, what the labels that live there have removed, and their distance; the last entry
    /// is for finished sequences.
    alive: Vec<Vec<(ObjectSet, f64)>>,
    search: Search,
    limit: usize,
    target: ObjectId,
    goal_cover: ObjectSet,
}

impl Frontier {
    fn push(&mut self, label: Label) {
        // The goal's cover is part of every solution by the roadmap: it counts from the start.
        let cover = if label.direct { label.removed } else { label.removed.union(self.goal_cover) };
        let size = cover.difference(ObjectSet::of(self.target)).len() + 1;
        if size > self.limit || self.labels.len() >= MOST_LABELS {
            return;
        }
        let here = &mut self.alive[label.node];
        let dead = match self.search {
            // An equal set lives on only when it is nearer.
            Search::Exact => here.iter().any(|(removed, distance)| {
                removed.is_subset(&label.removed) && (*removed != label.removed || *distance <= label.distance + 1e-12)
            }),
            Search::Greedy => here
                .iter()
                .any(|(removed, distance)| (removed.len(), *distance) <= (label.removed.len(), label.distance + 1e-12)),
        };
        if dead {
            return;
        }
        match self.search {
            Search::Exact => here.retain(|(removed, _)| !label.removed.is_subset(removed)),
            Search::Greedy => here.clear(),
        }
        here.push((label.removed, label.distance));
        self.queue.push(Reverse((size, Ordered(label.distance), self.labels.len())));
        self.labels.push(label);
    }

    /// The best label that still lives.
    fn pop(&mut self) -> Option<usize> {
        while let Some(Reverse((_, _, index))) = self.queue.pop() {
            let label = &self.labels[index];
            if self.alive[label.node].iter().any(|(r, d)| *r == label.removed && *d == label.distance) {
                return Some(index);
            }
        }
        None
    }
}

#[derive(Clone, Debug)]
struct Label {
    node: NodeId,
    /// PathCol, as far as it has been removed.
    removed: ObjectSet,
    objects: Vec<ObjectId>,
    distance: f64,
    parent: Option<usize>,
    direct: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(ids: &[u16]) -> ObjectSet {
        ids.iter().map(|&i| ObjectId(i)).collect()
    }

    fn ids(sequence: &Sequence) -> Vec<u16> {
        sequence.objects.iter().map(|o| o.0).collect()
    }

    const TARGET: u16 = 9;

    /// Fig. 5(a): n_s – n₈ – n₄ – n_g, and beside it a way round by n₁ and n₂, n₆. Node ids are in
    /// the order of the list; O₅ stands nearer to O₈ and O₄ than O₃ does.
    fn figure_5() -> RetrievalGraph {
        let mut positions = vec![[0.0, 0.0]; 10];
        positions[8] = [0.0, 0.0];
        positions[4] = [0.0, 0.2];
        positions[3] = [-0.3, 0.1];
        positions[5] = [0.1, 0.1];
        positions[9] = [0.0, 0.4];
        positions[1] = [1.0, 0.0];
        positions[2] = [1.0, 0.5];
        positions[6] = [1.0, 1.0];
        let mut graph = RetrievalGraph::new(ObjectId(TARGET), positions);
        let cluster = |ids: &[u16]| Cluster { collisions: set(ids), roadmap_nodes: vec![0] };
        let clusters = vec![
            cluster(&[]),
            cluster(&[8]),
            cluster(&[4]),
            cluster(&[]),
            cluster(&[1]),
            cluster(&[2]),
            cluster(&[6]),
            cluster(&[7]),
        ];
        // Node 7 hangs off n_s and leads nowhere.
        let edges = [(0, 1), (1, 2), (2, 3), (0, 4), (4, 5), (5, 6), (6, 3), (0, 7)];
        graph.set_clusters(clusters, &edges, 0, 3);
        graph
    }

    #[test]
    fn figure_6a_the_path_by_8_and_4() {
        for search in [Search::Exact, Search::Greedy] {
            let best = figure_5().best_sequence(10, search).unwrap();
            assert_eq!(ids(&best), [8, 4, TARGET]);
            assert_eq!(best.nodes, [0, 1, 2, 3]);
        }
    }

    #[test]
    fn figure_6b_after_the_failure_of_4_the_nearer_of_3_and_5_goes_between() {
        for search in [Search::Exact, Search::Greedy] {
            let mut graph = figure_5();
            graph.add_failure(ObjectId(4), set(&[8]), &[set(&[3]), set(&[5])], false);
            assert_eq!(graph.len(), 8 + 2);
            let best = graph.best_sequence(10, search).unwrap();
            // ⟨O8, O5, O4⟩ and ⟨O8, O3, O4⟩ are of one size, as is the way round; O5 is nearest.
            assert_eq!(ids(&best), [8, 5, 4, TARGET]);
            // O5 in turn cannot be had: ⟨O8, O3, O4⟩ is left.
            graph.add_failure(ObjectId(5), set(&[8]), &[], true);
            let best = graph.best_sequence(10, search).unwrap();
            assert_eq!(ids(&best), [8, 3, 4, TARGET]);
        }
    }

    #[test]
    fn the_limit_gates_every_sequence() {
        let mut graph = figure_5();
        assert_eq!(graph.best_sequence(2, Search::Exact), None);
        assert!(graph.best_sequence(3, Search::Exact).is_some());
        graph.add_failure(ObjectId(4), set(&[8]), &[set(&[3]), set(&[5])], false);
        assert_eq!(graph.best_sequence(3, Search::Exact), None);
        assert_eq!(graph.best_sequence(4, Search::Exact).unwrap().objects.len(), 4);
    }

    #[test]
    fn a_failure_holds_wherever_the_object_is_met() {
        // Two clusters with O4: another edge into it must not find the same failure again.
        let mut graph = figure_5();
        let mut clusters = graph.clusters.clone();
        clusters.push(Cluster { collisions: set(&[4]), roadmap_nodes: vec![1] });
        graph.set_clusters(clusters, &[(0, 1), (1, 2), (2, 3), (1, 8), (8, 3)], 0, 3);
        graph.add_failure(ObjectId(4), set(&[8]), &[], true);
        assert_eq!(graph.best_sequence(10, Search::Exact), None);
    }

    #[test]
    fn greedy_misses_what_exact_finds_when_an_object_is_entered_twice() {
        // O1 on the lower way is met again at the end; greedy keeps the smaller set at the fork.
        let mut graph = RetrievalGraph::new(ObjectId(TARGET), vec![[0.0, 0.0]; 10]);
        let cluster = |ids: &[u16]| Cluster { collisions: set(ids), roadmap_nodes: vec![0] };
        // n_s → {O2} → ∅(fork) → {O1,O3} → n_g, and n_s → {O1,O3} → fork.
        let clusters =
            vec![cluster(&[]), cluster(&[2]), cluster(&[1, 3]), cluster(&[]), cluster(&[1, 3]), cluster(&[])];
        graph.set_clusters(clusters, &[(0, 1), (0, 2), (1, 3), (2, 3), (3, 4), (4, 5)], 0, 5);
        assert_eq!(graph.best_sequence(10, Search::Exact).unwrap().objects.len(), 3);
        assert_eq!(graph.best_sequence(10, Search::Greedy).unwrap().objects.len(), 4);
    }

    #[test]
    fn ways_that_wait_for_each_other_are_no_way() {
        let mut graph = figure_5();
        graph.add_failure(ObjectId(4), set(&[8]), &[set(&[3])], true);
        graph.add_failure(ObjectId(3), set(&[8]), &[set(&[4])], true);
        let best = graph.best_sequence(10, Search::Exact).unwrap();
        assert_eq!(ids(&best), [1, 2, 6, TARGET]);
    }

    #[test]
    fn ways_found_later_count_where_no_others_were_left() {
        let mut graph = figure_5();
        graph.add_failure(ObjectId(4), set(&[8]), &[], true);
        assert_eq!(ids(&graph.best_sequence(10, Search::Exact).unwrap()), [1, 2, 6, TARGET]);
        assert_eq!(graph.complete(), [ObjectId(4)]);
        graph.add_ways(ObjectId(4), &[set(&[5])]);
        // Of two sequences of one size the nearer.
        assert_eq!(ids(&graph.best_sequence(10, Search::Exact).unwrap()), [8, 5, 4, TARGET]);
    }

    #[test]
    fn direct_ways_need_no_roadmap() {
        let mut graph = figure_5();
        graph.add_direct(&[set(&[7])]);
        let best = graph.best_sequence(10, Search::Exact).unwrap();
        assert_eq!((ids(&best), best.nodes.len()), (vec![7, TARGET], 0));
    }

    /// Brute force over ordered subsets: the fewest objects whose removal, in an order that the
    /// knowledge allows, clears some path.
    fn brute_force(graph: &RetrievalGraph, objects: u16) -> Option<usize> {
        let mut best: Option<usize> = None;
        let clear = |removed: &ObjectSet| {
            let mut seen = vec![false; graph.clusters.len()];
            let mut stack = vec![graph.start];
            while let Some(n) = stack.pop() {
                if seen[n] || !graph.clusters[n].collisions.is_subset(removed) {
                    continue;
                }
                seen[n] = true;
                stack.extend(&graph.edges[n]);
            }
            seen[graph.goal]
        };
        let mut reached: Vec<ObjectSet> = vec![ObjectSet::EMPTY];
        let mut at = 0;
        while at < reached.len() {
            let removed = reached[at];
            at += 1;
            if clear(&removed) && graph.allows(ObjectId(TARGET), &removed) {
                best = Some(best.map_or(removed.len() + 1, |b| b.min(removed.len() + 1)));
            }
            for o in 0..objects {
                let (o, next) = (ObjectId(o), removed.with(ObjectId(o)));
                if !removed.contains(o) && graph.allows(o, &removed) && !reached.contains(&next) {
                    reached.push(next);
                }
            }
        }
        best
    }

    #[test]
    fn exact_agrees_with_brute_force() {
        let mut state = 12345u64;
        let mut draw = |n: u64| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) % n
        };
        let mut solved = 0;
        for _ in 0..400 {
            let mut graph = RetrievalGraph::new(ObjectId(TARGET), vec![[0.0, 0.0]; 10]);
            let clusters: Vec<Cluster> = (0..7)
                .map(|i| {
                    let collisions = if i < 2 {
                        ObjectSet::EMPTY
                    } else {
                        (0..1 + draw(2)).map(|_| ObjectId(draw(6) as u16)).collect()
                    };
                    Cluster { collisions, roadmap_nodes: vec![0] }
                })
                .collect();
            let edges: Vec<(usize, usize)> =
                (0..9).map(|_| (draw(7) as usize, draw(7) as usize)).filter(|(a, b)| a != b).collect();
            graph.set_clusters(clusters, &edges, 0, 1);
            for _ in 0..draw(5) {
                let object = ObjectId(draw(6) as u16);
                // The nature of a complete failure: some sets, not with the object itself.
                let ways: Vec<ObjectSet> = (0..1 + draw(3))
                    .map(|_| (0..1 + draw(2)).map(|_| ObjectId(draw(6) as u16)).filter(|o| *o != object).collect())
                    .collect();
                if ways.iter().all(|w| !w.is_empty()) && graph.knowledge(object).is_none() {
                    graph.add_failure(object, ObjectSet::EMPTY, &ways, true);
                }
            }
            let found = graph.best_sequence(10, Search::Exact).map(|s| s.objects.len());
            // A way may be opened only in part by the ways listed: brute force may also remove
            // objects that no way names, which never helps.
            assert_eq!(found, brute_force(&graph, 6), "{graph:?}");
            solved += usize::from(found.is_some());
        }
        assert!(solved > 100, "{solved}");
    }
}
