//! Where a slender beam's force loses its digits. A beam is bent like a true cantilever, its elastic
//! force taken in a working number type, and every step on the way there redone in a reference type:
//! what is stored, the rule, the strains, the assembly, and the solution of a linear system.

use std::fmt;

use super::{Limit, Report};
use crate::element::{Element, NodalVector, most};
use crate::error::{Error, Result, positive};
use crate::formulation::{ElementKernel, Formulation, Reference, Tangent};
use crate::quadrature::gauss_legendre;
use crate::scalar::{Algebra, Field, Real};
use crate::section::Section;
use crate::solver::{BandMatrix, Factor, Profile};
use crate::tensor::{add_scaled, cross, difference, dot, sum, times};

/// A beam written once for every number type.
///
/// ```
/// use ancf::prelude::*;
/// use ancf::verify::{Parts, Pose, Slender, slender};
///
/// struct Rod;
/// impl Slender<3, 8> for Rod {
///     type Element = FullyParameterised;
///     type Section<R: Real> = Disk<R>;
///     type Formulation<R: Real> = CoMoving<Continuum<SaintVenantKirchhoff<R, 3>>>;
///     fn parts<R: Real>(&self, radius: R, young: R) -> Result<Parts<Self, R, 3, 8>> {
///         let material = SaintVenantKirchhoff::isotropic(young, R::zero())?;
///         let formulation = CoMoving(Continuum::full(material));
///         Ok((FullyParameterised, Disk::new(radius)?, formulation))
///     }
/// }
/// let sweep = Pose::default().sweep([1e-1, 1e-2]);
/// # #[cfg(feature = "double-double")]
/// let study = slender::<f32, ancf::scalar::DoubleDouble, _, 3, 8>(&Rod, &sweep)?;
/// // Most of the digits go where coordinates are stored.
/// # #[cfg(feature = "double-double")]
/// println!("{}", study.report(5.0).into_result()?);
/// # Ok::<(), ancf::Error>(())
/// ```
pub trait Slender<const D: usize, const S: usize>: Sized {
    /// Family of elements.
    type Element: Element<D, S>;
    /// Section, in a number type.
    type Section<R: Real>: Section<R>;
    /// Formulation, in a number type.
    type Formulation<R: Real>: Formulation<R, Self::Element, D, S>;

    /// Whether kernels take total nodal vectors, as [`Textbook`](super::Textbook)'s do, and not
    /// displacements.
    const TOTAL: bool = false;

    /// A beam of this radius (m), or another measure of the section's size, and this Young's modulus
    /// (Pa), by which its bending stiffness is 1 N m^2.
    ///
    /// # Errors
    /// Those of the section and of the material.
    fn parts<R: Real>(&self, radius: R, young: R) -> Result<Parts<Self, R, D, S>>;
}

/// Element, section and formulation of a [`Slender`] beam.
pub type Parts<B, R, const D: usize, const S: usize> = (
    <B as Slender<D, S>>::Element,
    <B as Slender<D, S>>::Section<R>,
    <B as Slender<D, S>>::Formulation<R>,
);

/// A bent beam of unit length and bending stiffness, and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Radius over the length.
    pub slenderness: f64,
    /// Number of elements.
    pub elements: usize,
    /// Rotation (rad) of the bent beam about an axis that is no coordinate axis, or in the plane.
    pub rotation: f64,
    /// Distance of the bent beam from where it was straight, in lengths.
    pub offset: f64,
    /// Slope angle (rad) at the tip; a unit load makes 0.46.
    pub bend: f64,
}

impl Pose {
    /// This pose turned by an angle (rad).
    #[must_use]
    pub fn turned(self, rotation: f64) -> Self {
        Self { rotation, ..self }
    }

    /// This pose at every radius over the length of a list.
    #[must_use]
    pub fn sweep<const N: usize>(self, slenderness: [f64; N]) -> [Self; N] {
        slenderness.map(|slenderness| Self {
            slenderness,
            ..self
        })
    }
}

