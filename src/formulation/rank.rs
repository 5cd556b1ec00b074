//! Zero-energy modes: a sampling that is too coarse leaves deformations that cost no energy. This
//! room counts them on a stocky reference element (where rank is not blurred by slenderness) and
//! finds the orders that would suffice.

use nalgebra::{DMatrix, DVector};

use super::{ElementKernel, Formulation, Reference, Tangent, mirror};
use crate::element::{Element, NodalVector};
use crate::error::{Error, Result, positive};
use crate::quadrature::Cubature;
use crate::scalar::{Field, Real};
use crate::section::Section;

/// Relative size below which an eigenvalue of the scaled stiffness counts as zero.
const ZERO: f64 = 1e-12;
/// The same in single precision.
const ZERO_SINGLE: f64 = 1e-5;
/// Orders tried when looking for sufficient ones.
const TRIALS: usize = 8;

/// Refuses a formulation whose sampling leaves zero-energy modes beyond the rigid ones on a
/// straight element of the given length (m).
pub(super) fn check_rank<R, E, F, const D: usize, const S: usize>(
    formulation: &F,
    element: &E,
    length: R,
    section: &dyn Section<R>,
) -> Result<()>
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    let axes =
        std::array::from_fn(|a| std::array::from_fn(|c| if a == c { R::one() } else { R::zero() }));
    let reference = Reference::straight(element, length, axes);
    let size = S * D;
    let lanes = || 0..R::LANES;
    let rigid: Vec<_> = lanes()
        .map(|lane| rigid_motions::<R, E, D, S>(&reference, lane))
        .collect();
    let count = rigid.iter().map(|motions| motions.rank(INDEPENDENT));
    let target = size - count.max().unwrap_or(0);
    let rank_of = |trial: &F| -> Result<usize> {
        let kernel = trial.kernel(element, &reference, section)?;
        let mut k = [[[[R::zero(); D]; S]; D]; S];
        kernel.upper_tangent(&[[R::zero(); D]; S], &mut k);
        mirror(&mut k);
        let ranks = lanes().map(|lane| {
            let stiffness = Stiffness::of::<R, E, D, S>(&k, &reference, lane)?;
            Ok(match stiffness.is_definite_but_for(&rigid[lane]) {
                true => target,
                false => stiffness.rank(),
            })
        });
        let ranks = ranks.collect::<Result<Vec<_>>>()?;
        Ok(ranks.into_iter().min().unwrap_or(0))
    };
    let rank = rank_of(formulation)?;
    if rank >= target {
        return Ok(());
    }
    let mut sufficient = None;
    'search: for degree in (1..TRIALS).step_by(2) {
        for axial in 1..=TRIALS {
            let trial = formulation.resampled(axial, degree);
            if trial.map_or(Ok(0), |trial| rank_of(&trial))? >= target {
                sufficient = Some((axial, degree));
                break 'search;
            }
        }
    }
    Err(Error::ZeroEnergyModes {
        modes: target - rank,
        rank,
        target,
        sufficient: match sufficient {
            Some((axial, degree)) => {
                format!(
                    "use at least {axial} axial points with a section rule of degree {degree} or more"
                )
            }
            None if zero_below::<R>() > ZERO => format!(
                "no other order tried removes them: sample more points, or give more stiffness to what has less than {:e} of the largest, which this number type does not tell from none, or take f64",
                zero_below::<R>()
            ),
            None => {
                "no other order tried removes them: sample more points, or give more stiffness to what has none".into()
            }
        },
    })
}

/// Length (m) over which a beam of this section is stocky: four radii of gyration.
pub(super) fn stocky_length<R: Real>(section: &dyn Section<R>) -> Result<R> {
    let properties = section.properties()?;
    let area = positive("area of the section [m^2]", properties.area)?;
    let moment = properties.iyy + properties.izz;
    let moment = second_moment(section, moment)?;
    let length = R::lit(4.0) * Field::sqrt(moment / area);
    positive("radius of gyration of the section [m]", length)
}

