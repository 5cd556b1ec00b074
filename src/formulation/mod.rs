//! Formulations: which strain energy an element carries and where it is sampled. A formulation
//! turns an element, a section and a reference geometry into an [`ElementKernel`]: energy, force
//! and tangent of one element over any number type. Locking remedies live here, as choices of
//! what is sampled where.
//!
//! A formulation of your own is an energy, written over any number type, at one of two levels:
//!
//! - per unit length, as a [`SectionLaw`] of the derivatives of the position that a
//!   [`SampledKernel`] takes at points of the axis ([`Sample`] names them): the shortest, and the
//!   fastest, with strains formed in [`Change`]s that keep their digits on slender beams;
//! - of a whole element, as an [`ElementKernel`] of its nodal displacements, with the derivatives of
//!   the shape functions that [`Sample::of`] gives at any point.
//!
//! Force and tangent follow by dual numbers, and [`verify::formulation`](crate::verify::formulation)
//! tells whether the energy is one of a beam. See `examples/custom_formulation.rs`.

mod basis;
mod cable;
mod change;
mod co_moving;
mod continuum;
mod either;
mod gram;
mod inertia;
mod law;
mod point;
mod products;
mod rank;
mod relative;
mod sampled;
mod structural;

pub use cable::{CableEnergy, CableKernel, CableSection, EulerBernoulli};
pub use change::{Change, changes};
pub use co_moving::{CoMoving, CoMovingKernel, FramedKernel};
pub use continuum::{Across, Continuum, ContinuumKernel, Layer};
pub use either::Either;
pub use gram::GramKernel;
pub use inertia::Inertia;
pub(crate) use law::varied;
pub use law::{SectionLaw, SectionStiffness};
pub use point::PointSection;
pub use products::{Direct, InParts, Products};
pub(crate) use rank::rigid_modes;
pub use sampled::{Sample, SampledKernel};
pub use structural::{BeamStiffness, StructuralKernel, StructuralMechanics, StructuralSection};

use std::fmt::Debug;

use crate::element::{Element, NodalVector};
use crate::error::{Error, Result};
use crate::quadrature::Cubature;
use crate::scalar::{Algebra, LaneWork, Lanes, Real, Scalar};
use crate::section::Section;
use crate::tensor::sum;

/// Tangent of one element: `k[i][c][j][d]` is the derivative of component `c` of the force on
/// nodal vector `i` by component `d` of nodal vector `j`; flattened, a row-major matrix in the
/// order of the coordinates.
pub type Tangent<T, const D: usize, const S: usize> = [[[[T; D]; S]; D]; S];

/// Fills the blocks `k[i][..][j]` with `i > j` of a symmetric tangent from those across the diagonal.
#[inline(always)]
pub(crate) fn mirror<T: Scalar, const D: usize, const S: usize>(k: &mut Tangent<T, D, S>) {
    for i in 0..S {
        for j in 0..i {
            for c in 0..D {
                for d in 0..D {
                    k[i][c][j][d] = k[j][d][i][c];
                }
            }
        }
    }
}

/// Adds a symmetric tangent of which `upper` gives the blocks with `i <= j`.
#[inline(always)]
fn mirrored<T: Scalar, const D: usize, const S: usize>(
    k: &mut Tangent<T, D, S>,
    upper: impl FnOnce(&mut Tangent<T, D, S>),
) {
    let mut whole = [[[[T::zero(); D]; S]; D]; S];
    upper(&mut whole);
    mirror(&mut whole);
    let sums = k.as_flattened_mut().as_flattened_mut();
    for (k, row) in sums.iter_mut().zip(whole.as_flattened().as_flattened()) {
        *k = sum(k, row);
    }
}

/// Reference geometry of one element: nodal vectors `e0` from which strains are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference<R, const D: usize, const S: usize> {
    /// Length of the axis (m) (`l` in eq. 5).
    pub length: R,
    /// Nodal vectors in the reference state, positions (m) relative to the first node.
    pub vectors: [[R; D]; S],
    straight: bool,
}

