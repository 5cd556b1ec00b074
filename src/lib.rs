//! WIP
pub mod error;
pub mod scalar;
pub use error::{Error, Result};
