//! Claims about rounding: strains keep their digits however slender the beam and wherever it is,
//! and the study of precision finds where digits are lost.

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::verify::{ByEnergy, ByForce, ByPoints, Staged, precision};
use num_traits::Zero;
use simba::simd::WideF32x8;

/// By a third of a full turn about (1, 1, 1) every number is exact, and so is the zero.
#[test]
fn a_rotation_without_rounding_makes_no_force() {
    let steel = SaintVenantKirchhoff::<f32, 3>::isotropic(2e11, 0.3).unwrap();
    let (cycle, disk) = (|v: [f32; 3]| [v[2], v[0], v[1]], Disk::new(1e-3).unwrap());
    let reference = reference::<f32, FullyParameterised, 3, 8>(&FullyParameterised, 0.0);
    let e = reference.vectors;
    let u = std::array::from_fn(|i| std::array::from_fn(|c| cycle(e[i])[c] - e[i][c] + 4.0));
    let u = positions_only::<_, FullyParameterised, 3, 8>(u, 4.0);
    let force = |rule: &dyn Fn(&mut [[f32; 3]; 8])| {
        let mut q = [[0.0; 3]; 8];
        rule(&mut q);
        assert!(q.as_flattened().iter().all(|q| *q == 0.0), "{q:?}");
    };
    // By products in two parts and in a frame.
    let rule = CoMoving(Continuum::full(steel));
    let kernel = rule.kernel(&FullyParameterised, &reference, &disk).unwrap();
    force(&|q| kernel.force(&u, q));
    let rule = CoMoving(Continuum::full(ByPoints(steel)));
    let kernel = rule.kernel(&FullyParameterised, &reference, &disk).unwrap();
    force(&|q| kernel.force(&u, q));
    // What turns already stays as it is.
    let rule = CoMoving(CoMoving(Continuum::full(steel)));
    let kernel = rule.kernel(&FullyParameterised, &reference, &disk).unwrap();
    force(&|q| kernel.force(&u, q));
}

/// Takes a shift from the slopes.
fn positions_only<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    mut u: [[R; D]; S],
    shift: f64,
) -> [[R; D]; S] {
    for i in 0..S {
        if E::VECTORS[i % E::VECTORS.len()] != NodalVector::Position {
            u[i] = u[i].map(|c| c - R::lit(shift));
        }
    }
    u
}

/// A vector turned by `angle`.
fn turn<R: Real, const D: usize>(v: [R; D], angle: f64) -> [R; D] {
    if D == 2 {
        let (sin, cos) = (R::lit(angle.sin()), R::lit(angle.cos()));
        let turned = [v[0] * cos - v[1] * sin, v[0] * sin + v[1] * cos];
        return std::array::from_fn(|c| turned[c]);
    }
    let axis = [1.0, 2.0, 2.0].map(|c| R::lit(c) / R::lit(3.0));
    let (sin, cos) = (Field::sin(R::lit(angle)), Field::cos(R::lit(angle)));
    let along = (0..3).map(|c| axis[c] * v[c]).sum::<R>() * (R::one() - cos);
    std::array::from_fn(|c| {
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        cos * v[c] + sin * (axis[d] * v[e] - axis[e] * v[d]) + along * axis[c]
    })
}

const LENGTH: f64 = 0.25;

/// A straight element in a frame turned by `angle`.
fn reference<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    element: &E,
    angle: f64,
) -> Reference<R, D, S> {
    let axis = |a| std::array::from_fn(|c| R::lit(f64::from(u8::from(a == c))));
    let frame = std::array::from_fn(|a| turn(axis(a), angle));
    Reference::straight(element, R::lit(LENGTH), frame)
}

/// Displacements of an element deformed by `size` and turned by `angle`.
fn state<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    reference: &Reference<R, D, S>,
    size: f64,
    angle: f64,
) -> [[R; D]; S] {
    std::array::from_fn(|i| {
        let position = E::VECTORS[i % E::VECTORS.len()] == NodalVector::Position;
        let unit = if position { LENGTH } else { 1.0 };
        let wave = |c: usize| R::lit(size * unit * ((5 * i + 3 * c + 1) as f64).sin());
        let e = reference.vectors[i];
        let now: [R; D] = turn(std::array::from_fn(|c| e[c] + wave(c)), angle);
        std::array::from_fn(|c| now[c] - e[c])
    })
}

