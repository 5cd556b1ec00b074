//! Long and violent motions: a minute of the pendulum, a hundred thousand steps of free flight,
//! a rod that spins at a thousand radians per second, loads that jump, clocks that run out of
//! digits.

use ancf::prelude::*;

use crate::row::{Answer, Claim, Row, number};

type Solid<R> = SaintVenantKirchhoff<R, 2>;

/// A free straight rod in the plane, of unit length.
fn rod<R: Real>(
    (young, nu): (f64, f64),
    radius: f64,
    density: f64,
    elements: usize,
    start: [f64; 2],
) -> Result<(Scene<R, 2>, Placed)>
where
    Continuum<Solid<R>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let solid = Solid::isotropic(R::lit(young), R::lit(nu))?;
    let form = Continuum::selective_reduced(solid);
    let mut scene = Scene::<R, 2>::new();
    let beam = Beam::new(FullyParameterised, Disk::new(R::lit(radius))?, form);
    let [from, to] = [start, [start[0] + 1.0, start[1]]].map(|p| p.map(R::lit));
    let beam = scene.add(beam.straight(from, to, elements).density(R::lit(density)))?;
    Ok((scene, beam))
}

/// The paper's pendulum in space through sixty seconds, with a viscosity; what of the energy exchanged may be
/// gained or, unless nothing is said of it, lost.
fn pendulum<R: Real>(form: &'static str, viscosity: f64, gained: f64, lost: Option<f64>) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 3>>: Formulation<R, FullyParameterised, 3, 8>,
{
    Row {
        family: "pendulum",
        case: "pendulum of 6 elements in space, 60 s at 1 ms".into(),
        number: number::<R>(),
        form,
        truth: "energy",
        parameter: viscosity,
        claim: Claim::Within(lost.unwrap_or(gained)),
        long: true,
        run: Box::new(move || {
            let rubber = SaintVenantKirchhoff::isotropic(R::lit(2e7), R::zero())?;
            let disk = Disk::new(R::lit(0.01))?;
            let rod = Beam::new(FullyParameterised, disk, Continuum::full(rubber));
            let (mut scene, zero) = (Scene::<R, 3>::new(), R::zero());
            let rod = rod.straight([zero; 3], [R::one(), zero, zero], 6);
            let rod = scene.add(rod.density(R::lit(7200.0)))?;
            scene.pin(rod.start())?;
            scene.gravity([zero, R::lit(-9.81), zero])?;
            let system = scene.assemble()?;
            let mut scheme = EnergyMomentum::conserving();
            scheme.viscosity = viscosity;
            scheme.newton.refresh = Refresh::EveryIteration;
            let mut run = Integration::start(&system, system.rest(), &scheme)?;
            let (mut up, mut down, mut most) = (0.0_f64, 0.0_f64, 0.0_f64);
            let mut curve = Vec::new();
            let stepping = Stepping::Halved {
                step: 1e-3,
                halvings: 10,
            };
            run.until(R::lit(60.0), stepping, |step| {
                let energies = system.energies(step.after)?;
                let balance = energies.balance().value();
                (up, down) = (up.max(balance), down.max(-balance));
                most = most.max(energies.kinetic.value());
                let time = step.after.time.value();
                if time >= 0.1 * curve.len() as f64 {
                    curve.push([time, balance]);
                }
                Ok(())
            })?;
            let error = lost.map_or(up, |_| up.max(down)) / most;
            Ok(Answer::dynamics(error, &run.report()).with_curve(curve))
        }),
    }
}

/// A rod thrown and set spinning by forces that end, conserving.
fn flight<R: Real>(steps: u32) -> Row
where
    Continuum<Solid<R>>: Formulation<R, FullyParameterised, 2, 6>,
{
    Row {
        family: "flight",
        case: format!("free flight of a rubber rod, {steps} steps of 1 ms"),
        number: number::<R>(),
        form: "energy-momentum",
        truth: "energy, momenta",
        parameter: f64::from(steps),
        // Rounding walks at random.
        claim: Claim::Within(100.0 * R::EPSILON * f64::from(steps)),
        long: steps > 10_000,
        run: Box::new(move || {
            let (mut scene, beam) = rod::<R>((2e7, 0.3), 0.01, 7200.0, 3, [0.0; 2])?;
            let on = |t: R| if t.value() < 0.2 { R::one() } else { R::zero() };
            let [a, b] = [[5.0, 20.0], [-4.0, -18.0]].map(|f| f.map(R::lit));
            scene.force_in_time(beam.end(), a, on)?;
            scene.force_in_time(beam.start(), b, on)?;
            scene.moment_in_time(beam.start(), Moment::about_z(R::lit(0.3)), on)?;
            let system = scene.assemble()?;
            let scheme = EnergyMomentum::conserving();
            let mut run = Integration::start(&system, system.rest(), &scheme)?;
            let stepping = Stepping::Fixed(1e-3);
            run.until(R::lit(0.25), stepping, |_| {})?;
            let error = kept(&system, &mut run, stepping, 0.25 + 1e-3 * f64::from(steps))?;
            Ok(Answer::dynamics(error, &run.report()))
        }),
    }
}

/// Runs to `end` and gives the largest departure of energy and momenta there, as a share of what
/// they are.
fn kept<R: Real, M: Method<R>>(
    system: &System<R, 2>,
    run: &mut Integration<'_, R, System<R, 2>, M>,
    stepping: Stepping,
    end: f64,
) -> Result<f64> {
    let measure = |state: &State<R>| -> Result<[f64; 4]> {
        let (energies, momenta) = (system.energies(state)?, system.momenta(state)?);
        let [x, y] = momenta.linear;
        Ok([energies.balance(), x, y, momenta.angular[2]].map(Real::value))
    };
    let before = measure(run.state())?;
    let kinetic = system.energies(run.state())?.kinetic.value();
    run.until(R::lit(end), stepping, |_| {})?;
    let after = measure(run.state())?;
    let linear = before[1].hypot(before[2]).max(1e-3 * before[3].abs());
    let sizes = [kinetic, linear, linear, before[3].abs()];
    let shares = (0..4).map(|i| (after[i] - before[i]).abs() / sizes[i]);
    Ok(shares.fold(0.0, f64::max))
}

/// A steel rod spun about its middle.
fn spin<R: Real, X: Scheme<R> + 'static>(name: &'static str, scheme: X, claim: f64) -> Row
where
    Continuum<Solid<R>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let (omega, step, steps) = (1e3, 2e-5, 5000.0);
    Row {
        family: "spin",
        case: format!("steel rod at {omega:.0e} rad/s, {steps} steps of {step:.0e} s"),
        number: number::<R>(),
        form: name,
        truth: "energy, momenta",
        parameter: omega,
        claim: Claim::Within(claim),
        long: false,
        run: Box::new(move || {
            let (scene, _) = rod::<R>((2e11, 0.3), 0.02, 7800.0, 4, [-0.5, 0.0])?;
            let system = scene.assemble()?;
            let mut state = system.rest();
            let turn = [R::zero(), R::zero(), R::lit(omega)];
            system.set_rigid_velocity(&mut state, [R::zero(); 2], turn)?;
            let mut run = Integration::start(&system, state, &scheme)?;
            let before = system.energies(run.state())?.total().value();
            let momentum = system.momenta(run.state())?.angular[2].value();
            let (mut curve, mut worst) = (Vec::new(), 0.0_f64);
            run.until(R::lit(step * steps), Stepping::Fixed(step), |s| {
                let energy = system.energies(s.after)?.total().value() / before - 1.0;
                let turned = system.momenta(s.after)?.angular[2].value() / momentum - 1.0;
                worst = worst.max(energy.abs()).max(turned.abs());
                curve.push([s.after.time.value(), energy.abs().max(1e-18)]);
                Ok(())
            })?;
            Ok(Answer::dynamics(worst, &run.report()).with_curve(curve))
        }),
    }
}

