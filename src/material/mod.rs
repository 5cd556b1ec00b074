//! Materials: strain energy densities of the Green-Lagrange strain. One file per law. A material
//! knows neither element nor section; a formulation decides where it is sampled.

mod saint_venant_kirchhoff;

pub use saint_venant_kirchhoff::SaintVenantKirchhoff;

use std::fmt::Debug;

use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, add_times, array, between, dot, gauss_pair};

/// A symmetric tensor or the columns of a gradient: `D x D` numbers.
pub type Tensor<T, const D: usize> = [[T; D]; D];

/// The blocks `A[a][b]` (each `D x D`) that couple changes of the columns `a` and `b` of the
/// deformation gradient. Only `a <= b` is used; the others follow by symmetry.
pub type Blocks<T, const D: usize> = [[Tensor<T, D>; D]; D];

/// Constant moduli (Pa) of a law in which normal strains couple among themselves only and every
/// shear strain stands alone: `S_aa = sum_b normal[a][b] E_bb` and `S_ab = 2 shear[a][b] E_ab`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli<R, const D: usize> {
    /// Symmetric matrix between normal strains and normal stresses.
    pub normal: Tensor<R, D>,
    /// Shear moduli, one for each pair of axes; symmetric, the diagonal is not used.
    pub shear: Tensor<R, D>,
}

impl<R: Real, const D: usize> Moduli<R, D> {
    /// Second Piola-Kirchhoff stress (Pa) at a strain.
    #[inline(always)]
    pub fn stress<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Tensor<T, D> {
        let two = R::lit(2.0);
        let mut stress = [[T::zero(); D]; D];
        for a in 0..D {
            for b in 0..D {
                stress[a][a] += strain[b][b].times(self.normal[a][b]);
            }
            for b in a + 1..D {
                stress[a][b] = strain[a][b].times(two * self.shear[a][b]);
                stress[b][a] = stress[a][b];
            }
        }
        stress
    }
}