fn largest<R: Real>(numbers: &[R]) -> f64 {
    numbers.iter().fold(0.0, |top, x| x.value().abs().max(top))
}

fn close<R: Real>(what: &str, a: &[R], b: &[R], tolerance: f64) {
    let error = a.iter().zip(b).map(|(a, b)| *a - *b).collect::<Vec<_>>();
    let error = largest(&error) / largest(b);
    assert!(error <= tolerance, "{what}: {error:e} above {tolerance:e}");
}

fn flat<R: Real, const D: usize, const S: usize>(k: &Tangent<R, D, S>) -> &[R] {
    k.as_flattened().as_flattened().as_flattened()
}

/// Force and tangent of a kernel.
fn both<R: Real, const D: usize, const S: usize>(
    kernel: &impl ElementKernel<R, D, S>,
    u: &[[R; D]; S],
) -> ([[R; D]; S], Tangent<R, D, S>) {
    let (mut q, mut k) = ([[R::zero(); D]; S], [[[[R::zero(); D]; S]; D]; S]);
    kernel.tangent(u, &mut q, &mut k);
    (q, k)
}

/// Everything that must hold of a kernel in the frame, to a rounding of some hundred operations.
fn check<R: Real, E, F, const D: usize, const S: usize>(element: E, formulation: F)
where
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    let rounding = 500.0 * R::EPSILON;
    let section = Disk::new(R::lit(0.04)).unwrap();
    for (frame, size, angle) in [
        (0.0, 0.1, 0.0),
        (0.4, 0.1, 2.0),
        (0.4, 1e-2, std::f64::consts::PI),
    ] {
        let name = format!("{formulation:?} in {D} dimensions, turned by {angle}");
        let reference = reference::<R, E, D, S>(&element, frame);
        let u = state::<R, E, D, S>(&reference, size, angle);
        let plain = formulation.kernel(&element, &reference, &section).unwrap();
        let moving = || {
            CoMoving(&formulation)
                .kernel(&element, &reference, &section)
                .unwrap()
        };
        let (kernel, by_energy, by_force) = (moving(), ByEnergy(moving()), ByForce(moving()));
        let (q, k) = both(&kernel, &u);
        let (mut force, mut gradient) = ([[R::zero(); D]; S], [[R::zero(); D]; S]);
        kernel.force(&u, &mut force);
        by_energy.force(&u, &mut gradient);
        close(&name, q.as_flattened(), force.as_flattened(), rounding);
        close(&name, q.as_flattened(), gradient.as_flattened(), rounding);
        close(&name, flat(&k), flat(&both(&by_force, &u).1), rounding);
        for (i, j) in (0..S * D).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let skew = flat(&k)[i * S * D + j] - flat(&k)[j * S * D + i];
            assert!(skew.value().abs() <= rounding * largest(flat(&k)), "{name}");
        }
        // The same mechanics as without the frame, to the rounding of a strain over the strain.
        let (expected, tangent) = both(&plain, &u);
        let loose = rounding / size;
        close(&name, q.as_flattened(), expected.as_flattened(), loose);
        close(&name, flat(&k), flat(&tangent), loose);
        let energies = [kernel.energy(&u), plain.energy(&u)];
        close(&name, &energies[..1], &energies[1..], loose);
    }
}