/// A second moment that is positive; where it is not because the rule it comes from is of too low a
/// degree, that is the error.
fn second_moment<R: Real>(section: &dyn Section<R>, moment: R) -> Result<R> {
    positive("second moment of the section [m^4]", moment).or_else(|error| {
        section.rule(2)?.reaching(2)?;
        Err(error)
    })
}

/// A section stretched to radii of gyration of a quarter about both axes, so that a beam of unit
/// length is stocky: rank does not depend on them, but its rounding does.
#[derive(Debug)]
pub(super) struct Stocky<'a, R> {
    section: &'a dyn Section<R>,
    stretch: [[R; 2]; 2],
}

impl<'a, R: Real> Stocky<'a, R> {
    pub(super) fn new(section: &'a dyn Section<R>) -> Result<Self> {
        let properties = section.properties()?;
        let area = positive("area of the section [m^2]", properties.area)?;
        let stretch = |moment: R| {
            let moment = second_moment(section, moment)?;
            let stretch = R::lit(0.25) * Field::sqrt(area / moment);
            positive("curvature of the section's gyration [1/m]", stretch)
        };
        let (y, z) = (stretch(properties.izz)?, stretch(properties.iyy)?);
        let stretch = [[y, R::zero()], [R::zero(), z]];
        Ok(Self { section, stretch })
    }
}

impl<R: Real> Section<R> for Stocky<'_, R> {
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        self.section
            .rule(degree)?
            .affine(self.stretch, [R::zero(); 2])
    }

    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        self.section.outline(n)
    }
}

/// Singular values of rigid motions below which they are not independent.
const INDEPENDENT: f64 = 1e-8;

/// Number of independent rigid motions the coordinates can tell apart.
pub(crate) fn rigid_modes<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    reference: &Reference<R, D, S>,
    lane: usize,
) -> usize {
    rigid_motions::<R, E, D, S>(reference, lane).rank(INDEPENDENT)
}

/// Translations and rotations by column, in coordinates of natural size.
fn rigid_motions<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    reference: &Reference<R, D, S>,
    lane: usize,
) -> DMatrix<f64> {
    let e = &reference.vectors;
    let per_node = E::VECTORS.len();
    let motions: Vec<_> = (0..D).flat_map(|a| (0..=a).map(move |b| (a, b))).collect();
    DMatrix::from_fn(S * D, motions.len(), |row, column| {
        let (vector, component) = (row / D, row % D);
        match motions[column] {
            (a, b) if a == b => {
                let position = E::VECTORS[vector % per_node] == NodalVector::Position;
                f64::from(u8::from(position && component == a))
            }
            (a, b) => {
                let unit = unit::<R, E, D, S>(row, reference, lane);
                match component {
                    c if c == a => -e[vector][b].lane(lane) / unit,
                    c if c == b => e[vector][a].lane(lane) / unit,
                    _ => 0.0,
                }
            }
        }
    })
}

/// Natural size of a coordinate: the element length for positions (m), 1 for slopes.
fn unit<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    row: usize,
    reference: &Reference<R, D, S>,
    lane: usize,
) -> f64 {
    match E::VECTORS[(row / D) % E::VECTORS.len()] {
        NodalVector::Position => reference.length.lane(lane),
        NodalVector::Slope(_) => 1.0,
    }
}

/// Below which an eigenvalue of the scaled stiffness counts as zero in a number type.
fn zero_below<R: Real>() -> f64 {
    match R::EPSILON > 1e-10 {
        true => ZERO_SINGLE,
        false => ZERO,
    }
}

/// A tangent at the reference configuration, coordinates scaled to a unit diagonal.
struct Stiffness {
    scaled: DMatrix<f64>,
    /// By what coordinates of natural size are multiplied.
    scale: DVector<f64>,
    /// Below which its eigenvalues count as zero.
    zero: f64,
}

