//! Claims about integration rules: the paper's table, exactness to the last digit, sharpness of
//! the degree, positivity, isotropy, derivatives, refusals.

use crate::exact::{Exact, both_units, centred, pairs, ring, units};
use ancf::quadrature::{
    Cubature, MAX_ORDER, annulus, disk_of_radius, disk_order, gauss_from_recurrence,
    gauss_legendre, gauss_legendre_on, gauss_radau, project,
};
use ancf::scalar::Real;
use ancf::section::{Annulus, Disk, Rectangle, Section};
use num_dual::{Dual, Dual64};
use proptest::prelude::*;

/// Prints the worst defect of a family in both units of `both_units` (shown with `--nocapture`)
/// and holds it to a limit in the second.
fn report<R>(family: &str, limit: f64, defects: impl Iterator<Item = [f64; 2]>) {
    let larger = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
    let worst = defects.fold([0.0; 2], larger);
    let number = std::any::type_name::<R>();
    println!(
        "{family} {number}: {:.2} and {:.2} units",
        worst[0], worst[1]
    );
    assert!(worst[1] <= limit, "{family}: {worst:?} units");
}

// ---------------------------------------------------------------- Table 1

/// Points and weights as the table gives them, in twice double precision: rows of r with their
/// w, rows of (q, t), every combination, factor pi/s; the centre of odd rules is listed s times
/// and merged here.
fn table(s: usize) -> Vec<([Exact; 2], Exact)> {
    let number = Exact::from;
    let root = |x: f64| number(x).sqrt();
    let (zero, one) = (number(0.0), number(1.0));
    let (radial, directions): (Vec<(Exact, f64)>, Vec<[Exact; 2]>) = match s {
        1 => (vec![(zero, 1.0)], vec![[one, zero]]),
        2 => {
            let (r, q) = (root(2.0).over(2.0), root(2.0).over(2.0));
            (vec![(r, 0.5), (-r, 0.5)], vec![[q, q], [q, -q]])
        }
        3 => {
            let (r, q, t) = (root(6.0).over(3.0), number(0.5), root(3.0).over(2.0));
            (
                vec![(zero, 0.25), (r, 0.375), (-r, 0.375)],
                vec![[one, zero], [q, t], [q, -t]],
            )
        }
        _ => {
            let r = [number(3.0) + root(3.0), number(3.0) - root(3.0)].map(|x| x.over(6.0).sqrt());
            let t = [number(2.0) + root(2.0), number(2.0) - root(2.0)].map(|x| x.over(4.0).sqrt());
            (
                r.iter().flat_map(|&r| [(r, 0.25), (-r, 0.25)]).collect(),
                vec![[t[1], t[0]], [t[1], -t[0]], [t[0], t[1]], [t[0], -t[1]]],
            )
        }
    };
    let share = Exact::PI.over(s as f64);
    let mut rule = Vec::new();
    let mut centre = zero;
    for &(r, w) in &radial {
        for d in &directions {
            if r.abs() == 0.0 {
                centre = centre + share * number(w);
            } else {
                rule.push((d.map(|d| d * r), share * number(w)));
            }
        }
    }
    if centre.abs() > 0.0 {
        rule.push(([zero; 2], centre));
    }
    rule
}

#[test]
fn the_rules_of_order_one_to_four_are_table_1_digit_for_digit() {
    for s in 1..=4 {
        let (rule, mut listed) = (disk_order::<f64>(s).unwrap(), table(s));
        assert_eq!(rule.len(), listed.len());
        for (x, w) in rule.iter() {
            // Each number is the nearest double to the table's: off by half a unit in the last
            // place at most, with a little room for the arithmetic of the comparison.
            let half = 0.500001 * f64::EPSILON;
            let same = |a: f64, b: Exact| (Exact::from(a) - b).abs() <= half * a.abs();
            let entry =
                |(y, v): &([Exact; 2], Exact)| same(x[0], y[0]) && same(x[1], y[1]) && same(w, *v);
            let found = listed.iter().position(entry);
            let found = found.unwrap_or_else(|| panic!("s = {s}: {x:?} {w} is not in {listed:?}"));
            listed.remove(found);
        }
    }
}

