//! Figures of section 5.1: the roll-up, convergence over the mesh, locking of thin beams, and
//! the order-2 rule turned about the axis.

use std::error::Error;
use std::path::Path;

use ancf::analytical::EndMoment;
use plotters::style::RGBColor;

use crate::model::Rule;
use crate::plot::{Axis, Panel, Series, Sheet, Stroke, colour};
use crate::static_bending::{Case, LAWS, RADII, RADIUS, Study, TURNS, limit};

type Made = Result<(), Box<dyn Error>>;

/// All figures of the section.
///
/// # Errors
/// When a file cannot be written or a shape has no equilibrium.
pub fn all(study: &Study, directory: &Path) -> Made {
    roll_up(directory)?;
    convergence(study, directory)?;
    locking(study, directory)?;
    turned(study, directory)
}

/// The outline of a bent beam and its axis.
fn outline(case: Case, share: f64, name: &str, tint: RGBColor) -> Result<Series, Box<dyn Error>> {
    let [mut upper, mut lower, _] = case.shape(share)?;
    lower.reverse();
    upper.append(&mut lower);
    Ok(Series::new(name, tint, Stroke::Filled, upper))
}

/// The paper's figure 3: the beam on its way to a circle, and a close view of the gap.
fn roll_up(directory: &Path) -> Made {
    let beam = Case::new(20, Rule::Full);
    let mut rolling = Vec::new();
    for share in [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875] {
        rolling.push(outline(beam, share, "", colour::SKY)?);
    }
    let name = "n = 20, exact rule";
    rolling.push(outline(beam, 1.0, name, colour::BLUE)?);
    let notes = [
        ([0.82, 0.055], "M = 0"),
        ([0.91, 0.395], "1/8"),
        ([0.62, 0.665], "1/4"),
        ([0.33, 0.76], "3/8"),
        ([-0.09, 0.64], "1/2"),
        ([-0.27, 0.46], "5/8"),
        ([-0.315, 0.19], "3/4"),
        ([-0.235, 0.02], "7/8"),
        ([-0.05, 0.16], "2π EI/L"),
    ];
    let shapes = Panel {
        title: "Shares of the moment 2π EI/L, drawn to scale".into(),
        x: Axis::linear("x [m]", -0.35, 1.05),
        y: Axis::linear("y [m]", -0.1, 0.8),
        series: rolling,
        notes: notes.map(|(at, note)| (at, note.into())).into(),
    };
    let mut close = Vec::new();
    for (elements, rule, name, tint) in [
        (160, Rule::Full, "n = 160, exact rule", colour::GREEN),
        (20, Rule::Full, name, colour::BLUE),
        (20, Rule::Reduced, "n = 20, paper's rule", colour::ORANGE),
    ] {
        let case = Case::new(elements, rule);
        let [mut upper, lower, mut axis] = case.shape(1.0)?;
        // Only the last part of the beam: the first overlaps the clamp.
        let keep = upper.len() * 9 / 10;
        let tip = [
            *upper.last().unwrap_or(&[0.0; 2]),
            *lower.last().unwrap_or(&[0.0; 2]),
        ];
        upper.drain(..keep);
        axis.drain(..keep);
        let end = axis.last().copied().into_iter().collect();
        close.push(Series::new("", tint, Stroke::Solid, upper));
        close.push(Series::new("", tint, Stroke::Solid, lower[keep..].to_vec()));
        close.push(Series::new("", tint, Stroke::Solid, tip.to_vec()));
        close.push(Series::new(name, tint, Stroke::Dashed, axis));
        close.push(Series::new("", tint, Stroke::Crosses, end));
    }
    let clamp = [[0.0, -RADIUS], [0.0, RADIUS]].to_vec();
    close.push(Series::new("clamp", colour::BLACK, Stroke::Solid, clamp));
    let origin = vec![[0.0, 0.0]];
    close.push(Series::new("", colour::BLACK, Stroke::Crosses, origin));
    let gap = Panel {
        title: "Close view of the end at the full moment".into(),
        x: Axis::linear("x [m]", -0.045, 0.045),
        y: Axis::linear("y [m]", -0.03, 0.028),
        series: close,
        notes: vec![([-0.010, -0.0245], "clamped end".into())],
    };
    Sheet {
        size: [1800, 681],
        columns: 2,
        legend: 4,
        panels: vec![shapes, gap],
    }
    .save(directory, "fig3-roll-up")
}

fn level(name: &str, tint: RGBColor, value: f64) -> Series {
    let line = vec![[1.0, value], [400.0, value]];
    Series::new(name, tint, Stroke::Dashed, line)
}

