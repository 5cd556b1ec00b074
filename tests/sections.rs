//! Claims about sections, rules and matrices, one file per family of claims: a single program, so that
//! their types are compiled once for all of them.

mod bad_outline;
mod band_solver;
mod exact;
mod outline;
mod quadrature;
mod section;
