//! Stacked objects (Table IV, Fig. 10).

use super::Report;
use super::figures::{lines, point};
use super::rows::{grouped, percent, solved, task, total, values};
use crate::retrieval::Row;
use crate::retrieval::chart::Series;
use crate::retrieval::table::{Cell, Table};
use crate::statistics::{median, quantile};

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
