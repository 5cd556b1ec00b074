//! Narrower registers give the same run: AVX2 to the last bit, baseline code within rounding, scene by
//! scene and with scenes in lanes. In doubles, AVX2 and AVX-512 differ where forces and masses are added up
//! and where packs go; in singles likewise. In a process of their own, for the limit holds for all threads.

use std::process::Command;

use ancf::prelude::*;
use ancf::scalar::Registers;
use ancf::sweep::{Experiment, Sweep};
use ancf::verify::ByPoints;

/// A planar rod that is swung at one inner node and held at another: its tip, the work of what swings
/// it and what supports carry. Forms, symmetric tangents.
struct Swung;
/// The tip of a planar pendulum whose energy is conserved: general tangents.
struct Conserved;
/// The tip of a planar cantilever, sampled point by point.
struct Sampled;
/// The tip of a spatial cantilever that turns: products in two parts.
struct Spatial;

fn axis<R: Real, const D: usize>(a: usize, size: R) -> [R; D] {
    std::array::from_fn(|c| if c == a { size } else { R::zero() })
}

/// A rod of nine elements, which leave lanes of the last group empty.
fn rod<R: Real, M, const D: usize>(
    radius: R,
    formulation: Continuum<M>,
) -> Result<Beam<R, FullyParameterised, Continuum<M>, Disk<R>, D>> {
    let beam = Beam::new(FullyParameterised, Disk::new(radius)?, formulation);
    let placed = beam.straight([R::zero(); D], axis(0, R::one()), 9);
    Ok(placed.density(R::lit(7200.0)))
}

impl Experiment<2> for Swung {
    fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let mut scene = Scene::<R, 2>::new();
        let rod = scene.add(rod(radius, Continuum::selective_reduced(rubber))?)?;
        struct Swing;
        impl<R: Real> Motion<R, 2> for Swing {
            fn at<T: Algebra<R>>(&self, time: T) -> [T; 2] {
                let swing = (T::one() - (time * T::lit(20.0)).cos()) * T::lit(0.01);
                [T::lit(1.0 / 3.0), swing]
            }
        }
        let (swung, held, end) = (rod.node(3), rod.node(6), rod.end());
        scene.drive(swung, NodalVector::Position, [false, true], Swing)?;
        scene.pin(held)?;
        scene.gravity(axis(1, R::lit(-9.81)))?;
        let system = scene.assemble()?;
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal())?;
        run.until(R::lit(0.05), Stepping::Fixed(1e-3), |_| {})?;
        let state = run.state();
        let mut out = system.position(state, end)?.to_vec();
        out.push(state.work);
        out.extend(system.reactions(state)?);
        Ok(out)
    }
}

impl Experiment<2> for Conserved {
    fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let mut scene = Scene::<R, 2>::new();
        let rod = scene.add(rod(radius, Continuum::selective_reduced(rubber))?)?;
        scene.pin(rod.start())?;
        scene.gravity(axis(1, R::lit(-9.81)))?;
        let system = scene.assemble()?;
        let method = EnergyMomentum::conserving();
        let method = method.with_newton(Newton {
            refresh: Refresh::EverySolve,
            ..method.newton
        });
        let mut run = Integration::start(&system, system.rest(), &method)?;
        run.until(R::lit(0.05), Stepping::Fixed(1e-3), |_| {})?;
        Ok(system.position(run.state(), rod.end())?.to_vec())
    }
}

impl Experiment<2> for Sampled {
    fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
        let rubber = ByPoints(SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?);
        let mut scene = Scene::<R, 2>::new();
        let rod = scene.add(rod(radius, Continuum::full(rubber))?)?;
        scene.clamp(rod.start())?;
        scene.force(rod.end(), axis(1, R::lit(-0.2)))?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        Statics::in_steps(3).solve(&system, &mut state)?;
        Ok(system.position(&state, rod.end())?.to_vec())
    }
}

impl Experiment<2> for Spatial {
    fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let turning = CoMoving(Continuum::selective_reduced(rubber));
        let mut scene = Scene::<R, 3>::new();
        let beam = Beam::new(FullyParameterised, Disk::new(radius)?, turning);
        let rod = scene.add(beam.straight([R::zero(); 3], axis(0, R::one()), 9))?;
        scene.clamp(rod.start())?;
        scene.force(rod.end(), [R::zero(), R::lit(-0.2), R::lit(0.1)])?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        Statics::in_steps(3).solve(&system, &mut state)?;
        Ok(system.position(&state, rod.end())?.to_vec())
    }
}

const ROWS: usize = 11;

fn row(n: usize) -> [f64; 2] {
    [2e7 * (1.0 + 0.1 * n as f64), 0.01]
}

/// All rows in registers no wider than these: one by one, in lanes, and the first in single precision.
fn results(experiment: &impl Experiment<2>, registers: Registers) -> ([Vec<f64>; 2], Vec<f32>) {
    Registers::limit(registers);
    assert_eq!(Registers::widest(), registers);
    let alone = Sweep::list((0..ROWS).map(row).collect()).unwrap();
    let lanes = alone.clone().in_lanes();
    let doubles = [alone, lanes].map(|sweep| {
        let results = sweep.run(experiment);
        let rows = results
            .rows()
            .iter()
            .map(|row| row.outputs.clone().unwrap());
        rows.flatten().collect()
    });
    let single = experiment.run(row(0).map(|x| x as f32)).unwrap();
    (doubles, single)
}

fn check(name: &str, experiment: &impl Experiment<2>, found: &[Registers]) {
    let all: Vec<_> = found.iter().map(|one| results(experiment, *one)).collect();
    for ([alone, lanes], _) in &all {
        assert!(alone == lanes, "{name}: lanes of scenes");
    }
    let ([baseline, _], single) = &all[0];
    for wide in &all[1..] {
        assert!(wide == &all[1], "{name}: AVX2 and AVX-512");
        let ([alone, _], own) = wide;
        assert!(
            alone != baseline,
            "{name}: nothing is fused in baseline code"
        );
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let apart: Vec<f64> = alone.iter().zip(baseline).map(|(a, b)| a - b).collect();
        // Newton's method stops at 1e-10 of the forces.
        let error = largest(&apart) / largest(baseline);
        assert!(error < 1e-9, "{name}: baseline code is off by {error:e}");
        for (a, b) in own.iter().zip(single) {
            assert!(
                (a - b).abs() < 1e-2 * (1.0 + b.abs()),
                "{name}: {a} and {b}"
            );
        }
    }
}

/// Set where this program runs itself.
const ALONE: &str = "ANCF_REGISTERS_ALONE";

#[test]
fn narrower_registers_give_the_same_run() {
    if std::env::var_os(ALONE).is_none() {
        let run = Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "registers::narrower_registers_give_the_same_run"])
            .env(ALONE, "1")
            .output()
            .unwrap();
        let said = [&run.stdout, &run.stderr].map(|text| String::from_utf8_lossy(text));
        let ran = run.status.success() && said[0].contains("1 passed");
        assert!(ran, "{}: {}", run.status, said.join("\n"));
        return;
    }
    let found: Vec<_> = Registers::available().collect();
    #[cfg(target_arch = "x86_64")]
    let expected = {
        let avx2 = std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
        1 + usize::from(avx2) + usize::from(avx2 && std::is_x86_feature_detected!("avx512f"))
    };
    #[cfg(not(target_arch = "x86_64"))]
    let expected = 1;
    assert_eq!(found.len(), expected);
    check("forms", &Swung, &found);
    check("general tangents", &Conserved, &found);
    check("samples", &Sampled, &found);
    check("space", &Spatial, &found);
}
