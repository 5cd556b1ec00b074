//! Young's modulus and radius of the paper's pendulum from a noisy record of its tip: the whole
//! simulation runs in dual numbers, so that Gauss-Newton has exact derivatives.
//! `cargo run --release --example identify`

use ancf::prelude::*;
use ancf::sweep::{Experiment, derivatives};
use nalgebra::{DMatrix, DVector, Vector2};

/// Tip positions every 10 ms up to 1 s for a Young's modulus (Pa) and a radius (m).
struct Swing;

impl Experiment<2> for Swing {
    fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let formulation = Continuum::selective_reduced(rubber);
        let mut scene = Scene::<R, 2>::new();
        let rod = Beam::new(FullyParameterised, Disk::new(radius)?, formulation)
            .straight([R::zero(); 2], [R::one(), R::zero()], 8)
            .density(R::lit(7200.0));
        let rod = scene.add(rod)?;
        scene.pin(rod.start())?;
        scene.gravity([R::zero(), R::lit(-9.81)])?;
        let system = scene.assemble()?;
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
        let mut record = Vec::new();
        for sample in 1..=100 {
            run.until(
                R::lit(0.01 * f64::from(sample)),
                Stepping::Fixed(2.5e-3),
                |_| {},
            )?;
            record.extend(system.position(run.state(), rod.end())?);
        }
        Ok(record)
    }
}

fn main() -> Result<()> {
    let truth: [f64; 2] = [2.0e7, 0.01];
    // Uniform noise of 0.1 mm (standard deviation), the same in every run.
    let mut seed = 1_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        1e-4 * 12.0_f64.sqrt() * ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    let clean = Swing.run(truth)?;
    let record: Vec<f64> = clean.into_iter().map(|x| x + noise()).collect();

    // The unknowns are logarithms; derivatives by both come from one run.
    let mut guess = Vector2::new(1.6e7_f64.ln(), 0.012_f64.ln());
    println!("    E (Pa)     R (m)  misfit (mm)");
    for _ in 0..12 {
        let parameters = [guess[0].exp(), guess[1].exp()];
        let model = derivatives(&Swing, parameters)?;
        let residual = DVector::from_fn(model.len(), |k, _| record[k] - model[k].0);
        let slope = |k: usize, i: usize| model[k].1[i] * parameters[i];
        let jacobian = DMatrix::from_fn(model.len(), 2, slope);
        let misfit = 1e3 * residual.norm() / (residual.len() as f64).sqrt();
        println!("{:10.4e} {:9.6} {misfit:9.4}", parameters[0], parameters[1]);
        let gradient = jacobian.transpose() * residual;
        let Some(step) = (jacobian.transpose() * jacobian).lu().solve(&gradient) else {
            break;
        };
        guess += Vector2::new(step[0], step[1]).map(|s| s.clamp(-0.2, 0.2));
        if step.norm() < 1e-9 {
            break;
        }
    }
    println!("{:10.4e} {:9.6}  (truth)", truth[0], truth[1]);
    Ok(())
}
