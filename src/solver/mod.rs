//! Solvers: linear algebra of chains, trees and loops, Newton's method, statics, path following,
//! modes. They live apart from the mechanics
//! because they know nothing of beams: they see a [`Structure`] through residuals, tangents and
//! masses over any [`Real`](crate::scalar::Real).

pub mod band;
mod checkpoint;
mod continuation;
mod critical;
mod eigen;
mod matrix;
mod modes;
mod newton;
mod observation;
mod order;
mod path;
mod progress;
mod sparse;
mod state;
mod statics;
mod stored;
mod structure;
mod tape;
mod unknowns;

pub use band::{BandMatrix, Factor, Profile};
pub use checkpoint::Checkpoint;
pub use continuation::Continuation;
pub use critical::{Critical, Criticality};
pub use matrix::Matrix;
pub(crate) use matrix::Rows;
pub use modes::{Mode, Modes};
pub(crate) use newton::{Equations, Rest, Sample, Workspace, norm};
pub use newton::{Newton, Refresh, Solved};
pub use observation::{Ending, Observation};
pub use path::{Control, Path, PathPoint, PathReport, Target};
pub use progress::{PathCheckpoint, PathRefusal};
pub use state::State;
pub use statics::{StaticReport, Statics};
pub use stored::Stored;
pub use structure::{Part, Rate, Ready, Secant, Structure};
pub(crate) use structure::{add_growing, add_projection, add_tangent_with, each_gradient, held};
pub use tape::{Record, Tape};
pub(crate) use unknowns::dependent;
pub use unknowns::{Condition, Unknowns};
