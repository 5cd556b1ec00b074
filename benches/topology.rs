//! Factorisation of rings, stars and grids of beams as they are stored, against the envelope of the
//! same numbering, and of a chain: `cargo bench --bench topology`.
#![allow(
    missing_docs,
    reason = "criterion's macros define items without documentation"
)]

use ancf::prelude::*;
use ancf::solver::band::{BandMatrix, Profile};
use ancf::solver::{Factor, Matrix};
use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};

type Part = Beam<f64, FullyParameterised, Continuum<SaintVenantKirchhoff<f64, 3>>, Disk<f64>, 3>;

fn part() -> Part {
    let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.3).expect("admissible constants");
    let disk = Disk::new(0.01).expect("a radius");
    Beam::new(FullyParameterised, disk, Continuum::full(rubber)).density(7200.0)
}

fn straight(scene: &mut Scene<f64, 3>, from: [f64; 3], to: [f64; 3], n: usize) -> Placed {
    scene.add(part().straight(from, to, n)).expect("a beam")
}

fn chain() -> Scene<f64, 3> {
    let mut scene = Scene::new();
    straight(&mut scene, [0.0; 3], [20.0, 0.0, 0.0], 200);
    scene
}

fn ring() -> Scene<f64, 3> {
    let turn = 2.0 * std::f64::consts::PI;
    let mut scene = Scene::new();
    let axis = move |s: f64| {
        let (sin, cos) = (s * turn).sin_cos();
        let frame = [[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]];
        ([3.0 * sin, -3.0 * cos, 0.0], frame)
    };
    let beam = scene.add(part().curved(3.0 * turn, 200, axis));
    let beam = beam.expect("a ring");
    let closed = scene.join(beam.start(), beam.end(), Joint::Rigid);
    closed.expect("the ring closes");
    scene
}

fn star() -> Scene<f64, 3> {
    let mut scene = Scene::new();
    let arms: Vec<Placed> = (0..5)
        .map(|k| {
            let (sin, cos) = (1.2566 * f64::from(k)).sin_cos();
            straight(&mut scene, [0.0; 3], [4.0 * cos, 4.0 * sin, 0.0], 40)
        })
        .collect();
    for arm in &arms[1..] {
        let joined = scene.join(arms[0].start(), arm.start(), Joint::Rigid);
        joined.expect("a joint");
    }
    scene
}

fn grid() -> Scene<f64, 3> {
    const SIDE: usize = 10;
    let mut scene = Scene::new();
    let mut crossing: Vec<Option<Node>> = vec![None; SIDE * SIDE];
    let at = |n: usize| [(n % SIDE) as f64, (n / SIDE) as f64, 0.0];
    for n in 0..SIDE * SIDE {
        let right = (n % SIDE + 1 < SIDE).then_some(n + 1);
        let up = (n / SIDE + 1 < SIDE).then_some(n + SIDE);
        for m in right.into_iter().chain(up) {
            let beam = straight(&mut scene, at(n), at(m), 2);
            for (place, node) in [(n, beam.start()), (m, beam.end())] {
                match crossing[place] {
                    None => crossing[place] = Some(node),
                    Some(first) => scene.join(first, node, Joint::Rigid).expect("a joint"),
                }
            }
        }
    }
    scene
}

/// The same matrix in the envelope of its numbering.
fn in_envelope(matrix: &Matrix<f64>) -> (Profile, BandMatrix<f64>) {
    let stored = matrix.stored();
    let reach = stored.profile().reach();
    let ranges = reach.iter().enumerate().map(|(j, r)| j..r + 1);
    let profile = Profile::from_ranges(reach.len(), ranges).expect("ranges");
    let mut band = BandMatrix::symmetric(&profile);
    for j in 0..reach.len() {
        for i in j..=reach[j] {
            band.add(i, j, stored.get(i, j)).expect("in the envelope");
        }
    }
    (profile, band)
}

fn all(c: &mut Criterion) {
    let mut group = c.benchmark_group("factor and solve");
    group.sample_size(20);
    let scenes = [
        ("chain of 200", chain()),
        ("ring of 200", ring()),
        ("star of 5 x 40", star()),
        ("grid of 10 x 10 beams", grid()),
    ];
    for (name, scene) in scenes {
        let system = scene.assemble().expect("a scene");
        let u = system.rest().displacement;
        let mut k = Matrix::zero(system.unknowns(), true);
        system.add_tangent(0.0, 1.0, &u, &mut k).expect("a tangent");
        system.add_mass(4e6, &mut k).expect("the same profile");
        let mut x = vec![0.0; system.unknowns().count()];
        let mut factor = Factor::new(system.unknowns().profile(), true);
        let stored = match k.stored().is_sparse() {
            true => "sparse",
            false => "envelope",
        };
        group.bench_function(BenchmarkId::new(name, stored), |b| {
            b.iter(|| {
                factor.factor(k.stored()).expect("a definite matrix");
                x.fill(1.0);
                factor.solve(&mut x).expect("factors");
            });
        });
        if k.stored().is_sparse() {
            let (profile, band) = in_envelope(&k);
            let mut factor = Factor::new(&profile, true);
            group.bench_function(BenchmarkId::new(name, "in its envelope"), |b| {
                b.iter(|| {
                    factor.factor(&band).expect("a definite matrix");
                    x.fill(1.0);
                    factor.solve(&mut x).expect("factors");
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, all);
criterion_main!(benches);
