//! Lanes: several numbers of a real type that go through a kernel together, one element in each.
//! [`Real::dispatch`](super::Real::dispatch) picks the widest registers that the processor at hand
//! has, once per chain of elements and not per operation; simba's wide types are the lanes of other
//! architectures, and a real number is a lane of its own.

use num_traits::{One, Zero};
use simba::simd::{SimdComplexField, WideF32x4, WideF32x8, WideF64x4};

use super::jet::{self, Jet};
use super::{Algebra, Field, Real, Scalar};

/// Numbers in the widest registers of the smallest type.
pub(crate) const MOST_LANES: usize = 16;

/// `WIDTH` numbers of the type `R` at once.
pub trait Lanes<R>: Algebra<R> {
    /// How many.
    const WIDTH: usize;

    /// The first `WIDTH` numbers of a slice.
    ///
    /// # Panics
    /// If it holds fewer.
    fn load(from: &[R]) -> Self;

    /// Overwrites the first `WIDTH` numbers of a slice.
    ///
    /// # Panics
    /// If it holds fewer.
    fn store(self, to: &mut [R]);

    /// `WIDTH` numbers that follow each other.
    type Block: AsRef<[R]> + AsMut<[R]>;

    /// A slice by blocks, less what is left over: with slices of as many blocks, loops check no bounds.
    fn blocks(from: &[R]) -> &[Self::Block];

    /// The same, to write.
    fn blocks_mut(to: &mut [R]) -> &mut [Self::Block];

    /// Reads rows into columns: number `i` of the row that begins at `starts(lane)` becomes that
    /// lane of `columns[i]`.
    ///
    /// # Panics
    /// If a row reaches beyond `x`.
    fn gather(x: &[R], starts: impl Fn(usize) -> usize, columns: &mut [Self]);

    /// Adds columns to the rows of the lanes that have a start: the reverse of
    /// [`gather`](Self::gather), for rows that may overlap.
    ///
    /// # Panics
    /// If a row reaches beyond `x`.
    fn scatter(columns: &[Self], x: &mut [R], starts: impl Fn(usize) -> Option<usize>);
}

/// Work that [`Real::dispatch`] runs in the widest lanes there are.
pub trait LaneWork<R> {
    /// What comes out.
    type Output;

    /// Whether the work holds far more numbers than registers do, so that the widest bring nothing
    /// over those of AVX2 but machine code.
    const HEAVY: bool = false;

    /// Does the work in lanes of one type. Must be inlined (`#[inline(always)]`), and so must what
    /// it calls, to be compiled for the registers that `L` stands for.
    fn run<L: Lanes<R>>(self) -> Self::Output;

    /// Does the work one number at a time: compiled once, wherever it is asked for.
    #[inline(never)]
    fn run_singly(self) -> Self::Output
    where
        R: Real,
        Self: Sized,
    {
        self.run::<R>()
    }
}

/// Work of plain loops over numbers, compiled for the widest registers, which packs fill by themselves.
/// The closure must be inlined, which is why it is not asked to be one that is called once: those are
/// called by way of a function that is not.
pub(crate) struct Loops<F>(pub(crate) F);

impl<R, T, F: FnMut() -> T> LaneWork<R> for Loops<F> {
    type Output = T;

    #[inline(always)]
    fn run<L: Lanes<R>>(mut self) -> T {
        (self.0)()
    }
}

/// The blocks of a lane type.
macro_rules! blocks {
    ($r:ty, $width:literal) => {
        const WIDTH: usize = $width;
        type Block = [$r; $width];

        #[inline(always)]
        fn blocks(from: &[$r]) -> &[[$r; $width]] {
            from.as_chunks().0
        }
        #[inline(always)]
        fn blocks_mut(to: &mut [$r]) -> &mut [[$r; $width]] {
            to.as_chunks_mut().0
        }
    };
}
pub(super) use blocks;

impl<R: Real> Lanes<R> for R {
    blocks!(R, 1);

