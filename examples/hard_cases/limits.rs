//! The ends of the number range: sections about to turn inside out, scenes far from the origin,
//! beams as small as a virus or smaller.

use std::f64::consts::PI;

use ancf::analytical::poisson_locked_ratio;
use ancf::prelude::*;

use crate::model::Chain;
use crate::row::{Answer, Claim, Row, number};

/// Statics without loads from a state whose sections have been squeezed to `share` of their size:
/// the only stable equilibrium is rest.
fn squeezed<R: Real>(share: f64, claim: Claim) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    Row {
        family: "inverted",
        case: format!("sections squeezed to {share} of their size, let go"),
        number: number::<R>(),
        form: "full",
        truth: "rest",
        parameter: share,
        claim,
        long: false,
        run: Box::new(move || {
            let solid = SaintVenantKirchhoff::<R, 2>::isotropic(R::lit(2e7), R::zero())?;
            let mut scene = Scene::<R, 2>::new();
            let beam = Beam::new(
                FullyParameterised,
                Disk::new(R::lit(0.05))?,
                Continuum::full(solid),
            );
            let beam = scene.add(beam.straight([R::zero(); 2], [R::one(), R::zero()], 4))?;
            scene.clamp(beam.start())?;
            let system = scene.assemble()?;
            let mut state = system.rest();
            for node in 1..beam.nodes() {
                let at = system.coordinate(beam.node(node), NodalVector::Slope(1))?;
                state.displacement[at + 1] = R::lit(share - 1.0);
            }
            let report = Statics::default().solve(&system, &mut state)?;
            let left = state
                .displacement
                .iter()
                .fold(0.0_f64, |m, u| m.max(u.value().abs()));
            // An equilibrium that is reported as unstable is not taken for rest by anyone.
            let told = report.unstable.is_none_or(|n| n > 0);
            let error = if told && left > 0.1 { 0.0 } else { left };
            Ok(Answer::statics(1.0 + error, 1.0, &report))
        }),
    }
}

/// A rod pressed along its axis by `load` of `EA`: up to 0.19245 it can carry, by
/// `P / EA = (lambda - lambda^3) / 2`.
fn pressed<R: Real>(load: f64, claim: Claim) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    Row {
        family: "inverted",
        case: format!("rod pressed by {load} EA"),
        number: number::<R>(),
        form: "zero Poisson",
        truth: "softening of the material",
        parameter: load,
        claim,
        long: false,
        run: Box::new(move || {
            let (young, radius) = (2e7, 0.05_f64);
            let solid = SaintVenantKirchhoff::<R, 2>::isotropic(R::lit(young), R::zero())?;
            let mut scene = Scene::<R, 2>::new();
            let form = Continuum::full(solid);
            let beam = Beam::new(FullyParameterised, Disk::new(R::lit(radius))?, form);
            let beam = scene.add(beam.straight([R::zero(); 2], [R::lit(0.1), R::zero()], 2))?;
            scene.pin(beam.start())?;
            scene.fix(beam.start(), NodalVector::Slope(1), [true, false])?;
            let force = load * young * PI * radius * radius;
            scene.force(beam.end(), [R::lit(-force), R::zero()])?;
            let system = scene.assemble()?;
            let mut state = system.rest();
            let report = Statics::in_steps(10).solve(&system, &mut state)?;
            let [x, _] = system.position(&state, beam.end())?;
            let stretch = x.value() / 0.1;
            let carried = 0.5 * (stretch - stretch.powi(3));
            Ok(Answer::statics(carried, load, &report))
        }),
    }
}

/// A cantilever of this length (m) and a hundredth of it in radius.
fn sized<R: Real>(length: f64) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 3>>: Formulation<R, FullyParameterised, 3, 8>,
{
    let radius = 1e-2 * length;
    Row {
        family: "size",
        case: format!("cantilever {length:.0e} m long"),
        number: number::<R>(),
        form: "full",
        truth: "locked Timoshenko",
        parameter: length,
        claim: Claim::Within(1e-4),
        long: false,
        run: Box::new(move || {
            let (young, nu) = (2e11, 0.3);
            let solid = SaintVenantKirchhoff::isotropic(R::lit(young), R::lit(nu))?;
            let mut scene = Scene::<R, 3>::new();
            let disk = Disk::new(R::lit(radius))?;
            let beam = Beam::new(FullyParameterised, disk, Continuum::full(solid));
            let end = [R::lit(length), R::zero(), R::zero()];
            let beam = scene.add(beam.straight([R::zero(); 3], end, 4))?;
            scene.clamp(beam.start())?;
            // Small beside what the section could carry.
            let force = 1e-12 * young * radius * radius;
            scene.force(beam.end(), [R::zero(), R::lit(force), R::zero()])?;
            let system = scene.assemble()?;
            let mut state = system.rest();
            let report = Statics::default().solve(&system, &mut state)?;
            let [_, tip, _] = system.displacement(&state, beam.end())?;
            // Ratios first: the moments themselves may lie outside the range of doubles.
            let bending = 4.0 / 3.0 * 1e6 / PI * poisson_locked_ratio(nu)? * (1.0 - 1.0 / 64.0);
            let shear = 2.0 * (1.0 + nu) * 1e2 / PI * 1e-2 * 1e2;
            let truth = 1e-12 * radius * (bending + shear);
            Ok(Answer::statics(tip.value(), truth, &report))
        }),
    }
}

/// The small cantilever, far away.
fn far<R: Real>(origin: f64) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let radius = 1e-2;
    Row {
        family: "far",
        case: format!("cantilever {origin:.0e} m from the origin"),
        number: number::<R>(),
        form: "full",
        truth: "Timoshenko, element by element",
        parameter: origin,
        claim: Claim::Within(0.03 * radius * radius),
        long: false,
        run: Box::new(move || {
            let chain = Chain {
                radius,
                parts: &[(4, 1.0), (4, 1.0)],
                load: 1e-8,
                origin,
            };
            let (tip, report) = chain.tip::<R, _>(Continuum::full)?;
            Ok(Answer::statics(tip, chain.truth(), &report))
        }),
    }
}

/// All rows of this file.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for share in [0.7, 0.58, 0.3, 1e-3] {
        rows.push(squeezed::<f64>(share, Claim::Within(1e-9)));
        rows.push(squeezed::<f32>(share, Claim::Within(1e-4)));
    }
    for share in [0.0, -0.5, -1.0] {
        rows.push(squeezed::<f64>(share, Claim::Refusal));
        rows.push(squeezed::<f32>(share, Claim::Refusal));
    }
    rows.push(pressed::<f64>(0.19, Claim::Within(1e-8)));
    rows.push(pressed::<f32>(0.19, Claim::Within(1e-4)));
    for load in [0.2, 10.0] {
        rows.push(pressed::<f64>(load, Claim::Refusal));
        rows.push(pressed::<f32>(load, Claim::Refusal));
    }
    for origin in [0.0, 1e3, 1e6] {
        rows.extend([far::<f64>(origin), far::<f32>(origin)]);
    }
    for length in [1e30, 1e-6, 1e-9, 1e-30, 1e-48, 1e-60, 1e-100] {
        rows.push(sized::<f64>(length));
    }
    for length in [1e3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-9, 1e-12] {
        rows.push(sized::<f32>(length));
    }
    rows
}
