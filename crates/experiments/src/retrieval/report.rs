//! Tables and figures from rows alone.

use super::Row;
use super::chart::{Chart, Form, Point, Series};
use super::row::Growth;
use super::table::{Cell, Table};
use crate::statistics::{deviation, mean, median, quantile};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// What the paper says of itself against the traversability graph: objects, less time and fewer removals in %.
const CLAIMS: [(usize, f64, f64); 3] = [(12, 24.6, 16.1), (16, 10.9, 3.0), (20, 21.3, 8.8)];
const SECTIONS: [(&str, &str, Section); 8] = [
    ("known", "Time and removals (Table I, Fig. 12)", known),
    ("graphs", "How the graphs grow (Fig. 13, Fig. 14)", graphs),
    ("peers", "Other planners (Fig. 15)", peers),
    ("large", "Large scenes (Table V)", large),
    ("optimal", "The fewest removals (Table VI)", optimal),
    ("occlusion", "Hidden objects (Table II)", occlusion),
    ("mobile", "A base that drives (Table III, Fig. 9)", mobile),
    ("stacked", "Stacked objects (Table IV, Fig. 10)", stacked),
];
const INTRODUCTION: &str = "# Experiments\n\nNumbers of removed objects include the target. Success is a plan that the \
    verifier finds valid; figures are of these runs, except where the graphs grow. Means stand with the sample \
    standard deviation in parentheses; – is where there is no data.\n";

type Section = fn(&mut Report, &[&Row]);

/// Names of files and what is in them, `report.md` first.
pub struct Report {
    pub files: Vec<(String, String)>,
}

pub fn report(rows: &[Row]) -> Report {
    let mut report = Report { files: vec![("report.md".to_owned(), INTRODUCTION.to_owned())] };
    if rows.is_empty() {
        report.say("There are no rows.");
    }
    for (experiment, title, section) in SECTIONS {
        let rows: Vec<&Row> = rows.iter().filter(|r| r.experiment == experiment).collect();
        if !rows.is_empty() {
            report.say(&format!("## {title}\n\n{}", what_was_run(&rows)));
            section(&mut report, &rows);
        }
    }
    let all: Vec<&Row> = rows.iter().collect();
    if all.iter().any(|r| r.planner == "clearway" && !r.bound_kind.is_empty()) {
        report.say("## Lower bounds");
        lower_bounds(&mut report, &all);
    }
    report
}

fn what_was_run(rows: &[&Row]) -> String {
    let listed = |values: BTreeSet<String>| values.into_iter().collect::<Vec<_>>().join("; ");
    let scenes = rows.iter().map(|r| scene(r)).collect::<BTreeSet<_>>().len();
    let versions = listed(rows.iter().map(|r| r.version.clone()).collect());
    let machines = listed(rows.iter().map(|r| format!("{} ({} cores)", r.machine.cpu, r.machine.cores)).collect());
    let refused = rows.iter().filter(|r| r.status == "refused" || r.verdict == "violations").count();
    format!(
        "Scenes: {scenes}. Runs: {}. Version: {versions}. Machine: {machines}.\n\nPlans that the verifier refused: {refused}.",
        rows.len()
    )
}

fn known(report: &mut Report, rows: &[&Row]) {
    let mut table = Table::new("table1", "Table I: time and removals");
    for ((objects, planner, limit), rows) in grouped(rows, |r| (r.objects, &r.planner, &r.first_limit)) {
        let solved = solved(&rows);
        table.row(vec![
            ("objects", Cell::Count(objects)),
            ("planner", Cell::Text(planner.clone())),
            ("first limit", Cell::Text(limit.clone())),
            ("runs", Cell::Count(rows.len())),
            ("success [%]", percent(solved.len(), rows.len())),
            ("removed", Cell::Spread(values(&solved, removed))),
            ("time [ms]", Cell::Spread(values(&solved, total))),
            ("median time [ms]", Cell::Number(median(&values(&solved, total)))),
            ("p95 time [ms]", Cell::Number(quantile(&values(&solved, total), 0.95))),
            ("iterations", Cell::Number(mean(&values(&solved, |r| r.iterations as f64)))),
        ]);
    }
    report.table(&table);
    report.chart("fig12_time", &bars(rows, "Fig. 12: planning time", "planning time [ms]", label, total));
    report.chart("fig12_removed", &bars(rows, "Fig. 12: removed objects", "removed objects", label, removed));
}