impl Default for Pose {
    /// Eight elements, radius a hundredth of the length, clamped at the origin, bent by a unit load.
    fn default() -> Self {
        Self {
            slenderness: 1e-2,
            elements: 8,
            rotation: 0.0,
            offset: 0.0,
            bend: 0.46,
        }
    }
}

/// Errors of one pose. All but the last are of the transverse force on the nodes, over the load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlenderRow {
    /// The pose.
    pub pose: Pose,
    /// Error of the force in the working type.
    pub error: f64,
    /// Share of the coordinates as they are stored.
    pub storage: f64,
    /// Share of the kernel's constants: rule, derivatives of shape functions, moduli, section.
    pub rule: f64,
    /// Share of the element's arithmetic: strain, stress, force.
    pub strain: f64,
    /// Share of adding the elements' forces.
    pub assembly: f64,
    /// Relative error of the displacements under a transverse tip load from factorising and solving
    /// with the assembled tangent; infinite where the working type finds it singular.
    pub factorisation: f64,
}

impl SlenderRow {
    /// The shares of the error of the force, with their names.
    #[must_use]
    pub fn shares(&self) -> [(&'static str, f64); 4] {
        [
            ("storage", self.storage),
            ("rule", self.rule),
            ("strain", self.strain),
            ("assembly", self.assembly),
        ]
    }

    /// Where most of the error of the force arises.
    #[must_use]
    pub fn worst(&self) -> &'static str {
        // What is not a number is worse than any; of equals the first.
        let worst = self.shares().into_iter().rev();
        let worst = worst.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        worst.map_or("storage", |(name, _)| name)
    }
}

/// Errors over a sweep of poses; prints as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct SlenderStudy {
    /// Machine epsilon of the working type.
    pub epsilon: f64,
    /// One row for each pose, in the order given.
    pub rows: Vec<SlenderRow>,
}

impl SlenderStudy {
    /// Decimal digits of the working type that the force of a row has lost, not below zero.
    #[must_use]
    pub fn digits_lost(&self, row: &SlenderRow) -> f64 {
        most((row.error / self.epsilon).log10(), 0.0)
    }

    /// A number of every row over the slenderness: what a figure draws.
    pub fn points(&self, number: impl Fn(&SlenderRow) -> f64) -> Vec<[f64; 2]> {
        let rows = self.rows.iter();
        rows.map(|row| [row.pose.slenderness, number(row)])
            .collect()
    }

    /// The verdict: the force of every pose may lose at most this number of digits. The shares inform.
    #[must_use]
    pub fn report(&self, digits: f64) -> Report {
        let mut report = Report::new(format!(
            "Slender beam, machine epsilon {:.1e}",
            self.epsilon
        ));
        for row in &self.rows {
            let p = row.pose;
            let case = format!(
                "R/L = {:.0e}, {} elements, turned by {}, {} lengths away",
                p.slenderness, p.elements, p.rotation, p.offset
            );
            let limit = Limit::AtMost(digits);
            report.push("digits lost", &case, self.digits_lost(row), limit);
            for (what, share) in [
                ("error by storage", row.storage),
                ("error by the rule", row.rule),
                ("error by strains", row.strain),
                ("error by assembly", row.assembly),
                ("error of the solution", row.factorisation),
            ] {
                report.push(what, &case, share, Limit::None);
            }
        }
        report
    }
}

impl fmt::Display for SlenderStudy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "    R/L elements turned  away    error   lost  ")?;
        write!(f, "storage     rule   strain assembly factorisation")?;
        for row in &self.rows {
            let (p, lost) = (row.pose, self.digits_lost(row));
            let (slenderness, n, error) = (p.slenderness, p.elements, row.error);
            write!(
                f,
                "\n{slenderness:7.0e} {n:8} {:6.2} {:5}",
                p.rotation, p.offset
            )?;
            write!(f, " {error:8.1e} {lost:6.1}")?;
            for (_, share) in row.shares() {
                write!(f, " {share:8.1e}")?;
            }
            write!(f, " {:13.1e}", row.factorisation)?;
        }
        Ok(())
    }
}

