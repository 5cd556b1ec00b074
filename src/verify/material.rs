//! Checks of a material. Its stress must be the gradient of its energy and its elasticity the
//! gradient of its stress: both are taken again by dual numbers, so that closed forms answer to
//! the energy. Objectivity needs no check: laws are functions of the Green-Lagrange strain, which
//! a rotation of the body does not change.

use nalgebra::{DMatrix, SymmetricEigen};

use super::{ByEnergy, ByStress, Limit, Report};
use crate::element::most;
use crate::material::{Blocks, Material, SaintVenantKirchhoff, Tensor};
use crate::scalar::{Algebra, Real};

/// A material without a stiffness of its own: contracted from its elasticity.
#[derive(Debug, Clone)]
struct ByElasticity<M>(M);

impl<R: Real, M: Material<R, D>, const D: usize> Material<R, D> for ByElasticity<M> {
    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T {
        self.0.energy(strain)
    }
    fn elasticity<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Blocks<T, D> {
        self.0.elasticity(strain)
    }
}

/// Largest component of the strains tried: Green-Lagrange strains must stay above -1/2.
const STRAINS: [f64; 2] = [1e-3, 0.1];
/// Strains tried of each size.
const TRIES: usize = 4;

/// Checks any material in `D` dimensions at strains up to 0.1: no energy and no stress in the
/// reference state, positive energy around it, stress and elasticity against the energy by dual
/// numbers (left out where they are dual numbers' own, [`Limit::Derived`]), the symmetries, the moduli of a law that says its elasticity is constant, and a [`stiffness`](Material::stiffness) of its own against the
/// elasticity. Errors are relative to the largest component of what is compared.
pub fn material<R: Real, M: Material<R, D>, const D: usize>(material: &M) -> Report {
    let mut report = Report::new(format!("{material:?}"));
    let exact = 1e3 * R::EPSILON;
    let zero = [[R::zero(); D]; D];
    let tangent = material.elasticity(&zero);
    let modulus = largest(&tangent);
    let energy = material.energy(&zero).value().abs() / modulus;
    report.push(
        "energy of the reference state",
        "",
        energy,
        Limit::AtMost(exact),
    );
    let stress = largest(&material.stress(&zero)) / modulus;
    report.push(
        "stress of the reference state",
        "",
        stress,
        Limit::AtMost(exact),
    );
    let lowest = smallest_modulus(&ByEnergy(material.clone()).elasticity(&zero)) / modulus;
    report.push(
        "smallest modulus over the largest",
        "reference",
        lowest,
        Limit::Above(0.0),
    );
    for size in STRAINS {
        let at = format!("strain {size}");
        let mut worst = [0.0_f64; 6];
        let mut constant = None;
        let mut lowest = f64::INFINITY;
        for k in 0..TRIES {
            let e = strain::<R, D>(size, k);
            let (s, c) = (material.stress(&e), material.elasticity(&e));
            lowest = least(
                lowest,
                material.energy(&e).value() / (modulus * size * size),
            );
            let gradient = ByEnergy(material.clone()).stress(&e);
            let second = ByStress(material.clone()).elasticity(&e);
            let columns = columns::<R, D>(size, k);
            let contracted = ByElasticity(material.clone()).stiffness(&e, &columns);
            let mut own = material.stiffness(&e, &columns);
            for (a, row) in own.iter_mut().enumerate() {
                // Only the upper triangle of blocks is part of the contract.
                row[..a].copy_from_slice(&contracted[a][..a]);
            }
            let error = match material.constant_elasticity() {
                Some(moduli) => Some(difference(&moduli.stress(&e), &s) / largest(&s)),
                // A type that promises moduli of all its materials.
                None => M::CONSTANT.then_some(f64::INFINITY),
            };
            constant = error.map(|error| most(constant.unwrap_or(0.0), error));
            let top = largest(&c);
            for (w, error) in worst.iter_mut().zip([
                difference(&s, &gradient) / largest(&gradient),
                difference(&c, &second) / largest(&second),
                difference(&own, &contracted) / largest(&contracted),
                asymmetry(&s) / largest(&s),
                symmetry(&c, |a, e, b, f| c[e][a][b][f].value()) / top,
                symmetry(&c, |a, e, b, f| c[b][f][a][e].value()) / top,
            ]) {
                *w = most(*w, error);
            }
        }
        report.push(
            "energy over modulus and strain squared",
            &at,
            lowest,
            Limit::Above(0.0),
        );
        for (check, error) in [
            "stress against the gradient of the energy",
            "elasticity against the gradient of the stress",
            "stiffness against the contracted elasticity",
            "symmetry of the stress",
            "minor symmetry of the elasticity",
            "major symmetry of the elasticity",
        ]
        .into_iter()
        .zip(worst)
        {
            match check.contains("against") {
                true => report.push_derivative(check, &at, error, exact),
                false => report.push(check, &at, error, Limit::AtMost(exact)),
            }
        }
        if let Some(error) = constant {
            let check = "constant elasticity against the stress";
            report.push(check, &at, error, Limit::AtMost(exact));
        }
    }
    report
}

