//! What keeps the digits of strains after large rotations. Displacements from a reference that has
//! turned away are as large as the element, and a strain formed from them has lost what displacements
//! were to keep. In the co-moving frame they are measured from a reference that turns with the
//! element, by a rotation that costs no digits; a formulation may have a cheaper way of its own.

use std::marker::PhantomData;

use super::either::Either;
use super::products::magnitude;
use super::relative::Positions;
use super::{ElementKernel, Formulation, Reference, Tangent};
use crate::element::{Element, NodalVector};
use crate::error::{Error, Result};
use crate::scalar::{Algebra, Field, Real, Scalar};
use crate::section::Section;
use crate::tensor::{add_scaled, cross, dot};

/// A formulation that keeps its digits however far elements turn.
///
/// Strain energies do not feel rotations, `U(e) = U(Q^T e)` whatever the rotation `Q`. So `Q` is
/// taken from the state, near the rotation of the element, and then held: the force is `Q q'` and
/// the tangent `Q k' Q^T`, with `q'` and `k'` of the formulation inside at the displacements
/// `Q^T (e - r_1) - e_0`, with `r_1` the position of the first node. These are as small as the
/// element is little bent, and so is the error of its strains.
///
/// Formulations with a kernel that keeps digits by itself ([`Formulation::turning_kernel`]) wear no
/// frame, and one that says its kernels turn must have it. A continuum of a material that is
/// [`Material::CONSTANT`](crate::material::Material::CONSTANT) has one ([`InParts`](super::InParts)): it
/// costs a tenth of the force of a chain of spatial elements in single precision, a twentieth in double
/// precision, and a sixth of their tangent. The frame costs a fifth of the force of a spatial element sampled at
/// 35 points.
///
/// # When to use it
/// Where forces of slender or far turned beams must be more exact than the type's arithmetic gives
/// them, in single precision above all. The error of the transverse force in arithmetic, over the
/// load, eight elements bent by 0.46 rad, `f32` (`cargo test --features double-double --test
/// beams double_double::slender -- --nocapture`), framed at section points:
///
/// | R/L | turned by | textbook | displacements | framed | co-moving continuum |
/// |---|---|---|---|---|---|
/// | 1e-2 | 0 | 5.9e-3 | 1.2e-3 | 8.7e-5 | 7.0e-6 |
/// | 1e-3 | 0 | 6.1e-1 | 1.2e-1 | 1.0e-2 | 1.1e-3 |
/// | 1e-2 | 2 rad | 4.8e-3 | 2.7e-3 | 3.5e-5 | 1.0e-5 |
/// | 1e-3 | 2 rad | 4.7e-1 | 2.7e-1 | 3.6e-3 | 7.9e-4 |
///
/// It cannot give back digits that the state does not hold. Displacements of the size of the beam
/// are stored with an error of `eps L`, which in an element of length `l` is a strain of
/// `eps L / l` whatever the arithmetic: a force of 1e-2 in the first row of the table, of 1 in the
/// second. A simulation whose state is stored in the same type therefore gains nothing once that
/// is the floor: the tip of a cantilever of `R/L = 1e-2` in `f32`, rolled up to half a circle, is
/// off by 3e-5 of its length with the frame and by 6e-5 without, both of them at the rounding floor
/// of Newton's method; that of a swinging pendulum after 2 s by 4e-6 m either way. In double
/// precision all this matters below `R/L = 1e-4` only.
///
/// An energy that does feel rotations (an element on a foundation, say) must not wear it. The frame
/// follows the chord and the mean of the first cross slopes; a state in which those vanish or are
/// parallel has none, and its energy is not a number, which solvers refuse.
///
/// # How digits are kept
/// The rotation must be orthogonal, and the product must not round, far below the type's `eps`.
/// Write `e = e_hi + e_lo` with `e_hi` on a grid of half the digits. Let `Q_s` be an approximate
/// rotation rounded to such a grid, so that its defect `D = Q_s^T Q_s - I` is exact, and
/// `Q = Q_s (I + D)^(-1/2) = Q_s + Q_l`, with `Q_l` small and from a short series. Then
///
/// `Q^T e - e_0 = (Q_s^T e_hi - e_0hi) + (Q_l^T e_hi + Q^T e_lo - e_0lo)`,
///
/// the first bracket exact, the second small: the error is about `eps^(3/2)`. Grid products stay
/// exact up to stretches of 4; beyond, the error grows to `eps`.
///
/// ```
/// use ancf::prelude::*;
///
/// let rubber = SaintVenantKirchhoff::<f32, 3>::isotropic(2.0e7, 0.0)?;
/// let rod = Beam::new(FullyParameterised, Disk::new(1e-3)?, CoMoving(Continuum::full(rubber)));
/// let mut scene = Scene::<f32, 3>::new();
/// scene.add(rod.straight([0.0; 3], [1.0, 0.0, 0.0], 10))?;
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoMoving<F>(pub F);

