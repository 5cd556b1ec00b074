//! The description of one beam: element family, section, formulation, axis and density. An axis is
//! straight between two points, or any curve with the frame that the section follows along it.

use std::fmt::{self, Debug};
use std::sync::Arc;

use super::chain::{Body, Chain, Link};
use crate::element::{Element, NodalVector};
use crate::error::{Error, Result, finite, positive};
use crate::formulation::{Formulation, Inertia, Reference};
use crate::scalar::Real;
use crate::section::{Remembered, Section};
use crate::tensor::{cross, dot};

/// Position and material frame at a fraction of the axis.
type Curve<R, const D: usize> = Arc<dyn Fn(R) -> ([R; D], [[R; D]; D]) + Send + Sync>;

/// The axis of a beam in the reference state.
#[derive(Clone)]
enum Axis<R, const D: usize> {
    Straight { from: [R; D], to: [R; D] },
    Curved { length: R, curve: Curve<R, D> },
}

impl<R: Debug, const D: usize> Debug for Axis<R, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Straight { from, to } => write!(f, "straight from {from:?} to {to:?}"),
            Self::Curved { length, .. } => write!(f, "a curve of length {length:?}"),
        }
    }
}

/// A beam before it is placed in a [`Scene`](super::Scene).
#[derive(Debug, Clone)]
pub struct Beam<R, E, F, X, const D: usize> {
    element: E,
    section: X,
    formulation: F,
    axis: Option<(Axis<R, D>, usize)>,
    up: Option<[R; D]>,
    density: Option<R>,
}

/// More elements than any memory holds are a mistake, not a beam.
const MOST_ELEMENTS: usize = 100_000_000;

impl<R: Real, E, F, X, const D: usize> Beam<R, E, F, X, D> {
    /// A beam of this element family, section and formulation; give it a line next.
    pub fn new(element: E, section: X, formulation: F) -> Self {
        Self {
            element,
            section,
            formulation,
            axis: None,
            up: None,
            density: None,
        }
    }

    /// A straight axis between two points (m), divided into `elements` equal elements.
    pub fn straight(mut self, from: [R; D], to: [R; D], elements: usize) -> Self {
        self.axis = Some((Axis::Straight { from, to }, elements));
        self
    }

    /// An axis of any shape, bent or twisted or both, divided into `elements` elements of equal
    /// arc length. `axis` takes the fraction of the arc length, from 0 to 1, to the position (m)
    /// and the orthonormal right-handed material frame: the unit tangent, then the directions of
    /// the section's axes. `length` (m) is the whole arc length. The beam is free of stress in
    /// this shape.
    ///
    /// A kink makes the tangents on its two sides clash: it needs two beams.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(2.0e11, 0.3)?;
    /// let quarter = std::f64::consts::FRAC_PI_2;
    /// let arch = Beam::new(Quadratic, Disk::new(0.01)?, StructuralMechanics::new(&steel))
    ///     .curved(quarter, 8, move |s| {
    ///         let (sin, cos) = (s * quarter).sin_cos();
    ///         ([sin, 1.0 - cos], [[cos, sin], [-sin, cos]])
    ///     });
    /// let mut scene = Scene::<f64, 2>::new();
    /// scene.add(arch)?;
    /// # Ok::<(), ancf::Error>(())
    /// ```
    pub fn curved(
        mut self,
        length: R,
        elements: usize,
        axis: impl Fn(R) -> ([R; D], [[R; D]; D]) + Send + Sync + 'static,
    ) -> Self {
        let curve = Arc::new(axis);
        self.axis = Some((Axis::Curved { length, curve }, elements));
        self
    }

    /// Direction that the section's first axis `y` leans to (it need not be normal to the beam).
    /// Without it the frame is the global one for a beam along `x`, and `y` stays as close to the
    /// global `y` (or `z`, for beams along `y`) as it can. No effect in the plane, where `y` is
    /// the left normal of the axis.
    pub fn up(mut self, direction: [R; D]) -> Self {
        self.up = Some(direction);
        self
    }

    /// Mass density (kg/m^3): needed for dynamics and gravity only.
    pub fn density(mut self, density: R) -> Self {
        self.density = Some(density);
        self
    }

