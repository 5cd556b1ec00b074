//! Claims about where the energy is sampled: which orders leave zero-energy modes, what the
//! refusal says, and that exact rules agree with any finer one.

use ancf::formulation::{ContinuumKernel, ElementKernel, Reference};
use ancf::material::Moduli;
use ancf::prelude::*;

fn kernel_of<const D: usize, const S: usize, F>(
    formulation: &F,
    section: &dyn Section<f64>,
) -> Result<F::Kernel>
where
    FullyParameterised: Element<D, S>,
    F: Formulation<f64, FullyParameterised, D, S>,
{
    let reference = Reference::straight(
        &FullyParameterised,
        0.2,
        std::array::from_fn(|a| std::array::from_fn(|c| f64::from(u8::from(a == c)))),
    );
    formulation.check(&FullyParameterised, section)?;
    formulation.kernel(&FullyParameterised, &reference, section)
}

fn steel<const D: usize>() -> SaintVenantKirchhoff<f64, D> {
    SaintVenantKirchhoff::isotropic(2.0e11, 0.3).unwrap()
}

/// 18 deformation modes in space, 9 in the plane; one or two axial points never see them all,
/// a single section point never either.
#[test]
fn three_axial_points_and_section_order_two_are_needed() {
    let disk = Disk::new(0.02).unwrap();
    let square = Rectangle::new(0.03, 0.03).unwrap();
    for section in [&disk as &dyn Section<f64>, &square] {
        for axial in 1..=6 {
            for order in 1..=4 {
                let rule = Continuum::sampled(steel(), axial, 2 * order - 1);
                let made = kernel_of::<3, 8, _>(&rule, section);
                assert_eq!(
                    made.is_ok(),
                    axial >= 3 && order >= 2,
                    "{axial} x order {order}"
                );
                let rule = Continuum::sampled(steel(), axial, 2 * order - 1);
                let made = kernel_of::<2, 6, _>(&rule, section);
                assert_eq!(
                    made.is_ok(),
                    axial >= 3 && order >= 2,
                    "plane {axial} x {order}"
                );
            }
        }
    }
}

#[test]
fn the_refusal_names_the_rank_and_the_orders_that_suffice() {
    let disk = Disk::new(0.02).unwrap();
    let error = kernel_of::<3, 8, _>(&Continuum::sampled(steel(), 5, 1), &disk).unwrap_err();
    assert!(
        matches!(
            error,
            Error::ZeroEnergyModes {
                modes: 3,
                rank: 15,
                target: 18,
                ..
            }
        ),
        "{error:?}"
    );
    let text = error.to_string();
    assert!(text.contains("at least 3 axial points"), "{text}");
    assert!(text.contains("section rule of degree 3"), "{text}");
    let text = kernel_of::<3, 8, _>(&Continuum::sampled(steel(), 2, 5), &disk)
        .unwrap_err()
        .to_string();
    assert!(text.contains("at least 3 axial points"), "{text}");
}

/// A torsion a million times softer than the axis is nothing to single precision, and the message does
/// not leave it at the rule.
#[test]
fn single_precision_says_which_stiffness_it_takes_for_none() {
    fn add<R: Real>() -> Result<()> {
        let stiffness = BeamStiffness {
            axial: R::lit(1e6),
            shear: [R::lit(1e6); 2],
            torsion: R::one(),
            bending: [R::one(), R::lit(1e4)],
        };
        let rule = StructuralMechanics::with_stiffness(stiffness)?;
        let one = R::one();
        let beam = Beam::new(Quadratic, Moments::new(one, one, one)?, rule);
        let axis = [one, R::zero(), R::zero()];
        Scene::<R, 3>::new().add(beam.straight([R::zero(); 3], axis, 8))?;
        Ok(())
    }
    assert!(add::<f64>().is_ok());
    let text = add::<f32>().unwrap_err().to_string();
    assert!(text.contains("less than 1e-5 of the largest"), "{text}");
    assert!(text.contains("take f64"), "{text}");
}

