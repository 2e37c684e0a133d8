//! Tables and figures from rows alone.

mod figures;
mod graphs;
mod known;
mod large;
mod lower_bounds;
mod mobile;
mod occlusion;
mod optimal;
mod peers;
mod rows;
mod stacked;

use super::Row;
use super::chart::Chart;
use super::table::Table;
use rows::scene;
use std::collections::BTreeSet;
use std::fmt::Write;

const SECTIONS: [(&str, &str, Section); 8] = [
    ("known", "Time and removals (Table I, Fig. 12)", known::write),
    ("graphs", "How the graphs grow (Fig. 13, Fig. 14)", graphs::write),
    ("peers", "Other planners (Fig. 15)", peers::write),
    ("large", "Large scenes (Table V)", large::write),
    ("optimal", "The fewest removals (Table VI)", optimal::write),
    ("occlusion", "Hidden objects (Table II)", occlusion::write),
    ("mobile", "A base that drives (Table III, Fig. 9)", mobile::write),
    ("stacked", "Stacked objects (Table IV, Fig. 10)", stacked::write),
];
const INTRODUCTION: &str = "# Experiments\n\nNumbers of removed objects include the target. Success is a plan that the \
    verifier finds valid; figures are of these runs, except where the graphs grow. Means stand with the sample \
    standard deviation in parentheses; – is where there is no data.\n";

type Section = fn(&mut Report, &[&Row]);

/// Names of files and what is in them, `report.md` first.
pub struct Report {
    pub files: Vec<(String, String)>,
}

pub fn report(rows: &[Row]) -> Report {
    let mut report = Report { files: vec![("report.md".to_owned(), INTRODUCTION.to_owned())] };
    if rows.is_empty() {
        report.say("There are no rows.");
    }
    for (experiment, title, section) in SECTIONS {
        let rows: Vec<&Row> = rows.iter().filter(|r| r.experiment == experiment).collect();
        if !rows.is_empty() {
            report.say(&format!("## {title}\n\n{}", what_was_run(&rows)));
            section(&mut report, &rows);
        }
    }
    let all: Vec<&Row> = rows.iter().collect();
    if all.iter().any(|r| r.planner == "clearway" && !r.bound_kind.is_empty()) {
        report.say("## Lower bounds");
        lower_bounds::write(&mut report, &all);
    }
    report
}

fn what_was_run(rows: &[&Row]) -> String {
    let listed = |values: BTreeSet<String>| values.into_iter().collect::<Vec<_>>().join("; ");
    let scenes = rows.iter().map(|r| scene(r)).collect::<BTreeSet<_>>().len();
    let versions = listed(rows.iter().map(|r| r.version.clone()).collect());
    let machines = listed(rows.iter().map(|r| format!("{} ({} cores)", r.machine.cpu, r.machine.cores)).collect());
    let refused = rows.iter().filter(|r| r.status == "refused" || r.verdict == "violations").count();
    format!(
        "Scenes: {scenes}. Runs: {}. Version: {versions}. Machine: {machines}.\n\nPlans that the verifier refused: {refused}.",
        rows.len()
    )
}

impl Report {
    /// A paragraph of `report.md`.
    fn say(&mut self, text: &str) {
        if let Some((_, document)) = self.files.first_mut() {
            let _ = writeln!(document, "\n{}", text.trim_end());
        }
    }

    fn table(&mut self, table: &Table) {
        let [names, below, _] = &table.head;
        if !table.markdown.is_empty() {
            self.say(&format!("### {}\n\n| {names} |\n| {below} |\n{}", table.title, table.markdown));
        }
        self.csv(table);
    }

    fn csv(&mut self, table: &Table) {
        if table.csv.is_empty() {
            return self.say(&format!("No data: {}.", table.title));
        }
        let name = format!("{}.csv", table.name);
        self.say(&format!("[{}, as CSV]({name})", table.title));
        self.files.push((name, format!("{}\n{}", table.head[2], table.csv)));
    }

    fn chart(&mut self, name: &str, chart: &Chart) {
        if chart.series.iter().all(|s| s.points.is_empty()) {
            return self.say(&format!("No data: {}.", chart.title));
        }
        let name = format!("{name}.svg");
        self.say(&format!("![{}]({name})", chart.title));
        self.files.push((name, chart.svg()));
    }
}

#[cfg(test)]
mod tests;
