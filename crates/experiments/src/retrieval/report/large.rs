//! Large scenes (Table V).

use super::Report;
use super::rows::{grouped, motion, percent, removed, solved, task, total, values};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use crate::statistics::median;

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
