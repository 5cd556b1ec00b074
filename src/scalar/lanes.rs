//! Lanes: several numbers of a real type that go through a kernel together, one element in each.
//! [`Real::dispatch`](super::Real::dispatch) picks the widest [`Registers`](super::Registers) that
//! the processor at hand has, once per chain of elements and not per operation; simba's wide types
//! are the lanes of other architectures, and a real number is a lane of its own.

use num_traits::{One, Zero};
use simba::simd::{SimdBool, SimdComplexField, SimdPartialOrd, WideF32x4, WideF32x8, WideF64x4};

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

    /// The larger of two numbers, in every lane; the first where one is no number.
    fn greater(self, other: Self) -> Self;

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

/// Work that [`Real::dispatch`] runs in the lanes of the [`Registers`](super::Registers) that suit it.
pub trait LaneWork<R> {
    /// What comes out.
    type Output;

    /// Whether the work holds far more numbers than registers do, so that the widest bring nothing
    /// over those of AVX2 but machine code.
    const HEAVY: bool = false;

    /// Whether work that is not heavy goes through two registers of AVX2 at once, which halves what is not
    /// arithmetic. Worth it only where sums stay in registers and all that is called is inlined; a few
    /// elements fill half of the lanes.
    const PAIRED: bool = false;

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

/// Work of plain loops over numbers, compiled for the widest registers.
/// The closure must be inlined, which is why it is not asked to be one that is called once: those are
/// called by way of a function that is not.
pub(crate) struct Loops<F>(pub(crate) F);

/// What is done with the numbers at one place of several vectors, the same at every place: a loop
/// in registers. (Plain loops over packs are taken for strided ones, and end in gathers.)
pub(crate) trait Elementwise<R, const I: usize, const O: usize> {
    /// Changes numbers of `O` vectors by those of `I` others. Must be inlined.
    fn at<L: Lanes<R>>(&self, inputs: [L; I], outputs: &mut [L; O]);

    /// Does it at all places.
    fn run(&self, inputs: [&[R]; I], outputs: [&mut [R]; O])
    where
        R: Real,
        Self: Sized,
    {
        R::dispatch(AllPlaces {
            work: self,
            inputs,
            outputs,
        });
    }

    /// The same inside work in lanes.
    #[inline(always)]
    fn run_in<L: Lanes<R>>(&self, inputs: [&[R]; I], outputs: [&mut [R]; O])
    where
        R: Real,
        Self: Sized,
    {
        let places = AllPlaces {
            work: self,
            inputs,
            outputs,
        };
        LaneWork::run::<L>(places);
    }
}

/// Defines [`Elementwise`] work: its constants, the vectors it reads and those it changes.
macro_rules! elementwise {
    (
        $(#[$doc:meta])*
        $name:ident($($constant:ident),*): [$($input:ident),*] -> [$($output:ident),*] $body:block
    ) => {
        $(#[$doc])*
        struct $name<R> {
            $($constant: R),*
        }

        impl<R: $crate::scalar::Real>
            $crate::scalar::Elementwise<
                R,
                { <[&str]>::len(&[$(stringify!($input)),*]) },
                { <[&str]>::len(&[$(stringify!($output)),*]) },
            > for $name<R>
        {
            #[inline(always)]
            fn at<L: $crate::scalar::Lanes<R>>(
                &self,
                [$($input),*]: [L; { <[&str]>::len(&[$(stringify!($input)),*]) }],
                [$($output),*]: &mut [L; { <[&str]>::len(&[$(stringify!($output)),*]) }],
            ) {
                $(let $constant = L::lift(self.$constant);)*
                $body
            }
        }
    };
}
pub(crate) use elementwise;

struct AllPlaces<'a, R, W, const I: usize, const O: usize> {
    work: &'a W,
    inputs: [&'a [R]; I],
    outputs: [&'a mut [R]; O],
}

impl<R, W, const I: usize, const O: usize> LaneWork<R> for AllPlaces<'_, R, W, I, O>
where
    R: Real,
    W: Elementwise<R, I, O>,
{
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<R>>(self) {
        let Self {
            work,
            inputs,
            mut outputs,
        } = self;
        let length = outputs[0].len();
        let count = length / L::WIDTH;
        let mut from: [&[L::Block]; I] = [&[]; I];
        let mut to: [&mut [L::Block]; O] = std::array::from_fn(|_| Default::default());
        for (from, input) in from.iter_mut().zip(inputs) {
            *from = &L::blocks(&input[..length])[..count];
        }
        for (to, output) in to.iter_mut().zip(&mut outputs) {
            *to = &mut L::blocks_mut(&mut output[..length])[..count];
        }
        for i in 0..count {
            let (mut ins, mut outs) = ([L::zero(); I], [L::zero(); O]);
            for n in 0..I {
                ins[n] = L::load(from[n][i].as_ref());
            }
            for n in 0..O {
                outs[n] = L::load(to[n][i].as_ref());
            }
            work.at(ins, &mut outs);
            for n in 0..O {
                outs[n].store(to[n][i].as_mut());
            }
        }
        // The last ones in registers, too, so that all of them round alike.
        let (start, rest) = (count * L::WIDTH, length % L::WIDTH);
        if rest > 0 {
            let mut numbers = [R::zero(); MOST_LANES];
            let (mut ins, mut outs) = ([L::zero(); I], [L::zero(); O]);
            for n in 0..I {
                numbers[..rest].copy_from_slice(&inputs[n][start..length]);
                ins[n] = L::load(&numbers);
            }
            for n in 0..O {
                numbers[..rest].copy_from_slice(&outputs[n][start..length]);
                outs[n] = L::load(&numbers);
            }
            work.at(ins, &mut outs);
            for n in 0..O {
                outs[n].store(&mut numbers);
                outputs[n][start..length].copy_from_slice(&numbers[..rest]);
            }
        }
    }
}

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
    fn greater(self, other: Self) -> Self {
        self.larger(other)
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
            // From behind, as on x86-64.
            for (b, block) in columns.chunks($width).enumerate().rev() {
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
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                other.simd_gt(self).if_else(|| other, || self)
            }
            by_array!($r, $width);
        }
    )*};
}
lanes!(WideF32x4 of f32, 4; WideF32x8 of f32, 8; WideF64x4 of f64, 4);
