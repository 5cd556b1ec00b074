//! Claims about sections given by their outline: moments by Green's theorem, rules by moment
//! fitting, profiles, refusals.

use std::f64::consts::PI;

use crate::exact::{pairs, ring};
use ancf::prelude::*;
use ancf::quadrature::{Cubature, disk_order, gauss_legendre_on};
use num_dual::{Dual, Dual64};
use proptest::prelude::*;

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * b.abs()
}

fn power([y, z]: [f64; 2], [a, b]: [usize; 2]) -> f64 {
    y.powi(a as i32) * z.powi(b as i32)
}

/// Integral of y^a z^b over a rectangle.
fn slab([a, b]: [usize; 2], y: [f64; 2], z: [f64; 2]) -> f64 {
    let side = |n: usize, [from, to]: [f64; 2]| {
        let n = n as i32 + 1;
        (to.powi(n) - from.powi(n)) / f64::from(n)
    };
    side(a, y) * side(b, z)
}

fn polygon(points: &[[f64; 2]]) -> Loop<f64> {
    Loop::polygon(points.iter().copied())
}

fn square(half: f64, [y, z]: [f64; 2]) -> Loop<f64> {
    polygon(&[
        [y - half, z - half],
        [y + half, z - half],
        [y + half, z + half],
        [y - half, z + half],
    ])
}

/// Part of a ring between the angles `-half` and `half`.
fn sector(outer: f64, inner: f64, half: f64) -> Outline<f64> {
    let (sin, cos) = half.sin_cos();
    let at = |r: f64, sign: f64| [r * cos, sign * r * sin];
    let bulge = (half / 2.0).tan();
    let boundary = Loop::start(at(outer, -1.0))
        .arc_to(at(outer, 1.0), bulge)
        .line_to(at(inner, 1.0))
        .arc_to(at(inner, -1.0), -bulge);
    Outline::new(boundary).unwrap()
}

fn tube(outer: f64, inner: f64) -> Outline<f64> {
    Outline::new(Loop::circle([0.0; 2], outer))
        .unwrap()
        .with_hole(Loop::circle([0.0; 2], inner))
        .unwrap()
}

/// Shapes that rules are wanted for, walls down to a thousandth of the height.
fn shapes() -> Vec<Outline<f64>> {
    let teeth = (0..24).map(|k| {
        let (angle, r) = (PI / 12.0 * f64::from(k), if k % 4 < 2 { 1.0 } else { 0.8 });
        [r * angle.cos(), r * angle.sin()]
    });
    let gear = Outline::new(Loop::polygon(teeth)).unwrap();
    vec![
        Outline::new(square(0.5, [3.0, -2.0])).unwrap(),
        i_profile(0.2, 0.1, 0.0085, 0.0056).unwrap(),
        i_profile(1.0, 0.5, 0.02, 0.02).unwrap(),
        c_profile(1.0, 0.5, 0.02, 0.02).unwrap(),
        l_profile(1.0, 0.6, 0.02).unwrap(),
        t_profile(1.0, 0.8, 0.1, 0.02).unwrap(),
        box_profile(1.0, 0.6, 0.02).unwrap(),
        l_profile(1.0, 0.6, 0.001).unwrap(),
        tube(1.0, 0.96),
        sector(1.0, 0.6, 1.0),
        sector(1.0, 0.96, 2.5),
        gear.with_hole(Loop::circle([0.0; 2], 0.3)).unwrap(),
    ]
}

