//! Checks of an element with its elasticity: derivatives, invariance, patch tests and mass, and
//! the zero-energy modes that coarse rules leave. States are compared in units of energy, positions
//! over the length of the element, so that one limit serves slender and stocky beams.

use nalgebra::{DMatrix, SymmetricEigen};

use super::{ByEnergy, ByForce, Limit, Report};
use crate::element::{Element, NodalVector, most};
use crate::error::{Error, Result, positive};
use crate::formulation::{
    Continuum, ElementKernel, Formulation, Reference, Tangent, mirror, rigid_modes,
};
use crate::section::Section;
use crate::tensor::array;

/// Rounding allowed in a force or tangent.
pub(super) const EXACT: f64 = 1e-11;
/// Rounding allowed in an energy of a state without strain: energies formed from invariants near 3, as
/// in the book, round at the unit of the modulus. The force tells what is more than rounding.
const NOTHING: f64 = 1e-14;
/// Checks a formulation on an element of `length` (m) with a section: force and tangent against
/// the energy by dual numbers, positive stiffness at rest, symmetry, what a kernel gives of its own in
/// place of them, no energy in large rigid motions, a force that turns with
/// the state, patch tests of a chain of three elements (constant stretch free to contract, shear
/// and, where the axis is the line of centroids, twist and bending), and the mass matrix against
/// the rigid body's inertia.
///
/// # Errors
/// Those of the formulation and of the section's rules.
pub fn formulation<E, F, X, const D: usize, const S: usize>(
    element: &E,
    formulation: &F,
    section: &X,
    length: f64,
) -> Result<Report>
where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
    X: Section<f64>,
{
    crate::element::check_layout::<E, D, S>()?;
    let length = positive("length of the element [m]", length)?;
    let reference = Reference::straight(element, length, tilted());
    formulation.check(element, section)?;
    let kernel = || formulation.kernel(element, &reference, section);
    let rest = reference.vectors;
    let mut bench = Bench::<_, E, D, S> {
        element: *element,
        kernel: ByForce(kernel()?),
        energy: ByEnergy(kernel()?),
        reference,
        rest,
        stiffness: 1.0,
    };
    bench.stiffness = bench.largest_stiffness();
    let mut report = Report::new(format!("{element:?} in {D} dimensions on {section:?}"));
    bench.derivatives(&mut report);
    bench.invariance(&mut report);
    bench.patches(&mut report, section)?;
    bench.inertia(&mut report, section)?;
    Ok(report)
}

/// Zero-energy modes of a [`Continuum`] beyond the rigid ones, for axial by section orders: a
/// table that informs, with the demand that the finest rule leaves none.
///
/// # Errors
/// Those of the continuum but for the zero-energy modes themselves.
pub fn sampling<E, M, X, const D: usize, const S: usize>(
    element: &E,
    material: &M,
    section: &X,
) -> Result<Report>
where
    E: Element<D, S>,
    M: Clone,
    Continuum<M>: Formulation<f64, E, D, S>,
    X: Section<f64>,
{
    const FINEST: (usize, usize) = (5, 5);
    let mut report = Report::new(format!("{element:?} in {D} dimensions on {section:?}"));
    for axial in 1..=FINEST.0 {
        for degree in (1..=FINEST.1).step_by(2) {
            let rule = Continuum::sampled(material.clone(), axial, degree);
            let modes = match rule.check(element, section) {
                Ok(()) => 0,
                Err(Error::ZeroEnergyModes { modes, .. }) => modes,
                Err(error) => return Err(error),
            };
            let limit = match (axial, degree) {
                FINEST => Limit::AtMost(0.0),
                _ => Limit::None,
            };
            let case = format!("{axial} axial, section degree {degree}");
            report.push("zero-energy modes", case, modes as f64, limit);
        }
    }
    Ok(report)
}

/// A frame out of the global axes, so that components cannot be taken for one another.
pub(super) fn tilted<const D: usize>() -> [[f64; D]; D] {
    turn(
        &std::array::from_fn(|a| std::array::from_fn(|c| if a == c { 1.0 } else { 0.0 })),
        0.7,
    )
}

/// Vectors turned about the normal of the plane and, in space, about another axis as well.
fn turn<const D: usize, const N: usize>(vectors: &[[f64; D]; N], angle: f64) -> [[f64; D]; N] {
    let mut turned = *vectors;
    for v in &mut turned {
        for (a, b, angle) in [(0, 1, angle), (D - 1, 0, 0.6 * angle)] {
            if D == 2 && a == 1 {
                continue;
            }
            let (sin, cos) = f64::sin_cos(angle);
            (v[a], v[b]) = (cos * v[a] - sin * v[b], sin * v[a] + cos * v[b]);
        }
    }
    turned
}

