//! A material of your own is its strain energy: a compressible Mooney-Rivlin rubber, checked,
//! stretched and bent. `cargo run --release --example custom_material`.
use ancf::{material::Tensor, prelude::*, verify};

/// `psi = c1 (I1 - 3 - 2 ln J) + c2 (I2 - 3 - 4 ln J)` (Pa) of the invariants of `C = 1 + 2 E`.
#[derive(Debug, Clone, Copy)]
struct MooneyRivlin(f64, f64);

impl Material<f64, 3> for MooneyRivlin {
    fn energy<T: Algebra<f64>>(&self, e: &Tensor<T, 3>) -> T {
        let c = |a: usize, b: usize| e[a][b] + e[a][b] + T::lit((a == b) as u8 as f64);
        let minor = |a, b| c(a, a) * c(b, b) - c(a, b) * c(a, b);
        let mixed = c(0, 1) * (c(1, 2) * c(0, 2) - c(0, 1) * c(2, 2))
            + c(0, 2) * (c(0, 1) * c(1, 2) - c(0, 2) * c(1, 1));
        let log = (c(0, 0) * minor(1, 2) + mixed).ln();
        (c(0, 0) + c(1, 1) + c(2, 2) - log - T::lit(3.0)).times(self.0)
            + (minor(0, 1) + minor(1, 2) + minor(2, 0) - log - log - T::lit(3.0)).times(self.1)
    }
}

/// Tip displacement (m) of a beam of one metre that is free to contract at its support.
fn tip(law: MooneyRivlin, radius: f64, force: f64, moment: f64) -> Result<[f64; 3]> {
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(FullyParameterised, Disk::new(radius)?, Continuum::full(law));
    let beam = scene.add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 8))?;
    scene.pin(beam.start())?;
    for a in 0..3 {
        let sideways = std::array::from_fn(|c| c != a);
        scene.fix(beam.start(), NodalVector::Slope(a), sideways)?;
    }
    scene.force(beam.end(), [force, 0.0, 0.0])?;
    scene.moment(beam.end(), Moment::about_z(moment))?;
    let system = scene.assemble()?;
    let mut state = system.rest();
    Statics::in_steps(10).solve(&system, &mut state)?;
    system.displacement(&state, beam.end())
}

fn main() -> Result<()> {
    let (c1, c2, radius) = (2e5, 3e5, 0.02_f64);
    let (law, mu, lambda) = (MooneyRivlin(c1, c2), 2.0 * (c1 + c2), 4.0 * c2);
    let nu = 0.5 * lambda / (lambda + mu);
    let small = verify::linear_elasticity(&law, 2.0 * mu * (1.0 + nu), nu)?;
    println!("{}", verify::material(&law).and(small).into_result()?);
    let area = std::f64::consts::PI * radius * radius;
    for l in [0.7, 0.9, 1.2, 1.5, 2.0_f64] {
        // The flanks are free at the square m of the stretch across that makes dpsi/dm zero.
        let b = c1 + c2 * l * l;
        let m = ((b * b + 4.0 * c2 * (c1 + 2.0 * c2)).sqrt() - b) / (2.0 * c2);
        let stress = (2.0 * c1 * (l * l - 1.0) + 4.0 * c2 * (l * l * m - 1.0)) / l;
        let found = 1.0 + tip(law, radius, area * stress, 0.0)?[0];
        println!("stretched to {found:.9}, exact {l}");
    }
    // A section that can shrink but not warp bends with the modulus of uniaxial strain.
    let (turn, stiffness) = (0.5_f64, (lambda + 2.0 * mu) * area * radius * radius / 4.0);
    let [_, y, _] = tip(law, radius, 0.0, turn * stiffness)?;
    let exact = (1.0 - turn.cos()) / turn;
    println!("bent by {y:.5}, {exact:.5} for a thin beam that cannot warp");
    Ok(())
}
