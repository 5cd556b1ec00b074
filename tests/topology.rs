//! Claims about the numbering of unknowns and the sparse factorisation: trees, loops and grids are
//! solved to rounding whatever way they are stored, chains stay in their envelope, and signs of
//! pivots count eigenvalues.

use ancf::prelude::*;
use ancf::solver::band::{BandMatrix, Factor, Profile};
use ancf::solver::{Condition, Matrix, Unknowns};
use num_dual::Dual64;

/// Unknowns per node of the networks below.
const NODE: usize = 6;

/// A network of two-node elements.
fn network(nodes: usize, elements: &[[usize; 2]]) -> Unknowns<f64> {
    let held = Vec::<Condition<f64>>::new();
    Unknowns::new(nodes * NODE, held, |tell| {
        for element in elements {
            tell(&element.map(|n| n * NODE..(n + 1) * NODE));
        }
    })
    .unwrap()
}

fn chain(nodes: usize) -> Vec<[usize; 2]> {
    (1..nodes).map(|n| [n - 1, n]).collect()
}

fn ring(nodes: usize) -> Vec<[usize; 2]> {
    (0..nodes).map(|n| [n, (n + 1) % nodes]).collect()
}

fn star(arms: usize, length: usize) -> Vec<[usize; 2]> {
    let arm = |a: usize| {
        (0..length).map(move |k| {
            let outer = 1 + a * length + k;
            [if k == 0 { 0 } else { outer - 1 }, outer]
        })
    };
    (0..arms).flat_map(arm).collect()
}

/// Crossings of `SIDE` lines each way, with nodes between them.
const SIDE: usize = 10;
const BETWEEN: usize = 3;
const GRID: usize = SIDE * SIDE + 2 * SIDE * (SIDE - 1) * BETWEEN;

fn grid() -> Vec<[usize; 2]> {
    let mut elements = Vec::new();
    let mut inner = SIDE * SIDE;
    for n in 0..SIDE * SIDE {
        let right = (n % SIDE + 1 < SIDE).then_some(n + 1);
        let up = (n / SIDE + 1 < SIDE).then_some(n + SIDE);
        for m in right.into_iter().chain(up) {
            let mut last = n;
            for _ in 0..BETWEEN {
                elements.push([last, inner]);
                last = inner;
                inner += 1;
            }
            elements.push([last, m]);
        }
    }
    elements
}

/// A reproducible number between -1 and 1.
fn noise(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6364136223846793005)
        .wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// A definite matrix on the network: squares of random differences, and a little on the diagonal.
fn definite<R: Real>(unknowns: &Unknowns<R>, elements: &[[usize; 2]]) -> Matrix<R> {
    let mut matrix = Matrix::zero(unknowns, true);
    let mut seed = 7;
    for element in elements {
        let places: Vec<usize> = element
            .iter()
            .flat_map(|n| n * NODE..(n + 1) * NODE)
            .collect();
        let rows: Vec<Vec<f64>> = (0..NODE)
            .map(|_| places.iter().map(|_| noise(&mut seed)).collect())
            .collect();
        for (a, i) in places.iter().enumerate() {
            for (b, j) in places.iter().enumerate() {
                let mut sum: f64 = rows.iter().map(|r| r[a] * r[b]).sum();
                if i == j {
                    sum += 0.1;
                }
                matrix.add(*i, *j, R::lit(sum)).unwrap();
            }
        }
    }
    matrix
}

/// Relative residual of a solution with a random right-hand side.
fn residual(factor: &mut Factor<f64>, matrix: &Matrix<f64>) -> f64 {
    let mut seed = 3;
    let b: Vec<f64> = (0..matrix.stored().size())
        .map(|_| noise(&mut seed))
        .collect();
    let mut x = b.clone();
    factor.solve(&mut x).unwrap();
    let mut product = vec![0.0; b.len()];
    matrix.stored().mul_vec(&x, &mut product).unwrap();
    let mut scale = vec![0.0; b.len()];
    matrix.stored().abs_mul_vec(&x, &mut scale).unwrap();
    let gaps = product.iter().zip(&b).zip(&scale);
    gaps.map(|((p, b), s)| (p - b).abs() / s)
        .fold(0.0, f64::max)
}

/// The same matrix in the envelope of its numbering.
fn in_envelope(matrix: &Matrix<f64>) -> (Profile, BandMatrix<f64>) {
    let stored = matrix.stored();
    let reach = stored.profile().reach();
    let ranges = reach.iter().enumerate().map(|(j, r)| j..r + 1);
    let profile = Profile::from_ranges(reach.len(), ranges).unwrap();
    let mut band = BandMatrix::symmetric(&profile);
    for j in 0..reach.len() {
        for i in j..=reach[j] {
            band.add(i, j, stored.get(i, j)).unwrap();
        }
    }
    (profile, band)
}

