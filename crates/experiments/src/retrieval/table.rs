//! A table, as Markdown and as CSV.

use crate::statistics::{deviation, mean};
use std::fmt::Write;

pub enum Cell {
    Text(String),
    Count(usize),
    Number(Option<f64>),
    /// Mean and deviation of these; two columns of a CSV.
    Spread(Vec<f64>),
}

impl Cell {
    fn shown(&self) -> String {
        match self {
            Self::Text(text) if text.is_empty() => figure(None),
            Self::Text(text) => text.replace('|', "\\|"),
            Self::Count(count) => count.to_string(),
            Self::Number(value) => figure(*value),
            Self::Spread(values) if values.is_empty() => figure(None),
            Self::Spread(values) => format!("{} ({})", figure(mean(values)), figure(deviation(values))),
        }
    }

    fn plain(&self) -> String {
        let number = |value: Option<f64>| value.map(|v| v.to_string()).unwrap_or_default();
        match self {
            Self::Text(text) => quoted(text),
            Self::Count(count) => count.to_string(),
            Self::Number(value) => number(*value),
            Self::Spread(values) => format!("{},{}", number(mean(values)), number(deviation(values))),
        }
    }
}

/// To three digits; a dash where there is none.
fn figure(value: Option<f64>) -> String {
    match value {
        None => "–".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(value) => {
            let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
            format!("{value:.decimals$}")
        }
    }
}

/// As RFC 4180 has it.
fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

pub struct Table {
    pub name: &'static str,
    pub title: &'static str,
    /// What is in Markdown's head, the line below it, and the head of the CSV.
    pub head: [String; 3],
    pub markdown: String,
    pub csv: String,
}

impl Table {
    pub fn new(name: &'static str, title: &'static str) -> Self {
        Self { name, title, head: Default::default(), markdown: String::new(), csv: String::new() }
    }

    /// All rows of a table have the same columns.
    pub fn row(&mut self, cells: Vec<(&str, Cell)>) {
        let joined =
            |of: &dyn Fn(&(&str, Cell)) -> String, by: &str| cells.iter().map(of).collect::<Vec<String>>().join(by);
        let align = |(_, cell): &(&str, Cell)| if matches!(cell, Cell::Text(_)) { "---" } else { "---:" }.to_owned();
        let column = |(name, cell): &(&str, Cell)| match cell {
            Cell::Spread(_) => format!("{},{}", quoted(&format!("{name} mean")), quoted(&format!("{name} sd"))),
            _ => quoted(name),
        };
        self.head = [joined(&|(name, _)| (*name).to_owned(), " | "), joined(&align, " | "), joined(&column, ",")];
        let _ = writeln!(self.markdown, "| {} |", joined(&|(_, cell)| cell.shown(), " | "));
        let _ = writeln!(self.csv, "{}", joined(&|(_, cell)| cell.plain(), ","));
    }
}