/// Measures the elastic force of a beam in the working type `W`, `f32` or `f64`, by the reference type
/// `X`, in which models of `W` can be evaluated: `DoubleDouble`, of the feature `double-double`.
///
/// Shares are made by redoing one step at a time in the reference type, on what the step before left:
/// the kernel of `X` on coordinates stored in `W` (storage), the kernel of `W` evaluated in `X` (rule),
/// that kernel in `W` with its forces added in `X` (strain), and added in `W` (assembly).
///
/// # Errors
/// [`Error::TooFew`] for a pose without elements, those of the beam and of the factorisation.
pub fn slender<W, X, B, const D: usize, const S: usize>(
    beam: &B,
    poses: &[Pose],
) -> Result<SlenderStudy>
where
    W: Real,
    X: Real + Algebra<W>,
    B: Slender<D, S>,
{
    let row = |pose: &Pose| {
        let exact = Bent::<X, B, D, S>::new(beam, pose, 1.0)?;
        let working = Bent::<W, B, D, S>::new(beam, pose, 1.0)?;
        let truth = exact.force(&exact.coordinates);
        // What is stored, in both types.
        let single: Vec<[W; D]> = converted(&exact.coordinates);
        let stored: Vec<[X; D]> = converted(&single);
        let at_stored = exact.force(&stored);
        let by_rule = working.force(&stored);
        let mut elements = vec![[X::zero(); D]; stored.len()];
        for n in 0..pose.elements {
            let f = working.element_force(n, &single);
            for (q, f) in elements[Bent::<W, B, D, S>::first(n)..].iter_mut().zip(&f) {
                *q = sum(q, &f.map(|f| X::lit(f.value())));
            }
        }
        let all: Vec<[X; D]> = converted(&working.force(&single));
        let error = |a: &[[X; D]], b: &[[X; D]]| exact.transverse(a, b);
        Ok(SlenderRow {
            pose: *pose,
            error: error(&all, &truth),
            storage: error(&at_stored, &truth),
            rule: error(&by_rule, &at_stored),
            strain: error(&elements, &by_rule),
            assembly: error(&all, &elements),
            factorisation: working.factorisation::<X>(&single)?,
        })
    };
    let rows: Result<Vec<_>> = poses.iter().map(row).collect();
    Ok(SlenderStudy {
        epsilon: W::EPSILON,
        rows: rows?,
    })
}

/// The error of the force in a number type without one more precise, over the slenderness of the poses:
/// how far the forces on two beams are apart, the second three times as long, which rounds every number
/// anew.
///
/// # Errors
/// Those of [`slender`].
pub fn slender_spread<W, B, const D: usize, const S: usize>(
    beam: &B,
    poses: &[Pose],
) -> Result<Vec<[f64; 2]>>
where
    W: Real,
    B: Slender<D, S>,
{
    let error = |pose: &Pose| {
        let bent = |length| Bent::<W, B, D, S>::new(beam, pose, length);
        let (one, three) = (bent(1.0)?, bent(3.0)?);
        let forces = [&one, &three].map(|bent| bent.force(&bent.coordinates));
        let error = one.transverse(&forces[0], &forces[1]);
        Ok([pose.slenderness, error])
    };
    poses.iter().map(error).collect()
}

/// A beam in one number type.
struct Bent<R: Real, B: Slender<D, S>, const D: usize, const S: usize> {
    kernel: <B::Formulation<R> as Formulation<R, B::Element, D, S>>::Kernel,
    /// Nodal vectors, total or less those of the straight beam.
    coordinates: Vec<[R; D]>,
    /// Direction of the load.
    across: [R; D],
    elements: usize,
}

