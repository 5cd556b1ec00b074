//! Lanes in the registers of x86-64 processors newer than its baseline. The types are private: code
//! meets them as the `L` of [`LaneWork::run`] only, which is called with them below the check that
//! the processor has the instructions they are made of.

use std::arch::x86_64::*;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use num_traits::{One, Zero};

use super::jet::{self, Jet};
use super::lanes::{LaneWork, Lanes, blocks};
use super::pack::{Pack, Wide};
use super::{Algebra, Field, Scalar};
use crate::tensor::array;

/// Has the caches fetch what is soon read.
#[inline(always)]
pub(crate) fn prefetch<T>(number: &T) {
    // SAFETY: part of every processor of the architecture; whatever the address, nothing is read.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(number).cast()) }
}

/// Rows and columns are exchanged in square blocks of this many.
const TILE: usize = 4;

#[inline]
#[target_feature(enable = "avx2")]
fn transpose_f64(tile: &mut [[f64; TILE]; TILE]) {
    let load = |row: &[f64; TILE]| unsafe { _mm256_loadu_pd(row.as_ptr()) };
    let (a, b, c, d) = (
        load(&tile[0]),
        load(&tile[1]),
        load(&tile[2]),
        load(&tile[3]),
    );
    let (ac, bd) = (
        _mm256_permute2f128_pd(a, c, 0x20),
        _mm256_permute2f128_pd(b, d, 0x20),
    );
    let (ca, db) = (
        _mm256_permute2f128_pd(a, c, 0x31),
        _mm256_permute2f128_pd(b, d, 0x31),
    );
    let rows = [
        _mm256_unpacklo_pd(ac, bd),
        _mm256_unpackhi_pd(ac, bd),
        _mm256_unpacklo_pd(ca, db),
        _mm256_unpackhi_pd(ca, db),
    ];
    for (row, values) in tile.iter_mut().zip(rows) {
        unsafe { _mm256_storeu_pd(row.as_mut_ptr(), values) };
    }
}

#[inline]
#[target_feature(enable = "avx2")]
fn transpose_f32(tile: &mut [[f32; TILE]; TILE]) {
    let load = |row: &[f32; TILE]| unsafe { _mm_loadu_ps(row.as_ptr()) };
    let (a, b, c, d) = (
        load(&tile[0]),
        load(&tile[1]),
        load(&tile[2]),
        load(&tile[3]),
    );
    let (low, high) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
    let (low2, high2) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
    let rows = [
        _mm_movelh_ps(low, high),
        _mm_movehl_ps(high, low),
        _mm_movelh_ps(low2, high2),
        _mm_movehl_ps(high2, low2),
    ];
    for (row, values) in tile.iter_mut().zip(rows) {
        unsafe { _mm_storeu_ps(row.as_mut_ptr(), values) };
    }
}

/// Where a lane adds its row: a pointer and what is taken of steps along it, all or nothing.
#[derive(Debug, Clone, Copy)]
struct Row<R> {
    first: *mut R,
    moves: usize,
}

