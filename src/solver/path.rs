//! Paths of equilibria under a growing and falling load: the load factor is an unknown, and what
//! takes its place is the factor itself, a coordinate, or the length of the step along the path.
//! So limit points are passed, snap-through and snap-back followed, and no branch is left unseen.

use super::State;
use super::newton::Newton;
use crate::error::{Error, Result, positive};

/// What is prescribed along a path. Arc lengths are roots of the mean square over the unknowns, in
/// natural sizes, with [`load_weight`](Path::load_weight) times the change of the load factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// The load factor: stops at limit points, with the last equilibrium before them, and jumps to no
    /// other branch.
    Load,
    /// The displacement of the coordinate with this index (see `System::coordinate`): fails where
    /// it turns back.
    Coordinate(usize),
    /// The distance from the last point (M. A. Crisfield, *A fast incremental/iterative solution
    /// procedure that handles snap-through*, Computers & Structures 13, 1981), by the root of its
    /// quadratic that keeps to the direction taken; cylindrical without load weight.
    Sphere,
    /// The distance at first, then the plane normal to the step so far (E. Ramm, *Strategies for
    /// tracing the nonlinear response near limit points*, 1981): linear, so no root is to be
    /// chosen.
    Plane,
}

/// Settings of path following.
///
/// ```
/// use ancf::prelude::*;
///
/// // Two bars that meet 0.1 m above their supports, pushed through.
/// let stocky = EulerBernoulli::with_stiffness(1.0, 1.0)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let cable = Beam::new(Cable, Disk::new(0.01)?, stocky);
/// let left = scene.add(cable.clone().straight([0.0; 2], [1.0, 0.1], 1))?;
/// let right = scene.add(cable.straight([1.0, 0.1], [2.0, 0.0], 1))?;
/// scene.pin(left.start())?;
/// scene.pin(right.end())?;
/// scene.join(left.end(), right.start(), Joint::Spherical)?;
/// scene.fix(left.end(), NodalVector::Position, [true, false])?;
/// scene.force(left.end(), [0.0, -1e-3])?;
/// let system = scene.assemble()?;
/// let mut path = Continuation::start(&system, system.rest(), 0.0, &Path::default())?;
/// let top = system.coordinate(left.end(), NodalVector::Position)? + 1;
/// let mut largest = 0.0_f64;
/// path.until(Target::Coordinate(top, -0.15), |point| largest = largest.max(point.factor))?;
/// assert!((system.displacement(path.state(), left.end())?[1] + 0.15).abs() < 1e-12);
/// let limit = &path.criticals()[0];
/// assert_eq!(limit.kind, Criticality::Limit);
/// assert!(limit.factor >= largest);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Path {
    /// What is prescribed.
    pub control: Control,
    /// First step, in units of what is prescribed; its sign is the first direction, that of the
    /// load factor for arc lengths.
    pub first: f64,
    /// Longest step. It should be short against every loop of the path: what a step leaps over whole, to
    /// an equilibrium that is as stable, no check notices.
    pub longest: f64,
    /// Shortest step: below it the path ends with an error.
    pub shortest: f64,
    /// Weight of the load factor in arc lengths; a load factor of 1 should be of the order of the
    /// loads of interest, or the weight smaller.
    pub load_weight: f64,
    /// Newton corrections per point that the steps are adapted to.
    pub corrections: usize,
    /// Most points in one run to a target.
    pub points: usize,
    /// Share of a step to which limit and bifurcation points are located; `None` not to look for
    /// them. They are seen by a change in the number of negative eigenvalues of the tangent, and points
    /// within one step are told as one, with the numbers before and after. Under follower loads, whose
    /// tangent is unsymmetric, they are seen by a change of the sign of its determinant: two points
    /// within one step, or one at which two directions become critical, are then missed, and so is the
    /// onset of flutter, where no static equilibrium is critical.
    pub locate: Option<f64>,
    /// Newton's method at each point.
    pub newton: Newton,
}

impl Default for Path {
    fn default() -> Self {
        Self {
            control: Control::Sphere,
            first: 0.05,
            longest: 0.1,
            shortest: 1e-8,
            load_weight: 1.0,
            corrections: 7,
            points: 10_000,
            locate: Some(1e-6),
            newton: Newton::default(),
        }
    }
}

impl Path {
    /// The default settings under another control, with this first step, which is a third of the
    /// longest.
    pub fn by(control: Control, first: f64) -> Self {
        Self {
            control,
            first,
            longest: 3.0 * first.abs(),
            shortest: 1e-6 * first.abs(),
            ..Self::default()
        }
    }

    pub(super) fn check(&self, coordinates: usize) -> Result<()> {
        self.newton.check()?;
        if self.first == 0.0 || !self.first.is_finite() {
            return Err(Error::OutOfRange {
                what: "first step of a path",
                value: self.first,
                range: "finite numbers but 0",
                remedy: "its sign is the first direction",
            });
        }
        positive("longest step of a path", self.longest)?;
        positive("shortest step of a path", self.shortest)?;
        if !(self.load_weight >= 0.0 && self.load_weight.is_finite()) {
            return Err(Error::OutOfRange {
                what: "weight of the load factor in an arc length",
                value: self.load_weight,
                range: "0 and above",
                remedy: "0 measures displacements alone (cylindrical arc length)",
            });
        }
        if let Some(locate) = self.locate {
            positive("accuracy of critical points", locate)?;
        }
        for (what, value) in [
            ("number of Newton corrections per point", self.corrections),
            ("number of points of a path", self.points),
        ] {
            if value == 0 {
                return Err(Error::TooFew {
                    what,
                    value,
                    least: 1,
                    remedy: "allow at least one",
                });
            }
        }
        match self.control {
            Control::Coordinate(c) => check_coordinate(c, coordinates),
            _ => Ok(()),
        }
    }
}

pub(super) fn check_coordinate(index: usize, size: usize) -> Result<()> {
    match index < size {
        true => Ok(()),
        false => Err(Error::NoSuchCoordinate { index, size }),
    }
}

/// Where a run along a path ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target<R> {
    /// At this load factor, exactly.
    Factor(R),
    /// At this displacement of the coordinate with this index, exactly.
    Coordinate(usize, R),
    /// After this many points.
    Points(usize),
    /// At the first point beyond a limit or bifurcation point.
    Critical,
}

/// What a path took so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathReport {
    /// Points found.
    pub points: usize,
    /// Steps that failed and were halved.
    pub cutbacks: usize,
    /// Newton corrections of the points found.
    pub corrections: usize,
    /// Points found at the residual that rounding leaves, above Newton's tolerance.
    pub at_floor: usize,
}

/// A point of a path, as observers see it.
#[derive(Debug, Clone, Copy)]
pub struct PathPoint<'a, R> {
    /// The equilibrium.
    pub state: &'a State<R>,
    /// Share of the external load it carries.
    pub factor: R,
    /// In how many directions it is unstable; `None` where the factorisation does not tell.
    pub unstable: Option<usize>,
    /// What the path took so far, this point included.
    pub report: &'a PathReport,
}
