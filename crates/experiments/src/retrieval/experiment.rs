//! Which runs an experiment consists of.

use clearway_retrieval::FirstLimit;
use std::collections::HashSet;

/// The paper's experiments on known scenes (section VI).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Experiment {
    /// Table I and Fig. 12.
    Known,
    /// Figs. 13 and 14.
    Graphs,
    /// Fig. 15.
    Peers,
    /// Table V.
    Large,
    /// Table VI.
    Optimal,
    /// Table II.
    Occlusion,
    /// Table III and Fig. 9.
    Mobile,
    /// Table IV and Fig. 10.
    Stacked,
}

/// Who plans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TaskPlanner {
    Clearway,
    /// Clearway with the paper's settings.
    Paper,
    Traversability,
    ShortestPath,
    BruteForce,
    /// The fewest removals over the frozen set of ways; no motions.
    Exact,
    /// In scenes that are partly observed, Clearway with the paper's rule where to look, and with that of [3];
    /// `Clearway` has its own.
    Farthest,
    Largest,
    /// Clearway, told of all objects.
    AllKnown,
    /// Clearway, with a mobile base that stays where it is.
    FixedBase,
    /// PDDL with streams: all objects may be moved, by either algorithm; then only those of removal sequences.
    Streams,
    StreamsIncremental,
    Sequences,
}

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    Shelf,
    Large,
    Occluded,
    Table,
    /// Tables on which driving saves removals.
    Contrast,
    Stacked,
}

/// A scene to be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Draw {
    pub kind: Kind,
    pub objects: usize,
    pub least_removals: usize,
    pub seed: u64,
}

/// One run: what makes its row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Case {
    pub draw: Draw,
    pub planner: TaskPlanner,
    pub first_limit: FirstLimit,
    pub seed: u64,
}

impl TaskPlanner {
    pub fn name(self) -> &'static str {
        match self {
            Self::Clearway => "clearway",
            Self::Paper => "paper",
            Self::Traversability => "traversability",
            Self::ShortestPath => "shortest_path",
            Self::BruteForce => "brute_force",
            Self::Exact => "exact",
            Self::Farthest => "farthest",
            Self::Largest => "largest",
            Self::AllKnown => "all_known",
            Self::FixedBase => "fixed_base",
            Self::Streams => "streams",
            Self::StreamsIncremental => "streams_incremental",
            Self::Sequences => "sequences",
        }
    }
}

