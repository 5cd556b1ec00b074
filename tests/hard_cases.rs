//! Claims about hard cases: slender, long, uneven, tiny, far, fast and almost inverted beams keep the
//! digits that their report leaves them, or are refused by an error that names the cause. (The
//! whole table is in the example `hard_cases`.)

use ancf::prelude::*;
use ancf::solver::StaticReport;
use model::Chain;

#[path = "../examples/hard_cases/model.rs"]
mod model;

type Solid<R, const D: usize> = SaintVenantKirchhoff<R, D>;

/// One uniform cantilever bent by a millionth of its radius.
fn slender(radius: f64, parts: &[(usize, f64)]) -> Chain<'_> {
    Chain {
        radius,
        parts,
        load: 3e-6 * radius,
        origin: 0.0,
    }
}

/// Error of the tip and what the report says of it.
fn error<R: Real>(chain: &Chain<'_>) -> Result<(f64, StaticReport)>
where
    Continuum<Solid<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let (tip, report) = chain.tip::<R, _>(Continuum::full)?;
    Ok(((tip / chain.truth() - 1.0).abs(), report))
}

/// The clamp that holds the section costs `0.025 (R/L)^2`; all else is rounding, of which the report
/// tells the order of magnitude: it is one sample of noise.
#[test]
fn slender_beams_keep_the_digits_their_report_leaves() {
    fn keeps<R: Real>(radius: f64)
    where
        Continuum<Solid<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
    {
        let (error, report) = error::<R>(&slender(radius, &[(8, 1.0)])).unwrap();
        let limit = 0.03 * radius.powi(2) + 10.0 * report.rounding;
        assert!(error < limit, "{radius}: {error:e}, {report:?}");
        // An estimate that is always large says nothing.
        let pessimist = 1e3 * R::EPSILON / radius.powi(2);
        assert!(report.rounding < pessimist, "{radius}: {report:?}");
    }
    for radius in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        keeps::<f64>(radius);
    }
    for radius in [1e-1, 1e-2] {
        keeps::<f32>(radius);
    }
}

/// Whose bending stiffness is lost in the rounding of its axial stiffness is not told to look for
/// supports.
#[test]
fn what_a_number_type_cannot_tell_is_refused() {
    for parts in [&[(8, 1.0)][..], &[(8, 1.0), (8, 1e6)]] {
        let refused = error::<f32>(&slender(1e-5, parts)).unwrap_err();
        assert!(matches!(refused, Error::StiffnessLost { .. }), "{refused}");
    }
    // Every pivot of this chain is well above rounding, and yet nothing is left of the answer.
    let long = slender(0.1, &[(10_000, 1.0)]);
    let refused = error::<f32>(&long).unwrap_err();
    let Error::NoDigits { share } = refused else {
        panic!("{refused}")
    };
    assert!(share > 0.1);
    let (error, report) = error::<f64>(&long).unwrap();
    assert!(
        error < 1e-6 && report.rounding < 1e-2,
        "{error:e} {report:?}"
    );
}

#[test]
fn neighbours_of_very_unequal_stiffness() {
    for parts in [[(8, 1e6), (8, 1.0)], [(8, 1.0), (8, 1e6)]] {
        let (error, report) = error::<f64>(&slender(1e-2, &parts)).unwrap();
        assert!(error < 1e-5, "{parts:?}: {error:e} {report:?}");
    }
}

/// A cantilever of this length and Poisson ratio, of its own section, by selective reduction: tip
/// along and across over the length, under loads that grow with the square of its size.
fn tip<R: Real>(length: f64, nu: f64, offset: bool) -> Result<[f64; 2]>
where
    Continuum<Solid<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let (young, radius) = (2e11, 0.05 * length);
    let solid = Solid::isotropic(R::lit(young), R::lit(nu))?;
    let form = Continuum::selective_reduced(solid);
    let mut scene = Scene::<R, 2>::new();
    let disk = Disk::new(R::lit(radius))?;
    let end = [R::lit(length), R::zero()];
    let ends = ([R::zero(); 2], end);
    let beam = if offset {
        let section = Offset::new(disk, [R::lit(radius), R::zero()])?;
        scene.add(Beam::new(FullyParameterised, section, form).straight(ends.0, ends.1, 4))?
    } else {
        scene.add(Beam::new(FullyParameterised, disk, form).straight(ends.0, ends.1, 4))?
    };
    scene.clamp(beam.start())?;
    let force = 1e-6 * young * length * length;
    scene.force(beam.end(), [R::lit(force), R::lit(1e-3 * force)])?;
    let system = scene.assemble()?;
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state)?;
    let tip = system.displacement(&state, beam.end())?;
    Ok(tip.map(|u| u.value() / length))
}

