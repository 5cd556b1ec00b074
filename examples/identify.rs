//! Young's modulus and radius of the paper's pendulum from a noisy record of its tip: the whole
//! simulation runs in dual numbers, so that Gauss-Newton has exact derivatives.
use ancf::prelude::*;
use ancf::sweep::{Experiment, derivatives};
use nalgebra::{Matrix2, Vector2};

/// Tip positions every 10 ms up to 1 s for a Young's modulus (Pa) and a radius (m).
struct Swing;

impl Experiment<2> for Swing {
    fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let rubber = Continuum::selective_reduced(rubber);
        let mut scene = Scene::<R, 2>::new();
        let rod = Beam::new(FullyParameterised, Disk::new(radius)?, rubber)
            .straight([R::zero(); 2], [R::one(), R::zero()], 8)
            .density(R::lit(7200.0));
        let rod = scene.add(rod)?;
        scene.pin(rod.start())?;
        scene.gravity([R::zero(), R::lit(-9.81)])?;
        let system = scene.assemble()?;
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
        let mut record = Vec::new();
        for sample in 1..=100 {
            let time = R::lit(0.01 * f64::from(sample));
            run.until(time, Stepping::Fixed(2.5e-3), |_| {})?;
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
    let mut record = Swing.run(truth)?;
    record.iter_mut().for_each(|x| *x += noise());

    // The unknowns are logarithms; derivatives by both come from one run.
    let mut guess = Vector2::new(1.6e7_f64.ln(), 0.012_f64.ln());
    println!("    E (Pa)     R (m)  misfit (mm)");
    for _ in 0..12 {
        let parameters = guess.map(f64::exp);
        let (mut normal, mut gradient, mut square) = (Matrix2::zeros(), Vector2::zeros(), 0.0);
        let model = derivatives(&Swing, parameters.into())?;
        for ((position, slope), measured) in model.into_iter().zip(&record) {
            let (slope, off) = (
                parameters.component_mul(&Vector2::from(slope)),
                measured - position,
            );
            normal += slope * slope.transpose();
            gradient += slope * off;
            square += off * off;
        }
        let misfit = 1e3 * (square / record.len() as f64).sqrt();
        println!("{:10.4e} {:9.6} {misfit:9.4}", parameters[0], parameters[1]);
        let step = normal.lu().solve(&gradient).unwrap_or_default();
        guess += step.map(|s| s.clamp(-0.2, 0.2));
        if step.norm() < 1e-6 {
            break;
        }
    }
    println!("{:10.4e} {:9.6}  (truth)", truth[0], truth[1]);
    Ok(())
}