#[test]
fn moments_of_polygons_are_those_of_their_parts() {
    let (h, b, f, w) = (0.2, 0.1, 0.0085, 0.0056);
    let profile = i_profile(h, b, f, w).unwrap();
    for e in pairs(8) {
        let flange = |y: [f64; 2]| slab(e, y, [-b / 2.0, b / 2.0]);
        let web = slab(e, [f - h / 2.0, h / 2.0 - f], [-w / 2.0, w / 2.0]);
        let parts = [
            flange([-h / 2.0, f - h / 2.0]),
            flange([h / 2.0 - f, h / 2.0]),
            web,
        ];
        let size = h * b * power([h / 2.0, b / 2.0], e);
        let moment = profile.moment(e[0], e[1]).unwrap();
        assert!(
            (moment - parts.iter().sum::<f64>()).abs() <= 2e-16 * size,
            "{e:?}"
        );
    }
    // An L away from the origin, given clockwise, with a square hole.
    let corners = [
        [1.0, 1.0],
        [1.0, 4.0],
        [2.0, 4.0],
        [2.0, 2.0],
        [3.0, 2.0],
        [3.0, 1.0],
    ];
    let plate = Outline::new(polygon(&corners)).unwrap();
    let plate = plate.with_hole(square(0.25, [1.5, 1.5])).unwrap();
    for e in pairs(8) {
        let whole = slab(e, [1.0, 3.0], [1.0, 2.0]) + slab(e, [1.0, 2.0], [2.0, 4.0]);
        let exact = whole - slab(e, [1.25, 1.75], [1.25, 1.75]);
        assert!(
            near(plate.moment(e[0], e[1]).unwrap(), exact, 4e-15),
            "{e:?}"
        );
    }
}

/// A triangle against a fine cubature that is built otherwise: a square collapsed on it.
#[test]
fn moments_of_a_slanted_polygon_are_those_of_a_fine_cubature() {
    let [p, q, r] = [[0.3, -0.7], [1.9, 0.4], [-0.6, 1.1]];
    let triangle = Outline::new(polygon(&[p, q, r])).unwrap();
    let line = gauss_legendre_on(0.0, 1.0, 12).unwrap();
    let twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    for e in pairs(10) {
        let (mut sum, mut size) = (0.0, 0.0);
        for ([s], v) in line.iter() {
            for ([t], w) in line.iter() {
                let x = [0, 1].map(|c| p[c] + s * (q[c] - p[c] + t * (r[c] - q[c])));
                sum += v * w * s * twice * power(x, e);
                size += (v * w * s * twice * power(x, e)).abs();
            }
        }
        assert!((triangle.moment(e[0], e[1]).unwrap() - sum).abs() <= 1e-14 * size);
    }
}

#[test]
fn moments_of_arcs_are_those_of_disk_and_ring() {
    for (outer, inner) in [(1.3, 0.0), (1.0, 0.98)] {
        let round = Outline::new(Loop::circle([0.0; 2], outer)).unwrap();
        let round = match inner {
            0.0 => round,
            _ => round.with_hole(Loop::circle([0.0; 2], inner)).unwrap(),
        };
        for e in pairs(12) {
            let exact = ring(e, outer, inner).0;
            let size = ring(e.map(|n| n + n % 2), outer, inner).0;
            let moment = round.moment(e[0], e[1]).unwrap();
            assert!(
                (moment - exact).abs() <= 1e-14 * size / (1.0 - inner),
                "{e:?}"
            );
        }
    }
    // A sector in polar coordinates; bulges above a half circle too.
    for half in [0.2, 1.0, 1.8, 3.0_f64] {
        let shape = sector(1.0, 0.6, half);
        let exact = half * (1.0 - 0.36);
        assert!(near(shape.moment(0, 0).unwrap(), exact, 4e-15));
        let first = 2.0 * half.sin() * (1.0 - 0.6_f64.powi(3)) / 3.0;
        assert!(near(shape.moment(1, 0).unwrap(), first, 2e-14));
        let second = (half - half.sin() * half.cos()) * (1.0 - 0.6_f64.powi(4)) / 4.0;
        assert!(near(shape.moment(0, 2).unwrap(), second, 2e-14));
    }
}