impl<R: Real, const D: usize, const S: usize> Reference<R, D, S> {
    /// A straight element with an orthonormal material frame: `frame[a]` is the direction of
    /// material axis `a` (0 along the beam) in global components.
    pub fn straight<E: Element<D, S>>(_element: &E, length: R, frame: [[R; D]; D]) -> Self {
        let per_node = E::VECTORS.len();
        let vector = |i: usize| match E::VECTORS[i % per_node] {
            NodalVector::Slope(a) => frame[a],
            NodalVector::Position => {
                let along = R::lit((i / per_node) as f64) / R::lit((E::NODES - 1) as f64);
                frame[0].map(|c| along * length * c)
            }
        };
        Self {
            length,
            vectors: std::array::from_fn(vector),
            straight: true,
        }
    }

    /// An element of any shape, given by its nodal vectors; slopes along the axis have unit
    /// length where the nodal spacing follows the arc length.
    pub fn curved(length: R, vectors: [[R; D]; S]) -> Self {
        Self {
            length,
            vectors,
            straight: false,
        }
    }

    /// Whether the reference gradient is one and the same rotation everywhere.
    pub fn is_straight(&self) -> bool {
        self.straight
    }
}

/// How elements of one kernel go through work together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Together {
    /// One after the other.
    Never,
    /// In the lanes of a register. Worth it only where every function down to the arithmetic is inlined
    /// (`#[inline(always)]`): lanes are compiled for the processor's widest registers inside one
    /// function, and what is called from there crosses over at a price.
    InLanes,
    /// In two registers at once where there are none as wide, as in [`LaneWork::PAIRED`]: worth it only
    /// where sums stay in registers, too. Packs go through registers even where elements do not share a
    /// kernel: it must not derive by dual numbers, whose functions round in other ways there.
    InPairs,
}

/// Work on elements that share a kernel, as [`ElementKernel::dispatch`] runs it.
pub trait KernelWork<R: Real, const D: usize, const S: usize>: Sized {
    /// What comes out.
    type Output;

    /// Whether the work holds far more numbers than registers do, as in [`LaneWork::HEAVY`].
    const HEAVY: bool = false;

    /// Whether every element has a kernel of its own, so that it has no other beside it in lanes.
    #[inline(always)]
    fn is_alone(&self) -> bool {
        false
    }

    /// Does the work in lanes of one type. Must be inlined (`#[inline(always)]`), as in
    /// [`LaneWork::run`].
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernel: &K) -> Self::Output;

    /// Does the work one element at a time: compiled once, wherever it is asked for.
    #[inline(never)]
    fn run_singly<K: ElementKernel<R, D, S>>(self, kernel: &K) -> Self::Output {
        self.run::<R, K>(kernel)
    }

    /// Does the work as the kernel asks for, in the lanes that suit the processor best. Always inlined: handed
    /// on, work is copied in larger pieces than it was written in, and processors wait for that.
    #[inline(always)]
    fn run_together<K: ElementKernel<R, D, S>>(self, kernel: &K) -> Self::Output {
        // Constants of blocks, so that what is not asked for is not compiled.
        if const { matches!(K::TOGETHER, Together::Never) } {
            return self.run_singly(kernel);
        }
        if !self.is_alone() {
            return R::dispatch(OfKernel { work: self, kernel });
        }
        match const { matches!(K::TOGETHER, Together::InPairs) } {
            true => R::dispatch_singly(OfKernel { work: self, kernel }),
            // Lanes have dual numbers of their own, which round in other ways.
            false => self.run_singly(kernel),
        }
    }
}

/// Work with the kernel that it is done with.
struct OfKernel<'a, W, K, const D: usize, const S: usize> {
    work: W,
    kernel: &'a K,
}

impl<R, W, K, const D: usize, const S: usize> LaneWork<R> for OfKernel<'_, W, K, D, S>
where
    R: Real,
    W: KernelWork<R, D, S>,
    K: ElementKernel<R, D, S>,
{
    type Output = W::Output;
    const HEAVY: bool = W::HEAVY;
    const PAIRED: bool = matches!(K::TOGETHER, Together::InPairs);

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> W::Output {
        self.work.run::<L, K>(self.kernel)
    }

    #[inline]
    fn run_singly(self) -> W::Output {
        self.work.run_singly(self.kernel)
    }
}