impl<R, E, F, const D: usize, const S: usize> Formulation<R, E, D, S> for CoMoving<F>
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    type Kernel = CoMovingKernel<R, E, F::Kernel, D, S>;

    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        if let Some(kernel) = self.0.turning_kernel(element, reference, section)? {
            return Ok(Either::First(kernel));
        }
        if F::Kernel::TURNS {
            return Err(Error::Unsupported {
                what: format!("{self:?}, whose kernels turn, without a turning_kernel"),
                remedy: "give Formulation::turning_kernel, by that of the formulation whose kernels these are",
            });
        }
        let kernel = self.0.kernel(element, reference, section)?;
        Ok(Either::Second(FramedKernel::new(kernel, reference)))
    }

    /// Its own: no frame is put around another.
    fn turning_kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Option<Self::Kernel>> {
        self.kernel(element, reference, section).map(Some)
    }

    fn resampled(&self, axial: usize, section_degree: usize) -> Option<Self> {
        self.0.resampled(axial, section_degree).map(Self)
    }

    fn check(&self, element: &E, section: &dyn Section<R>) -> Result<()> {
        self.0.check(element, section)
    }
}

/// Kernel of a [`CoMoving`] formulation: one that needs no frame, or one in its frame.
pub type CoMovingKernel<R, E, K, const D: usize, const S: usize> =
    Either<K, FramedKernel<R, E, K, D, S>>;

/// A kernel in its co-moving frame.
#[derive(Debug, Clone)]
pub struct FramedKernel<R, E, K, const D: usize, const S: usize> {
    kernel: K,
    element: PhantomData<E>,
    positions: Positions<S>,
    /// Reference vectors, positions relative to the first: their parts on the grid and the rest.
    coarse: [[R; D]; S],
    fine: [[R; D]; S],
    /// What rounds to the grid of each vector by being added and taken away.
    grid: [R; S],
    /// The same for the entries of a rotation.
    unit: R,
    /// Frame of the reference.
    frame: [[R; D]; D],
}

/// A rotation `sharp + rest`, by columns of the frame it starts from; `sharp` is on the grid.
struct Rotation<T, const D: usize> {
    sharp: [[T; D]; D],
    rest: [[T; D]; D],
    whole: [[T; D]; D],
}

