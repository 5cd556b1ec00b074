//! Claims about the band solver, against dense algebra of nalgebra as the independent truth.

use std::ops::Range;
use std::time::Instant;

use ancf::Error;
use ancf::scalar::{Laned, Real, together};
use ancf::solver::{BandMatrix, Factor, Profile};
use nalgebra::{DMatrix, DVector};
use num_dual::Dual64;
use proptest::prelude::*;

/// Reproducible numbers in -1..1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A profile with overlapping ranges of varying length, and gaps between some of them.
fn varied(size: usize, longest: usize, random: &mut Random) -> Profile {
    let mut ranges: Vec<Range<usize>> = Vec::new();
    let mut start = 0;
    while start < size {
        let length = 1 + (random.next().abs() * longest as f64) as usize;
        ranges.push(start..(start + length).min(size));
        start += 1 + (random.next().abs() * length as f64) as usize;
    }
    Profile::from_ranges(size, ranges).unwrap()
}

fn beam(elements: usize, per_node: usize) -> Profile {
    Profile::from_ranges(
        (elements + 1) * per_node,
        (0..elements).map(|e| e * per_node..(e + 2) * per_node),
    )
    .unwrap()
}

/// The symmetric matrix of these entries inside the profile, column by column from the diagonal on.
fn of<R: Real>(profile: &Profile, mut entry: impl FnMut(usize, usize) -> R) -> BandMatrix<R> {
    let mut matrix = BandMatrix::symmetric(profile);
    for j in 0..profile.size() {
        for i in j..=profile.reach()[j] {
            matrix.add(i, j, entry(i, j)).unwrap();
        }
    }
    matrix
}

/// Symmetric random entries inside the profile, `diagonal` added.
fn symmetric(profile: &Profile, diagonal: f64, random: &mut Random) -> BandMatrix<f64> {
    of(profile, |i, j| {
        random.next() + if i == j { diagonal } else { 0.0 }
    })
}

fn dense<R: Real>(matrix: &BandMatrix<R>) -> DMatrix<f64> {
    DMatrix::from_fn(matrix.size(), matrix.size(), |i, j| {
        matrix.get(i, j).value()
    })
}

fn general(profile: &Profile, random: &mut Random) -> BandMatrix<f64> {
    let mut matrix = BandMatrix::general(profile);
    for i in 0..profile.size() {
        for j in 0..profile.size() {
            if profile.contains(i, j) {
                matrix.add(i, j, random.next()).unwrap();
            }
        }
    }
    matrix
}

fn vector(size: usize, random: &mut Random) -> DVector<f64> {
    DVector::from_fn(size, |_, _| random.next())
}

/// Largest residual over the rounding it may have: `|A| |x| + |b|` in rounding units.
fn residual_in_units<R: Real>(matrix: &BandMatrix<R>, x: &[R], b: &[f64]) -> f64 {
    let a = dense(matrix);
    let x = DVector::from_iterator(x.len(), x.iter().map(|x| x.value()));
    let product = &a * &x;
    let floor = a.norm() * x.norm() + DVector::from_row_slice(b).norm();
    let error = (product - DVector::from_row_slice(b)).norm();
    error / (R::EPSILON * floor)
}

fn solved<R: Real>(
    matrix: &BandMatrix<R>,
    symmetric: bool,
    b: &DVector<f64>,
) -> (Vec<R>, Factor<R>) {
    let mut factor = Factor::new(matrix.profile(), symmetric);
    factor.factor(matrix).unwrap();
    let mut x: Vec<R> = b.iter().map(|b| R::lit(*b)).collect();
    factor.solve(&mut x).unwrap();
    (x, factor)
}

