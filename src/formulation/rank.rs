//! Zero-energy modes: a sampling that is too coarse leaves deformations that cost no energy. This
//! room counts them on a stocky reference element (where rank is not blurred by slenderness) and
//! finds the orders that would suffice.

use nalgebra::DMatrix;

use super::{ElementKernel, Formulation, Reference, Tangent};
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
    let rigid = lanes().map(|lane| rigid_modes::<R, E, D, S>(&reference, lane));
    let target = size - rigid.max().unwrap_or(0);
    let rank_of = |trial: &F| -> Result<usize> {
        let kernel = trial.kernel(element, &reference, section)?;
        let (mut q, mut k) = ([[R::zero(); D]; S], [[[[R::zero(); D]; S]; D]; S]);
        kernel.tangent(&[[R::zero(); D]; S], &mut q, &mut k);
        let ranks = lanes().map(|lane| rank::<R, E, D, S>(&k, &reference, lane));
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

/// Number of independent rigid motions the coordinates can tell apart.
pub(crate) fn rigid_modes<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    reference: &Reference<R, D, S>,
    lane: usize,
) -> usize {
    let e = &reference.vectors;
    let per_node = E::VECTORS.len();
    let mut modes = Vec::new();
    for a in 0..D {
        modes.push(DMatrix::from_fn(S * D, 1, |row, _| {
            let position = E::VECTORS[(row / D) % per_node] == NodalVector::Position;
            f64::from(u8::from(position && row % D == a))
        }));
        for b in 0..a {
            modes.push(DMatrix::from_fn(S * D, 1, |row, _| {
                let vector = row / D;
                let unit = unit::<R, E, D, S>(row, reference, lane);
                match row % D {
                    c if c == a => -e[vector][b].lane(lane) / unit,
                    c if c == b => e[vector][a].lane(lane) / unit,
                    _ => 0.0,
                }
            }));
        }
    }
    let columns: Vec<_> = modes.iter().map(|m| m.column(0)).collect();
    DMatrix::from_columns(&columns).rank(1e-8)
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

/// Rank of a tangent at the reference configuration, coordinates scaled to a unit diagonal.
fn rank<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    k: &Tangent<R, D, S>,
    reference: &Reference<R, D, S>,
    lane: usize,
) -> Result<usize> {
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
    if top <= 0.0 {
        return Ok(0);
    }
    let scale = matrix.diagonal().map(|d| {
        if d.abs() > ZERO * top {
            1.0 / d.abs().sqrt()
        } else {
            1.0 / top.sqrt()
        }
    });
    let scaled = DMatrix::from_fn(S * D, S * D, |i, j| scale[i] * matrix[(i, j)] * scale[j]);
    let zero = zero_below::<R>();
    let eigenvalues = scaled.symmetric_eigenvalues();
    Ok(eigenvalues.iter().filter(|v| v.abs() > zero).count())
}