/// A force that sets in between the ends of a step and what it has given the free rod in momentum.
fn jump<R: Real>(name: &'static str, stepping: Stepping, share: f64) -> Row
where
    Continuum<Solid<R>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let (start, end, force) = (0.050_37, 0.1, 10.0);
    Row {
        family: "jump",
        case: "force that sets in within a step".into(),
        number: number::<R>(),
        form: name,
        truth: "impulse",
        parameter: start,
        claim: Claim::Within(share / (end - start)),
        long: false,
        run: Box::new(move || {
            let (mut scene, beam) = rod::<R>((2e7, 0.3), 0.01, 7200.0, 3, [0.0; 2])?;
            let on = move |t: R| match t.value() < start {
                true => R::zero(),
                false => R::one(),
            };
            scene.force_in_time(beam.end(), [R::zero(), R::lit(force)], on)?;
            let system = scene.assemble()?;
            let scheme = Newmark::generalised_alpha(0.8);
            let mut run = Integration::start(&system, system.rest(), &scheme)?;
            run.until(R::lit(end), stepping, |_| {})?;
            let [_, impulse] = system.momenta(run.state())?.linear;
            let error = (impulse.value() / (force * (end - start)) - 1.0).abs();
            Ok(Answer::dynamics(error, &run.report()))
        }),
    }
}