/// Checks that the elasticity in the reference state is that of linear elasticity with Young's
/// modulus `young` (Pa) and Poisson ratio `poisson`, in plane stress for `D = 2`.
///
/// # Errors
/// Those of [`SaintVenantKirchhoff::isotropic`] for the constants.
pub fn linear_elasticity<R: Real, M: Material<R, D>, const D: usize>(
    material: &M,
    young: R,
    poisson: R,
) -> crate::Result<Report> {
    let truth = SaintVenantKirchhoff::<R, D>::isotropic(young, poisson)?;
    let zero = [[R::zero(); D]; D];
    let c = truth.elasticity(&zero);
    let error = difference(&material.elasticity(&zero), &c) / largest(&c);
    let mut report = Report::new(format!("{material:?}"));
    let case = format!("E = {:e} Pa, nu = {}", young.value(), poisson.value());
    report.push(
        "elasticity at small strain",
        case,
        error,
        Limit::AtMost(1e3 * R::EPSILON),
    );
    Ok(report)
}

/// Checks that the energy does not care for the direction of the strain: `psi(Q E Q^T)` is
/// `psi(E)` for rotations `Q` of the material frame.
pub fn isotropy<R: Real, M: Material<R, D>, const D: usize>(material: &M) -> Report {
    let mut report = Report::new(format!("{material:?}"));
    for size in STRAINS {
        let mut worst = 0.0_f64;
        for k in 0..TRIES {
            let e = strain::<R, D>(size, k);
            let mut turned = e;
            for (a, b) in [(0, 1), (1, D - 1), (0, D - 1)] {
                if a != b {
                    turned = rotated(&turned, a, b, 0.7 + k as f64);
                }
            }
            let (before, after) = (material.energy(&e), material.energy(&turned));
            worst = most(worst, ((after - before) / before).value().abs());
        }
        let at = format!("strain {size}");
        report.push(
            "energy of a turned strain",
            at,
            worst,
            // Energies formed from invariants near 3 round at the unit of the modulus.
            Limit::AtMost((1e4 + 64.0 / (size * size)) * R::EPSILON),
        );
    }
    report
}

/// `Q E Q^T` with a rotation in the plane of two axes.
fn rotated<R: Real, const D: usize>(
    e: &Tensor<R, D>,
    a: usize,
    b: usize,
    angle: f64,
) -> Tensor<R, D> {
    let (sin, cos) = (R::lit(angle.sin()), R::lit(angle.cos()));
    let mut q = [[R::zero(); D]; D];
    for (i, row) in q.iter_mut().enumerate() {
        row[i] = if i == a || i == b { cos } else { R::one() };
    }
    q[a][b] = -sin;
    q[b][a] = sin;
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let terms = (0..D).flat_map(|k| (0..D).map(move |l| (k, l)));
            terms.map(|(k, l)| q[i][k] * e[k][l] * q[j][l]).sum()
        })
    })
}

