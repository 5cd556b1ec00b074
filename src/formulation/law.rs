//! Laws of the cross-section: strain energy per unit length as a function of the vectors that a
//! station samples. A law given by its energy alone gets its resultants and stiffness by dual
//! numbers, one sampled vector at a time; built-in laws override them with closed forms.

use std::fmt::Debug;

use crate::scalar::{Algebra, Real};
use crate::tensor::{add_times, array, between, gauss_pair};

/// Second derivatives of a section's energy: `k[a][b]` is the `D x D` block that couples the
/// sampled vectors `a` and `b`. Only blocks with `a <= b` are used,
/// except of secants, which are not symmetric.
pub type SectionStiffness<T, const D: usize, const K: usize> = [[[[T; D]; D]; K]; K];

/// Strain energy per unit length of a beam as a function of `K` sampled vectors in `D` dimensions.
///
/// The vectors are `g = g0 + h`: `reference` holds `g0`, the displacement part `h` carries the
/// number type. Energies formed from `h` keep their digits on slender beams.
pub trait SectionLaw<R: Real, const D: usize, const K: usize>:
    Debug + Send + Sync + 'static
{
    /// Whether chains of elements take this law in SIMD lanes: several times faster where every
    /// function of it down to the arithmetic is inlined (`#[inline(always)]`), slower where one is
    /// not, and machine code for each kind of register. By default they do not.
    const LANES: bool = false;

    /// Whether no element is ever made of this law, whose functions are then not compiled where its kernel
    /// is one of several: that of a material that is integrated once, see [`Material::CONSTANT`].
    ///
    /// [`Material::CONSTANT`]: crate::material::Material::CONSTANT
    const ABSENT: bool = false;

    /// Energy per unit length (J/m).
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T;

    /// Derivatives of the energy by the sampled vectors.
    #[inline]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        derived_resultants(self, reference, h)
    }

    /// Whether [`secant`](Self::secant) is made of strains that rotations do not change, so that
    /// it keeps angular momentum and may be viscous; by default it is not.
    fn has_strain(&self) -> bool {
        false
    }

    /// The mean of the resultants on the straight way of the sampled vectors, whose work is the
    /// change of energy; by default by two Gauss points, exact for energies up to the fourth
    /// degree. With a `viscosity`, and only for laws that have strain, the stress that this share
    /// of the change of strain makes is added.
    #[inline(always)]
    fn secant<T: Algebra<R>>(
        &self,
        _viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> [[T; D]; K] {
        path_mean(
            from,
            to,
            #[inline(always)]
            |h| self.resultants(reference, h),
        )
    }

    /// Derivatives of the secant resultants by the sampled vectors `to`, all blocks of them: they need not
    /// be symmetric. By default those of the default [`secant`](Self::secant), from the stiffness at its
    /// Gauss points; a law with a secant of its own gives its derivatives, too.
    #[inline(always)]
    fn secant_stiffness<T: Algebra<R>>(
        &self,
        _viscosity: R,
        reference: &[[R; D]; K],
        from: &[[T; D]; K],
        to: &[[T; D]; K],
    ) -> SectionStiffness<T, D, K> {
        let mut mean = [[[[T::zero(); D]; D]; K]; K];
        let mut there = [[[[T::zero(); D]; D]; K]; K];
        for share in gauss_pair::<R>() {
            self.stiffness(reference, &between(from, to, share), &mut there);
            for a in 0..K {
                for b in a..K {
                    for c in 0..D {
                        add_times(&mut mean[a][b][c], R::lit(0.5) * share, &there[a][b][c]);
                    }
                }
            }
        }
        for a in 0..K {
            for b in 0..a {
                for c in 0..D {
                    mean[a][b][c] = array(
                        #[inline(always)]
                        |d| mean[b][a][d][c],
                    );
                }
            }
        }
        mean
    }

    /// First derivatives of the energy by the sampled vectors; the second derivatives overwrite the
    /// blocks `a <= b` of `k`.
    #[inline]
    fn stiffness<T: Algebra<R>>(
        &self,
        reference: &[[R; D]; K],
        h: &[[T; D]; K],
        k: &mut SectionStiffness<T, D, K>,
    ) -> [[T; D]; K] {
        derived_stiffness(self, reference, h, k)
    }
}

/// Mean of `force` on the straight way between two sets of vectors, by two Gauss points.
#[inline(always)]
pub(super) fn path_mean<R: Real, T: Algebra<R>, const D: usize, const N: usize>(
    from: &[[T; D]; N],
    to: &[[T; D]; N],
    force: impl Fn(&[[T; D]; N]) -> [[T; D]; N],
) -> [[T; D]; N] {
    let mut mean = [[T::zero(); D]; N];
    for share in gauss_pair::<R>() {
        let part = force(&between(from, to, share));
        for i in 0..N {
            add_times(&mut mean[i], R::lit(0.5), &part[i]);
        }
    }
    mean
}

#[inline(always)]
fn derived_resultants<R, T, L, const D: usize, const K: usize>(
    law: &L,
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
) -> [[T; D]; K]
where
    R: Real,
    T: Algebra<R>,
    L: SectionLaw<R, D, K> + ?Sized,
{
    let mut resultants = [[T::zero(); D]; K];
    // A loop, so that there is the energy once.
    for k in 0..K {
        let energy = law.energy(reference, &varied(h, k));
        for c in 0..D {
            resultants[k][c] = T::derivative::<D>(&energy, c);
        }
    }
    resultants
}

