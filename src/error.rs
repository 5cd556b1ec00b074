//! Everything that can go wrong, as one typed enum. Each message names the offending value and
//! says what to do about it; nothing in the library panics on bad input.

use thiserror::Error;

/// Result of every fallible call of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// A refused input or a failed solution. Numbers are reported in double precision whatever the
/// number type of the model.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A quantity that must be finite and positive is not.
    #[error("{what} is {value}, but must be a finite number above zero")]
    NotPositive {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A quantity that must be finite is NaN or infinite.
    #[error("{what} is {value}, but must be finite: check the input it was computed from")]
    NotFinite {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A quantity lies outside its admissible range.
    #[error("{what} is {value}, but must lie in {range}: {remedy}")]
    OutOfRange {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
        /// The admissible range.
        range: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A count that must be at least some number is smaller.
    #[error("{what} is {value}, but at least {least} is needed: {remedy}")]
    TooFew {
        /// Name of the count.
        what: &'static str,
        /// The value given.
        value: usize,
        /// The smallest admissible value.
        least: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// Something the library cannot do for this input.
    #[error("{what}: {remedy}")]
    Unsupported {
        /// What was asked.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
}

/// `value` if it is finite and above zero, a typed error that names it otherwise.
pub(crate) fn positive<R: crate::scalar::Real>(what: &'static str, value: R) -> Result<R> {
    if value.finite() && value > R::zero() {
        Ok(value)
    } else {
        let value = value.value();
        Err(Error::NotPositive { what, value })
    }
}

/// `value` if it is finite, a typed error that names it otherwise.
pub(crate) fn finite<R: crate::scalar::Real>(what: &'static str, value: R) -> Result<R> {
    if value.finite() {
        Ok(value)
    } else {
        let value = value.value();
        Err(Error::NotFinite { what, value })
    }
}