/// A lane type over a register, and the function that runs work in it.
macro_rules! register {
    (
        $t:ident, $raw:ident, $r:ty, $width:literal, $feature:literal, $run:ident,
        $pack:literal in $count:literal, $run_pack:ident,
        $set:ident $load:ident $store:ident $tile:ident
        $add:ident $sub:ident $mul:ident $div:ident $sqrt:ident $fused:ident $max:ident
    ) => {
        #[derive(Debug, Clone, Copy)]
        pub(super) struct $t($raw);

        /// Runs work in lanes of this type.
        #[target_feature(enable = $feature)]
        pub(super) fn $run<W: LaneWork<$r>>(work: W) -> W::Output {
            work.run::<$t>()
        }

        /// Runs work on packs in registers of this type.
        #[target_feature(enable = $feature)]
        pub(super) fn $run_pack<W: LaneWork<Pack<$r, $pack>>>(work: W) -> W::Output {
            work.run::<Wide<$t, $count>>()
        }

        // SAFETY, here and below: numbers of this type are made by work inside `$run`, `$run_pack` and
        // those of `@two` only, whose callers have found the processor to have the instructions.
        register!(@operator $t, Add add $add, AddAssign add_assign);
        register!(@operator $t, Sub sub $sub, SubAssign sub_assign);
        register!(@operator $t, Mul mul $mul, MulAssign mul_assign);
        register!(@operator $t, Div div $div, DivAssign div_assign);

        impl $t {
            #[inline(always)]
            fn to_array(self) -> [$r; $width] {
                let mut values = [0.0; $width];
                self.store(&mut values);
                values
            }
            #[inline(always)]
            fn map(self, f: impl Fn($r) -> $r) -> Self {
                Self::load(&self.to_array().map(f))
            }

            /// [`Lanes::gather`], which tells of each of `count` columns by its number.
            #[inline(always)]
            fn gather_each(
                x: &[$r],
                starts: impl Fn(usize) -> usize,
                count: usize,
                mut put: impl FnMut(usize, Self),
            ) {
                let mut rows = [x; $width];
                for (lane, row) in rows.iter_mut().enumerate() {
                    *row = &x[starts(lane)..][..count];
                }
                let whole = count / TILE * TILE;
                for i in (0..whole).step_by(TILE) {
                    let mut values = [[0.0; $width]; TILE];
                    for first in (0..$width).step_by(TILE) {
                        let mut tile = [[0.0; TILE]; TILE];
                        for lane in 0..TILE {
                            tile[lane].copy_from_slice(&rows[first + lane][i..i + TILE]);
                        }
                        unsafe { $tile(&mut tile) };
                        for j in 0..TILE {
                            values[j][first..first + TILE].copy_from_slice(&tile[j]);
                        }
                    }
                    for j in 0..TILE {
                        put(i + j, Self::load(&values[j]));
                    }
                }
                for i in whole..count {
                    let mut values = [0.0; $width];
                    for lane in 0..$width {
                        values[lane] = rows[lane][i];
                    }
                    put(i, Self::load(&values));
                }
            }

            /// [`Lanes::scatter`] of what `own` takes of the columns.
            #[inline(always)]
            fn scatter_each<C: Copy>(
                columns: &[C],
                own: impl Fn(C) -> Self,
                x: &mut [$r],
                starts: impl Fn(usize) -> Option<usize>,
            ) {
                let (tiles, rest) = columns.as_chunks::<TILE>();
                let whole = tiles.as_flattened().len();
                // Lanes without a row add to numbers of their own, or they would wait for one another.
                let mut nowhere = [[0.0; TILE]; $width];
                // One pointer for all rows: to ask for another would end what may be done with it.
                let (length, all) = (x.len(), x.as_mut_ptr());
                let mut end = 0;
                let mut rows = [Row { first: all, moves: 0 }; $width];
                for lane in 0..$width {
                    rows[lane].first = nowhere[lane].as_mut_ptr();
                    if let Some(start) = starts(lane) {
                        end = end.max(start.saturating_add(columns.len()));
                        let first = all.wrapping_add(start);
                        rows[lane] = Row { first, moves: usize::MAX };
                    }
                }
                assert!(end <= length, "rows lie within");
                let left = length - end;
                // From behind, for elements share their end nodes: of two that meet the first adds first, as
                // where they come one by one.
                if !rest.is_empty() {
                    // What a tile lacks is added behind the rows, and changes no number there.
                    let mut tile = [Self::lift(-0.0); TILE];
                    for j in 0..TILE - 1 {
                        if j < rest.len() {
                            tile[j] = own(rest[j]);
                        }
                    }
                    // SAFETY: so much is left behind the last row, or the rest alone is added.
                    match rest.len() + left >= TILE {
                        true => unsafe { Self::add_tile(tile, &rows, whole) },
                        false => unsafe { Self::add_part(tile, &rows, whole, rest.len()) },
                    }
                }
                for (k, tile) in tiles.iter().enumerate().rev() {
                    // SAFETY: rows are as long as there are columns.
                    unsafe { Self::add_tile(array(#[inline(always)] |j| own(tile[j])), &rows, k * TILE) };
                }
            }

            /// Adds a tile to rows from their number `i` on.
            ///
            /// # Safety
            /// From there on, as many numbers must follow in what the rows lie in.
            #[inline(always)]
            unsafe fn add_tile(tile: [Self; TILE], rows: &[Row<$r>; $width], i: usize) {
                let values = array::<_, TILE>(#[inline(always)] |j| tile[j].to_array());
                for first in (0..$width).step_by(TILE) {
                    let mut tile = [[0.0; TILE]; TILE];
                    for j in 0..TILE {
                        tile[j].copy_from_slice(&values[j][first..first + TILE]);
                    }
                    unsafe { $tile(&mut tile) };
                    for lane in 0..TILE {
                        let Row { first, moves } = rows[first + lane];
                        // SAFETY: as asked for, or numbers that nobody reads.
                        let row = unsafe { &mut *first.add(i & moves).cast::<[$r; TILE]>() };
                        for j in 0..TILE {
                            row[j] += tile[lane][j];
                        }
                    }
                }
            }

            /// The same of its first `count` columns.
            ///
            /// # Safety
            /// So many numbers must follow.
            #[inline(always)]
            unsafe fn add_part(tile: [Self; TILE], rows: &[Row<$r>; $width], i: usize, count: usize) {
                for (j, column) in tile[..count].iter().enumerate() {
                    for (Row { first, moves }, value) in rows.iter().zip(column.to_array()) {
                        // SAFETY: as asked for, or a number that nobody reads.
                        unsafe { *first.add(i & moves).add(j) += value };
                    }
                }
            }
        }
        impl Neg for $t {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self::lift(-0.0) - self
            }
        }
        impl Zero for $t {
            #[inline(always)]
            fn zero() -> Self {
                Self::lift(0.0)
            }
            fn is_zero(&self) -> bool {
                self.to_array() == [0.0; $width]
            }
        }
        impl One for $t {
            #[inline(always)]
            fn one() -> Self {
                Self::lift(1.0)
            }
        }
        impl Scalar for $t {
            #[inline(always)]
            fn lit(x: f64) -> Self {
                Self::lift(x as $r)
            }
            #[inline(always)]
            fn plus_product(self, a: Self, b: Self) -> Self {
                Self(unsafe { $fused(a.0, b.0, self.0) })
            }
            #[inline(always)]
            fn outlined<O>(mut work: impl FnMut() -> O) -> O {
                work()
            }
        }
        impl Field for $t {
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(unsafe { $sqrt(self.0) })
            }
            #[inline(always)]
            fn recip(self) -> Self {
                Self::one() / self
            }
            register!(@mapped $r, exp exp_m1 ln ln_1p sin cos asin acos atan sinh cosh tanh);
            #[inline(always)]
            fn frozen(self) -> Self {
                self
            }
        }
        impl Algebra<$r> for $t {
            type Dual<const M: usize> = Jet<Self, M>;
            #[inline(always)]
            fn lift(r: $r) -> Self {
                Self(unsafe { $set(r) })
            }
            #[inline(always)]
            fn times(self, r: $r) -> Self {
                self * Self::lift(r)
            }
            #[inline(always)]
            fn plus_times(self, r: $r, a: Self) -> Self {
                self.plus_product(a, Self::lift(r))
            }
            jet::by_jet!();
        }
        impl Lanes<$r> for $t {
            #[inline(always)]
            fn load(from: &[$r]) -> Self {
                let from = &from[..$width];
                Self(unsafe { $load(from.as_ptr()) })
            }
            #[inline(always)]
            fn store(self, to: &mut [$r]) {
                let to = &mut to[..$width];
                unsafe { $store(to.as_mut_ptr(), self.0) }
            }
            blocks!($r, $width);

            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                Self(unsafe { $max(other.0, self.0) })
            }

            #[inline(always)]
            fn gather(x: &[$r], starts: impl Fn(usize) -> usize, columns: &mut [Self]) {
                let count = columns.len();
                Self::gather_each(
                    x,
                    starts,
                    count,
                    #[inline(always)]
                    |i, column| columns[i] = column,
                );
            }
            #[inline(always)]
            fn scatter(columns: &[Self], x: &mut [$r], starts: impl Fn(usize) -> Option<usize>) {
                Self::scatter_each(
                    columns,
                    #[inline(always)]
                    |column| column,
                    x,
                    starts,
                );
            }
        }
    };
    (@two $t:ident, $r:ty, $width:literal, $both:literal, $feature:literal, $run:ident, $single:ident) => {
        /// Runs work on packs, rounded as in plain numbers that have no lanes. The processor must have the
        /// instructions.
        #[target_feature(enable = $feature)]
        pub(super) fn $single<W: LaneWork<Pack<$r, $both>>>(work: W) -> W::Output {
            work.run::<Wide<$t, 2, false>>()
        }

        /// Runs work in two registers at once, so that what is not arithmetic is done half as often: for
        /// work that is not heavy. The processor must have the instructions.
        #[target_feature(enable = $feature)]
        pub(super) fn $run<W: LaneWork<$r>>(work: W) -> W::Output {
            work.run::<Wide<$t, 2>>()
        }

        impl Algebra<$r> for Wide<$t, 2> {
            type Dual<const M: usize> = Jet<Self, M>;
            #[inline(always)]
            fn lift(r: $r) -> Self {
                Self([$t::lift(r); 2])
            }
            #[inline(always)]
            fn times(self, r: $r) -> Self {
                let both: Self = Algebra::<$r>::lift(r);
                self * both
            }
            #[inline(always)]
            fn plus_times(self, r: $r, a: Self) -> Self {
                self.plus_product(a, Algebra::<$r>::lift(r))
            }
            jet::by_jet!();
        }
        impl Lanes<$r> for Wide<$t, 2> {
            blocks!($r, $both);

            #[inline(always)]
            fn load(from: &[$r]) -> Self {
                let from = &from[..$both];
                Self([$t::load(from), $t::load(&from[$width..])])
            }
            #[inline(always)]
            fn store(self, to: &mut [$r]) {
                let to = &mut to[..$both];
                self.0[0].store(to);
                self.0[1].store(&mut to[$width..]);
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                self.with(other, $t::greater)
            }
            #[inline(always)]
            fn gather(x: &[$r], starts: impl Fn(usize) -> usize, columns: &mut [Self]) {
                for m in 0..2 {
                    let count = columns.len();
                    $t::gather_each(
                        x,
                        #[inline(always)]
                        |lane| starts(m * $width + lane),
                        count,
                        #[inline(always)]
                        |i, column| columns[i].0[m] = column,
                    );
                }
            }
            #[inline(always)]
            fn scatter(columns: &[Self], x: &mut [$r], starts: impl Fn(usize) -> Option<usize>) {
                // The elements of the first register add first, as where they come one by one.
                for m in 0..2 {
                    $t::scatter_each(
                        columns,
                        #[inline(always)]
                        |column| column.0[m],
                        x,
                        #[inline(always)]
                        |lane| starts(m * $width + lane),
                    );
                }
            }
        }
    };
    (@mapped $r:ty, $($function:ident)*) => {$(
        fn $function(self) -> Self {
            self.map(<$r>::$function)
        }
    )*};
    (@operator $t:ident, $trait:ident $method:ident $op:ident, $assign:ident $assign_method:ident) => {
        impl $trait for $t {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(unsafe { $op(self.0, other.0) })
            }
        }
        impl $assign for $t {
            #[inline(always)]
            fn $assign_method(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    };
}

register!(
    F64x4, __m256d, f64, 4, "avx2,fma", in_f64x4,
    8 in 2, in_two_f64x4,
    _mm256_set1_pd _mm256_loadu_pd _mm256_storeu_pd transpose_f64
    _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_sqrt_pd _mm256_fmadd_pd
    _mm256_max_pd
);
register!(
    F32x8, __m256, f32, 8, "avx2,fma", in_f32x8,
    16 in 2, in_two_f32x8,
    _mm256_set1_ps _mm256_loadu_ps _mm256_storeu_ps transpose_f32
    _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_sqrt_ps _mm256_fmadd_ps
    _mm256_max_ps
);
register!(
    F64x8, __m512d, f64, 8, "avx512f,avx2,fma", in_f64x8,
    8 in 1, in_one_f64x8,
    _mm512_set1_pd _mm512_loadu_pd _mm512_storeu_pd transpose_f64
    _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_sqrt_pd _mm512_fmadd_pd
    _mm512_max_pd
);
register!(
    F32x16, __m512, f32, 16, "avx512f,avx2,fma", in_f32x16,
    16 in 1, in_one_f32x16,
    _mm512_set1_ps _mm512_loadu_ps _mm512_storeu_ps transpose_f32
    _mm512_add_ps _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_sqrt_ps _mm512_fmadd_ps
    _mm512_max_ps
);
register!(@two F64x4, f64, 4, 8, "avx2,fma", in_both_f64x4, singly_f64x4);
register!(@two F32x8, f32, 8, 16, "avx2,fma", in_both_f32x8, singly_f32x8);
