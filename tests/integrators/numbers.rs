//! Every integrator runs in every number type: in dual numbers it returns the derivative of the whole
//! simulation, in single precision it follows double.

use ancf::prelude::*;
use num_dual::Dual64;

/// Where the tip of a rubber pendulum of this modulus (Pa) hangs after 0.2 s, by 40 or more steps.
fn tip<R: Real>(scheme: &impl Scheme<R>, young: R, stepping: Stepping) -> R {
    let mut scene = Scene::<R, 2>::new();
    let disk = Disk::new(R::lit(0.02)).unwrap();
    let solid = SaintVenantKirchhoff::isotropic(young, R::lit(0.3)).unwrap();
    let formulation = Continuum::selective_reduced(solid);
    let beam = Beam::new(FullyParameterised, disk, formulation)
        .straight([R::zero(); 2], [R::one(), R::zero()], 2)
        .density(R::lit(2000.0));
    let beam = scene.add(beam).unwrap();
    scene.pin(beam.start()).unwrap();
    scene.gravity([R::zero(), R::lit(-9.81)]).unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
    run.until(R::lit(0.2), stepping, |_| {}).unwrap();
    system.position(run.state(), beam.end()).unwrap()[1]
}

fn check<S>(name: &str, scheme: S, stepping: Stepping)
where
    S: Scheme<f64> + Scheme<f32> + Scheme<Dual64>,
{
    let young = 1e6;
    let dual = tip(&scheme, Dual64::from_re(young).derivative(), stepping);
    let by = 1e-4 * young;
    let [left, right] = [young - by, young + by].map(|young| tip(&scheme, young, stepping));
    let difference = (right - left) / (2.0 * by);
    let gap = (dual.eps / difference - 1.0).abs();
    assert!(gap < 1e-4, "{name}: {} and {difference}", dual.eps);
    let single: f32 = tip(&scheme, young as f32, stepping);
    let gap = (f64::from(single) - dual.re).abs();
    assert!(gap < 1e-3, "{name}: {single} and {}", dual.re);
}

#[test]
fn derivatives_of_whole_simulations_and_single_precision() {
    let fixed = Stepping::Fixed(5e-3);
    check("alpha", Newmark::generalised_alpha(0.8), fixed);
    check("midpoint", Midpoint::default(), fixed);
    check("conserving", EnergyMomentum::conserving(), fixed);
    check("dissipating", EnergyMomentum::dissipating(0.1), fixed);
    check("Gauss", Collocation::gauss(2), fixed);
    check("Radau", Collocation::radau(3), fixed);
    check(
        "central",
        CentralDifference::default(),
        Stepping::Fixed(2e-4),
    );
}