impl Experiment {
    pub const ALL: [Self; 8] = [
        Self::Known,
        Self::Graphs,
        Self::Peers,
        Self::Large,
        Self::Optimal,
        Self::Occlusion,
        Self::Mobile,
        Self::Stacked,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Known => "known",
            Self::Graphs => "graphs",
            Self::Peers => "peers",
            Self::Large => "large",
            Self::Optimal => "optimal",
            Self::Occlusion => "occlusion",
            Self::Mobile => "mobile",
            Self::Stacked => "stacked",
        }
    }

    /// Seconds for one run, unless said otherwise: the paper allows 60.
    pub fn time_limit(self, quick: bool) -> f64 {
        match self {
            Self::Mobile | Self::Stacked => 10.0,
            _ if quick => 2.0,
            Self::Large | Self::Optimal | Self::Occlusion => 60.0,
            _ => 10.0,
        }
    }

    /// All its runs, those on one scene together; `quick`: a small cut.
    pub fn cases(self, quick: bool) -> Vec<Case> {
        use TaskPlanner::{
            AllKnown, BruteForce, Clearway, Exact, Farthest, FixedBase, Largest, Paper, Sequences, ShortestPath,
            Streams, StreamsIncremental, Traversability,
        };
        let sizes = [12, 16, 20];
        let (scenes, runs) = if quick { (2, 2) } else { (20, 20) };
        let all_limits = [FirstLimit::One, FirstLimit::GraspCover, FirstLimit::All];
        let shelf = |objects, seed| Draw { kind: Kind::Shelf, objects, least_removals: 2, seed };
        match self {
            Self::Known => {
                // With the paper's settings the time is often spent in vain, so that once is enough.
                let draws = || sizes.into_iter().flat_map(|n| (1..=scenes).map(move |s| shelf(n, s)));
                let mut cases = cross(draws(), all_limits.map(|limit| (Clearway, limit)), runs);
                cases.extend(cross(draws(), all_limits.map(|limit| (Paper, limit)), 1));
                cases
            }
            Self::Graphs => {
                let draws = sizes.into_iter().flat_map(|n| (1..=scenes).map(move |s| shelf(n, s)));
                cross(draws, [(Paper, FirstLimit::One)], 1)
            }
            Self::Peers => {
                let with = [Clearway, Traversability, ShortestPath].map(|p| (p, FirstLimit::One));
                cross(sizes.into_iter().flat_map(|n| (1..=scenes).map(move |s| shelf(n, s))), with, runs)
            }
            Self::Large => {
                let draw = |seed| Draw { kind: Kind::Large, objects: 100, least_removals: 10, seed };
                let with = [Clearway, Traversability, ShortestPath].map(|p| (p, FirstLimit::One));
                cross((1..=if quick { 1 } else { 10 }).map(draw), with, 1)
            }
            Self::Optimal => {
                // More than ask for 2, 3 and 4 removals; brute force where it comes first.
                let counts = if quick { [1, 1, 1] } else { [100, 70, 40] };
                let few = if quick { 1 } else { 5 };
                let mut cases = Vec::new();
                for (least_removals, count) in (2..).zip(counts) {
                    for scene in 1..=count {
                        let seed = least_removals as u64 * 1000 + scene;
                        let draw = [Draw { kind: Kind::Shelf, objects: 16, least_removals, seed }];
                        cases.extend(cross(draw, [(Exact, FirstLimit::One)], 1));
                        let again = scene <= few;
                        cases.extend(cross(draw, [(Clearway, FirstLimit::One)], if again { runs } else { 1 }));
                        if again {
                            cases.extend(cross(draw, [(BruteForce, FirstLimit::One)], 1));
                        }
                    }
                }
                cases
            }
            Self::Occlusion => {
                let draws = || {
                    let draw = |objects, seed| Draw { kind: Kind::Occluded, objects, least_removals: 1, seed };
                    sizes.into_iter().flat_map(move |n| (1..=scenes).map(move |s| draw(n, s)))
                };
                let mut cases = cross(draws(), [(Clearway, FirstLimit::One)], runs);
                let others = [Farthest, Largest, AllKnown].map(|p| (p, FirstLimit::One));
                cases.extend(cross(draws(), others, runs.min(5)));
                cases
            }
            Self::Mobile => {
                // By the least removals tables and contrasts are told apart in rows.
                let table = |seed| Draw { kind: Kind::Table, objects: 20, least_removals: 1, seed };
                let contrast = |seed| Draw { kind: Kind::Contrast, objects: 20, least_removals: 2, seed };
                let (tables, contrasts, runs) = if quick { (2, 0, 1) } else { (200, 20, 5) };
                let both = [Clearway, FixedBase].map(|planner| (planner, FirstLimit::One));
                let mut cases = cross((1..=tables).map(table), both, 1);
                cases.extend(cross((1..=scenes).map(table), all_limits.map(|limit| (Clearway, limit)), runs));
                cases.extend(cross((1..=scenes).map(table), all_limits.map(|limit| (FixedBase, limit)), runs));
                cases.extend(cross((1..=contrasts).map(contrast), both, 1));
                let mut known = HashSet::new();
                cases.retain(|case| known.insert(*case));
                cases.sort_by_key(|case| (case.draw.least_removals, case.draw.seed));
                cases
            }
            Self::Stacked => {
                let draw = |objects, seed| Draw { kind: Kind::Stacked, objects, least_removals: 3, seed };
                let draws = [4, 8, 12, 20].into_iter().flat_map(|n| (1..=scenes).map(move |s| draw(n, s)));
                let with = [Streams, Sequences, Clearway].map(|p| (p, FirstLimit::One));
                let mut cases = cross(draws.clone(), with, if quick { 1 } else { 5 });
                // It often spends all its time.
                cases.extend(cross(draws, [(StreamsIncremental, FirstLimit::One)], 1));
                cases.sort_by_key(|case| (case.draw.objects, case.draw.seed));
                cases
            }
        }
    }
}

fn cross(
    draws: impl IntoIterator<Item = Draw>,
    with: impl IntoIterator<Item = (TaskPlanner, FirstLimit)> + Clone,
    runs: u64,
) -> Vec<Case> {
    let mut cases = Vec::new();
    for draw in draws {
        for seed in 1..=runs {
            for (planner, first_limit) in with.clone() {
                cases.push(Case { draw, planner, first_limit, seed });
            }
        }
    }
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_runs_as_the_paper_and_none_twice() {
        for experiment in Experiment::ALL {
            for quick in [false, true] {
                let cases = experiment.cases(quick);
                assert_eq!(cases.iter().collect::<HashSet<_>>().len(), cases.len(), "{experiment:?}");
            }
        }
        let of = |cases: &[Case], objects, planner| {
            cases
                .iter()
                .filter(|c| c.draw.objects == objects && c.planner == planner && c.first_limit == FirstLimit::One)
                .count()
        };
        for objects in [12, 16, 20] {
            assert_eq!(of(&Experiment::Known.cases(false), objects, TaskPlanner::Clearway), 400);
            assert_eq!(of(&Experiment::Peers.cases(false), objects, TaskPlanner::Traversability), 400);
        }
        assert!(of(&Experiment::Optimal.cases(false), 16, TaskPlanner::Exact) >= 200);
        assert_eq!(of(&Experiment::Large.cases(false), 100, TaskPlanner::Clearway), 10);
    }
}