    #[inline(always)]
    fn load(from: &[R]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [R]) {
        to[0] = self;
    }
    #[inline(always)]
    fn gather(x: &[R], starts: impl Fn(usize) -> usize, columns: &mut [Self]) {
        let start = starts(0);
        columns.copy_from_slice(&x[start..start + columns.len()]);
    }
    #[inline(always)]
    fn scatter(columns: &[Self], x: &mut [R], starts: impl Fn(usize) -> Option<usize>) {
        let Some(start) = starts(0) else { return };
        for (x, column) in x[start..start + columns.len()].iter_mut().zip(columns) {
            *x += *column;
        }
    }
}

/// [`Lanes`] by an array of `WIDTH` numbers, which compilers turn into shuffles.
macro_rules! by_array {
    ($r:ty, $width:literal) => {
        blocks!($r, $width);

        #[inline(always)]
        fn gather(x: &[$r], starts: impl Fn(usize) -> usize, columns: &mut [Self]) {
            let mut rows = [x; $width];
            for (lane, row) in rows.iter_mut().enumerate() {
                *row = &x[starts(lane)..][..columns.len()];
            }
            for i in 0..columns.len() {
                let mut values = [0.0; $width];
                for lane in 0..$width {
                    values[lane] = rows[lane][i];
                }
                columns[i] = Self::load(&values);
            }
        }
        #[inline(always)]
        fn scatter(columns: &[Self], x: &mut [$r], starts: impl Fn(usize) -> Option<usize>) {
            for (b, block) in columns.chunks($width).enumerate() {
                let mut values = [[0.0; $width]; $width];
                for (values, column) in values.iter_mut().zip(block) {
                    column.store(values);
                }
                for lane in 0..$width {
                    let Some(start) = starts(lane) else { continue };
                    let start = start + $width * b;
                    for (x, values) in x[start..start + block.len()].iter_mut().zip(&values) {
                        *x += values[lane];
                    }
                }
            }
        }
    };
}
macro_rules! by_simba {
    ($($function:ident $simba:ident),*) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            self.$simba()
        }
    )*};
}
macro_rules! lanes {
    ($($t:ident of $r:ty, $width:literal);*) => {$(
        impl Scalar for $t {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                Self::lift(x as $r)
            }
            #[inline(always)]
            fn outlined<O>(mut work: impl FnMut() -> O) -> O {
                work()
            }
        }
        impl Field for $t {
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.simd_sqrt()
            }
            #[inline(always)]
            fn recip(self) -> Self {
                Self::one() / self
            }
            by_simba! {
                exp simd_exp, exp_m1 simd_exp_m1, ln simd_ln, ln_1p simd_ln_1p,
                sin simd_sin, cos simd_cos, asin simd_asin, acos simd_acos, atan simd_atan,
                sinh simd_sinh, cosh simd_cosh, tanh simd_tanh
            }
            #[inline(always)]
            fn frozen(self) -> Self {
                self
            }
        }
        impl Algebra<$r> for $t {
            // num-dual's numbers need an order, which lanes do not have.
            type Dual<const M: usize> = Jet<Self, M>;
            #[inline(always)]
            fn lift(r: $r) -> Self {
                $t(r.into())
            }
            #[inline(always)]
            fn times(self, r: $r) -> Self {
                self * Self::lift(r)
            }
            jet::by_jet!();
        }
        impl Lanes<$r> for $t {
            #[inline(always)]
            fn load(from: &[$r]) -> Self {
                let values: [$r; $width] = std::array::from_fn(|lane| from[lane]);
                values.into()
            }
            #[inline(always)]
            fn store(self, to: &mut [$r]) {
                to[..$width].copy_from_slice(&<[$r; $width]>::from(self.0));
            }
            by_array!($r, $width);
        }
    )*};
}
lanes!(WideF32x4 of f32, 4; WideF32x8 of f32, 8; WideF64x4 of f64, 4);
