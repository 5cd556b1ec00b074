//! Structural mechanics: the strain energy of a geometrically exact beam (Reissner, Simo) on the
//! slopes of an ANCF element, after Nachbagauer, Gruber and Gerstmayr (2013). Stiffness is given
//! by constants, as most benchmarks of beams are; the law is its energy and nothing else.

use num_traits::{One, Zero};

use super::change::{Change, changes};
use super::sampled::{SampledKernel, section_samples};
use super::{Formulation, Reference, SectionLaw};
use crate::element::Element;
use crate::error::{Error, Result, positive};
use crate::material::SaintVenantKirchhoff;
use crate::quadrature::{Cubature, gauss_legendre};
use crate::scalar::{Algebra, Field, Real};
use crate::section::Section;
use crate::tensor::{cross, dot, sum};

/// Stiffness of a beam about its section axes `y` and `z`. In the plane only `axial`, `shear[0]`
/// and `bending[1]` matter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamStiffness<R> {
    /// `EA` (N).
    pub axial: R,
    /// `GA_y` and `GA_z` (N), shear correction included.
    pub shear: [R; 2],
    /// `GJ` (N m^2).
    pub torsion: R,
    /// `EI_y` and `EI_z` (N m^2), `I_y` the integral of `z^2`.
    pub bending: [R; 2],
}

/// Where the stiffness comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source<R> {
    Moduli { young: R, shear: R },
    Constants(BeamStiffness<R>),
}

/// The structural mechanics formulation for elements with cross slopes that are linear across the
/// section, the [`Quadratic`](crate::element::Quadratic) one above all.
///
/// Strains and curvatures are sampled at Gauss points along the axis, by default as many as the
/// axis has degrees; the section's own deformation, which the formulation resists only to keep
/// the slopes unit and normal, at the nodes, where it can vanish exactly.
///
/// ```
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::<f64, 3>::isotropic(2.07e11, 0.3)?;
/// let from_section = StructuralMechanics::new(&steel).with_shear_factors([5.0 / 6.0; 2]);
/// let given = StructuralMechanics::with_stiffness(BeamStiffness {
///     axial: 1e6,
///     shear: [1e6, 1e6],
///     torsion: 1e3,
///     bending: [1e3, 1e3],
/// })?;
/// // With a density of 1 kg/m^3, Moments are rho A, rho I_y and rho I_z.
/// let leg = Beam::new(Quadratic, Moments::new(1.0, 10.0, 10.0)?, given)
///     .straight([0.0; 3], [10.0, 0.0, 0.0], 4)
///     .density(1.0);
/// Scene::<f64, 3>::new().add(leg)?;
/// # let _ = from_section;
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StructuralMechanics<R> {
    source: Source<R>,
    factors: [R; 2],
    torsion: Option<R>,
    axial: Option<usize>,
}

impl<R: Real> StructuralMechanics<R> {
    /// Stiffness from the moduli of the material and the beam's section: `EA`, `GA` without
    /// correction, `EI`, and `GJ = G (I_y + I_z)`, which is exact for circular sections only.
    pub fn new<const D: usize>(material: &SaintVenantKirchhoff<R, D>) -> Self {
        let (young, shear) = (material.young(), material.shear());
        Self::from(Source::Moduli { young, shear })
    }

    /// Given stiffness; the beam's section is then needed for the mass only.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a stiffness that is not.
    pub fn with_stiffness(stiffness: BeamStiffness<R>) -> Result<Self> {
        Ok(Self::from(Source::Constants(checked(stiffness)?)))
    }

    fn from(source: Source<R>) -> Self {
        Self {
            source,
            factors: [R::one(); 2],
            torsion: None,
            axial: None,
        }
    }

    /// Multiplies `GA_y` and `GA_z` by shear correction factors.
    #[must_use]
    pub fn with_shear_factors(self, factors: [R; 2]) -> Self {
        Self { factors, ..self }
    }

    /// Replaces `GJ` (N m^2).
    #[must_use]
    pub fn with_torsion(self, torsion: R) -> Self {
        let torsion = Some(torsion);
        Self { torsion, ..self }
    }