#[inline(always)]
fn derived_stiffness<R, T, L, const D: usize, const K: usize>(
    law: &L,
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
    stiffness: &mut SectionStiffness<T, D, K>,
) -> [[T; D]; K]
where
    R: Real,
    T: Algebra<R>,
    L: SectionLaw<R, D, K> + ?Sized,
{
    let mut resultants = [[T::zero(); D]; K];
    for b in 0..K {
        let dual = law.resultants(reference, &varied(h, b));
        for a in 0..=b {
            for c in 0..D {
                for d in 0..D {
                    stiffness[a][b][c][d] = T::derivative::<D>(&dual[a][c], d);
                }
            }
        }
        resultants[b] = array(|c| T::real_part::<D>(&dual[b][c]));
    }
    resultants
}

/// Dual numbers with unit derivatives along the components of vector `k` of `vectors`.
#[inline(always)]
pub(crate) fn varied<R, T: Algebra<R>, const D: usize, const K: usize>(
    vectors: &[[T; D]; K],
    k: usize,
) -> [[T::Dual<D>; D]; K] {
    array(|a| {
        array(|c| match a == k {
            true => vectors[a][c].variable(c),
            false => vectors[a][c].constant(),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Cable;
    use crate::formulation::{
        BeamStiffness, CableEnergy, CableSection, Reference, Sample, SampledKernel,
        StructuralSection,
    };
    use crate::quadrature::gauss_legendre;

    /// A law reduced to its energy.
    #[derive(Debug)]
    struct Energy<L>(L);

    impl<R: Real, L: SectionLaw<R, D, K>, const D: usize, const K: usize> SectionLaw<R, D, K>
        for Energy<L>
    {
        fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T {
            self.0.energy(reference, h)
        }
    }

    /// Resultants and stiffness against those by dual numbers of the energy, far from the reference,
    /// which is curved and stretched.
    fn check<L, const D: usize, const K: usize>(law: L)
    where
        L: SectionLaw<f64, D, K> + Copy,
    {
        let number = |seed: usize| (1.7 * seed as f64).sin();
        let reference: [[f64; D]; K] =
            array(|k| array(|c| number(7 * k + 3 * c + 1) * 0.3 + if c == k { 1.1 } else { 0.0 }));
        let h: [[f64; D]; K] = array(|k| array(|c| 0.4 * number(5 * k + 11 * c + 2)));
        let mut stiffness = [[[[[0.0; D]; D]; K]; K]; 2];
        let [ours, theirs] = &mut stiffness;
        let resultants = [
            law.resultants(&reference, &h),
            Energy(law).resultants(&reference, &h),
            law.stiffness(&reference, &h, ours),
            Energy(law).stiffness(&reference, &h, theirs),
        ];
        let size = |v: &[f64]| v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let largest = size(resultants[1].as_flattened());
        assert!(largest > 1e-3);
        for other in &resultants {
            for (a, b) in other
                .as_flattened()
                .iter()
                .zip(resultants[1].as_flattened())
            {
                assert!((a - b).abs() < 1e-13 * largest, "{law:?}: {a} {b}");
            }
        }
        let largest = size(theirs.as_flattened().as_flattened().as_flattened());
        for (a, b) in (0..K).flat_map(|a| (a..K).map(move |b| (a, b))) {
            let pair = [ours[a][b].as_flattened(), theirs[a][b].as_flattened()];
            for (x, y) in pair[0].iter().zip(pair[1]) {
                assert!((x - y).abs() < 1e-13 * largest, "{law:?} {a} {b}: {x} {y}");
            }
        }
    }

    /// A law that no element is made of.
    #[derive(Debug)]
    struct Absent;

    impl SectionLaw<f64, 2, 1> for Absent {
        const ABSENT: bool = true;

        fn energy<T: Algebra<f64>>(&self, _reference: &[[f64; 2]; 1], h: &[[T; 2]; 1]) -> T {
            h[0][0]
        }
    }

    #[test]
    #[should_panic(expected = "ABSENT")]
    fn no_element_is_made_of_an_absent_law() {
        let axes = [[1.0, 0.0], [0.0, 1.0]];
        let reference = Reference::<f64, 2, 4>::straight(&Cable, 1.0, axes);
        let axial = gauss_legendre(2).unwrap();
        let samples = [Sample::First(0)];
        let _ = SampledKernel::new().with_part(&Cable, &reference, Absent, samples, &axial);
    }

    #[test]
    fn closed_forms_of_cables_are_the_derivatives_of_their_energy() {
        for energy in [
            CableEnergy::MaterialCurvature,
            CableEnergy::GeometricCurvature,
        ] {
            let stretching = CableSection::Stretching(energy, 2.0);
            let bending = CableSection::Bending(energy, 3.0);
            for law in [stretching, bending] {
                check::<_, 2, 2>(law);
                check::<_, 3, 2>(law);
            }
        }
    }

    #[test]
    fn closed_forms_of_rods_are_the_derivatives_of_their_energy() {
        let stiffness = BeamStiffness {
            axial: 2.0,
            shear: [3.0, 1.5],
            torsion: 0.7,
            bending: [1.2, 0.4],
        };
        for law in [
            StructuralSection::Rod(stiffness),
            StructuralSection::Shape(2.0),
        ] {
            check::<_, 2, 3>(law);
            check::<_, 3, 5>(law);
        }
    }
}
