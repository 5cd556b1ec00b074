//! Claims about line search: where it brings Newton's method to equilibria that full corrections miss.

use ancf::prelude::*;

/// A wire between two walls under its weight, hardly stiffer than a thread: the first correction
/// hangs it a thousand lengths deep. Full corrections diverge from there and need shorter load
/// steps; with a line search the whole load goes on at once, to the same equilibrium.
#[test]
fn a_line_search_hangs_a_wire_in_one_step() {
    let wire = EulerBernoulli::with_stiffness(1.0, 1e-8).unwrap();
    let mut scene = Scene::<f64, 2>::new();
    let beam = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0).unwrap(), wire);
    let beam = scene
        .add(beam.straight([0.0; 2], [1.0, 0.0], 20).density(1.0))
        .unwrap();
    scene.pin(beam.start()).unwrap();
    scene.pin(beam.end()).unwrap();
    let weight = 1e-2;
    scene.gravity([0.0, -weight]).unwrap();
    let system = scene.assemble().unwrap();
    let hang = |line_search, cutbacks| {
        let newton = Newton {
            line_search,
            ..Newton::default()
        };
        let settings = Statics {
            cutbacks,
            newton,
            ..Statics::default()
        };
        let mut state = system.rest();
        let report = settings.solve(&system, &mut state)?;
        let sag = -system.displacement(&state, beam.node(10))?[1];
        Ok::<_, Error>((sag, report))
    };
    assert!(hang(false, 0).is_err());
    let (sag, searched) = hang(true, 0).unwrap();
    let (same, halved) = hang(false, 12).unwrap();
    assert!((sag / same - 1.0).abs() < 1e-8, "{sag} {same}");
    assert!(halved.cutbacks > 0 && searched.iterations < halved.iterations);
    // A shallow parabola: H s = w L^2 / 8 with the tension H = EA 8 s^2 / (3 L^2).
    let parabola = (3.0 * weight / 64.0_f64).cbrt();
    assert!((sag / parabola - 1.0).abs() < 0.02, "{sag} {parabola}");
}
