//! Claims about natural frequencies and linear buckling loads: beams at rest, prestressed and in
//! steady rotation against the equations of beam theory, and the eigenvalues in other number types.

use ancf::prelude::*;
use ancf::solver::{Matrix, Profile, Unknowns};
use num_dual::Dual64;
use std::f64::consts::PI;

/// A straight cable of length 1 with unit bending stiffness and unit mass per length along an axis,
/// its first node held in position and direction (but not in stretch) when `held`.
fn cable<const D: usize>(
    axis: usize,
    n: usize,
    axial: f64,
    from: f64,
    held: bool,
) -> (Scene<f64, D>, Placed)
where
    Cable: Element<D, 4>,
    EulerBernoulli<f64>: Formulation<f64, Cable, D, 4>,
{
    let mut scene = Scene::<f64, D>::new();
    let along = |v: f64| std::array::from_fn(|c| if c == axis { v } else { 0.0 });
    let rule = EulerBernoulli::with_stiffness(axial, 1.0).unwrap();
    let beam = Beam::new(Cable, Moments::new(1.0, 1e-9, 1e-9).unwrap(), rule)
        .straight(along(from), along(from + 1.0), n)
        .density(1.0);
    let beam = scene.add(beam).unwrap();
    if held {
        scene.pin(beam.start()).unwrap();
        let across = std::array::from_fn(|c| c != axis);
        scene
            .fix(beam.start(), NodalVector::Slope(0), across)
            .unwrap();
    }
    (scene, beam)
}

fn rows(table: &str) -> Vec<Vec<f64>> {
    let number = |v: &str| v.parse().unwrap_or(f64::NAN);
    let lines = table.lines().skip(1);
    lines.map(|l| l.split(',').map(number).collect()).collect()
}

fn close(value: f64, truth: f64, tolerance: f64, what: &str) {
    let error = (value / truth - 1.0).abs();
    assert!(
        error < tolerance,
        "{what}: {value} is not {truth}: {error:e}"
    );
}

/// Cubic elements meet the frequencies of Euler and Bernoulli; the rigid motions of a free beam
/// cost nothing.
#[test]
fn slender_beams_vibrate_as_euler_and_bernoulli_say() {
    let table: Vec<f64> = include_str!("data/euler_bernoulli_betaL.csv")
        .lines()
        .skip(1)
        .map(|line| line.rsplit(',').next().unwrap().parse().unwrap())
        .collect();
    for (held, rigid, truth) in [(false, 3, &table[..4]), (true, 0, &table[5..9])] {
        let (scene, _) = cable::<2>(0, 32, 1e8, 0.0, held);
        let system = scene.assemble().unwrap();
        let modes = Modes::lowest(rigid + 4);
        let modes = modes.vibration(&system, &system.rest(), 1.0).unwrap();
        for mode in &modes[..rigid] {
            // Rounding of the largest stiffness over mass, some 1e14 rad^2/s^2.
            assert!(mode.value.abs() < 0.1, "rigid: {mode:?}");
        }
        for (mode, truth) in modes[rigid..].iter().zip(truth) {
            // Hermite's cubics err by (beta h)^4 / 1440.
            let mesh = (truth / 1024.0).powi(2) / 1440.0;
            close(mode.frequency(), *truth, 1.1 * mesh + 1e-6, "bending");
            assert!(mode.residual < 1e-5, "{}", mode.residual);
        }
    }
}