    pub(super) fn place<const S: usize>(self, offset: usize) -> Result<Body<R, D>>
    where
        E: Element<D, S>,
        F: Formulation<R, E, D, S>,
        X: Section<R>,
    {
        let Some((axis, elements)) = &self.axis else {
            return Err(Error::Unsupported {
                what: "a beam without an axis".into(),
                remedy: "call Beam::straight with its two ends, or Beam::curved with its shape",
            });
        };
        let elements = *elements;
        if elements == 0 {
            return Err(Error::TooFew {
                what: "number of elements of a beam",
                value: 0,
                least: 1,
                remedy: "divide the beam into at least one element",
            });
        }
        if elements > MOST_ELEMENTS {
            return Err(Error::OutOfRange {
                what: "number of elements of a beam",
                value: elements as f64,
                range: "[1, 1e8]",
                remedy: "take no more elements than memory holds, of which each asks for a kilobyte and more",
            });
        }
        crate::element::check(&self.element)?;
        let section = &Remembered::new(&self.section);
        self.formulation.check(&self.element, section)?;
        let share = R::one() / R::lit(elements as f64);
        let (chain, frames, length) = match axis {
            Axis::Straight { from, to } => {
                for end in from.iter().chain(to) {
                    finite("coordinate of a beam's end [m]", *end)?;
                }
                let along: [R; D] = std::array::from_fn(|c| to[c] - from[c]);
                let length = positive("length of a beam [m]", norm(&along))?;
                let frame = frame(&along, self.up)?;
                let reference = Reference::straight(&self.element, length * share, frame);
                let start = |n| {
                    let along = length * share * R::lit(n as f64);
                    std::array::from_fn(|c| from[c] + along * frame[0][c])
                };
                let (kernel, link) = self.link(section, reference)?;
                let starts = (0..elements).map(start).collect();
                let parts = (vec![kernel], vec![link]);
                let chain = Chain::new(self.element, parts, starts, offset);
                (chain, vec![frame], length)
            }
            Axis::Curved { length, curve } => {
                let length = positive("length of a beam's axis [m]", *length)?;
                let last = (E::NODES - 1) * elements;
                let mut nodes = Vec::with_capacity(last + 1);
                for n in 0..=last {
                    let s = R::lit(n as f64) / R::lit(last as f64);
                    nodes.push(checked(s, curve(s))?);
                }
                let mut links = Vec::with_capacity(elements);
                let mut kernels = Vec::with_capacity(elements);
                for nodes in nodes.windows(E::NODES).step_by(E::NODES - 1) {
                    let reference = bent(&self.element, length * share, nodes)?;
                    let (kernel, link) = self.link(section, reference)?;
                    kernels.push(kernel);
                    links.push(link);
                }
                let start = |n: usize| nodes[n * (E::NODES - 1)].0;
                let starts = (0..elements).map(start).collect();
                let chain = Chain::new(self.element, (kernels, links), starts, offset);
                (
                    chain,
                    nodes.into_iter().map(|(_, frame)| frame).collect(),
                    length,
                )
            }
        };
        let mass = match self.density {
            Some(density) => {
                let area = section.properties()?.area;
                format!("{:.4e} kg", (density * area * length).largest())
            }
            None => "no mass".into(),
        };
        let description = format!(
            "{elements} elements of {:?}, {:.4e} m long, {mass}\n    section {:?}\n    {:?}",
            self.element,
            length.largest(),
            self.section,
            self.formulation,
        );
        Ok(Body::new(chain, frames, length, description))
    }

    /// Kernel and inertia of one element.
    fn link<const S: usize>(
        &self,
        section: &dyn Section<R>,
        reference: Reference<R, D, S>,
    ) -> Result<(F::Kernel, Link<R, D, S>)>
    where
        E: Element<D, S>,
        F: Formulation<R, E, D, S>,
    {
        let inertia = |density| Inertia::new(&self.element, &reference, section, density);
        let kernel = self
            .formulation
            .kernel(&self.element, &reference, section)?;
        let inertia = self.density.map(inertia).transpose()?;
        Ok((kernel, Link::new(inertia, reference)))
    }
}