/// Free fall from rest, whatever the numbers.
struct Fall {
    case: &'static str,
    density: f64,
    start: [f64; 2],
    clock: f64,
    step: f64,
    steps: f64,
    claim: Claim,
}

impl Fall {
    fn row<R: Real>(self) -> Row
    where
        Continuum<Solid<R>>: Formulation<R, FullyParameterised, 2, 6>,
    {
        Row {
            family: "fall",
            case: format!("free fall, {}", self.case),
            number: number::<R>(),
            form: "trapezoidal",
            truth: "parabola",
            parameter: self.step,
            claim: self.claim,
            long: false,
            run: Box::new(move || {
                let (mut scene, beam) = rod::<R>((2e7, 0.3), 0.01, self.density, 3, self.start)?;
                scene.gravity([R::zero(), R::lit(-10.0)])?;
                let system = scene.assemble()?;
                let mut state = system.rest();
                state.time = R::lit(self.clock);
                let mut run = Integration::start(&system, state, &Newmark::trapezoidal())?;
                for _ in 0..self.steps as usize {
                    run.step(R::lit(self.step))?;
                }
                let time = self.step * self.steps;
                let [_, y] = system.displacement(run.state(), beam.end())?;
                let shown = (run.state().time.value() - self.clock) / time - 1.0;
                let error = (y.value() / (-5.0 * time * time) - 1.0).abs();
                Ok(Answer::dynamics(error.max(shown.abs()), &run.report()))
            }),
        }
    }
}

/// A load whose ramp takes no time.
fn ramp<R: Real>(length: f64, claim: Claim) -> Row
where
    Continuum<Solid<R>>: Formulation<R, FullyParameterised, 2, 6>,
{
    Row {
        family: "ramp",
        case: format!("load that rises within {length:.0e} s"),
        number: number::<R>(),
        form: "generalised alpha",
        truth: "impulse",
        parameter: length,
        claim,
        long: false,
        run: Box::new(move || {
            let (mut scene, beam) = rod::<R>((2e7, 0.3), 0.01, 7200.0, 3, [0.0; 2])?;
            let force = [R::zero(), R::lit(10.0)];
            scene.force_in_time(beam.end(), force, move |t: R| {
                // 0 / 0 at the start of a ramp without length, as users write it.
                let share = t / R::lit(length);
                if share > R::one() { R::one() } else { share }
            })?;
            let system = scene.assemble()?;
            let scheme = Newmark::generalised_alpha(0.8);
            let mut run = Integration::start(&system, system.rest(), &scheme)?;
            run.until(R::lit(0.1), Stepping::Adaptive(Adaptive::to(1e-5)), |_| {})?;
            let [_, impulse] = system.momenta(run.state())?.linear;
            Ok(Answer::dynamics(
                (impulse.value() - 1.0).abs(),
                &run.report(),
            ))
        }),
    }
}

