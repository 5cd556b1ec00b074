//! Claims about the exact solutions, against published tables and independent prototypes.

use std::f64::consts::PI;

use ancf::Error;
use ancf::analytical::*;
use num_dual::{Dual, Dual64};

const E: f64 = 2e11;

fn full_turn(section: &BendingSection<f64>, kind: EndMoment) -> RollUp<f64> {
    pure_bending(section, 2.0 * PI * E * section.second, kind).unwrap()
}

fn assert_near(value: f64, truth: f64, tolerance: f64) {
    assert!((value - truth).abs() <= tolerance, "{value}, not {truth}");
}

#[test]
fn roll_up_closes_to_the_known_gaps() {
    // Limits of converged meshes, in mm, for a beam of unit length.
    let thick = BendingSection::disk(E, 0.02);
    let state = full_turn(&thick, EndMoment::Conjugate);
    assert_near(state.curvature / (2.0 * PI), 1.022877, 5e-7);
    assert_near(state.axial_stretch, 0.993836, 5e-7);
    assert_near(state.section_stretch, 0.995920, 5e-7);
    for (kind, gap) in [
        (EndMoment::Conjugate, 22.2080),
        (EndMoment::NormalToSlope, 18.0854),
        (EndMoment::AlongAxis, 18.0854),
        (EndMoment::SecondPiola, 11.9429),
    ] {
        assert_near(1e3 * full_turn(&thick, kind).gap(1.0), gap, 6e-5);
    }
    for (radius, gap, digit) in [
        (0.01, 5.459, 5e-4),
        (0.005, 1.359, 5e-4),
        (0.001, 0.0543, 5e-5),
    ] {
        let state = full_turn(&BendingSection::disk(E, radius), EndMoment::Conjugate);
        assert_near(1e3 * state.gap(1.0), gap, digit);
    }
    // A cubature of order two on the disk halves the fourth moment.
    let fourth = 0.5 * thick.fourth;
    let coarse = BendingSection { fourth, ..thick };
    let gap = full_turn(&coarse, EndMoment::Conjugate).gap(1.0);
    assert_near(1e3 * gap, 24.308, 5e-4);
}

#[test]
fn pure_bending_is_a_stationary_point_of_the_energy() {
    let section = BendingSection::rectangle(E, 0.03, 0.05);
    let BendingSection {
        area,
        second,
        fourth,
        ..
    } = section;
    let energy = |k: Dual64, l: Dual64, a: Dual64| {
        let (axial, bent) = (l * l - 1.0, a * a * k * k);
        let across = a * a - 1.0;
        (axial * axial * area
            + l * l * bent * second * 4.0
            + bent * bent * fourth
            + axial * bent * second * 2.0
            + across * across * area)
            * (E / 8.0)
    };
    let moment = -1.5 * E * second;
    for (kind, arm) in [
        (EndMoment::Conjugate, [0, 0]),
        (EndMoment::NormalToSlope, [1, 0]),
        (EndMoment::SecondPiola, [1, 1]),
    ] {
        let state = pure_bending(&section, moment, kind).unwrap();
        let at = [state.curvature, state.axial_stretch, state.section_stretch];
        let slope = |which: usize| {
            let x: [Dual64; 3] =
                std::array::from_fn(|i| Dual64::new(at[i], f64::from(u8::from(i == which))));
            energy(x[0], x[1], x[2]).eps
        };
        let factor = at[2].powi(arm[0]) * at[1].powi(arm[1]);
        assert_near(slope(0), moment * factor, 1e-13 * moment.abs());
        assert_near(slope(1), 0.0, 1e-13 * E * area);
        assert_near(slope(2), 0.0, 1e-13 * E * area);
    }
}

#[test]
fn softening_in_bending_starts_with_the_known_slope() {
    for radius in [1e-3, 5e-3] {
        let state = full_turn(&BendingSection::disk(E, radius), EndMoment::Conjugate);
        let square = (2.0 * PI * radius).powi(2) / 4.0;
        let predicted = 1.0 + 5.5 * square;
        assert_near(
            state.curvature / (2.0 * PI),
            predicted,
            100.0 * square * square,
        );
    }
}

#[test]
fn the_gap_is_that_of_the_arc() {
    let straight = pure_bending(&BendingSection::disk(E, 0.02), 0.0, EndMoment::Conjugate).unwrap();
    assert_eq!(straight.gap(3.0), 3.0);
    let half = RollUp {
        curvature: PI,
        axial_stretch: 1.0,
        section_stretch: 1.0,
    };
    assert_near(half.gap(1.0), 2.0 / PI, 1e-15);
    let over = RollUp {
        curvature: 3.0 * PI,
        ..half
    };
    assert_near(over.gap(1.0), 2.0 / (3.0 * PI), 1e-15);
}