impl<R, E, K, const D: usize, const S: usize> FramedKernel<R, E, K, D, S>
where
    R: Real,
    E: Element<D, S>,
    K: ElementKernel<R, D, S>,
{
    fn new(kernel: K, reference: &Reference<R, D, S>) -> Self {
        let digits = -R::EPSILON.log2().round() as i32;
        // Products on the grid and sums of them up to 4 fit in the digits of the type.
        let unit = R::lit(1.5 * 2.0_f64.powi(digits - (digits - 1) / 2));
        let size = |i: usize| match E::VECTORS[i % E::VECTORS.len()] {
            NodalVector::Position => magnitude(reference.length),
            NodalVector::Slope(_) => R::one(),
        };
        let mut new = Self {
            kernel,
            element: PhantomData,
            positions: Positions::of::<E, D>(),
            coarse: [[R::zero(); D]; S],
            fine: [[R::zero(); D]; S],
            grid: std::array::from_fn(|i| unit * size(i)),
            unit,
            frame: [[R::zero(); D]; D],
        };
        (new.coarse, new.fine) = new.split(&reference.vectors);
        new.frame = new.frame(&new.coarse, &new.fine);
        new
    }

    /// Parts on the grid and the rest, positions relative to the first: split before their
    /// difference is taken, so that it does not round.
    #[inline(always)]
    fn split<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> ([[T; D]; S], [[T; D]; S]) {
        let (mut coarse, mut fine) = (*u, *u);
        for i in 0..S {
            let grid = T::lift(self.grid[i]);
            for c in 0..D {
                let rounded = (u[i][c] + grid) - grid;
                coarse[i][c] = rounded;
                fine[i][c] -= rounded;
            }
        }
        self.positions.make_relative(&mut coarse);
        self.positions.make_relative(&mut fine);
        (coarse, fine)
    }

    /// An orthonormal frame along the chord, its second axis towards the cross slopes.
    #[inline(always)]
    fn frame<T: Algebra<R>>(&self, coarse: &[[T; D]; S], fine: &[[T; D]; S]) -> [[T; D]; D] {
        let (mut chord, mut across) = ([T::zero(); 3], [T::zero(); 3]);
        let per_node = E::VECTORS.len();
        let first = Slope::<E, D, S>::PLACE;
        let end = self.positions.split().and_then(|(_, mut p)| p.next_back());
        for c in 0..D {
            if let Some(end) = end {
                let size = self.unit / self.grid[end];
                chord[c] = (coarse[end][c] + fine[end][c]).frozen().times(size);
            }
            if let Some(first) = first {
                for i in (first..S).step_by(per_node) {
                    across[c] += (coarse[i][c] + fine[i][c]).frozen();
                }
            }
        }
        let along = normalised(chord);
        if first.is_none() {
            across = beside(&along);
        }
        let normal = match D {
            2 => [T::zero(), T::zero(), T::one()],
            _ => normalised(cross(&along, &across)),
        };
        let frame = [along, cross(&normal, &along), normal];
        std::array::from_fn(|a| std::array::from_fn(|c| frame[a][c]))
    }

    /// The rotation of a frame from the reference's.
    #[inline(always)]
    fn rotation<T: Algebra<R>>(&self, frame: &[[T; D]; D]) -> Rotation<T, D> {
        let unit = T::lift(self.unit);
        let mut sharp = [[T::zero(); D]; D];
        for k in 0..D {
            for a in 0..D {
                add_scaled(&mut sharp[k], T::lift(self.frame[a][k]), &frame[a]);
            }
            sharp[k] = sharp[k].map(|q| (q + unit) - unit);
        }
        let defect: [[T; D]; D] = std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let unit = if a == b { T::one() } else { T::zero() };
                dot(&sharp[a], &sharp[b]) - unit
            })
        });
        // (1 + D)^(-1/2) - 1 = -D (1/2 - D (3/8 - 5/16 D))
        let constant_minus = |constant: f64, m: [[T; D]; D]| {
            let mut difference = m.map(|row| row.map(|d| -d));
            for a in 0..D {
                difference[a][a] += T::lit(constant);
            }
            difference
        };
        let series = defect.map(|row| row.map(|d| d * T::lit(0.3125)));
        let series = constant_minus(0.375, series);
        let series = constant_minus(0.5, product(&defect, &series));
        let series = constant_minus(0.0, product(&defect, &series));
        let rest = product(&series, &sharp);
        let whole = std::array::from_fn(|k| std::array::from_fn(|c| sharp[k][c] + rest[k][c]));
        Rotation { sharp, rest, whole }
    }

    /// The rotation of a state, and its displacements in the frame that it turns.
    #[inline(always)]
    fn local<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> (Rotation<T, D>, [[T; D]; S]) {
        let parts = self.parts(u);
        let rotation = self.rotation(&self.frame(&parts.0, &parts.1));
        let local = self.within(&rotation, &parts);
        (rotation, local)
    }

    /// Nodal vectors of a state, on the grid and the rest.
    #[inline(always)]
    fn parts<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> ([[T; D]; S], [[T; D]; S]) {
        let (mut coarse, mut fine) = self.split(u);
        for i in 0..S {
            for c in 0..D {
                coarse[i][c] += T::lift(self.coarse[i][c]);
                fine[i][c] += T::lift(self.fine[i][c]);
            }
        }
        (coarse, fine)
    }

    /// Displacements in a frame turned by a rotation.
    #[inline(always)]
    fn within<T: Algebra<R>>(
        &self,
        rotation: &Rotation<T, D>,
        (coarse, fine): &([[T; D]; S], [[T; D]; S]),
    ) -> [[T; D]; S] {
        let mut local = [[T::zero(); D]; S];
        for i in 0..S {
            for k in 0..D {
                let exact = dot(&rotation.sharp[k], &coarse[i]) - T::lift(self.coarse[i][k]);
                let small = dot(&rotation.rest[k], &coarse[i])
                    + (dot(&rotation.whole[k], &fine[i]) - T::lift(self.fine[i][k]));
                local[i][k] = exact + small;
            }
        }
        if let Some((first, _)) = self.positions.split() {
            local[first] = [T::zero(); D];
        }
        local
    }

    /// Adds the force `Q q'`.
    #[inline(always)]
    fn add_force<T: Algebra<R>>(
        &self,
        rotation: &Rotation<T, D>,
        local: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        let mut turned = [[T::zero(); D]; S];
        for i in 0..S {
            for k in 0..D {
                add_scaled(&mut turned[i], local[i][k], &rotation.whole[k]);
            }
        }
        if let Some((first, _)) = self.positions.split() {
            turned[first] = [T::zero(); D];
        }
        self.positions.add_force(&turned, q);
    }
}