/// Mechanics knows no unit of length: a beam of a nanometre in single precision, the squares of
/// whose forces underflow, bends like one of a metre, also when its section lies beside the axis so
/// that pulling bends it.
#[test]
fn tiny_beams_bend_like_large_ones() {
    for offset in [false, true] {
        let truth = tip::<f64>(1.0, 0.3, offset).unwrap();
        for length in [1e3, 1e-3, 1e-5, 1e-6, 1e-7] {
            let found = tip::<f32>(length, 0.3, offset).unwrap();
            for (found, truth) in found.iter().zip(truth) {
                let error = (found / truth - 1.0).abs();
                assert!(error < 1e-4, "{length} m, {offset}: {found} for {truth}");
            }
        }
        for length in [1e30, 1e-30, 1e-50] {
            let found = tip::<f64>(length, 0.3, offset).unwrap();
            for (found, truth) in found.iter().zip(truth) {
                let error = (found / truth - 1.0).abs();
                assert!(error < 1e-10, "{length} m, {offset}: {found} for {truth}");
            }
        }
    }
}

/// In space the shear modulus lies `1 / (1 - 2 nu)` below the bulk modulus; plane stress has no
/// bulk modulus to hide it.
#[test]
fn nearly_incompressible_materials() {
    let single = Solid::<f32, 3>::isotropic(1.0, 0.499_999_9);
    let text = single.unwrap_err().to_string();
    assert!(text.contains("Poisson ratio") && text.contains("number type"));
    Solid::<f32, 3>::isotropic(1.0, 0.4999).unwrap();
    Solid::<f64, 3>::isotropic(1.0, 0.499_999_9).unwrap();
    Solid::<f32, 2>::isotropic(1.0, 0.499_999_9).unwrap();
    let truth = tip::<f64>(1.0, 0.3, false).unwrap()[1];
    for nu in [0.4999, 0.499_999_9] {
        let found = tip::<f64>(1.0, nu, false).unwrap()[1];
        // Shear alone depends on the ratio, by 3/2 (R/L)^2 (1 + nu) of bending.
        assert!((found / truth - 1.0).abs() < 2e-3, "{nu}: {found} {truth}");
    }
}

/// A scene a thousand kilometres away is the same to the last bit, in single precision, too:
/// coordinates are displacements.
#[test]
fn distance_from_the_origin_costs_nothing() {
    let near = slender(1e-2, &[(8, 1.0)]);
    let far = Chain {
        origin: 1e6,
        ..slender(1e-2, &[(8, 1.0)])
    };
    let tips = [&near, &far].map(|chain| chain.tip::<f32, _>(Continuum::full).unwrap().0);
    assert_eq!(tips[0], tips[1]);
    let tips = [&near, &far].map(|chain| chain.tip::<f64, _>(Continuum::full).unwrap().0);
    assert_eq!(tips[0], tips[1]);
}

/// Squeezed beyond `1 / sqrt(3)` a section of this material is unstable and falls towards zero
/// volume: what is let go before returns to rest, what is let go behind is refused, and the state
/// given is kept.
#[test]
fn sections_about_to_turn_inside_out() {
    let mut scene = Scene::<f64, 2>::new();
    let rubber = Solid::isotropic(2e7, 0.0).unwrap();
    let disk = Disk::new(0.05).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber));
    let beam = scene.add(beam.straight([0.0; 2], [1.0, 0.0], 4)).unwrap();
    scene.clamp(beam.start()).unwrap();
    let system = scene.assemble().unwrap();
    let squeezed = |share: f64| {
        let mut state = system.rest();
        for node in 1..beam.nodes() {
            let node = beam.node(node);
            let at = system.coordinate(node, NodalVector::Slope(1)).unwrap();
            state.displacement[at + 1] = share - 1.0;
        }
        state
    };
    for share in [0.9, 0.7, 0.6] {
        let mut state = squeezed(share);
        Statics::default().solve(&system, &mut state).unwrap();
        assert!(
            state.displacement.iter().all(|u| u.abs() < 1e-12),
            "{share}"
        );
    }
    for share in [0.3, 1e-3, 0.0, -0.5, -1.0] {
        let mut state = squeezed(share);
        let solved = Statics::default().solve(&system, &mut state);
        assert!(solved.is_err(), "{share}: {solved:?}");
        let kept = state.displacement.iter().all(|u| u.is_finite());
        assert!(kept, "{share}");
    }
}

