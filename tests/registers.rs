//! Narrower registers give the same run: AVX2 to the last bit, baseline code within rounding, scene by
//! scene and with scenes in lanes. One test only in this file, for the limit holds for all threads.

use ancf::prelude::*;
use ancf::scalar::Registers;
use ancf::sweep::{Experiment, Sweep};

/// The tip of a spatial pendulum for `[E, R]`: symmetric tangents.
struct Pendulum;
/// The tip of a planar one whose energy is conserved: general tangents.
struct Conserved;

fn axis<R: Real, const D: usize>(a: usize, size: R) -> [R; D] {
    std::array::from_fn(|c| if c == a { size } else { R::zero() })
}

macro_rules! falls {
    ($name:ty, $d:literal, $method:expr) => {
        impl Experiment<2> for $name {
            fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
                let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
                let formulation = Continuum::selective_reduced(rubber);
                let beam = Beam::new(FullyParameterised, Disk::new(radius)?, formulation);
                let beam = beam.straight([R::zero(); $d], axis(0, R::one()), 5);
                let mut scene = Scene::<R, $d>::new();
                let rod = scene.add(beam.density(R::lit(7200.0)))?;
                scene.pin(rod.start())?;
                scene.gravity(axis(1, R::lit(-9.81)))?;
                let system = scene.assemble()?;
                let mut run = Integration::start(&system, system.rest(), &$method)?;
                run.until(R::lit(0.05), Stepping::Fixed(1e-3), |_| {})?;
                Ok(system.position(run.state(), rod.end())?.to_vec())
            }
        }
    };
}
falls!(Pendulum, 3, Newmark::trapezoidal());
falls!(Conserved, 2, {
    let method = EnergyMomentum::conserving();
    method.with_newton(Newton {
        refresh: Refresh::EverySolve,
        ..method.newton
    })
});

/// Tips of eleven pendulums in registers no wider than these, one by one and in lanes.
fn tips(experiment: &impl Experiment<2>, registers: Registers) -> [Vec<f64>; 2] {
    registers.limit();
    let rows = (0..11).map(|n| [2e7 * (1.0 + 0.1 * f64::from(n)), 0.01]);
    let alone = Sweep::list(rows.collect()).unwrap();
    let lanes = alone.clone().in_lanes();
    [alone, lanes].map(|sweep| {
        let results = sweep.run(experiment);
        let tips = results
            .rows()
            .iter()
            .map(|row| row.outputs.clone().unwrap());
        tips.flatten().collect()
    })
}

fn check(name: &str, experiment: &impl Experiment<2>, found: Registers) {
    let all = [Registers::Avx512, Registers::Avx2, Registers::Baseline];
    let [widest, narrower, baseline] = all.map(|registers| tips(experiment, registers));
    assert_eq!(widest, narrower, "{name}");
    for [alone, lanes] in [&widest, &baseline] {
        assert_eq!(alone, lanes, "{name}");
    }
    assert_eq!(widest == baseline, found == Registers::Baseline, "{name}");
    for (a, b) in widest[0].iter().zip(&baseline[0]) {
        // Newton stops at 1e-10 of the forces, which bend the rod by a tenth of its length.
        assert!((a - b).abs() < 1e-10, "{name}: {a} and {b}");
    }
}

#[test]
fn narrower_registers_give_the_same_run() {
    let found = Registers::widest();
    check("symmetric tangents", &Pendulum, found);
    check("general tangents", &Conserved, found);
    Registers::Avx2.limit();
    assert!(Registers::widest() <= found.min(Registers::Avx2));
}
