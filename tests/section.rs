//! Claims about cross-sections: closed forms, outlines, planar rules, derivatives, refusals.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::exact::{pairs, ring, units};
use ancf::quadrature::Cubature;
use ancf::section::{Annulus, Disk, MAX_OUTLINE, Rectangle, Section};
use num_dual::Dual64;
use proptest::prelude::*;

/// One of each shape, with area, iyy, izz in closed form.
fn shapes() -> Vec<(Box<dyn Section<f64>>, [f64; 3])> {
    let (r, q) = (0.021_f64, 0.0175_f64);
    let (h, b) = (0.04_f64, 0.015_f64);
    let quarter = |r: f64| PI / 4.0 * r.powi(4);
    vec![
        (
            Box::new(Disk::new(r).unwrap()),
            [PI * r * r, quarter(r), quarter(r)],
        ),
        (
            Box::new(Annulus::new(r, q).unwrap()),
            [
                PI * (r * r - q * q),
                quarter(r) - quarter(q),
                quarter(r) - quarter(q),
            ],
        ),
        (
            Box::new(Rectangle::new(h, b).unwrap()),
            [h * b, h * b.powi(3) / 12.0, b * h.powi(3) / 12.0],
        ),
    ]
}

fn area(outline: &[Vec<[f64; 2]>]) -> f64 {
    let wedge = |a: &[f64; 2], b: &[f64; 2]| 0.5 * (a[0] * b[1] - a[1] * b[0]);
    let loop_area = |p: &Vec<[f64; 2]>| -> f64 {
        (0..p.len())
            .map(|i| wedge(&p[i], &p[(i + 1) % p.len()]))
            .sum()
    };
    outline.iter().map(loop_area).sum()
}

#[test]
fn properties_are_the_closed_forms() {
    for (section, [area, iyy, izz]) in shapes() {
        let p = section.properties().unwrap();
        assert!((p.area / area - 1.0).abs() < 4e-15, "{section:?}");
        assert!((p.iyy / iyy - 1.0).abs() < 4e-15, "{section:?}");
        assert!((p.izz / izz - 1.0).abs() < 4e-15, "{section:?}");
        assert!(p.iyz.abs() < 1e-15 * iyy, "{section:?}");
        assert!(p.centroid.iter().all(|c| c.abs() < 1e-17), "{section:?}");
    }
}

#[test]
fn properties_are_about_the_centroid() {
    /// A rectangle away from the axis and turned, by its rule alone.
    #[derive(Debug)]
    struct Moved(Rectangle<f64>);
    impl Section<f64> for Moved {
        fn rule(&self, degree: usize) -> ancf::Result<Cubature<f64, 2>> {
            let (sin, cos) = 0.3_f64.sin_cos();
            self.0
                .rule(degree)?
                .affine([[cos, -sin], [sin, cos]], [0.5, -0.25])
        }
        fn outline(&self, n: usize) -> Vec<Vec<[f64; 2]>> {
            self.0.outline(n)
        }
    }
    let shape = Rectangle::new(0.4, 0.1).unwrap();
    let (own, p) = (
        shape.properties().unwrap(),
        Moved(shape).properties().unwrap(),
    );
    assert!((p.centroid[0] - 0.5).abs() < 1e-15 && (p.centroid[1] + 0.25).abs() < 1e-15);
    let (mean, half) = (0.5 * (own.izz + own.iyy), 0.5 * (own.izz - own.iyy));
    assert!((p.izz - (mean + half * 0.6_f64.cos())).abs() < 1e-17);
    assert!((p.iyy - (mean - half * 0.6_f64.cos())).abs() < 1e-17);
    assert!((p.iyz - half * 0.6_f64.sin()).abs() < 1e-17);
}