/// A hyperelastic law over the Green-Lagrange strain `E` in `D` dimensions, with parameters in
/// `R`. Its strain energy density is enough: stress and elasticity follow by dual numbers. A law
/// that knows them in closed form overrides them, which is faster.
///
/// All tensors are `D x D` component arrays in the material frame (axis first). Energies are
/// densities per reference volume (J/m^3), stresses second Piola-Kirchhoff (Pa).
pub trait Material<R: Real, const D: usize>: Clone + Debug + Send + Sync + 'static {
    /// Whether chains of elements take this material in SIMD lanes where they sample it, as in
    /// [`SectionLaw::LANES`](crate::formulation::SectionLaw::LANES). By default they do not.
    const LANES: bool = false;

    /// Whether all materials of this type have a [constant elasticity](Self::constant_elasticity): elements
    /// are then integrated once and for all, and no program compiles what would sample them. By default
    /// they are sampled at every evaluation. A beam of a material that says so and has none is refused.
    const CONSTANT: bool = false;

    /// Strain energy density `psi(E)` (J/m^3) (eq. 10 of Orzechowski 2012), as a function of all
    /// `D x D` components of the symmetric strain.
    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T;

    /// Second Piola-Kirchhoff stress `S = d psi / dE` (Pa) (eq. 11).
    #[inline(always)]
    fn stress<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Tensor<T, D> {
        match D {
            2 => derived_stress::<R, T, Self, D, 3>(self, strain),
            _ => derived_stress::<R, T, Self, D, 6>(self, strain),
        }
    }

    /// Stress whose work over the straight way from the strain `from` to `to` is the change of
    /// energy, `int_0^1 S ds`: by two Gauss points, exact for energies up to the fourth degree.
    #[inline(always)]
    fn secant<T: Algebra<R>>(&self, from: &Tensor<T, D>, to: &Tensor<T, D>) -> Tensor<T, D> {
        let mut mean = [[T::zero(); D]; D];
        for share in gauss_pair::<R>() {
            let stress = self.stress(&between(from, to, share));
            for a in 0..D {
                add_times(&mut mean[a], R::lit(0.5), &stress[a]);
            }
        }
        mean
    }

    /// Derivative of the [`secant`](Self::secant) stress by the strain `to`, as
    /// [`elasticity`](Self::elasticity) is that of the stress. By default that of the default secant, from
    /// the elasticity at its Gauss points; a law with a secant of its own gives its derivative, too.
    #[inline(always)]
    fn secant_elasticity<T: Algebra<R>>(
        &self,
        from: &Tensor<T, D>,
        to: &Tensor<T, D>,
    ) -> Blocks<T, D> {
        let mut mean = [[[[T::zero(); D]; D]; D]; D];
        for share in gauss_pair::<R>() {
            let there = self.elasticity(&between(from, to, share));
            let rows = there.as_flattened().as_flattened();
            for (mean, there) in mean
                .as_flattened_mut()
                .as_flattened_mut()
                .iter_mut()
                .zip(rows)
            {
                add_times(mean, R::lit(0.5) * share, there);
            }
        }
        mean
    }

    /// Elasticity `C[a][e][b][f] = dS[a][e] / dE[b][f]` (Pa), with both minor symmetries.
    #[inline(always)]
    fn elasticity<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Blocks<T, D> {
        match D {
            2 => derived_elasticity::<R, T, Self, D, 3>(self, strain),
            _ => derived_elasticity::<R, T, Self, D, 6>(self, strain),
        }
    }

    /// The moduli of a law whose elasticity is the same at every strain; none by default. Elements of
    /// a material that is [`CONSTANT`](Self::CONSTANT) are integrated once and for all with them, straight or
    /// curved, and its energy and stress are not asked for again. [`verify::material`](crate::verify::material) checks that
    /// they agree.
    #[inline]
    fn constant_elasticity(&self) -> Option<Moduli<R, D>> {
        None
    }

    /// The constitutive part of the tangent of the first Piola-Kirchhoff stress,
    /// `A[a][b] = sum_ef C[a][e][b][f] c_e c_f^T` with `c` the columns of the deformation
    /// gradient; filled for `a <= b`.
    #[inline(always)]
    fn stiffness<T: Algebra<R>>(&self, strain: &Tensor<T, D>, c: &Tensor<T, D>) -> Blocks<T, D> {
        let elasticity = self.elasticity(strain);
        let mut blocks = [[[[T::zero(); D]; D]; D]; D];
        for a in 0..D {
            for b in a..D {
                for e in 0..D {
                    let mut column = [T::zero(); D];
                    for f in 0..D {
                        add_scaled(&mut column, elasticity[a][e][b][f], &c[f]);
                    }
                    for i in 0..D {
                        add_scaled(&mut blocks[a][b][i], c[e][i], &column);
                    }
                }
            }
        }
        blocks
    }
}

/// The pairs of axes of a symmetric tensor, each once.
fn pairs<const D: usize>() -> impl Iterator<Item = (usize, (usize, usize))> {
    let pairs = (0..D).flat_map(|a| (a..D).map(move |b| (a, b)));
    pairs.enumerate()
}

/// The strain with one derivative for each of its `N = D (D + 1) / 2` independent components.
#[inline(always)]
fn varied<R, T: Algebra<R>, const D: usize, const N: usize>(
    strain: &Tensor<T, D>,
) -> Tensor<T::Dual<N>, D> {
    let mut dual: Tensor<T::Dual<N>, D> =
        std::array::from_fn(|a| std::array::from_fn(|b| strain[a][b].constant()));
    for (k, (a, b)) in pairs::<D>() {
        dual[a][b] = strain[a][b].variable(k);
        dual[b][a] = strain[b][a].variable(k);
    }
    dual
}

/// What one derivative of a symmetric pair is worth for each of its two components.
#[inline(always)]
fn share<T: Algebra<R>, R: Real>(a: usize, b: usize, derivative: T) -> T {
    if a == b {
        derivative
    } else {
        derivative.times(R::lit(0.5))
    }
}

#[inline(always)]
fn derived_stress<R, T, M, const D: usize, const N: usize>(
    material: &M,
    strain: &Tensor<T, D>,
) -> Tensor<T, D>
where
    R: Real,
    T: Algebra<R>,
    M: Material<R, D>,
{
    let energy = material.energy(&varied::<R, T, D, N>(strain));
    let mut stress = [[T::zero(); D]; D];
    for (k, (a, b)) in pairs::<D>() {
        stress[a][b] = share(a, b, T::derivative::<N>(&energy, k));
        stress[b][a] = stress[a][b];
    }
    stress
}