// ---------------------------------------------------------------- exactness

/// Rules that are rounded once stay within one unit of storage; the other limits count the
/// roundings that are left: weights as products of two rounded ones, and the rounded rule of the
/// section that is projected.
fn exactness<R: Real>() {
    report::<R>(
        "Legendre",
        1.0,
        (1..=12).flat_map(|n| {
            let rule = gauss_legendre::<R>(n).unwrap();
            assert_eq!(rule.degree(), 2 * n - 1);
            let defect = move |d| both_units(&rule, [d], Exact::from(1.0).over((d + 1) as f64));
            (0..2 * n).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "Radau",
        1.0,
        (1..=12).flat_map(|n| {
            let rule = gauss_radau::<R>(n).unwrap();
            assert_eq!(rule.degree(), 2 * n - 2);
            let defect = move |d| both_units(&rule, [d], Exact::from(1.0).over((d + 1) as f64));
            (0..2 * n - 1).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "unit disk",
        1.0,
        (1..=12).flat_map(|s| {
            let rule = disk_order::<R>(s).unwrap();
            assert_eq!(rule.degree(), 2 * s - 1);
            let defect = move |e| both_units(&rule, e, ring(e, 1.0, 0.0));
            pairs(2 * s - 1).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "annulus",
        1.0,
        (0..=16).flat_map(|degree| {
            [0.1, 0.5, 0.95].into_iter().flat_map(move |ratio| {
                let ratio = R::lit(ratio);
                let rule = annulus(R::one(), ratio, degree).unwrap();
                assert_eq!(rule.degree(), degree);
                let defect = move |e| both_units(&rule, e, ring(e, 1.0, ratio.value()));
                pairs(degree).map(defect).collect::<Vec<_>>()
            })
        }),
    );
    report::<R>(
        "rectangle",
        3.0,
        (0..=16).flat_map(|degree| {
            let (h, b) = (R::lit(0.7), R::lit(1.9));
            let rule = Rectangle::new(h, b).unwrap().rule(degree).unwrap();
            let (h, b) = (h.value(), b.value());
            let defect =
                move |e: [usize; 2]| both_units(&rule, e, centred(e[0], h) * centred(e[1], b));
            pairs(degree).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "disk of a radius",
        1.0,
        (0..=16).flat_map(|degree| {
            let radius = R::lit(0.0371);
            let rule = Disk::new(radius).unwrap().rule(degree).unwrap();
            let defect = move |e| both_units(&rule, e, ring(e, radius.value(), 0.0));
            pairs(degree).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "disk, projected",
        3.0,
        (0..=16).flat_map(|degree| {
            let radius = R::lit(0.0371);
            let rule = Disk::new(radius).unwrap().planar_rule(degree).unwrap();
            assert_eq!(rule.len(), degree / 2 + 1);
            let defect = move |a| both_units(&rule, [a], ring([a, 0], radius.value(), 0.0));
            (0..=degree | 1).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "annulus, projected",
        3.0,
        (0..=16).flat_map(|degree| {
            let (outer, inner) = (R::lit(0.51), R::lit(0.47));
            let rule = Annulus::new(outer, inner).unwrap();
            let rule = rule.planar_rule(degree).unwrap();
            let defect =
                move |a| both_units(&rule, [a], ring([a, 0], outer.value(), inner.value()));
            (0..=degree | 1).map(defect).collect::<Vec<_>>()
        }),
    );
    report::<R>(
        "rectangle, planar",
        3.0,
        (0..=16).flat_map(|degree| {
            let (h, b) = (R::lit(0.7), R::lit(1.9));
            let rule = Rectangle::new(h, b).unwrap().planar_rule(degree).unwrap();
            let (h, b) = (h.value(), b.value());
            let defect = move |a| both_units(&rule, [a], centred(a, h) * Exact::from(b));
            (0..=degree | 1).map(defect).collect::<Vec<_>>()
        }),
    );
}

#[test]
fn every_rule_is_exact_to_its_degree_in_double_precision() {
    exactness::<f64>();
}

#[test]
fn every_rule_is_exact_to_its_degree_in_single_precision() {
    exactness::<f32>();
}

#[test]
fn the_degree_of_line_and_disk_rules_is_sharp() {
    for n in 1..=8 {
        let rule = gauss_legendre::<f64>(n).unwrap();
        let exact = Exact::from(1.0).over((2 * n + 1) as f64);
        // The defect is 1/(2 n + 1) / binomial(2 n, n)^2: above 1e-10 to n = 8.
        assert!(units(&rule, [2 * n], exact) > 1e4, "Legendre {n}");
        let rule = gauss_radau::<f64>(n).unwrap();
        let exact = Exact::from(1.0).over((2 * n) as f64);
        assert!(units(&rule, [2 * n - 1], exact) > 1e4, "Radau {n}");
    }
    for s in 1..=12 {
        // Re (y + i z)^(2 s) has mean zero on every circle, but is +-r^(2 s) at every point.
        let rule = disk_order::<f64>(s).unwrap();
        let wave = |[y, z]: [f64; 2]| {
            let radius = y.hypot(z);
            radius.powi(2 * s as i32) * (2.0 * s as f64 * z.atan2(y)).cos()
        };
        assert!(s == 1 || rule.integrate(wave).abs() > 1e-2, "disk {s}");
        let missed = pairs(2 * s)
            .filter(|e| e[0] + e[1] == 2 * s)
            .any(|e| units(&rule, e, ring(e, 1.0, 0.0)) > 1e4);
        assert!(missed, "disk {s}");
    }
}

#[test]
fn high_orders_stay_exact() {
    for n in [64, MAX_ORDER] {
        let rule = gauss_legendre::<f64>(n).unwrap();
        for d in [0, 1, n, 2 * n - 1] {
            let defect = units(&rule, [d], Exact::from(1.0).over((d + 1) as f64));
            assert!(defect <= 1.0, "{n} nodes, x^{d}: {defect}");
        }
    }
    let rule = disk_order::<f64>(41).unwrap();
    let defect = units(&rule, [40, 40], ring([40, 40], 1.0, 0.0));
    assert!(defect <= 1.0, "{defect}");
}

// ---------------------------------------------------------------- known rules

#[test]
fn the_projected_disk_is_gauss_chebyshev_of_the_second_kind() {
    for n in 1..=20 {
        let disk = disk_order::<f64>(n).unwrap();
        let rule = project(&disk, 2 * n - 1).unwrap();
        assert_eq!((rule.len(), rule.degree()), (n, 2 * n - 1));
        for k in 1..=n {
            let angle = (n + 1 - k) as f64 * std::f64::consts::PI / (n + 1) as f64;
            let (x, w) = (rule.points()[k - 1][0], rule.weights()[k - 1]);
            let weight = 2.0 * std::f64::consts::PI / (n + 1) as f64 * angle.sin().powi(2);
            // The width of the disk is twice the square root of Chebyshev's weight function.
            assert!((x - angle.cos()).abs() < 1e-15, "{n} {k}: {x}");
            assert!((w - weight).abs() < 2e-15, "{n} {k}: {w}");
        }
    }
}

#[test]
fn recurrences_of_other_weights_give_their_rules() {
    // Chebyshev of the first kind: all weights equal, in single precision.
    let n = 9;
    let mut beta = vec![0.25_f32; n];
    beta[0] = std::f32::consts::PI;
    beta[1] = 0.5;
    let rule = gauss_from_recurrence(&vec![0.0; n], &beta).unwrap();
    for (k, ([x], w)) in rule.iter().enumerate() {
        let exact = -((2 * k + 1) as f32 * std::f32::consts::PI / (2 * n) as f32).cos();
        assert!((x - exact).abs() < 3e-7, "{x} {exact}");
        assert!((w - std::f32::consts::PI / n as f32).abs() < 2e-7);
    }
    // Laguerre: weight exp(-x) on the half line, moments are factorials.
    let alpha: Vec<f64> = (0..5).map(|k| (2 * k + 1) as f64).collect();
    let beta: Vec<f64> = (0..5).map(|k| (k * k).max(1) as f64).collect();
    let rule = gauss_from_recurrence(&alpha, &beta).unwrap();
    let moment: f64 = rule.integrate(|[x]| x.powi(9));
    assert!((moment / 362_880.0 - 1.0).abs() < 1e-14);
}

// ---------------------------------------------------------------- positivity, isotropy

#[test]
fn weights_are_positive_and_points_inside() {
    for s in 1..=20 {
        let rule = disk_order::<f32>(s).unwrap();
        assert!(rule.iter().all(|([y, z], w)| w > 0.0 && y.hypot(z) < 1.0));
        let line = gauss_radau::<f32>(s).unwrap();
        assert!(
            line.iter()
                .all(|([x], w)| w > 0.0 && (0.0..1.0).contains(&x))
        );
        let line = gauss_legendre::<f32>(s).unwrap();
        assert!(line.iter().all(|([x], w)| w > 0.0 && 0.0 < x && x < 1.0));
        let tube = annulus(1.0, 0.75_f32, s).unwrap();
        let inside = |[y, z]: [f32; 2]| (0.75..1.0).contains(&y.hypot(z));
        assert!(tube.iter().all(|(x, w)| w > 0.0 && inside(x)));
    }
}

fn quartics_turned(s: usize, angle: f64) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let rule = disk_order::<f64>(s).unwrap();
    let turned = rule.affine([[cos, -sin], [sin, cos]], [0.0; 2]).unwrap();
    (0..=4)
        .map(|a| {
            let f = |[y, z]: [f64; 2]| y.powi(a) * z.powi(4 - a);
            (rule.integrate(f) - turned.integrate(f)).abs()
        })
        .fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn order_three_is_isotropic_for_quartics_and_order_two_is_not(angle in 0.1..1.4_f64) {
        prop_assert!(quartics_turned(3, angle) < 1e-15);
        prop_assert!(quartics_turned(2, angle) > 1e-2);
    }

    #[test]
    fn affine_images_have_the_moments_of_ellipses(a in 0.1..3.0_f64, b in 0.1..3.0_f64) {
        let rule = disk_order::<f64>(3).unwrap();
        let rule = rule.affine([[0.0, -a], [b, 0.0]], [0.5, -2.0]).unwrap();
        let area = std::f64::consts::PI * a * b;
        prop_assert!((rule.integrate(|_| 1.0) / area - 1.0).abs() < 1e-14);
        let second = rule.integrate(|[y, _]| (y - 0.5) * (y - 0.5));
        prop_assert!((second / (area * a * a / 4.0) - 1.0).abs() < 1e-13);
        let second = rule.integrate(|[_, z]| (z + 2.0) * (z + 2.0));
        prop_assert!((second / (area * b * b / 4.0) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn projection_follows_shift_and_scale(shift in -50.0..50.0_f64, scale in 1e-3..1e3_f64) {
        let disk = disk_order::<f64>(4).unwrap();
        let unit = project(&disk, 7).unwrap();
        let moved = disk.affine([[scale, 0.0], [0.0, scale]], [shift * scale, 0.0]).unwrap();
        let moved = project(&moved, 7).unwrap();
        for (([x], v), ([y], w)) in unit.iter().zip(moved.iter()) {
            prop_assert!((y - scale * (x + shift)).abs() < 1e-14 * scale * (1.0 + shift.abs()));
            // Rounding the shifted points costs what the shift exceeds the radius by.
            prop_assert!((w / (scale * scale * v) - 1.0).abs() < 1e-14 * (1.0 + shift.abs()));
        }
    }

    #[test]
    fn intervals_anywhere_have_exact_moments(start in -3.0..3.0_f64, length in 0.1..5.0_f64) {
        let end = start + length;
        let rule = gauss_legendre_on(start, end, 4).unwrap();
        for d in 0..8 {
            let exact = Exact::from(end).powi(d + 1) - Exact::from(start).powi(d + 1);
            let defect = units(&rule, [d], exact.over((d + 1) as f64));
            prop_assert!(defect <= 1.0, "x^{}: {}", d, defect);
        }
    }
}

// ---------------------------------------------------------------- derivatives

#[test]
fn constant_rules_in_duals_have_exact_values_and_no_derivative() {
    for n in 1..=12 {
        let plain = gauss_legendre::<f64>(n).unwrap();
        let dual = gauss_legendre::<Dual64>(n).unwrap();
        for (([x], w), ([y], v)) in plain.iter().zip(dual.iter()) {
            assert_eq!((x, w), (y.re, v.re));
            assert_eq!((y.eps, v.eps), (0.0, 0.0));
        }
        let plain = disk_order::<f64>(n).unwrap();
        let dual = disk_order::<Dual64>(n).unwrap();
        for ((x, w), (y, v)) in plain.iter().zip(dual.iter()) {
            assert_eq!((x, w), (y.map(|y| y.re), v.re));
            assert!(y.iter().all(|y| y.eps == 0.0) && v.eps == 0.0);
        }
    }
}

#[test]
fn gauss_rules_carry_derivatives_of_their_recurrence() {
    // Laguerre with a parameter, weight x^p exp(-x) of unit mass: alpha = 2 k + 1 + p,
    // beta = k (k + p), and the m-th moment is (p + 1) (p + 2) ... (p + m). First and second
    // derivatives by p in nested duals.
    let p = Dual::new(Dual64::new(0.5, 1.0), Dual64::new(1.0, 0.0));
    let (one, n) = (Dual::from_re(Dual64::from_re(1.0)), 5);
    let alpha: Vec<_> = (0..n).map(|k| p + (2 * k + 1) as f64).collect();
    let beta = |k: usize| {
        if k == 0 {
            one
        } else {
            (p + k as f64) * k as f64
        }
    };
    let rule = gauss_from_recurrence(&alpha, &(0..n).map(beta).collect::<Vec<_>>()).unwrap();
    for m in 0..2 * n {
        let exact = (1..=m).fold(one, |product, k| product * (p + k as f64));
        let moment = rule.integrate(|[x]| (0..m).fold(one, |product, _| product * x));
        let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * exact.re.re;
        assert!(near(moment.re.re, exact.re.re), "x^{m}");
        assert!(near(moment.re.eps, exact.re.eps), "x^{m}");
        assert!(near(moment.eps.eps, exact.eps.eps), "x^{m}");
    }
}

#[test]
fn annuli_carry_second_derivatives() {
    // Moments of the annulus between rho and 1: the second derivative of the area by rho is
    // -2 pi, that of the second moment -3 pi rho^2, in nested duals.
    let rho = Dual::new(Dual64::new(0.5, 1.0), Dual64::new(1.0, 0.0));
    let rule = annulus(Dual::from_re(Dual64::from_re(1.0)), rho, 3).unwrap();
    let area = rule.integrate(|_| Dual::from_re(Dual64::from_re(1.0)));
    assert!((area.eps.re + std::f64::consts::PI).abs() < 1e-14);
    assert!((area.eps.eps + 2.0 * std::f64::consts::PI).abs() < 1e-13);
    let second = rule.integrate(|[y, _]| y * y);
    assert!((second.eps.eps + 0.75 * std::f64::consts::PI).abs() < 1e-13);
    let planar = project(&rule, 3).unwrap();
    let second = planar.integrate(|[y]| y * y);
    assert!((second.eps.eps + 0.75 * std::f64::consts::PI).abs() < 1e-13);
}

// ---------------------------------------------------------------- refusals

fn refused<T: std::fmt::Debug>(result: ancf::Result<T>, words: &[&str]) {
    let message = result.expect_err("must be refused").to_string();
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message:?}");
    }
}

#[test]
fn bad_input_is_refused_with_the_value_and_a_remedy() {
    refused(gauss_legendre::<f64>(0), &["is 0", "at least 1"]);
    refused(gauss_radau::<f32>(0), &["is 0", "at least 1"]);
    refused(disk_order::<f64>(0), &["is 0", "at least 1"]);
    refused(gauss_legendre::<f64>(257), &["257", "256", "split"]);
    refused(disk_order::<f64>(usize::MAX), &["18446744073709551615"]);
    refused(annulus(1.0, 0.5, usize::MAX), &["256"]);
    refused(annulus(1.0, f64::NAN, 2), &["inner", "NaN"]);
    refused(annulus(0.0, 1.0, 2), &["outer", "is 0"]);
    refused(annulus(1.0, 1.0, 2), &["inner", "is 1", "(0, outer"]);
    refused(annulus(1.0, 0.0, 2), &["inner", "is 0", "Disk"]);
    refused(annulus(1.0, -0.25, 2), &["-0.25"]);
    refused(disk_of_radius(-0.5, 2), &["radius", "-0.5"]);
    refused(gauss_legendre_on(0.0, f64::INFINITY, 3), &["end", "inf"]);
    refused(gauss_legendre_on(1.0, -1.5, 3), &["-2.5"]);
    refused(gauss_from_recurrence::<f64>(&[], &[]), &["is 0"]);
    refused(
        gauss_from_recurrence(&[0.0], &[1.0, 2.0]),
        &["1 alpha", "2 beta"],
    );
    refused(
        gauss_from_recurrence(&[0.0, 0.0], &[1.0, -2.5]),
        &["beta", "-2.5"],
    );
    refused(
        gauss_from_recurrence(&[f64::NAN], &[1.0]),
        &["alpha", "NaN"],
    );
    refused(
        gauss_from_recurrence(&[1.0, 1.0], &[1.0, 1e-60_f64]),
        &["2 nodes", "separate"],
    );
    let none: [[f64; 2]; 0] = [];
    refused(
        Cubature::new(none.to_vec(), vec![], 1),
        &["is 0", "at least 1"],
    );
    refused(
        Cubature::new(vec![[0.0]], vec![1.0, 2.0], 1),
        &["1 points", "2 weights"],
    );
    refused(Cubature::new(vec![[f64::INFINITY]], vec![1.0], 1), &["inf"]);
    refused(
        Cubature::new(vec![[0.0]], vec![f64::NAN], 1),
        &["weight", "NaN"],
    );
    let disk = disk_order::<f64>(2).unwrap();
    refused(disk.scaled(-3.0), &["-3"]);
    refused(disk.scaled(1e200), &["inf"]);
    refused(
        disk.affine([[1.0, 2.0], [2.0, 4.0]], [0.0; 2]),
        &["determinant", "is 0"],
    );
    refused(
        disk.affine([[1.0, f64::NAN], [0.0, 1.0]], [0.0; 2]),
        &["NaN"],
    );
    refused(project(&disk, 4), &["is 3", "at least 5"]);
    refused(project(&disk, usize::MAX), &["256"]);
    // The three nodes for degree 4 are a rule of degree 5.
    let ring = annulus(1.0, 0.5, 4).unwrap();
    refused(project(&ring, 4), &["is 4", "at least 5"]);
    // Claims a degree that its two different places cannot have.
    let two = Cubature::new(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], vec![1.0; 3], 5).unwrap();
    refused(project(&two, 4), &["3 nodes"]);
    let negative = Cubature::new(vec![[0.0, 0.0], [1.0, 0.0]], vec![1.0, -2.0], 5).unwrap();
    refused(project(&negative, 1), &["1 nodes"]);
}