fn families<R: Real>() {
    macro_rules! in_dimension {
        ($d:literal) => {
            let rubber = SaintVenantKirchhoff::<R, $d>::isotropic(R::lit(2e7), R::lit(0.3));
            let rubber = rubber.unwrap();
            let solid = Continuum::selective_reduced(rubber);
            check::<R, _, _, $d, { 2 * ($d + 1) }>(FullyParameterised, solid.clone());
            let points = Continuum::full(ByPoints(rubber));
            check::<R, _, _, $d, { 2 * ($d + 1) }>(FullyParameterised, points);
            check::<R, _, _, $d, { 3 * $d }>(Quadratic, solid.axial(2));
            check::<R, _, _, $d, { 3 * $d }>(Quadratic, StructuralMechanics::new(&rubber));
            check::<R, _, _, $d, 4>(Cable, EulerBernoulli::new(&rubber));
        };
    }
    in_dimension!(2);
    in_dimension!(3);
}

#[test]
fn energy_force_and_tangent_belong_together_in_the_frame() {
    families::<f64>();
    families::<f32>();
}

/// Each lane turns with an element of its own.
#[test]
fn lanes_have_frames_of_their_own() {
    let rubber = SaintVenantKirchhoff::<f32, 3>::isotropic(2e7, 0.3).unwrap();
    let reference = reference::<f32, FullyParameterised, 3, 8>(&FullyParameterised, 0.4);
    let rule = CoMoving(Continuum::full(rubber));
    let disk = Disk::new(0.04).unwrap();
    let kernel = rule.kernel(&FullyParameterised, &reference, &disk).unwrap();
    let turned = |lane: usize| state::<_, FullyParameterised, 3, 8>(&reference, 0.1, lane as f64);
    let states: [_; 8] = std::array::from_fn(turned);
    let lanes = |i: usize, c: usize| WideF32x8::from(states.map(|u| u[i][c]));
    let u = std::array::from_fn(|i| std::array::from_fn(|c| lanes(i, c)));
    let mut forces = [[WideF32x8::zero(); 3]; 8];
    kernel.force(&u, &mut forces);
    for (lane, u) in states.iter().enumerate() {
        let mut q = [[0.0; 3]; 8];
        kernel.force(u, &mut q);
        let of_lane = forces.map(|q| q.map(|q| <[f32; 8]>::from(q.0)[lane]));
        let rounding = 100.0 * f64::from(f32::EPSILON);
        close("lane", of_lane.as_flattened(), q.as_flattened(), rounding);
    }
}

/// `sqrt(1 + x^2) - 1` at a small `x` loses all digits, and to the stage that adds to one.
struct Cancelling;

impl Staged for Cancelling {
    const STAGES: &'static [&'static str] = &["root", "difference"];
    fn given<X: Real>(&self, x: f64) -> Result<Vec<X>> {
        Ok(vec![X::one() / X::lit(1.0 / x)])
    }
    fn stage<R: Real>(&self, k: usize, _: f64, x: &[R]) -> Result<Vec<R>> {
        Ok(vec![match k {
            0 => Field::sqrt(R::one() + x[0] * x[0]),
            _ => x[0] - R::one(),
        }])
    }
}

#[test]
fn the_study_blames_the_stage_that_loses_the_digits() {
    let study = precision::<f32, f64, _>(&Cancelling, &[3.0, 3e-2]).unwrap();
    let [easy, hard] = &study.rows[..] else {
        panic!("{study}")
    };
    assert!(study.digits_lost(easy) < 0.5, "{study}");
    // Half a unit in the last place of 1 is 6e-8, over a result of 4.5e-4.
    assert!(hard.error > 1e-6 && hard.error < 6e-8 / 4.5e-4, "{study}");
    let [root, difference] = &hard.shares[..] else {
        panic!("{study}")
    };
    // The input is rounded to half a unit in the last place, and its square counts.
    assert!(root.stored < 2.0 * 6e-8, "{study}");
    assert!(root.computed > 0.5 * hard.error, "{study}");
    // What the root gives is stored with the same loss; the difference itself is exact.
    assert!(
        difference.stored > 1e-6 && difference.computed < 1e-15,
        "{study}"
    );
    study.report(4.0).into_result().unwrap();
    let error = study.report(1.0).into_result().unwrap_err().to_string();
    assert!(error.contains("digits lost (at 3.0e-2)"), "{error}");
    assert!(precision::<f32, f64, _>(&Cancelling, &[]).is_err());
}
