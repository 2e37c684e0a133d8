//! Removals against the fewest (Table VI).

use super::Report;
use super::rows::{grouped, optima, percent, removed, scene, solved, total, values};
use crate::retrieval::Row;
use crate::retrieval::table::{Cell, Table};
use std::collections::BTreeSet;

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
