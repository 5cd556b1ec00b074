//! Figures of sections 5.2 and 5.3: trajectories, distances to the limit and energies of the
//! pendulum, its fixed-step runs, and the ramp on the cantilever.

use std::error::Error;
use std::path::Path;

use ancf::prelude::Refresh;

use crate::fixed_step;
use crate::model::Rule;
use crate::pendulum::{self, FINE, LI};
use crate::plot::{Axis, Panel, Series, Sheet, Stroke, colour};
use crate::ramp;
use crate::reference::{Curve, References};
use crate::track::Track;

type Made = Result<(), Box<dyn Error>>;

/// Figure 4 of the paper: position of the tip over time.
///
/// # Errors
/// When a file cannot be written.
pub fn trajectories(study: &pendulum::Study, refs: &References, directory: &Path) -> Made {
    let cases = [
        (6, Rule::Full, "n = 6", colour::ORANGE, Stroke::Solid),
        (10, Rule::Full, "n = 10", colour::BLUE, Stroke::Solid),
        (40, Rule::Full, "n = 40", colour::GREEN, Stroke::Solid),
        (
            40,
            Rule::SelectiveReduced,
            "n = 40, selective reduced",
            colour::PINK,
            Stroke::Solid,
        ),
    ];
    let reference = "reference: limit of the element (ν = 0), rod (ν = 0.3)";
    let mut panels = Vec::new();
    for (c, label) in [(0, "x"), (1, "y")] {
        for (poisson, curve) in [(0.3, &refs.pendulum_rod), (0.0, &refs.pendulum_limit)] {
            let mut series = Vec::new();
            for (elements, rule, name, tint, line) in cases {
                if let Some(track) = study.find(elements, poisson, rule, LI, 2.0) {
                    series.push(Series::new(name, tint, line, track.component(c)));
                }
            }
            let points = if c == 0 { curve.x() } else { curve.y() };
            series.push(Series::new(
                reference,
                colour::BLACK,
                Stroke::Dashed,
                points,
            ));
            let range = if c == 0 { [-1.2, 1.2] } else { [-1.25, 0.25] };
            panels.push(Panel {
                title: format!("Tip, {label}(t), ν = {poisson}"),
                x: Axis::linear("time [s]", 0.0, 2.0),
                y: Axis::linear(&format!("{label} [m]"), range[0], range[1]),
                series,
                notes: Vec::new(),
            });
        }
    }
    Sheet {
        size: [1800, 1340],
        columns: 2,
        legend: 3,
        panels,
    }
    .save(directory, "fig4-pendulum")
}

/// Distance of the tip to the limit of the element, over time.
///
/// # Errors
/// When a file cannot be written.
pub fn distances(study: &pendulum::Study, refs: &References, directory: &Path) -> Made {
    let distance = |track: &Track, curve: &Curve| {
        let pairs = track.samples.iter().zip(&curve.rows).skip(1);
        pairs
            .map(|(s, r)| [s.time, (s.tip[0] - r[1]).hypot(s.tip[1] - r[2])])
            .collect::<Vec<_>>()
    };
    let tints = [colour::ORANGE, colour::BLUE, colour::GREEN, colour::PINK];
    let mut series = Vec::new();
    for (elements, tint) in pendulum::MESHES.into_iter().zip(tints) {
        if let Some(track) = study.full(elements, 0.0, FINE, 2.0) {
            let points = distance(track, &refs.pendulum_limit);
            series.push(Series::new(
                &format!("n = {elements}"),
                tint,
                Stroke::Solid,
                points,
            ));
        }
    }
    let rods = refs.pendulum_rod.rows.iter().zip(&refs.pendulum_limit.rows);
    let rods = rods
        .skip(1)
        .map(|(a, b)| [a[0], (a[1] - b[1]).hypot(a[2] - b[2])])
        .collect();
    let name = "rod (ν = 0.3) against the limit: difference of the models";
    series.push(Series::new(name, colour::BLACK, Stroke::Dashed, rods));
    let panel = Panel::new(
        "Pendulum, ν = 0: distance of the tip to the limit of ever finer meshes",
        Axis::linear("time [s]", 0.0, 2.0),
        Axis::log("distance [m]", 1e-6, 1.0),
        series,
    );
    Sheet::row([1500, 940], 3, vec![panel]).save(directory, "pendulum-distance")
}

