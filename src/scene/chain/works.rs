//! What a chain does with all its elements: tasks that gather their displacements, run their kernels,
//! in lanes where the processor has them, and add what comes out to vectors and matrices.

use std::ops::Range;

use super::shares::{Numbers, Sink, Task};
use super::{Chain, Coupling};
use crate::error::Result;
use crate::formulation::{ElementKernel, Tangent, mirror};
use crate::scalar::{Lanes, MOST_LANES, Real};
use crate::solver::Matrix;
use crate::tensor::add_times;

/// A task of a chain that adds to `Numbers` or to a `Sink`.
macro_rules! task {
    ($task:ident, $out:ident, $heavy:literal, |$self:ident, $kernel:ident, $elements:ident, $sink:ident| $add:block) => {
        impl<R, Kn, const D: usize, const S: usize> Task<R, D, S> for $task<'_, Chain<R, Kn, D, S>, R>
        where
            R: Real,
            Kn: ElementKernel<R, D, S>,
        {
            type Out<'o> = $out<'o, R>;
            const HEAVY: bool = $heavy;

            fn halves<'h>(
                out: &'h mut $out<'_, R>,
                coordinate: usize,
            ) -> Option<($out<'h, R>, $out<'h, R>)> {
                task!(@halves $out, out, coordinate)
            }

            #[inline(always)]
            fn add<L: Lanes<R>, K: ElementKernel<R, D, S>>(
                &$self,
                $kernel: &K,
                $elements: Range<usize>,
                $sink: &mut $out<'_, R>,
            ) -> Result<()> $add
        }
    };
    (@halves Numbers, $out:ident, $coordinate:ident) => {
        Some($out.halves($coordinate))
    };
    (@halves Sink, $out:ident, $coordinate:ident) => {
        $out.halves($coordinate)
    };
}

/// Adds the elastic forces of a chain's elements.
pub(super) struct Force<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) u: &'a [R],
}

task!(Force, Numbers, false, |self, kernel, elements, q| {
    let chain = self.chain;
    chain.groups::<L, 1>(
        elements,
        ([self.u], 0),
        #[inline(always)]
        |elements, _, [u]| {
            let mut force = [[L::zero(); D]; S];
            kernel.force(u, &mut force);
            chain.scatter(&force, elements, q);
        },
    );
    Ok(())
});

/// Adds the mass matrices of a chain's elements times accelerations, which start at a coordinate.
pub(super) struct Acceleration<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) factor: R,
    pub(super) a: &'a [R],
    pub(super) from: usize,
}

task!(
    Acceleration,
    Numbers,
    false,
    |self, _kernel, elements, out| {
        let chain = self.chain;
        chain.groups::<L, 1>(
            elements,
            ([self.a], self.from),
            #[inline(always)]
            |elements, link, [a]| {
                if link.masses.is_empty() {
                    return;
                }
                let mut force = [[L::zero(); D]; S];
                for row in link.masses.chunk_by(|one, next| one.row == next.row) {
                    let mut sum = [L::zero(); D];
                    for Coupling { column, mass, .. } in row {
                        add_times(&mut sum, self.factor * *mass, &a[(*column).min(S - 1)]);
                    }
                    force[row[0].row.min(S - 1)] = sum;
                }
                chain.scatter(&force, elements, out);
            },
        );
        Ok(())
    }
);

/// Adds the tangents of a chain's elements, with a share of their mass where that is wanted.
pub(super) struct Stiffness<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) u: &'a [R],
    pub(super) mass: Option<R>,
}

task!(Stiffness, Sink, true, |self, kernel, elements, k| {
    let chain = self.chain;
    let mut result = Ok(());
    let mut tangent: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
    chain.groups::<L, 1>(
        elements,
        ([self.u], 0),
        #[inline(always)]
        |elements, link, [u]| {
            kernel.upper_tangent(u, &mut tangent);
            if let Some(share) = self.mass {
                let upper = link.masses.iter().filter(|entry| entry.row <= entry.column);
                for Coupling { row, column, mass } in upper {
                    let (i, j) = ((*row).min(S - 1), (*column).min(S - 1));
                    let m = L::lift(share * *mass);
                    for c in 0..D {
                        tangent[i][c][j][c] += m;
                    }
                }
            }
            if !k.is_symmetric() {
                mirror(&mut tangent);
            }
            if result.is_ok() {
                result = add_lanes(k, &tangent, chain.starts_in(elements));
            }
        },
    );
    result
});

/// Adds the secant forces of a chain's elements.
pub(super) struct Secant<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) viscosity: R,
    pub(super) ends: [&'a [R]; 2],
}

task!(Secant, Numbers, true, |self, kernel, elements, q| {
    let chain = self.chain;
    chain.groups::<L, 2>(
        elements,
        (self.ends, 0),
        #[inline(always)]
        |elements, _, [from, to]| {
            let mut force = [[L::zero(); D]; S];
            kernel.secant(self.viscosity, from, to, &mut force);
            chain.scatter(&force, elements, q);
        },
    );
    Ok(())
});

/// Adds the derivatives of a chain's secant forces.
pub(super) struct SecantStiffness<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) viscosity: R,
    pub(super) ends: [&'a [R]; 2],
}

task!(SecantStiffness, Sink, true, |self, kernel, elements, k| {
    let chain = self.chain;
    let mut result = Ok(());
    let mut tangent: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
    chain.groups::<L, 2>(
        elements,
        (self.ends, 0),
        #[inline(always)]
        |elements, _, [from, to]| {
            kernel.secant_tangent(self.viscosity, from, to, &mut tangent);
            if result.is_ok() {
                result = add_lanes(k, &tangent, chain.starts_in(elements));
            }
        },
    );
    result
});

/// Adds the tangents of the elements in the lanes that have a start; of those added to a symmetric
/// matrix the upper triangles are read.
#[inline(always)]
fn add_lanes<R: Real, L: Lanes<R>, const D: usize, const S: usize>(
    sink: &mut Sink<'_, R>,
    tangent: &Tangent<L, D, S>,
    start: impl Fn(usize) -> Option<usize>,
) -> Result<()> {
    let block = tangent.as_flattened().as_flattened().as_flattened();
    let k = match sink {
        Sink::Matrix(k) => k,
        Sink::Rows(rows) => return rows.add_blocks(S * D, block, &start),
    };
    let mut left = k.add_blocks(S * D, block, &start)?;
    while left != 0 {
        let lane = left.trailing_zeros() as usize;
        if let Some(offset) = start(lane) {
            add_lane::<R, L, D, S>(k, lane, offset, tangent)?;
        }
        left &= left - 1;
    }
    Ok(())
}

/// Adds the tangent of the element in one lane, in plain numbers.
#[inline(always)]
fn add_lane<R: Real, L: Lanes<R>, const D: usize, const S: usize>(
    k: &mut Matrix<R>,
    lane: usize,
    offset: usize,
    tangent: &Tangent<L, D, S>,
) -> Result<()> {
    let mut own: Tangent<R, D, S> = [[[[R::zero(); D]; S]; D]; S];
    let mut lanes = [R::zero(); MOST_LANES];
    let symmetric = k.stored().is_symmetric();
    for i in 0..S {
        for c in 0..D {
            let first = if symmetric { i } else { 0 };
            for j in first..S {
                for d in 0..D {
                    tangent[i][c][j][d].store(&mut lanes);
                    own[i][c][j][d] = lanes[lane];
                }
            }
        }
    }
    if symmetric {
        mirror(&mut own);
    }
    k.add_block(
        offset,
        S * D,
        own.as_flattened().as_flattened().as_flattened(),
    )
}
