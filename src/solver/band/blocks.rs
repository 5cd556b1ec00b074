//! Loops over long rows and columns by blocks of registers, shared by the factorisations: slices of as
//! many blocks, so that no loop checks a bound.

use crate::scalar::{Lanes, Real};

/// Numbers a scalar product is summed in, whatever the registers hold, so that all of them round
/// alike.
pub(super) const SUMS: usize = 8;

/// The first blocks of a slice.
#[inline(always)]
pub(super) fn first_blocks<R, L: Lanes<R>>(from: &[R], count: usize) -> &[L::Block] {
    &L::blocks(from)[..count]
}

/// The same, to write.
#[inline(always)]
pub(super) fn first_blocks_mut<R, L: Lanes<R>>(to: &mut [R], count: usize) -> &mut [L::Block] {
    &mut L::blocks_mut(to)[..count]
}

/// The partial sums of the scalar products of `N` columns with a vector.
#[inline(always)]
pub(super) fn products<R: Real, L: Lanes<R>, const N: usize>(
    columns: &[&[R]],
    x: &[R],
    below: usize,
    parts: &mut [[R; SUMS]],
) {
    assert!(SUMS.is_multiple_of(L::WIDTH), "registers of HEAVY work");
    let mut sums = [[L::zero(); SUMS]; N];
    let whole = below / SUMS;
    let known = &x.as_chunks::<SUMS>().0[..whole];
    let mut blocks: [&[[R; SUMS]]; N] = [&[]; N];
    for n in 0..N {
        blocks[n] = &columns[n].as_chunks().0[..whole];
    }
    // What was found last comes last: the rest is summed while that is awaited.
    for (part, at) in (whole * SUMS..below).step_by(L::WIDTH).enumerate() {
        let known = L::load(&x[at..]);
        for n in 0..N {
            sums[n][part] = sums[n][part].plus_product(known, L::load(&columns[n][at..]));
        }
    }
    for i in (0..whole).rev() {
        for part in 0..SUMS / L::WIDTH {
            let known = L::load(&known[i][part * L::WIDTH..]);
            for n in 0..N {
                let along = L::load(&blocks[n][i][part * L::WIDTH..]);
                sums[n][part] = sums[n][part].plus_product(known, along);
            }
        }
    }
    for n in 0..N {
        for part in 0..SUMS / L::WIDTH {
            sums[n][part].store(&mut parts[n][part * L::WIDTH..]);
        }
    }
}

/// Adds a multiple of one row to another, as far as `reached` numbers fill registers.
#[inline(always)]
pub(super) fn add_multiple<R: Real, L: Lanes<R>>(
    factor: R,
    row: &[R],
    sum: &mut [R],
    reached: usize,
) {
    let factor = L::lift(factor);
    let count = reached / L::WIDTH;
    let (row, sum) = (
        first_blocks::<R, L>(row, count),
        first_blocks_mut::<R, L>(sum, count),
    );
    for k in 0..count {
        let entry = L::load(sum[k].as_ref());
        let along = L::load(row[k].as_ref());
        entry.plus_product(along, factor).store(sum[k].as_mut());
    }
}

/// The number in the first lane.
#[inline(always)]
pub(super) fn first<R: Real, L: Lanes<R>>(lanes: L) -> R {
    if L::WIDTH == 1 {
        let mut number = [R::zero()];
        lanes.store(&mut number);
        return number[0];
    }
    let mut numbers = [R::zero(); SUMS];
    lanes.store(&mut numbers);
    numbers[0]
}