/// A thick square beam (L/h = 5): bending of a simply supported one by Timoshenko's frequency
/// equation, a bar fixed at one end and a shaft fixed at both. Of the shaft's inertia the half that
/// is the other cross slope's hangs on the section's own stiffness, which no shaft of theory has.
#[test]
fn thick_beams_vibrate_as_timoshenko_says() {
    let (length, h, young, density) = (2.0, 0.4, 1e9, 7850.0);
    let (shear, area) = (young / 2.6, h * h);
    // Cowper's factor of a rectangle, and the share of the polar moment that a square twists with.
    let (factor, torsion) = (13.0 / 15.3, 0.8436 * area * h * h / 6.0);
    let solid = SaintVenantKirchhoff::<f64, 3>::isotropic(young, 0.3).unwrap();
    let rule = StructuralMechanics::new(&solid)
        .with_shear_factors([factor; 2])
        .with_torsion(shear * torsion);
    let section = Rectangle::new(h, h).unwrap();

    let mut scene = Scene::<f64, 2>::new();
    let beam = Beam::new(Quadratic, section, rule);
    let beam = beam.straight([0.0; 2], [length, 0.0], 64).density(density);
    let beam = scene.add(beam).unwrap();
    scene.pin(beam.start()).unwrap();
    scene.pin(beam.end()).unwrap();
    let system = scene.assemble().unwrap();
    let modes = Modes::lowest(5).vibration(&system, &system.rest(), 1.0);
    let found: Vec<f64> = modes.unwrap().iter().map(Mode::frequency).collect();
    let axial = PI / length * (young / density).sqrt();
    let truth = [
        95.6339808811,
        332.234513637,
        axial,
        635.696288366,
        965.735466899,
    ];
    for (value, truth) in found.iter().zip(truth) {
        close(*value, truth, 2e-5, "bending");
    }

    let (rigid, polar) = (319.349808602_f64, density * area * h * h / 6.0);
    let shaft = (0..20).fold(rigid, |omega, _| {
        let hanging = 1.0 / (1.0 - omega * omega * polar / (young * area));
        rigid / (0.5 + 0.5 * hanging).sqrt()
    });
    for (held, truth) in [(1, 280.320625133), (2, shaft)] {
        let mut scene = Scene::<f64, 3>::new();
        let beam = Beam::new(Quadratic, section, rule);
        let beam = beam
            .straight([0.0; 3], [length, 0.0, 0.0], 32)
            .density(density);
        let beam = scene.add(beam).unwrap();
        for node in [beam.start(), beam.end()].into_iter().take(held) {
            scene.clamp(node).unwrap();
        }
        let system = scene.assemble().unwrap();
        let modes = Modes::lowest(8)
            .vibration(&system, &system.rest(), 1.0)
            .unwrap();
        let distance = |mode: &Mode<f64>| (mode.frequency() / truth - 1.0).abs();
        let nearest = modes.iter().map(distance).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-5, "{held} ends held, {truth}: {nearest:e}");
    }
}

/// A free circular rod in space: six rigid modes, then every bending mode twice.
#[test]
fn equal_frequencies_are_all_found() {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.3).unwrap();
    let disk = Disk::new(0.02).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(
        FullyParameterised,
        disk,
        Continuum::selective_reduced(rubber),
    );
    let beam = beam.straight([0.0; 3], [1.0, 2.0, 2.0], 24).density(1000.0);
    scene.add(beam).unwrap();
    let system = scene.assemble().unwrap();
    let rest = system.rest();
    let modes = Modes::lowest(10).vibration(&system, &rest, 1.0).unwrap();
    let first = (2.0e7_f64 / 1000.0).sqrt() * 0.01 / 9.0 * 22.373285;
    assert!(
        modes[..6]
            .iter()
            .all(|mode| mode.frequency() < 1e-3 * first)
    );
    close(modes[6].frequency(), first, 5e-3, "first bending mode");
    for pair in [6, 8] {
        let [a, b] = [&modes[pair], &modes[pair + 1]];
        close(a.frequency(), b.frequency(), 1e-8, "a pair");
        let mut momentum = vec![0.0; a.shape.len()];
        system.add_mass_times(1.0, &a.shape, &mut momentum);
        let product = |x: &[f64]| momentum.iter().zip(x).map(|(p, x)| p * x).sum::<f64>();
        assert!(product(&b.shape).abs() < 1e-8 * product(&a.shape));
    }
}

