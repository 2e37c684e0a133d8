//! What tables and figures read from rows.

use crate::retrieval::Row;
use crate::retrieval::table::Cell;
use std::collections::BTreeMap;

pub(super) fn removed(row: &Row) -> f64 {
    row.removed as f64
}

pub(super) fn sampled(row: &Row) -> f64 {
    row.samples as f64
}

/// Times in milliseconds.
pub(super) fn total(row: &Row) -> f64 {
    row.timing.total * 1e3
}

pub(super) fn task(row: &Row) -> f64 {
    row.timing.task * 1e3
}

pub(super) fn motion(row: &Row) -> f64 {
    row.timing.motion * 1e3
}

/// What tells scenes apart.
pub(super) fn scene(row: &Row) -> (&str, usize, u64, &str) {
    (&row.experiment, row.objects, row.scene_seed, &row.scene)
}

pub(super) fn label(row: &Row) -> String {
    match row.first_limit.as_str() {
        "" => row.planner.clone(),
        limit => format!("{} ({limit})", row.planner),
    }
}

/// The exact search has no plan that could be valid.
pub(super) fn solved<'a>(rows: &[&'a Row]) -> Vec<&'a Row> {
    let sound = |r: &Row| r.verdict == "valid" || (r.planner == "exact" && r.verdict == "none");
    rows.iter().copied().filter(|r| r.status == "solved" && sound(r)).collect()
}

/// By scene, where the exact search ended.
pub(super) fn optima<'a>(rows: &[&'a Row]) -> BTreeMap<(&'a str, usize, u64, &'a str), usize> {
    let exact = rows.iter().filter(|r| r.planner == "exact");
    exact.filter_map(|r| Some((scene(r), r.optimum?))).collect()
}

pub(super) fn grouped<'a, K: Ord>(rows: &[&'a Row], key: impl Fn(&'a Row) -> K) -> BTreeMap<K, Vec<&'a Row>> {
    let mut groups: BTreeMap<K, Vec<&Row>> = BTreeMap::new();
    for row in rows {
        groups.entry(key(row)).or_default().push(row);
    }
    groups
}

pub(super) fn values(rows: &[&Row], value: impl Fn(&Row) -> f64) -> Vec<f64> {
    rows.iter().map(|r| value(r)).filter(|v| v.is_finite()).collect()
}

pub(super) fn over(part: Option<f64>, whole: Option<f64>) -> Option<f64> {
    whole.filter(|whole| *whole > 0.0).and_then(|whole| Some(part? / whole))
}

pub(super) fn percent(part: usize, whole: usize) -> Cell {
    Cell::Number(over(Some(part as f64 * 100.0), Some(whole as f64)))
}
