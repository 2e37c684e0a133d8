//! How the roadmap and the retrieval graph grow (Fig. 13, Fig. 14).

use super::Report;
use super::figures::{curve, lines, over_iterations, point};
use super::rows::{grouped, label, over, sampled, solved, total, values};
use crate::retrieval::Row;
use crate::retrieval::chart::{Point, Series};
use crate::retrieval::table::{Cell, Table};
use std::collections::BTreeSet;

pub(super) fn write(report: &mut Report, rows: &[&Row]) {
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