#[test]
fn properties_are_moments_about_the_centroid_wherever_the_origin_is() {
    let angle = l_profile(0.1_f64, 0.06, 0.008).unwrap();
    let own = angle.properties().unwrap();
    assert!(own.centroid.iter().all(|c| c.abs() < 1e-16));
    let part = |h: f64, b: f64, y: f64, z: f64| (h * b, y, z, h, b);
    let parts = [
        part(0.1, 0.008, 0.05, 0.004),
        part(0.008, 0.052, 0.004, 0.034),
    ];
    let area: f64 = parts.iter().map(|p| p.0).sum();
    let cy = parts.iter().map(|p| p.0 * p.1).sum::<f64>() / area;
    let cz = parts.iter().map(|p| p.0 * p.2).sum::<f64>() / area;
    let izz: f64 = parts
        .iter()
        .map(|&(a, y, _, h, _)| a * ((y - cy).powi(2) + h * h / 12.0))
        .sum();
    let iyy: f64 = parts
        .iter()
        .map(|&(a, _, z, _, b)| a * ((z - cz).powi(2) + b * b / 12.0))
        .sum();
    let iyz: f64 = parts
        .iter()
        .map(|&(a, y, z, ..)| a * (y - cy) * (z - cz))
        .sum();
    let far = angle.moved([40.0, -70.0]).unwrap().properties().unwrap();
    for (p, tolerance) in [(own, 1e-14), (far, 1e-11)] {
        assert!(near(p.area, area, tolerance));
        assert!(near(p.izz, izz, tolerance) && near(p.iyy, iyy, tolerance));
        assert!(near(p.iyz, iyz, tolerance));
    }
}

/// Worst error of a rule's moments over `sum |w f|` (or a hundredth of the greatest it could be,
/// for the sake of single points at the centroid), against Green's theorem in double precision.
fn defect<R: Real>(rule: &Cubature<R, 2>, truth: &Outline<f64>, degree: usize) -> f64 {
    let corners = Section::outline(truth, 64);
    let extent = |c: usize| corners[0].iter().fold(0.0, |m: f64, p| m.max(p[c].abs()));
    let (extent, area) = ([0, 1].map(extent), truth.moment(0, 0).unwrap());
    let worst = |e: [usize; 2]| {
        let terms = rule
            .iter()
            .map(|(p, w)| w.value() * power(p.map(Real::value), e));
        let (sum, size) = terms.fold((0.0, 0.0), |(s, a), t| (s + t, a + f64::abs(t)));
        let size = size.max(0.01 * area * power(extent, e));
        (sum - truth.moment(e[0], e[1]).unwrap()).abs() / size
    };
    pairs(degree).map(worst).fold(0.0, f64::max)
}

fn rules_are_positive_inside_small_and_exact(shapes: &[Outline<f64>]) {
    for shape in shapes {
        let area = shape.properties().unwrap().area;
        for degree in [0, 1, 2, 3, 4, 5, 8] {
            let rule = shape.rule(degree).unwrap();
            assert!(rule.len() <= (degree + 1) * (degree + 2) / 2);
            assert!(rule.degree() >= degree);
            assert!(rule.weights().iter().all(|&w| w > 1e-6 * area));
            assert!(rule.points().iter().all(|&p| shape.contains(p)));
            let error = defect(&rule, shape, degree);
            assert!(error < 2e-15, "degree {degree}: {error:e} for {shape:?}");
            // The degree is not reached by accident of the test: the next is not exact.
            assert!(defect(&rule, shape, 2 * degree + 2) > 1e-9);
            if degree == 5 {
                assert_eq!(rule, shape.rule(5).unwrap());
            }
        }
    }
}

// Two tests, to run at the same time.
#[test]
fn rules_of_open_profiles_are_positive_inside_small_and_exact() {
    rules_are_positive_inside_small_and_exact(&shapes()[..6]);
}

#[test]
fn rules_of_round_and_the_thinnest_sections_are_positive_inside_small_and_exact() {
    rules_are_positive_inside_small_and_exact(&shapes()[6..]);
}

