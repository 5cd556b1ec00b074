//! What derivatives cost: force and tangent of one spatial element by closed forms, by dual
//! numbers at every level at which a user may stop writing formulas, and by finite differences.
//! `cargo bench --bench derivatives`; the table is in benches/README.md.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use std::hint::black_box;

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::verify::{ByEnergy, ByForce, ByPoints, ByStress};
use criterion::{Criterion, criterion_group, criterion_main};

type Law = SaintVenantKirchhoff<f64, 3>;
type Nodal = [[f64; 3]; 8];

/// The rules of the table: the paper's 16 points and exact integration with 35.
const RULES: [(&str, usize, usize); 2] = [("reduced", 4, 3), ("full", 5, 5)];

fn kernel<M: Material<f64, 3>>(
    material: M,
    axial: usize,
    degree: usize,
) -> impl ElementKernel<f64, 3, 8> {
    let reference = Reference::straight(
        &FullyParameterised,
        0.1,
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    );
    let disk = Disk::new(0.01).expect("a radius");
    Continuum::sampled(material, axial, degree)
        .kernel(&FullyParameterised, &reference, &disk)
        .expect("a rule of full rank")
}

fn state() -> Nodal {
    std::array::from_fn(|i| std::array::from_fn(|c| 1e-2 * ((3 * i + c + 1) as f64).sin()))
}

/// Times `evaluate`, which adds to a force and a tangent.
fn time(
    c: &mut Criterion,
    quantity: &str,
    way: &str,
    rule: &str,
    mut evaluate: impl FnMut(&Nodal, &mut Nodal, &mut Tangent<f64, 3, 8>),
) {
    let u = state();
    let mut k: Tangent<f64, 3, 8> = [[[[0.0; 3]; 8]; 3]; 8];
    c.bench_function(&format!("{quantity}, {way}, {rule}"), |b| {
        b.iter(|| {
            let mut q = [[0.0; 3]; 8];
            evaluate(black_box(&u), &mut q, &mut k);
            black_box(&k);
            q
        });
    });
}

/// Force and tangent of a kernel as it stands.
fn both(c: &mut Criterion, way: &str, rule: &str, kernel: &impl ElementKernel<f64, 3, 8>) {
    time(c, "force", way, rule, |u, q, _| kernel.force(u, q));
    time(c, "tangent", way, rule, |u, q, k| kernel.tangent(u, q, k));
}

fn central_force(kernel: &impl ElementKernel<f64, 3, 8>, u: &Nodal, q: &mut Nodal) {
    const H: f64 = 6e-6;
    let mut moved = *u;
    for i in 0..8 {
        for c in 0..3 {
            moved[i][c] = u[i][c] + H;
            let plus = kernel.energy(&moved);
            moved[i][c] = u[i][c] - H;
            q[i][c] += (plus - kernel.energy(&moved)) / (2.0 * H);
            moved[i][c] = u[i][c];
        }
    }
}

fn central_tangent(
    kernel: &impl ElementKernel<f64, 3, 8>,
    u: &Nodal,
    q: &mut Nodal,
    k: &mut Tangent<f64, 3, 8>,
) {
    const H: f64 = 6e-6;
    kernel.force(u, q);
    let mut moved = *u;
    for j in 0..8 {
        for d in 0..3 {
            let [mut plus, mut minus] = [[[0.0; 3]; 8]; 2];
            moved[j][d] = u[j][d] + H;
            kernel.force(&moved, &mut plus);
            moved[j][d] = u[j][d] - H;
            kernel.force(&moved, &mut minus);
            moved[j][d] = u[j][d];
            for i in 0..8 {
                for c in 0..3 {
                    k[i][c][j][d] += (plus[i][c] - minus[i][c]) / (2.0 * H);
                }
            }
        }
    }
}

fn derivatives(c: &mut Criterion) {
    let law = Law::isotropic(2.0e7, 0.3).expect("admissible constants");
    for (rule, axial, degree) in RULES {
        let moments = kernel(law, axial, degree);
        both(c, "closed form, section integrated once", rule, &moments);
        let closed = kernel(ByPoints(law), axial, degree);
        both(c, "closed form", rule, &closed);
        let stress = kernel(ByStress(law), axial, degree);
        both(c, "material given by stress", rule, &stress);
        let energy = kernel(ByEnergy(law), axial, degree);
        both(c, "material given by energy", rule, &energy);
        let force = ByForce(kernel(ByPoints(law), axial, degree));
        time(c, "tangent", "element given by force", rule, |u, q, k| {
            force.tangent(u, q, k)
        });
        let bare = ByEnergy(kernel(ByPoints(law), axial, degree));
        both(c, "element given by energy", rule, &bare);
        time(
            c,
            "force",
            "central differences of the energy",
            rule,
            |u, q, _| {
                central_force(&closed, u, q);
            },
        );
        time(
            c,
            "tangent",
            "central differences of the force",
            rule,
            |u, q, k| {
                central_tangent(&closed, u, q, k);
            },
        );
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(1));
    targets = derivatives
}
criterion_main!(benches);
