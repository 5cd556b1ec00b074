//! Claims about every integrator: orders, conservation, dissipation, stability, step control, events
//! and what is refused, on structures of one unknown and on beams.

mod conservation;
mod control;
mod dissipation;
mod flying;
mod log;
mod models;
mod numbers;
mod order;
mod refusals;
mod resume;
mod secant;