fn assert_close(x: &[f64], truth: &DVector<f64>, tolerance: f64) {
    let scale = truth.amax().max(1e-300);
    for (i, (a, b)) in x.iter().zip(truth).enumerate() {
        assert!((a - b).abs() <= tolerance * scale, "x[{i}] = {a}, not {b}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn definite_matrices_are_solved_to_rounding(seed in any::<u64>(), size in 1_usize..70, longest in 1_usize..26) {
        let random = &mut Random(seed);
        let profile = varied(size, longest, random);
        let matrix = symmetric(&profile, 2.0 * longest as f64 + 1.0, random);
        let b = vector(size, random);
        let (x, factor) = solved(&matrix, true, &b);
        prop_assert_eq!(factor.inertia(), Some(0));
        prop_assert!(residual_in_units(&matrix, &x, b.as_slice()) < 4.0);
        assert_close(&x, &dense(&matrix).lu().solve(&b).unwrap(), 1e-13);
    }

    /// Eight matrices at once and one at a time, registers of one and of several numbers: the same bits.
    #[test]
    fn packs_of_matrices_are_solved_as_each_alone(seed in any::<u64>(), size in 1_usize..70, longest in 1_usize..26) {
        let random = &mut Random(seed);
        let profile = varied(size, longest, random);
        let diagonal = 2.0 * longest as f64 + 1.0;
        let alone: Vec<_> = (0..8).map(|_| symmetric(&profile, diagonal, random)).collect();
        let b: Vec<_> = (0..8).map(|_| vector(size, random)).collect();
        let matrix = of(&profile, |i, j| f64::pack(|lane| alone[lane].get(i, j)));
        let packed = together(|| {
            let mut factor = Factor::new(&profile, true);
            factor.factor(&matrix).unwrap();
            let mut x: Vec<_> = (0..size).map(|i| f64::pack(|lane| b[lane][i])).collect();
            factor.solve(&mut x).unwrap();
            x
        })
        .expect("the lanes part");
        for lane in 0..8 {
            let x: Vec<_> = packed.iter().map(|x| f64::unpack(*x, lane)).collect();
            prop_assert_eq!(x, solved(&alone[lane], true, &b[lane]).0);
        }
    }

    /// Registers hold more numbers of single precision than a panel has columns. Copies of factors and of
    /// matrices, which lie elsewhere, are as good.
    #[test]
    fn single_precision_is_solved_to_its_rounding(seed in any::<u64>(), size in 1_usize..70, longest in 1_usize..26) {
        let random = &mut Random(seed);
        let profile = varied(size, longest, random);
        let double = symmetric(&profile, 2.0 * longest as f64 + 1.0, random);
        let matrix = of(&profile, |i, j| double.get(i, j) as f32);
        let b = vector(size, random).map(|b| f64::from(b as f32));
        let (x, factor) = solved(&matrix, true, &b);
        prop_assert!(residual_in_units(&matrix, &x, b.as_slice()) < 4.0);
        let mut copy = factor.clone();
        let mut y: Vec<_> = b.iter().map(|&b| b as f32).collect();
        copy.solve(&mut y).unwrap();
        prop_assert_eq!(&y, &x);
        prop_assert_eq!(solved(&matrix.clone(), true, &b).0, x);
    }

    #[test]
    fn indefinite_matrices_are_solved_to_rounding(seed in any::<u64>(), size in 1_usize..70, longest in 1_usize..26, diagonal in 0.0..3.0) {
        let random = &mut Random(seed);
        let profile = varied(size, longest, random);
        let matrix = symmetric(&profile, diagonal, random);
        let b = vector(size, random);
        let (x, _) = solved(&matrix, true, &b);
        prop_assert!(residual_in_units(&matrix, &x, b.as_slice()) < 500.0);
        let (x, factor) = solved(&matrix, false, &b);
        prop_assert_eq!(factor.inertia(), None);
        prop_assert!(residual_in_units(&matrix, &x, b.as_slice()) < 20.0);
    }

    #[test]
    fn general_matrices_are_solved_to_rounding(seed in any::<u64>(), size in 1_usize..70, longest in 1_usize..26) {
        let random = &mut Random(seed);
        let profile = varied(size, longest, random);
        let mut other = general(&profile, random);
        let matrix = general(&profile, random);
        let b = vector(size, random);
        let (x, mut factor) = solved(&matrix, true, &b);
        prop_assert!(residual_in_units(&matrix, &x, b.as_slice()) < 20.0);
        // A workspace keeps nothing of a matrix that interchanged other rows, or none.
        for share in [0.0, 1.0] {
            (0..size).for_each(|i| other.add(i, i, share * 4.0 * longest as f64).unwrap());
            factor.factor(&other).unwrap();
            factor.factor(&matrix).unwrap();
            let mut again: Vec<f64> = b.iter().copied().collect();
            factor.solve(&mut again).unwrap();
            prop_assert_eq!(&again, &x);
        }
        // The same factors know the transposed matrix and the sign of the determinant.
        let mut y: Vec<f64> = b.iter().copied().collect();
        factor.solve_transposed(&mut y).unwrap();
        let transposed = dense(&matrix).transpose();
        let y = DVector::from_vec(y);
        let rounding = f64::EPSILON * (transposed.norm() * y.norm() + b.norm());
        prop_assert!((&transposed * &y - &b).norm() < 20.0 * rounding);
        prop_assert_eq!(factor.odd(), Some(transposed.determinant() < 0.0));
    }

    #[test]
    fn inertia_counts_the_negative_eigenvalues(seed in any::<u64>(), elements in 1_usize..5, diagonal in 1.0..6.0) {
        let random = &mut Random(seed);
        let matrix = symmetric(&beam(elements, 12), diagonal, random);
        let mut factor = Factor::new(matrix.profile(), true);
        factor.factor(&matrix).unwrap();
        if let Some(negative) = factor.inertia() {
            let eigenvalues = dense(&matrix).symmetric_eigenvalues();
            prop_assert_eq!(negative, eigenvalues.iter().filter(|&&l| l < 0.0).count());
        }
    }
}

/// Diagonals that are large enough for pivots, one by one, and let entries grow where all of them are taken.
#[test]
fn growing_entries_are_eliminated_by_other_pivots() {
    for size in [15, 40, 70] {
        let random = &mut Random(size as u64);
        let profile = Profile::from_ranges(size, [0..size]).unwrap();
        let mut matrix = general(&profile, random);
        for i in 0..size {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            matrix.add(i, i, sign / 16.0 - matrix.get(i, i)).unwrap();
        }
        let b = vector(size, random);
        let (x, _) = solved(&matrix, false, &b);
        let units = residual_in_units(&matrix, &x, b.as_slice());
        assert!(units < 1.0, "{size} unknowns: {units} units");
    }
}

#[test]
fn indefinite_matrices_with_dominant_diagonal_keep_the_cheap_factorisation() {
    let random = &mut Random(7);
    let profile = beam(6, 12);
    let mut matrix = symmetric(&profile, 0.0, random);
    for i in 0..profile.size() {
        let sign = if i % 3 == 1 { -40.0 } else { 40.0 };
        matrix.add(i, i, sign).unwrap();
    }
    let b = vector(profile.size(), random);
    let (x, factor) = solved(&matrix, true, &b);
    assert_eq!(factor.inertia(), Some(profile.size() / 3));
    assert!(residual_in_units(&matrix, &x, b.as_slice()) < 8.0);
}

/// Bars in a row, every second unknown a multiplier with a zero on the diagonal.
fn saddle(nodes: usize, stiffness: f64, order: [usize; 2]) -> BandMatrix<f64> {
    let size = 3 * nodes;
    let profile =
        Profile::from_ranges(size, (0..nodes).map(|n| 3 * n..(3 * n + 6).min(size))).unwrap();
    let mut matrix = BandMatrix::symmetric(&profile);
    for n in 0..nodes {
        let [u, multiplier] = order.map(|k| 3 * n + k);
        let v = 3 * n + 1;
        matrix.add(u, u, 3.0 * stiffness).unwrap();
        matrix.add(v, v, 2.0 * stiffness).unwrap();
        matrix.add(v.max(u), v.min(u), -stiffness).unwrap();
        for (column, value) in [(u, 1.0), (v, -0.5)] {
            let (i, j) = (multiplier.max(column), multiplier.min(column));
            matrix.add(i, j, value).unwrap();
        }
        if n + 1 < nodes {
            matrix.add(3 * n + 3 + order[0], u, -stiffness).unwrap();
        }
    }
    matrix
}

#[test]
fn saddle_points_are_solved_whatever_the_units_and_the_order() {
    for stiffness in [1e-6, 1.0, 1e11] {
        for order in [[0, 2], [2, 0]] {
            let matrix = saddle(15, stiffness, order);
            let b = vector(matrix.size(), &mut Random(3));
            let (x, factor) = solved(&matrix, true, &b);
            assert!(residual_in_units(&matrix, &x, b.as_slice()) < 8.0);
            // A multiplier that comes first is a zero pivot; one that comes last is not, but
            // outgrows its row if the stiffness before it is small against its coefficients.
            let expected = (order == [0, 2] && stiffness >= 1.0).then_some(15);
            assert_eq!(factor.inertia(), expected, "{stiffness} {order:?}");
        }
    }
}

#[test]
fn the_smallest_systems_work() {
    let one = Profile::from_ranges(1, std::iter::once(0..1)).unwrap();
    let mut matrix = BandMatrix::symmetric(&one);
    matrix.add(0, 0, -4.0).unwrap();
    let (x, factor) = solved(&matrix, true, &DVector::from_element(1, 2.0));
    assert_eq!((x[0], factor.inertia()), (-0.5, Some(1)));

    let diagonal = Profile::from_ranges(9, (0..9).map(|i| i..i + 1)).unwrap();
    assert_eq!(diagonal.half_bandwidth(), 0);
    for symmetric in [true, false] {
        let mut matrix = BandMatrix::general(&diagonal);
        if symmetric {
            matrix = BandMatrix::symmetric(&diagonal);
        }
        for i in 0..9 {
            matrix.add(i, i, 2.0_f64.powi(i as i32)).unwrap();
        }
        let (x, _) = solved(&matrix, symmetric, &DVector::from_element(9, 1.0));
        assert!((0..9).all(|i| x[i] == 0.5_f64.powi(i as i32)));
    }
}

#[test]
fn indefinite_matrices_in_single_precision_are_solved_to_their_rounding() {
    let random = &mut Random(11);
    for diagonal in [0.0, 30.0] {
        let double = symmetric(&beam(5, 12), diagonal, random);
        let matrix = of(double.profile(), |i, j| double.get(i, j) as f32);
        let b = vector(double.size(), random).map(|b| f64::from(b as f32));
        let (x, _) = solved(&matrix, true, &b);
        assert!(residual_in_units(&matrix, &x, b.as_slice()) < 50.0);
    }
}

#[test]
fn duals_carry_the_derivative_of_the_solution() {
    // d(A^-1 b) = A^-1 (db - dA A^-1 b), on the path of LDL^T and on that of LU.
    for (diagonal, symmetric_path) in [(40.0, true), (0.0, false)] {
        let random = &mut Random(5);
        let (a, da) = (
            symmetric(&beam(4, 12), diagonal, random),
            symmetric(&beam(4, 12), 0.0, random),
        );
        let (b, db) = (vector(a.size(), random), vector(a.size(), random));
        let matrix = of(a.profile(), |i, j| Dual64::new(a.get(i, j), da.get(i, j)));
        let mut x: Vec<Dual64> = b
            .iter()
            .zip(&db)
            .map(|(&b, &d)| Dual64::new(b, d))
            .collect();
        let mut factor = Factor::new(a.profile(), symmetric_path);
        factor.factor(&matrix).unwrap();
        factor.solve(&mut x).unwrap();
        assert_eq!(factor.inertia().is_some(), symmetric_path);
        let lu = dense(&a).lu();
        let truth = lu.solve(&b).unwrap();
        let slope = lu.solve(&(db - dense(&da) * &truth)).unwrap();
        let (re, eps): (Vec<f64>, Vec<f64>) = x.iter().map(|x| (x.re, x.eps)).unzip();
        assert_close(&re, &truth, 1e-11);
        assert_close(&eps, &slope, 1e-10);
    }
}

#[test]
fn singular_matrices_name_the_unknown() {
    let singular_at = |matrix: &BandMatrix<f64>| {
        let mut factor = Factor::new(matrix.profile(), true);
        let error = factor.factor(matrix).unwrap_err();
        assert!(factor.solve(&mut vec![0.0; matrix.size()]).is_err());
        assert!(error.to_string().contains("supports"), "{error}");
        match error {
            Error::Singular { unknown, .. } => unknown,
            other => panic!("{other}"),
        }
    };
    let profile = beam(4, 3);
    let mut spd = symmetric(&profile, 20.0, &mut Random(1));
    for k in 0..spd.size() {
        let (i, j) = (k.max(7), k.min(7));
        if spd.profile().contains(i, j) {
            spd.add(i, j, -spd.get(i, j)).unwrap();
        }
    }
    assert_eq!(singular_at(&spd), 7);

    // Springs without support: the last one is free to drift with all the others.
    let chain = Profile::from_ranges(20, (0..19).map(|i| i..i + 2)).unwrap();
    let mut springs = BandMatrix::symmetric(&chain);
    for i in 0..19 {
        springs.add_block(i, 2, &[3.7, -3.7, 3.7]).unwrap();
    }
    assert_eq!(singular_at(&springs), 19);

    // The same with a cut: the first half drifts, so its last unknown is the first free one.
    let mut cut = springs.clone();
    cut.add_block(9, 2, &[-3.7, 3.7, -3.7]).unwrap();
    cut.add(19, 19, 1.0).unwrap();
    assert_eq!(singular_at(&cut), 9);
}

#[test]
fn what_is_not_finite_is_refused() {
    for (value, symmetric_path) in [(f64::NAN, true), (f64::INFINITY, true), (f64::NAN, false)] {
        for (i, j) in [(4, 4), (9, 2)] {
            let mut matrix = symmetric(&beam(3, 6), 20.0, &mut Random(2));
            matrix.add(i, j, value).unwrap();
            let error = Factor::new(matrix.profile(), symmetric_path)
                .factor(&matrix)
                .unwrap_err();
            assert!(matches!(error, Error::NotFinite { .. }), "{error}");
        }
    }
}

#[test]
fn bad_input_is_named() {
    assert!(matches!(
        Profile::from_ranges(0, []),
        Err(Error::TooFew { .. })
    ));
    let range = |range| Profile::from_ranges(5, [range]).unwrap_err();
    let (start, end, size) = (3, 6, 5);
    assert_eq!(range(3..6), Error::BadRange { start, end, size });
    assert!(matches!(range(2..2), Error::BadRange { .. }));

    let profile = Profile::from_ranges(6, [0..2, 2..5]).unwrap();
    assert_eq!(profile.reach(), [1, 1, 4, 4, 4, 5]);
    assert_eq!(profile.first(), [0, 0, 2, 2, 2, 5]);
    let mut matrix = BandMatrix::symmetric(&profile);
    let (row, column) = (2, 1);
    let outside = Error::OutsideProfile { row, column };
    assert_eq!(matrix.add(2, 1, 1.0), Err(outside.clone()));
    assert_eq!(matrix.add_block(1, 2, &[1.0; 4]), Err(outside));
    assert!(matrix.add_block(2, 3, &[1.0; 8]).is_err());
    assert!(matrix.add(6, 6, 1.0).is_err());
    assert_eq!(matrix.get(2, 1), 0.0);
    let other = BandMatrix::symmetric(&Profile::from_ranges(6, [0..3, 3..5]).unwrap());
    assert!(matrix.copy_from(&other).is_err());
    assert!(matrix.copy_from(&BandMatrix::general(&profile)).is_err());
    let mut factor = Factor::new(&profile, true);
    assert!(factor.factor(&other).is_err());
    assert!(factor.solve(&mut [1.0; 6]).is_err());
    assert!(matrix.mul_vec(&[1.0; 5], &mut [0.0; 6]).is_err());
}

#[test]
fn assembly_products_and_sums_agree_with_dense_algebra() {
    let random = &mut Random(31);
    let profile = beam(3, 4);
    let x = vector(16, random);
    for general in [false, true] {
        let zero = || match general {
            true => BandMatrix::general(&profile),
            false => BandMatrix::symmetric(&profile),
        };
        let (mut full, mut packed, mut entries) = (zero(), zero(), zero());
        let mut truth = DMatrix::zeros(16, 16);
        for e in 0..3 {
            let half = DMatrix::from_fn(8, 8, |_, _| random.next());
            let block = &half + half.transpose();
            let lower: Vec<f64> = (0..8)
                .flat_map(|i| (0..=i).map(move |j| (i, j)))
                .map(|index| block[index])
                .collect();
            full.add_block(4 * e, 8, block.as_slice()).unwrap();
            packed.add_block(4 * e, 8, &lower).unwrap();
            for i in 0..8 {
                for j in 0..8 {
                    entries.add(4 * e + i, 4 * e + j, block[(i, j)]).unwrap();
                }
            }
            let mut view = truth.view_mut((4 * e, 4 * e), (8, 8));
            view += block;
        }
        for matrix in [&full, &packed, &entries] {
            assert_eq!(dense(matrix), truth);
        }
        let mut y = vec![0.0; 16];
        full.mul_vec(x.as_slice(), &mut y).unwrap();
        assert_close(&y, &(&truth * &x), 1e-15);
        full.abs_mul_vec(x.as_slice(), &mut y).unwrap();
        assert_close(&y, &(truth.abs() * x.abs()), 1e-15);
        packed.scale_add(-0.5, &full).unwrap();
        assert_eq!(dense(&packed), &truth * 0.5);
        packed.copy_from(&full).unwrap();
        assert_eq!(dense(&packed), truth);
        packed.clear();
        assert_eq!(dense(&packed), DMatrix::zeros(16, 16));
    }
}

#[test]
fn cost_is_linear_in_the_number_of_unknowns() {
    let time = |elements: usize| {
        let matrix = symmetric(&beam(elements, 12), 40.0, &mut Random(9));
        let mut factor = Factor::new(matrix.profile(), true);
        let mut x = vec![1.0; matrix.size()];
        (0..20)
            .map(|_| {
                let start = Instant::now();
                factor.factor(&matrix).unwrap();
                factor.solve(&mut x).unwrap();
                start.elapsed()
            })
            .min()
            .unwrap()
            .as_secs_f64()
    };
    // The best of many runs: ten times the unknowns, where quadratic cost would take a hundred.
    let ratio = time(400) / time(40);
    assert!(ratio < 40.0, "{ratio}");
}

/// Taking the right-hand side along is factorising and then solving, to the last bit, whether the matrix
/// is definite, indefinite, in need of pivots or not symmetric.
#[test]
fn factorising_and_solving_at_once_is_one_after_the_other() {
    let random = &mut Random(17);
    let profile = varied(83, 14, random);
    let definite = symmetric(&profile, 40.0, random);
    let dominant = symmetric(&profile, -40.0, random);
    let pivoted = symmetric(&profile, 0.0, random);
    let mut general = BandMatrix::general(&profile);
    for i in 0..profile.size() {
        for j in profile.first()[i]..=profile.reach()[i] {
            general.add(i, j, random.next()).unwrap();
        }
    }
    let b = vector(83, random);
    for (matrix, inertia) in [
        (&definite, Some(0)),
        (&dominant, Some(83)),
        (&pivoted, None),
        (&general, None),
    ] {
        let (expected, apart) = solved(matrix, matrix.is_symmetric(), &b);
        let mut factor = Factor::new(&profile, matrix.is_symmetric());
        let mut x = b.as_slice().to_vec();
        factor.factor_and_solve(matrix, &mut x).unwrap();
        assert_eq!(x, expected);
        assert_eq!([factor.inertia(), apart.inertia()], [inertia; 2]);
        // What is kept solves on.
        let mut x = b.as_slice().to_vec();
        factor.solve(&mut x).unwrap();
        assert_eq!(x, expected);
    }
    let mut factor = Factor::new(&profile, true);
    let short = factor.factor_and_solve(&definite, &mut [0.0; 5]);
    assert!(matches!(short, Err(Error::Length { .. })));
}

/// Lines are zeroed when they are written to: until then, and wherever writing starts, a cleared matrix
/// is zero for every reader.
#[test]
fn a_cleared_matrix_is_a_new_one() {
    let random = &mut Random(5);
    let profile = varied(40, 9, random);
    let block: Vec<f64> = (0..9).map(|k| f64::from(k + 1)).collect();
    // A block of three unknowns that couple.
    let start = (0..37).find(|i| profile.reach()[*i] >= i + 2).unwrap();
    type Write = fn(&mut BandMatrix<f64>, &BandMatrix<f64>, usize, &[f64]);
    let writes: [Write; 4] = [
        |_, _, _, _| {},
        |matrix, _, start, block| matrix.add_block(start, 3, block).unwrap(),
        |matrix, _, start, _| matrix.add(start + 2, start, 3.0).unwrap(),
        |matrix, other, _, _| matrix.scale_add(2.0, other).unwrap(),
    ];
    for full in [symmetric(&profile, 2.0, random), {
        let mut general = BandMatrix::general(&profile);
        for i in 0..40 {
            for j in profile.first()[i]..=profile.reach()[i] {
                general.add(i, j, random.next()).unwrap();
            }
        }
        general
    }] {
        let new = || match full.is_symmetric() {
            true => BandMatrix::symmetric(&profile),
            false => BandMatrix::general(&profile),
        };
        let mut other = full.clone();
        other.clear();
        other.add_block(start, 3, &block).unwrap();
        for write in writes {
            let (mut cleared, mut fresh) = (full.clone(), new());
            cleared.clear();
            write(&mut cleared, &other, start, &block);
            write(&mut fresh, &other, start, &block);
            assert_eq!(dense(&cleared), dense(&fresh));
            let x: Vec<f64> = (0..40).map(|i| f64::from(i) - 7.5).collect();
            let [mut a, mut b] = [vec![0.0; 40], vec![0.0; 40]];
            cleared.mul_vec(&x, &mut a).unwrap();
            fresh.mul_vec(&x, &mut b).unwrap();
            assert_eq!(a, b);
            let mut copy = full.clone();
            copy.copy_from(&cleared).unwrap();
            assert_eq!(dense(&copy), dense(&fresh));
        }
    }
}