/// A symmetric strain with components up to `size`, without any symmetry of its own.
fn strain<R: Real, const D: usize>(size: f64, k: usize) -> Tensor<R, D> {
    let wave = |a: usize, b: usize| ((7 * k + 3 * (a + b) + a * b + 1) as f64 * 1.3).sin();
    std::array::from_fn(|a| std::array::from_fn(|b| R::lit(size * wave(a, b))))
}

/// Columns of some deformation gradient: the stiffness is linear in their products, any will do.
fn columns<R: Real, const D: usize>(size: f64, k: usize) -> Tensor<R, D> {
    std::array::from_fn(|a| {
        std::array::from_fn(|i| {
            let unit = if a == i { 1.0 } else { 0.0 };
            R::lit(unit + size * ((5 * k + 2 * a + 7 * i) as f64).cos())
        })
    })
}

/// The smallest eigenvalue of the elasticity as a map of symmetric tensors.
fn smallest_modulus<R: Real, const D: usize>(c: &Blocks<R, D>) -> f64 {
    let pairs: Vec<(usize, usize)> = (0..D).flat_map(|a| (a..D).map(move |b| (a, b))).collect();
    let weight = |(a, b): (usize, usize)| if a == b { 1.0 } else { 2.0_f64.sqrt() };
    let matrix = DMatrix::from_fn(pairs.len(), pairs.len(), |i, j| {
        let ((a, e), (b, f)) = (pairs[i], pairs[j]);
        weight(pairs[i]) * weight(pairs[j]) * c[a][e][b][f].value()
    });
    if !matrix.iter().all(|v| v.is_finite()) {
        return f64::NAN;
    }
    SymmetricEigen::new(matrix).eigenvalues.min()
}

/// The smaller of two, NaN if either is.
pub(super) fn least(a: f64, b: f64) -> f64 {
    if a <= b || a.is_nan() { a } else { b }
}

/// Arrays of numbers of any depth, seen as one list.
trait Components {
    fn each(&self, f: &mut dyn FnMut(f64));
}

impl<R: Real, const D: usize> Components for Tensor<R, D> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        self.iter().flatten().for_each(|x| f(x.value()));
    }
}

impl<R: Real, const D: usize> Components for Blocks<R, D> {
    fn each(&self, f: &mut dyn FnMut(f64)) {
        self.iter().flatten().for_each(|block| block.each(f));
    }
}

fn largest(x: &impl Components) -> f64 {
    let mut top = 0.0;
    x.each(&mut |v| top = most(top, v.abs()));
    top
}

fn difference<C: Components>(a: &C, b: &C) -> f64 {
    let mut left = Vec::new();
    a.each(&mut |v| left.push(v));
    let (mut worst, mut left) = (0.0, left.into_iter());
    b.each(&mut |v| worst = most(worst, left.next().map_or(f64::NAN, |a| (a - v).abs())));
    worst
}

fn asymmetry<R: Real, const D: usize>(s: &Tensor<R, D>) -> f64 {
    let pairs = (0..D).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs.fold(0.0, |worst, (a, b)| {
        most(worst, (s[a][b] - s[b][a]).value().abs())
    })
}

fn symmetry<R: Real, const D: usize>(
    c: &Blocks<R, D>,
    other: impl Fn(usize, usize, usize, usize) -> f64,
) -> f64 {
    let mut worst = 0.0;
    for n in 0..D * D * D * D {
        let (a, e, b, f) = (n % D, n / D % D, n / D / D % D, n / D / D / D);
        worst = most(worst, (c[a][e][b][f].value() - other(a, e, b, f)).abs());
    }
    worst
}
