//! The description of one straight beam: element family, section, formulation, line and density.

use super::chain::{Body, Chain};
use crate::element::Element;
use crate::error::{Error, Result, finite, positive};
use crate::formulation::{Formulation, Inertia, Reference};
use crate::scalar::Real;
use crate::section::Section;

/// A straight beam before it is placed in a [`Scene`](super::Scene).
#[derive(Debug, Clone)]
pub struct Beam<R, E, F, X, const D: usize> {
    element: E,
    section: X,
    formulation: F,
    line: Option<([R; D], [R; D], usize)>,
    up: Option<[R; D]>,
    density: Option<R>,
}

impl<R: Real, E, F, X, const D: usize> Beam<R, E, F, X, D> {
    /// A beam of this element family, section and formulation; give it a line next.
    pub fn new(element: E, section: X, formulation: F) -> Self {
        Self {
            element,
            section,
            formulation,
            line: None,
            up: None,
            density: None,
        }
    }

    /// A straight axis between two points (m), divided into `elements` equal elements.
    pub fn straight(mut self, from: [R; D], to: [R; D], elements: usize) -> Self {
        self.line = Some((from, to, elements));
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
        let Some((from, to, elements)) = self.line else {
            return Err(Error::Unsupported {
                what: "a beam without an axis".into(),
                remedy: "call Beam::straight with its two ends and the number of elements",
            });
        };
        if elements == 0 {
            return Err(Error::TooFew {
                what: "number of elements of a beam",
                value: 0,
                least: 1,
                remedy: "divide the beam into at least one element",
            });
        }
        for end in from.iter().chain(&to) {
            finite("coordinate of a beam's end [m]", *end)?;
        }
        let along: [R; D] = std::array::from_fn(|c| to[c] - from[c]);
        let length = positive("length of a beam [m]", norm(&along))?;
        let reference = Reference {
            length: length / R::lit(elements as f64),
            frame: frame(&along, self.up)?,
        };
        let kernel = self
            .formulation
            .kernel(&self.element, &reference, &self.section)?;
        let inertia = self
            .density
            .map(|density| Inertia::new(&self.element, &reference, &self.section, density))
            .transpose()?;
        let mass = match self.density {
            Some(density) => {
                let area = self.section.properties()?.area;
                format!("{:.4e} kg", (density * area * length).value())
            }
            None => "no mass".into(),
        };
        let description = format!(
            "{elements} elements of {:?}, {:.4e} m long, {mass}\n    section {:?}\n    {:?}",
            self.element,
            length.value(),
            self.section,
            self.formulation,
        );
        let chain = Chain {
            element: self.element,
            kernel,
            inertia,
            reference,
            from,
            elements,
            offset,
        };
        Ok(Body::new(chain, description))
    }
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