impl<R, E, K, const D: usize, const S: usize> ElementKernel<R, D, S> for FramedKernel<R, E, K, D, S>
where
    R: Real,
    E: Element<D, S>,
    K: ElementKernel<R, D, S>,
{
    const ABSENT: bool = K::TURNS;

    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T {
        self.kernel.energy(&self.local(u).1)
    }

    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        let (rotation, u) = self.local(u);
        let mut force = [[T::zero(); D]; S];
        self.kernel.force(&u, &mut force);
        self.add_force(&rotation, &force, q);
    }

    fn has_strain(&self) -> bool {
        self.kernel.has_strain()
    }

    /// Both ends of the step in the frame of the last.
    fn secant<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        let (rotation, to) = self.local(to);
        let from = self.within(&rotation, &self.parts(from));
        let mut force = [[T::zero(); D]; S];
        self.kernel.secant(viscosity, &from, &to, &mut force);
        self.add_force(&rotation, &force, q);
    }

    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        let (rotation, u) = self.local(u);
        let mut force = [[T::zero(); D]; S];
        let mut tangent: Tangent<T, D, S> = [[[[T::zero(); D]; S]; D]; S];
        self.kernel.tangent(&u, &mut force, &mut tangent);
        self.add_force(&rotation, &force, q);
        let turn = &rotation.whole;
        let first = self.positions.split().map(|(first, _)| first);
        let mut turned: Tangent<T, D, S> = [[[[T::zero(); D]; S]; D]; S];
        for i in (0..S).filter(|i| Some(*i) != first) {
            // The second derivatives of an energy are symmetric.
            for j in (i..S).filter(|j| Some(*j) != first) {
                let mut half = [[T::zero(); D]; D];
                for a in 0..D {
                    for b in 0..D {
                        add_scaled(&mut half[a], tangent[i][a][j][b], &turn[b]);
                    }
                }
                let mut block = [[T::zero(); D]; D];
                for a in 0..D {
                    for c in 0..D {
                        add_scaled(&mut block[c], turn[a][c], &half[a]);
                    }
                }
                for c in 0..D {
                    turned[i][c][j] = block[c];
                    for d in 0..D {
                        turned[j][d][i][c] = block[c][d];
                    }
                }
            }
        }
        self.positions.add_tangent(turned, k);
    }
}

/// Place of the first cross slope among the vectors of a node; none for a cable.
struct Slope<E, const D: usize, const S: usize>(PhantomData<E>);

impl<E: Element<D, S>, const D: usize, const S: usize> Slope<E, D, S> {
    const PLACE: Option<usize> = {
        let mut place = None;
        let mut i = 0;
        while i < E::VECTORS.len() {
            if matches!(E::VECTORS[i], NodalVector::Slope(1)) {
                place = Some(i);
            }
            i += 1;
        }
        place
    };
}

#[inline(always)]
fn normalised<T: Field>(v: [T; 3]) -> [T; 3] {
    let per_length = dot(&v, &v).sqrt().recip();
    v.map(|c| c * per_length)
}

/// A vector that is nowhere parallel to the unit vector `a`, found without comparing numbers, for
/// lanes have no order: the second basis vector of Duff et al. (2017), unscaled.
#[inline(always)]
fn beside<T: Field>(a: &[T; 3]) -> [T; 3] {
    let [x, y, z] = *a;
    // The shift decides for a vector in the plane z = 0.
    let shifted = z + T::lit(1e-12);
    let sign = shifted / (shifted * shifted).sqrt();
    [-x * y, T::one() + sign * z - y * y, -y * (sign + z)]
}

#[inline(always)]
fn product<T: Scalar, const D: usize>(a: &[[T; D]; D], b: &[[T; D]; D]) -> [[T; D]; D] {
    let mut product = [[T::zero(); D]; D];
    for i in 0..D {
        for k in 0..D {
            add_scaled(&mut product[i], a[i][k], &b[k]);
        }
    }
    product
}