/// Rank does not depend on how slender the beam is.
#[test]
fn slender_and_stocky_beams_are_judged_alike() {
    for radius in [1e-7, 1e-3, 10.0] {
        let disk = Disk::new(radius).unwrap();
        assert!(kernel_of::<3, 8, _>(&Continuum::sampled(steel(), 3, 3), &disk).is_ok());
        assert!(kernel_of::<3, 8, _>(&Continuum::sampled(steel(), 2, 3), &disk).is_err());
    }
}

fn state(size: f64) -> [[f64; 3]; 8] {
    std::array::from_fn(|i| {
        std::array::from_fn(|c| {
            size * ((5 * i + 3 * c + 1) as f64).sin() * if i % 4 == 0 { 0.2 } else { 1.0 }
        })
    })
}

#[test]
fn the_full_rule_is_exact_and_the_reduced_one_is_not() {
    for section in [
        &Disk::new(0.02).unwrap() as &dyn Section<f64>,
        &Rectangle::new(0.05, 0.01).unwrap(),
        &Annulus::new(0.03, 0.02).unwrap(),
    ] {
        let energy = |rule: Continuum<SaintVenantKirchhoff<f64, 3>>| {
            kernel_of::<3, 8, _>(&rule, section)
                .unwrap()
                .energy(&state(0.5))
        };
        let exact = energy(Continuum::sampled(steel(), 9, 9));
        let full = energy(Continuum::full(steel()));
        let reduced = energy(Continuum::reduced(steel()));
        assert!((full / exact - 1.0).abs() < 1e-13, "{}", full / exact - 1.0);
        assert!((reduced / exact - 1.0).abs() > 1e-6);
    }
}

/// What a material knows of itself is used where its type says that all of them know it.
#[test]
fn constant_materials_that_do_not_say_so_are_sampled() {
    #[derive(Debug, Clone)]
    struct Modest(SaintVenantKirchhoff<f64, 3>);
    impl Material<f64, 3> for Modest {
        fn energy<T: Algebra<f64>>(&self, strain: &[[T; 3]; 3]) -> T {
            self.0.energy(strain)
        }
        fn constant_elasticity(&self) -> Option<Moduli<f64, 3>> {
            panic!("a sampled material is not asked for its moduli");
        }
    }
    let disk = Disk::new(0.02).unwrap();
    let u = state(1e-2);
    let said = kernel_of::<3, 8, _>(&Continuum::full(steel::<3>()), &disk).unwrap();
    let unsaid = kernel_of::<3, 8, _>(&Continuum::full(Modest(steel())), &disk).unwrap();
    let (said, unsaid): (f64, f64) = (said.energy(&u), unsaid.energy(&u));
    assert!((said - unsaid).abs() < 1e-12 * said, "{said} {unsaid}");
}

/// The two layers of selective reduced integration add up to the whole material where both are
/// sampled alike, and a layer may be given by hand.
#[test]
fn the_parts_of_a_material_add_up() {
    let disk = Disk::new(0.02).unwrap();
    let material = steel();
    let layer = |material| Layer {
        material,
        axial: 5,
        across: Across::Degree(5),
    };
    let split = Continuum::layered([layer(material.uncoupled()), layer(material.coupled())]);
    let whole = Continuum::full(material);
    let energy = |rule: Continuum<_>| {
        let kernel = kernel_of::<3, 8, _>(&rule, &disk).unwrap();
        kernel.energy(&state(0.3))
    };
    assert!((energy(split) / energy(whole) - 1.0).abs() < 1e-13);
}

