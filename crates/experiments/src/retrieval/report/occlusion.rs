//! Hidden objects (Table II), and rules for where to look.

use super::Report;
use super::rows::{grouped, percent, removed, scene, solved, total, values};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use crate::statistics::{median, quantile};
use std::collections::BTreeMap;

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
