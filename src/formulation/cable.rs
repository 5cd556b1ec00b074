//! Cables and shear-rigid beams: an axis with stretching and bending stiffness, no section frame
//! and no torsion. The literature has two strain energies of this kind under one name; both are
//! here, with resultants and stiffness in closed form.

use super::change::{changes, values};
use super::sampled::{Sample, SampledKernel};
use super::{Formulation, Reference, SectionLaw, SectionStiffness};
use crate::element::Element;
use crate::error::{Error, Result, positive};
use crate::material::SaintVenantKirchhoff;
use crate::quadrature::gauss_legendre;
use crate::scalar::{Algebra, Real, Scalar};
use crate::section::Section;
use crate::tensor::{add_scaled, array, dot, scaled, times};

/// Which strains the energy `1/2 EA eps^2 + 1/2 EI kappa^2` of a cable is made of. They differ by
/// terms of the size of the axial strain: 0.1 % in the benchmark of Gerstmayr and Irschik (2008).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CableEnergy {
    /// Engineering strain `|r'| - 1` and material curvature, the rotation of the tangent per
    /// *reference* length, `|r' x r''| / |r'|^2`: the rod of Reissner without shear, the energy
    /// that Gerstmayr and Irschik recommend.
    #[default]
    MaterialCurvature,
    /// Green-Lagrange strain `(r'.r' - 1) / 2` and geometric curvature, the rotation of the
    /// tangent per *current* length, `|r' x r''| / |r'|^3`: the energy of the original cable
    /// (Berzeri and Shabana 2000).
    GeometricCurvature,
}

/// Where the stiffness comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source<R> {
    Young(R),
    Constants { axial: R, bending: R },
}

/// The strain energy of an Euler-Bernoulli beam, for elements that need no section slopes.
///
/// Bending in space is isotropic: without a section frame there is nothing that could tell two
/// stiffnesses apart, and a section with `Iyy != Izz` is refused. In space the reference must be
/// straight.
///
/// ```
/// use ancf::formulation::CableEnergy;
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(2.07e11, 0.3)?;
/// let mut scene = Scene::<f64, 2>::new();
/// let energy = EulerBernoulli::new(&steel).with_energy(CableEnergy::GeometricCurvature);
/// let beam = Beam::new(Cable, Rectangle::new(0.1, 0.1)?, energy);
/// let beam = scene.add(beam.straight([0.0, 0.0], [2.0, 0.0], 8))?;
/// # let _ = beam;
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EulerBernoulli<R> {
    source: Source<R>,
    energy: CableEnergy,
    stretching: usize,
    bending: usize,
}

impl<R: Real> EulerBernoulli<R> {
    /// `EA` and `EI` from Young's modulus of the material and the area and second moment of the
    /// beam's section.
    pub fn new<const D: usize>(material: &SaintVenantKirchhoff<R, D>) -> Self {
        Self::from(Source::Young(material.young()))
    }

    /// Given stiffness: `axial` `EA` (N) and `bending` `EI` (N m^2). The beam's section is then
    /// needed for the mass only.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a stiffness that is not.
    pub fn with_stiffness(axial: R, bending: R) -> Result<Self> {
        Ok(Self::from(Source::Constants {
            axial: positive("axial stiffness EA [N]", axial)?,
            bending: positive("bending stiffness EI [N m^2]", bending)?,
        }))
    }

    /// 5 axial points for stretching, which integrate the Green-Lagrange energy of a cubic axis
    /// exactly, and 3 for bending, which do so for the straight one.
    fn from(source: Source<R>) -> Self {
        Self {
            source,
            energy: CableEnergy::default(),
            stretching: 5,
            bending: 3,
        }
    }

    /// The same stiffness with these strains.
    #[must_use]
    pub fn with_energy(self, energy: CableEnergy) -> Self {
        Self { energy, ..self }
    }

    /// The same with other numbers of Gauss points along an element, for stretching and bending;
    /// 5 and 3 by default.
    #[must_use]
    pub fn sampled(self, stretching: usize, bending: usize) -> Self {
        Self {
            stretching,
            bending,
            ..self
        }
    }

