//! Charts as SVG: lines, and bars in groups, with error bars, axes and a legend.

use std::fmt::Write;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 72.0;
const TOP: f64 = 44.0;
const BOTTOM: f64 = HEIGHT - 56.0;
/// What a letter of the legend takes.
const LETTER: f64 = 6.4;
const COLOURS: [&str; 10] =
    ["#4e79a7", "#f28e2b", "#59a14f", "#e15759", "#b07aa1", "#9c755f", "#76b7b2", "#edc948", "#ff9da7", "#7f7f7f"];
/// From so large a ratio of values on, small ones could not be read off a linear axis.
const LOGARITHMIC_FROM: f64 = 40.0;
/// More points than this merge into a line.
const MARKED: usize = 40;

pub struct Chart {
    pub title: String,
    pub x: String,
    pub y: String,
    pub form: Form,
    pub series: Vec<Series>,
}

pub enum Form {
    /// The groups' names; a point's x is the index of its group.
    Bars(Vec<String>),
    /// Over whole numbers.
    Lines,
}

pub struct Series {
    pub name: String,
    pub points: Vec<Point>,
}

/// Finite, and y is not negative.
pub struct Point {
    pub x: f64,
    pub y: f64,
    pub deviation: Option<f64>,
}

/// From numbers to pixels.
struct Axis {
    /// Exponents of ten where logarithmic.
    from: f64,
    to: f64,
    logarithmic: bool,
    pixels: (f64, f64),
}

impl Axis {
    /// Upwards, for all of these; logarithmic where they differ much.
    fn up(points: &[&Point]) -> Self {
        let pixels = (BOTTOM, TOP);
        let least = points.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let most = points.iter().map(|p| p.y + p.deviation.unwrap_or(0.0)).fold(0.0, f64::max);
        if least > 0.0 && least.is_finite() && most / least > LOGARITHMIC_FROM {
            let (from, to) = ((least * 0.6).log10(), (most * 1.05).log10());
            return Self { from, to, logarithmic: true, pixels };
        }
        Self { from: 0.0, to: if most > 1e-9 { most * 1.05 } else { 1.0 }, logarithmic: false, pixels }
    }

    /// To the right, whole numbers from the first to the last.
    fn right(points: &[&Point], pixels: (f64, f64)) -> Self {
        let least = points.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
        let most = points.iter().map(|p| p.x).fold(f64::NEG_INFINITY, f64::max);
        let (from, to) = if least < most { (least, most) } else { (most.max(1.0) - 1.0, most.max(1.0) + 1.0) };
        Self { from, to, logarithmic: false, pixels }
    }

    fn at(&self, value: f64) -> f64 {
        let value = if self.logarithmic { value.max(f64::MIN_POSITIVE).log10().max(self.from) } else { value };
        self.pixels.0 + (value - self.from) / (self.to - self.from) * (self.pixels.1 - self.pixels.0)
    }

    /// Steps of 1, 2 or 5 times a power of ten; tens where logarithmic.
    fn ticks(&self, least_step: f64) -> Vec<(f64, String)> {
        if self.logarithmic {
            let between: &[f64] = if self.to - self.from > 3.0 { &[1.0] } else { &[1.0, 2.0, 5.0] };
            let exponents = self.from.floor() as i32..=self.to.floor() as i32;
            return exponents
                .flat_map(|e| between.iter().map(move |m| (m * 10f64.powi(e), decimals(e))))
                .filter(|(value, _)| (self.from..=self.to).contains(&value.log10()))
                .map(|(value, decimals)| (value, format!("{value:.decimals$}")))
                .collect();
        }
        let rough = (self.to - self.from) / 8.0;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
        let step = step.max(least_step);
        let decimals = decimals(step.log10().floor() as i32);
        let (first, last) = ((self.from / step - 1e-9).ceil() as i64, (self.to / step + 1e-9).floor() as i64);
        (first..=last).map(|n| n as f64 * step).map(|value| (value, format!("{value:.decimals$}"))).collect()
    }
}

/// Behind the point, for a power of ten.
fn decimals(exponent: i32) -> usize {
    usize::try_from(-exponent).unwrap_or(0)
}

