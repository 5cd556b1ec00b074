//! The gradient-deficient cable of Berzeri and Shabana (2000) and Gerstmayr and Shabana (2006):
//! position and axial slope at two nodes, Hermite's cubic along the axis and no section, hence
//! neither shear nor torsion.

use super::{Element, NodalVector};
use crate::scalar::Scalar;

/// Two nodes with `r` and `r_x`: `S = 4` vectors in the plane and in space.
///
/// Clamping such a node holds the stretch of the axis too. A support that only holds its direction
/// pins the position and fixes the components of `r_x` across the axis, and converges faster.
///
/// ```
/// use ancf::element::{Cable, Element};
///
/// // Half way along a straight element of 2 m: the mean of the ends, the slopes cancel.
/// let s = Element::<2, 4>::shape(&Cable, 2.0, [0.5, 0.0]);
/// assert_eq!(s, [0.5, 0.25, 0.5, -0.25]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Cable;

impl<const D: usize> Element<D, 4> for Cable {
    const NODES: usize = 2;
    const VECTORS: &'static [NodalVector] = &[NodalVector::Position, NodalVector::Slope(0)];
    const AXIAL_DEGREE: usize = 3;
    const SECTION_DEGREE: usize = 0;

    fn shape<T: Scalar>(&self, l: T, x: [T; D]) -> [T; 4] {
        let (one, two, three) = (T::one(), T::lit(2.0), T::lit(3.0));
        let xi = x[0];
        let (xi2, xi3) = (xi * xi, xi * xi * xi);
        [
            one - three * xi2 + two * xi3,
            l * (xi - two * xi2 + xi3),
            three * xi2 - two * xi3,
            l * (xi3 - xi2),
        ]
    }
}
