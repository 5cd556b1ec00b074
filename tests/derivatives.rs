//! Claims about one element: the elastic force is the gradient of the strain energy and the
//! tangent the gradient of the force (dual numbers are the independent truth), rigid motions cost
//! nothing, and the same kernel runs in lanes. For both dimensions, every section, every remedy.

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use num_dual::DualSVec64;
use proptest::prelude::*;
use simba::simd::WideF64x4;

const LENGTH: f64 = 0.3;

fn sections() -> Vec<Box<dyn Section<f64>>> {
    vec![
        Box::new(Disk::new(0.04).unwrap()),
        Box::new(Annulus::new(0.05, 0.03).unwrap()),
        Box::new(Rectangle::new(0.08, 0.03).unwrap()),
    ]
}

fn remedies<const D: usize>() -> Vec<Continuum<SaintVenantKirchhoff<f64, D>>> {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.3).unwrap();
    let solid = SaintVenantKirchhoff::isotropic(2.0e7, 0.0).unwrap();
    vec![
        Continuum::full(rubber),
        Continuum::reduced(rubber),
        Continuum::sampled(rubber, 3, 7),
        Continuum::zero_poisson(rubber),
        Continuum::selective_reduced(rubber),
        Continuum::full(solid),
    ]
}

/// A frame turned out of the global axes.
fn frame<const D: usize>() -> [[f64; D]; D] {
    let (s, c) = 0.7_f64.sin_cos();
    let (p, q) = 0.4_f64.sin_cos();
    let space = [[c * q, s * q, p], [-s, c, 0.0], [-c * p, -s * p, q]];
    let plane = [[c, s, 0.0], [-s, c, 0.0]];
    std::array::from_fn(|a| std::array::from_fn(|i| if D == 3 { space[a][i] } else { plane[a][i] }))
}

/// Runs a check on the kernels of every section and remedy.
macro_rules! for_every_kernel {
    ($d:literal, $s:literal, $check:expr) => {
        for section in sections() {
            for remedy in remedies::<$d>() {
                let kernel = Formulation::<f64, FullyParameterised, $d, $s>::kernel(
                    &remedy,
                    &FullyParameterised,
                    &Reference::straight(&FullyParameterised, LENGTH, frame::<$d>()),
                    &*section,
                )
                .unwrap();
                $check(&kernel);
            }
        }
    };
}

/// Nodal displacements with components up to `size` (times the length for positions).
fn displacements<const D: usize, const S: usize>(seed: &[f64], size: f64) -> [[f64; D]; S] {
    std::array::from_fn(|i| {
        let unit = if i % (D + 1) == 0 { LENGTH } else { 1.0 };
        std::array::from_fn(|c| size * unit * seed[i * D + c])
    })
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m, v| v.abs().max(m))
}

fn check_derivatives<K, const D: usize, const S: usize, const N: usize>(
    kernel: &K,
    u: &[[f64; D]; S],
) where
    K: ElementKernel<f64, D, S>,
{
    let dual: [[DualSVec64<N>; D]; S] = std::array::from_fn(|i| {
        std::array::from_fn(|c| DualSVec64::from_re(u[i][c]).derivative(i * D + c))
    });
    let energy = kernel.energy(&dual);
    let mut dual_force = [[DualSVec64::<N>::from_re(0.0); D]; S];
    kernel.force(&dual, &mut dual_force);
    let mut force = [[0.0; D]; S];
    let mut tangent: Tangent<f64, D, S> = [[[[0.0; D]; S]; D]; S];
    kernel.tangent(u, &mut force, &mut tangent);

    let mut plain = [[0.0; D]; S];
    kernel.force(u, &mut plain);
    let gradient = |x: DualSVec64<N>, k: usize| x.eps.0.map_or(0.0, |eps| eps[k]);
    let force = force.as_flattened();
    let scale = largest(force);
    let rows = tangent.as_flattened().as_flattened().as_flattened();
    let stiffest = largest(rows);
    for i in 0..N {
        assert!((force[i] - plain.as_flattened()[i]).abs() <= 1e-12 * scale);
        assert!(
            (force[i] - gradient(energy, i)).abs() <= 1e-12 * scale,
            "force {i}: {} against {}",
            force[i],
            gradient(energy, i)
        );
        for j in 0..N {
            let truth = gradient(dual_force.as_flattened()[i], j);
            assert!(
                (rows[i * N + j] - truth).abs() <= 1e-12 * stiffest,
                "tangent ({i}, {j}): {} against {truth}",
                rows[i * N + j]
            );
            let skew = rows[i * N + j] - rows[j * N + i];
            assert!(skew.abs() <= 1e-14 * stiffest, "symmetry ({i}, {j})");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..Default::default() })]

    #[test]
    fn force_and_tangent_are_gradients_in_space(
        seed in prop::collection::vec(-1.0..1.0_f64, 24),
        size in prop_oneof![Just(1e-3), Just(0.3)],
    ) {
        let u = displacements::<3, 8>(&seed, size);
        for_every_kernel!(3, 8, |kernel| check_derivatives::<_, 3, 8, 24>(kernel, &u));
    }

    #[test]
    fn force_and_tangent_are_gradients_in_the_plane(
        seed in prop::collection::vec(-1.0..1.0_f64, 12),
        size in prop_oneof![Just(1e-3), Just(0.3)],
    ) {
        let u = displacements::<2, 6>(&seed, size);
        for_every_kernel!(2, 6, |kernel| check_derivatives::<_, 2, 6, 12>(kernel, &u));
    }

    #[test]
    fn rigid_motion_of_any_size_costs_nothing(
        axis in prop::array::uniform3(-1.0..1.0_f64),
        angle in -6.0..6.0_f64,
        shift in prop::array::uniform3(-1e3..1e3_f64),
    ) {
        let norm = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
        prop_assume!(norm > 0.1);
        let n = axis.map(|a| a / norm);
        let r = nalgebra::Rotation3::from_axis_angle(
            &nalgebra::Unit::new_normalize(nalgebra::Vector3::from(n)), angle);
        let frame = frame::<3>();
        let u: [[f64; 3]; 8] = std::array::from_fn(|i| {
            let e = match (i % 4, i / 4) {
                (0, node) => frame[0].map(|c| c * LENGTH * node as f64),
                (a, _) => frame[a - 1],
            };
            let turned = r * nalgebra::Vector3::from(e);
            std::array::from_fn(|c| turned[c] - e[c] + if i % 4 == 0 { shift[c] } else { 0.0 })
        });
        for_every_kernel!(3, 8, |kernel| check_rigid(kernel, &u));
    }
}