fn graphs(report: &mut Report, rows: &[&Row]) {
    let planners = rows.iter().map(|r| label(r)).collect::<BTreeSet<_>>().len();
    let name = |objects: usize, planner: &str| match planners {
        1 => format!("{objects} objects"),
        _ => format!("{objects} objects, {planner}"),
    };
    let grown: Vec<&Row> = rows.iter().copied().filter(|r| !r.growth.is_empty()).collect();
    let shown = grown.iter().map(|r| r.objects).min_by_key(|objects| (*objects != 12, *objects)).unwrap_or(0);
    let mut table = Table::new("fig13", "Fig. 13 and Fig. 14(a): nodes after each iteration");
    let (mut nodes, mut ratios) = (Vec::new(), Vec::new());
    for ((objects, planner), rows) in grouped(&grown, |r| (r.objects, label(r))) {
        let roadmap = curve(&rows, |g| Some(g.roadmap_nodes as f64));
        let retrieval = curve(&rows, |g| Some(g.retrieval_nodes as f64));
        let ratio = curve(&rows, |g| over(Some(g.roadmap_nodes as f64), Some(g.retrieval_nodes as f64)));
        for (index, ((roadmap, retrieval), ratio)) in roadmap.iter().zip(&retrieval).zip(&ratio).enumerate() {
            table.row(vec![
                ("objects", Cell::Count(objects)),
                ("planner", Cell::Text(planner.clone())),
                ("iteration", Cell::Count(index + 1)),
                ("runs", Cell::Count(rows.iter().filter(|r| r.growth.len() > index).count())),
                ("roadmap nodes", Cell::Number(*roadmap)),
                ("retrieval graph nodes", Cell::Number(*retrieval)),
                ("ratio", Cell::Number(*ratio)),
            ]);
        }
        if objects == shown {
            let of = |graph: &str| if planners == 1 { graph.to_owned() } else { format!("{graph}, {planner}") };
            nodes.push(Series { name: of("roadmap"), points: over_iterations(&roadmap) });
            nodes.push(Series { name: of("retrieval graph"), points: over_iterations(&retrieval) });
        }
        ratios.push(Series { name: name(objects, &planner), points: over_iterations(&ratio) });
    }
    report.csv(&table);
    let title = format!("Fig. 13: nodes with {shown} objects (mean of the runs that got so far)");
    report.chart("fig13", &lines(&title, "iteration", "nodes", nodes));
    let title = "Fig. 14(a): roadmap nodes per retrieval graph node";
    report.chart("fig14a", &lines(title, "iteration", "ratio of nodes", ratios));

    let mut table = Table::new("fig14b", "Fig. 14(b): samples and time");
    let (mut samples, mut times) = (Vec::new(), Vec::new());
    for ((objects, planner), rows) in grouped(&solved(rows), |r| (r.objects, label(r))) {
        let by_removed = grouped(&rows, |r| r.removed);
        for (removed, rows) in &by_removed {
            table.row(vec![
                ("objects", Cell::Count(objects)),
                ("planner", Cell::Text(planner.clone())),
                ("removed", Cell::Count(*removed)),
                ("runs", Cell::Count(rows.len())),
                ("samples", Cell::Spread(values(rows, sampled))),
                ("time [ms]", Cell::Spread(values(rows, total))),
            ]);
        }
        let points = |value: fn(&Row) -> f64| {
            let points = by_removed.iter().filter_map(|(removed, rows)| point(*removed, &values(rows, value)));
            points.map(|point| Point { deviation: None, ..point }).collect()
        };
        samples.push(Series { name: name(objects, &planner), points: points(sampled) });
        times.push(Series { name: name(objects, &planner), points: points(total) });
    }
    report.table(&table);
    report.chart("fig14b_samples", &lines("Fig. 14(b): samples", "removed objects", "samples", samples));
    report.chart("fig14b_time", &lines("Fig. 14(b): planning time", "removed objects", "planning time [ms]", times));
}

