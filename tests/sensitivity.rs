//! Claims about derivatives of whole simulations: statics and dynamics run in dual numbers give
//! the derivative of the answer by any parameter, the same whether propagated from the start or
//! only at the converged state, and the same as Richardson's finite differences of plain runs.

use ancf::prelude::*;
use ancf::solver::{Matrix, Profile, Unknowns};
use num_dual::Dual64;

/// The parameters a derivative may be taken by.
#[derive(Clone, Copy)]
struct Parameters<R> {
    young: R,
    poisson: R,
    size: R,
    density: R,
    load: R,
    /// Initial angular velocity (rad/s).
    spin: R,
    /// Factor of one weight of a user's section rule.
    weight: R,
}

const NAMES: [&str; 7] = ["E", "nu", "size", "rho", "load", "spin", "weight"];

impl<R: Real> Parameters<R> {
    fn from_array(p: [R; 7]) -> Self {
        let [young, poisson, size, density, load, spin, weight] = p;
        Self {
            young,
            poisson,
            size,
            density,
            load,
            spin,
            weight,
        }
    }
}

const AT: [f64; 7] = [2e7, 0.3, 0.02, 1000.0, 1.5, 0.7, 1.0];

/// A disk rule of degree 5 with one weight scaled by a parameter: a user's section.
#[derive(Debug, Clone, Copy)]
struct Weighted<R>(R, R);

impl<R: Real> Section<R> for Weighted<R> {
    fn rule(&self, _degree: usize) -> Result<Cubature<R, 2>> {
        let rule = Disk::new(self.0)?.rule(5)?;
        let mut weights = rule.weights().to_vec();
        weights[1] *= self.1;
        Cubature::new(rule.points().to_vec(), weights, 5)
    }
    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        Disk::new(self.0).map_or_else(|_| Vec::new(), |disk| disk.outline(n))
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Disk,
    Annulus,
    Rectangle,
    Weighted,
}

#[derive(Debug, Clone, Copy)]
enum Remedy {
    Full,
    Reduced,
    Selective,
    ZeroPoisson,
}

fn system<R: Real>(
    p: &Parameters<R>,
    shape: Shape,
    remedy: Remedy,
    moment: bool,
) -> (System<R, 3>, Node) {
    let section: Box<dyn Section<R>> = match shape {
        Shape::Disk => Box::new(Disk::new(p.size).unwrap()),
        Shape::Annulus => Box::new(Annulus::new(p.size, p.size * R::lit(0.6)).unwrap()),
        Shape::Rectangle => Box::new(Rectangle::new(p.size, p.size * R::lit(1.5)).unwrap()),
        Shape::Weighted => Box::new(Weighted(p.size, p.weight)),
    };
    let solid = SaintVenantKirchhoff::isotropic(p.young, p.poisson).unwrap();
    let formulation = match remedy {
        Remedy::Full => Continuum::full(solid),
        Remedy::Reduced => Continuum::reduced(solid),
        Remedy::Selective => Continuum::selective_reduced(solid),
        Remedy::ZeroPoisson => Continuum::zero_poisson(solid),
    };
    let mut scene = Scene::<R, 3>::new();
    let zero = R::zero();
    let beam = Beam::new(FullyParameterised, section, formulation)
        .straight([zero; 3], [R::one(), zero, zero], 3)
        .density(p.density);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene
        .force(beam.end(), [zero, p.load, p.load * R::lit(0.3)])
        .unwrap();
    if moment {
        let vector = [R::lit(0.05) * p.load, zero, R::lit(0.2) * p.load];
        scene
            .moment(beam.end(), Moment::new(vector, MomentLaw::MeanRotation))
            .unwrap();
    }
    scene.gravity([zero, R::lit(-1.0), zero]).unwrap();
    (scene.assemble().unwrap(), beam.end())
}

/// A tight Newton, so that differences of plain runs have digits to show.
fn newton() -> Newton {
    Newton {
        residual: 1e-13,
        correction: 1e-9,
        ..Newton::default()
    }
}

fn statics<R: Real>(
    p: [R; 7],
    shape: Shape,
    remedy: Remedy,
    start: Option<&[f64]>,
) -> (R, Vec<f64>) {
    let (system, end) = system(&Parameters::from_array(p), shape, remedy, true);
    let mut state = system.rest();
    if let Some(start) = start {
        state.displacement = start.iter().map(|u| R::lit(*u)).collect();
    }
    let solver = Statics {
        newton: newton(),
        ..Statics::in_steps(2)
    };
    solver.solve(&system, &mut state).unwrap();
    let [x, y, z] = system.displacement(&state, end).unwrap();
    let plain = state.displacement.iter().map(|u| u.value()).collect();
    (x + y + z, plain)
}