/// A strain of `rounding` in every point would store this energy; coordinates of size 1e3 m carry
/// rounding of 1e3 eps, over the length of the element.
fn check_rigid<K: ElementKernel<f64, 3, 8>>(kernel: &K, u: &[[f64; 3]; 8]) {
    let largest_shift = u.iter().flatten().fold(1.0_f64, |m, v| v.abs().max(m));
    let rounding = 16.0 * f64::EPSILON * largest_shift / LENGTH;
    let stretch = 1e-3;
    let frame = frame::<3>();
    let stretched: [[f64; 3]; 8] = std::array::from_fn(|i| match (i % 4, i / 4) {
        (0, node) => frame[0].map(|c| c * stretch * LENGTH * node as f64),
        (1, _) => frame[0].map(|c| c * stretch),
        _ => [0.0; 3],
    });
    let unit = kernel.energy(&stretched) / (stretch * stretch);
    let energy = kernel.energy(u);
    assert!(
        energy.abs() <= 10.0 * unit * rounding * rounding,
        "energy {energy} of a rigid motion, {} allowed",
        10.0 * unit * rounding * rounding
    );
}

#[test]
fn rigid_motion_in_the_plane_costs_nothing() {
    let frame = frame::<2>();
    for angle in [0.1, 1.0, 3.0, 100.0] {
        let (s, c) = f64::sin_cos(angle);
        let u: [[f64; 2]; 6] = std::array::from_fn(|i| {
            let e = match (i % 3, i / 3) {
                (0, node) => frame[0].map(|x| x * LENGTH * node as f64),
                (a, _) => frame[a - 1],
            };
            let shift = if i % 3 == 0 { 5.0 } else { 0.0 };
            [
                c * e[0] - s * e[1] - e[0] + shift,
                s * e[0] + c * e[1] - e[1],
            ]
        });
        for_every_kernel!(2, 6, |kernel: &_| {
            let energy = ElementKernel::<f64, 2, 6>::energy(kernel, &u);
            // E A l eps^2 with a margin for the coordinates' rounding.
            assert!(energy.abs() < 2e7 * 5e-3 * LENGTH * (1e3 * f64::EPSILON).powi(2));
        });
    }
}

#[test]
fn four_lanes_give_what_four_scalars_give() {
    let states: [[[f64; 3]; 8]; 4] = std::array::from_fn(|lane| {
        std::array::from_fn(|i| {
            std::array::from_fn(|c| 0.1 * ((1 + lane) as f64 * (3 * i + c + 1) as f64).sin())
        })
    });
    let lanes: [[WideF64x4; 3]; 8] = std::array::from_fn(|i| {
        std::array::from_fn(|c| WideF64x4::from(std::array::from_fn(|lane| states[lane][i][c])))
    });
    for_every_kernel!(3, 8, |kernel: &_| {
        let mut q = [[WideF64x4::lit(0.0); 3]; 8];
        let mut k = [[[[WideF64x4::lit(0.0); 3]; 8]; 3]; 8];
        ElementKernel::<f64, 3, 8>::tangent(kernel, &lanes, &mut q, &mut k);
        for (lane, state) in states.iter().enumerate() {
            let mut force = [[0.0; 3]; 8];
            let mut tangent = [[[[0.0; 3]; 8]; 3]; 8];
            ElementKernel::<f64, 3, 8>::tangent(kernel, state, &mut force, &mut tangent);
            let pick = |x: WideF64x4| <[f64; 4]>::from(x.0)[lane];
            for (wide, plain) in q.as_flattened().iter().zip(force.as_flattened()) {
                assert!((pick(*wide) - plain).abs() <= 1e-13 * largest(force.as_flattened()));
            }
            let wide = k.as_flattened().as_flattened().as_flattened();
            let plain = tangent.as_flattened().as_flattened().as_flattened();
            for (wide, value) in wide.iter().zip(plain) {
                assert!((pick(*wide) - value).abs() <= 1e-13 * largest(plain));
            }
        }
    });
}

/// The textbook strain `(J^T J - I) / 2` of a slender beam loses what the displacement form keeps.
#[test]
fn strain_of_a_slender_beam_keeps_its_digits() {
    use ancf::material::green_lagrange;
    let identity: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let tiny = 3.0e-9_f32;
    let h = [[tiny, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
    let strain = green_lagrange(&identity, &h);
    assert_eq!(strain[0][0], tiny);
    let j = 1.0 + tiny;
    assert_eq!((j * j - 1.0) / 2.0, 0.0, "what the textbook form gives");
}
