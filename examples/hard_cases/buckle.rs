//! Large rotations and lost stability: a rod rolled up three times, snap-through, buckling in the
//! plane and sideways.

use std::f64::consts::PI;

use ancf::analytical::{BendingSection, EndMoment, pure_bending};
use ancf::formulation::CableEnergy;
use ancf::prelude::*;

use crate::row::{Answer, Claim, Row, number};

/// A rod rolled up by an end moment that would make `turns` of a linear one.
fn roll_up<R: Real>(turns: u8, n: usize, radius: f64) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    // Straight directors turn by (kappa h)^2 / 12 less and shrink between nodes.
    let element = 2.0 * PI * f64::from(turns) / n as f64;
    let lag = element.powi(2) / 12.0 + (element / n as f64 / radius).powi(2) / 90.0;
    Row {
        family: "roll-up",
        case: format!("{turns} turns, {n} elements, R/L = {radius}"),
        number: number::<R>(),
        form: "full",
        truth: "exact section model",
        parameter: f64::from(turns),
        claim: Claim::Within(1.2 * lag),
        long: false,
        run: Box::new(move || {
            let young = 2e11;
            let solid = SaintVenantKirchhoff::isotropic(R::lit(young), R::zero())?;
            let mut scene = Scene::<R, 2>::new();
            let disk = Disk::new(R::lit(radius))?;
            let rod = Beam::new(FullyParameterised, disk, Continuum::full(solid));
            let rod = scene.add(rod.straight([R::zero(); 2], [R::one(), R::zero()], n))?;
            scene.clamp(rod.start())?;
            let turn = 2.0 * PI * young * PI * radius.powi(4) / 4.0;
            let moment = f64::from(turns) * turn;
            scene.moment(rod.end(), Moment::about_z(R::lit(moment)))?;
            let system = scene.assemble()?;
            let mut state = system.rest();
            let statics = Statics::in_steps(10 * usize::from(turns));
            let report = statics.solve(&system, &mut state)?;
            let section = BendingSection::disk(young, radius);
            let exact = pure_bending(&section, moment, EndMoment::Conjugate)?;
            let curvature = exact.curvature / exact.axial_stretch;
            let truth = [
                exact.curvature.sin() / curvature,
                (1.0 - exact.curvature.cos()) / curvature,
            ];
            let tip = system.position(&state, rod.end())?.map(Real::value);
            let error = (tip[0] - truth[0]).hypot(tip[1] - truth[1]);
            let at = |k: u16| R::lit(f64::from(k) / 400.0);
            let point = |k| system.point(&state, rod.start(), at(k), [R::zero(); 2]);
            let curve: Result<Vec<_>> = (0..=400).map(point).collect();
            let curve = curve?.into_iter().map(|p| p.map(Real::value)).collect();
            let answer = Answer::statics(1.0 + error, 1.0, &report);
            Ok(answer.with_curve(curve))
        }),
    }
}

/// Two bars that meet at a height, pushed through; by `P = EA z (h^2 - z^2) / L^3` at the height z.
fn snap_through<R: Real>(height: f64) -> Row
where
    EulerBernoulli<R>: Formulation<R, Cable, 2, 4>,
{
    Row {
        family: "snap-through",
        case: format!("truss of height {height}, limit load and path"),
        number: number::<R>(),
        form: "cable",
        truth: "closed form",
        parameter: height,
        claim: Claim::Within((300.0 * R::EPSILON / height.powi(2)).max(1e-6)),
        long: false,
        run: Box::new(move || {
            let lit = R::lit;
            let length = (1.0 + height * height).sqrt();
            let limit = 2.0 * height.powi(3) / (3.0 * 3_f64.sqrt() * length.powi(3));
            let bar = EulerBernoulli::with_stiffness(R::one(), R::one())?
                .with_energy(CableEnergy::GeometricCurvature);
            let mut scene = Scene::<R, 2>::new();
            let one = R::one();
            let bar = Beam::new(Cable, Moments::new(one, one, one)?, bar);
            let [foot, top, far] = [[0.0, 0.0], [1.0, height], [2.0, 0.0]].map(|p| p.map(lit));
            let left = scene.add(bar.clone().straight(foot, top, 1))?;
            let right = scene.add(bar.straight(top, far, 1))?;
            scene.pin(left.start())?;
            scene.pin(right.end())?;
            scene.join(left.end(), right.start(), Joint::Spherical)?;
            scene.fix(left.end(), NodalVector::Position, [true, false])?;
            scene.force(left.end(), [R::zero(), lit(-limit)])?;
            let system = scene.assemble()?;
            let at = system.coordinate(left.end(), NodalVector::Position)? + 1;
            let settings = Path {
                locate: Some(R::EPSILON.sqrt().max(1e-6)),
                longest: 0.05 * height,
                ..Path::by(Control::Coordinate(at), -0.05 * height)
            };
            let mut path = Continuation::start(&system, system.rest(), R::zero(), &settings)?;
            let (mut curve, mut worst) = (vec![[0.0, 0.0]], 0.0_f64);
            path.until(Target::Coordinate(at, lit(-2.2 * height)), |point| {
                let z = height + point.state.displacement[at].value();
                let truth = z * (height * height - z * z) / length.powi(3) / limit;
                worst = worst.max((point.factor.value() - truth).abs());
                curve.push([(height - z) / height, point.factor.value()]);
            })?;
            for (critical, truth) in path.criticals().iter().zip([1.0, -1.0]) {
                worst = worst.max((critical.factor.value() - truth).abs());
            }
            let missed = if path.criticals().len() == 2 {
                0.0
            } else {
                1.0
            };
            Ok(Answer::path(1.0 + worst.max(missed), 1.0, &path).with_curve(curve))
        }),
    }
}

