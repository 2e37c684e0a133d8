//! A base that drives (Table III, Fig. 9).

use super::Report;
use super::rows::{grouped, motion, percent, removed, scene, solved, task, total, values};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use crate::statistics::{median, quantile};
use std::collections::BTreeMap;

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
