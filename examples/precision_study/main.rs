//! What single and double precision lose on slender beams: the error of the transverse elastic
//! force over the load, against double-double at the very same stored state, in three forms; to
//! `target/precision_study.svg` and `.png`. Needs `--features double-double`.
use ancf::{Result, scalar::DoubleDouble, verify::precision};
use model::{Force, Form, Pose};
use plot::{Axis, Panel, Series, Sheet, Stroke, colour};

#[path = "../../papers/orzechowski-2012/brush.rs"]
mod brush;
#[path = "../../papers/orzechowski-2012/canvas.rs"]
mod canvas;
mod model;
#[allow(dead_code, reason = "the papers draw more than this example")]
#[path = "../../papers/orzechowski-2012/plot.rs"]
mod plot;

const RADII: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];

fn panel(title: &str, pose: Pose) -> Result<Panel> {
    let mut series = Vec::new();
    for (form, single, double) in [
        (Form::Textbook, colour::ORANGE, colour::AMBER),
        (Form::Displacements, colour::BLUE, colour::SKY),
        (Form::CoMoving, colour::GREEN, colour::PINK),
    ] {
        let bend = 0.46;
        let force = Force { form, pose, bend };
        let f32 = precision::<f32, DoubleDouble, _>(&force, &RADII)?;
        let f64 = precision::<f64, DoubleDouble, _>(&force, &RADII)?;
        for (name, tint, study) in [("f32", single, f32), ("f64", double, f64)] {
            println!("\n{title}, {form:?}, {name}; stored and computed:\n{study}");
            let rows = study.rows.iter();
            let points = rows.map(|r| [r.parameter, r.shares[0].computed]).collect();
            let name = format!("{name}, {form:?}");
            series.push(Series::new(&name, tint, Stroke::Marked, points));
        }
    }
    Ok(Panel {
        title: title.into(),
        x: Axis::log("R/L", 0.7e-5, 0.15),
        y: Axis::log("error over the load", 1e-17, 1e7),
        series,
        notes: Vec::new(),
    })
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    plot::prepare()?;
    let clamped = panel("clamped, bent by 0.46 rad", Pose::Clamped)?;
    let turned = panel("turned by 2 rad", Pose::Turned)?;
    let away = panel("ten lengths away", Pose::Away)?;
    let sheet = Sheet {
        size: [2400, 900],
        columns: 3,
        legend: 3,
        panels: vec![clamped, turned, away],
    };
    sheet.save("target".as_ref(), "precision_study")
}
