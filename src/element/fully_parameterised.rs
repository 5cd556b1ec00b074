//! The fully parameterised two-node beam of Shabana and Yakoub, the element of the paper:
//! position and all slopes at each node, cubic along the axis, linear across it.

use super::{Element, NodalVector};
use crate::scalar::Scalar;

/// Two nodes with position and every slope: `S = 6` vectors in the plane, `S = 8` in space
/// (eqs. 1 to 5 of Orzechowski 2012).
///
/// ```
/// use ancf::element::{Element, FullyParameterised};
///
/// // The end node's position function is 1 at the end, on the axis.
/// let s = Element::<3, 8>::shape(&FullyParameterised, 2.0, [1.0, 0.0, 0.0]);
/// assert_eq!(s, [0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FullyParameterised;

const VECTORS: [NodalVector; 4] = [
    NodalVector::Position,
    NodalVector::Slope(0),
    NodalVector::Slope(1),
    NodalVector::Slope(2),
];

fn shape<T: Scalar, const D: usize, const S: usize>(l: T, x: [T; D]) -> [T; S] {
    const { assert!(S == 2 * (D + 1), "position and D slopes at two nodes") };
    let (one, two, three) = (T::one(), T::lit(2.0), T::lit(3.0));
    let xi = x[0];
    let (xi2, xi3) = (xi * xi, xi * xi * xi);
    let mut s = [T::zero(); S];
    let b = D + 1;
    s[0] = one - three * xi2 + two * xi3;
    s[1] = l * (xi - two * xi2 + xi3);
    s[b] = three * xi2 - two * xi3;
    s[b + 1] = l * (xi3 - xi2);
    for a in 1..D {
        s[1 + a] = l * (x[a] - xi * x[a]);
        s[b + 1 + a] = l * xi * x[a];
    }
    s
}

macro_rules! dimension {
    ($d:literal, $s:literal) => {
        impl Element<$d, $s> for FullyParameterised {
            const NODES: usize = 2;
            const VECTORS: &'static [NodalVector] = VECTORS.split_at($d + 1).0;
            const AXIAL_DEGREE: usize = 3;

            fn shape<T: Scalar>(&self, l: T, xi: [T; $d]) -> [T; $s] {
                shape(l, xi)
            }
        }
    };
}
dimension!(2, 6);
dimension!(3, 8);