#[test]
fn networks_are_solved_to_rounding() {
    let cases = [
        ("chain", 60, chain(60), false),
        ("ring", 60, ring(60), false),
        ("star", 151, star(5, 30), true),
        ("grid", GRID, grid(), true),
    ];
    for (name, nodes, elements, sparse) in cases {
        let unknowns = network(nodes, &elements);
        let mut matrix = definite(&unknowns, &elements);
        assert_eq!(matrix.stored().is_sparse(), sparse, "{name}");
        let mut factor = Factor::new(unknowns.profile(), true);
        factor.factor(matrix.stored()).unwrap();
        assert_eq!(factor.inertia(), Some(0), "{name}");
        let error = residual(&mut factor, &matrix);
        assert!(error < 1e-14, "{name}: {error}");
        // Sylvester's law, against the envelope's factor.
        for k in 0..unknowns.coordinates() {
            matrix.add(k, k, -1.5).unwrap();
        }
        factor.factor(matrix.stored()).unwrap();
        let error = residual(&mut factor, &matrix);
        assert!(error < 1e-12, "{name}: {error}");
        let (profile, band) = in_envelope(&matrix);
        let mut envelope = Factor::new(&profile, true);
        envelope.factor(&band).unwrap();
        if let (Some(a), Some(b)) = (factor.inertia(), envelope.inertia()) {
            assert!(a > 0 && a == b, "{name}: {a} {b}");
        }
    }
}

/// A ring numbered from end to end would couple its first unknown with its last: renumbered, it
/// costs about a band of twice the width.
#[test]
fn a_ring_is_numbered_from_both_sides() {
    let nodes = 100;
    let unknowns = network(nodes, &ring(nodes));
    assert!(unknowns.profile().half_bandwidth() < 3 * NODE);
    let straight = network(nodes, &chain(nodes));
    assert!((0..nodes * NODE).eq(straight.free().iter().copied()));
}

/// Where no pivot can be trusted the sparse matrix is factorised with pivoting: zeros all along the
/// diagonal.
#[test]
fn what_needs_pivoting_gets_it() {
    let elements = grid();
    let unknowns = network(GRID, &elements);
    let mut matrix = definite(&unknowns, &elements);
    let stored = matrix.stored();
    assert!(stored.is_sparse());
    let diagonal: Vec<(usize, f64)> = unknowns
        .free()
        .iter()
        .enumerate()
        .map(|(q, i)| (*i, stored.get(q, q)))
        .collect();
    for (i, d) in diagonal {
        matrix.add(i, i, -d).unwrap();
    }
    let mut factor = Factor::new(unknowns.profile(), true);
    factor.factor(matrix.stored()).unwrap();
    assert_eq!(factor.inertia(), None);
    let error = residual(&mut factor, &matrix);
    assert!(error < 1e-12, "{error}");
}

/// Five clamped arms meet in a hub that is pushed out of their plane: it does not turn, so that every
/// arm is a guided cantilever. Solved by sparse blocks.
#[test]
fn a_star_of_beams_shares_its_load() {
    let (radius, young, n) = (1e-3, 2e11, 40);
    let steel = SaintVenantKirchhoff::isotropic(young, 0.0).unwrap();
    let disk = Disk::new(radius).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(steel));
    let mut scene = Scene::<f64, 3>::new();
    let turn = 2.0 * std::f64::consts::PI / 5.0;
    let arms: Vec<Placed> = (0..5)
        .map(|k| {
            let (sin, cos) = (turn * f64::from(k)).sin_cos();
            let arm = beam.clone().straight([0.0; 3], [cos, sin, 0.0], n);
            scene.add(arm).unwrap()
        })
        .collect();
    for arm in &arms {
        scene.clamp(arm.end()).unwrap();
    }
    for arm in &arms[1..] {
        let hub = arms[0].start();
        scene.join(hub, arm.start(), Joint::Rigid).unwrap();
    }
    // A thousandth of the radius: the arms must not feel that they are held at both ends.
    let force = 1e-5;
    scene.force(arms[0].start(), [0.0, 0.0, force]).unwrap();
    let system = scene.assemble().unwrap();
    assert!(Matrix::zero(system.unknowns(), true).stored().is_sparse());
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let [x, y, z] = system.displacement(&state, arms[0].start()).unwrap();
    let bending = young * std::f64::consts::PI * radius.powi(4) / 4.0;
    // Each half of a guided cantilever loses a share 1 / n^2 to linear sections.
    let expected = force / (5.0 * 12.0 * bending) * (1.0 - 1.0 / (n * n) as f64);
    assert!((z / expected - 1.0).abs() < 2e-4, "{z} {expected}");
    assert!(x.abs() < 1e-9 * z && y.abs() < 1e-9 * z);
}

/// The derivative of a solution by a stiffness, against `-A^-1 A' x`.
#[test]
fn sparse_solutions_carry_derivatives() {
    let elements = grid();
    let plain = network(GRID, &elements);
    let unknowns = Unknowns::<Dual64>::new(plain.coordinates(), Vec::new(), |tell| {
        for element in &elements {
            tell(&element.map(|n| n * NODE..(n + 1) * NODE));
        }
    })
    .unwrap();
    let mut matrix = definite(&unknowns, &elements);
    assert!(matrix.stored().is_sparse());
    matrix.add(0, 0, Dual64::new(0.0, 1.0)).unwrap();
    let mut factor = Factor::new(unknowns.profile(), true);
    factor.factor(matrix.stored()).unwrap();
    let mut x = vec![Dual64::from_re(1.0); unknowns.count()];
    factor.solve(&mut x).unwrap();
    let mut real = Factor::new(plain.profile(), true);
    let reference = definite(&plain, &elements);
    real.factor(reference.stored()).unwrap();
    let place = plain.free().iter().position(|i| *i == 0).unwrap();
    let mut slope = vec![0.0; x.len()];
    slope[place] = -x[place].re;
    real.solve(&mut slope).unwrap();
    let size = slope.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
    for (x, s) in x.iter().zip(&slope) {
        assert!((x.eps - s).abs() < 1e-11 * size, "{} {s}", x.eps);
    }
}