fn peers(report: &mut Report, rows: &[&Row]) {
    let mut table = Table::new("fig15", "Fig. 15: planners");
    for ((objects, planner), rows) in grouped(rows, |r| (r.objects, &r.planner)) {
        let solved = solved(&rows);
        table.row(vec![
            ("objects", Cell::Count(objects)),
            ("planner", Cell::Text(planner.clone())),
            ("runs", Cell::Count(rows.len())),
            ("success [%]", percent(solved.len(), rows.len())),
            ("removed", Cell::Spread(values(&solved, removed))),
            ("time [ms]", Cell::Spread(values(&solved, total))),
            ("median time [ms]", Cell::Number(median(&values(&solved, total)))),
            ("task time [ms]", Cell::Spread(values(&solved, task))),
            ("median task time [ms]", Cell::Number(median(&values(&solved, task)))),
            ("motion time [ms]", Cell::Spread(values(&solved, motion))),
            ("median motion time [ms]", Cell::Number(median(&values(&solved, motion)))),
        ]);
    }
    report.table(&table);
    let planner = |r: &Row| r.planner.clone();
    report.chart("fig15_time", &bars(rows, "Fig. 15: planning time", "planning time [ms]", planner, total));
    report.chart("fig15_removed", &bars(rows, "Fig. 15: removed objects", "removed objects", planner, removed));

    let run = |r: &Row| (r.objects, r.scene_seed, r.seed);
    let (own, others): (Vec<&Row>, Vec<&Row>) = solved(rows).into_iter().partition(|r| r.planner == "clearway");
    let own: BTreeMap<_, &Row> = own.into_iter().map(|r| (run(r), r)).collect();
    let mut table = Table::new("fig15_comparison", "Clearway against each, over the runs that both solved");
    for ((objects, planner), others) in grouped(&others, |r| (r.objects, &r.planner)) {
        let (own, others): (Vec<&Row>, Vec<&Row>) =
            others.into_iter().filter_map(|r| Some((*own.get(&run(r))?, r))).unzip();
        let ratio = |of: fn(&[f64]) -> Option<f64>, value: fn(&Row) -> f64| {
            over(of(&values(&own, value)), of(&values(&others, value)))
        };
        let claim = CLAIMS.iter().find(|claim| planner == "traversability" && claim.0 == objects);
        let claim = claim.map(|(_, time, fewer)| format!("{time} % less time, {fewer} % fewer removals"));
        table.row(vec![
            ("objects", Cell::Count(objects)),
            ("against", Cell::Text(planner.clone())),
            ("runs", Cell::Count(own.len())),
            ("ratio of mean times", Cell::Number(ratio(mean, total))),
            ("ratio of median times", Cell::Number(ratio(median, total))),
            ("difference of mean removals [%]", Cell::Number(ratio(mean, removed).map(|r| (r - 1.0) * 100.0))),
            ("the paper's claim", Cell::Text(claim.unwrap_or_default())),
        ]);
    }
    report.table(&table);
}

fn large(report: &mut Report, rows: &[&Row]) {
    let mut table = Table::new("table5", "Table V: large scenes");
    for ((objects, planner), rows) in grouped(rows, |r| (r.objects, &r.planner)) {
        let solved = solved(&rows);
        let seconds = |value: fn(&Row) -> f64| values(&solved, value).iter().map(|ms| ms / 1e3).collect::<Vec<_>>();
        table.row(vec![
            ("objects", Cell::Count(objects)),
            ("planner", Cell::Text(planner.clone())),
            ("runs", Cell::Count(rows.len())),
            ("success [%]", percent(solved.len(), rows.len())),
            ("task time [s]", Cell::Spread(seconds(task))),
            ("median task time [s]", Cell::Number(median(&seconds(task)))),
            ("motion time [s]", Cell::Spread(seconds(motion))),
            ("median motion time [s]", Cell::Number(median(&seconds(motion)))),
            ("total time [s]", Cell::Spread(seconds(total))),
            ("median total time [s]", Cell::Number(median(&seconds(total)))),
            ("sequences tried", Cell::Spread(values(&solved, |r| r.sequences as f64))),
            ("removed", Cell::Spread(values(&solved, removed))),
            ("least optimum", rows.iter().filter_map(|r| r.optimum).min().map_or(Cell::Number(None), Cell::Count)),
        ]);
    }
    report.table(&table);
}

fn occlusion(report: &mut Report, rows: &[&Row]) {
    let mut table = Table::new("table2", "Table II: hidden objects");
    for ((objects, planner), rows) in grouped(rows, |r| (r.objects, &r.planner)) {
        let solved = solved(&rows);
        let actions: Vec<f64> = solved.iter().flat_map(|r| &r.actions).map(|s| 1e3 * s).collect();
        table.row(vec![
            ("objects", Cell::Count(objects)),
            ("planner", Cell::Text(planner.clone())),
            ("runs", Cell::Count(rows.len())),
            ("success [%]", percent(solved.len(), rows.len())),
            ("removed", Cell::Spread(values(&solved, removed))),
            ("time [ms]", Cell::Spread(values(&solved, total))),
            ("median time per action [ms]", Cell::Number(median(&actions))),
            ("p95 time per action [ms]", Cell::Number(quantile(&actions, 0.95))),
            ("motion [s]", Cell::Spread(values(&solved, |r| r.motion))),
        ]);
    }
    report.table(&table);
    let mut table = Table::new("table2_rules", "Where to look: removals on the same scenes, same seeds");
    for (objects, rows) in grouped(&solved(rows), |r| r.objects) {
        let own: BTreeMap<_, usize> =
            rows.iter().filter(|r| r.planner == "clearway").map(|r| ((scene(r), r.seed), r.removed)).collect();
        for (planner, rows) in grouped(&rows, |r| &r.planner).into_iter().filter(|(p, _)| *p != "clearway") {
            let pairs: Vec<(f64, f64)> =
                rows.iter().filter_map(|r| Some((*own.get(&(scene(r), r.seed))? as f64, removed(r)))).collect();
            table.row(vec![
                ("objects", Cell::Count(objects)),
                ("planner", Cell::Text(planner.clone())),
                ("runs", Cell::Count(pairs.len())),
                ("clearway removed", Cell::Spread(pairs.iter().map(|p| p.0).collect())),
                ("removed", Cell::Spread(pairs.iter().map(|p| p.1).collect())),
                ("difference", Cell::Spread(pairs.iter().map(|p| p.0 - p.1).collect())),
            ]);
        }
    }
    report.table(&table);
}

