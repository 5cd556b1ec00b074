//! The shear-deformable element of Nachbagauer, Pechstein, Irschik and Gerstmayr (2011, 2013):
//! position and cross slopes at three nodes, quadratic along the axis, linear across it.

use super::{Element, NodalVector};
use crate::scalar::Scalar;

/// Three nodes with `r`, `r_y`[, `r_z`]: `S = 3 D` vectors, 6 in the plane and 9 in space.
///
/// ```
/// use ancf::element::{Element, Quadratic};
///
/// // At the middle node of an element of 2 m, 0.1 m off the axis: the node's r + y r_y.
/// let s = Element::<2, 6>::shape(&Quadratic, 2.0, [0.5, 0.05]);
/// assert_eq!(s, [0.0, 0.0, 1.0, 0.1, 0.0, 0.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Quadratic;

const VECTORS: [NodalVector; 3] = [
    NodalVector::Position,
    NodalVector::Slope(1),
    NodalVector::Slope(2),
];

fn shape<T: Scalar, const D: usize, const S: usize>(l: T, x: [T; D]) -> [T; S] {
    const { assert!(S == 3 * D, "position and D - 1 cross slopes at three nodes") };
    let (one, two, four) = (T::one(), T::lit(2.0), T::lit(4.0));
    let (xi, eta) = (x[0], one - x[0]);
    // Lagrange's quadratics of the start, the middle and the end.
    let node = [
        eta * (one - two * xi),
        four * xi * eta,
        xi * (two * xi - one),
    ];
    std::array::from_fn(|i| match i % D {
        0 => node[i / D],
        a => l * x[a] * node[i / D],
    })
}

macro_rules! dimension {
    ($d:literal, $s:literal) => {
        impl Element<$d, $s> for Quadratic {
            const NODES: usize = 3;
            const VECTORS: &'static [NodalVector] = VECTORS.split_at($d).0;
            const AXIAL_DEGREE: usize = 2;

            fn shape<T: Scalar>(&self, l: T, xi: [T; $d]) -> [T; $s] {
                shape(l, xi)
            }
        }
    };
}
dimension!(2, 6);
dimension!(3, 9);
