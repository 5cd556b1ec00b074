//! What a chain does with all its elements: work that gathers their displacements, runs their kernels,
//! in lanes where the processor has them, and adds what comes out to vectors and matrices.

use super::{Chain, of};
use crate::element::Element;
use crate::error::Result;
use crate::formulation::{ElementKernel, KernelWork, Tangent, mirror};
use crate::scalar::{LaneWork, Lanes, Real};
use crate::solver::Matrix;
use crate::tensor::add_times;

/// Adds the elastic forces of a chain's elements.
pub(super) struct Force<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) u: &'a [R],
    pub(super) q: &'a mut [R],
}

impl<R, E, Kn, const D: usize, const S: usize> KernelWork<R, D, S>
    for Force<'_, Chain<R, E, Kn, D, S>, R>
where
    R: Real,
    E: Element<D, S>,
    Kn: ElementKernel<R, D, S>,
{
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernels: &[K]) {
        let Self { chain, u, q } = self;
        chain.groups::<L, 1>(
            [u],
            #[inline(always)]
            |elements, _, [u]| {
                let mut force = [[L::zero(); D]; S];
                of(kernels, elements.start).force(u, &mut force);
                L::scatter(force.as_flattened(), q, chain.starts_in(elements));
            },
        );
    }
}

/// Adds the mass matrices of a chain's elements times accelerations.
pub(super) struct Acceleration<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) factor: R,
    pub(super) a: &'a [R],
    pub(super) out: &'a mut [R],
}

impl<R, E, Kn, const D: usize, const S: usize> LaneWork<R>
    for Acceleration<'_, Chain<R, E, Kn, D, S>, R>
where
    R: Real,
    E: Element<D, S>,
    Kn: ElementKernel<R, D, S>,
{
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes<R>>(self) {
        let Self {
            chain,
            factor,
            a,
            out,
        } = self;
        chain.groups::<L, 1>(
            [a],
            #[inline(always)]
            |elements, link, [a]| {
                let Some(inertia) = &link.inertia else { return };
                let mut force = [[L::zero(); D]; S];
                for i in 0..S {
                    for j in 0..S {
                        // Sections about their centroid couple positions with no slope across.
                        if !inertia.mass[i][j].is_nothing() {
                            add_times(&mut force[i], factor * inertia.mass[i][j], &a[j]);
                        }
                    }
                }
                L::scatter(force.as_flattened(), out, chain.starts_in(elements));
            },
        );
    }
}

/// Adds the tangents of a chain's elements, with a share of their mass where that is wanted.
pub(super) struct Stiffness<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) u: &'a [R],
    pub(super) mass: Option<R>,
    pub(super) k: &'a mut Matrix<R>,
}

impl<R, E, Kn, const D: usize, const S: usize> KernelWork<R, D, S>
    for Stiffness<'_, Chain<R, E, Kn, D, S>, R>
where
    R: Real,
    E: Element<D, S>,
    Kn: ElementKernel<R, D, S>,
{
    type Output = Result<()>;
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernels: &[K]) -> Result<()> {
        let Self { chain, u, mass, k } = self;
        let mut result = Ok(());
        let mut tangent: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
        chain.groups::<L, 1>(
            [u],
            #[inline(always)]
            |elements, link, [u]| {
                let mut force = [[L::zero(); D]; S];
                of(kernels, elements.start).upper_tangent(u, &mut force, &mut tangent);
                if let (Some(share), Some(inertia)) = (mass, &link.inertia) {
                    for i in 0..S {
                        for j in i..S {
                            let m = L::lift(share * inertia.mass[i][j]);
                            for c in 0..D {
                                tangent[i][c][j][c] += m;
                            }
                        }
                    }
                }
                if !k.stored().is_symmetric() {
                    mirror(&mut tangent);
                }
                if result.is_ok() {
                    result = add_lanes(k, &tangent, chain.starts_in(elements));
                }
            },
        );
        result
    }
}

/// Adds the secant forces of a chain's elements.
pub(super) struct Secant<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) viscosity: R,
    pub(super) ends: [&'a [R]; 2],
    pub(super) q: &'a mut [R],
}

impl<R, E, Kn, const D: usize, const S: usize> KernelWork<R, D, S>
    for Secant<'_, Chain<R, E, Kn, D, S>, R>
where
    R: Real,
    E: Element<D, S>,
    Kn: ElementKernel<R, D, S>,
{
    type Output = ();
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernels: &[K]) {
        let (chain, q) = (self.chain, self.q);
        chain.groups::<L, 2>(
            self.ends,
            #[inline(always)]
            |elements, _, [from, to]| {
                let mut force = [[L::zero(); D]; S];
                of(kernels, elements.start).secant(self.viscosity, from, to, &mut force);
                L::scatter(force.as_flattened(), q, chain.starts_in(elements));
            },
        );
    }
}

/// Adds the derivatives of a chain's secant forces.
pub(super) struct SecantStiffness<'a, C, R> {
    pub(super) chain: &'a C,
    pub(super) viscosity: R,
    pub(super) ends: [&'a [R]; 2],
    pub(super) k: &'a mut Matrix<R>,
}

impl<R, E, Kn, const D: usize, const S: usize> KernelWork<R, D, S>
    for SecantStiffness<'_, Chain<R, E, Kn, D, S>, R>
where
    R: Real,
    E: Element<D, S>,
    Kn: ElementKernel<R, D, S>,
{
    type Output = Result<()>;
    const HEAVY: bool = true;

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernels: &[K]) -> Result<()> {
        let (chain, k) = (self.chain, self.k);
        let mut result = Ok(());
        chain.groups::<L, 2>(
            self.ends,
            #[inline(always)]
            |elements, _, [from, to]| {
                let mut tangent: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
                of(kernels, elements.start).secant_tangent(self.viscosity, from, to, &mut tangent);
                if result.is_ok() {
                    result = add_lanes(k, &tangent, chain.starts_in(elements));
                }
            },
        );
        result
    }
}

/// Adds the tangents of the elements in the lanes that have a start; of those added to a symmetric
/// matrix the upper triangles are read.
#[inline(always)]
fn add_lanes<R: Real, L: Lanes<R>, const D: usize, const S: usize>(
    k: &mut Matrix<R>,
    tangent: &Tangent<L, D, S>,
    start: impl Fn(usize) -> Option<usize>,
) -> Result<()> {
    let block = tangent.as_flattened().as_flattened().as_flattened();
    k.add_blocks(S * D, block, &start)?;
    for lane in 0..L::WIDTH {
        if let Some(offset) = start(lane).filter(|offset| !k.takes_blocks(*offset, S * D)) {
            add_lane::<R, L, D, S>(k, lane, offset, tangent)?;
        }
    }
    Ok(())
}

/// Numbers in the widest registers of the smallest type.
const MOST_LANES: usize = 16;

/// Adds the tangent of the element in one lane.
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
    let upper = k.takes_upper(offset, S * D);
    if symmetric && !upper {
        mirror(&mut own);
    }
    let block = own.as_flattened().as_flattened().as_flattened();
    match upper {
        true => k.add_upper(offset, S * D, block),
        false => k.add_block(offset, S * D, block),
    }
}
