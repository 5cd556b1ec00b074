//! Claims about nonlinear constraints, connectors, rigid bodies and closed loops: pendulums and
//! linkages against their closed forms, Euler's equations, derivatives against differences.

use ancf::prelude::*;
use ancf::solver::Matrix;
use num_dual::Dual64;

const G: f64 = 9.81;

/// A point at a fixed distance from the origin.
#[derive(Debug)]
struct Tether {
    length: f64,
}

impl<R: Real, const D: usize> Constraint<R, D, 1, 1> for Tether {
    fn residual<T: Algebra<R>>(&self, _time: T, [r]: &[[T; D]; 1]) -> [T; 1] {
        let mut square = T::zero();
        for c in 0..D {
            square += r[c] * r[c];
        }
        [square.sqrt() - T::lit(self.length)]
    }
}

/// A point on the parabola `y = x^2 + speed t`.
#[derive(Debug)]
struct Parabola {
    speed: f64,
}

impl<R: Real> Constraint<R, 2, 1, 1> for Parabola {
    fn moves(&self) -> bool {
        self.speed != 0.0
    }

    fn residual<T: Algebra<R>>(&self, time: T, [[x, y]]: &[[T; 2]; 1]) -> [T; 1] {
        [*y - *x * *x - time * T::lit(self.speed)]
    }
}

/// A spring that resists horizontal displacement of a point.
#[derive(Debug)]
struct Buffer {
    stiffness: f64,
    rest: f64,
}

impl<R: Real> Connector<R, 2, 1> for Buffer {
    fn energy<T: Algebra<R>>(&self, [[x, _]]: &[[T; 2]; 1]) -> T {
        let stretch = *x - T::lit(self.rest);
        stretch * stretch * T::lit(0.5 * self.stiffness)
    }
}

fn steel<R: Real>(
    radius: f64,
) -> Beam<R, FullyParameterised, Continuum<SaintVenantKirchhoff<R, 2>>, Disk<R>, 2> {
    let material = SaintVenantKirchhoff::isotropic(R::lit(2e11), R::zero()).unwrap();
    let disk = Disk::new(R::lit(radius)).unwrap();
    Beam::new(FullyParameterised, disk, Continuum::full(material))
}

fn about_normal(inertia: f64) -> [[f64; 3]; 3] {
    let mut tensor = [[0.0; 3]; 3];
    tensor[2][2] = inertia;
    tensor
}

/// A body that swings through 90 degrees on a rod without mass comes back after three periods of
/// ten thousand steps, at rest, with its constraint held in position, velocity and acceleration.
#[test]
fn a_rigid_pendulum_keeps_its_length() {
    let mut scene = Scene::<f64, 2>::new();
    let body = RigidBody::new(2.0, about_normal(0.1)).at([1.0, 0.0]);
    let body = scene.add_body(body).unwrap().start();
    scene.gravity([0.0, -G]).unwrap();
    let tether = Tether { length: 1.0 };
    scene.bind([(body, NodalVector::Position)], tether).unwrap();
    let system = scene.assemble().unwrap();
    let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
    // Complete elliptic integral of modulus sin 45 degrees.
    let quarter = 1.854_074_677_301_371_9 / G.sqrt();
    let steps = 10_000;
    let step = 12.0 * quarter / steps as f64;
    let mut worst = [0.0_f64; 4];
    run.until(12.0 * quarter, Stepping::Fixed(step), |step| {
        let drift = system.drift(step.after)?;
        let energy = system.energies(step.after)?.balance();
        let now = [
            drift.position,
            drift.velocity,
            drift.acceleration,
            energy.abs(),
        ];
        worst = std::array::from_fn(|k| worst[k].max(now[k]));
        Ok(())
    })
    .unwrap();
    assert_eq!(run.report().steps, steps);
    assert!(worst[..3].iter().all(|d| *d < 1e-9), "{worst:?}");
    // Of 20 J.
    assert!(worst[3] < 1e-4, "{worst:?}");
    let state = run.state();
    let [x, y] = system.position(state, body).unwrap();
    let at = system.coordinate(body, NodalVector::Position).unwrap();
    // Second order: phase (omega dt)^2 / 12 over 19 rad.
    assert!((x - 1.0).abs() < 1e-6 && y.abs() < 1e-4, "{x} {y}");
    assert!(
        state.velocity[at + 1].abs() < 1e-4,
        "{}",
        state.velocity[at + 1]
    );
}