impl<R: Real, B: Slender<D, S>, const D: usize, const S: usize> Bent<R, B, D, S> {
    /// A beam of this length (m) that carries the forces of one of unit length.
    fn new(beam: &B, pose: &Pose, length: f64) -> Result<Self> {
        if pose.elements == 0 {
            return Err(Error::TooFew {
                what: "number of elements of a beam",
                value: 0,
                least: 1,
                remedy: "divide the beam into at least one element",
            });
        }
        crate::element::check_layout::<B::Element, D, S>()?;
        positive("slenderness, radius over length", pose.slenderness)?;
        // The same beam in every type: its measures are numbers of single precision.
        let radius = f64::from(pose.slenderness as f32);
        let (_, section, _) = beam.parts::<f64>(radius, 1.0)?;
        let izz = section.properties()?.izz;
        let young = R::lit(f64::from(izz.recip() as f32));
        let length = R::lit(length);
        let young = young / (length * length);
        let (element, section, formulation) = beam.parts(R::lit(radius) * length, young)?;
        let axes: [[R; D]; D] = std::array::from_fn(|a| unit(a));
        let share = R::one() / R::lit(pose.elements as f64);
        let reference = Reference::straight(&element, share * length, axes);
        let kernel = formulation.kernel(&element, &reference, &section)?;

        let turn = |v: [R; D]| turned(v, R::lit(pose.rotation));
        let (per_node, last) = (B::Element::VECTORS, B::Element::NODES - 1);
        let spacing = share / R::lit(last as f64);
        let angle = |s: R| R::lit(pose.bend) * s * (R::lit(2.0) - s);
        // Towards (6, 7, 6), or (6, 7) in the plane.
        let away: [R; D] = std::array::from_fn(|c| R::lit(if c == 1 { 7.0 } else { 6.0 }));
        let away = times(R::lit(pose.offset) / Field::sqrt(dot(&away, &away)), &away);
        let rule = gauss_legendre::<R>(12)?;
        let (mut coordinates, mut r) = (Vec::new(), [R::zero(); D]);
        for node in 0..=pose.elements * last {
            let s = spacing * R::lit(node as f64);
            let frame = frame::<R, D>(angle(s));
            for vector in per_node {
                let (now, rest) = match *vector {
                    NodalVector::Position => {
                        let now = times(length, &sum(&turn(r), &away));
                        (now, times(s * length, &axes[0]))
                    }
                    NodalVector::Slope(a) => (turn(frame[a]), axes[a]),
                };
                coordinates.push(if B::TOTAL {
                    now
                } else {
                    difference(&now, &rest)
                });
            }
            for ([x], w) in rule.iter() {
                let tangent = self::frame::<R, D>(angle(s + x * spacing))[0];
                add_scaled(&mut r, w * spacing, &tangent);
            }
        }
        Ok(Self {
            kernel,
            coordinates,
            across: turn(unit(1)),
            elements: pose.elements,
        })
    }

    /// Force of one element on its nodal vectors.
    fn element_force<T: Algebra<R>>(&self, n: usize, x: &[[T; D]]) -> [[T; D]; S] {
        let mut q = [[T::zero(); D]; S];
        self.kernel.force(&nodal(Self::first(n), x), &mut q);
        q
    }

    /// Place of an element's first nodal vector.
    fn first(n: usize) -> usize {
        n * (B::Element::NODES - 1) * B::Element::VECTORS.len()
    }

    /// Force of all elements on the nodal vectors, in any type over the kernel's.
    fn force<T: Algebra<R>>(&self, x: &[[T; D]]) -> Vec<[T; D]> {
        let mut q = vec![[T::zero(); D]; x.len()];
        for n in 0..self.elements {
            let f = self.element_force(n, x);
            for (q, f) in q[Self::first(n)..].iter_mut().zip(&f) {
                *q = sum(q, f);
            }
        }
        q
    }

    /// Norm of the transverse part of a difference of forces on the nodes' positions.
    fn transverse(&self, a: &[[R; D]], b: &[[R; D]]) -> f64 {
        let vectors = B::Element::VECTORS;
        let mut square = 0.0;
        for (i, (a, b)) in a.iter().zip(b).enumerate() {
            if vectors[i % vectors.len()] == NodalVector::Position {
                square += dot(&difference(a, b), &self.across).value().powi(2);
            }
        }
        square.sqrt()
    }