impl Chart {
    pub fn svg(&self) -> String {
        let points: Vec<&Point> = self.series.iter().flat_map(|s| &s.points).collect();
        let longest = self.series.iter().map(|s| s.name.chars().count()).max().unwrap_or(0);
        let right = (WIDTH - 44.0 - LETTER * longest as f64).max(WIDTH / 2.0);
        let y = Axis::up(&points);
        let mut svg = Svg::new();
        svg.text((LEFT + right) / 2.0, 24.0, "middle", 14, &self.title);
        for (value, label) in y.ticks(0.0) {
            let at = y.at(value);
            svg.line((LEFT, at), (right, at), "#e3e3e3");
            svg.line((LEFT - 5.0, at), (LEFT, at), "#333333");
            svg.text(LEFT - 8.0, at + 4.0, "end", 11, &label);
        }
        match &self.form {
            Form::Bars(groups) => self.bars(&mut svg, &y, groups, right),
            Form::Lines => self.lines(&mut svg, &y, &Axis::right(&points, (LEFT + 10.0, right - 10.0))),
        }
        svg.line((LEFT, TOP), (LEFT, BOTTOM), "#333333");
        svg.line((LEFT, BOTTOM), (right, BOTTOM), "#333333");
        svg.text((LEFT + right) / 2.0, HEIGHT - 14.0, "middle", 12, &self.x);
        let scale = if y.logarithmic { ", logarithmic" } else { "" };
        svg.upwards(18.0, (TOP + BOTTOM) / 2.0, &format!("{}{scale}", self.y));
        for (index, series) in self.series.iter().enumerate() {
            let at = TOP + 8.0 + 18.0 * index as f64;
            svg.rect((right + 14.0, at - 5.0), (12.0, 10.0), colour(index));
            svg.text(right + 31.0, at + 4.0, "start", 11, &series.name);
        }
        svg.end()
    }

    fn bars(&self, svg: &mut Svg, y: &Axis, groups: &[String], right: f64) {
        let group = (right - LEFT) / groups.len().max(1) as f64;
        let bar = (0.8 * group / self.series.len().max(1) as f64).min(48.0);
        let middle = |index: f64| LEFT + group * (index + 0.5);
        for (index, name) in groups.iter().enumerate() {
            svg.text(middle(index as f64), BOTTOM + 18.0, "middle", 11, name);
        }
        for (index, series) in self.series.iter().enumerate() {
            let shift = bar * (index as f64 - self.series.len() as f64 / 2.0);
            for point in &series.points {
                let (left, top) = (middle(point.x) + shift, y.at(point.y));
                svg.rect((left + 0.05 * bar, top), (0.9 * bar, BOTTOM - top), colour(index));
                if let Some(deviation) = point.deviation.filter(|d| *d > 0.0) {
                    let (low, high) = (y.at((point.y - deviation).max(0.0)), y.at(point.y + deviation));
                    let (at, half) = (left + bar / 2.0, (0.2 * bar).min(4.0));
                    svg.line((at, low), (at, high), "#333333");
                    svg.line((at - half, high), (at + half, high), "#333333");
                    svg.line((at - half, low), (at + half, low), "#333333");
                }
            }
        }
    }

    fn lines(&self, svg: &mut Svg, y: &Axis, x: &Axis) {
        for (value, label) in x.ticks(1.0) {
            svg.line((x.at(value), BOTTOM), (x.at(value), BOTTOM + 5.0), "#333333");
            svg.text(x.at(value), BOTTOM + 18.0, "middle", 11, &label);
        }
        for (index, series) in self.series.iter().enumerate() {
            let way: Vec<(f64, f64)> = series.points.iter().map(|p| (x.at(p.x), y.at(p.y))).collect();
            svg.polyline(&way, colour(index));
            if way.len() <= MARKED {
                way.iter().for_each(|at| svg.dot(*at, colour(index)));
            }
        }
    }
}

fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}

/// The text of a drawing. Writing to a `String` cannot fail.
struct Svg(String);

impl Svg {
    fn new() -> Self {
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
             viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"Helvetica, Arial, sans-serif\" fill=\"#222222\">\n\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n"
        ))
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, size: usize, text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.0,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\">{text}</text>"
        );
    }

    fn upwards(&mut self, x: f64, y: f64, text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.0,
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\" font-size=\"12\">{text}</text>"
        );
    }

    fn line(&mut self, from: (f64, f64), to: (f64, f64), colour: &str) {
        let _ = writeln!(
            self.0,
            "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"{colour}\"/>",
            from.0, from.1, to.0, to.1
        );
    }

    fn rect(&mut self, corner: (f64, f64), size: (f64, f64), colour: &str) {
        let _ = writeln!(
            self.0,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{colour}\"/>",
            corner.0,
            corner.1,
            size.0,
            size.1.max(0.0)
        );
    }

    fn dot(&mut self, at: (f64, f64), colour: &str) {
        let _ = writeln!(self.0, "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.5\" fill=\"{colour}\"/>", at.0, at.1);
    }

    fn polyline(&mut self, way: &[(f64, f64)], colour: &str) {
        let way: Vec<String> = way.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            self.0,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"/>",
            way.join(" ")
        );
    }

    fn end(self) -> String {
        self.0 + "</svg>\n"
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