/// Figure 5 of the paper: energies over time.
///
/// # Errors
/// When a file cannot be written.
pub fn energies(study: &pendulum::Study, directory: &Path) -> Made {
    let Some(track) = study.full(6, 0.0, LI, 10.0) else {
        return Ok(());
    };
    let curve = |f: fn(&crate::track::Sample) -> f64| {
        let samples = track.samples.iter();
        samples.map(|s| [s.time, f(s)]).collect::<Vec<_>>()
    };
    let series = vec![
        Series::new(
            "kinetic",
            colour::BLUE,
            Stroke::Solid,
            curve(|s| s.energies.kinetic),
        ),
        Series::new(
            "elastic",
            colour::ORANGE,
            Stroke::Solid,
            curve(|s| s.energies.elastic),
        ),
        Series::new(
            "gravity",
            colour::GREEN,
            Stroke::Solid,
            curve(|s| s.energies.gravity),
        ),
        Series::new(
            "total",
            colour::BLACK,
            Stroke::Solid,
            curve(|s| s.energies.total()),
        ),
    ];
    let all = Panel {
        title: "Energies, n = 6, ν = 0, error-controlled Newmark".into(),
        x: Axis::linear("time [s]", 0.0, 10.0),
        y: Axis::linear("energy [J]", -15.0, 15.0),
        series,
        notes: Vec::new(),
    };
    let drift = curve(|s| 1e3 * s.energies.total());
    // The axis covers the data and zero, to the next ten beyond.
    let lowest = drift.iter().map(|p| p[1]).fold(0.0, f64::min);
    let highest = drift.iter().map(|p| p[1]).fold(0.0, f64::max);
    let [from, to] = [
        10.0 * (lowest / 10.0 - 0.2).floor(),
        10.0 * (highest / 10.0 + 0.2).ceil(),
    ];
    let total = Panel {
        title: "Total energy alone".into(),
        x: Axis::linear("time [s]", 0.0, 10.0),
        y: Axis::linear("total energy [mJ]", from, to),
        series: vec![Series::new("", colour::BLACK, Stroke::Solid, drift)],
        notes: Vec::new(),
    };
    Sheet {
        size: [1800, 840],
        columns: 2,
        legend: 4,
        panels: vec![all, total],
    }
    .save(directory, "fig5-energy")
}

/// Energy error of the fixed-step runs, with the points where they fail.
///
/// # Errors
/// When a file cannot be written.
pub fn fixed_steps(study: &fixed_step::Study, directory: &Path) -> Made {
    let tints = [
        (1e-2, "10 ms", colour::ORANGE),
        (5e-3, "5 ms", colour::AMBER),
        (2e-3, "2 ms", colour::PINK),
        (1e-3, "1 ms", colour::BLUE),
        (1e-4, "0.1 ms", colour::GREEN),
    ];
    // One axis for all panels, to the decade above the data.
    let disks = study.runs().iter().filter(|(case, _)| {
        case.shape == fixed_step::Shape::Disk && case.residual == fixed_step::RESIDUAL
    });
    let worst = disks.map(|(_, track)| track.worst_balance());
    let worst = worst.filter(|x| x.is_finite()).fold(1e-2, f64::max);
    let top = 10_f64.powf(worst.log10().floor() + 1.0);
    let mut panels = Vec::new();
    for (refresh, title) in [
        (Refresh::Never, "Tangent never renewed"),
        (Refresh::EverySolve, "Tangent renewed once per step"),
        (
            Refresh::EveryIteration,
            "Tangent renewed in every iteration",
        ),
    ] {
        let mut series = Vec::new();
        for (step, name, tint) in tints {
            let case = fixed_step::Case::disk(refresh, step);
            let Some(track) = study.find(case) else {
                continue;
            };
            let size = |x: f64| x.abs().max(1.01e-7);
            let samples = track.samples.iter().skip(1);
            let mut points: Vec<_> = samples
                .map(|s| [s.time, size(s.energies.balance())])
                .collect();
            points.push([track.reached, size(track.balance)]);
            let last = points.last().copied().into_iter().collect();
            let name = format!("step of {name}");
            series.push(Series::new(&name, tint, Stroke::Solid, points));
            if track.failure.is_some() {
                series.push(Series::new("", tint, Stroke::Crosses, last));
            }
        }
        let stopped = Series::new("the run stops", colour::BLACK, Stroke::Crosses, vec![]);
        series.push(stopped);
        let last = tints[..4]
            .iter()
            .filter_map(|(step, ..)| study.find(fixed_step::Case::disk(refresh, *step)))
            .map(|track| track.reached)
            .fold(0.0, f64::max);
        let note = format!("1 to 10 ms: stops within {:.2} s", last + 0.005);
        panels.push(Panel {
            title: title.into(),
            x: Axis::linear("time [s]", 0.0, 10.0),
            y: Axis::log("|energy error| [J]", 1e-7, top),
            series,
            notes: match refresh {
                Refresh::Never => vec![([0.4, 0.1], note)],
                _ => Vec::new(),
            },
        });
    }
    Sheet {
        size: [2100, 920],
        columns: 3,
        legend: 3,
        panels,
    }
    .save(directory, "fixed-step")
}