/// A simply supported beam under an axial force `N`:
/// `omega^2 = (k pi)^4 (1 + N / (k pi)^2)` with unit stiffness, mass and length. Towards Euler's
/// load the first frequency vanishes, beyond it its square is negative.
#[test]
fn axial_force_stiffens_and_softens() {
    for force in [-1.02, -0.5, 0.0, 10.0].map(|share: f64| share * PI * PI) {
        let (mut scene, beam) = cable::<2>(0, 32, 1e7, 0.0, false);
        scene.pin(beam.start()).unwrap();
        let up = [false, true];
        scene.fix(beam.end(), NodalVector::Position, up).unwrap();
        scene.force(beam.end(), [force, 0.0]).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        let report = Statics::in_steps(4).solve(&system, &mut state).unwrap();
        assert_eq!(report.unstable, Some(usize::from(force < -PI * PI)));
        let modes = Modes::lowest(3).vibration(&system, &state, 1.0).unwrap();
        for (k, mode) in modes.iter().enumerate() {
            let wave = ((k + 1) as f64 * PI).powi(2);
            let truth = wave * wave * (1.0 + force / wave);
            let error = (mode.value - truth).abs() / (wave * wave + truth.abs());
            assert!(
                error < 1e-4,
                "mode {k} under {force}: {} {truth}",
                mode.value
            );
        }
    }
}

/// Flapping and lagging of a cantilever on a hub of radius 0 and of its own length, with Coriolis
/// forces, whose coupling with stretching a slender beam does not feel.
#[test]
fn a_rotating_cantilever_meets_its_reference() {
    for row in rows(include_str!("data/rotating_cantilever_frequencies.csv")) {
        if ![0.0, 1.0, 4.0, 12.0].contains(&row[1]) {
            continue;
        }
        let (scene, beam) = cable::<3>(0, 16, 1e7, row[0], true);
        let system = scene.assemble().unwrap();
        let spinning = system.spinning([0.0, 0.0, row[1]]).unwrap();
        let mut state = system.rest();
        Statics::in_steps(2).solve(&spinning, &mut state).unwrap();
        let modes = Modes::lowest(6).vibration(&spinning, &state, 1.0).unwrap();
        let at = system
            .coordinate(beam.end(), NodalVector::Position)
            .unwrap();
        if row[1] == 0.0 {
            let pairs = modes.iter().zip([2, 2, 3, 3, 4, 4]);
            pairs.for_each(|(mode, k)| close(mode.frequency(), row[k], 1e-4, "at rest"));
            continue;
        }
        for (direction, truth) in [(2, &row[2..5]), (1, &row[5..8])] {
            let chosen = modes
                .iter()
                .filter(|mode| mode.shape[at + direction].abs() > 0.1);
            let found: Vec<f64> = chosen.map(Mode::frequency).collect();
            assert_eq!(found.len(), 3, "{row:?}: {found:?}");
            for (found, truth) in found.iter().zip(truth) {
                close(*found, *truth, 1e-4, "rotating");
            }
        }
    }
}

/// A thin shaft that spins about its own axis moves as if it did not; seen from the turning frame,
/// each of its frequencies splits into `omega - Omega` and `omega + Omega`.
#[test]
fn gyroscopic_forces_split_frequencies_exactly() {
    let (scene, _) = cable::<3>(2, 8, 1e5, 0.0, true);
    let system = scene.assemble().unwrap();
    let rest = system.rest();
    let still = Modes::lowest(4).vibration(&system, &rest, 1.0).unwrap();
    let speed = 2.0;
    let spinning = system.spinning([0.0, 0.0, speed]).unwrap();
    let modes = Modes::lowest(4).vibration(&spinning, &rest, 1.0).unwrap();
    for (k, mode) in modes.iter().enumerate() {
        let shift = if k % 2 == 0 { -speed } else { speed };
        let truth = still[k].frequency() + shift;
        close(mode.frequency(), truth, 1e-7, "split frequency");
    }
    // Faster than the first frequency only gyroscopic forces keep it up: not this problem.
    let fast = system.spinning([0.0, 0.0, 4.0]).unwrap();
    let error = Modes::lowest(1).vibration(&fast, &rest, 1.0).unwrap_err();
    assert!(matches!(error, Error::Unsupported { .. }), "{error}");
}