fn mobile(report: &mut Report, rows: &[&Row]) {
    // Contrasts were drawn with two removals at least.
    let scenes = |r: &Row| if r.least_removals > 1 { "contrast" } else { "drawn uniformly" };
    let mut table = Table::new("table3", "Table III: a base that drives, and the same base fixed");
    for ((scenes, planner, limit), rows) in grouped(rows, |r| (scenes(r), &r.planner, &r.first_limit)) {
        let solved = solved(&rows);
        table.row(vec![
            ("scenes", Cell::Text(scenes.to_owned())),
            ("planner", Cell::Text(planner.clone())),
            ("first limit", Cell::Text(limit.clone())),
            ("runs", Cell::Count(rows.len())),
            ("success [%]", percent(solved.len(), rows.len())),
            ("removed", Cell::Spread(values(&solved, removed))),
            ("base moves", Cell::Spread(values(&solved, |r| r.base_moves as f64))),
            ("median time [ms]", Cell::Number(median(&values(&solved, total)))),
            ("p95 time [ms]", Cell::Number(quantile(&values(&solved, total), 0.95))),
            ("median choosing [ms]", Cell::Number(median(&values(&solved, task)))),
            ("median moving [ms]", Cell::Number(median(&values(&solved, motion)))),
            ("motion [s]", Cell::Spread(values(&solved, |r| r.motion))),
        ]);
    }
    report.table(&table);
    let mut table = Table::new("table3_removals", "Driving against standing: the same scenes, the same seeds");
    for (scenes, rows) in grouped(&solved(rows), |r| scenes(r)) {
        let of = |planner: &str| -> BTreeMap<_, f64> {
            let rows = rows.iter().filter(|r| r.planner == planner && r.first_limit == "1" && r.seed == 1);
            rows.map(|r| (scene(r), removed(r))).collect()
        };
        let (driving, standing) = (of("clearway"), of("fixed_base"));
        let pairs: Vec<(f64, f64)> = driving.iter().filter_map(|(s, d)| Some((*d, *standing.get(s)?))).collect();
        let count = |is: fn(f64, f64) -> bool| pairs.iter().filter(|(d, s)| is(*d, *s)).count();
        let saved: Vec<f64> = pairs.iter().filter(|(d, s)| d < s).map(|(d, s)| s - d).collect();
        table.row(vec![
            ("scenes", Cell::Text(scenes.to_owned())),
            ("solved by both", Cell::Count(pairs.len())),
            ("solved by driving alone", Cell::Count(driving.keys().filter(|s| !standing.contains_key(*s)).count())),
            ("solved by standing alone", Cell::Count(standing.keys().filter(|s| !driving.contains_key(*s)).count())),
            ("driving removes", Cell::Spread(pairs.iter().map(|p| p.0).collect())),
            ("standing removes", Cell::Spread(pairs.iter().map(|p| p.1).collect())),
            ("driving removes fewer", Cell::Count(count(|d, s| d < s))),
            ("more", Cell::Count(count(|d, s| d > s))),
            ("fewer by, where so", Cell::Spread(saved)),
        ]);
    }
    report.table(&table);
}

fn stacked(report: &mut Report, rows: &[&Row]) {
    let mut table =
        Table::new("table4", "Table IV: one object on two before the target; three removals are the fewest");
    for ((objects, planner), rows) in grouped(rows, |r| (r.objects, &r.planner)) {
        let solved = solved(&rows);
        let fewest = solved.iter().filter(|r| r.removed <= r.least_removals).count();
        table.row(vec![
            ("objects", Cell::Count(objects)),
            ("planner", Cell::Text(planner.clone())),
            ("runs", Cell::Count(rows.len())),
            ("success [%]", percent(solved.len(), rows.len())),
            ("fewest removals [%]", percent(fewest, rows.len())),
            ("time [ms]", Cell::Spread(values(&solved, total))),
            ("median time [ms]", Cell::Number(median(&values(&solved, total)))),
            ("p95 time [ms]", Cell::Number(quantile(&values(&solved, total), 0.95))),
            ("median task time [ms]", Cell::Number(median(&values(&solved, task)))),
        ]);
    }
    report.table(&table);
    let series = grouped(&solved(rows), |r| r.planner.clone()).into_iter().map(|(name, rows)| {
        let points = grouped(&rows, |r| r.objects)
            .into_iter()
            .filter_map(|(objects, rows)| point(objects, &values(&rows, total)));
        Series { name, points: points.collect() }
    });
    report.chart("table4_time", &lines("Table IV: planning time", "objects", "planning time [ms]", series.collect()));
}