#[test]
fn the_smallest_order_that_reaches_the_degree_is_taken() {
    let disk = Disk::new(1.0).unwrap();
    for (degree, points) in [
        (0, 1),
        (1, 1),
        (2, 4),
        (3, 4),
        (4, 7),
        (5, 7),
        (6, 16),
        (8, 21),
    ] {
        let rule: Cubature<f64, 2> = disk.rule(degree).unwrap();
        assert_eq!(rule.len(), points);
        assert!(rule.degree() >= degree);
    }
    let square = Rectangle::new(1.0_f32, 1.0).unwrap();
    for (degree, points) in [(0, 1), (1, 1), (2, 4), (3, 4), (4, 9), (8, 25)] {
        assert_eq!(square.rule(degree).unwrap().len(), points);
    }
}

#[test]
fn outlines_enclose_the_area() {
    for (section, [exact, ..]) in shapes() {
        let mut defects = [64, 128].map(|n| {
            let outline = section.outline(n);
            assert!(outline.iter().all(|p| p.len() == n));
            (area(&outline) / exact - 1.0).abs()
        });
        // Second order for curved shapes, none at all for the rectangle.
        assert!(defects[0] < 2e-3);
        defects[0] = defects[0].max(1e-14);
        assert!(defects[1] < 0.26 * defects[0] || defects[1] < 1e-14);
    }
}

#[test]
fn outlines_have_their_points_whatever_is_asked() {
    for n in [0, 1, 2, 3, 4, 5, 6, 7, 50] {
        let disk = Disk::new(1.0_f32).unwrap().outline(n);
        assert_eq!((disk.len(), disk[0].len()), (1, n.max(3)));
        let tube: Vec<Vec<[f64; 2]>> = Annulus::new(2.0, 1.0).unwrap().outline(n);
        assert_eq!(tube.len(), 2);
        assert!(area(&tube[..1]) > 0.0 && area(&tube[1..]) < 0.0);
        let square = Rectangle::new(2.0, 1.0).unwrap().outline(n);
        assert_eq!(square[0].len(), n.max(4));
        assert!((area(&square) - 2.0).abs() < 1e-15);
    }
    let many = Disk::new(1.0_f64).unwrap().outline(usize::MAX);
    assert_eq!(many[0].len(), MAX_OUTLINE);
}

#[test]
fn planar_rules_have_the_moments_of_the_section() {
    for (section, [area, _, izz]) in shapes() {
        for degree in 0..=9 {
            let (plane, space) = (section.planar_rule(degree).unwrap(), section.rule(degree));
            let space = space.unwrap();
            assert_eq!(plane.len(), degree / 2 + 1);
            assert!(plane.degree() >= degree);
            assert!(plane.weights().iter().all(|&w| w > 0.0));
            for a in 0..=degree as i32 {
                let exact = space.integrate(|[y, _]| y.powi(a));
                let size = space.integrate(|[y, _]| y.abs().powi(a));
                let moment = plane.integrate(|[y]| y.powi(a));
                assert!((moment - exact).abs() <= 5e-15 * size, "{section:?} y^{a}");
            }
        }
        let plane = section.planar_rule(2).unwrap();
        assert!((plane.integrate(|_| 1.0) / area - 1.0).abs() < 2e-15);
        assert!((plane.integrate(|[y]| y * y) / izz - 1.0).abs() < 4e-15);
    }
}

