//! Claims about beams, what solves them and what moves them, one file per family of claims: a single
//! program, so that kernels are compiled once for all of them.

mod analytical;
mod bad_input;
mod constraints;
mod derivatives;
#[cfg(feature = "double-double")]
mod double_double;
mod dynamics;
mod elements;
mod families;
mod hard_cases;
mod integrators;
mod joints;
mod lanes;
mod mechanisms;
mod modes;
mod moments;
mod newton;
mod oscillators;
mod paper_problems;
mod paths;
mod precision;
mod published;
mod roll_up;
mod sampling;
mod sensitivity;
mod solvers;
mod statics;
mod structural;
mod threads;
mod topology;
mod verify;
mod welds;