fn optimal(report: &mut Report, rows: &[&Row]) {
    let optima = optima(rows);
    let known: Vec<&Row> = rows.iter().copied().filter(|r| optima.contains_key(&scene(r))).collect();
    let mut table = Table::new("table6", "Table VI: removals and time by the fewest removals of a scene");
    let mut verdicts = Table::new("table6_runs", "Runs against the fewest removals");
    for (optimum, rows) in grouped(&known, |r| optima.get(&scene(r)).copied().unwrap_or(0)) {
        let of = |planner: &str| solved(&rows).into_iter().filter(|r| r.planner == planner).collect::<Vec<_>>();
        let (exact, brute_force, clearway) = (of("exact"), of("brute_force"), of("clearway"));
        table.row(vec![
            ("optimum", Cell::Count(optimum)),
            ("scenes", Cell::Count(rows.iter().map(|r| scene(r)).collect::<BTreeSet<_>>().len())),
            ("exact removed", Cell::Spread(values(&exact, removed))),
            ("brute force removed", Cell::Spread(values(&brute_force, removed))),
            ("clearway removed", Cell::Spread(values(&clearway, removed))),
            ("exact time [ms]", Cell::Spread(values(&exact, total))),
            ("brute force time [ms]", Cell::Spread(values(&brute_force, total))),
            ("clearway time [ms]", Cell::Spread(values(&clearway, total))),
        ]);
        let with = |rows: &[&Row], is: &dyn Fn(usize) -> bool| rows.iter().filter(|r| is(r.removed)).count();
        verdicts.row(vec![
            ("optimum", Cell::Count(optimum)),
            ("clearway runs", Cell::Count(clearway.len())),
            ("equal [%]", percent(with(&clearway, &|n| n == optimum), clearway.len())),
            ("one above", Cell::Count(with(&clearway, &|n| n.checked_sub(optimum) == Some(1)))),
            ("more above", Cell::Count(with(&clearway, &|n| n.saturating_sub(optimum) > 1))),
            ("below", Cell::Count(with(&clearway, &|n| n < optimum))),
            ("brute force runs", Cell::Count(brute_force.len())),
            ("brute force equals exact", Cell::Count(with(&brute_force, &|n| n == optimum))),
        ]);
    }
    report
        .say("The optimum is what the exact search found over the ways known to it; its time is that search's alone.");
    report.table(&table);
    report.table(&verdicts);
}

fn lower_bounds(report: &mut Report, rows: &[&Row]) {
    let optima = optima(rows);
    // Without a kind there is no bound: of partly observed scenes nothing is proved.
    let own: Vec<&Row> =
        solved(rows).into_iter().filter(|r| r.planner == "clearway" && !r.bound_kind.is_empty()).collect();
    let kinds: BTreeSet<&str> = own.iter().map(|r| r.bound_kind.as_str()).collect();
    let kinds: Vec<(&str, String)> = kinds.into_iter().map(|kind| (kind, format!("{kind} bounds"))).collect();
    let mut table = Table::new("lower_bounds", "Removals against their lower bounds");
    for ((experiment, objects), rows) in grouped(&own, |r| (&r.experiment, r.objects)) {
        let count = |is: &dyn Fn(&Row) -> bool| rows.iter().filter(|r| is(r)).count();
        let gap = |gap: usize| Cell::Count(count(&|r| r.removed.checked_sub(r.bound) == Some(gap)));
        let optimum = |r: &Row| r.optimum.or(optima.get(&scene(r)).copied());
        let mut cells = vec![
            ("experiment", Cell::Text(experiment.clone())),
            ("objects", Cell::Count(objects)),
            ("runs", Cell::Count(rows.len())),
            ("removed = bound [%]", percent(count(&|r| r.removed == r.bound), rows.len())),
            ("gap 0", gap(0)),
            ("gap 1", gap(1)),
            ("gap 2", gap(2)),
            ("larger gap", Cell::Count(count(&|r| r.removed.saturating_sub(r.bound) > 2))),
            ("bound > removed", Cell::Count(count(&|r| r.bound > r.removed))),
            ("bound > optimum", Cell::Count(count(&|r| optimum(r).is_some_and(|o| r.bound > o)))),
            ("optimum known", Cell::Count(count(&|r| optimum(r).is_some()))),
        ];
        cells.extend(kinds.iter().map(|(kind, name)| (name.as_str(), Cell::Count(count(&|r| r.bound_kind == *kind)))));
        table.row(cells);
    }
    report.table(&table);
}

