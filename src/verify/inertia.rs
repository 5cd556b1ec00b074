//! Checks of a mass matrix: the fields 1, X_0, X_1, X_2 have the moments of the rigid body.

use nalgebra::{DMatrix, SymmetricEigen};

use super::Report;
use super::formulation::{Bench, EXACT, nan};
use super::report::Limit;
use crate::element::{Element, NodalVector};
use crate::error::Result;
use crate::formulation::{ElementKernel, Inertia};
use crate::section::Section;

impl<K, E, const D: usize, const S: usize> Bench<K, E, D, S>
where
    K: ElementKernel<f64, D, S>,
    E: Element<D, S>,
{
    pub(super) fn inertia<X: Section<f64>>(&self, report: &mut Report, section: &X) -> Result<()> {
        let Inertia { mass, first } = Inertia::new(&self.element, &self.reference, section, 1.0)?;
        let p = section.properties()?;
        let l = self.reference.length;
        let volume = p.area * l;
        let [y, z] = p.centroid;
        // Nodal values of the fields 1, X_0 and X_a, with the integrals of the field and its square.
        let mut fields = vec![
            ("1".to_owned(), None, volume, volume),
            (
                "X_0".into(),
                Some(0),
                volume * l / 2.0,
                volume * l * l / 3.0,
            ),
        ];
        for (a, c, second) in [
            (1, y, p.izz + p.area * y * y),
            (2, z, p.iyy + p.area * z * z),
        ] {
            if a < D && Self::has(NodalVector::Slope(a)) {
                fields.push((format!("X_{a}"), Some(a), volume * c, second * l));
            }
        }
        for (case, axis, mean, square) in fields {
            let nodal: [f64; S] = std::array::from_fn(|i| match (Self::vector(i), axis) {
                (NodalVector::Position, None) => 1.0,
                (NodalVector::Position, Some(0)) => {
                    l * (i / E::VECTORS.len()) as f64 / (E::NODES - 1) as f64
                }
                (NodalVector::Slope(a), Some(b)) if a == b => 1.0,
                _ => 0.0,
            });
            let total: f64 = (0..S).map(|i| first[i] * nodal[i]).sum();
            let twice: f64 = (0..S)
                .flat_map(|i| (0..S).map(move |j| (i, j)))
                .map(|(i, j)| nodal[i] * mass[i][j] * nodal[j])
                .sum();
            let scale = (square * volume).sqrt();
            report.push(
                "first moment of the mass",
                &case,
                (total - mean).abs() / scale,
                Limit::AtMost(EXACT),
            );
            report.push(
                "second moment of the mass",
                &case,
                (twice / square - 1.0).abs(),
                Limit::AtMost(EXACT),
            );
        }
        let scaled = DMatrix::from_fn(S, S, |i, j| mass[i][j] / (mass[i][i] * mass[j][j]).sqrt());
        let skew = (&scaled - scaled.transpose()).amax();
        report.push(
            "symmetry of the mass",
            "",
            nan(skew, &scaled),
            Limit::AtMost(EXACT),
        );
        let lowest = match scaled.iter().all(|v| v.is_finite()) {
            true => SymmetricEigen::new(scaled).eigenvalues.min(),
            false => f64::NAN,
        };
        report.push(
            "smallest eigenvalue of the scaled mass",
            "",
            lowest,
            Limit::Above(0.0),
        );
        Ok(())
    }
}
