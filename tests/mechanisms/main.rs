//! Claims about mechanisms of rigid bodies and constrained beams, in every integrator: one program,
//! whose few kernels compile in a moment.

mod bodies;
mod held;
mod modes;
