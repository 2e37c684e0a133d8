//! Other planners on the same scenes (Fig. 15).

use super::Report;
use super::figures::bars;
use super::rows::{grouped, motion, over, percent, removed, solved, task, total, values};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use crate::statistics::{mean, median};
use std::collections::BTreeMap;

/// What the paper says of itself against the traversability graph: objects, less time and fewer removals in %.
const CLAIMS: [(usize, f64, f64); 3] = [(12, 24.6, 16.1), (16, 10.9, 3.0), (20, 21.3, 8.8)];

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