#[test]
fn moments_beyond_the_section_are_refused() {
    let section = BendingSection::disk(E, 0.02);
    let bend = |moment| pure_bending(&section, moment, EndMoment::Conjugate);
    let error = bend(100.0 * E * section.second).unwrap_err();
    assert!(matches!(error, Error::OutOfRange { .. }), "{error}");
    assert!(matches!(bend(f64::NAN), Err(Error::NotFinite { .. })));
    let hollow = BendingSection {
        area: 0.0,
        ..section
    };
    let error = pure_bending(&hollow, 1.0, EndMoment::Conjugate).unwrap_err();
    assert!(error.to_string().contains("area"), "{error}");
}

#[test]
fn derivatives_pass_through_the_solvers() {
    // The gap as a function of the radius, and the elastica as one of the load.
    let gap = |radius: Dual64| {
        let section = BendingSection::disk(Dual64::from(E), radius);
        let moment = section.modulus * section.second * (2.0 * PI);
        let bent = pure_bending(&section, moment, EndMoment::SecondPiola).unwrap();
        bent.gap(Dual::from(1.0))
    };
    let step = 1e-6;
    let slope = gap(Dual64::from(0.02).derivative()).eps;
    let difference = (gap((0.02 + step).into()).re - gap((0.02 - step).into()).re) / (2.0 * step);
    assert_near(slope, difference, 1e-8);

    let tip = |load: Dual64| Elastica::under_transverse_load(load).unwrap();
    let step = 1e-5;
    for load in [0.3, 3.0, 30.0] {
        let exact = tip(Dual64::from(load).derivative());
        let (plus, minus) = (tip((load + step).into()), tip((load - step).into()));
        for (exact, plus, minus) in [
            (exact.deflection, plus.deflection, minus.deflection),
            (exact.shortening, plus.shortening, minus.shortening),
            (exact.rotation, plus.rotation, minus.rotation),
        ] {
            assert_near(exact.eps, (plus.re - minus.re) / (2.0 * step), 1e-10);
        }
    }
}

#[test]
fn elastica_agrees_with_published_numbers() {
    // Elliptic integrals after Mattiasson 1981 (transverse tip load on a cantilever): load
    // P L^2/(E I), deflection w/L, shortening u/L, rotation of the tip.
    for [load, deflection, shortening, rotation] in [
        [0.2, 0.06636448214483, 0.0026465483405228, 0.099636163037402],
        [1.0, 0.30172077379981, 0.056433236283377, 0.46135194971188],
        [2.0, 0.49345748039671, 0.16064172082517, 0.78174983155654],
        [5.0, 0.71379152361191, 0.38762836072443, 1.2153681176117],
        [10.0, 0.8106090248803, 0.55499559775375, 1.4302855388039],
        [50.0, 0.91715544730359, 0.8000003960496, 1.5679819015714],
        [100.0, 0.94142135086201, 0.85857864456288, 1.57064588466],
    ] {
        let tip = Elastica::under_transverse_load(load).unwrap();
        assert_near(tip.deflection, deflection, 1e-12);
        assert_near(tip.shortening, shortening, 1e-12);
        assert_near(tip.rotation, rotation, 1e-12);
        let single = Elastica::under_transverse_load(load as f32).unwrap();
        assert_near(single.deflection.into(), deflection, 2e-6);
    }
}

#[test]
fn elastica_has_the_right_limits() {
    let none = Elastica::under_transverse_load(0.0).unwrap();
    assert_eq!(
        (none.deflection, none.shortening, none.rotation),
        (0.0, 0.0, 0.0)
    );
    let small = Elastica::under_transverse_load(1e-6).unwrap();
    let linear = cantilever_small_deflection(1e-6, 1.0, 1.0).unwrap();
    assert_near(small.deflection / linear, 1.0, 1e-12);
    assert_near(small.rotation, 0.5e-6, 1e-18);
    // Hanging straight down, all but a bend of length sqrt(E I/P) at the clamp.
    let large = Elastica::under_transverse_load(1e4).unwrap();
    assert_near(1.0 - large.shortening, (2.0_f64 / 1e4).sqrt(), 1e-12);
    for load in [-1.0, f64::NAN, 1e9] {
        let error = Elastica::under_transverse_load(load).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. }), "{error}");
    }
}

#[test]
fn closed_forms_take_their_known_values() {
    assert_near(
        cantilever_shear_deflection(3.0, 2.0, 4.0).unwrap(),
        1.5,
        0.0,
    );
    assert!(cantilever_small_deflection(1.0, 1.0, 0.0).is_err());
    assert_eq!(fully_parameterised_tip_ratio(1), Ok(0.75));
    assert_eq!(fully_parameterised_tip_ratio(4), Ok(1.0 - 1.0 / 64.0));
    assert!(fully_parameterised_tip_ratio::<f64>(0).is_err());
    assert_near(poisson_locked_ratio(0.3).unwrap(), 0.742857, 5e-7);
    assert_eq!(poisson_locked_ratio(0.0), Ok(1.0));
    assert!(poisson_locked_ratio(0.5).is_err());
    let frequency = |nu| thickness_frequency(2.0, nu, 8.0, 0.25).unwrap();
    assert_near(frequency(0.0), 4.0, 1e-15);
    assert_near(
        frequency(0.3) / frequency(0.0),
        1.0 / 0.52_f64.sqrt(),
        1e-15,
    );
}