/// A planar scene is the spatial one with out-of-plane coordinates at rest: at zero Poisson ratio
/// the energies agree for any planar state and every section.
#[test]
fn plane_and_space_store_the_same_energy() {
    for section in [
        &Disk::new(0.02).unwrap() as &dyn Section<f64>,
        &Rectangle::new(0.05, 0.01).unwrap(),
        &Annulus::new(0.03, 0.02).unwrap(),
    ] {
        let solid3 = SaintVenantKirchhoff::<f64, 3>::isotropic(2e7, 0.0).unwrap();
        let solid2 = SaintVenantKirchhoff::<f64, 2>::isotropic(2e7, 0.0).unwrap();
        let space = kernel_of::<3, 8, _>(&Continuum::full(solid3), section).unwrap();
        let plane = kernel_of::<2, 6, _>(&Continuum::full(solid2), section).unwrap();
        let u2: [[f64; 2]; 6] = std::array::from_fn(|i| {
            std::array::from_fn(|c| 0.3 * ((7 * i + 2 * c + 1) as f64).sin())
        });
        let u3: [[f64; 3]; 8] = std::array::from_fn(|i| {
            if i % 4 == 3 {
                return [0.0; 3];
            }
            let planar = u2[i / 4 * 3 + i % 4];
            [planar[0], planar[1], 0.0]
        });
        let (a, b) = (space.energy(&u3), plane.energy(&u2));
        assert!(
            (a / b - 1.0).abs() < 1e-13,
            "{a} in space, {b} in the plane"
        );
    }
}

/// Flat sections and nearly incompressible materials are no mechanisms.
#[test]
fn flat_sections_and_extreme_poisson_ratios_have_full_rank() {
    for ratio in [1e-2, 1e-5, 1e4] {
        let flat = Rectangle::new(0.1 * ratio, 0.1).unwrap();
        kernel_of::<3, 8, _>(&Continuum::full(steel()), &flat).unwrap();
    }
    for nu in [-0.99, 0.49, 0.4999, 0.499999] {
        let solid = SaintVenantKirchhoff::<f64, 3>::isotropic(2e11, nu).unwrap();
        let disk = Disk::new(0.1).unwrap();
        kernel_of::<3, 8, _>(&Continuum::full(solid), &disk).unwrap();
        kernel_of::<3, 8, _>(&Continuum::selective_reduced(solid), &disk).unwrap();
    }
    let single = SaintVenantKirchhoff::<f32, 3>::isotropic(2e11, 0.3).unwrap();
    for section in [
        Rectangle::new(0.001_f32, 0.1).unwrap(),
        Rectangle::new(0.1, 0.1).unwrap(),
    ] {
        let mut scene = Scene::<f32, 3>::new();
        let beam = Beam::new(FullyParameterised, section, Continuum::full(single));
        scene
            .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1))
            .unwrap();
        let beam = Beam::new(
            FullyParameterised,
            section,
            Continuum::sampled(single, 2, 5),
        );
        assert!(
            scene
                .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 1))
                .is_err()
        );
    }
}

/// A formulation of one's own that says only how to make a kernel.
#[derive(Debug, Clone)]
struct Bare(Continuum<SaintVenantKirchhoff<f64, 2>>);

impl Formulation<f64, FullyParameterised, 2, 6> for Bare {
    type Kernel = ContinuumKernel<f64, SaintVenantKirchhoff<f64, 2>, 2, 6, 3>;

    fn kernel(
        &self,
        element: &FullyParameterised,
        reference: &Reference<f64, 2, 6>,
        section: &dyn Section<f64>,
    ) -> Result<Self::Kernel> {
        self.0.kernel(element, reference, section)
    }
}

/// It is checked without being asked to, by value and by reference; what would suffice it alone
/// knows.
#[test]
fn formulations_of_ones_own_are_checked() {
    let disk = Disk::new(0.02).unwrap();
    let add = |axial| {
        let bare = Bare(Continuum::sampled(steel(), axial, 3));
        let mut scene = Scene::<f64, 2>::new();
        let beam = Beam::new(FullyParameterised, disk, &bare);
        let borrowed = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 4)).err();
        let beam = Beam::new(FullyParameterised, disk, bare.clone());
        let owned = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 4)).err();
        assert_eq!(borrowed, owned);
        owned
    };
    let refused = add(2).unwrap();
    assert!(
        matches!(refused, Error::ZeroEnergyModes { target: 9, .. }),
        "{refused}"
    );
    assert!(
        refused.to_string().contains("sample more points"),
        "{refused}"
    );
    assert_eq!(add(3), None);
}