    /// Samples the strains at this number of Gauss points along an element.
    #[must_use]
    pub fn axial(self, points: usize) -> Self {
        let axial = Some(points);
        Self { axial, ..self }
    }

    /// The stiffness on this section.
    fn stiffness(&self, section: &dyn Section<R>) -> Result<BeamStiffness<R>> {
        let mut stiffness = match self.source {
            Source::Constants(stiffness) => stiffness,
            Source::Moduli { young, shear } => {
                let p = section.properties()?;
                let polar = p.iyy + p.izz;
                let small = R::lit(1e4 * R::EPSILON);
                let [y, z] = p.centroid;
                if p.iyz.abs() > polar * small || p.area * (y * y + z * z) > polar * small * small {
                    return Err(Error::Unsupported {
                        what: format!(
                            "a section with Iyz = {} m^4 and centroid ({}, {}) m",
                            p.iyz.value(),
                            y.value(),
                            z.value()
                        ),
                        remedy: "structural mechanics needs the principal axes and the centroid: turn and shift the section, or use a continuum",
                    });
                }
                BeamStiffness {
                    axial: young * p.area,
                    shear: [shear * p.area; 2],
                    torsion: shear * polar,
                    bending: [young * p.iyy, young * p.izz],
                }
            }
        };
        for (shear, factor) in stiffness.shear.iter_mut().zip(self.factors) {
            *shear *= positive("shear correction factor", factor)?;
        }
        stiffness.torsion = self.torsion.unwrap_or(stiffness.torsion);
        checked(stiffness)
    }
}

fn checked<R: Real>(stiffness: BeamStiffness<R>) -> Result<BeamStiffness<R>> {
    positive("axial stiffness EA [N]", stiffness.axial)?;
    positive("shear stiffness GA_y [N]", stiffness.shear[0])?;
    positive("shear stiffness GA_z [N]", stiffness.shear[1])?;
    positive("torsional stiffness GJ [N m^2]", stiffness.torsion)?;
    positive("bending stiffness EI_y [N m^2]", stiffness.bending[0])?;
    positive("bending stiffness EI_z [N m^2]", stiffness.bending[1])?;
    Ok(stiffness)
}

/// Trapezoidal and Simpson's rule on [0, 1]: points at the nodes. Beyond three nodes, where such
/// rules turn bad, Gauss points of the same number.
fn at_nodes<R: Real>(nodes: usize) -> Result<Cubature<R, 1>> {
    let line = |weights: &[f64], degree| {
        let last = R::lit((weights.len() - 1) as f64);
        let point = |i| [R::lit(i as f64) / last];
        let total = R::lit(weights.iter().sum());
        let weight = |w: &f64| R::lit(*w) / total;
        Cubature::new(
            (0..weights.len()).map(point).collect(),
            weights.iter().map(weight).collect(),
            degree,
        )
    };
    match nodes {
        2 => line(&[1.0, 1.0], 1),
        3 => line(&[1.0, 4.0, 1.0], 3),
        _ => gauss_legendre(nodes),
    }
}

/// Kernel of a [`StructuralMechanics`] beam; `K = 2 D - 1`.
pub type StructuralKernel<R, const D: usize, const S: usize, const K: usize> =
    SampledKernel<R, StructuralSection<R>, D, S, K>;

macro_rules! dimension {
    ($d:literal, $k:literal) => {
        impl<R: Real, E: Element<$d, S>, const S: usize> Formulation<R, E, $d, S>
            for StructuralMechanics<R>
        {
            type Kernel = StructuralKernel<R, $d, S, $k>;

            fn kernel(
                &self,
                element: &E,
                reference: &Reference<R, $d, S>,
                section: &dyn Section<R>,
            ) -> Result<Self::Kernel> {
                let stiffness = self.stiffness(section)?;
                let samples = section_samples(element, reference.length)?;
                let along = gauss_legendre(self.axial.unwrap_or(E::AXIAL_DEGREE))?;
                let rod = StructuralSection::Rod(stiffness);
                let shape = StructuralSection::Shape(stiffness.axial);
                Ok(SampledKernel::new()
                    .with_part(element, reference, rod, samples, &along)
                    .with_part(element, reference, shape, samples, &at_nodes(E::NODES)?))
            }

            fn resampled(&self, axial: usize, _section_degree: usize) -> Option<Self> {
                Some(self.axial(axial))
            }
        }
    };
}
dimension!(2, 3);
dimension!(3, 5);

