//! Claims about the number type `DoubleDouble`: its arithmetic, rules, analytical solutions,
//! factorisations and equilibria hold to thirty digits, against exact rationals and values
//! computed in arbitrary precision.

mod functions;
mod slender;

use ancf::analytical::{BendingSection, Elastica, EndMoment, pure_bending};
use ancf::prelude::*;
use ancf::quadrature::{annulus, disk_order, gauss_legendre, gauss_radau, project};
use ancf::scalar::DoubleDouble;
use ancf::solver::band::{BandMatrix, Factor, Profile};
use num_dual::{Dual, DualSVec};

fn number(x: f64) -> DoubleDouble {
    DoubleDouble::from(x)
}

/// Relative error of `value`.
fn error(value: DoubleDouble, truth: DoubleDouble) -> f64 {
    ((value - truth) / truth).value().abs()
}

const PI: &str = "3.14159265358979323846264338327950288";

#[test]
fn arithmetic_reads_and_writes_thirty_digits() {
    let third = number(1.0) / number(3.0);
    assert!((third * 3.0 - 1.0).value().abs() <= DoubleDouble::EPSILON);
    assert_eq!(third.to_string(), "3.333333333333333333333333333333e-1");
    assert_eq!(format!("{:.3}", number(-0.0012345)), "-1.234e-3");
    assert_eq!(format!("{:>8.1}|", number(9.99)), "   1.0e1|");
    // What cancellation leaves is exact.
    let close = DoubleDouble::new(1.0, 3e-20);
    assert_eq!((close - 1.0).value(), 3e-20);
    let parsed: DoubleDouble = "-12.5e-3".parse().unwrap();
    assert!((parsed * 80.0 + 1.0).value().abs() <= DoubleDouble::EPSILON);
    assert!("1.2.3".parse::<DoubleDouble>().is_err());
    assert_eq!(number(-1.0) / 0.0, number(f64::NEG_INFINITY));
    assert_eq!(number(1.0) / f64::INFINITY, 0.0);
    assert!(!(number(1e200) * 1e200).finite());
    assert_eq!(number(7.5) % 2.0, 1.5);
}

#[test]
fn the_circle_constant_is_right_in_every_type() {
    let pi: DoubleDouble = PI.parse().unwrap();
    assert!((DoubleDouble::pi() - pi).value().abs() <= 2.0 * DoubleDouble::EPSILON);
    assert_eq!(f64::pi(), std::f64::consts::PI);
    assert_eq!(f32::pi(), std::f32::consts::PI);
    let dual = Dual::<DoubleDouble>::pi();
    assert!(dual.re == DoubleDouble::pi() && dual.eps == 0.0);
}

/// `x^3 sin x` and its derivatives, first and second, by nested duals and by vectors of them.
#[test]
fn dual_numbers_over_double_doubles_keep_their_digits() {
    fn f<T: Field>(x: T) -> T {
        x * x * x * x.sin()
    }
    let x = number(0.75);
    let (sin, cos) = (Field::sin(x), Field::cos(x));
    let slope = x * x * (sin * 3.0 + x * cos);
    let curvature = x * (sin * 6.0 + x * cos * 6.0 - x * x * sin);
    let nested = f(Dual::new(
        Dual::new(x, number(1.0)),
        Dual::from_re(number(1.0)),
    ));
    assert!(error(nested.re.eps, slope) < 1e-30);
    assert!(error(nested.eps.eps, curvature) < 1e-30);
    fn slopes<R: Real>(x: R) -> [R; 2] {
        let vector = f(x.variable::<2>(1));
        [0, 1].map(|k| R::derivative::<2>(&vector, k))
    }
    let [none, vector] = slopes(x);
    assert!(error(vector, slope) < 1e-30);
    assert_eq!(none, 0.0);
    fn real<R: Real>() -> [f64; 2] {
        [R::EPSILON, R::ORDER as f64]
    }
    assert_eq!(
        real::<DualSVec<DoubleDouble, 3>>(),
        [DoubleDouble::EPSILON, 1.0]
    );
}