#[test]
fn sections_work_behind_pointers() {
    let disk = Disk::new(0.5).unwrap();
    let expected = disk.properties().unwrap();
    fn area<S: Section<f64>>(section: S) -> f64 {
        section.planar_rule(4).unwrap();
        assert_eq!(section.outline(8).len(), 1);
        section.rule(2).unwrap();
        section.properties().unwrap().area
    }
    let borrowed: &dyn Section<f64> = &disk;
    assert_eq!(area(borrowed), expected.area);
    assert_eq!(area(Box::new(disk)), expected.area);
    let shared: Arc<dyn Section<f64>> = Arc::new(disk);
    assert_eq!(area(&*shared), expected.area);
    assert_eq!(area(shared), expected.area);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn annuli_of_any_wall_are_exact(outer in 0.01..10.0_f64, ratio in 1e-3..0.999_f64) {
        let inner = outer * ratio;
        let section = Annulus::new(outer, inner).unwrap();
        let rule = section.rule(5).unwrap();
        for e in pairs(5) {
            prop_assert!(units(&rule, e, ring(e, outer, inner)) <= 1.0);
        }
    }

    #[test]
    fn area_and_moments_of_a_disk_have_exact_derivatives(radius in 1e-3..1e2_f64) {
        let section = Disk::new(Dual64::from_re(radius).derivative()).unwrap();
        let p = section.properties().unwrap();
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-13;
        prop_assert!(near(p.area.eps, 2.0 * PI * radius));
        prop_assert!(near(p.izz.eps, PI * radius.powi(3)));
        prop_assert!(near(p.iyy.eps, PI * radius.powi(3)));
        let plane = section.planar_rule(8).unwrap();
        prop_assert!(near(plane.integrate(|_| Dual64::from_re(1.0)).eps, 2.0 * PI * radius));
        prop_assert!(near(plane.integrate(|[y]| y * y).eps, PI * radius.powi(3)));
        prop_assert!(near(
            plane.integrate(|[y]| y * y * y * y).eps,
            0.75 * PI * radius.powi(5)
        ));
        // Every node is proportional to R, every weight to R^2.
        for ([y], w) in plane.iter() {
            prop_assert!((y.eps - y.re / radius).abs() < 1e-13);
            prop_assert!(near(w.eps, 2.0 * w.re / radius));
        }
    }

    #[test]
    fn annulus_and_rectangle_have_exact_derivatives(r in 0.1..1.0_f64, part in 0.1..0.9_f64) {
        let q = Dual64::from_re(r * part).derivative();
        let tube = Annulus::new(Dual64::from_re(r), q).unwrap();
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-11;
        prop_assert!(near(tube.properties().unwrap().izz.eps, -PI * q.re.powi(3)));
        let second = tube.planar_rule(2).unwrap().integrate(|[y]| y * y);
        prop_assert!(near(second.eps, -PI * q.re.powi(3)));
        let bar = Rectangle::new(q, Dual64::from_re(r)).unwrap();
        prop_assert!(near(bar.properties().unwrap().izz.eps, r * q.re * q.re / 4.0));
        let second = bar.planar_rule(2).unwrap().integrate(|[y]| y * y);
        prop_assert!(near(second.eps, r * q.re * q.re / 4.0));
    }
}

fn refused<T: std::fmt::Debug>(result: ancf::Result<T>, words: &[&str]) {
    let message = result.expect_err("must be refused").to_string();
    for word in words {
        assert!(message.contains(word), "{word:?} is not in {message:?}");
    }
}

#[test]
fn bad_shapes_are_refused_with_the_value_and_a_remedy() {
    for (bad, word) in [
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
        (f64::NEG_INFINITY, "-inf"),
        (0.0, "is 0"),
        (-0.125, "-0.125"),
    ] {
        refused(Disk::new(bad), &["radius", word]);
        refused(Rectangle::new(bad, 1.0), &["height", word]);
        refused(Rectangle::new(1.0, bad), &["width", word]);
        refused(Annulus::new(bad, 0.5), &["outer", word]);
        refused(Annulus::new(1.0, bad), &["inner", word]);
    }
    refused(Annulus::new(1.0, 0.0), &["is 0", "Disk"]);
    refused(Annulus::new(1.0, 1.0), &["inner", "is 1", "outer"]);
    refused(Annulus::new(0.5, 0.75), &["inner", "0.75", "outer"]);
    refused(Disk::new(Dual64::new(1.0, f64::NAN)), &["radius"]);
    let huge = Disk::new(1e200).unwrap();
    refused(huge.properties(), &["weight"]);
    refused(huge.rule(usize::MAX), &["256"]);
    refused(Annulus::new(2.0, 1.0).unwrap().rule(usize::MAX), &["256"]);
    refused(Rectangle::new(2.0, 1.0).unwrap().planar_rule(600), &["301"]);
}