/// A bead on a parabola that is raised steadily: without drift, and the energy of the bead on the
/// resting one is kept to second order.
#[test]
fn a_bead_slides_along_its_curve() {
    let bead = |speed, step| {
        let mut scene = Scene::<f64, 2>::new();
        let body = RigidBody::new(1.0, about_normal(1.0)).at([1.0, 1.0]);
        let body = scene.add_body(body).unwrap().start();
        scene.gravity([0.0, -G]).unwrap();
        let curve = Parabola { speed };
        scene.bind([(body, NodalVector::Position)], curve).unwrap();
        let system = scene.assemble().unwrap();
        let mut run = Integration::start(&system, system.rest(), &Newmark::trapezoidal()).unwrap();
        let start = system.energies(run.state()).unwrap().balance();
        let (mut drift, mut loss) = (0.0_f64, 0.0_f64);
        run.until(2.0, Stepping::Fixed(step), |step| {
            let now = system.drift(step.after)?;
            drift = drift
                .max(now.position)
                .max(now.velocity)
                .max(now.acceleration);
            let energies = system.energies(step.after)?;
            loss = loss.max((energies.balance() - start).abs());
            Ok(())
        })
        .unwrap();
        (drift, loss)
    };
    let (drift, coarse) = bead(0.0, 0.004);
    let (_, fine) = bead(0.0, 0.002);
    assert!(drift < 1e-9, "{drift}");
    assert!(coarse < 0.01 && coarse / fine > 3.5, "{coarse} {fine}");
    // What raises the curve does work, which the balance knows.
    let (drift, coarse) = bead(0.5, 0.004);
    let (_, fine) = bead(0.5, 0.002);
    assert!(drift < 1e-9, "{drift}");
    assert!(coarse < 0.02 && coarse / fine > 3.5, "{coarse} {fine}");
}

/// Tangent of springs and constraints against central differences of their forces, at a state
/// away from the reference with multipliers at work.
#[test]
fn tangents_of_constraints_are_derivatives() {
    let mut scene = Scene::<f64, 2>::new();
    let beam = steel(0.05).straight([0.0; 2], [1.0, 1.0], 1).density(1.0);
    let beam = scene.add(beam).unwrap();
    let body = RigidBody::new(1.0, about_normal(1.0)).at([1.0, 1.0]);
    let body = scene.add_body(body).unwrap();
    let tip = (beam.end(), NodalVector::Position);
    scene.bind([tip], Parabola { speed: 0.2 }).unwrap();
    scene
        .bind(
            [(body.start(), NodalVector::Position)],
            Tether { length: 1.4 },
        )
        .unwrap();
    let buffer = Buffer {
        stiffness: 1e9,
        rest: 0.3,
    };
    scene.connect([tip], buffer).unwrap();
    let system = scene.assemble().unwrap();
    let n = system.rest().displacement.len();
    let u: Vec<f64> = (0..n)
        .map(|i| 0.05 * (1.0 + 7.0 * i as f64).sin())
        .collect();
    let force = |u: &[f64]| {
        let mut q = vec![0.0; n];
        system.add_internal(u, &mut q);
        system.add_holding(0.7, u, &mut q);
        q
    };
    let mut k = Matrix::zero(system.unknowns(), true);
    system.add_tangent(0.7, 1.0, &u, &mut k).unwrap();
    system.add_holding_tangent(0.7, &u, &mut k).unwrap();
    let free = system.unknowns().free();
    let largest = (0..n)
        .map(|q| k.stored().get(q, q).abs())
        .fold(0.0, f64::max);
    for (q, &j) in free.iter().enumerate() {
        let h = 1e-6;
        let moved = |h: f64| {
            let mut u = u.clone();
            u[j] += h;
            force(&u)
        };
        let (plus, minus) = (moved(h), moved(-h));
        for (p, &i) in free.iter().enumerate() {
            let slope = (plus[i] - minus[i]) / (2.0 * h);
            let error = (k.stored().get(p, q) - slope).abs();
            assert!(error < 1e-8 * largest, "{i} {j}: {slope}");
        }
    }
}

