//! Patch tests: a chain of elements whose nodes follow a state of constant stress must be in
//! equilibrium at its inner nodes, whatever the element interpolates in between.

use nalgebra::{DMatrix, DVector};

use super::Report;
use super::formulation::{Bench, EXACT, Nodal, largest, tilted};
use super::report::Limit;
use crate::element::{Element, NodalVector};
use crate::error::Result;
use crate::formulation::ElementKernel;
use crate::section::Section;

/// Elements of the chain.
const CHAIN: usize = 3;

impl<K, E, const D: usize, const S: usize> Bench<K, E, D, S>
where
    K: ElementKernel<f64, D, S>,
    E: Element<D, S>,
{
    /// Force at the inner nodes of a chain whose nodal vectors follow a field given in the
    /// material frame as `(vector, x over the length) -> displacement`; largest component over the
    /// vectors `tested`.
    fn inner_residual(
        &self,
        force: impl Fn(&Nodal<D, S>) -> Nodal<D, S>,
        field: impl Fn(NodalVector, f64) -> [f64; D],
        tested: impl Fn(NodalVector) -> bool,
    ) -> f64 {
        let (per_node, spans) = (E::VECTORS.len(), E::NODES - 1);
        let mut sum = vec![[0.0; D]; (spans * CHAIN + 1) * per_node];
        for n in 0..CHAIN {
            let first = n * spans;
            let u = std::array::from_fn(|i| {
                let x = (first + i / per_node) as f64 / spans as f64;
                self.global(&field(Self::vector(i), x))
            });
            let q = force(&u);
            for i in 0..S {
                for c in 0..D {
                    sum[first * per_node + i][c] += q[i][c] * self.unit(i) / self.stiffness;
                }
            }
        }
        let inner = per_node..sum.len() - per_node;
        let chosen = inner.filter(|&i| tested(Self::vector(i)));
        let components: Vec<f64> = chosen.flat_map(|i| sum[i]).collect();
        largest(&components)
    }

    fn global(&self, v: &[f64; D]) -> [f64; D] {
        let f = &tilted::<D>();
        std::array::from_fn(|c| (0..D).map(|a| f[a][c] * v[a]).sum())
    }

    pub(super) fn patches<X: Section<f64>>(&self, report: &mut Report, section: &X) -> Result<()> {
        let l = self.reference.length;
        let along =
            |a: usize, value: f64| std::array::from_fn(|c| if c == a { value } else { 0.0 });
        for stretch in [-0.1, 0.1] {
            let free = self.free_contraction(stretch);
            let field = |v, x: f64| match v {
                NodalVector::Position => along(0, stretch * l * x),
                NodalVector::Slope(0) => along(0, stretch),
                NodalVector::Slope(a) => along(a, free[a - 1]),
            };
            let residual = self.inner_residual(|u| self.force(u), field, |_| true);
            let case = format!("constant stretch {stretch}");
            report.push("patch test", case, residual, Limit::AtMost(EXACT));
        }
        for a in (1..D).filter(|&a| Self::has(NodalVector::Slope(a))) {
            // The tractions on the flanks of a sheared beam act on cross slopes only.
            let field = |v, x: f64| match v {
                NodalVector::Position => along(a, 0.1 * l * x),
                NodalVector::Slope(0) => along(a, 0.1),
                NodalVector::Slope(_) => [0.0; D],
            };
            let axial = |v| matches!(v, NodalVector::Position | NodalVector::Slope(0));
            let residual = self.inner_residual(|u| self.force(u), field, axial);
            let case = format!("constant shear along X_{a}");
            report.push("patch test", case, residual, Limit::AtMost(EXACT));
        }
        let p = section.properties()?;
        let off = (p.centroid[0].powi(2) + p.centroid[1].powi(2)) * p.area;
        if off > 1e-12 * (p.iyy + p.izz) {
            return Ok(());
        }
        let (_, k) = self.tangent(self.kernel(), &[[0.0; D]; S]);
        let linear = |u: &Nodal<D, S>| -> Nodal<D, S> {
            let u = DVector::from_fn(S * D, |row, _| u[row / D][row % D] / self.unit(row / D));
            let q = &k * u * self.stiffness;
            std::array::from_fn(|i| std::array::from_fn(|c| q[i * D + c] / self.unit(i)))
        };
        for a in 1..D {
            let bent = |v, x: f64| match v {
                NodalVector::Position => along(a, 0.5 * l * x * x),
                NodalVector::Slope(0) => along(a, x),
                NodalVector::Slope(b) if b == a => along(0, -x),
                NodalVector::Slope(_) => [0.0; D],
            };
            let residual = self.inner_residual(linear, bent, |_| true);
            let case = format!("constant curvature along X_{a}");
            report.push("patch test", case, residual, Limit::AtMost(EXACT));
        }
        if D == 3 && (1..D).all(|a| Self::has(NodalVector::Slope(a))) {
            let twisted = |v, x: f64| match v {
                NodalVector::Slope(1) => along(2, x),
                NodalVector::Slope(2) => along(1, -x),
                _ => [0.0; D],
            };
            let residual = self.inner_residual(linear, twisted, |_| true);
            report.push(
                "patch test",
                "constant twist",
                residual,
                Limit::AtMost(EXACT),
            );
        }
        Ok(())
    }

    /// Changes of the cross slopes' lengths that leave a uniformly stretched element without
    /// stress across: Newton's method on the forces that work on them.
    fn free_contraction(&self, stretch: f64) -> Vec<f64> {
        let mut free = vec![0.0; D - 1];
        let axes: Vec<usize> = (1..D)
            .filter(|&a| Self::has(NodalVector::Slope(a)))
            .collect();
        if axes.is_empty() {
            return free;
        }
        let l = self.reference.length;
        for _ in 0..20 {
            let direction = |i: usize| match Self::vector(i) {
                NodalVector::Slope(a) if a > 0 => axes.iter().position(|&b| b == a),
                _ => None,
            };
            let u: Nodal<D, S> = std::array::from_fn(|i| {
                let axial = stretch * l * (i / E::VECTORS.len()) as f64 / (E::NODES - 1) as f64;
                let local = std::array::from_fn(|c| match Self::vector(i) {
                    NodalVector::Position if c == 0 => axial,
                    NodalVector::Slope(0) if c == 0 => stretch,
                    NodalVector::Slope(a) if c == a && a > 0 => free[a - 1],
                    _ => 0.0,
                });
                self.global(&local)
            });
            let (q, k) = self.tangent(self.kernel(), &u);
            let project = DMatrix::from_fn(S * D, axes.len(), |row, j| match direction(row / D) {
                Some(at) if at == j => tilted::<D>()[axes[j]][row % D],
                _ => 0.0,
            });
            let g = project.transpose() * DVector::from_vec(q);
            let h = project.transpose() * k * &project;
            let Some(step) = h.lu().solve(&g) else { break };
            for (j, &a) in axes.iter().enumerate() {
                free[a - 1] -= step[j];
            }
        }
        free
    }
}
