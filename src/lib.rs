//! Flexible beams in the absolute nodal coordinate formulation (ANCF), generic over the number
//! type and parameterised by dimension.
//!
//! A [`Scene`](scene::Scene) is made of [`Beam`](scene::Beam)s; a beam is a chain of
//! [`Element`](element::Element)s; an element samples a [`Section`](section::Section); a
//! [`Formulation`](formulation::Formulation) says which part of the strain energy of a
//! [`Material`](material::Material) is sampled where; and everything is written over a
//! [`Scalar`](scalar::Scalar), so that derivatives, SIMD lanes and precision are choices of type
//! and not new code.
//!
//! A new element is its shape functions, a new section is its cubature, a new material is its
//! strain energy, a locking remedy is a choice of what is sampled where. Mass matrix, elastic
//! force and tangent follow.
//!
//! The foundation is the method of G. Orzechowski, *Analysis of beam elements of circular cross
//! section using the absolute nodal coordinate formulation*, Archive of Mechanical Engineering,
//! 2012; equation numbers in this documentation are that paper's.
//!
//! # A beam bent into a circle
//!
//! ```
//! use ancf::prelude::*;
//! use std::f64::consts::PI;
//!
//! let (young, radius) = (2.0e11, 0.02);
//! let steel = SaintVenantKirchhoff::isotropic(young, 0.0)?;
//! let mut scene = Scene::<f64, 3>::new();
//! let beam = scene.add(
//!     Beam::new(FullyParameterised, Disk::new(radius)?, Continuum::full(steel))
//!         .straight([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 20),
//! )?;
//! scene.clamp(beam.start())?;
//! scene.moment(beam.end(), Moment::about_z(2.0 * PI * young * PI * radius.powi(4) / 4.0))?;
//!
//! let system = scene.assemble()?;
//! let mut state = system.rest();
//! Statics::in_steps(20).solve(&system, &mut state)?;
//! let [x, y, _] = system.position(&state, beam.end())?;
//! assert!((x.hypot(y) - 6.2402e-3).abs() < 1e-7);
//! # Ok::<(), ancf::Error>(())
//! ```
//!
//! # Map
//!
//! | module | what lives there |
//! |---|---|
//! | [`scalar`] | what kernels and solvers need of a number; `DoubleDouble` with the feature `double-double` |
//! | [`quadrature`] | rules on the line and in the plane, to any order, in the precision of the type |
//! | [`section`] | cross-sections: rectangle, disk, annulus, ellipse, rolled profiles, moments alone, anything given by its outline |
//! | [`material`] | strain energies: St Venant-Kirchhoff |
//! | [`element`] | shape functions: fully parameterised, quadratic shear-deformable, cable |
//! | [`formulation`] | what is sampled where: full, reduced, selective reduced, zero Poisson, your own; Euler-Bernoulli cables, structural mechanics; co-moving frame |
//! | [`scene`] | beams, rigid bodies, supports, joints, constraints, loads, gravity, and the system they assemble to; threads for long chains with the feature `rayon` |
//! | [`solver`] | band and sparse factorisation, Newton's method, statics, path following with its limit and bifurcation points, natural frequencies and buckling loads |
//! | [`integrator`] | Newmark's family, midpoint, energy-momentum, collocation, central differences; fixed, halved and error-controlled steps, events, checkpoints |
//! | [`sweep`] | one experiment for many parameters, in lanes, threads and shards |
//! | [`analytical`] | exact solutions to test against |
//! | [`verify`] | checks of your own elements, sections, materials and derivatives; where digits are lost |

pub mod analytical;
pub mod element;
pub mod error;
pub mod formulation;
pub mod integrator;
pub mod material;
pub mod quadrature;
pub mod scalar;
pub mod scene;
pub mod section;
pub mod solver;
pub mod sweep;
mod tensor;
pub mod verify;

pub use error::{Error, Result};

/// What most programs need: `use ancf::prelude::*`.
pub mod prelude {
    pub use crate::element::{Cable, Element, FullyParameterised, NodalVector, Quadratic};
    pub use crate::error::{Error, Result};
    pub use crate::formulation::{
        Across, BeamStiffness, CoMoving, Continuum, EulerBernoulli, Formulation, Layer,
        StructuralMechanics,
    };
    pub use crate::integrator::{
        Adaptive, CentralDifference, Checkpoint, Collocation, Crossing, Ending, EnergyMomentum,
        Estimator, Integration, Method, Midpoint, Newmark, Refusal, RunReport, Scheme, Step,
        Stepping,
    };
    pub use crate::material::{Material, PoissonSplit, SaintVenantKirchhoff, Tensor};
    pub use crate::quadrature::Cubature;
    pub use crate::scalar::{Algebra, Field, Real, Scalar};
    pub use crate::scene::{
        Beam, Connector, Constraint, Energies, Joint, Moment, MomentLaw, Momenta, Motion, Node,
        Placed, RigidBody, Scene, Spinning, System,
    };
    pub use crate::section::{
        Annulus, Disk, Ellipse, Loop, Moments, Offset, Outline, Rectangle, Section, box_profile,
        c_profile, i_profile, l_profile, t_profile,
    };
    pub use crate::solver::{
        Continuation, Control, Critical, Criticality, Mode, Modes, Newton, Path, PathCheckpoint,
        PathPoint, PathRefusal, PathReport, Refresh, Secant, State, Statics, Structure, Target,
    };
}

/// The programs of the README, kept compiling.
#[doc = include_str!("../README.md")]
#[cfg(doctest)]
pub struct Readme;