/// Gap over the mesh for every definition of the moment and for both rules.
fn convergence(study: &Study, directory: &Path) -> Made {
    let tints = [
        colour::BLUE,
        colour::GREEN,
        colour::AMBER,
        colour::PINK,
        colour::GREY,
        colour::SKY,
        colour::BROWN,
    ];
    let names = [
        "a1: conjugate to the rotation of r_y",
        "a2: follower couple on r_y",
        "a3: traction along the tangent",
        "d2: second Piola traction",
        "b1: conjugate to the rotation of r_x",
        "c1: mean rotation of the triad",
        "c2: polar rotation",
    ];
    let mut curves = Vec::new();
    for (k, law) in LAWS.into_iter().enumerate() {
        let case = Case {
            law,
            ..Case::new(0, Rule::Full)
        };
        let points = study.over_meshes(case);
        curves.push(Series::new(names[k], tints[k], Stroke::Marked, points));
    }
    // The default moment is drawn over the others.
    curves.rotate_left(1);
    let reduced = study.over_meshes(Case::new(0, Rule::Reduced));
    let name = "a1 with the paper's rule";
    curves.push(Series::new(name, colour::ORANGE, Stroke::Marked, reduced));
    let limits = [
        (EndMoment::Conjugate, Rule::Full, colour::BLUE, ""),
        (EndMoment::NormalToSlope, Rule::Full, colour::GREEN, ""),
        (EndMoment::SecondPiola, Rule::Full, colour::PINK, ""),
        (EndMoment::Conjugate, Rule::Reduced, colour::ORANGE, ""),
    ];
    for (kind, rule, tint, name) in limits {
        curves.push(level(name, tint, limit(RADIUS, kind, rule)?));
    }
    let paper = "the paper's 8.3 mm (n = 20)";
    let at = vec![[20.0, 8.3]];
    curves.push(Series::new(paper, colour::BLACK, Stroke::Crosses, at));
    let all = Panel {
        title: "Gap between the ends, R = 20 mm".into(),
        x: Axis::log("elements n", 2.0, 200.0),
        y: Axis::log("gap [mm]", 0.1, 2000.0),
        series: curves.clone(),
        notes: Vec::new(),
    };
    let near = Panel {
        title: "The same near the limits (dashed)".into(),
        x: Axis::log("elements n", 10.0, 200.0),
        y: Axis::linear("gap [mm]", 0.0, 30.0),
        series: curves,
        notes: Vec::new(),
    };
    Sheet {
        size: [1800, 1080],
        columns: 2,
        legend: 3,
        panels: vec![all, near],
    }
    .save(directory, "roll-up-convergence")
}

/// Gap over the mesh for three radii: thin beams lock.
fn locking(study: &Study, directory: &Path) -> Made {
    let tints = [colour::BLUE, colour::GREEN, colour::ORANGE];
    let mut series = Vec::new();
    for (radius, tint) in RADII.into_iter().zip(tints) {
        let case = Case {
            radius,
            ..Case::new(0, Rule::Full)
        };
        let exact = limit(radius, EndMoment::Conjugate, Rule::Full)?;
        let name = format!("R = {} mm", 1e3 * radius);
        let points = study.over_meshes(case);
        series.push(Series::new(&name, tint, Stroke::Marked, points));
        let name = format!("R = {} mm, limit {exact:.4} mm", 1e3 * radius);
        series.push(level(&name, tint, exact));
    }
    let panel = Panel {
        title: "Thickness locking: the thinner the beam, the finer the mesh it needs".into(),
        x: Axis::log("elements n", 2.0, 200.0),
        y: Axis::log("gap [mm]", 0.03, 2000.0),
        series,
        notes: Vec::new(),
    };
    Sheet {
        size: [1500, 960],
        columns: 1,
        legend: 2,
        panels: vec![panel],
    }
    .save(directory, "roll-up-thin-beams")
}

/// Gap and way out of the plane when the rule is turned about the axis.
fn turned(study: &Study, directory: &Path) -> Made {
    let curve = |rule, out: bool| {
        let point = |turn: f64| {
            let case = Case {
                turn,
                ..Case::new(20, rule)
            };
            let outcome = study.find(case)?;
            let value = if out {
                outcome.out_of_plane()
            } else {
                outcome.gap()
            };
            Some([turn, value])
        };
        TURNS.into_iter().filter_map(point).collect::<Vec<_>>()
    };
    let two = "order 2, 4 points (the paper's rule)";
    let three = "order 3, 7 points (exact)";
    let panel = |title: &str, label: &str, to: f64, out: bool| Panel {
        title: title.into(),
        x: Axis::linear("turn of the integration points [°]", 0.0, 90.0),
        y: Axis::linear(label, if out { -0.5 } else { 5.0 }, to),
        series: vec![
            Series::new(
                two,
                colour::ORANGE,
                Stroke::Marked,
                curve(Rule::Reduced, out),
            ),
            Series::new(three, colour::BLUE, Stroke::Marked, curve(Rule::Full, out)),
        ],
        notes: Vec::new(),
    };
    Sheet {
        size: [1800, 800],
        columns: 2,
        legend: 2,
        panels: vec![
            panel("Gap, n = 20", "gap [mm]", 9.0, false),
            panel(
                "Tip out of the plane of bending, n = 20",
                "|z| [mm]",
                4.0,
                true,
            ),
        ],
    }
    .save(directory, "turned-rule")
}