/// Energy, force and tangent of one element with nodal displacements `u` (current minus reference
/// nodal vectors). Force and tangent are *added* to what they are given.
///
/// A kernel given by its energy alone gets both by dual numbers, one nodal vector at a time.
pub trait ElementKernel<R: Real, const D: usize, const S: usize>:
    Debug + Send + Sync + Sized + 'static
{
    /// How elements that share this kernel go through work together, by default one after the other; of
    /// no meaning where [`dispatch`](Self::dispatch) hands work on.
    const TOGETHER: Together = Together::Never;

    /// Whether no element ever has a kernel of this type: where it is one of several, nothing of it is
    /// compiled. That of a material which is never sampled, or never integrated once, see
    /// [`Material::CONSTANT`](crate::material::Material::CONSTANT).
    const ABSENT: bool = false;

    /// Whether a formulation with kernels of this type has a
    /// [`turning_kernel`](Formulation::turning_kernel) for every element, so that none is put in a frame
    /// and nothing that would is compiled.
    const TURNS: bool = false;

    /// Runs work on elements that share this kernel. A kernel that is one of several hands the work to
    /// the one it is.
    #[inline(always)]
    fn dispatch<W: KernelWork<R, D, S>>(&self, work: W) -> W::Output {
        work.run_together(self)
    }

    /// Strain energy (J) (eq. 10).
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; S]) -> T;

    /// Adds the elastic force `Q_s = dU/de` (eq. 14).
    fn force<T: Algebra<R>>(&self, u: &[[T; D]; S], q: &mut [[T; D]; S]) {
        for i in 0..S {
            let energy = self.energy(&varied(u, i));
            for c in 0..D {
                q[i][c] += T::derivative::<D>(&energy, c);
            }
        }
    }

    /// Adds the elastic force and the tangent stiffness `dQ_s/de`.
    fn tangent<T: Algebra<R>>(
        &self,
        u: &[[T; D]; S],
        q: &mut [[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        for j in 0..S {
            let mut dual = [[T::zero().constant::<D>(); D]; S];
            self.force(&varied(u, j), &mut dual);
            for c in 0..D {
                q[j][c] += T::real_part::<D>(&dual[j][c]);
                for i in 0..S {
                    for d in 0..D {
                        k[i][c][j][d] += T::derivative::<D>(&dual[i][c], d);
                    }
                }
            }
        }
    }

    /// The tangent alone, which overwrites the blocks `k[i][..][j]` with `i <= j`; what becomes of the
    /// others does not matter. This is what assembly asks for; by default all of the tangent.
    #[inline(always)]
    fn upper_tangent<T: Algebra<R>>(&self, u: &[[T; D]; S], k: &mut Tangent<T, D, S>) {
        *k = [[[[T::zero(); D]; S]; D]; S];
        self.tangent(u, &mut [[T::zero(); D]; S], k);
    }

    /// Whether [`secant`](Self::secant) is made of strains that rotations do not change, so that
    /// it keeps angular momentum and may be viscous; by default it is not.
    fn has_strain(&self) -> bool {
        false
    }

    /// Adds the secant force of a step, whose work on the straight way `to - from` is the change
    /// of strain energy; by default the mean of the force by two Gauss points, exact for energies
    /// up to the fourth degree. With a `viscosity`, and only for kernels that have strain, adds
    /// `B^T C (E(to) - E(from))` times it, `B` the derivative of the strain half way: a Kelvin-Voigt
    /// stress with this share of the step as its retardation time.
    fn secant<T: Algebra<R>>(
        &self,
        _viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        q: &mut [[T; D]; S],
    ) {
        let mean = law::path_mean(from, to, |u| {
            let mut force = [[T::zero(); D]; S];
            self.force(u, &mut force);
            force
        });
        for i in 0..S {
            q[i] = sum(&q[i], &mean[i]);
        }
    }

    /// The derivative of the secant force by `to`, which overwrites all of `k`: it is not symmetric.
    fn secant_tangent<T: Algebra<R>>(
        &self,
        viscosity: R,
        from: &[[T; D]; S],
        to: &[[T; D]; S],
        k: &mut Tangent<T, D, S>,
    ) {
        let from = from.map(|vector| vector.map(|x| x.constant::<D>()));
        for j in 0..S {
            let mut dual = [[T::zero().constant::<D>(); D]; S];
            self.secant(viscosity, &from, &varied(to, j), &mut dual);
            for i in 0..S {
                for c in 0..D {
                    for d in 0..D {
                        k[i][c][j][d] = T::derivative::<D>(&dual[i][c], d);
                    }
                }
            }
        }
    }
}

/// What gives an element of family `E` its elasticity.
pub trait Formulation<R: Real, E: Element<D, S>, const D: usize, const S: usize>:
    Debug + Send + Sync
{
    /// The kernel this formulation makes.
    type Kernel: ElementKernel<R, D, S>;

    /// The kernel of one element of this reference geometry.
    ///
    /// # Errors
    /// Whatever is wrong with the sampling asked for.
    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel>;

    /// A kernel that keeps its digits however far an element turns, where the formulation has one of
    /// its own: what [`CoMoving`] takes instead of a frame. None by default, which [`CoMoving`] refuses of
    /// kernels that say they [turn](ElementKernel::TURNS): pass on what is asked of a formulation inside.
    ///
    /// # Errors
    /// Those of [`kernel`](Self::kernel).
    fn turning_kernel(
        &self,
        _element: &E,
        _reference: &Reference<R, D, S>,
        _section: &dyn Section<R>,
    ) -> Result<Option<Self::Kernel>> {
        Ok(None)
    }

    /// The same with this many axial points and this section degree, where it has such orders:
    /// what [`check`](Self::check) looks for orders that suffice with. None by default.
    fn resampled(&self, _axial: usize, _section_degree: usize) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Refuses a sampling that leaves zero-energy modes beyond the rigid ones, by the rank of the
    /// tangent on a straight and stocky element, where slenderness does not blur it. A beam asks
    /// once, whatever its shape and the number of its elements.
    ///
    /// # Errors
    /// [`Error::ZeroEnergyModes`] with the orders that suffice, and those of
    /// [`kernel`](Self::kernel).
    fn check(&self, element: &E, section: &dyn Section<R>) -> Result<()>
    where
        Self: Sized,
    {
        rank::check_rank(self, element, rank::stocky_length(section)?, section)
    }
}

impl<R, E, F, const D: usize, const S: usize> Formulation<R, E, D, S> for &F
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    type Kernel = F::Kernel;

    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        (**self).kernel(element, reference, section)
    }

    fn turning_kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Option<Self::Kernel>> {
        (**self).turning_kernel(element, reference, section)
    }

    fn check(&self, element: &E, section: &dyn Section<R>) -> Result<()> {
        (**self).check(element, section)
    }
}

/// A rule in the cross coordinates of a `D`-dimensional scene: points `X = (0, y[, z])` (m) and
/// weights (m^2). In the plane the section is projected (weights carry the width).
pub(crate) fn section_points<R: Real, const D: usize>(
    section: &dyn Section<R>,
    degree: usize,
) -> Result<Vec<([R; D], R)>> {
    fn embed<R: Real, const C: usize, const D: usize>(rule: &Cubature<R, C>) -> Vec<([R; D], R)> {
        let at = |y: [R; C]| std::array::from_fn(|a| if a == 0 { R::zero() } else { y[a - 1] });
        rule.iter().map(|(y, w)| (at(y), w)).collect()
    }
    match D {
        2 => Ok(embed(&section.planar_rule(degree)?.reaching(degree)?)),
        3 => Ok(embed(&section.rule(degree)?.reaching(degree)?)),
        _ => Err(Error::Unsupported {
            what: format!("a scene in {D} dimensions"),
            remedy: "use D = 2 (plane) or D = 3 (space)",
        }),
    }
}