/// The tip of a cantilever pushed along a curve: derivative of its place by the force, exactly and
/// by differences.
#[test]
fn constrained_scenes_carry_derivatives() {
    fn tip<R: Real>(force: R) -> R {
        let mut scene = Scene::<R, 2>::new();
        let (from, to) = ([R::zero(); 2], [R::one(); 2]);
        let beam = scene.add(steel(0.01).straight(from, to, 4)).unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force(beam.end(), [force, R::zero()]).unwrap();
        let vectors = [(beam.end(), NodalVector::Position)];
        scene.bind(vectors, Parabola { speed: 0.0 }).unwrap();
        let system = scene.assemble().unwrap();
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state).unwrap();
        let [x, y] = system.position(&state, beam.end()).unwrap();
        assert!((y - x * x).value().abs() < 1e-12);
        x
    }
    let exact = tip(Dual64::new(1e3, 1.0)).eps;
    let difference = (tip(1e3 + 1.0) - tip(1e3 - 1.0)) / 2.0;
    assert!(
        (exact / difference - 1.0).abs() < 1e-6,
        "{exact} {difference}"
    );
}

/// A parallelogram of stiff bars. Pushed against a spring it stands where virtual work says; hung
/// up it swings as a pendulum with the inertia of two cranks and a coupler.
#[test]
fn a_four_bar_linkage_closes() {
    let linkage = |up: f64| {
        let mut scene = Scene::<f64, 2>::new();
        let bar = |from, to| steel(0.02).straight(from, to, 2).density(1000.0);
        let corners = [[0.0, 0.0], [0.0, up], [2.0, up], [2.0, 0.0]];
        let bars: Vec<Placed> = corners
            .windows(2)
            .map(|ends| scene.add(bar(ends[0], ends[1])).unwrap())
            .collect();
        scene.pin(bars[0].start()).unwrap();
        scene.pin(bars[2].end()).unwrap();
        for pair in bars.windows(2) {
            let (one, other) = (pair[0].end(), pair[1].start());
            scene.join(one, other, Joint::Spherical).unwrap();
        }
        (scene, bars[1].start())
    };
    let (mut scene, corner) = linkage(1.0);
    let buffer = Buffer {
        stiffness: 1e4,
        rest: 0.0,
    };
    scene
        .connect([(corner, NodalVector::Position)], buffer)
        .unwrap();
    scene.force(corner, [6e3, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state).unwrap();
    let [x, y] = system.position(&state, corner).unwrap();
    // The bars hardly carry: the spring meets the push where it acts.
    assert!((x - 0.6).abs() < 1e-6 && (y - 0.8).abs() < 1e-6, "{x} {y}");

    let (mut scene, corner) = linkage(-1.0);
    scene.gravity([0.0, -G]).unwrap();
    let system = scene.assemble().unwrap();
    // Without any tension it is a mechanism: start from cranks that are stretched a little.
    let mut state = system.rest();
    for i in (1..system.reference().len()).step_by(2) {
        state.displacement[i] = 1e-6 * system.reference()[i].min(0.0);
    }
    Statics::default().solve(&system, &mut state).unwrap();
    let at = system.coordinate(corner, NodalVector::Position).unwrap();
    let hanging = state.displacement[at];
    // Cranks of mass m turn, the coupler of mass 2 m goes with them: (2/3 + 2) and (1 + 2) m.
    let omega = (3.0 * G / (8.0 / 3.0)).sqrt();
    let swing = 0.01;
    let mut start = system.rest();
    start.displacement.clone_from(&state.displacement);
    for (i, e) in system.reference().chunks(2).enumerate() {
        // Positions of the cranks turn by their depth, the coupler's all alike; slopes turn.
        let bar = i / 9;
        let (vector, speed) = (i % 3, swing * omega);
        match (vector, bar) {
            (0, _) => start.velocity[2 * i] = -speed * e[1],
            (_, 1) => {}
            _ => {
                start.velocity[2 * i] = -speed * e[1];
                start.velocity[2 * i + 1] = speed * e[0];
            }
        }
    }
    let mut run = Integration::start(&system, start, &Newmark::trapezoidal()).unwrap();
    let mut worst: f64 = 0.0;
    run.until(3.0, Stepping::Fixed(0.01), |step| {
        let x = step.after.displacement[at] - hanging;
        worst = worst.max((x - swing * (omega * step.after.time).sin()).abs());
    })
    .unwrap();
    // Second order in omega dt over 10 rad, and the amplitude's square over 16.
    assert!(worst < 5e-3 * swing, "{worst}");
}

/// A heavy body on a stiff light rod swings with the period of a compound pendulum.
#[test]
fn a_heavy_body_makes_a_compound_pendulum() {
    let mut scene = Scene::<f64, 2>::new();
    let rod = steel(0.02)
        .straight([0.0; 2], [0.0, -1.0], 2)
        .density(100.0);
    let rod = scene.add(rod).unwrap();
    let (mass, inertia, beyond) = (10.0, 0.8, 0.3);
    // The body's axes are the rod's: the first points down.
    let body = RigidBody::new(mass, about_normal(inertia))
        .at([0.0, -1.0])
        .centre([beyond, 0.0])
        .turned([[0.0, -1.0], [1.0, 0.0]]);
    let body = scene.add_body(body).unwrap();
    scene.pin(rod.start()).unwrap();
    scene.join(rod.end(), body.start(), Joint::Rigid).unwrap();
    scene.gravity([0.0, -G]).unwrap();
    let system = scene.assemble().unwrap();
    let beam = 100.0 * std::f64::consts::PI * 0.02 * 0.02;
    let arm = 1.0 + beyond;
    let about_pin = beam / 3.0 + inertia + mass * arm * arm;
    let omega = (G * (beam * 0.5 + mass * arm) / about_pin).sqrt();
    let swing = 0.01;
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [0.0; 2], [0.0, 0.0, swing * omega])
        .unwrap();
    let mut run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
    let mut worst: f64 = 0.0;
    run.until(4.0, Stepping::Fixed(0.01), |step| {
        let [x, _] = system.position(step.after, body.start())?;
        worst = worst.max((x - swing * (omega * step.after.time).sin()).abs());
        Ok(())
    })
    .unwrap();
    // Phase (omega dt)^2 / 12 over 11 rad: 1e-4 of the swing, and as much for its flexibility.
    assert!(worst < 2e-3 * swing, "{worst}");
}