/// An element on trial.
pub(super) struct Bench<K, E, const D: usize, const S: usize> {
    pub(super) element: E,
    /// The kernel on trial, and what dual numbers make of its force and of its energy.
    kernel: ByForce<K>,
    energy: ByEnergy<K>,
    pub(super) reference: Reference<f64, D, S>,
    /// Reference nodal vectors.
    rest: [[f64; D]; S],
    /// Largest entry of the tangent at rest in units of energy (J).
    pub(super) stiffness: f64,
}

pub(super) type Nodal<const D: usize, const S: usize> = [[f64; D]; S];

impl<K, E, const D: usize, const S: usize> Bench<K, E, D, S>
where
    K: ElementKernel<f64, D, S>,
    E: Element<D, S>,
{
    pub(super) fn kernel(&self) -> &K {
        &self.kernel.0
    }

    pub(super) fn has(vector: NodalVector) -> bool {
        E::VECTORS.contains(&vector)
    }

    pub(super) fn vector(i: usize) -> NodalVector {
        E::VECTORS[i % E::VECTORS.len()]
    }

    /// Natural size of a nodal vector.
    pub(super) fn unit(&self, i: usize) -> f64 {
        match Self::vector(i) {
            NodalVector::Position => self.reference.length,
            NodalVector::Slope(_) => 1.0,
        }
    }

    // Kernels are inlined for lanes: here once is enough.
    #[inline(never)]
    pub(super) fn force(&self, u: &Nodal<D, S>) -> Nodal<D, S> {
        let mut q = [[0.0; D]; S];
        self.kernel().force(u, &mut q);
        q
    }

    /// Components in units of energy over the stiffness.
    fn scaled(&self, q: &Nodal<D, S>) -> Vec<f64> {
        let scale = |i: usize| self.unit(i) / self.stiffness;
        (0..S).flat_map(|i| q[i].map(|q| q * scale(i))).collect()
    }

    /// Force and tangent of some kernel in units of energy.
    #[inline(never)]
    pub(super) fn tangent(
        &self,
        kernel: &impl ElementKernel<f64, D, S>,
        u: &Nodal<D, S>,
    ) -> (Vec<f64>, DMatrix<f64>) {
        let mut q = [[0.0; D]; S];
        let mut k = [[[[0.0; D]; S]; D]; S];
        kernel.tangent(u, &mut q, &mut k);
        let unit = |row: usize| self.unit(row / D);
        let k = k.as_flattened().as_flattened().as_flattened();
        let k = DMatrix::from_fn(S * D, S * D, |i, j| {
            k[i * S * D + j] * unit(i) * unit(j) / self.stiffness
        });
        (self.scaled(&q), k)
    }

    fn largest_stiffness(&self) -> f64 {
        let k = self.tangent(self.kernel(), &[[0.0; D]; S]).1.amax();
        if k > 0.0 { k } else { f64::NAN }
    }

    /// A state without symmetry.
    fn state(&self, size: f64) -> Nodal<D, S> {
        std::array::from_fn(|i| {
            std::array::from_fn(|c| size * self.unit(i) * ((5 * i + 3 * c + 1) as f64).sin())
        })
    }

    /// The smallest eigenvalue of the tangent at rest, in units of energy, but for as many around zero as
    /// there are rigid motions.
    fn softest(&self) -> f64 {
        let (_, k) = self.tangent(self.kernel(), &[[0.0; D]; S]);
        let size = k.nrows();
        if nan(0.0, &k).is_nan() {
            return f64::NAN;
        }
        let Some(eigen) = SymmetricEigen::try_new(k, f64::EPSILON, 10_000) else {
            return f64::NAN;
        };
        let mut values: Vec<f64> = eigen.eigenvalues.iter().copied().collect();
        values.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let rigid = rigid_modes::<f64, E, D, S>(&self.reference, 0).min(size);
        let rest = values[rigid..].iter().copied();
        rest.reduce(f64::min).unwrap_or(f64::NAN)
    }

    /// What assembly and energy-momentum methods ask for, which a kernel may give by itself.
    fn overridden(&self, report: &mut Report, at: &str, u: &Nodal<D, S>, small: bool) {
        let kernel = self.kernel();
        let flat = |k: &Tangent<f64, D, S>| {
            let k = k.as_flattened().as_flattened().as_flattened();
            DMatrix::from_row_slice(S * D, S * D, k)
        };
        let zero: Tangent<f64, D, S> = [[[[0.0; D]; S]; D]; S];
        let (mut whole, mut upper, mut q) = (zero, zero, [[0.0; D]; S]);
        kernel.tangent(u, &mut q, &mut whole);
        kernel.upper_tangent(u, &mut upper);
        mirror(&mut upper);
        let (whole, upper) = (flat(&whole), flat(&upper));
        let error = nan((&whole - &upper).amax() / whole.amax(), &upper);
        report.push("upper half of the tangent", at, error, Limit::AtMost(EXACT));
        let from: Nodal<D, S> = array(|i| array(|c| -0.5 * u[S - 1 - i][D - 1 - c]));
        let mut secant = [[0.0; D]; S];
        kernel.secant(0.0, &from, u, &mut secant);
        let mut work = 0.0;
        for i in 0..S {
            for c in 0..D {
                work += (u[i][c] - from[i][c]) * secant[i][c];
            }
        }
        let energies = [kernel.energy(&from), kernel.energy(u)];
        let error =
            (work - (energies[1] - energies[0])) / most(energies[0].abs(), energies[1].abs());
        // By default a rule for energies of the fourth degree, which others are where they are small.
        let limit = Limit::AtMost(1e-5);
        if small {
            report.push("work of the secant force", at, error.abs(), limit);
        }
        let (mut own, mut derived) = (zero, zero);
        kernel.secant_tangent(0.0, &from, u, &mut own);
        self.kernel.secant_tangent(0.0, &from, u, &mut derived);
        let (own, derived) = (flat(&own), flat(&derived));
        let error = nan((&own - &derived).amax() / derived.amax(), &own);
        report.push_derivative(
            "tangent of the secant against its gradient",
            at,
            error,
            EXACT,
        );
    }

    fn derivatives(&self, report: &mut Report) {
        report.push(
            "smallest stiffness beyond rigid motions",
            "",
            self.softest(),
            Limit::Above(0.0),
        );
        let force = self.scaled(&self.force(&[[0.0; D]; S]));
        report.push(
            "force of the reference state",
            "",
            largest(&force),
            Limit::AtMost(EXACT),
        );
        for size in [1e-3, 0.1] {
            let u = self.state(size);
            let at = format!("displacements of {size}");
            let (force, k) = self.tangent(self.kernel(), &u);
            let mut gradient = [[0.0; D]; S];
            self.energy.force(&u, &mut gradient);
            let gradient = self.scaled(&gradient);
            let plain = self.scaled(&self.force(&u));
            let error = difference(&plain, &gradient) / largest(&gradient);
            report.push_derivative(
                "force against the gradient of the energy",
                &at,
                error,
                EXACT,
            );
            let error = difference(&force, &plain) / largest(&plain);
            report.push(
                "force that comes with the tangent",
                &at,
                error,
                Limit::AtMost(EXACT),
            );
            let (_, truth) = self.tangent(&self.kernel, &u);
            let error = (&k - &truth).amax() / truth.amax();
            report.push_derivative(
                "tangent against the gradient of the force",
                &at,
                nan(error, &k),
                EXACT,
            );
            let skew = (&k - k.transpose()).amax() / k.amax();
            report.push(
                "symmetry of the tangent",
                &at,
                nan(skew, &k),
                Limit::AtMost(EXACT),
            );
            self.overridden(report, &at, &u, size < 1e-2);
        }
    }

    fn invariance(&self, report: &mut Report) {
        let l = self.reference.length;
        for angle in [0.0, 0.5, 2.0, 40.0] {
            let turned = turn(&self.rest, angle);
            let u: Nodal<D, S> = std::array::from_fn(|i| {
                let shift = match Self::vector(i) {
                    NodalVector::Position => 3.0 * l,
                    NodalVector::Slope(_) => 0.0,
                };
                std::array::from_fn(|c| turned[i][c] - self.rest[i][c] + shift)
            });
            let case = format!("turned by {angle} rad and moved");
            let energy = self.kernel().energy(&u).abs() / self.stiffness;
            report.push(
                "energy of a rigid motion",
                &case,
                energy,
                Limit::AtMost(NOTHING),
            );
            let force = largest(&self.scaled(&self.force(&u)));
            report.push(
                "force of a rigid motion",
                &case,
                force,
                Limit::AtMost(EXACT),
            );

            let u = self.state(0.1);
            let current: Nodal<D, S> =
                std::array::from_fn(|i| std::array::from_fn(|c| self.rest[i][c] + u[i][c]));
            let moved = turn(&current, angle);
            let moved =
                std::array::from_fn(|i| std::array::from_fn(|c| moved[i][c] - self.rest[i][c]));
            let expected = self.scaled(&turn(&self.force(&u), angle));
            let error =
                difference(&self.scaled(&self.force(&moved)), &expected) / largest(&expected);
            report.push("force of a turned state", case, error, Limit::AtMost(EXACT));
        }
    }
}

pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |top, v| most(top, v.abs()))
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |top, (a, b)| most(top, (a - b).abs()))
}

/// `value`, or NaN when the matrix it was measured on is not finite: `amax` passes over NaN.
pub(super) fn nan(value: f64, matrix: &DMatrix<f64>) -> f64 {
    if matrix.iter().all(|v| v.is_finite()) {
        value
    } else {
        f64::NAN
    }
}