/// Rows that fall.
fn falls() -> Vec<Row> {
    let usual = || Fall {
        case: "",
        density: 7200.0,
        start: [0.0; 2],
        clock: 0.0,
        step: 1e-3,
        steps: 100.0,
        claim: Claim::Within(1e-9),
    };
    let single = Claim::Within(1e-4);
    let far = [1e6, -1e6];
    vec![
        Fall {
            case: "1e6 m from the origin",
            start: far,
            ..usual()
        }
        .row::<f64>(),
        Fall {
            case: "1e6 m from the origin",
            start: far,
            claim: single,
            ..usual()
        }
        .row::<f32>(),
        Fall {
            case: "density 1e-30",
            density: 1e-30,
            ..usual()
        }
        .row::<f64>(),
        Fall {
            case: "density 1e-30",
            density: 1e-30,
            claim: single,
            ..usual()
        }
        .row::<f32>(),
        Fall {
            case: "density 1e-42",
            density: 1e-42,
            claim: single,
            ..usual()
        }
        .row::<f32>(),
        Fall {
            case: "step of 1e6 s",
            step: 1e6,
            steps: 2.0,
            claim: Claim::Within(1e-6),
            ..usual()
        }
        .row::<f64>(),
        Fall {
            case: "clock at 1e9 s",
            clock: 1e9,
            claim: Claim::Within(1e-4),
            ..usual()
        }
        .row::<f64>(),
        Fall {
            case: "clock at 1e9 s, step of 1e-9 s",
            clock: 1e9,
            step: 1e-9,
            claim: Claim::Refusal,
            ..usual()
        }
        .row::<f64>(),
        Fall {
            case: "clock at 1e5 s",
            clock: 1e5,
            claim: Claim::Refusal,
            ..usual()
        }
        .row::<f32>(),
    ]
}

/// All rows of this file.
pub fn rows() -> Vec<Row> {
    // Of rounding in 60 000 steps, as in free flight.
    let single = 100.0 * f64::from(f32::EPSILON) * 6e4;
    let mut rows = vec![
        pendulum::<f64>("energy-momentum", 0.0, 1e-9, Some(1e-9)),
        pendulum::<f64>("viscosity 1e-8", 1e-8, 1e-9, Some(1e-3)),
        pendulum::<f64>("viscosity 1e-3", 1e-3, 1e-9, None),
        pendulum::<f32>("energy-momentum", 0.0, single, Some(single)),
        pendulum::<f32>("viscosity 1e-3", 1e-3, single, None),
    ];
    rows.extend([flight::<f64>(100_000), flight::<f32>(100_000)]);
    rows.extend([flight::<f64>(1000), flight::<f32>(1000)]);
    let loose = 1e-3;
    rows.push(spin::<f64, _>(
        "energy-momentum",
        EnergyMomentum::conserving(),
        1e-10,
    ));
    rows.push(spin::<f32, _>(
        "energy-momentum",
        EnergyMomentum::conserving(),
        loose,
    ));
    rows.push(spin::<f64, _>("trapezoidal", Newmark::trapezoidal(), 1e-2));
    rows.push(spin::<f64, _>(
        "Gauss, 2 stages",
        Collocation::gauss(2),
        1e-2,
    ));
    let step = 1e-3;
    let halved = Stepping::Halved { step, halvings: 4 };
    let adaptive = Stepping::Adaptive(Adaptive::to(1e-5));
    for (name, stepping, share) in [
        ("fixed steps", Stepping::Fixed(step), step),
        ("halved steps", halved, step),
        ("adaptive steps", adaptive, 0.1 * step),
    ] {
        rows.push(jump::<f64>(name, stepping, share));
        rows.push(jump::<f32>(name, stepping, share));
    }
    rows.extend(falls());
    rows.push(ramp::<f64>(0.0, Claim::Refusal));
    rows.push(ramp::<f32>(0.0, Claim::Refusal));
    rows.push(ramp::<f64>(1e-300, Claim::Within(1e-3)));
    rows.push(ramp::<f32>(1e-30, Claim::Within(1e-3)));
    rows
}
