//! Claims about when Newton's method may stop above its tolerance: at what rounding leaves, whoever
//! wrote the material, and never anywhere else.

use ancf::material::Tensor;
use ancf::prelude::*;
use ancf::solver::{Matrix, Profile, StaticReport, Unknowns};

/// Mooney and Rivlin's law in the invariants of `C = 1 + 2 E`, as in the book: at small strains
/// it forms differences of numbers near one and loses all but a few digits of the stress.
#[derive(Debug, Clone, Copy)]
struct MooneyRivlin(f64, f64);

impl Material<f64, 2> for MooneyRivlin {
    fn energy<T: Algebra<f64>>(&self, e: &Tensor<T, 2>) -> T {
        let (two, three) = (T::lit(2.0), T::lit(3.0));
        let [x, y] = [0, 1].map(|a| T::one() + two * e[a][a]);
        let area = x * y - (two * e[0][1]) * (two * e[1][0]);
        // Plane strain: the third principal value of C is one.
        let (first, second, log) = (x + y + T::one(), area + x + y, area.ln());
        (first - log - three).times(self.0) + (second - two * log - three).times(self.1)
    }
}

const C: [f64; 2] = [2e5, 3e5];

/// A cantilever of 1 m whose tip load turns its end by `turn` if it is thin: what the solver says, and
/// the deflection over that of Timoshenko's beam.
fn cantilever(radius: f64, turn: f64) -> (Result<StaticReport>, f64) {
    let disk = Disk::new(radius).unwrap();
    let law = Continuum::full(MooneyRivlin(C[0], C[1])).axial(2);
    let mut scene = Scene::<f64, 2>::new();
    let beam = Beam::new(Quadratic, disk, law).straight([0.0; 2], [1.0, 0.0], 8);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    // Moduli at small strain; a section that cannot warp bends with that of uniaxial strain.
    let shear = 2.0 * (C[0] + C[1]);
    let modulus = 2.0 * shear + 4.0 * C[1];
    let bending = modulus * std::f64::consts::PI * radius.powi(4) / 4.0;
    let load = 2.0 * turn * bending;
    scene.force(beam.end(), [0.0, load]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let solved = Statics::default().solve(&system, &mut state);
    let tip = system.displacement(&state, beam.end()).unwrap();
    let gyration = radius * radius / 4.0;
    let exact = load / (3.0 * bending) * (1.0 + 3.0 * gyration * modulus / shear);
    (solved, tip[1] / exact)
}

/// The residual ends a hundred times and more above the tolerance, at what rounding leaves of such
/// a stress; the report says so, and the deflection has the digits it can have.
#[test]
fn a_material_that_cancels_ends_at_its_rounding() {
    for (radius, turn) in [(0.02, 1e-4), (0.02, 1e-6), (0.002, 1e-4)] {
        let (solved, ratio) = cantilever(radius, turn);
        let report = solved.unwrap();
        assert!(report.at_floor && report.residual > 1e-9, "{report:?}");
        // Large deflections come with the square of the angle.
        let near = 1e-8 + turn * turn;
        assert!(
            (ratio - 1.0).abs() < near,
            "{radius} m, {turn} rad: {ratio}"
        );
    }
}

/// A spring whose force is known to a few digits only, and its tangent with an error.
struct Spring {
    unknowns: Unknowns<f64>,
    /// The force is a multiple of this (N).
    grain: f64,
    /// The tangent given over the true one.
    tangent: f64,
}

impl Structure<f64> for Spring {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[f64] {
        &[1.0]
    }
    fn add_internal(&self, u: &[f64], q: &mut [f64]) {
        let force = u[0] + u[0].powi(3);
        q[0] += match self.grain {
            0.0 => force,
            grain => (force / grain).round() * grain,
        };
    }
    fn add_external(&self, _: f64, factor: f64, _: &[f64], q: &mut [f64]) -> Result<()> {
        q[0] += factor / 3.0;
        Ok(())
    }
    fn add_tangent(&self, _: f64, _: f64, u: &[f64], k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, self.tangent * (1.0 + 3.0 * u[0] * u[0]))
    }
    fn has_mass(&self) -> bool {
        false
    }
    fn add_mass_times(&self, _: f64, _: &[f64], _: &mut [f64]) {}
    fn add_mass(&self, _: f64, _: &mut Matrix<f64>) -> Result<()> {
        Ok(())
    }
}

fn stretch(grain: f64, tangent: f64) -> Result<(StaticReport, f64)> {
    let unknowns = Unknowns::all(Profile::from_ranges(1, [0..1]).unwrap());
    let spring = Spring {
        unknowns,
        grain,
        tangent,
    };
    let mut state = State {
        time: 0.0,
        displacement: vec![0.0],
        velocity: vec![0.0],
        acceleration: vec![0.0],
        work: 0.0,
    };
    let report = Statics::default().solve(&spring, &mut state)?;
    Ok((report, state.displacement[0]))
}

/// Forces that jump far above rounding, and tangents that are not those of the force, fail however
/// small the residual and the corrections get: neither is at rounding.
#[test]
fn what_stalls_above_rounding_is_refused() {
    let (report, exact) = stretch(0.0, 1.0).unwrap();
    assert!(!report.at_floor && report.residual < 1e-10);
    assert!((exact + exact.powi(3) - 1.0 / 3.0).abs() < 1e-10);
    for grain in [1e-4, 1e-7, 1e-9] {
        let refused = stretch(grain, 1.0);
        assert!(
            matches!(refused, Err(Error::StaticsFailed { .. })),
            "{grain}: {refused:?}"
        );
    }
    // A tangent off by a third still converges, one a hundred times too stiff creeps and one
    // too soft by half swings for ever.
    let (_, slow) = stretch(0.0, 1.3).unwrap();
    assert!((slow / exact - 1.0).abs() < 1e-9);
    for tangent in [100.0, 0.5, -1.0] {
        let refused = stretch(0.0, tangent);
        assert!(refused.is_err(), "{tangent}: {refused:?}");
    }
}
