//! The secant force: its work is the change of energy, its torque is nothing, its viscous part
//! takes energy, and its tangent is its derivative, for every formulation, straight or curved, in the
//! plane and in space.

use ancf::prelude::*;
use ancf::solver::Matrix;

use super::models::{Solid, rubber};

/// A number between -1 and 1 for every index.
fn noise(seed: usize, i: usize) -> f64 {
    (12.9898 * (i as f64 + 1.0) + 78.233 * seed as f64).sin()
}

/// Two states of a system, far apart.
fn states(system: &impl Structure<f64>) -> [Vec<f64>; 2] {
    [1, 2].map(|seed| {
        let measure = system.measure().iter().enumerate();
        measure.map(|(i, m)| 0.2 * m * noise(seed, i)).collect()
    })
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `exact` for energies that are quartic, whose work is the change of energy to rounding.
fn check<const D: usize>(system: &System<f64, D>, viscosity: f64, exact: bool) {
    let [from, to] = states(system);
    let n = from.len();
    let energy = |u: &[f64]| {
        let mut state = system.rest();
        state.displacement.copy_from_slice(u);
        system.energies(&state).unwrap().elastic
    };
    let secant = |viscosity: f64, to: &[f64]| {
        let mut q = vec![0.0; n];
        system.add_secant(viscosity, &from, to, &mut q);
        q
    };
    let path: Vec<f64> = to.iter().zip(&from).map(|(b, a)| b - a).collect();
    let change = energy(&to) - energy(&from);
    let elastic = secant(0.0, &to);
    if exact {
        let gap = (dot(&elastic, &path) / change - 1.0).abs();
        assert!(gap < 1e-12, "work over change of energy: 1 + {gap:e}");
    }
    // No force, and about the state half way no torque.
    let scale = elastic.iter().fold(0.0_f64, |m, q| m.max(q.abs()));
    let q = secant(viscosity, &to);
    if system.secant() == Secant::Strain {
        let mut torque = [0.0; 3];
        for i in (0..n).step_by(D) {
            let e = |c: usize| match c < D {
                true => system.reference()[i + c] + 0.5 * (from[i + c] + to[i + c]),
                false => 0.0,
            };
            let force = |c: usize| if c < D { q[i + c] } else { 0.0 };
            for c in 0..3 {
                let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                torque[c] += e(a) * force(b) - e(b) * force(a);
            }
        }
        assert!(torque.iter().all(|t| t.abs() < 1e-12 * scale), "{torque:?}");
    }
    let viscous = dot(&q, &path) - dot(&elastic, &path);
    assert!(viscosity == 0.0 || viscous > 0.0);
    // The tangent against central differences.
    let mut k = Matrix::zero(system.unknowns(), false);
    system
        .add_secant_tangent((0.0, 1.0), viscosity, &from, &to, &mut k)
        .unwrap();
    let step = 1e-6;
    let mut worst = 0.0_f64;
    let mut largest = 0.0_f64;
    for j in 0..n {
        let shifted = |by: f64| {
            let mut to = to.clone();
            to[j] += by;
            secant(viscosity, &to)
        };
        let (right, left) = (shifted(step), shifted(-step));
        for i in 0..n {
            let difference = (right[i] - left[i]) / (2.0 * step);
            worst = worst.max((k.stored().get(i, j) - difference).abs());
            largest = largest.max(difference.abs());
        }
    }
    assert!(worst < 1e-8 * largest, "{worst:e} of {largest:e}");
}

fn system<const D: usize, const S: usize, E, F>(
    element: E,
    formulation: F,
    bent: bool,
) -> System<f64, D>
where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
{
    let disk = Disk::new(0.1).unwrap();
    let beam = Beam::new(element, disk, formulation);
    let unit = |k: usize| std::array::from_fn(|c| if c == k { 1.0 } else { 0.0 });
    let beam = match bent {
        false => beam.straight([0.0; D], unit(0), 1),
        true => beam.curved(1.0, 1, move |s: f64| {
            let (sin, cos) = s.sin_cos();
            let plane = |x, y| {
                let mut v = [0.0; D];
                (v[0], v[1]) = (x, y);
                v
            };
            let mut frame = std::array::from_fn(unit);
            (frame[0], frame[1]) = (plane(cos, sin), plane(-sin, cos));
            (plane(sin, 1.0 - cos), frame)
        }),
    };
    let mut scene = Scene::<f64, D>::new();
    scene.add(beam).unwrap();
    scene.assemble().unwrap()
}

#[test]
fn continua_do_the_work_exactly_and_turn_nothing() {
    for bent in [false, true] {
        for viscosity in [0.0, 0.3] {
            let plane = Continuum::selective_reduced(rubber::<2>(0.3));
            check(&system(FullyParameterised, plane, bent), viscosity, true);
            let space = Continuum::selective_reduced(rubber::<3>(0.3));
            check(&system(FullyParameterised, space, bent), viscosity, true);
            let quadratic = Continuum::full(rubber::<3>(0.0)).axial(3);
            check(&system(Quadratic, quadratic, bent), viscosity, true);
        }
    }
}

/// What is given by its energy alone takes the mean of its forces: a quartic cable does the work
/// exactly, others nearly so (to the error of two Gauss points on a way this long).
#[test]
fn energies_alone_take_the_mean_of_forces() {
    let steel = Solid::<2>::isotropic(2e7, 0.3).unwrap();
    let plane = system::<2, 6, _, _>(Quadratic, StructuralMechanics::new(&steel), false);
    assert_eq!(plane.secant(), Secant::Path);
    check(&plane, 0.0, false);
}

/// A material given by its energy alone: its mean stress and the derivative of that come from
/// duals and two Gauss points in strain, exact for this energy of the fourth degree.
#[test]
fn materials_of_fourth_degree_do_the_work_exactly() {
    #[derive(Debug, Clone)]
    struct Stiffening(Solid<2>);
    impl Material<f64, 2> for Stiffening {
        fn energy<T: Algebra<f64>>(&self, strain: &[[T; 2]; 2]) -> T {
            let quadratic = Material::<f64, 2>::energy(&self.0, strain);
            quadratic + (quadratic * quadratic).times(1e-7)
        }
    }
    let law = Continuum::full(Stiffening(rubber(0.3)));
    check(&system(FullyParameterised, law, false), 0.0, true);
}

/// Loads enter the tangent as they are half way.
#[test]
fn the_tangent_holds_the_loads() {
    let build = |moment: f64| {
        let mut scene = Scene::<f64, 2>::new();
        let disk = Disk::new(0.1).unwrap();
        let solid = Continuum::full(rubber(0.0));
        let beam = Beam::new(FullyParameterised, disk, solid);
        let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 1)).unwrap();
        scene
            .moment_in_time(beam.end(), Moment::about_z(moment), |t| t)
            .unwrap();
        scene.assemble().unwrap()
    };
    let [loaded, free] = [1e3, 0.0].map(build);
    let [from, to] = states(&loaded);
    let tangent = |system: &System<f64, 2>| {
        let mut k = Matrix::zero(system.unknowns(), false);
        system
            .add_secant_tangent((2.0, 0.5), 0.0, &from, &to, &mut k)
            .unwrap();
        k
    };
    let (with, without) = (tangent(&loaded), tangent(&free));
    let load = |to: &[f64]| {
        let middle: Vec<f64> = from.iter().zip(to).map(|(a, b)| 0.5 * (a + b)).collect();
        let mut q = vec![0.0; middle.len()];
        loaded.add_external(2.0, 0.5, &middle, &mut q).unwrap();
        q
    };
    let n = from.len();
    for j in 0..n {
        let shifted = |by: f64| {
            let mut to = to.clone();
            to[j] += by;
            load(&to)
        };
        let (right, left) = (shifted(1e-6), shifted(-1e-6));
        for i in 0..n {
            let difference = (right[i] - left[i]) / 2e-6;
            let gap = (without.stored().get(i, j) - with.stored().get(i, j) - difference).abs();
            assert!(gap < 1e-5 * 1e3, "({i}, {j}): {gap:e}");
        }
    }
}
