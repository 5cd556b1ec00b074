//! Figures of the hard cases, drawn from the rows of the table.

use std::error::Error;
use std::path::Path;

use crate::plot::{Axis, Panel, Series, Sheet, Stroke, colour, prepare};
use crate::row::{Answer, Done};

type Drawn = Result<(), Box<dyn Error>>;

/// The answers of a family in one number type and formulation.
fn answers<'a>(
    rows: &'a [Done],
    family: &'a str,
    number: &'a str,
    form: &'a str,
) -> impl Iterator<Item = (&'a Done, &'a Answer)> {
    rows.iter()
        .filter(move |done| {
            let row = &done.row;
            (row.family, row.number) == (family, number) && (form.is_empty() || row.form == form)
        })
        .filter_map(|done| Some((done, done.answer()?)))
}

fn panel(title: &str, x: Axis, y: Axis, series: Vec<Series>) -> Panel {
    Panel {
        title: title.into(),
        x,
        y,
        series,
        notes: Vec::new(),
    }
}

fn save(out: &Path, name: &str, size: [u32; 2], legend: usize, panels: Vec<Panel>) -> Drawn {
    let sheet = Sheet {
        size,
        columns: panels.len(),
        legend,
        panels,
    };
    sheet.save(out, name)
}

/// Digits against slenderness: those kept and those that the report claims.
fn slenderness(rows: &[Done], out: &Path) -> Drawn {
    let mut panels = Vec::new();
    for (family, title) in [
        ("slender, small load", "tip under a small load"),
        (
            "slender, bent",
            "bent by half a radian (the mesh leaves 3 digits)",
        ),
    ] {
        let mut series = Vec::new();
        for (number, form, tint) in [
            ("f64", "full", colour::BLUE),
            ("f32", "full", colour::ORANGE),
            ("f32", "co-moving", colour::AMBER),
        ] {
            let points = |digits: &dyn Fn(&Done, &Answer) -> f64| {
                answers(rows, family, number, form)
                    .map(|(done, answer)| [done.row.parameter, digits(done, answer)])
                    .collect::<Vec<_>>()
            };
            let kept = points(&|done, _| done.digits().unwrap_or(0.0));
            let told = points(&|_, answer| -answer.told.max(1e-17).log10());
            if kept.is_empty() {
                continue;
            }
            let name = format!("{number}, {form}: digits kept");
            series.push(Series::new(&name, tint, Stroke::Marked, kept));
            if form == "full" {
                let name = format!("{number}: left by rounding, says the report");
                series.push(Series::new(&name, tint, Stroke::Dashed, told));
            }
        }
        if family == "slender, small load" {
            let line = [1e-5, 1e-1].map(|r: f64| [r, -(0.025 * r * r).log10()]);
            let name = "what a clamp that holds the section leaves";
            series.push(Series::new(name, colour::GREY, Stroke::Dashed, line.into()));
        }
        let x = Axis::log("R/L (what is missing was refused)", 0.7e-5, 0.15);
        panels.push(panel(title, x, Axis::linear("digits", 0.0, 16.0), series));
    }
    save(out, "slenderness", [2000, 900], 2, panels)
}

/// Error of the tip against the Poisson ratio for every remedy.
fn poisson(rows: &[Done], out: &Path) -> Drawn {
    let remedies = [
        ("full", colour::ORANGE, Stroke::Marked),
        ("reduced", colour::BLACK, Stroke::Dashed),
        ("selective", colour::BLUE, Stroke::Marked),
        ("zero Poisson", colour::GREEN, Stroke::Dashed),
    ];
    let series = remedies.map(|(remedy, tint, stroke)| {
        let curve = answers(rows, "Poisson", "f64", remedy).flat_map(|(_, answer)| &answer.curve);
        let points = curve.map(|[nu, error]| [1.0 - 2.0 * nu, error.max(1e-9)]);
        Series::new(remedy, tint, stroke, points.collect())
    });
    let single = answers(rows, "Poisson", "f32", "selective").flat_map(|(_, answer)| &answer.curve);
    let single = single.map(|[nu, error]| [1.0 - 2.0 * nu, *error]).collect();
    let mut series = Vec::from(series);
    series.push(Series::new(
        "selective, f32",
        colour::SKY,
        Stroke::Crosses,
        single,
    ));
    let x = Axis::log("1 - 2 nu (incompressible to the left)", 1e-7, 1.5);
    let y = Axis::log("error of the tip against the true beam", 1e-3, 2.0);
    let title = "cantilever of 8 elements, R/L = 0.01";
    save(
        out,
        "poisson",
        [1300, 900],
        3,
        vec![panel(title, x, y, series)],
    )
}

