//! The flying beam of Simo and Vu-Quoc in the plane, softer and thrown harder: a free rod given by its
//! stiffness, against a geometrically exact beam of another code.

use ancf::prelude::*;

const REFERENCE: &str = include_str!("../data/flying_beam_2d_EI500_M-80_F8.csv");

/// Largest distance of the two ends to the reference up to `end`, as a share of the beam's length.
fn distance(scheme: &impl Scheme<f64>, elements: usize, step: f64, end: f64) -> f64 {
    let stiffness = BeamStiffness {
        axial: 1e4,
        shear: [1e4; 2],
        torsion: 500.0,
        bending: [500.0; 2],
    };
    let law = StructuralMechanics::with_stiffness(stiffness).unwrap();
    let section = Moments::new(1.0, 10.0, 10.0).unwrap();
    let mut scene = Scene::<f64, 2>::new();
    let beam = Beam::new(Quadratic, section, law)
        .straight([6.0, 0.0], [0.0, 8.0], elements)
        .density(1.0);
    let beam = scene.add(beam).unwrap();
    let on = |t: f64| if t <= 2.5 { 1.0 } else { 0.0 };
    scene.force_in_time(beam.start(), [8.0, 0.0], on).unwrap();
    scene
        .moment_in_time(beam.start(), Moment::about_z(-80.0), on)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), scheme).unwrap();
    let mut worst = 0.0_f64;
    for line in REFERENCE.lines().skip(1) {
        let row: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        if row[0] > end {
            break;
        }
        run.until(row[0], Stepping::Fixed(step), |_| {}).unwrap();
        for (node, [x, y]) in [
            (beam.start(), [row[1], row[2]]),
            (beam.end(), [row[4], row[5]]),
        ] {
            let at = system.position(run.state(), node).unwrap();
            worst = worst.max((at[0] - x).hypot(at[1] - y));
        }
    }
    worst / 10.0
}

/// Eight elements at 10 ms follow the reference through the forced half turn, and through six turns
/// of free flight as far as two models with other stiffness of the section itself, and a
/// reference known to a thousandth, can agree.
#[test]
fn a_flying_beam_follows_the_reference() {
    let scheme = EnergyMomentum::conserving();
    for (end, bound) in [(2.5, 4e-4), (5.0, 1.5e-3), (15.0, 1e-2)] {
        let distance = distance(&scheme, 8, 1e-2, end);
        assert!(distance < bound, "{distance:e} to {end} s");
    }
    // A method with dissipation at the same step, while its own error is small.
    let distance = distance(&Newmark::generalised_alpha(0.8), 8, 1e-2, 2.5);
    assert!(distance < 4e-4, "{distance:e}");
}