/// Not fewer than polynomials of half the degree, which no rule can undercut, and for usual
/// profiles not many more.
#[test]
fn rules_of_low_degree_are_nearly_as_small_as_can_be() {
    let square = Outline::new(square(0.5, [3.0, -2.0])).unwrap();
    let profile = i_profile(1.0, 0.5, 0.02, 0.02).unwrap();
    for (shape, most) in [(square, [3, 6, 8]), (profile, [3, 6, 12])] {
        for ((degree, fewest), most) in [(2, 3), (4, 6), (5, 6)].into_iter().zip(most) {
            let n = shape.rule(degree).unwrap().len();
            assert!((fewest..=most).contains(&n), "degree {degree}: {n}");
        }
    }
}

#[test]
fn high_degrees_are_reached() {
    let profile = i_profile(0.2, 0.1, 0.0085, 0.0056).unwrap();
    for (degree, shape) in [(12, &profile), (16, &sector(1.0, 0.6, 1.0))] {
        let rule = shape.rule(degree).unwrap();
        assert!(rule.len() <= (degree + 1) * (degree + 2) / 2);
        assert!(rule.weights().iter().all(|&w| w > 0.0));
        assert!(defect(&rule, shape, degree) < 1e-14);
    }
}

#[test]
fn single_precision_is_exact_to_its_rounding() {
    let single = i_profile(0.5_f32, 0.25, 0.015625, 0.03125).unwrap();
    let double = i_profile(0.5_f64, 0.25, 0.015625, 0.03125).unwrap();
    for degree in [2, 4, 5, 8] {
        let rule = single.rule(degree).unwrap();
        assert!(rule.weights().iter().all(|&w| w > 0.0));
        assert!(defect(&rule, &double, degree) < 4.0 * f64::from(f32::EPSILON));
    }
    let area = single.properties().unwrap().area;
    assert_eq!(area, double.properties().unwrap().area as f32);
}

/// All moments of an I profile, through the rule, by the thickness of its web: the two strips
/// that the web grows by.
#[test]
fn rules_carry_exact_derivatives() {
    let (h, b, f) = (0.2, 0.1, 0.01);
    let lift = Dual64::from_re;
    let web = lift(0.006).derivative();
    let profile = i_profile(lift(h), lift(b), lift(f), web).unwrap();
    let plain = i_profile(h, b, f, 0.006).unwrap();
    for degree in [2, 5, 8] {
        let (rule, same) = (profile.rule(degree).unwrap(), plain.rule(degree).unwrap());
        for ((x, w), (y, v)) in rule.iter().zip(same.iter()) {
            assert!(x.map(|x| x.re) == y && w.re == v, "duals change the rule");
        }
        for [a, c] in pairs(degree) {
            let moment = rule.integrate(|[y, z]| y.powi(a as i32) * z.powi(c as i32));
            let height = slab([a, 0], [f - h / 2.0, h / 2.0 - f], [0.0, 1.0]);
            let edge = |z: f64| 0.5 * z.powi(c as i32);
            let exact = height * (edge(0.003) + edge(-0.003));
            let size = (h / 2.0).powi(a as i32) * (b / 2.0).powi(c as i32) * h;
            assert!((moment.eps - exact).abs() < 1e-14 * size, "y^{a} z^{c}");
        }
    }
    let izz = profile.properties().unwrap().izz.eps;
    assert!(near(izz, (h - 2.0 * f).powi(3) / 12.0, 1e-13));
    // In a uniform scaling every point scales and every weight with the square.
    let scale = lift(2.0).derivative();
    let circle = Loop::circle([lift(0.0); 2], scale);
    let hole = Loop::circle([lift(0.0); 2], scale * 0.5);
    let rule = Outline::new(circle)
        .unwrap()
        .with_hole(hole)
        .unwrap()
        .rule(4)
        .unwrap();
    for (x, w) in rule.iter() {
        assert!(x.iter().all(|x| (x.eps - x.re / 2.0).abs() < 1e-14));
        assert!(near(w.eps, w.re, 1e-13));
    }
    // Second derivatives: area and fourth moment of a disk by its radius.
    let radius = Dual::new(Dual::new(2.0, 1.0), Dual::new(1.0, 0.0));
    let disk = Outline::new(Loop::circle([radius * 0.0; 2], radius)).unwrap();
    let rule = disk.rule(4).unwrap();
    let area = rule.integrate(|_| radius / radius);
    assert!(near(area.eps.eps, 2.0 * PI, 1e-13));
    let fourth = rule.integrate(|[y, _]| y * y * y * y).eps.eps;
    assert!(near(fourth, 30.0 * PI / 8.0 * 16.0, 1e-12));
}