    /// Relative error of the displacements of the clamped beam under a transverse tip load, by
    /// factorising and solving in this type a tangent that is the same in both.
    fn factorisation<X: Real>(&self, x: &[[R; D]]) -> Result<f64> {
        let clamped = B::Element::VECTORS.len() * D;
        let n = x.len() * D - clamped;
        let first = |e: usize| Self::first(e) * D;
        let range = |e: usize| first(e).saturating_sub(clamped)..first(e) + S * D - clamped;
        let profile = Profile::from_ranges(n, (0..self.elements).map(range))?;
        let mut matrix = BandMatrix::symmetric(&profile);
        for e in 0..self.elements {
            let mut q = [[R::zero(); D]; S];
            let mut k: Tangent<R, D, S> = [[[[R::zero(); D]; S]; D]; S];
            self.kernel
                .tangent(&nodal(Self::first(e), x), &mut q, &mut k);
            let k = k.as_flattened().as_flattened().as_flattened();
            for (at, k) in k.iter().enumerate() {
                let (i, j) = (first(e) + at / (S * D), first(e) + at % (S * D));
                if i >= clamped && j >= clamped {
                    matrix.add(i - clamped, j - clamped, *k)?;
                }
            }
        }
        let mut precise = BandMatrix::<X>::symmetric(&profile);
        for i in 0..n {
            for j in 0..n {
                let k = matrix.get(i, j).value();
                if k != 0.0 {
                    precise.add(i, j, X::lit(k))?;
                }
            }
        }
        let mut load = vec![R::zero(); n];
        let vectors = B::Element::VECTORS;
        let place = vectors.iter().position(|v| *v == NodalVector::Position);
        let tip = n - clamped + place.unwrap_or(0) * D;
        load[tip..tip + D].copy_from_slice(&self.across);
        let mut truth: Vec<X> = load.iter().map(|q| X::lit(q.value())).collect();
        solve(&precise, &profile, &mut truth)?;
        match solve(&matrix, &profile, &mut load) {
            Err(Error::Singular { .. }) => return Ok(f64::INFINITY),
            solved => solved?,
        }
        let norm = |terms: &mut dyn Iterator<Item = X>| terms.map(|x| x * x).sum::<X>().value();
        let pairs = load.iter().zip(&truth);
        let error = norm(&mut pairs.map(|(u, v)| X::lit(u.value()) - *v));
        Ok((error / norm(&mut truth.iter().copied())).sqrt())
    }
}

fn solve<R: Real>(matrix: &BandMatrix<R>, profile: &Profile, x: &mut [R]) -> Result<()> {
    let mut factor = Factor::new(profile, true);
    factor.factor(matrix)?;
    factor.solve(x)
}

/// The nodal vectors of one element.
fn nodal<T: Copy, const D: usize, const S: usize>(first: usize, x: &[[T; D]]) -> [[T; D]; S] {
    std::array::from_fn(|i| x[first + i])
}

/// Numbers in another type, to double precision.
fn converted<A: Real, B: Real, const D: usize>(vectors: &[[A; D]]) -> Vec<[B; D]> {
    let convert = |v: &[A; D]| v.map(|x| B::lit(x.value()));
    vectors.iter().map(convert).collect()
}

fn unit<R: Real, const D: usize>(axis: usize) -> [R; D] {
    std::array::from_fn(|c| if c == axis { R::one() } else { R::zero() })
}

/// Tangent and section axes of a beam that has turned by an angle in the plane.
fn frame<R: Real, const D: usize>(angle: R) -> [[R; D]; D] {
    let (sin, cos) = (Field::sin(angle), Field::cos(angle));
    std::array::from_fn(|a| {
        let mut axis = unit(a);
        if a < 2 {
            (axis[0], axis[1]) = if a == 0 { (cos, sin) } else { (-sin, cos) };
        }
        axis
    })
}

/// A vector turned in the plane, or about (1, 2, 2) in space.
fn turned<R: Real, const D: usize>(v: [R; D], angle: R) -> [R; D] {
    let (sin, cos) = (Field::sin(angle), Field::cos(angle));
    let space: [R; 3] = std::array::from_fn(|c| if c < D { v[c] } else { R::zero() });
    let axis = match D {
        2 => unit(2),
        _ => [1.0, 2.0, 2.0].map(|c| R::lit(c) / R::lit(3.0)),
    };
    let (normal, along) = (cross(&axis, &space), dot(&axis, &space) * (R::one() - cos));
    std::array::from_fn(|c| cos * space[c] + sin * normal[c] + along * axis[c])
}
