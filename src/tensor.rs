//! Small fixed-size vector operations of the kernels, written out over any [`Scalar`]. Not
//! nalgebra's: its matrix products shortcut on zero real parts, which drops derivatives when the
//! scalar is a dual number.

/// Runs a block for each index below a constant, written out where there are few: compilers unroll
/// such loops, too, but take a time for it that grows with the square of the function they are in.
macro_rules! each {
    ($i:ident in $from:literal..$n:expr, $body:block) => {
        const { assert!($from <= 4) };
        each!(@one $i 0 $from $n, $body);
        each!(@one $i 1 $from $n, $body);
        each!(@one $i 2 $from $n, $body);
        each!(@one $i 3 $from $n, $body);
        if const { $n > 4 } {
            for $i in 4..$n $body
        }
    };
    (@one $i:ident $at:literal $from:literal $n:expr, $body:block) => {
        if const { $at >= $from && $at < $n } {
            let $i: usize = $at;
            $body
        }
    };
}
pub(crate) use each;

#[allow(
    unsafe_code,
    reason = "room that is not filled before it is written to"
)]
mod room;

use crate::scalar::{Algebra, Field, Real, Scalar};
pub(crate) use room::{Pairs, array};
pub use room::{Room, Stack};

/// `a . b`.
#[inline(always)]
pub(crate) fn dot<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> T {
    let mut sum = a[0] * b[0];
    each!(c in 1..D, { sum = sum.plus_product(a[c], b[c]) });
    sum
}

/// `a + b`.
#[inline(always)]
pub(crate) fn sum<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; D] {
    array(|c| a[c] + b[c])
}

/// `a - b`.
#[inline(always)]
pub(crate) fn difference<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; D] {
    array(|c| a[c] - b[c])
}

/// `y += k x`.
#[inline(always)]
pub(crate) fn add_scaled<T: Scalar, const D: usize>(y: &mut [T; D], k: T, x: &[T; D]) {
    each!(c in 0..D, { y[c] = y[c].plus_product(k, x[c]) });
}

/// `y += r x` with `r` a parameter of the model.
#[inline(always)]
pub(crate) fn add_times<R: Copy, T: Algebra<R>, const D: usize>(y: &mut [T; D], r: R, x: &[T; D]) {
    each!(c in 0..D, { y[c] = y[c].plus_times(r, x[c]) });
}

/// `k x`.
#[inline(always)]
pub(crate) fn scaled<T: Scalar, const D: usize>(k: T, x: &[T; D]) -> [T; D] {
    array(|c| k * x[c])
}

/// `r x` with `r` a parameter of the model.
#[inline(always)]
pub(crate) fn times<R: Copy, T: Algebra<R>, const D: usize>(r: R, x: &[T; D]) -> [T; D] {
    array(|c| x[c].times(r))
}

/// Cross product in space.
#[inline(always)]
pub(crate) fn cross<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// The place at a share of the straight way between two sets of vectors.
#[inline(always)]
pub(crate) fn between<R: Copy, T: Algebra<R>, const D: usize, const N: usize>(
    from: &[[T; D]; N],
    to: &[[T; D]; N],
    share: R,
) -> [[T; D]; N] {
    let mut between = *from;
    for i in 0..N {
        each!(c in 0..D, { between[i][c] += (to[i][c] - from[i][c]).times(share) });
    }
    between
}

/// The two Gauss points of the interval from 0 to 1, of equal weight.
#[inline(always)]
pub(crate) fn gauss_pair<R: Real>() -> [R; 2] {
    let (half, offset) = (R::lit(0.5), Field::recip(Field::sqrt(R::lit(12.0))));
    [half - offset, half + offset]
}