/// The rolled-up rods.
fn roll_up(rows: &[Done], out: &Path) -> Drawn {
    let mut panels = Vec::new();
    for turns in 1..=3_u8 {
        let mut series = Vec::new();
        for (number, tint, stroke) in [
            ("f64", colour::BLUE, Stroke::Solid),
            ("f32", colour::ORANGE, Stroke::Crosses),
        ] {
            let all = answers(rows, "roll-up", number, "");
            for (_, answer) in all.filter(|(done, _)| done.row.parameter == f64::from(turns)) {
                let name = match number {
                    "f64" => "f64, 160 elements, R/L = 0.005",
                    _ => "f32, 80 elements, R/L = 0.01",
                };
                // Crosses apart enough to be told from each other.
                let stride = if number == "f64" { 1 } else { 13 };
                let curve = answer.curve.iter().step_by(stride).copied().collect();
                series.push(Series::new(name, tint, stroke, curve));
            }
        }
        let half = 0.26 / f64::from(turns).sqrt();
        let x = Axis::linear("x (m)", -half, half);
        let middle = 0.5 / std::f64::consts::PI / f64::from(turns);
        let y = Axis::linear("y (m)", middle - half, middle + half);
        let title = match turns {
            1 => "one turn".into(),
            _ => format!("{turns} turns"),
        };
        panels.push(panel(&title, x, y, series));
    }
    save(out, "roll-up", [2400, 830], 2, panels)
}

/// Snap-through of the truss and lateral buckling.
fn buckling(rows: &[Done], out: &Path) -> Drawn {
    let mut snap: Vec<_> = answers(rows, "snap-through", "f64", "")
        .chain(answers(rows, "snap-through", "f32", ""))
        .filter(|(done, _)| done.row.parameter > 1e-3)
        .map(|(done, answer)| {
            let (number, height) = (done.row.number, done.row.parameter);
            let tint = if number == "f64" {
                colour::BLUE
            } else {
                colour::ORANGE
            };
            let stroke = if number == "f64" {
                Stroke::Solid
            } else {
                Stroke::Crosses
            };
            let name = format!("truss of height {height}, {number}");
            Series::new(&name, tint, stroke, answer.curve.clone())
        })
        .collect();
    for (series, tint) in
        snap.iter_mut()
            .zip([colour::BLUE, colour::SKY, colour::ORANGE, colour::AMBER])
    {
        series.colour = tint;
    }
    let mut aside: Vec<_> = answers(rows, "lateral", "f64", "")
        .filter(|(_, answer)| !answer.curve.is_empty())
        .zip([colour::GREEN, colour::PINK, colour::BROWN])
        .map(|((done, answer), tint)| {
            let name = format!("{:.0e} of the load across", done.row.parameter);
            let curve = answer.curve.iter().map(|[z, p]| [z.abs(), *p]).collect();
            Series::new(&name, tint, Stroke::Solid, curve)
        })
        .collect();
    let prandtl = vec![[0.0, 1.0], [1.0, 1.0]];
    aside.push(Series::new(
        "Prandtl's load",
        colour::BLACK,
        Stroke::Dashed,
        prandtl,
    ));
    let panels = vec![
        panel(
            "snap-through",
            Axis::linear("deflection over height", 0.0, 2.2),
            Axis::linear("load over the limit load", -1.2, 1.6),
            snap,
        ),
        panel(
            "lateral buckling of a deep cantilever",
            Axis::linear("displacement aside over length", 0.0, 0.6),
            Axis::linear("load over Prandtl's", 0.0, 1.3),
            aside,
        ),
    ];
    save(out, "buckling", [2000, 950], 4, panels)
}

/// Energies of the spinning rod and of the minute of the pendulum.
fn motion(rows: &[Done], out: &Path) -> Drawn {
    let spun = [
        ("f64", "energy-momentum", colour::BLUE),
        ("f32", "energy-momentum", colour::SKY),
        ("f64", "trapezoidal", colour::ORANGE),
        ("f64", "Gauss, 2 stages", colour::GREEN),
    ];
    let mut series = Vec::new();
    for (number, form, tint) in spun {
        for (_, answer) in answers(rows, "spin", number, form) {
            // The largest so far, which shows what a curve of noise hides.
            let mut top = 0.0_f64;
            let largest = answer.curve.iter().map(|[t, e]| {
                top = top.max(*e);
                [*t, top]
            });
            let name = format!("{number}, {form}");
            series.push(Series::new(&name, tint, Stroke::Solid, largest.collect()));
        }
    }
    let mut panels = vec![panel(
        "steel rod at 1000 rad/s",
        Axis::linear("time (s)", 0.0, 0.1),
        Axis::log("largest energy error so far, as a share", 1e-17, 1e-1),
        series,
    )];
    let swings: Vec<_> = answers(rows, "pendulum", "f64", "")
        .zip([colour::BLUE, colour::GREEN, colour::PINK])
        .map(|((done, answer), tint)| {
            Series::new(done.row.form, tint, Stroke::Solid, answer.curve.clone())
        })
        .collect();
    if !swings.is_empty() {
        let points = swings.iter().flat_map(|swing| &swing.points);
        let low = points.map(|p| p[1]).fold(0.0, f64::min);
        let low = (low * 1.1).min(-0.1);
        panels.push(panel(
            "pendulum of 6 elements, 60 s at 1 ms",
            Axis::linear("time (s)", 0.0, 60.0),
            Axis::linear(
                "energy since the start, less by viscosity (J)",
                low,
                -0.05 * low,
            ),
            swings,
        ));
    }
    let width = 1000 * panels.len() as u32;
    save(out, "motion", [width.max(1300), 900], 3, panels)
}

/// All figures.
///
/// # Errors
/// When a file cannot be written.
pub fn all(rows: &[Done], out: &Path) -> Drawn {
    prepare()?;
    slenderness(rows, out)?;
    poisson(rows, out)?;
    roll_up(rows, out)?;
    buckling(rows, out)?;
    motion(rows, out)
}