    /// `EA` and `EI` on this section, in `dimension` dimensions.
    fn stiffness(&self, section: &dyn Section<R>, dimension: usize) -> Result<(R, R)> {
        let young = match self.source {
            Source::Constants { axial, bending } => return Ok((axial, bending)),
            Source::Young(young) => young,
        };
        let p = section.properties()?;
        let small = (p.iyy + p.izz) * R::lit(1e4 * R::EPSILON);
        if dimension > 2 && ((p.iyy - p.izz).abs() > small || p.iyz.abs() > small) {
            return Err(Error::Unsupported {
                what: format!(
                    "a cable in space with the second moments {}, {} and {} m^4",
                    p.iyy.value(),
                    p.izz.value(),
                    p.iyz.value()
                ),
                remedy: "without a section frame bending is isotropic: take a section with Iyy = Izz, EulerBernoulli::with_stiffness, or an element with cross slopes",
            });
        }
        Ok((young * p.area, young * p.izz))
    }
}

/// Kernel of an [`EulerBernoulli`] beam.
pub type CableKernel<R, const D: usize, const S: usize> =
    SampledKernel<R, CableSection<R>, D, S, 2>;

impl<R: Real, E: Element<D, S>, const D: usize, const S: usize> Formulation<R, E, D, S>
    for EulerBernoulli<R>
{
    type Kernel = CableKernel<R, D, S>;

    fn kernel(
        &self,
        element: &E,
        reference: &Reference<R, D, S>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        if D > 2 && !reference.is_straight() {
            return Err(Error::Unsupported {
                what: "a cable in space that is curved from the start".into(),
                remedy: "without a section frame nothing says to which side it is curved: use an element with cross slopes, or a planar scene",
            });
        }
        let (axial, bending) = self.stiffness(section, D)?;
        let samples = [Sample::First(0), Sample::Second(0, 0)];
        let stretching = CableSection::Stretching(self.energy, axial);
        let bending = CableSection::Bending(self.energy, bending);
        let mut kernel = SampledKernel::new();
        for (law, points) in [(stretching, self.stretching), (bending, self.bending)] {
            kernel = kernel.with_part(element, reference, law, samples, &gauss_legendre(points)?);
        }
        Ok(kernel)
    }

    fn resampled(&self, axial: usize, _section_degree: usize) -> Option<Self> {
        Some(self.sampled(axial, axial))
    }
}

/// Energy per unit length of a cable as a function of `r'` and `r''`, one part at a time because
/// the two are sampled with different rules.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CableSection<R> {
    /// `1/2 EA eps^2`, with `EA` (N).
    Stretching(CableEnergy, R),
    /// `1/2 EI kappa^2`, with `EI` (N m^2).
    Bending(CableEnergy, R),
}

impl<R: Real, const D: usize> SectionLaw<R, D, 2> for CableSection<R> {
    const LANES: bool = true;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; 2], h: &[[T; D]; 2]) -> T {
        let half = R::lit(0.5);
        match *self {
            Self::Stretching(energy, stiffness) => {
                let Stretch { strain, unit, .. } = Stretch::of(energy, reference, h);
                (strain * strain).times(half * stiffness * unit)
            }
            Self::Bending(energy, stiffness) => {
                // The square of the curvature, never the curvature: its root has no derivative on
                // a straight axis.
                let Bend {
                    curvature, unit, ..
                } = Bend::of(energy, reference, h);
                dot(&curvature, &curvature).times(half * stiffness * unit)
            }
        }
    }

    #[inline(always)]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; 2], h: &[[T; D]; 2]) -> [[T; D]; 2] {
        match *self {
            Self::Stretching(energy, stiffness) => {
                let stretch = Stretch::of(energy, reference, h);
                let force = (stretch.strain * stretch.slope).times(stiffness * stretch.unit);
                [scaled(force, &stretch.tangent), [T::zero(); D]]
            }
            Self::Bending(energy, stiffness) => {
                let bend = Bend::of(energy, reference, h);
                bend.resultants(&bend.moment(stiffness))
            }
        }
    }

    #[inline(always)]
    fn stiffness<T: Algebra<R>>(
        &self,
        reference: &[[R; D]; 2],
        h: &[[T; D]; 2],
        k: &mut SectionStiffness<T, D, 2>,
    ) -> [[T; D]; 2] {
        match *self {
            Self::Stretching(energy, stiffness) => {
                let stretch = Stretch::of(energy, reference, h);
                let Stretch {
                    tangent,
                    strain,
                    slope,
                    steeper,
                    unit,
                } = stretch;
                let force = (strain * slope).times(stiffness * unit);
                let along = (slope * slope + strain * steeper).times(stiffness * unit);
                *k = [[[[T::zero(); D]; D]; 2]; 2];
                for c in 0..D {
                    k[0][0][c] = scaled(tangent[c] * along, &tangent);
                    k[0][0][c][c] += force;
                }
                [scaled(force, &tangent), [T::zero(); D]]
            }
            Self::Bending(energy, stiffness) => {
                let bend = Bend::of(energy, reference, h);
                let moment = bend.moment(stiffness);
                bend.write_stiffness(stiffness, &moment, k);
                bend.resultants(&moment)
            }
        }
    }
}

