//! Tables of results as CSV files, for other programs to read.

use std::error::Error;
use std::path::Path;

use crate::claims::{Claim, HEADINGS};
use crate::model::Rule;
use crate::track::Track;
use crate::{fixed_step, pendulum, ramp, static_bending};

type Made = Result<(), Box<dyn Error>>;

fn write<const N: usize>(
    path: &Path,
    headings: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> Made {
    let mut writer = csv::Writer::from_path(path)?;
    writer.write_record(headings)?;
    for row in rows {
        writer.write_record(row)?;
    }
    writer.flush()?;
    Ok(())
}

/// The claims with their verdicts.
///
/// # Errors
/// When the file cannot be written.
pub fn claims(claims: &[Claim], directory: &Path) -> Made {
    let mut headings = HEADINGS;
    headings[0] = "section";
    let rows = claims.iter().map(Claim::cells);
    write(&directory.join("claims.csv"), headings, rows)
}

/// Every roll-up.
///
/// # Errors
/// When the file cannot be written.
pub fn roll_up(study: &static_bending::Study, directory: &Path) -> Made {
    let rows = study.outcomes.iter().map(|outcome| {
        let case = outcome.case;
        let place = |c: usize| {
            let tip = outcome.tip.as_ref();
            tip.map_or(String::new(), |tip| format!("{:.9}", tip[c]))
        };
        [
            case.elements.to_string(),
            case.radius.to_string(),
            case.law.0.into(),
            case.rule.name(),
            case.poisson.to_string(),
            case.turn.to_string(),
            place(0),
            place(1),
            place(2),
            format!("{:.6}", outcome.gap()),
            outcome.tip.as_ref().err().cloned().unwrap_or_default(),
        ]
    });
    let headings = [
        "elements", "radius_m", "moment", "rule", "poisson", "turn_deg", "x_m", "y_m", "z_m",
        "gap_mm", "failure",
    ];
    write(&directory.join("roll_up.csv"), headings, rows)
}

fn track(track: &Track, path: &Path) -> Made {
    let headings = [
        "t_s",
        "x_m",
        "y_m",
        "z_m",
        "kinetic_J",
        "elastic_J",
        "gravity_J",
        "work_J",
    ];
    let rows = track.samples.iter().map(|s| {
        let e = s.energies;
        let [x, y, z] = s.tip.map(|c| format!("{c:.10}"));
        let [t, v, g, w] = [e.kinetic, e.elastic, e.gravity, e.work].map(|e| format!("{e:.9e}"));
        [format!("{:.2}", s.time), x, y, z, t, v, g, w]
    });
    write(path, headings, rows)
}

fn slug(rule: Rule) -> String {
    rule.name().replace(' ', "-")
}

/// Every run of the pendulum, and its effort and energy in one table.
///
/// # Errors
/// When a file cannot be written.
pub fn pendulum(study: &pendulum::Study, directory: &Path) -> Made {
    for (case, run) in study.runs() {
        let steps = case.steps.name();
        let rule = slug(case.rule);
        let (n, nu, end) = (case.elements, case.poisson, case.end);
        let name = format!("pendulum_n{n}_nu{nu}_{rule}_{steps}_{end}s.csv");
        track(run, &directory.join(name))?;
    }
    let rows = study.runs().iter().map(|(case, run)| {
        let report = run.report;
        [
            case.elements.to_string(),
            case.poisson.to_string(),
            case.rule.name(),
            case.steps.name(),
            case.end.to_string(),
            report.steps.to_string(),
            report.rejected.to_string(),
            report.failed.to_string(),
            report.iterations.to_string(),
            format!("{:.6}", run.energy_error(2.0)),
            format!("{:.6}", run.energy_error(case.end)),
        ]
    });
    let headings = [
        "elements",
        "poisson",
        "rule",
        "stepping",
        "end_s",
        "steps",
        "rejected",
        "failed",
        "iterations",
        "energy_error_to_2s_J",
        "energy_error_to_end_J",
    ];
    write(&directory.join("pendulum.csv"), headings, rows)
}

/// Every run of the ramp.
///
/// # Errors
/// When a file cannot be written.
pub fn ramp(study: &ramp::Study, directory: &Path) -> Made {
    for (case, run) in study.runs() {
        let (n, (nu, rule), step) = (case.elements, case.kind, case.step);
        let name = format!("ramp_n{n}_nu{nu}_{}_step{step}.csv", slug(rule));
        track(run, &directory.join(name))?;
    }
    Ok(())
}

/// Every fixed-step run in one line.
///
/// # Errors
/// When the file cannot be written.
pub fn fixed_step(study: &fixed_step::Study, directory: &Path) -> Made {
    let rows = study.runs().iter().map(|(case, run)| {
        [
            format!("{:?}", case.shape),
            case.rule.name(),
            case.tangent().into(),
            case.step.to_string(),
            case.residual.to_string(),
            format!("{:.4}", run.reached),
            format!("{:.4e}", run.balance),
            format!("{:.4e}", run.worst_balance()),
            run.report.steps.to_string(),
            run.report.at_floor.to_string(),
            run.report.iterations.to_string(),
            format!("{:.2e}", run.out_of_plane()),
            run.failure.clone().unwrap_or_default(),
        ]
    });
    let headings = [
        "section",
        "rule",
        "tangent_renewed",
        "step_s",
        "residual",
        "reached_s",
        "energy_error_J",
        "largest_energy_error_J",
        "steps",
        "steps_at_rounding_floor",
        "iterations",
        "out_of_plane_m",
        "failure",
    ];
    write(&directory.join("fixed_step.csv"), headings, rows)
}