#[test]
fn a_straight_edge_knows_the_derivative_by_its_bulge() {
    // The segment on a chord of length c has the area c^2 b / 3 to first order.
    let lift = Dual64::from_re;
    let bulge = lift(0.0).derivative();
    let sheet = Loop::start([lift(-1.0), lift(-1.0)])
        .line_to([lift(1.0), lift(-1.0)])
        .arc_to([lift(1.0), lift(1.0)], bulge)
        .line_to([lift(-1.0), lift(1.0)]);
    let area = Outline::new(sheet).unwrap().moment(0, 0).unwrap();
    assert_eq!(area.re, 4.0);
    assert!(near(area.eps, 4.0 / 3.0, 1e-14));
}

#[test]
fn planar_rules_have_the_moments_of_the_profile() {
    let profile = i_profile(0.2_f64, 0.1, 0.01, 0.006).unwrap();
    for degree in 0..=8 {
        let plane = profile.planar_rule(degree).unwrap();
        assert_eq!(plane.len(), degree / 2 + 1);
        assert!(plane.weights().iter().all(|&w| w > 0.0));
        for a in (0..=degree).step_by(2) {
            let moment = plane.integrate(|[y]| y.powi(a as i32));
            let whole = slab([a, 0], [-0.1, 0.1], [0.0, 0.1]);
            let exact = whole - slab([a, 0], [-0.09, 0.09], [0.0, 0.094]);
            assert!(near(moment, exact, 1e-13), "degree {degree}, y^{a}");
        }
    }
}

#[test]
fn points_are_inside_or_not() {
    let shape = tube(1.0, 0.5);
    for k in 0..360 {
        let (sin, cos) = (PI / 180.0 * f64::from(k)).sin_cos();
        for (r, truth) in [
            (0.0, false),
            (0.49, false),
            (0.5, true),
            (0.75, true),
            (1.0, true),
            (1.01, false),
        ] {
            assert_eq!(
                shape.contains([r * cos, r * sin]),
                truth,
                "{r} at {k} degrees"
            );
        }
    }
    let profile = i_profile(2.0, 1.0, 0.25, 0.25).unwrap();
    for (point, truth) in [
        ([0.0, 0.0], true),
        ([0.0, 0.2], false),
        ([0.8, 0.4], true),
        ([0.75, 0.3], true),
        ([0.7, 0.3], false),
        ([1.0, 0.5], true),
        ([1.1, 0.0], false),
    ] {
        assert_eq!(profile.contains(point), truth, "{point:?}");
    }
    assert!(!profile.contains([f64::NAN, 0.0]));
}

#[test]
fn outlines_are_drawn_counter_clockwise_with_clockwise_holes() {
    let area = |p: &Vec<[f64; 2]>| -> f64 {
        let wedge = |i: usize| {
            let (a, b) = (p[i], p[(i + 1) % p.len()]);
            0.5 * (a[0] * b[1] - a[1] * b[0])
        };
        (0..p.len()).map(wedge).sum()
    };
    for shape in shapes() {
        for n in [0, 50, 400] {
            let loops = Section::outline(&shape, n);
            assert!(area(&loops[0]) > 0.0 && loops[1..].iter().all(|l| area(l) < 0.0));
            assert!(
                loops
                    .iter()
                    .all(|l| l.len() == n || l.len() > n && l.len() <= 24)
            );
            assert!(loops.iter().flatten().all(|&p| shape.contains(p)));
        }
        let drawn: f64 = Section::outline(&shape, 400).iter().map(area).sum();
        assert!(near(drawn, shape.moment(0, 0).unwrap(), 5e-3));
    }
}

