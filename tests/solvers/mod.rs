//! Claims about how equilibria are found and followed, one file per family of claims.

mod follower;
mod loose;
mod permanent;
mod resume;
mod search;
mod truss;