/// A node of a curved axis, refused unless it is finite with an orthonormal right-handed frame.
pub(super) fn checked<R: Real, const D: usize>(
    s: R,
    (position, frame): ([R; D], [[R; D]; D]),
) -> Result<([R; D], [[R; D]; D])> {
    for number in position.iter().chain(frame.as_flattened()) {
        finite("coordinate of a beam's axis or frame", *number)?;
    }
    let small = R::lit(16.0 * R::EPSILON.sqrt());
    let unit = |a: usize, b: usize| if a == b { R::one() } else { R::zero() };
    let mut pairs = (0..D).flat_map(|a| (a..D).map(move |b| (a, b)));
    let skew = pairs.any(|(a, b)| (dot(&frame[a], &frame[b]) - unit(a, b)).abs() > small);
    let space = |a: usize| std::array::from_fn(|c| if c < D { frame[a][c] } else { R::zero() });
    let third = match D {
        2 => [R::zero(), R::zero(), R::one()],
        _ => space(2),
    };
    if skew || dot(&cross(&space(0), &space(1)), &third) < R::zero() {
        return Err(Error::Unsupported {
            what: format!(
                "the frame {:?} at the fraction {} of a beam's axis",
                frame.map(|axis| axis.map(Real::value)),
                s.value()
            ),
            remedy: "give the unit tangent and unit directions normal to it and to each other, right-handed",
        });
    }
    Ok((position, frame))
}

/// Reference of one element of a curved axis through its nodes.
fn bent<R: Real, E: Element<D, S>, const D: usize, const S: usize>(
    _element: &E,
    length: R,
    nodes: &[([R; D], [[R; D]; D])],
) -> Result<Reference<R, D, S>> {
    let start = nodes[0].0;
    let span: [R; D] = std::array::from_fn(|c| nodes[E::NODES - 1].0[c] - start[c]);
    let chord = norm(&span) / length;
    // A chord is no longer than its arc, and the chord of a half circle is 2/pi of it.
    if chord > R::lit(1.0 + 16.0 * R::EPSILON.sqrt()) || chord < R::lit(0.6) {
        return Err(Error::OutOfRange {
            what: "distance of the ends of a curved element over its arc length",
            value: chord.value(),
            range: "0.6 to 1",
            remedy: "check that the length given is that of the axis and that the axis takes the fraction of the arc length; on a strongly bent axis take more elements",
        });
    }
    let per_node = E::VECTORS.len();
    let vector = |i: usize| {
        let (position, frame) = &nodes[i / per_node];
        match E::VECTORS[i % per_node] {
            NodalVector::Slope(a) => frame[a],
            NodalVector::Position => std::array::from_fn(|c| position[c] - start[c]),
        }
    };
    Ok(Reference::curved(length, std::array::from_fn(vector)))
}

fn norm<R: Real, const D: usize>(v: &[R; D]) -> R {
    // The largest component is taken out so that no length overflows or underflows.
    let largest = v.iter().fold(R::zero(), |m, c| m.larger(c.abs()));
    if largest.is_zero() {
        return largest;
    }
    let ratio = |c: &R| *c / largest;
    v.iter().map(|c| ratio(c) * ratio(c)).sum::<R>().sqrt() * largest
}

fn unit<R: Real, const D: usize>(v: &[R; D]) -> [R; D] {
    let length = norm(v);
    v.map(|c| c / length)
}

/// Orthonormal frame of a straight beam: along, then across.
fn frame<R: Real, const D: usize>(along: &[R; D], up: Option<[R; D]>) -> Result<[[R; D]; D]> {
    let t = unit(along);
    let mut frame = [[R::zero(); D]; D];
    frame[0] = t;
    if D == 2 {
        frame[1] = std::array::from_fn(|c| if c == 0 { -t[1] } else { t[0] });
        return Ok(frame);
    }
    let axis = |k: usize| std::array::from_fn(|c| if c == k { R::one() } else { R::zero() });
    let steep = t[1].abs() > R::lit(0.9);
    let up = up.unwrap_or_else(|| axis(if steep { 2 } else { 1 }));
    for component in up {
        finite("component of a beam's up direction", component)?;
    }
    let overlap: R = (0..D).map(|c| up[c] * t[c]).sum();
    let across: [R; D] = std::array::from_fn(|c| up[c] - overlap * t[c]);
    let height = norm(&across);
    if height <= norm(&up) * R::lit(1e-6) {
        return Err(Error::Unsupported {
            what: format!(
                "an up direction {:?} that is zero or parallel to the beam",
                up.map(Real::value)
            ),
            remedy: "give a direction across the beam",
        });
    }
    let n = unit(&across);
    frame[1] = n;
    for c in 0..D {
        let (a, b) = ((c + 1) % D, (c + 2) % D);
        frame[2][c] = t[a] * n[b] - t[b] * n[a];
    }
    Ok(frame)
}