/// Figure 6 of the paper: deflection of the tip under the growing force.
///
/// # Errors
/// When a file cannot be written.
pub fn ramp(study: &ramp::Study, refs: &References, directory: &Path) -> Made {
    let tints = [colour::ORANGE, colour::BLUE, colour::GREEN, colour::PINK];
    let millimetres = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        points.into_iter().map(|[t, y]| [t, 1e3 * y]).collect()
    };
    let mut panels = Vec::new();
    for (title, kind, references) in [
        (
            "ν = 0.3, full integration: locked",
            (0.3, Rule::Full),
            vec![
                (
                    &refs.ramp_rod,
                    "rod (ν = 0.3) or limit of the element (ν = 0)",
                    colour::BLACK,
                ),
                (
                    &refs.ramp_locked,
                    "limit of the element with full elasticity",
                    colour::GREY,
                ),
            ],
        ),
        (
            "ν = 0.3, selective reduced integration",
            (0.3, Rule::SelectiveReduced),
            vec![(
                &refs.ramp_rod,
                "rod (ν = 0.3) or limit of the element (ν = 0)",
                colour::BLACK,
            )],
        ),
        (
            "ν = 0, full integration",
            (0.0, Rule::Full),
            vec![(
                &refs.ramp_limit,
                "rod (ν = 0.3) or limit of the element (ν = 0)",
                colour::BLACK,
            )],
        ),
        (
            "ν = 0.3, Poisson-coupled part left out",
            (0.3, Rule::ZeroPoisson),
            vec![(
                &refs.ramp_rod,
                "rod (ν = 0.3) or limit of the element (ν = 0)",
                colour::BLACK,
            )],
        ),
    ] {
        let mut series = Vec::new();
        for (elements, tint) in ramp::MESHES.into_iter().zip(tints) {
            if let Some(track) = study.find(ramp::Case::new(elements, kind)) {
                let points = millimetres(track.component(1));
                series.push(Series::new(
                    &format!("n = {elements}"),
                    tint,
                    Stroke::Solid,
                    points,
                ));
            }
        }
        for (curve, name, tint) in references {
            let points = millimetres(curve.y());
            series.push(Series::new(name, tint, Stroke::Dashed, points));
        }
        panels.push(Panel {
            title: title.into(),
            x: Axis::linear("time [s]", 0.0, 1.0),
            y: Axis::linear("tip deflection [mm]", 0.0, 60.0),
            series,
            notes: Vec::new(),
        });
    }
    Sheet {
        size: [1800, 1380],
        columns: 2,
        legend: 2,
        panels,
    }
    .save(directory, "fig6-ramp")
}
