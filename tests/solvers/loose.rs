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

fn chain<R: Real, const D: usize>(slenderness: f64, hold: Hold) -> Result<()>
where
    EulerBernoulli<R>: Formulation<R, Cable, D, 4>,
{
    let lit = R::lit;
    let mut scene = Scene::<R, D>::new();
    let rule = EulerBernoulli::with_stiffness(R::one(), lit(slenderness * slenderness))?;
    let section = Moments::new(R::one(), R::one(), R::one())?;
    let beam = Beam::new(Cable, section, rule);
    let at = |x: f64| std::array::from_fn(|c| if c == 0 { lit(x) } else { R::zero() });
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
    let system = scene.assemble()?;
    Statics::default()
        .solve(&system, &mut system.rest())
        .map(|_| ())
}

fn told<const D: usize>()
where
    EulerBernoulli<f64>: Formulation<f64, Cable, D, 4>,
    EulerBernoulli<f32>: Formulation<f32, Cable, D, 4>,
{
    chain::<f64, D>(1e-2, Hold::Firm).unwrap();
    let lost = chain::<f32, D>(1e-5, Hold::Firm).unwrap_err();
    assert!(matches!(lost, Error::StiffnessLost { .. }), "{lost}");
    for hold in [
        Hold::FootTurns,
        Hold::MiddleTurns,
        Hold::Free,
        Hold::Straight,
    ] {
        for error in [
            chain::<f64, D>(1e-2, hold).unwrap_err(),
            chain::<f32, D>(1e-2, hold).unwrap_err(),
        ] {
            assert!(
                matches!(error, Error::Mechanism { .. }),
                "{hold:?}: {error}"
            );
        }
    }
}

/// Hinged and free chains are mechanisms in either precision, in the plane and in space; a clamped
/// one of a slenderness that single precision cannot hold is none. A chain straight between two walls
/// moves without deforming to first order, which is what its tangent knows.
#[test]
fn mechanisms_are_told_from_lost_digits() {
    told::<2>();
    told::<3>();
}
