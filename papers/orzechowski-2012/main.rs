//! Reproduces G. Orzechowski, "Analysis of beam elements of circular cross section using the
//! absolute nodal coordinate formulation", Archive of Mechanical Engineering 59 (2012): its three
//! examples, its figures and every claim it makes about them, with the evidence for or against.
//! Ends with a table of claims; the exit status is that of the table.

mod check_dynamic;
mod check_static;
mod claims;
mod figures_dynamic;
mod figures_static;
mod fixed_step;
mod model;
mod parallel;
mod pendulum;
mod plot;
mod ramp;
mod reference;
mod static_bending;
mod tables;
mod track;
mod turned;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser;
use indicatif::{ProgressBar, ProgressStyle};

/// What the command line offers.
#[derive(Debug, Parser)]
#[command(about = "Reproduces Orzechowski 2012: circular beams in the ANCF")]
struct Options {
    /// Directory for tables and figures.
    #[arg(long, default_value = "target/orzechowski-2012")]
    out: PathBuf,
    /// Leave out the longest runs of the pendulum and the claims that need them.
    #[arg(long)]
    quick: bool,
}

/// A bar on a terminal; elsewhere a line when a stage begins.
fn bar(what: &'static str, cases: usize) -> Result<ProgressBar, Box<dyn Error>> {
    let bar = ProgressBar::new(cases as u64).with_message(what);
    if bar.is_hidden() {
        eprintln!("{what}: {cases} cases");
    }
    let style = "{msg:<28} {bar:40} {pos:>3}/{len} cases, {elapsed}";
    bar.set_style(ProgressStyle::with_template(style)?);
    Ok(bar)
}

/// The end of a stage, with a line where there is no terminal.
fn done(bar: &ProgressBar) {
    bar.finish();
    if bar.is_hidden() {
        let seconds = bar.elapsed().as_secs_f64();
        eprintln!("{}: done in {seconds:.0} s", bar.message());
    }
}

fn run(options: &Options) -> Result<bool, Box<dyn Error>> {
    let start = Instant::now();
    let out = &options.out;
    std::fs::create_dir_all(out)?;
    plot::prepare()?;
    let references = reference::References::load()?;
    let mut claims = check_static::integration()?;

    let progress = bar("5.1 static bending", static_bending::cases().len())?;
    let bending = static_bending::Study::run(&progress);
    done(&progress);
    tables::roll_up(&bending, out)?;
    figures_static::all(&bending, out)?;
    claims.extend(check_static::bending(&bending)?);

    let progress = bar("5.2 pendulum", pendulum::cases(options.quick).len())?;
    let swing = pendulum::Study::run(options.quick, &progress)?;
    done(&progress);
    tables::pendulum(&swing, out)?;
    figures_dynamic::trajectories(&swing, &references, out)?;
    figures_dynamic::distances(&swing, &references, out)?;
    figures_dynamic::energies(&swing, out)?;
    claims.extend(check_dynamic::pendulum(&swing, &references)?);

    let progress = bar("5.2 fixed steps", fixed_step::cases(options.quick).len())?;
    let fixed = fixed_step::Study::run(options.quick, &progress)?;
    done(&progress);
    tables::fixed_step(&fixed, out)?;
    figures_dynamic::fixed_steps(&fixed, out)?;
    claims.extend(check_dynamic::fixed_steps(&fixed));

    let progress = bar("5.3 ramp", ramp::cases().len())?;
    let loading = ramp::Study::run(&progress)?;
    done(&progress);
    tables::ramp(&loading, out)?;
    figures_dynamic::ramp(&loading, &references, out)?;
    claims.extend(check_dynamic::ramp(&loading, &references)?);

    tables::claims(&claims, out)?;
    println!("{}", claims::table(&claims));
    let checked = claims.iter().filter(|claim| claim.checked()).count();
    let failed = claims.iter().filter(|claim| !claim.passed()).count();
    println!(
        "{} of {checked} checks pass, {} more figures are reported; {:.0} s; tables and figures in {}",
        checked - failed,
        claims.len() - checked,
        start.elapsed().as_secs_f64(),
        out.display()
    );
    Ok(failed == 0)
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