#[test]
fn offset_and_ellipse_are_affine_images() {
    let ellipse = Ellipse::new(0.02, 0.01).unwrap();
    let moved = Offset::new(ellipse, [0.3, -0.1]).unwrap();
    let p = Section::<f64>::properties(&moved).unwrap();
    assert!(near(p.area, PI * 2e-4, 1e-14) && near(p.iyy, PI / 4.0 * 2e-8, 1e-14));
    assert!(near(p.izz, PI / 4.0 * 8e-8, 1e-14));
    assert_eq!(p.centroid, [0.3, -0.1]);
    let second = moved.rule(4).unwrap().integrate(|[y, _]| y * y);
    assert!(near(second, p.izz + p.area * 0.09, 1e-14));
    let plane = moved.planar_rule(4).unwrap();
    assert!(near(plane.integrate(|[y]| y * y), second, 1e-14));
    assert!(moved.outline(64)[0].iter().all(|&[y, z]| {
        let (u, v) = ((y - 0.3) / 0.02, (z + 0.1) / 0.01);
        near(u * u + v * v, 1.0, 1e-12)
    }));
    assert!(Offset::new(ellipse, [f64::NAN, 0.0]).is_err());
    assert!(Ellipse::new(-1.0, 1.0).is_err() && Ellipse::new(1.0, f64::INFINITY).is_err());
}

#[test]
fn a_disk_by_arcs_is_the_disk() {
    let arcs = Outline::new(Loop::circle([0.0; 2], 1.0)).unwrap();
    let (fitted, known) = (arcs.rule(5).unwrap(), disk_order::<f64>(3).unwrap());
    for e in pairs(5) {
        let difference = fitted.integrate(|p| power(p, e)) - known.integrate(|p| power(p, e));
        assert!(difference.abs() < 4e-15, "{e:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: None, cases: 32, ..ProptestConfig::default()
    })]

    /// Star-shaped polygons and their mirror images: area against the shoelace formula, moments
    /// of the rule against Green's theorem, and the rule is positive and inside.
    #[test]
    fn star_shaped_polygons_have_rules(
        radii in prop::collection::vec(0.2..1.0_f64, 3..14),
        degree in 0..7_usize,
        centre in [-2.0..2.0_f64, -2.0..2.0],
        mirrored: bool,
    ) {
        let n = radii.len();
        let corner = |(k, r): (usize, &f64)| {
            let angle = 2.0 * PI * k as f64 / n as f64 * if mirrored { -1.0 } else { 1.0 };
            [centre[0] + r * angle.cos(), centre[1] + r * angle.sin()]
        };
        let corners: Vec<_> = radii.iter().enumerate().map(corner).collect();
        let star = Outline::new(polygon(&corners)).unwrap();
        let wedge = |k: usize| 0.5 * radii[k] * radii[(k + 1) % n] * (2.0 * PI / n as f64).sin();
        let area: f64 = (0..n).map(wedge).sum();
        prop_assert!(near(star.moment(0, 0).unwrap(), area, 1e-13));
        let rule = star.rule(degree).unwrap();
        prop_assert!(rule.len() <= (degree + 1) * (degree + 2) / 2);
        prop_assert!(rule.weights().iter().all(|&w| w > 0.0));
        prop_assert!(rule.points().iter().all(|&p| star.contains(p)));
        prop_assert!(defect(&rule, &star, degree) < 1e-14);
    }
}