fn dynamics<R: Real>(p: [R; 7], shape: Shape) -> R {
    let p = Parameters::from_array(p);
    let (system, end) = system(&p, shape, Remedy::Selective, false);
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [R::zero(); 3], [R::zero(), R::zero(), p.spin])
        .unwrap();
    let method = Newmark::trapezoidal().with_newton(newton());
    let mut run = Integration::start(&system, state, &method).unwrap();
    run.until(R::lit(0.05), Stepping::Fixed(1e-3), |_| {})
        .unwrap();
    let [x, y, z] = system.displacement(run.state(), end).unwrap();
    x + y + z
}

/// Richardson's extrapolation of central differences, with the scale of its own error.
fn richardson(f: impl Fn([f64; 7]) -> f64, k: usize) -> (f64, f64) {
    let central = |h: f64| {
        let at = |sign: f64| {
            let mut p = AT;
            p[k] *= 1.0 + sign * h;
            f(p)
        };
        (at(1.0) - at(-1.0)) / (2.0 * h * AT[k])
    };
    let h = 4e-3;
    let [a, b, c] = [central(h), central(h / 2.0), central(h / 4.0)];
    let (ab, bc) = ((4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0);
    let best = (16.0 * bc - ab) / 15.0;
    (best, (best - bc).abs())
}

fn seeded(k: usize) -> [Dual64; 7] {
    let mut p = AT.map(Dual64::from_re);
    p[k] = p[k].derivative();
    p
}

#[track_caller]
fn agree(name: &str, dual: f64, truth: (f64, f64), scale: f64) {
    let error = (dual - truth.0).abs() / scale;
    assert!(
        error < 1e-8,
        "{name}: {dual} by duals, {} by differences (sure to {:e}): {error:e}",
        truth.0,
        truth.1
    );
}

#[test]
fn statics_differentiate_by_every_parameter_for_every_section_and_remedy() {
    for shape in [
        Shape::Disk,
        Shape::Annulus,
        Shape::Rectangle,
        Shape::Weighted,
    ] {
        for remedy in [
            Remedy::Full,
            Remedy::Reduced,
            Remedy::Selective,
            Remedy::ZeroPoisson,
        ] {
            let (tip, plain) = statics(AT, shape, remedy, None);
            for k in 0..7 {
                let name = format!("{shape:?} {remedy:?} {}", NAMES[k]);
                let (dual, _) = statics(seeded(k), shape, remedy, None);
                // Implicit differentiation: only the converged state is seen in dual numbers.
                let (implicit, _) = statics(seeded(k), shape, remedy, Some(&plain));
                let scale = (tip / AT[k]).abs().max(dual.eps.abs());
                assert!((dual.re - tip).abs() < 1e-12 * tip.abs());
                assert!(
                    (dual.eps - implicit.eps).abs() < 1e-10 * scale,
                    "{name}: {} along the way, {} at the end",
                    dual.eps,
                    implicit.eps
                );
                let truth = richardson(|p| statics(p, shape, remedy, None).0, k);
                agree(&name, dual.eps, truth, scale);
                let acts = match NAMES[k] {
                    "spin" => false,
                    "weight" => shape == Shape::Weighted,
                    _ => true,
                };
                assert_eq!(dual.eps != 0.0, acts, "{name}");
            }
        }
    }
}

#[test]
fn dynamics_differentiate_by_every_parameter() {
    for shape in [Shape::Disk, Shape::Weighted] {
        let run = |p| dynamics(p, shape);
        let tip = run(AT);
        for k in 0..7 {
            let dual = dynamics(seeded(k), shape);
            let scale = (tip / AT[k]).abs().max(dual.eps.abs());
            assert!((dual.re - tip).abs() < 1e-11 * tip.abs());
            agree(
                &format!("{shape:?} {}", NAMES[k]),
                dual.eps,
                richardson(run, k),
                scale,
            );
        }
    }
}

/// `u'' + k u = 0` as a structure of one unknown.
struct Oscillator {
    stiffness: Dual64,
    unknowns: Unknowns<Dual64>,
}

impl Structure<Dual64> for Oscillator {
    fn unknowns(&self) -> &Unknowns<Dual64> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[Dual64] {
        const UNIT: Dual64 = Dual64 { re: 1.0, eps: 0.0 };
        &[UNIT]
    }
    fn add_internal(&self, u: &[Dual64], q: &mut [Dual64]) {
        q[0] += self.stiffness * u[0];
    }
    fn add_tangent(
        &self,
        _: Dual64,
        _: Dual64,
        _: &[Dual64],
        k: &mut Matrix<Dual64>,
    ) -> Result<()> {
        k.add(0, 0, self.stiffness)
    }
    fn has_mass(&self) -> bool {
        true
    }
    fn add_mass_times(&self, factor: Dual64, a: &[Dual64], out: &mut [Dual64]) {
        out[0] += factor * a[0];
    }
    fn add_mass(&self, factor: Dual64, k: &mut Matrix<Dual64>) -> Result<()> {
        k.add(0, 0, factor)
    }
}

/// With error control the derivative is that of the motion at the steps taken; it converges with
/// the tolerance to the exact `du/dk = -t sin(sqrt(k) t) / (2 sqrt(k))`.
#[test]
fn adaptive_runs_differentiate_too() {
    let stiffness = Dual64::from_re(4.0).derivative();
    let unknowns = Unknowns::all(Profile::from_ranges(1, [0..1]).unwrap());
    let oscillator = Oscillator {
        stiffness,
        unknowns,
    };
    for estimator in [Estimator::LiZengWiberg, Estimator::ZienkiewiczXie] {
        let errors = [1e-5, 1e-8].map(|tolerance| {
            let zero = || vec![Dual64::from_re(0.0)];
            let state = State {
                time: Dual64::from_re(0.0),
                displacement: vec![Dual64::from_re(1.0)],
                velocity: zero(),
                acceleration: zero(),
                work: Dual64::from_re(0.0),
            };
            let method = Newmark::trapezoidal().with_estimator(estimator);
            let mut run = Integration::start(&oscillator, state, &method).unwrap();
            let control = Stepping::Adaptive(Adaptive::to(tolerance));
            run.until(Dual64::from_re(3.0), control, |_| {}).unwrap();
            let exact = -3.0 * 6.0_f64.sin() / 4.0;
            (run.state().displacement[0].eps - exact).abs()
        });
        let ratio = errors[0] / errors[1];
        assert!(
            errors[1] < 1e-4 && (30.0..300.0).contains(&ratio),
            "{estimator:?}: {errors:?}"
        );
    }
}

/// What vanishes by value may have a derivative: the bending of an axially loaded bar by the offset
/// of its section, and the way of a roller by its inclination, both at zero.
#[test]
fn derivatives_survive_where_values_vanish() {
    let zero = Dual64::from_re(0.0);
    let number = Dual64::from_re;
    let build = || {
        let material = SaintVenantKirchhoff::isotropic(number(1e9), zero).unwrap();
        let square = Rectangle::new(number(0.02), number(0.02)).unwrap();
        (material, square)
    };
    let lift = |e: Dual64| {
        let (material, square) = build();
        let section = Offset::new(square, [e, zero]).unwrap();
        let mut scene = Scene::<Dual64, 3>::new();
        let bar = Beam::new(FullyParameterised, section, Continuum::full(material));
        let bar = bar.straight([zero; 3], [number(1.0), zero, zero], 2);
        let bar = scene.add(bar).unwrap();
        scene.clamp(bar.start()).unwrap();
        scene.force(bar.end(), [number(10.0), zero, zero]).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state).unwrap();
        system.displacement(&state, bar.end()).unwrap()[1]
    };
    let roll = |angle: Dual64| {
        let (material, square) = build();
        let mut scene = Scene::<Dual64, 3>::new();
        let bar = Beam::new(FullyParameterised, square, Continuum::full(material));
        let bar = bar.straight([zero; 3], [number(1.0), zero, zero], 2);
        let bar = scene.add(bar).unwrap();
        scene.clamp(bar.start()).unwrap();
        let along = |c, factor| (bar.end(), NodalVector::Position, c, factor);
        let (sin, cos) = (Field::sin(angle), Field::cos(angle));
        scene.constrain(&[along(1, cos), along(0, -sin)]).unwrap();
        scene.force(bar.end(), [number(1e3), zero, zero]).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state).unwrap();
        system.displacement(&state, bar.end()).unwrap()[1]
    };
    for f in [&lift as &dyn Fn(Dual64) -> Dual64, &roll] {
        let exact = f(Dual64::new(0.0, 1.0)).eps;
        let step = 1e-4;
        let difference = (f(number(step)).re - f(number(-step)).re) / (2.0 * step);
        assert!(exact.abs() > 1e-6, "{exact}");
        assert!(
            (exact / difference - 1.0).abs() < 1e-4,
            "{exact} {difference}"
        );
    }
}