/// A free rod under gravity whose clock stands at a time (s).
fn falling<R: Real>(clock: f64, step: f64, steps: usize) -> Result<f64>
where
    Continuum<Solid<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let rubber = Solid::isotropic(R::lit(2e7), R::lit(0.3))?;
    let form = Continuum::selective_reduced(rubber);
    let beam = Beam::new(FullyParameterised, Disk::new(R::lit(0.01))?, form);
    let mut scene = Scene::<R, 2>::new();
    let beam = beam
        .straight([R::zero(); 2], [R::one(), R::zero()], 2)
        .density(R::lit(1e3));
    let beam = scene.add(beam)?;
    scene.gravity([R::zero(), R::lit(-10.0)])?;
    let system = scene.assemble()?;
    let mut state = system.rest();
    state.time = R::lit(clock);
    let mut run = Integration::start(&system, state, &Newmark::trapezoidal())?;
    for _ in 0..steps {
        run.step(R::lit(step))?;
    }
    Ok(system.displacement(run.state(), beam.end())?[1].value())
}

/// Steps that a clock cannot tell would leave it standing, and every load in time with it.
#[test]
fn clocks_that_would_stand_still_refuse_the_step() {
    let fallen = falling::<f64>(1e9, 1e-3, 10).unwrap();
    assert!((fallen / -5e-4 - 1.0).abs() < 1e-9, "{fallen}");
    for refused in [falling::<f64>(1e9, 1e-9, 1), falling::<f32>(1e5, 1e-3, 1)] {
        let text = refused.unwrap_err().to_string();
        assert!(
            text.contains("time step") && text.contains("clock"),
            "{text}"
        );
    }
}

/// A steel rod that spins at a thousand radians per second about its middle, stretched by 500 m/s at its
/// ends, for sixteen turns.
#[test]
fn a_fast_rod_keeps_its_energy_and_momentum() {
    fn drifts<R: Real>() -> [f64; 2]
    where
        Continuum<Solid<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
    {
        let steel = Solid::isotropic(R::lit(2e11), R::lit(0.3)).unwrap();
        let form = Continuum::selective_reduced(steel);
        let disk = Disk::new(R::lit(0.02)).unwrap();
        let mut scene = Scene::<R, 2>::new();
        let [from, to] = [-0.5, 0.5].map(|x| [R::lit(x), R::zero()]);
        let rod = Beam::new(FullyParameterised, disk, form).straight(from, to, 4);
        scene.add(rod.density(R::lit(7800.0))).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        let turn = [R::zero(), R::zero(), R::lit(1e3)];
        system
            .set_rigid_velocity(&mut state, [R::zero(); 2], turn)
            .unwrap();
        let scheme = EnergyMomentum::conserving();
        let mut run = Integration::start(&system, state, &scheme).unwrap();
        let kept = |state: &State<R>| {
            let energy = system.energies(state).unwrap().total().value();
            [energy, system.momenta(state).unwrap().angular[2].value()]
        };
        let before = kept(run.state());
        run.until(R::lit(0.1), Stepping::Fixed(1e-4), |_| {})
            .unwrap();
        assert_eq!(run.report().steps, 1000);
        let after = kept(run.state());
        std::array::from_fn(|i| (after[i] / before[i] - 1.0).abs())
    }
    // A thousand roundings in a row at most.
    let limit = |unit: f64| 1e3 * unit;
    let double = drifts::<f64>();
    assert!(
        double.iter().all(|d| *d < limit(f64::EPSILON)),
        "{double:?}"
    );
    let single = drifts::<f32>();
    let unit = f64::from(f32::EPSILON);
    assert!(single.iter().all(|d| *d < limit(unit)), "{single:?}");
}

/// A force that sets in between two ends of a step gives the momentum it should to the share of that
/// step, whatever the stepping; error control finds the jump.
#[test]
fn loads_that_jump_within_a_step() {
    let (start, end, step) = (0.050_37, 0.1, 1e-3);
    let error = |stepping| {
        let rubber = Solid::isotropic(2e7, 0.3).unwrap();
        let form = Continuum::selective_reduced(rubber);
        let rod = Beam::new(FullyParameterised, Disk::new(0.01).unwrap(), form);
        let mut scene = Scene::<f64, 2>::new();
        let rod = rod.straight([0.0; 2], [1.0, 0.0], 3).density(7200.0);
        let rod = scene.add(rod).unwrap();
        let on = move |t: f64| if t < start { 0.0 } else { 1.0 };
        scene.force_in_time(rod.end(), [0.0, 10.0], on).unwrap();
        let system = scene.assemble().unwrap();
        let scheme = Newmark::generalised_alpha(0.8);
        let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
        run.until(end, stepping, |_| {}).unwrap();
        let [_, impulse] = system.momenta(run.state()).unwrap().linear;
        (impulse / 10.0 - (end - start)).abs()
    };
    let halved = Stepping::Halved { step, halvings: 4 };
    for stepping in [Stepping::Fixed(step), halved] {
        assert!(error(stepping) < step, "{stepping:?}");
    }
    assert!(error(Stepping::Adaptive(Adaptive::to(1e-5))) < 0.01 * step);
}
