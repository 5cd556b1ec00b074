//! Figures: error against processor time, for every model the best of its runs, and for every
//! integrator its own error on one mesh.

use std::error::Error;
use std::path::Path;

use plotters::style::RGBColor;

use crate::measure::Record;
use crate::plot::{Axis, Panel, Series, Sheet, Stroke, colour};

const COLOURS: [RGBColor; 8] = [
    colour::ORANGE,
    colour::BLUE,
    colour::GREEN,
    colour::PINK,
    colour::AMBER,
    colour::SKY,
    colour::BROWN,
    colour::GREY,
];

/// The runs that no other beats in both time and error, cheapest first.
fn front(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.retain(|p| p.iter().all(|v| v.is_finite() && *v > 0.0));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut best = f64::INFINITY;
    points.retain(|p| {
        let better = p[1] < best;
        best = best.min(p[1]);
        better
    });
    points
}

/// Points of time (ms) and error of the runs of one name, in the order of the names.
fn by_name<'a>(
    records: impl Iterator<Item = &'a Record>,
    name: impl Fn(&Record) -> &str,
    error: impl Fn(&Record) -> f64,
) -> Vec<(String, Vec<[f64; 2]>)> {
    let mut groups: Vec<(String, Vec<[f64; 2]>)> = Vec::new();
    for record in records {
        let point = [1e3 * record.seconds, error(record)];
        match groups.iter_mut().find(|(other, _)| other == name(record)) {
            Some((_, points)) => points.push(point),
            None => groups.push((name(record).into(), vec![point])),
        }
    }
    groups
}

/// A decade that contains a bound.
fn decade(value: f64, round: impl Fn(f64) -> f64) -> f64 {
    10_f64.powf(round(value.log10()))
}

fn panel(title: &str, y: &str, series: Vec<Series>) -> Panel {
    let points = || series.iter().flat_map(|s| &s.points);
    let range = |c: usize| {
        let values = points().map(|p| p[c]);
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        (decade(low, f64::floor), decade(high, f64::ceil))
    };
    let (x, e) = (range(0), range(1));
    Panel {
        title: title.into(),
        x: Axis::log("processor time (ms)", x.0, x.1),
        y: Axis::log(y, e.0.max(1e-10), e.1.min(1.0)),
        series,
        notes: Vec::new(),
    }
}

/// Draws a problem.
///
/// # Errors
/// When a file cannot be written.
pub fn draw(title: &str, records: &[Record], out: &Path) -> Result<(), Box<dyn Error>> {
    let Some(first) = records.first() else {
        return Ok(());
    };
    let everything = records.iter().map(|r| [1e3 * r.seconds, r.error]);
    let mut series = vec![Series::new(
        "best of all",
        RGBColor(215, 215, 215),
        Stroke::Solid,
        front(everything.collect()),
    )];
    let models = by_name(records.iter(), |r| &r.model, |r| r.error);
    for (k, (name, points)) in models.into_iter().enumerate() {
        let dashed = k >= COLOURS.len();
        let stroke = if dashed {
            Stroke::Dashed
        } else {
            Stroke::Marked
        };
        let colour = COLOURS[k % COLOURS.len()];
        series.push(Series::new(&name, colour, stroke, front(points)));
    }
    let error = "error over the tip's way";
    Sheet {
        size: [1800, 1500],
        columns: 1,
        legend: 2,
        panels: vec![panel(title, error, series)],
    }
    .save(out, first.problem)?;
    let own = || records.iter().filter(|r| r.own_error.is_some());
    if own().next().is_none() {
        return Ok(());
    }
    let methods = by_name(own(), |r| &r.method, |r| r.own_error.unwrap_or(f64::NAN));
    let series = methods.into_iter().enumerate().map(|(k, (name, points))| {
        let dashed = k >= COLOURS.len();
        let stroke = if dashed {
            Stroke::Dashed
        } else {
            Stroke::Marked
        };
        Series::new(&name, COLOURS[k % COLOURS.len()], stroke, points)
    });
    let error = "integrator's own error over the tip's way";
    let title = format!("{title}: integrators on 8 quadratic rods in the plane");
    Sheet {
        size: [1800, 1400],
        columns: 1,
        legend: 2,
        panels: vec![panel(&title, error, series.collect())],
    }
    .save(out, &format!("{}-integrators", first.problem))
}