#[inline(always)]
fn derived_elasticity<R, T, M, const D: usize, const N: usize>(
    material: &M,
    strain: &Tensor<T, D>,
) -> Blocks<T, D>
where
    R: Real,
    T: Algebra<R>,
    M: Material<R, D>,
{
    by_strain(&material.stress(&varied::<R, T, D, N>(strain)))
}

/// Derivatives of a stress by the strain whose variations it carries.
#[inline(always)]
fn by_strain<R: Real, T: Algebra<R>, const D: usize, const N: usize>(
    stress: &Tensor<T::Dual<N>, D>,
) -> Blocks<T, D> {
    let mut elasticity = [[[[T::zero(); D]; D]; D]; D];
    for (k, (b, f)) in pairs::<D>() {
        for a in 0..D {
            for e in 0..D {
                let value = share(b, f, T::derivative::<N>(&stress[a][e], k));
                elasticity[a][e][b][f] = value;
                elasticity[a][e][f][b] = value;
            }
        }
    }
    elasticity
}

/// A material whose energy splits into a part free of Poisson coupling and the rest, so that the
/// two can be sampled in different places (selective reduced integration).
///
/// A law of one's own splits by the linear elasticity it has at rest: the uncoupled part is the law
/// less `D - D0` of small strains, `psi(E) - (E : (D - D0) : E) / 2`, the coupled part that quadratic
/// term, so that both add up to the law.
///
/// This is a split for small strains. The coupled part is indefinite by nature and no material of its
/// own; what is left, the uncoupled part, must be one, and is sampled alone off the axis: where the law
/// leaves its quadratic form, the difference of the two is not bounded below. The nearer Poisson's ratio
/// is to 1/2, the sooner: for a Yeoh law at 0.32 the split bends a cantilever to a third of a circle, at
/// 0.48 its tip is 6 % off at a strain of 2 %, at 0.496 statics ends at a strain of 0.65 %. Ask
/// [`verify::material`](crate::verify::material) of the uncoupled part at the strains meant; its
/// smallest modulus there must be positive. Nearly incompressible laws at larger strains want a
/// volumetric energy of their own choosing on the axis ([`Continuum::layered`](crate::formulation::Continuum::layered)):
/// the isochoric part over the section, the volumetric one at the centroid.
#[diagnostic::on_unimplemented(
    message = "`{Self}` does not say how it splits into a part without Poisson coupling and the rest",
    note = "implement `PoissonSplit` for it, or state the parts yourself with `Continuum::layered`"
)]
pub trait PoissonSplit: Sized {
    /// The part in which normal strains do not couple: `D0 = diag(E, .., G, ..)`.
    fn uncoupled(&self) -> Self;
    /// What [`uncoupled`](Self::uncoupled) leaves: `Dnu = D - D0`.
    fn coupled(&self) -> Self;
}

/// Green-Lagrange strain `(J^T J - J0^T J0) / 2` from the columns of the reference gradient `J0`
/// and of the displacement gradient `H = J - J0`. The textbook form squares numbers near one and
/// loses every digit on slender beams; this one never forms them.
#[inline(always)]
pub fn green_lagrange<R: Real, T: Algebra<R>, const D: usize>(
    reference: &Tensor<R, D>,
    displacement: &Tensor<T, D>,
) -> Tensor<T, D> {
    let half = R::lit(0.5);
    let middle: Tensor<T, D> =
        array(|a| array(|i| T::lift(reference[a][i]).plus_times(half, displacement[a][i])));
    let mut strain = [[T::zero(); D]; D];
    for a in 0..D {
        strain[a][a] = dot(&middle[a], &displacement[a]);
        for b in a + 1..D {
            let both = dot(&middle[a], &displacement[b]) + dot(&middle[b], &displacement[a]);
            strain[a][b] = both.times(half);
            strain[b][a] = strain[a][b];
        }
    }
    strain
}