/// Euler's load of a clamped strut, from the unloaded state and from one under most of it.
#[test]
fn a_strut_buckles_at_eulers_load() {
    let (mut scene, beam) = cable::<2>(0, 16, 1e7, 0.0, true);
    scene.force(beam.end(), [-1.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let rest = system.rest();
    let mut state = rest.clone();
    let modes = Modes::lowest(3).buckling(&system, &state, 0.0).unwrap();
    for (k, mode) in modes.iter().enumerate() {
        let truth = ((2 * k + 1) as f64 * PI / 2.0).powi(2);
        close(mode.value, truth, 1e-5 * 25_f64.powi(k as i32), "Euler");
    }
    drop(system);
    let (mut scene, beam) = cable::<2>(0, 16, 1e7, 0.0, true);
    scene.force(beam.end(), [-2.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    Statics::default().solve(&system, &mut state).unwrap();
    let near = Modes::lowest(1).buckling(&system, &state, 1.0).unwrap();
    close(
        2.0 * near[0].value,
        PI * PI / 4.0,
        1e-5,
        "from near Euler's load",
    );
}

/// A deep narrow cantilever under a tip load across it tips over at `4.0126 sqrt(EI GJ) / L^2`
/// (Prandtl, Michell 1899), whichever way the load acts.
#[test]
fn a_deep_cantilever_buckles_sideways() {
    let stiffness = BeamStiffness {
        axial: 1e7,
        shear: [1e7; 2],
        torsion: 0.5,
        bending: [1.0, 1e5],
    };
    let rule = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(Quadratic, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    let beam = scene
        .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 32))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), [0.0, 1.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let modes = Modes::lowest(2)
        .buckling(&system, &system.rest(), 0.0)
        .unwrap();
    for mode in modes {
        close(
            mode.value.abs(),
            4.0125993436 * 0.5_f64.sqrt(),
            1e-3,
            "Prandtl",
        );
    }
}

/// The first frequency of a cantilever and its buckling load, as functions of its radius, in any
/// number type.
fn of_radius<R: Real>(radius: R) -> [R; 2]
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let material = SaintVenantKirchhoff::<R, 2>::isotropic(R::lit(2.0e7), R::zero()).unwrap();
    let mut scene = Scene::<R, 2>::new();
    let beam = Beam::new(
        FullyParameterised,
        Disk::new(radius).unwrap(),
        Continuum::full(material),
    );
    let [zero, one] = [R::zero(), R::one()];
    let beam = beam
        .straight([zero; 2], [one, zero], 6)
        .density(R::lit(1000.0));
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.force(beam.end(), [-one, zero]).unwrap();
    let system = scene.assemble().unwrap();
    let rest = system.rest();
    let frequency = Modes::lowest(1).vibration(&system, &rest, one).unwrap()[0].frequency();
    let buckling = Modes::lowest(1).buckling(&system, &rest, zero).unwrap()[0].value;
    [frequency, buckling]
}

#[test]
fn eigenvalues_carry_derivatives_and_come_in_single_precision() {
    let radius = 0.05;
    let plain = of_radius(radius);
    let dual = of_radius(Dual64::new(radius, 1.0));
    let step = 1e-4;
    let [behind, ahead] = [of_radius(radius - step), of_radius(radius + step)];
    let single = of_radius(radius as f32);
    for k in 0..2 {
        close(dual[k].re, plain[k], 1e-10, "value");
        let slope = (ahead[k] - behind[k]) / (2.0 * step);
        close(dual[k].eps, slope, 1e-5, "derivative");
        close(f64::from(single[k]), plain[k], 2e-3, "single precision");
    }
}

/// Two springs of stiffness 1 and 2 on a unit mass, alone: no beam is needed.
struct Springs(Unknowns<f64>);

impl Structure<f64> for Springs {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.0
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[f64] {
        &[1.0, 1.0]
    }
    fn add_internal(&self, u: &[f64], q: &mut [f64]) {
        q[0] += u[0];
        q[1] += 2.0 * u[1];
    }
    fn add_tangent(&self, _t: f64, _f: f64, _u: &[f64], k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, 1.0)?;
        k.add(1, 1, 2.0)
    }
    fn has_mass(&self) -> bool {
        true
    }
    fn add_mass_times(&self, factor: f64, a: &[f64], out: &mut [f64]) {
        out[0] += factor * a[0];
        out[1] += factor * a[1];
    }
    fn add_mass(&self, factor: f64, k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, factor)?;
        k.add(1, 1, factor)
    }
    fn has_gyroscopic(&self) -> bool {
        true
    }
    fn add_gyroscopic(&self, v: &[f64], out: &mut [f64]) {
        out[0] -= 3.0 * v[1];
        out[1] += 3.0 * v[0];
    }
}