/// Energy per unit length of a structural mechanics beam as a function of `r'`, the cross slopes
/// and their derivatives, one part at a time because the two are sampled in different places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StructuralSection<R> {
    /// `1/2 (EA G_1^2 + GA_y G_2^2 + GA_z G_3^2 + GJ k_1^2 + EI_y k_2^2 + EI_z k_3^2)` with the
    /// strains `G` and curvatures `k` in the section frame, less those of the reference.
    Rod(BeamStiffness<R>),
    /// `1/2 EA (E_yy^2 + E_zz^2 + 2 E_yz^2)` with the Green-Lagrange strains of the section and
    /// `EA` (N): the same for every direction in the section.
    Shape(R),
}

impl<R: Real, const D: usize, const K: usize> SectionLaw<R, D, K> for StructuralSection<R> {
    #[inline]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T {
        // Reference length per unit of the coordinate X: 1 up to rounding on a straight axis.
        let length0 = dot(&reference[0], &reference[0]).sqrt();
        let half = R::lit(0.5);
        let mut twice = T::zero();
        match self {
            Self::Rod(k) => {
                let [[axial, sy, sz], [torsion, by, bz]] = [
                    [k.axial, k.shear[0], k.shear[1]],
                    [k.torsion, k.bending[0], k.bending[1]],
                ];
                let stiffness = [axial, sy, sz, torsion, by, bz];
                let strains = strains(&changes(reference, h));
                for (strain, stiffness) in strains.into_iter().zip(stiffness) {
                    twice += (strain.change * strain.change).times(stiffness);
                }
                // Strains are per reference length: two divisions, and one factor to integrate.
                twice.times(half / length0)
            }
            Self::Shape(axial) => {
                for a in 1..D {
                    for b in a..D {
                        let middle = |k: usize| {
                            let half = h[k].map(|c| c.times(half));
                            sum(&reference[k].map(T::lift), &half)
                        };
                        let strain = (dot(&middle(a), &h[b]) + dot(&middle(b), &h[a])).times(half);
                        let count = if a == b { 1.0 } else { 2.0 };
                        twice += (strain * strain).times(R::lit(count));
                    }
                }
                twice.times(half * *axial * length0)
            }
        }
    }
}

/// `e_i . r'` and the components of the curvature in the section frame `e_3 = r_z / |r_z|`, `e_1`
/// along `r_y x r_z`, `e_2 = e_3 x e_1`, per unit of the coordinate along the axis.
///
/// For an orthonormal frame `1/2 sum e_i x e_i'` has the components `-e_2.e_3'`, `e_1.e_3'` and
/// `e_2.e_1'`, in which the projections of `r_z'` and `(r_y x r_z)'` that make `e_3'` and `e_1'`
/// drop out. A planar beam is one in space with `r_z` along the normal.
#[inline(always)]
fn strains<T: Field, const D: usize, const K: usize>(g: &[[Change<T>; D]; K]) -> [Change<T>; 6] {
    let (zero, one) = (Change::zero(), Change::one());
    let space = |k: usize| std::array::from_fn(|c| if c < D { g[k][c] } else { zero });
    let (tangent, y) = (space(0), space(1));
    let (z, y_turn, z_turn) = match D {
        2 => ([zero, zero, one], space(2), [zero; 3]),
        _ => (space(2), space(3), space(4)),
    };
    let normal = cross(&y, &z);
    let turn = sum(&cross(&y_turn, &z), &cross(&y, &z_turn));
    let (per_z, per_normal) = (dot(&z, &z).rsqrt(), dot(&normal, &normal).rsqrt());
    let e3 = z.map(|c| c * per_z);
    let e1 = normal.map(|c| c * per_normal);
    let e2 = cross(&e3, &e1);
    [
        dot(&e1, &tangent),
        dot(&e2, &tangent),
        dot(&e3, &tangent),
        -dot(&e2, &z_turn) * per_z,
        dot(&e1, &z_turn) * per_z,
        dot(&e2, &turn) * per_normal,
    ]
}