/// A free body turning about its middle axis tumbles as Euler's equations say.
#[test]
fn a_free_body_obeys_eulers_equations() {
    let inertia = [1.0, 2.0, 2.5];
    let spin = [0.05, 2.0, 0.02];
    let mut scene = Scene::<f64, 3>::new();
    let tensor =
        std::array::from_fn(|a| std::array::from_fn(|b| if a == b { inertia[a] } else { 0.0 }));
    let body = scene.add_body(RigidBody::new(3.0, tensor)).unwrap().start();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    system
        .set_rigid_velocity(&mut state, [0.0; 3], spin)
        .unwrap();
    let mut run = Integration::start(&system, state, &Newmark::trapezoidal()).unwrap();
    let end = 5.0;
    run.until(end, Stepping::Fixed(2e-3), |_| {}).unwrap();
    // Euler's equations in body axes and the axes themselves by Runge and Kutta's rule.
    let rate = |y: &[f64; 12]| {
        let w = [y[0], y[1], y[2]];
        let mut d = [0.0; 12];
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            d[a] = (inertia[b] - inertia[c]) * w[b] * w[c] / inertia[a];
            // d e_a / dt = omega x e_a = w_c e_b - w_b e_c.
            for k in 0..3 {
                d[3 + 3 * a + k] = w[c] * y[3 + 3 * b + k] - w[b] * y[3 + 3 * c + k];
            }
        }
        d
    };
    let mut y = [0.0; 12];
    y[..3].copy_from_slice(&spin);
    for a in 0..3 {
        y[3 + 4 * a] = 1.0;
    }
    let n = 5000;
    let h = end / n as f64;
    for _ in 0..n {
        let add = |k: &[f64; 12], f: f64| std::array::from_fn(|i| y[i] + f * k[i]);
        let k1 = rate(&y);
        let k2 = rate(&add(&k1, h / 2.0));
        let k3 = rate(&add(&k2, h / 2.0));
        let k4 = rate(&add(&k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    // It has left its axis by far.
    assert!(y[1] < 1.9, "{y:?}");
    for a in 0..3 {
        let axis = system
            .vector(run.state(), body, NodalVector::Slope(a))
            .unwrap();
        for k in 0..3 {
            let gap = (axis[k] - y[3 + 3 * a + k]).abs();
            assert!(gap < 1e-3, "axis {a}: {axis:?}, {y:?}");
        }
    }
    assert!(system.drift(run.state()).unwrap().position < 1e-9);
}

/// A constraint said twice is held once, one that a support already keeps not at all; what
/// contradicts the others is named.
#[test]
fn constraints_may_say_the_same_but_not_the_contrary() {
    let scene = |times: usize, clamped: bool, length: f64| {
        let mut scene = Scene::<f64, 2>::new();
        let beam = scene
            .add(steel(0.01).straight([0.0; 2], [1.0, 1.0], 2))
            .unwrap();
        scene.clamp(beam.start()).unwrap();
        scene.force(beam.end(), [1e3, 0.0]).unwrap();
        for _ in 0..times {
            let vectors = [(beam.end(), NodalVector::Position)];
            scene.bind(vectors, Parabola { speed: 0.0 }).unwrap();
        }
        if clamped {
            let vectors = [(beam.start(), NodalVector::Position)];
            scene.bind(vectors, Parabola { speed: 0.0 }).unwrap();
            let pair = [(beam.node(1), NodalVector::Position)];
            scene
                .bind(
                    pair,
                    Tether {
                        length: 0.5_f64.sqrt(),
                    },
                )
                .unwrap();
            scene.bind(pair, Tether { length }).unwrap();
        }
        scene.assemble()
    };
    let tip = |system: System<f64, 2>| {
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state).unwrap();
        state.displacement[12..14].to_vec()
    };
    let once = tip(scene(1, false, 1.0).unwrap());
    for times in [2, 3] {
        let system = scene(times, false, 1.0).unwrap();
        assert!(system.describe().contains("implied"), "{system}");
        let again = tip(system);
        assert!((once[0] - again[0]).abs() + (once[1] - again[1]).abs() < 1e-12);
    }
    scene(1, true, 0.5_f64.sqrt()).unwrap();
    let error = scene(1, true, 0.7).unwrap_err();
    assert!(matches!(error, Error::Redundant { .. }), "{error}");
    assert!(error.to_string().contains("Tether"), "{error}");
}

/// Bodies that cannot be are refused.
#[test]
fn impossible_bodies_are_refused() {
    let mut scene = Scene::<f64, 3>::new();
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let add = |scene: &mut Scene<f64, 3>, body| scene.add_body(body).unwrap_err();
    let error = add(&mut scene, RigidBody::new(-1.0, unit));
    assert!(matches!(error, Error::NotPositive { .. }), "{error}");
    let mut long = unit;
    long[0][0] = 3.0;
    let error = add(&mut scene, RigidBody::new(1.0, long));
    assert!(error.to_string().contains("inertia"), "{error}");
    // Every pair of axes admissible, but principal moments 3.8, 1.1 and 1.1.
    let skew = [[2.0, 0.9, 0.9], [0.9, 2.0, 0.9], [0.9, 0.9, 2.0]];
    let error = add(&mut scene, RigidBody::new(1.0, skew));
    assert!(error.to_string().contains("inertia"), "{error}");
    let error = add(&mut scene, RigidBody::new(1.0, unit).at([f64::NAN; 3]));
    assert!(matches!(error, Error::NotFinite { .. }), "{error}");
    let body = scene.add_body(RigidBody::new(1.0, unit)).unwrap().start();
    let error = scene.mass(body, f64::NAN).unwrap_err();
    assert!(matches!(error, Error::NotPositive { .. }), "{error}");
}

/// A constraint that depends on time moves what it holds, at every level.
#[test]
fn a_moving_constraint_moves_its_point() {
    let mut scene = Scene::<f64, 2>::new();
    let beam = scene
        .add(steel(0.01).straight([0.0; 2], [1.0, 1.0], 2))
        .unwrap();
    scene.clamp(beam.start()).unwrap();
    let curve = Parabola { speed: 0.1 };
    scene
        .bind([(beam.end(), NodalVector::Position)], curve)
        .unwrap();
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    state.time = 0.5;
    Statics::in_steps(2).solve(&system, &mut state).unwrap();
    let [x, y] = system.position(&state, beam.end()).unwrap();
    assert!((y - x * x - 0.05).abs() < 1e-11, "{x} {y}");
    let drift = system.drift(&state).unwrap();
    assert!((drift.velocity - 0.1).abs() < 1e-14);
}