#[test]
fn gauss_rules_have_exact_moments() {
    let moment = |rule: &Cubature<DoubleDouble, 1>, k: i32| {
        rule.integrate(|[x]| (0..k).fold(number(1.0), |p, _| p * x))
    };
    for n in [1, 2, 3, 5, 8, 13, 40] {
        let (legendre, radau) = (gauss_legendre(n).unwrap(), gauss_radau(n).unwrap());
        for k in 0..2 * n as i32 {
            let truth = number(1.0) / f64::from(k + 1);
            let e = error(moment(&legendre, k), truth);
            assert!(e < 1e-30, "{n} Legendre nodes, degree {k}: {e:e}");
            if k + 1 < 2 * n as i32 {
                let e = error(moment(&radau, k), truth);
                assert!(e < 1e-30, "{n} Radau nodes, degree {k}: {e:e}");
            }
        }
    }
    // The nodes of three points are 1/2 and 1/2 -+ sqrt(3/20).
    let rule = gauss_legendre::<DoubleDouble>(3).unwrap();
    let node = number(0.5) + Field::sqrt(number(3.0) / 20.0);
    assert!(error(rule.points()[2][0], node) < 1e-31);
}

/// Moments of the unit disk are pi times `(2i)! (2j)! / (4^(i + j) i! j! (i + j + 1)!)`.
#[test]
fn disk_and_annulus_rules_have_exact_moments() {
    let pi: DoubleDouble = PI.parse().unwrap();
    let factorial = |n: i32| {
        (1..=n)
            .map(|k| number(f64::from(k)))
            .product::<DoubleDouble>()
    };
    let power = |x: DoubleDouble, k: i32| (0..k).fold(number(1.0), |p, _| p * x);
    let check = |rule: &Cubature<DoubleDouble, 2>, hole: f64, what: &str| {
        for total in 0..=rule.degree() as i32 {
            for b in 0..=total {
                let a = total - b;
                let value = rule.integrate(|[y, z]| power(y, a) * power(z, b));
                if a % 2 + b % 2 > 0 {
                    assert!(value.value().abs() < 1e-31, "{what}, y^{a} z^{b}: {value}");
                    continue;
                }
                let (i, j) = (a / 2, b / 2);
                let below = power(number(4.0), i + j) * factorial(i) * factorial(j);
                let truth = pi * factorial(a) * factorial(b) / (below * factorial(i + j + 1));
                let truth = truth * (-power(number(hole), total + 2) + 1.0);
                let e = error(value, truth);
                assert!(e < 1e-30, "{what}, y^{a} z^{b}: {e:e}");
            }
        }
    };
    for s in [1, 2, 3, 4, 5, 8, 11] {
        check(&disk_order(s).unwrap(), 0.0, &format!("disk of order {s}"));
    }
    for degree in [1, 4, 5, 12] {
        let rule = annulus(number(1.0), number(0.75), degree).unwrap();
        check(&rule, 0.75, &format!("annulus of degree {degree}"));
    }
}

/// Projection, affine images and fitted rules, against areas and moments in closed form.
#[test]
fn derived_rules_keep_their_digits() {
    let pi = DoubleDouble::pi();
    let disk = Disk::new(number(2.0)).unwrap();
    let planar = disk.planar_rule(5).unwrap();
    assert!(error(planar.integrate(|[y]| y * y), pi * 4.0) < 1e-30);
    // Two points do not make a rule of three, and rounding must not make it look so.
    let flanges = [
        [number(1.0) / 3.0, number(0.0)],
        [number(2.0) / 7.0, number(0.0)],
    ];
    let flanges = Cubature::new(flanges.to_vec(), vec![number(0.1), number(0.7)], 9).unwrap();
    assert!(project(&flanges, 3).is_ok() && project(&flanges, 5).is_err());
    let ellipse = Ellipse::new(number(3.0), number(1.0)).unwrap();
    assert!(error(ellipse.properties().unwrap().izz, pi * 27.0 / 4.0) < 1e-30);
    let [zero, two] = [number(0.0), number(2.0)];
    let square = Loop::polygon([[zero, zero], [two, zero], [two, two], [zero, two]]);
    let hole = Loop::circle([number(1.0); 2], number(0.5));
    let plate = Outline::new(square).unwrap().with_hole(hole).unwrap();
    let area = -pi / 4.0 + 4.0;
    assert!(error(plate.moment(0, 0).unwrap(), area) < 1e-30);
    let rule = plate.rule(5).unwrap();
    assert!(error(rule.integrate(|_| number(1.0)), area) < 1e-30);
    let second = number(16.0) / 3.0 - pi / 64.0 - pi / 4.0;
    assert!(error(rule.integrate(|[y, _]| y * y), second) < 1e-30);
}

