//! Claims about mechanisms of rigid bodies and constrained beams, in every integrator.

mod bodies;
mod held;
mod modes;