fn removed(row: &Row) -> f64 {
    row.removed as f64
}

fn sampled(row: &Row) -> f64 {
    row.samples as f64
}

/// Times in milliseconds.
fn total(row: &Row) -> f64 {
    row.timing.total * 1e3
}

fn task(row: &Row) -> f64 {
    row.timing.task * 1e3
}

fn motion(row: &Row) -> f64 {
    row.timing.motion * 1e3
}

/// What tells scenes apart.
fn scene(row: &Row) -> (&str, usize, u64, &str) {
    (&row.experiment, row.objects, row.scene_seed, &row.scene)
}

fn label(row: &Row) -> String {
    match row.first_limit.as_str() {
        "" => row.planner.clone(),
        limit => format!("{} ({limit})", row.planner),
    }
}

/// The exact search has no plan that could be valid.
fn solved<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let sound = |r: &Row| r.verdict == "valid" || (r.planner == "exact" && r.verdict == "none");
    rows.iter().copied().filter(|r| r.status == "solved" && sound(r)).collect()
}

/// By scene, where the exact search ended.
fn optima<'a>(rows: &[&'a Row]) -> BTreeMap<(&'a str, usize, u64, &'a str), usize> {
    let exact = rows.iter().filter(|r| r.planner == "exact");
    exact.filter_map(|r| Some((scene(r), r.optimum?))).collect()
}

fn grouped<'a, K: Ord>(rows: &[&'a Row], key: impl Fn(&'a Row) -> K) -> BTreeMap<K, Vec<&'a Row>> {
    let mut groups: BTreeMap<K, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        groups.entry(key(row)).or_default().push(row);
    }
    groups
}

fn values(rows: &[&Row], value: impl Fn(&Row) -> f64) -> Vec<f64> {
    rows.iter().map(|r| value(r)).filter(|v| v.is_finite()).collect()
}

fn over(part: Option<f64>, whole: Option<f64>) -> Option<f64> {
    whole.filter(|whole| *whole > 0.0).and_then(|whole| Some(part? / whole))
}

fn percent(part: usize, whole: usize) -> Cell {
    Cell::Number(over(Some(part as f64 * 100.0), Some(whole as f64)))
}

/// Means after each iteration, over the runs that got so far.
fn curve(rows: &[&Row], value: fn(&Growth) -> Option<f64>) -> Vec<Option<f64>> {
    let iterations = rows.iter().map(|r| r.growth.len()).max().unwrap_or(0);
    let values = |index: usize| rows.iter().filter_map(|r| value(r.growth.get(index)?)).collect::<Vec<_>>();
    (0..iterations).map(|index| mean(&values(index))).collect()
}

fn over_iterations(curve: &[Option<f64>]) -> Vec<Point> {
    let points = curve.iter().enumerate();
    points.filter_map(|(index, y)| Some(Point { x: (index + 1) as f64, y: (*y)?, deviation: None })).collect()
}

fn point(x: usize, values: &[f64]) -> Option<Point> {
    let y = mean(values).filter(|y| y.is_finite())?;
    Some(Point { x: x as f64, y, deviation: deviation(values) })
}

fn lines(title: &str, x: &str, y: &str, series: Vec<Series>) -> Chart {
    Chart { title: title.to_owned(), x: x.to_owned(), y: y.to_owned(), form: Form::Lines, series }
}

/// Of the runs that succeeded, in groups by the number of objects.
fn bars(rows: &[&Row], title: &str, y: &str, name: fn(&Row) -> String, value: fn(&Row) -> f64) -> Chart {
    let rows = solved(rows);
    let groups: BTreeSet<usize> = rows.iter().map(|r| r.objects).collect();
    let points = |rows: Vec<&Row>| {
        let by_objects = grouped(&rows, |r| r.objects);
        let groups = groups.iter().enumerate();
        groups.filter_map(|(index, objects)| point(index, &values(by_objects.get(objects)?, value))).collect()
    };
    let series = grouped(&rows, name).into_iter().map(|(name, rows)| Series { name, points: points(rows) }).collect();
    let form = Form::Bars(groups.iter().map(usize::to_string).collect());
    Chart {
        title: format!("{title} (mean, standard deviation)"),
        x: "objects".to_owned(),
        y: y.to_owned(),
        form,
        series,
    }
}

impl Report {
    /// A paragraph of `report.md`.
    fn say(&mut self, text: &str) {
        if let Some((_, document)) = self.files.first_mut() {
            let _ = writeln!(document, "\n{}", text.trim_end());
        }
    }

    fn table(&mut self, table: &Table) {
        let [names, below, _] = &table.head;
        if !table.markdown.is_empty() {
            self.say(&format!("### {}\n\n| {names} |\n| {below} |\n{}", table.title, table.markdown));
        }
        self.csv(table);
    }