/// `(1 - w^2)(2 - w^2) = 9 w^2`; all modes there are may be asked for.
#[test]
fn a_gyroscopic_pair_has_the_roots_of_its_polynomial() {
    let profile = Profile::from_ranges(2, [0..2]).unwrap();
    let springs = Springs(Unknowns::all(profile));
    let state = State {
        time: 0.0,
        displacement: vec![0.0; 2],
        velocity: vec![0.0; 2],
        acceleration: vec![0.0; 2],
        work: 0.0,
    };
    let modes = Modes::lowest(2).vibration(&springs, &state, 0.0).unwrap();
    for (mode, sign) in modes.iter().zip([-1.0, 1.0]) {
        let truth = 6.0 + sign * 34_f64.sqrt();
        close(mode.value, truth, 1e-12, "square");
    }
}

#[test]
fn eigenproblems_that_make_no_sense_are_refused() {
    let (mut scene, beam) = cable::<2>(0, 2, 1e4, 0.0, true);
    scene.force(beam.end(), [-1.0, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let rest = system.rest();
    let refused = |modes: Modes| modes.vibration(&system, &rest, 1.0).unwrap_err();
    assert!(matches!(refused(Modes::lowest(0)), Error::TooFew { .. }));
    assert!(matches!(
        refused(Modes::lowest(99)),
        Error::OutOfRange { .. }
    ));
    let tolerance = f64::NAN;
    let error = refused(Modes {
        tolerance,
        ..Modes::lowest(1)
    });
    assert!(matches!(error, Error::NotPositive { .. }));
    let error = Modes::lowest(1).vibration(&system, &rest, f64::NAN);
    assert!(matches!(error, Err(Error::NotFinite { .. })));
    assert!(system.spinning([0.0, 1.0, 0.0]).is_err());
    assert!(system.spinning([0.0, 0.0, f64::NAN]).is_err());
    let spinning = system.spinning([0.0, 0.0, 1.0]).unwrap();
    assert!(Integration::start(&spinning, system.rest(), &Newmark::trapezoidal()).is_err());

    // No load, an unstable state, no mass.
    let (scene, _) = cable::<2>(0, 2, 1e4, 0.0, true);
    let idle = scene.assemble().unwrap();
    let error = Modes::lowest(1).buckling(&idle, &idle.rest(), 0.0);
    assert!(matches!(error, Err(Error::Unsupported { .. })));
    let (scene, _) = cable::<2>(0, 2, 1e4, 0.0, false);
    let free = scene.assemble().unwrap();
    let error = Modes::lowest(1).buckling(&free, &free.rest(), 0.0);
    assert!(matches!(error, Err(Error::Unsupported { .. })));
    let mut scene = Scene::<f64, 2>::new();
    let rule = EulerBernoulli::with_stiffness(1e4, 1.0).unwrap();
    let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), rule);
    scene.add(beam.straight([0.0; 2], [1.0, 0.0], 2)).unwrap();
    let light = scene.assemble().unwrap();
    let error = Modes::lowest(1).vibration(&light, &light.rest(), 1.0);
    assert!(matches!(error, Err(Error::Unsupported { .. })));
}
