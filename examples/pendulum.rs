//! The paper's pendulum (section 5.2): a rubber rod of one metre, pinned at one end and let go
//! from the horizontal. Prints the path of the tip, the energy balance and the time per step:
//! `cargo run --release --example pendulum`.

use std::time::Instant;

use ancf::prelude::*;

fn main() -> Result<()> {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    let mut scene = Scene::<f64, 3>::new();
    let beam = scene.add(
        Beam::new(
            FullyParameterised,
            Disk::new(0.01)?,
            Continuum::full(rubber),
        )
        .straight([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 10)
        .density(7200.0),
    )?;
    scene.pin(beam.start())?;
    scene.gravity([0.0, -9.81, 0.0])?;
    let system = scene.assemble()?;
    println!("{system}\n\n  t (s)    x (m)    y (m)   energy error (J)");

    // One tangent per step: at this step size the rod turns little within a step.
    let newton = Newton {
        refresh: Refresh::EverySolve,
        ..Newton::default()
    };
    let method = Newmark::trapezoidal().with_newton(newton);
    let mut run = Integration::start(&system, system.rest(), &method)?;
    let start = Instant::now();
    for tenth in 1..=20 {
        run.until(0.1 * f64::from(tenth), Stepping::Fixed(1e-3), |_| {})?;
        let [x, y, _] = system.position(run.state(), beam.end())?;
        let error = system.energies(run.state())?.balance();
        println!("{:7.2} {x:8.4} {y:8.4} {error:12.1e}", run.state().time);
    }
    let report = run.report();
    println!(
        "\n{:.1} us per step, {:.2} iterations and {:.2} tangents per step",
        1e6 * start.elapsed().as_secs_f64() / report.steps as f64,
        report.iterations as f64 / report.steps as f64,
        report.tangents as f64 / report.steps as f64,
    );
    Ok(())
}