/// Euler's column of length and bending stiffness 1, axially stiffer by `axial`: 1 over the
/// slenderness squared.
fn column<R: Real>(axial: f64) -> Row
where
    EulerBernoulli<R>: Formulation<R, Cable, 2, 4>,
{
    Row {
        family: "column",
        case: format!("clamped column, EA L^2/EI = {axial:.0e}"),
        number: number::<R>(),
        form: "cable",
        truth: "Euler",
        parameter: axial,
        // The column shortens before it buckles; rounding of its axial stiffness counts.
        claim: Claim::Within(1e-5 + 4.0 / axial + 32.0 * R::EPSILON * axial),
        long: false,
        run: Box::new(move || {
            let rule = EulerBernoulli::with_stiffness(R::lit(axial), R::one())?;
            let one = R::one();
            let beam = Beam::new(Cable, Moments::new(one, one, one)?, rule);
            let mut scene = Scene::<R, 2>::new();
            let beam = scene.add(beam.straight([R::zero(); 2], [one, R::zero()], 32))?;
            scene.pin(beam.start())?;
            scene.fix(beam.start(), NodalVector::Slope(0), [false, true])?;
            scene.force(beam.end(), [R::lit(-PI * PI / 4.0), R::zero()])?;
            let system = scene.assemble()?;
            let settings = Path {
                locate: Some(R::EPSILON.sqrt().max(1e-6)),
                ..Path::by(Control::Sphere, 0.3)
            };
            let mut path = Continuation::start(&system, system.rest(), R::zero(), &settings)?;
            path.until(Target::Critical, |_| {})?;
            let critical = &path.criticals()[0];
            Ok(Answer::path(critical.factor.value(), 1.0, &path))
        }),
    }
}

/// A cantilever stiff in its plane under a tip load, which buckles sideways at
/// `4.01260 sqrt(EI GJ) / L^2` (Prandtl 1899, Michell 1899) when rigid in the plane; and the path
/// with a small force across.
fn lateral<R: Real>(across: f64) -> Row
where
    StructuralMechanics<R>: Formulation<R, Quadratic, 3, 9>,
{
    const PRANDTL: f64 = 4.012_599;
    Row {
        family: "lateral",
        case: match across {
            0.0 => "lateral buckling, critical load".into(),
            _ => format!("lateral buckling, {across:.0e} of the load across"),
        },
        number: number::<R>(),
        form: "structural",
        truth: "Prandtl",
        parameter: across,
        claim: Claim::Within(match across {
            // The beam bends by P L^2 / EI in its plane before.
            0.0 => 2e-3,
            // Where it has gone aside by a tenth of its length.
            _ => 0.3,
        }),
        long: false,
        run: Box::new(move || {
            let stiffness = BeamStiffness {
                axial: R::lit(1e6),
                shear: [R::lit(1e6); 2],
                torsion: R::one(),
                bending: [R::one(), R::lit(1e4)],
            };
            let (zero, one) = (R::zero(), R::one());
            let rule = StructuralMechanics::with_stiffness(stiffness)?;
            let beam = Beam::new(Quadratic, Moments::new(one, one, one)?, rule);
            let mut scene = Scene::<R, 3>::new();
            let beam = scene.add(beam.straight([zero; 3], [one, zero, zero], 8))?;
            scene.clamp(beam.start())?;
            let force = [0.0, PRANDTL, PRANDTL * across].map(R::lit);
            scene.force(beam.end(), force)?;
            let system = scene.assemble()?;
            let at = system.coordinate(beam.end(), NodalVector::Position)? + 2;
            let settings = Path {
                locate: Some(R::EPSILON.sqrt().max(1e-6)),
                ..Path::by(Control::Sphere, 0.05)
            };
            let mut path = Continuation::start(&system, system.rest(), zero, &settings)?;
            if across == 0.0 {
                path.until(Target::Critical, |_| {})?;
                let factor = path.criticals()[0].factor.value();
                return Ok(Answer::path(factor, 1.0, &path));
            }
            let mut curve = vec![[0.0, 0.0]];
            let mut found = f64::NAN;
            path.until(Target::Factor(R::lit(1.3)), |point| {
                let aside = point.state.displacement[at].value();
                if found.is_nan() && aside.abs() > 0.1 {
                    found = point.factor.value();
                }
                curve.push([aside, point.factor.value()]);
            })?;
            Ok(Answer::path(found, 1.0, &path).with_curve(curve))
        }),
    }
}

/// All rows of this file.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for turns in 1..=3 {
        rows.push(roll_up::<f64>(turns, 160, 5e-3));
        rows.push(roll_up::<f32>(turns, 80, 1e-2));
    }
    for height in [0.3, 1e-2, 1e-4] {
        rows.extend([snap_through::<f64>(height), snap_through::<f32>(height)]);
    }
    for axial in [1e4, 1e6, 1e8, 1e10] {
        rows.extend([column::<f64>(axial), column::<f32>(axial)]);
    }
    rows.extend([0.0, 1e-2, 1e-3, 1e-4].map(lateral::<f64>));
    rows.extend([0.0, 1e-2].map(lateral::<f32>));
    rows
}