/// The axial strain as a function of `x = r'`, with `d strain / dx = slope x` and
/// `d slope / dx = steeper x`.
struct Stretch<R, T, const D: usize> {
    tangent: [T; D],
    strain: T,
    slope: T,
    steeper: T,
    /// Reference length per unit of the coordinate X: 1 up to rounding on a straight axis.
    unit: R,
}

impl<R: Real, T: Algebra<R>, const D: usize> Stretch<R, T, D> {
    #[inline(always)]
    fn of(energy: CableEnergy, reference: &[[R; D]; 2], h: &[[T; D]; 2]) -> Self {
        let square0 = dot(&reference[0], &reference[0]);
        let [tangent] = changes(&[reference[0]], &[h[0]]);
        let twice = dot(&tangent, &tangent).change.times(square0.recip());
        let (strain, slope, steeper) = match energy {
            CableEnergy::GeometricCurvature => (
                twice.times(R::lit(0.5)),
                T::lift(square0.recip()),
                T::zero(),
            ),
            // sqrt(1 + 2 E) - 1 without the difference of numbers near one.
            CableEnergy::MaterialCurvature => {
                let square = T::one() + twice;
                let stretch = square.sqrt();
                let slope = stretch.recip().times(square0.recip());
                let steeper = -(slope / square).times(square0.recip());
                (twice / (T::one() + stretch), slope, steeper)
            }
        };
        Self {
            tangent: values(&tangent),
            strain,
            slope,
            steeper,
            unit: square0.sqrt(),
        }
    }
}

/// The curvature `p x x y` as a function of `x = r'` and `y = r''`, with `p` a power of `|x|`,
/// `dp/dx = slope x` and `d slope / dx = steeper x`.
struct Bend<R, T, const D: usize> {
    x: [T; D],
    y: [T; D],
    /// `x x y`, in the plane the one component that there is, first.
    turn: [T; 3],
    power: T,
    slope: T,
    steeper: T,
    /// Components of the curvature less that of the reference.
    curvature: [T; 3],
    unit: R,
}

impl<R: Real, T: Algebra<R>, const D: usize> Bend<R, T, D> {
    /// Components of the curvature.
    const TURNS: usize = if D == 3 { 3 } else { 1 };

    #[inline(always)]
    fn of(energy: CableEnergy, reference: &[[R; D]; 2], h: &[[T; D]; 2]) -> Self {
        let length0 = dot(&reference[0], &reference[0]).sqrt();
        let [tangent, bend] = changes(reference, h);
        let per_length = dot(&tangent, &tangent).rsqrt();
        let per_square = per_length * per_length;
        let (power, exponent, unit) = match energy {
            CableEnergy::MaterialCurvature => (per_square, 2.0, length0.recip()),
            CableEnergy::GeometricCurvature => (per_square * per_length, 3.0, length0),
        };
        let turns = wedge(&tangent, &bend);
        let slope = (power.value * per_square.value).times(R::lit(-exponent));
        let mut curvature = [T::zero(); 3];
        for m in 0..Self::TURNS {
            curvature[m] = (turns[m] * power).change;
        }
        Self {
            x: values(&tangent),
            y: values(&bend),
            turn: values(&turns),
            power: power.value,
            slope,
            steeper: (slope * per_square.value).times(R::lit(-exponent - 2.0)),
            curvature,
            unit,
        }
    }

