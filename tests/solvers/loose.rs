//! Claims about singular tangents: what can move is told from what has lost its stiffness to rounding.

use ancf::prelude::*;

/// How a chain of two beams is held.
#[derive(Debug, Clone, Copy)]
enum Hold {
    /// A clamp and a weld.
    Firm,
    /// A hinge at the foot.
    FootTurns,
    /// A hinge between the beams.
    MiddleTurns,
    /// Nothing.
    Free,
    /// Both feet and the middle are hinged: a chain that hangs straight between walls.
    Straight,
}

fn chain<R: Real, const D: usize>(slenderness: f64, hold: Hold) -> Result<(System<R, D>, [Node; 2])>
where
    EulerBernoulli<R>: Formulation<R, Cable, D, 4>,
{
    let lit = R::lit;
    let mut scene = Scene::<R, D>::new();
    let rule = EulerBernoulli::with_stiffness(R::one(), lit(slenderness * slenderness))?;
    let section = Moments::new(R::one(), R::one(), R::one())?;
    let beam = Beam::new(Cable, section, rule);
    // Aslant, or the stiffness along the beam would stand apart from that across.
    let slant = [0.6, 0.8, 0.0];
    let at = |x: f64| std::array::from_fn(|c| lit(x * slant[c]));
    let first = scene.add(beam.clone().straight(at(0.0), at(1.0), 4))?;
    let second = scene.add(beam.straight(at(1.0), at(2.0), 4))?;
    match hold {
        Hold::Firm | Hold::MiddleTurns => scene.clamp(first.start())?,
        Hold::FootTurns | Hold::Straight => scene.pin(first.start())?,
        Hold::Free => {}
    }
    if let Hold::Straight = hold {
        scene.pin(second.end())?;
    }
    let joint = match hold {
        Hold::MiddleTurns | Hold::Straight => Joint::Spherical,
        _ => Joint::Rigid,
    };
    scene.join(first.end(), second.start(), joint)?;
    let mut force = [R::zero(); D];
    force[1] = lit(1e-3 * slenderness * slenderness);
    scene.force(first.end(), force)?;
    Ok((scene.assemble()?, [first.end(), second.start()]))
}

fn refused<R: Real, const D: usize>(slenderness: f64, hold: Hold) -> Error
where
    EulerBernoulli<R>: Formulation<R, Cable, D, 4>,
{
    let (system, _) = chain::<R, D>(slenderness, hold).unwrap();
    let solved = Statics::default().solve(&system, &mut system.rest());
    solved.unwrap_err()
}

fn told<const D: usize>()
where
    EulerBernoulli<f64>: Formulation<f64, Cable, D, 4>,
    EulerBernoulli<f32>: Formulation<f32, Cable, D, 4>,
{
    let loose = |slenderness, hold, across: f32| {
        let (system, middle) = chain::<f32, D>(slenderness, hold).unwrap();
        let mut state = system.rest();
        for node in middle {
            let at = system.coordinate(node, NodalVector::Position).unwrap();
            state.displacement[at] += across;
        }
        system.moves_rigidly(&state.displacement)
    };
    for slenderness in [1e-1, 1e-4] {
        assert_eq!(loose(slenderness, Hold::Firm, 0.0), Some(false));
        for hold in [Hold::FootTurns, Hold::MiddleTurns, Hold::Free] {
            assert_eq!(loose(slenderness, hold, 0.0), Some(true), "{hold:?}");
            assert_eq!(loose(slenderness, hold, 0.1), Some(true), "{hold:?}");
        }
        assert_eq!(loose(slenderness, Hold::Straight, 0.0), Some(true));
        // What sags cannot move in its plane, but swings out of it.
        assert_eq!(loose(slenderness, Hold::Straight, 0.1), Some(D == 3));
    }
    let lost = refused::<f32, D>(1e-4, Hold::Firm);
    assert!(matches!(lost, Error::StiffnessLost { .. }), "{lost}");
    for free in [
        refused::<f32, D>(1e-1, Hold::Free),
        refused::<f64, D>(1e-1, Hold::Free),
    ] {
        assert!(matches!(free, Error::Mechanism { .. }), "{free}");
    }
}

/// Hinged and free chains can move as rigid bodies whatever their slenderness, in the plane and in
/// space, and a chain straight between two walls to first order, until it sags; a clamped one cannot.
/// So where single precision has lost its stiffness the error is another than that of a free chain.
#[test]
fn mechanisms_are_told_from_lost_digits() {
    told::<2>();
    told::<3>();
}
