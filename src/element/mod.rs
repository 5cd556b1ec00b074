//! Elements: kinematics only. One file per family, each nothing but shape functions and the
//! names of its nodal vectors; no physics. Gradients come from the shape functions by dual
//! numbers, everything else from the gradients.

mod cable;
mod check;
mod fully_parameterised;
mod quadratic;

pub use cable::Cable;
pub(crate) use check::{ACROSS, Kit, check, check_layout, most};
pub use fully_parameterised::FullyParameterised;
pub use quadratic::Quadratic;

use std::fmt::Debug;

use crate::scalar::Scalar;

/// What one vector-valued nodal coordinate is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NodalVector {
    /// The position `r` (m).
    Position,
    /// The slope `dr/dX_a` along material axis `a` (0 the beam axis, 1 and 2 across).
    Slope(usize),
}

/// A family of elements in `D` dimensions with `S` vector-valued nodal coordinates.
///
/// The position field is `r(X) = sum_i s_i(X) e_i` (eq. 3 of Orzechowski 2012) with the nodal
/// vectors `e_i` node by node, each node carrying [`VECTORS`](Self::VECTORS) in that order. The
/// nodes are equally spaced from end to end, neighbours share the end nodes. Every node carries the same
/// vectors: positions and slopes, no higher derivatives and nothing inside the element. What of it an
/// energy can use is the formulation's to say: [`Continuum`](crate::formulation::Continuum) wants
/// elements that are linear across the section.
///
/// A scene does not compile with an element whose `S` is not [`NODES`](Self::NODES) times the length of
/// [`VECTORS`](Self::VECTORS):
///
/// ```compile_fail,E0080
/// use ancf::prelude::*;
///
/// #[derive(Debug, Clone, Copy)]
/// struct Short;
/// impl Element<2, 3> for Short {
///     const NODES: usize = 2;
///     const VECTORS: &'static [NodalVector] = &[NodalVector::Position, NodalVector::Slope(0)];
///     const AXIAL_DEGREE: usize = 3;
///     fn shape<T: Scalar>(&self, _: T, xi: [T; 2]) -> [T; 3] {
///         [xi[0]; 3]
///     }
/// }
/// let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.3)?;
/// let beam = Beam::new(Short, Disk::new(0.01)?, EulerBernoulli::new(&rubber));
/// Scene::<f64, 2>::new().add(beam.straight([0.0; 2], [1.0, 0.0], 4))?;
/// # Ok::<(), ancf::Error>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not an element with {S} nodal vectors in {D} dimensions",
    note = "S must be NODES times the number of nodal vectors of a node"
)]
pub trait Element<const D: usize, const S: usize>: Copy + Debug + Send + Sync + 'static {
    /// Number of nodes of an element, at least 2.
    const NODES: usize;
    /// The vector-valued coordinates of a node, a [`NodalVector::Position`] among them.
    const VECTORS: &'static [NodalVector];
    /// Polynomial degree of the shape functions along the axis.
    const AXIAL_DEGREE: usize;
    /// Polynomial degree of the shape functions across it.
    const SECTION_DEGREE: usize = 1;

    /// Shape functions `s_i` at the natural coordinates `xi = X / l` (eq. 6: the first from 0 to
    /// 1 along the axis, the others across it) for an element of length `l` (m).
    fn shape<T: Scalar>(&self, l: T, xi: [T; D]) -> [T; S];
}