#[test]
fn analytical_solutions_have_thirty_digits() {
    // Elliptic integrals of mpmath with 45 digits.
    let tip = Elastica::under_transverse_load(number(1.0)).unwrap();
    for (value, truth) in [
        (tip.deflection, "0.301720773799813529543788650720271073"),
        (tip.shortening, "0.056433236283376883090998516864252846"),
        (tip.rotation, "0.461351949711878960705769315724835446"),
    ] {
        let e = error(value, truth.parse().unwrap());
        assert!(e < 1e-29, "{value} instead of {truth}");
    }
    // The bent section is in equilibrium: its energy is stationary in both stretches.
    let section = BendingSection::disk(number(1.0), number(0.5));
    let moment = number(0.01);
    let roll = pure_bending(&section, moment, EndMoment::Conjugate).unwrap();
    let energy = |l: Dual<DoubleDouble>, a: Dual<DoubleDouble>, k: Dual<DoubleDouble>| {
        let lift = Dual::from_re;
        let (area, i2, i4) = (
            lift(section.area),
            lift(section.second),
            lift(section.fourth),
        );
        let (one, m) = (lift(number(1.0)), l * l - lift(number(1.0)));
        let b = a * a * k * k;
        let sum = m * m * area
            + lift(number(4.0)) * l * l * b * i2
            + a * a * k * k * b * i4
            + lift(number(2.0)) * m * b * i2
            + (a * a - one) * (a * a - one) * area;
        sum * lift(number(0.125))
    };
    let state = [roll.axial_stretch, roll.section_stretch, roll.curvature];
    let slope = |c: usize| {
        let mut x = state.map(Dual::from_re);
        x[c].eps = number(1.0);
        energy(x[0], x[1], x[2]).eps
    };
    assert!(slope(0).value().abs() < 1e-31 && slope(1).value().abs() < 1e-31);
    assert!(error(slope(2), moment) < 1e-29);
}

/// Integer matrices with integer solutions: the right sides are exact.
#[test]
fn both_factorisations_solve_to_thirty_digits() {
    let n = 60;
    let profile = Profile::from_ranges(n, (0..n - 2).map(|i| i..i + 3)).unwrap();
    for symmetric in [true, false] {
        let mut matrix = match symmetric {
            true => BandMatrix::symmetric(&profile),
            false => BandMatrix::general(&profile),
        };
        for i in 0..n {
            for j in i.saturating_sub(2)..(i + 3).min(n) {
                // The general one needs pivoting.
                let entry = match (symmetric, i.abs_diff(j)) {
                    (true, 0) => 7.0,
                    (true, d) => -[3.0, 0.5][d - 1],
                    (false, 0) => 2.0,
                    (false, d) => [5.0, 2.0][d - 1] * if i < j { 1.0 } else { -1.5 },
                };
                if !symmetric || j <= i {
                    matrix.add(i, j, number(entry)).unwrap();
                }
            }
        }
        let truth: Vec<_> = (0..n).map(|i| number((1 + i * i % 17) as f64)).collect();
        let mut x = vec![number(0.0); n];
        matrix.mul_vec(&truth, &mut x).unwrap();
        let mut factor = Factor::new(&profile, symmetric);
        factor.factor(&matrix).unwrap();
        factor.solve(&mut x).unwrap();
        let worst = x
            .iter()
            .zip(&truth)
            .map(|(x, t)| error(*x, *t))
            .fold(0.0, f64::max);
        assert!(worst < 1e-28, "symmetric {symmetric}: {worst:e}");
    }
}