impl Stiffness {
    fn of<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
        k: &Tangent<R, D, S>,
        reference: &Reference<R, D, S>,
        lane: usize,
    ) -> Result<Self> {
        let unit = |row: usize| unit::<R, E, D, S>(row, reference, lane);
        let k = k.as_flattened().as_flattened().as_flattened();
        let matrix = DMatrix::from_fn(S * D, S * D, |i, j| {
            unit(i) * k[i * S * D + j].lane(lane) * unit(j)
        });
        if let Some(value) = matrix.iter().copied().find(|v| !v.is_finite()) {
            return Err(Error::NotFinite {
                what: "a stiffness of an element at rest, by its energy and moduli,",
                value,
            });
        }
        let top = matrix.diagonal().amax();
        let scale = matrix.diagonal().map(|d| match top > 0.0 {
            true if d.abs() > ZERO * top => 1.0 / d.abs().sqrt(),
            true => 1.0 / top.sqrt(),
            false => 1.0,
        });
        Ok(Self {
            scaled: DMatrix::from_fn(S * D, S * D, |i, j| scale[i] * matrix[(i, j)] * scale[j]),
            scale,
            zero: zero_below::<R>(),
        })
    }

    /// Whether it is definite where the given motions are held. Then all its eigenvalues but as many are
    /// above zero: `m` dyads lift no more than `m` of them over a bound (Weyl). That takes one
    /// factorisation, a tenth of the time in which eigenvalues are found.
    fn is_definite_but_for(&self, motions: &DMatrix<f64>) -> bool {
        let mut held = motions.clone();
        for mut motion in held.column_iter_mut() {
            motion.component_div_assign(&self.scale);
            let norm = motion.norm();
            match norm > INDEPENDENT {
                true => motion /= norm,
                // None that these coordinates can tell.
                false => motion.fill(0.0),
            }
        }
        let mut sum = &self.scaled + &held * held.transpose();
        for i in 0..sum.nrows() {
            sum[(i, i)] -= 2.0 * self.zero;
        }
        sum.cholesky().is_some()
    }

    /// How many of its eigenvalues do not count as zero.
    fn rank(&self) -> usize {
        let eigenvalues = self.scaled.symmetric_eigenvalues();
        eigenvalues.iter().filter(|v| v.abs() > self.zero).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Cable, FullyParameterised};
    use crate::formulation::{Continuum, EulerBernoulli};
    use crate::material::SaintVenantKirchhoff;
    use crate::section::Disk;

    /// Whether one factorisation says that no mode is without energy, after eigenvalues were found to say
    /// the same.
    fn definite<E, F, const D: usize, const S: usize>(
        element: &E,
        formulation: &F,
        rigid: usize,
    ) -> Result<bool>
    where
        E: Element<D, S>,
        F: Formulation<f64, E, D, S>,
    {
        let axes = std::array::from_fn(|a| std::array::from_fn(|c| f64::from(u8::from(a == c))));
        let reference = Reference::straight(element, 1.0, axes);
        let motions = rigid_motions::<f64, E, D, S>(&reference, 0);
        assert_eq!(motions.rank(INDEPENDENT), rigid);
        let kernel = formulation.kernel(element, &reference, &Disk::new(0.3)?)?;
        let mut k = [[[[0.0; D]; S]; D]; S];
        kernel.upper_tangent(&[[0.0; D]; S], &mut k);
        mirror(&mut k);
        let stiffness = Stiffness::of::<f64, E, D, S>(&k, &reference, 0)?;
        let definite = stiffness.is_definite_but_for(&motions);
        assert_eq!(definite, stiffness.rank() == S * D - rigid);
        Ok(definite)
    }

    #[test]
    fn held_motions_and_eigenvalues_agree_on_zero_energy_modes() -> Result<()> {
        let rubber = SaintVenantKirchhoff::<f64, 3>::isotropic(1.0, 0.3)?;
        let mut poor = 0;
        for (axial, degree) in (1..6).flat_map(|axial| [1, 3, 5].map(|degree| (axial, degree))) {
            let rule = Continuum::sampled(rubber, axial, degree);
            let definite = definite::<_, _, 3, 8>(&FullyParameterised, &rule, 6)?;
            poor += usize::from(!definite);
        }
        assert!((1..15).contains(&poor), "{poor} of 15 rules leave modes");
        // A cable does not feel that it turns about itself.
        let cable = EulerBernoulli::new(&rubber);
        assert!(definite::<_, _, 3, 4>(&Cable, &cable, 5)?);
        Ok(())
    }
}
