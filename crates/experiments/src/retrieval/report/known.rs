//! Times and removals of known scenes (Table I, Fig. 12).

use super::Report;
use super::figures::bars;
use super::rows::{grouped, label, percent, removed, solved, total, values};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use crate::statistics::{mean, median, quantile};

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