    fn csv(&mut self, table: &Table) {
        if table.csv.is_empty() {
            return self.say(&format!("No data: {}.", table.title));
        }
        let name = format!("{}.csv", table.name);
        self.say(&format!("[{}, as CSV]({name})", table.title));
        self.files.push((name, format!("{}\n{}", table.head[2], table.csv)));
    }

    fn chart(&mut self, name: &str, chart: &Chart) {
        if chart.series.iter().all(|s| s.points.is_empty()) {
            return self.say(&format!("No data: {}.", chart.title));
        }
        let name = format!("{name}.svg");
        self.say(&format!("![{}]({name})", chart.title));
        self.files.push((name, chart.svg()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::retrieval::row::Timing;

    fn row(experiment: &str, planner: &str, scene_seed: u64, removed: usize, total: f64) -> Row {
        Row {
            experiment: experiment.to_owned(),
            planner: planner.to_owned(),
            objects: 12,
            first_limit: "1".to_owned(),
            scene_seed,
            status: "solved".to_owned(),
            verdict: "valid".to_owned(),
            removed,
            bound: 2,
            bound_kind: "grasps".to_owned(),
            samples: 100 * removed,
            iterations: 3,
            timing: Timing { total, task: 0.75 * total, motion: 0.25 * total, judged: 0.0 },
            version: "1, of \"two\"".to_owned(),
            ..Row::default()
        }
    }

    fn growing(nodes: &[(usize, usize)]) -> Row {
        let growth = nodes.iter().map(|n| Growth { roadmap_nodes: n.0, retrieval_nodes: n.1, ..Growth::default() });
        Row { growth: growth.collect(), ..row("graphs", "paper", 1, 2, 0.1) }
    }

    fn all_experiments() -> Vec<Row> {
        let failed =
            |row: Row| Row { status: "out_of_budget".to_owned(), verdict: "none".to_owned(), removed: 0, ..row };
        let exact = |seed, optimum| {
            let row = row("optimal", "exact", seed, optimum, 0.5);
            Row { optimum: Some(optimum), verdict: "none".to_owned(), ..row }
        };
        vec![
            row("known", "clearway", 1, 2, 0.010),
            row("known", "clearway", 2, 4, 0.030),
            failed(row("known", "clearway", 3, 0, 9.0)),
            Row {
                status: "refused".into(),
                verdict: "violations".into(),
                ..row("known", "a <b> & \"c\", d|", 1, 2, 0.1)
            },
            growing(&[(10, 5), (30, 6)]),
            growing(&[(20, 5)]),
            growing(&[]),
            row("peers", "clearway", 1, 2, 0.010),
            row("peers", "clearway", 2, 3, 0.020),
            row("peers", "clearway", 3, 9, 9.0),
            row("peers", "traversability", 1, 4, 0.020),
            row("peers", "traversability", 2, 4, 0.040),
            failed(row("peers", "traversability", 3, 0, 9.0)),
            Row { objects: 100, sequences: 7, ..row("large", "clearway", 1, 12, 2.5) },
            exact(1, 2),
            exact(2, 3),
            row("optimal", "brute_force", 1, 2, 5.0),
            row("optimal", "clearway", 1, 2, 0.010),
            row("optimal", "clearway", 1, 3, 0.010),
            row("optimal", "clearway", 1, 5, 0.010),
            row("optimal", "clearway", 1, 1, 0.010),
            row("optimal", "clearway", 2, 3, 0.010),
            Row { least_removals: 3, ..row("stacked", "streams", 1, 3, 0.040) },
            Row { least_removals: 3, ..row("stacked", "streams", 2, 4, 0.060) },
            failed(Row { least_removals: 3, ..row("stacked", "streams", 3, 0, 9.0) }),
        ]
    }

    fn file<'a>(report: &'a Report, name: &str) -> &'a str {
        &report.files.iter().find(|(n, _)| n == name).unwrap_or_else(|| panic!("no {name}")).1
    }

    fn fields(line: &str) -> Vec<String> {
        let (mut fields, mut inside) = (vec![String::new()], false);
        for letter in line.chars() {
            match letter {
                '"' => inside = !inside,
                ',' if !inside => fields.push(String::new()),
                _ => fields.last_mut().unwrap().push(letter),
            }
        }
        assert!(!inside, "{line}");
        fields
    }

    /// What stands in a column of the line that begins so.
    fn at(report: &Report, name: &str, begins: &str, column: &str) -> String {
        let mut lines = file(report, name).lines();
        let head = fields(lines.next().unwrap());
        let index = head.iter().position(|c| c == column).unwrap_or_else(|| panic!("no {column} in {head:?}"));
        fields(lines.find(|l| l.starts_with(begins)).unwrap_or_else(|| panic!("no {begins}")))[index].clone()
    }

    #[test]
    fn figures_by_hand() {
        let report = report(&all_experiments());
        let number = |name, begins, column| at(&report, name, begins, column).parse::<f64>().unwrap();
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        close(number("table1.csv", "12,clearway", "success [%]"), 200.0 / 3.0);
        close(number("table1.csv", "12,clearway", "removed sd"), 2f64.sqrt());
        close(number("table1.csv", "12,clearway", "time [ms] mean"), 20.0);
        close(number("table1.csv", "12,clearway", "p95 time [ms]"), 30.0);
        let line = "| 12 | clearway | 1 | 3 | 66.7 | 3.00 (1.41) | 20.0 (14.1) | 20.0 | 30.0 | 3.00 |";
        assert!(file(&report, "report.md").contains(line));
        assert!(file(&report, "report.md").contains("Scenes: 3. Runs: 4. Version: 1, of"));
        assert!(file(&report, "report.md").contains("refused: 1."));

        close(number("fig13.csv", "12,paper (1),1,", "roadmap nodes"), 15.0);
        close(number("fig13.csv", "12,paper (1),1,", "ratio"), 3.0);
        close(number("fig13.csv", "12,paper (1),2,", "retrieval graph nodes"), 6.0);
        close(number("fig13.csv", "12,paper (1),2,", "runs"), 1.0);
        close(number("fig14b.csv", "12,paper (1),2,", "samples mean"), 200.0);

        close(number("table4.csv", "12,streams", "fewest removals [%]"), 100.0 / 3.0);
        close(number("table4.csv", "12,streams", "median time [ms]"), 50.0);
        close(number("fig15_comparison.csv", "12,trav", "runs"), 2.0);
        close(number("fig15_comparison.csv", "12,trav", "ratio of mean times"), 0.5);
        close(number("fig15_comparison.csv", "12,trav", "difference of mean removals [%]"), -37.5);
        assert!(
            at(&report, "fig15_comparison.csv", "12,trav", "the paper's claim").starts_with("24.6 % less time, 16.1")
        );
        close(number("table5.csv", "100,clearway", "motion time [s] mean"), 0.625);
        assert_eq!(at(&report, "table5.csv", "100,clearway", "motion time [s] sd"), "");

        close(number("table6.csv", "2,", "exact time [ms] mean"), 500.0);
        close(number("table6.csv", "3,", "clearway removed mean"), 3.0);
        assert!(file(&report, "table6_runs.csv").contains("\n2,4,25,1,1,1,1,1\n3,1,100,0,0,0,0,0\n"));
        // Five runs of Clearway's with removals 2, 3, 5, 1, 3 and bound 2.
        assert!(file(&report, "lower_bounds.csv").contains("\noptimal,12,5,20,1,2,0,1,1,0,5,5\n"));
    }

    #[test]
    fn any_rows_make_a_report() {
        assert!(file(&report(&[]), "report.md").contains("There are no rows."));
        let rows = all_experiments();
        let alone = rows.iter().map(|r| vec![r.clone()]);
        let unsolved = rows.iter().map(|r| Row { status: "impossible".to_owned(), ..r.clone() }).collect();
        let names = ["known", "graphs", "peers", "large", "optimal"];
        let experiments = names.map(|n| rows.iter().filter(|r| r.experiment == n).cloned().collect());
        for rows in alone.chain(experiments).chain([unsolved, vec![Row::default()]]) {
            let (files, again) = (report(&rows).files, report(&rows).files);
            assert_eq!(files, again);
            assert!(files.iter().all(|(_, text)| !text.contains("NaN") && !text.contains("inf")), "{rows:?}");
        }
    }

    #[test]
    fn files_are_well_formed_and_named_in_the_document() {
        let report = report(&all_experiments());
        for (name, text) in &report.files[1..] {
            assert!(file(&report, "report.md").contains(&format!("]({name})")), "{name}");
            if name.ends_with(".csv") {
                let columns: BTreeSet<usize> = text.lines().map(|l| fields(l).len()).collect();
                assert!(columns.len() == 1 && text.lines().count() > 1, "{name}: {text}");
                continue;
            }
            let mut open = Vec::new();
            for tag in text.split('<').skip(1) {
                let (tag, text) = tag.split_once('>').unwrap();
                assert!(!text.contains('>') && tag.matches('"').count() % 2 == 0, "{name}: {tag}");
                match tag.strip_prefix('/') {
                    Some(closed) => assert_eq!(open.pop(), Some(closed), "{name}"),
                    None if tag.ends_with('/') => {}
                    None => open.push(tag.split(' ').next().unwrap()),
                }
            }
            assert!(open.is_empty(), "{name}: {open:?}");
        }
        assert_eq!(report.files.iter().filter(|(name, _)| name.ends_with(".svg")).count(), 9);
    }
}
