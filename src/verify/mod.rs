//! Checks for types of your own. A new element, section or material is a few lines, and a wrong
//! coefficient in them gives plausible beams; each check here measures what must hold by theory
//! and returns a [`Report`], which prints as a table and fails a test by `into_result()?`.
//!
//! | check | of |
//! |---|---|
//! | [`element`] | shape functions: what they reproduce at nodes and of linear fields |
//! | [`formulation`] | energy, force, tangent and mass of one element and of a short chain |
//! | [`sampling`] | zero-energy modes of a continuum for every pair of orders |
//! | [`frequencies`] | natural frequencies of a chain against Timoshenko's beam |
//! | [`section`] | rules against the outline |
//! | [`material`], [`linear_elasticity`], [`isotropy`] | stress and elasticity against the energy |
//! | [`jacobian`] and its kin | exact derivatives against finite differences, with the V-curve |
//! | [`precision`] | digits lost in a number type, and the stage of a computation that loses them |
//! | [`slender`] | the same of a slender beam's force, over slenderness, elements, rotation and offset |
//!
//! ```
//! use ancf::prelude::*;
//! use ancf::verify;
//!
//! let report = verify::element::<_, 3, 8>(&FullyParameterised, 0.5)
//!     .and(verify::section(&Disk::new(0.02)?, 7)?);
//! println!("{report}");
//! report.into_result()?;
//! # Ok::<(), ancf::Error>(())
//! ```

mod element;
mod formulation;
mod inertia;
mod jacobian;
mod material;
mod patch;
mod precision;
mod reduced;
mod report;
mod section;
mod slender;
mod textbook;
mod vibration;

pub use element::element;
pub use formulation::{formulation, sampling};
pub use jacobian::{
    Curve, CurveRow, Residual, Scheme, differences, energy_gradient, force_gradient, jacobian,
    structure_tangent,
};
pub use material::{isotropy, linear_elasticity, material};
pub use precision::{Precision, PrecisionRow, Share, Staged, precision};
pub use reduced::{ByEnergy, ByForce, ByPoints, ByStress};
pub use report::{Limit, Report, Row};
pub use section::section;
pub use slender::{Parts, Pose, Slender, SlenderRow, SlenderStudy, slender, slender_spread};
pub use textbook::{Textbook, TextbookKernel};
pub use vibration::{Rod, frequencies};
