//! Claims about moments: the paper's roll-up to every digit for each law by which a moment can act,
//! its limit against the exact solution, and the direction that every law bends.

use ancf::analytical::{BendingSection, EndMoment, pure_bending};
use ancf::prelude::*;
use std::f64::consts::PI;

type Steel = SaintVenantKirchhoff<f64, 3>;

fn rolled_up(n: usize, radius: f64, law: MomentLaw, rule: fn(Steel) -> Continuum<Steel>) -> f64 {
    let young = 2.0e11;
    let steel = Steel::isotropic(young, 0.0).unwrap();
    let mut scene = Scene::<f64, 3>::new();
    let disk = Disk::new(radius).unwrap();
    let beam = Beam::new(FullyParameterised, disk, rule(steel));
    let beam = scene
        .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], n))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    let moment = 2.0 * PI * young * PI * radius.powi(4) / 4.0;
    scene
        .moment(beam.end(), Moment::new([0.0, 0.0, moment], law))
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::in_steps(20).solve(&system, &mut state).unwrap();
    let [x, y, z] = system.position(&state, beam.end()).unwrap();
    1e3 * (x * x + y * y + z * z).sqrt()
}

/// Gap between end and clamp in millimetres, from an independent implementation.
#[test]
fn roll_up_to_every_digit_for_each_moment_law() {
    use MomentLaw::{FollowerCouple, PiolaTraction, SlopeRotation, TangentTraction};
    let table = [
        (SlopeRotation(1), [108.197, 6.2402, 19.5970, 21.6473]),
        (FollowerCouple(1), [87.330, 10.5881, 17.6488, 18.0712]),
        (TangentTraction, [87.564, 10.4695, 17.5798, 18.0315]),
        (PiolaTraction, [90.281, 4.7981, 11.5075, 11.9036]),
    ];
    for (law, row) in table {
        for (n, truth) in [10, 20, 40, 80].into_iter().zip(row) {
            let gap = rolled_up(n, 0.02, law, Continuum::full);
            assert!(
                (gap - truth).abs() < 1e-3,
                "{law:?}, {n} elements: {gap} mm, not {truth}"
            );
        }
    }
    for (n, truth) in [(10, 106.865), (20, 8.2600), (40, 21.689), (80, 23.746)] {
        let gap = rolled_up(n, 0.02, SlopeRotation(1), Continuum::reduced);
        assert!(
            (gap - truth).abs() < 1e-3,
            "paper's rule, {n} elements: {gap} mm, not {truth}"
        );
    }
}

#[test]
fn other_moment_laws_agree_with_the_independent_implementation() {
    use MomentLaw::{MeanRotation, SlopeRotation};
    for (law, n, truth) in [
        (MeanRotation, 10, 107.736),
        (MeanRotation, 20, 6.2440),
        (MeanRotation, 40, 19.411),
        (SlopeRotation(0), 10, 107.390),
        (SlopeRotation(0), 20, 6.2256),
        (SlopeRotation(0), 40, 18.529),
    ] {
        let gap = rolled_up(n, 0.02, law, Continuum::full);
        assert!(
            (gap - truth).abs() < 1e-3,
            "{law:?}, {n} elements: {gap} mm, not {truth}"
        );
    }
}

/// The gap of a section-linear beam converges to the exact one, cubature and moment law included.
/// The locking part of the error falls with the fourth power of the element length.
#[test]
fn roll_up_converges_to_the_exact_section_model() {
    let exact = |radius: f64, fourth: f64, law| {
        let mut section = BendingSection::disk(2.0e11, radius);
        section.fourth *= fourth;
        let moment = 2.0 * PI * 2.0e11 * PI * radius.powi(4) / 4.0;
        let roll = pure_bending(&section, moment, law).unwrap();
        1e3 * roll.gap(1.0)
    };
    let a1 = MomentLaw::SlopeRotation(1);
    let full = exact(0.02, 1.0, EndMoment::Conjugate);
    let reduced = exact(0.02, 0.5, EndMoment::Conjugate);
    assert!((full - 22.2080).abs() < 1e-3 && (reduced - 24.308).abs() < 1e-3);
    let errors = [40, 80, 160].map(|n| (rolled_up(n, 0.02, a1, Continuum::full) - full).abs());
    assert!(
        errors[2] < 0.15 && errors[1] > 3.5 * errors[2],
        "{errors:?}"
    );
    assert!((rolled_up(160, 0.02, a1, Continuum::reduced) - reduced).abs() < 0.15);
    for radius in [0.005, 0.001] {
        let limit = exact(radius, 1.0, EndMoment::Conjugate);
        let errors =
            [40, 80, 160].map(|n| (rolled_up(n, radius, a1, Continuum::full) - limit).abs());
        assert!(
            errors[1] < errors[0] / 6.0 && errors[2] < errors[1] / 6.0,
            "R = {radius}: {errors:?}"
        );
    }
}

