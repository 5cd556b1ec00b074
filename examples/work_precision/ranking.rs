//! The tables: every run; the cheapest for each tolerance, what the best saves over the paper's
//! method, and the observed orders of the integrators.

use std::error::Error;
use std::path::Path;

use crate::measure::Record;

/// Tolerances of the ranking.
const TOLERANCES: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// Whether a run is within a tolerance, and so are what its mesh converges to, smaller steps on it and the
/// same steps on finer meshes: errors of mesh and step that happen to cancel are no accuracy.
fn is_within(records: &[Record], run: &Record, tolerance: f64) -> bool {
    let alike = || records.iter().filter(|other| other.model == run.model);
    let same_mesh = || alike().filter(|other| other.elements == run.elements);
    // The smallest step of the highest order comes closest.
    let limit = same_mesh().max_by(|a, b| a.order.cmp(&b.order).then(b.step.total_cmp(&a.step)));
    let smaller = |other: &&Record| other.method == run.method && other.step < run.step;
    let same = |other: &&Record| (&other.method, &other.setting) == (&run.method, &run.setting);
    let finer = alike().filter(|other| other.elements > run.elements);
    let others = finer.filter(same).chain(same_mesh().filter(smaller));
    let mut all = others.chain(limit).chain([run]);
    all.all(|other| other.error <= tolerance)
}

/// The cheapest run of those that are wanted within a tolerance.
fn cheapest(
    records: &[Record],
    tolerance: f64,
    wanted: impl Fn(&Record) -> bool,
) -> Option<&Record> {
    let wanted = records.iter().filter(|run| wanted(run));
    let good = wanted.filter(|run| is_within(records, run, tolerance));
    good.min_by(|a, b| a.seconds.total_cmp(&b.seconds))
}

/// Whether a run is the paper's full integration.
fn is_paper(record: &Record) -> bool {
    record.model.starts_with("paper: full") && !record.method.contains("when slow")
}

/// Whether a run has the paper's limit, a continuum without Poisson's ratio.
fn is_continuum(record: &Record) -> bool {
    let others = ["nu = 0.3", "rod", "cable"];
    others.iter().all(|other| !record.model.contains(other))
}

fn problems(records: &[Record]) -> Vec<(&'static str, &[Record])> {
    let parts = records.chunk_by(|a, b| a.problem == b.problem);
    parts.map(|part| (part[0].problem, part)).collect()
}

/// Writes the ranking and prints it with the observed orders.
///
/// # Errors
/// When a file cannot be written.
pub fn write(records: &[Record], out: &Path) -> Result<(), Box<dyn Error>> {
    let mut writer = csv::Writer::from_path(out.join("ranking.csv"))?;
    writer.write_record([
        "problem",
        "tolerance",
        "model",
        "elements",
        "method",
        "setting",
        "seconds",
        "error",
        "paper_over_best",
        "paper_over_best_of_its_limit",
    ])?;
    for (problem, part) in problems(records) {
        println!("\n{problem}: the cheapest run within a tolerance, and how many times dearer the");
        println!("paper's method is than it and than the best with the same limit");
        for tolerance in TOLERANCES {
            let Some(best) = cheapest(part, tolerance, |_| true) else {
                continue;
            };
            let paper = cheapest(part, tolerance, is_paper);
            let same = cheapest(part, tolerance, is_continuum);
            let over = |other: Option<&Record>| match (paper, other) {
                (Some(paper), Some(other)) => format!("{:.0}", paper.seconds / other.seconds),
                _ => "-".into(),
            };
            let (any, same) = (over(Some(best)), over(same));
            println!(
                "  {tolerance:.0e} {:>9.3} ms {any:>5} {same:>5}  {}, {} elements, {}, {}",
                1e3 * best.seconds,
                best.model,
                best.elements,
                best.method,
                best.setting
            );
            writer.write_record([
                problem,
                &format!("{tolerance:.0e}"),
                &best.model,
                &best.elements.to_string(),
                &best.method,
                &best.setting,
                &format!("{:.3e}", best.seconds),
                &format!("{:.3e}", best.error),
                &any,
                &same,
            ])?;
        }
        orders(part);
    }
    writer.flush()?;
    Ok(())
}

/// Writes every run.
///
/// # Errors
/// When the file cannot be written.
pub fn runs(records: &[Record], out: &Path) -> Result<(), Box<dyn Error>> {
    let mut writer = csv::Writer::from_path(out.join("runs.csv"))?;
    writer.write_record([
        "problem",
        "model",
        "elements",
        "method",
        "setting",
        "seconds",
        "error",
        "integrators_own_error",
        "steps",
        "iterations",
    ])?;
    for r in records {
        writer.write_record([
            r.problem,
            &r.model,
            &r.elements.to_string(),
            &r.method,
            &r.setting,
            &format!("{:.4e}", r.seconds),
            &format!("{:.4e}", r.error),
            &r.own_error.map_or(String::new(), |e| format!("{e:.4e}")),
            &r.steps.to_string(),
            &r.iterations.to_string(),
        ])?;
    }
    writer.flush()?;
    Ok(())
}

/// Prints the powers of the step with which the integrators' own errors fall from step to step.
fn orders(records: &[Record]) {
    let own: Vec<_> = records.iter().filter(|r| r.own_error.is_some()).collect();
    for series in own.chunk_by(|a, b| a.method == b.method) {
        let order = |pair: &[&Record]| {
            let [coarse, fine] = [pair[0], pair[1]].map(|r| r.own_error.unwrap_or(f64::NAN));
            let ratio = coarse / fine;
            let finer = pair[1].steps as f64 / pair[0].steps as f64;
            format!("{:.1}", ratio.log2() / finer.log2())
        };
        let orders: Vec<_> = series.windows(2).map(order).collect();
        let theory = series[0].order;
        let (method, orders) = (&series[0].method, orders.join(" "));
        println!("  order {theory} in theory, observed {orders}: {method}");
    }
}
