//! Removals against their proved lower bounds, of all experiments.

use super::Report;
use super::rows::{grouped, optima, percent, scene, solved};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use std::collections::BTreeSet;

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