/// Moments about both cross axes bend the way they should, by every law that can carry them, in
/// space and in the plane.
#[test]
fn every_moment_law_bends_the_right_way() {
    use MomentLaw::{
        FollowerCouple, MeanRotation, PiolaTraction, PolarRotation, SlopeRotation, TangentTraction,
    };
    let (young, radius, moment) = (2e11, 5e-3_f64, 0.1);
    let slope = moment / (young * PI * radius.powi(4) / 4.0);
    let turned = |vector: [f64; 3], law| {
        let steel = Steel::isotropic(young, 0.0).unwrap();
        let mut scene = Scene::<f64, 3>::new();
        let disk = Disk::new(radius).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(steel));
        let beam = scene
            .add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], 4))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.moment(beam.end(), Moment::new(vector, law)).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state).unwrap();
        system
            .vector(&state, beam.end(), NodalVector::Slope(0))
            .unwrap()
    };
    let about_z = [
        SlopeRotation(1),
        SlopeRotation(0),
        FollowerCouple(1),
        TangentTraction,
        PiolaTraction,
        MeanRotation,
        PolarRotation,
    ];
    for law in about_z {
        let [_, y, z] = turned([0.0, 0.0, moment], law);
        assert!(
            (y / slope - 1.0).abs() < 1e-3 && z.abs() < 1e-9,
            "{law:?}: {y} {z}, not {slope}"
        );
    }
    let about_y = [
        SlopeRotation(2),
        SlopeRotation(0),
        FollowerCouple(2),
        TangentTraction,
        PiolaTraction,
        MeanRotation,
        PolarRotation,
    ];
    for law in about_y {
        let [_, y, z] = turned([0.0, moment, 0.0], law);
        assert!(
            (z / slope + 1.0).abs() < 1e-3 && y.abs() < 1e-9,
            "{law:?}: {y} {z}, not -{slope}"
        );
    }
    for law in about_z {
        let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(young, 0.0).unwrap();
        let mut scene = Scene::<f64, 2>::new();
        let disk = Disk::new(radius).unwrap();
        let beam = Beam::new(FullyParameterised, disk, Continuum::full(steel));
        // Along a slanted line: nothing may depend on the global axes.
        let beam = scene.add(beam.straight([0.0; 2], [0.6, 0.8], 8)).unwrap();
        scene.clamp(beam.start()).unwrap();
        scene
            .moment(beam.end(), Moment::new([0.0, 0.0, 100.0 * moment], law))
            .unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        let report = Statics::default().solve(&system, &mut state).unwrap();
        let [x, y] = system
            .vector(&state, beam.end(), NodalVector::Slope(0))
            .unwrap();
        let angle = y.atan2(x) - 0.8_f64.atan2(0.6);
        assert!(
            (angle / (100.0 * slope) - 1.0).abs() < 2e-2,
            "{law:?}: {angle}"
        );
        assert!(
            report.iterations <= 7,
            "{law:?}: {report:?}: a wrong tangent is slow"
        );
    }
}

/// Polar rotation, from an independent evaluation (mm).
#[test]
fn polar_rotation_rolls_up_as_known() {
    for (n, truth) in [(10, 107.739), (20, 6.2592), (40, 19.4505)] {
        let gap = rolled_up(n, 0.02, MomentLaw::PolarRotation, Continuum::full);
        assert!((gap - truth).abs() < 1e-3, "{n} elements: {gap} mm");
    }
}
