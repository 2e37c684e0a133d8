//! Curves and bars from rows.

use super::rows::{grouped, solved, values};
use crate::retrieval::Row;
use crate::retrieval::chart::{Chart, Form, Point, Series};
use crate::retrieval::row::Growth;
use crate::statistics::{deviation, mean};
use std::collections::BTreeSet;

/// Means after each iteration, over the runs that got so far.
pub(super) fn curve(rows: &[&Row], value: fn(&Growth) -> Option<f64>) -> Vec<Option<f64>> {
    let iterations = rows.iter().map(|r| r.growth.len()).max().unwrap_or(0);
    let values = |index: usize| rows.iter().filter_map(|r| value(r.growth.get(index)?)).collect::<Vec<_>>();
    (0..iterations).map(|index| mean(&values(index))).collect()
}

pub(super) fn over_iterations(curve: &[Option<f64>]) -> Vec<Point> {
    let points = curve.iter().enumerate();
    points.filter_map(|(index, y)| Some(Point { x: (index + 1) as f64, y: (*y)?, deviation: None })).collect()
}

pub(super) fn point(x: usize, values: &[f64]) -> Option<Point> {
    let y = mean(values).filter(|y| y.is_finite())?;
    Some(Point { x: x as f64, y, deviation: deviation(values) })
}

pub(super) fn lines(title: &str, x: &str, y: &str, series: Vec<Series>) -> Chart {
    Chart { title: title.to_owned(), x: x.to_owned(), y: y.to_owned(), form: Form::Lines, series }
}

/// Of the runs that succeeded, in groups by the number of objects.
pub(super) fn bars(rows: &[&Row], title: &str, y: &str, name: fn(&Row) -> String, value: fn(&Row) -> f64) -> Chart {
    let rows = solved(rows);
    let groups: BTreeSet<usize> = rows.iter().map(|r| r.objects).collect();
    let points = |rows: Vec<&Row>| {
        let by_objects = grouped(&rows, |r| r.objects);
        let groups = groups.iter().enumerate();
        groups.filter_map(|(index, objects)| point(index, &values(by_objects.get(objects)?, value))).collect()
    };
    let series = grouped(&rows, name).into_iter().map(|(name, rows)| Series { name, points: points(rows) }).collect();
    let form = Form::Bars(groups.iter().map(usize::to_string).collect());
    Chart {
        title: format!("{title} (mean, standard deviation)"),
        x: "objects".to_owned(),
        y: y.to_owned(),
        form,
        series,
    }
}