    /// What is conjugate to the curvature.
    #[inline(always)]
    fn moment(&self, stiffness: R) -> [T; 3] {
        array(|m| self.curvature[m].times(stiffness * self.unit))
    }

    /// `sum_m moment_m d curvature_m`.
    #[inline(always)]
    fn resultants(&self, moment: &[T; 3]) -> [[T; D]; 2] {
        let along = self.slope * self.along(moment);
        let ([by_x, by_y], x) = (self.by_turns(moment), &self.x);
        [
            array(|c| by_x[c] * self.power + x[c] * along),
            scaled(self.power, &by_y),
        ]
    }

    /// `moment . turn`.
    #[inline(always)]
    fn along(&self, moment: &[T; 3]) -> T {
        let mut sum = moment[0] * self.turn[0];
        for m in 1..Self::TURNS {
            sum = sum.plus_product(moment[m], self.turn[m]);
        }
        sum
    }

    /// Derivatives of `moment . (x x y)` by `x` and `y`: `y x moment` and `moment x x`.
    #[inline(always)]
    fn by_turns(&self, moment: &[T; 3]) -> [[T; D]; 2] {
        [
            beside(&self.y, moment),
            scaled(-T::one(), &beside(&self.x, moment)),
        ]
    }

    /// Writes the second derivatives of the energy.
    #[inline(always)]
    fn write_stiffness(&self, stiffness: R, moment: &[T; 3], k: &mut SectionStiffness<T, D, 2>) {
        let Self { x, power, .. } = *self;
        let along = self.along(moment);
        let [by_x, by_y] = self.by_turns(moment);
        let (own, sides) = (self.slope * along, self.steeper * along);
        for c in 0..D {
            for d in 0..D {
                let bent = (x[c] * by_x[d] + by_x[c] * x[d]) * self.slope;
                k[0][0][c][d] = bent + x[c] * x[d] * sides;
                k[0][1][c][d] = x[c] * by_y[d] * self.slope;
                k[1][1][c][d] = T::zero();
            }
            k[0][0][c][c] += own;
        }
        // d (y x moment) / dy.
        let moment: [T; 3] = array(|m| moment[m] * power);
        if D == 3 {
            for c in 0..3 {
                let (e, f) = ((c + 1) % 3, (c + 2) % 3);
                k[0][1][e % D][f % D] += moment[c];
                k[0][1][f % D][e % D] -= moment[c];
            }
        } else {
            k[0][1][0][1] += moment[0];
            k[0][1][1][0] -= moment[0];
        }
        for m in 0..Self::TURNS {
            let unit = array(|n| if n == m { T::one() } else { T::zero() });
            let [g, f] = self.resultants(&unit);
            let (stiff_g, stiff_f) = (
                times(stiffness * self.unit, &g),
                times(stiffness * self.unit, &f),
            );
            for c in 0..D {
                add_scaled(&mut k[0][0][c], stiff_g[c], &g);
                add_scaled(&mut k[0][1][c], stiff_g[c], &f);
                add_scaled(&mut k[1][1][c], stiff_f[c], &f);
            }
        }
    }
}

/// `a x m`, in the plane for `m` along the normal, whose one component comes first.
#[inline(always)]
fn beside<T: Scalar, const D: usize>(a: &[T; D], m: &[T; 3]) -> [T; D] {
    array(|c| match (D, c) {
        (3, _) => a[(c + 1) % D] * m[(c + 2) % 3] - a[(c + 2) % D] * m[(c + 1) % 3],
        (_, 0) => a[1] * m[0],
        _ => -(a[0] * m[0]),
    })
}

/// Components of `a x b` in space; in the plane the one component that there is, with its sign.
#[inline(always)]
fn wedge<T: Scalar, const D: usize>(a: &[T; D], b: &[T; D]) -> [T; 3] {
    array(|k| match (k + 1, k + 2) {
        (i, j) if D == 3 => a[i % D] * b[j % D] - a[j % D] * b[i % D],
        _ if k == 0 => a[0] * b[1] - a[1] * b[0],
        _ => T::zero(),
    })
}