/// Tip of a steel cantilever bent to half its length, and the residual left.
fn cantilever<R: Real>(statics: &Statics) -> ([R; 3], f64) {
    let lit = R::lit;
    let steel = SaintVenantKirchhoff::isotropic(lit(2.0e11), lit(0.25)).unwrap();
    let mut scene = Scene::<R, 3>::new();
    let disk = Disk::new(lit(0.0625)).unwrap();
    let beam = Beam::new(
        FullyParameterised,
        disk,
        Continuum::selective_reduced(steel),
    );
    let beam = beam.straight([R::zero(); 3], [lit(2.0), lit(1.0), R::zero()], 6);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene
        .force(beam.end(), [lit(1e5), lit(-8e5), lit(3e5)])
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let report = statics.solve(&system, &mut state).unwrap();
    (
        system.displacement(&state, beam.end()).unwrap(),
        report.residual,
    )
}

#[test]
fn newton_converges_to_twenty_five_digits() {
    let newton = Newton {
        residual: 1e-25,
        correction: 1e-14,
        ..Newton::default()
    };
    let at_once = Statics {
        newton,
        ..Statics::default()
    };
    let (tip, residual) = cantilever::<DoubleDouble>(&at_once);
    assert!(residual < 1e-25);
    let in_steps = Statics {
        steps: 3,
        newton: Newton {
            refresh: Refresh::WhenSlow,
            correction: 1e-27,
            ..newton
        },
        ..at_once
    };
    let (again, residual) = cantilever::<DoubleDouble>(&in_steps);
    assert!(residual < 1e-25);
    let (rough, _) = cantilever::<f64>(&Statics::default());
    for c in 0..3 {
        assert!(
            error(again[c], tip[c]) < 1e-24,
            "{} and {}",
            again[c],
            tip[c]
        );
        assert!(
            error(number(rough[c]), tip[c]) < 1e-10,
            "{} and {}",
            rough[c],
            tip[c]
        );
    }
}

/// A time integration in double-doubles is the one in doubles, with more digits.
#[test]
fn a_planar_swing_in_double_double_is_that_in_double() {
    fn swing<R: Real>() -> ([R; 2], R) {
        let lit = R::lit;
        let rubber = SaintVenantKirchhoff::isotropic(lit(2.0e7), lit(0.0)).unwrap();
        let mut scene = Scene::<R, 2>::new();
        let disk = Disk::new(lit(0.015625)).unwrap();
        let rod = Beam::new(FullyParameterised, disk, Continuum::full(rubber));
        let rod = rod.straight([R::zero(); 2], [lit(1.0), R::zero()], 4);
        let rod = scene.add(rod.density(lit(7200.0))).unwrap();
        scene.pin(rod.start()).unwrap();
        scene.gravity([R::zero(), lit(-9.8125)]).unwrap();
        let system = scene.assemble().unwrap();
        let scheme = Newmark::trapezoidal();
        let mut run = Integration::start(&system, system.rest(), &scheme).unwrap();
        run.until(lit(0.125), Stepping::Fixed(0.0078125), |_| {})
            .unwrap();
        let balance = system.energies(run.state()).unwrap().balance();
        (system.position(run.state(), rod.end()).unwrap(), balance)
    }
    let ((exact, energy), (rough, other)) = (swing::<DoubleDouble>(), swing::<f64>());
    for c in 0..2 {
        assert!((exact[c].value() - rough[c]).abs() < 1e-9);
    }
    assert!((energy.value() - other).abs() < 1e-7);
}

#[test]
fn zero_energy_modes_are_seen_in_double_double() {
    let steel = SaintVenantKirchhoff::isotropic(number(2.0e11), number(0.25)).unwrap();
    let refused = |axial: usize, degree: usize| {
        let rule = Continuum::sampled(steel, axial, degree);
        let disk = Disk::new(number(0.01)).unwrap();
        let beam = Beam::new(FullyParameterised, disk, rule);
        let ends = [[0.0; 3], [1.0, 0.0, 0.0]].map(|end| end.map(number));
        Scene::new().add(beam.straight(ends[0], ends[1], 4)).err()
    };
    assert!(matches!(
        refused(2, 5),
        Some(Error::ZeroEnergyModes { target: 18, .. })
    ));
    let modes = refused(5, 1);
    assert!(matches!(
        modes,
        Some(Error::ZeroEnergyModes { rank: 15, .. })
    ));
    assert!(refused(3, 3).is_none());
}
