//! `clearway bench report`: tables and figures from the rows in a directory.

use super::output::{self, tell};
use super::rows;
use crate::cli::BenchReportArgs;
use crate::exit::{Exit, Failure};
use clearway::FileError;
use clearway_experiments::retrieval::row::Row;
use clearway_experiments::retrieval::{Experiment, report};

pub fn run(args: &BenchReportArgs) -> Result<Exit, Failure> {
    let directory = &args.directory;
    let mut found = Vec::new();
    for experiment in Experiment::ALL {
        let path = directory.join(experiment.name()).with_extension("jsonl");
        if path.exists() {
            found.extend(rows::read::<Row>(&path)?.0);
        }
    }
    if found.is_empty() {
        let names = Experiment::ALL.map(|e| format!("{}.jsonl", e.name())).join(", ");
        return Err(FileError::new(directory, format!("holds no rows: none of {names}"))
            .help("make some: `clearway bench known --quick --out DIR`")
            .into());
    }
    let report = report::report(&found);
    for (name, text) in &report.files {
        output::write(&directory.join(name), text.as_bytes())?;
    }
    tell(&format!(
        "{} rows; {} files, first of all {}",
        found.len(),
        report.files.len(),
        directory.join("report.md").display()
    ));
    Ok(Exit::Done)
}
