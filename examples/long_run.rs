//! Long runs with the energy-momentum method: the paper's pendulum of six elements through sixty
//! seconds at a nominal step of 1 ms, where the trapezoidal rule is lost after 14 s with a hundred
//! times the energy there was, and a hundred thousand steps of a free beam:
//! `cargo run --release --example long_run`.
//!
//! What it took: the force of a step is the one whose work is the change of energy, so no fast
//! mode can grow; Newton's method goes to the residual that rounding leaves, because whatever
//! residual remains does work in every step; a guess that misleads Newton's method is replaced by a
//! calmer one, and a step that fails all the same is made of two halves.
//!
//! Past some seconds the pendulum whips in all three dimensions and its energy spreads over modes
//! that no step of a millisecond resolves. Viscosity takes it from there, and what has gone there is
//! much: in a minute a viscosity of 1e-8 takes 0.04 % of the energy exchanged, 1e-7 takes 0.3 %, 1e-6
//! 3.4 %, and whatever empties those modes as they fill, such as 1e-3, most of it. While the motion is
//! smooth, to 5 s, even 1e-6 takes 3e-5. A Kelvin-Voigt material of the retardation time 1e-3 s times
//! the viscosity is the same at these steps.

use ancf::prelude::*;

fn main() -> Result<()> {
    let conserving = EnergyMomentum::conserving();
    // Where a step turns the motion about, the tangent of the last one is of no use: with a new one
    // in every iteration half as many are needed.
    let newton = Newton {
        refresh: Refresh::EveryIteration,
        ..conserving.newton
    };
    println!("pendulum, 1 ms, conserving");
    pendulum(&conserving.with_newton(newton))?;
    for viscosity in [1e-8, 1e-3] {
        println!("\npendulum, 1 ms, viscosity {viscosity:e}");
        pendulum(&EnergyMomentum::dissipating(viscosity).with_newton(newton))?;
    }
    println!("\nfree beam, 1 ms, conserving");
    free(&conserving)
}

/// Sixty seconds of the pendulum.
fn pendulum(scheme: &EnergyMomentum) -> Result<()> {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    let mut scene = Scene::<f64, 3>::new();
    let rod = Beam::new(
        FullyParameterised,
        Disk::new(0.01)?,
        Continuum::full(rubber),
    );
    let rod = scene.add(rod.straight([0.0; 3], [1.0, 0.0, 0.0], 6).density(7200.0))?;
    scene.pin(rod.start())?;
    scene.gravity([0.0, -9.81, 0.0])?;
    let system = scene.assemble()?;
    let mut run = Integration::start(&system, system.rest(), scheme)?;
    let stepping = Stepping::Halved {
        step: 1e-3,
        halvings: 10,
    };
    let (mut worst, mut exchanged) = (0.0_f64, 0.0_f64);
    let (mut before, mut most) = (0, 0);
    println!(
        "  t (s)  worst energy error (J)  most kinetic energy (J)  steps failed  iterations per step, most"
    );
    for end in [1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0] {
        run.until(end, stepping, |step| {
            let energies = system.energies(step.after)?;
            worst = worst.max(energies.balance().abs());
            exchanged = exchanged.max(energies.kinetic);
            most = most.max(step.report.iterations - before);
            before = step.report.iterations;
            Ok(())
        })?;
        let report = run.report();
        println!(
            "{end:7.0} {worst:23.1e} {exchanged:24.2} {:13} {:20.1} {most:5}",
            report.failed,
            report.iterations as f64 / report.steps as f64
        );
    }
    Ok(())
}

/// A hundred thousand steps of a planar rod that forces on its ends have set spinning, bent and sent off.
fn free(scheme: &EnergyMomentum) -> Result<()> {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.3)?;
    let mut scene = Scene::<f64, 2>::new();
    let rod = Beam::new(
        FullyParameterised,
        Disk::new(0.01)?,
        Continuum::selective_reduced(rubber),
    );
    let rod = scene.add(rod.straight([0.0, 0.0], [1.0, 0.0], 3).density(7200.0))?;
    let on = |t: f64| if t < 0.2 { 1.0 } else { 0.0 };
    scene.force_in_time(rod.end(), [5.0, 20.0], on)?;
    scene.force_in_time(rod.start(), [-4.0, -18.0], on)?;
    scene.moment_in_time(rod.start(), Moment::about_z(0.3), on)?;
    let system = scene.assemble()?;
    let mut run = Integration::start(&system, system.rest(), scheme)?;
    run.until(0.25, Stepping::Fixed(1e-3), |_| {})?;
    let energy = system.energies(run.state())?.balance();
    let start = system.momenta(run.state())?;
    println!("  steps  energy drift (J)  linear momentum (kg m/s)  angular momentum (kg m^2/s)");
    for tenth in 1..=10 {
        run.until(
            0.25 + 10.0 * f64::from(tenth),
            Stepping::Fixed(1e-3),
            |_| {},
        )?;
        let now = system.momenta(run.state())?;
        let drift = system.energies(run.state())?.balance() - energy;
        let [x, y] = std::array::from_fn(|c| now.linear[c] - start.linear[c]);
        let turn = now.angular[2] - start.angular[2];
        println!(
            "{:7} {drift:17.1e} {:25.1e} {turn:28.1e}",
            10_000 * tenth,
            x.hypot(y)
        );
    }
    Ok(())
}
