//! Slender beams, nearly incompressible ones, long chains and unequal neighbours: where statics
//! loses its digits.

use std::f64::consts::PI;

use ancf::analytical::{Elastica, fully_parameterised_tip_ratio, poisson_locked_ratio};
use ancf::prelude::*;

use crate::model::Chain;
use crate::row::{Answer, Claim, Row, number};

const RADII: [f64; 5] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5];

fn small<R: Real>(radius: f64) -> [Row; 2]
where
    CoMoving<Continuum<SaintVenantKirchhoff<R, 2>>>: Formulation<R, FullyParameterised, 2, 6>,
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    [false, true].map(|moving| Row {
        family: "slender, small load",
        case: format!("cantilever of 8 elements, R/L = {radius:.0e}"),
        number: number::<R>(),
        form: if moving { "co-moving" } else { "full" },
        truth: "Timoshenko, element by element",
        parameter: radius,
        claim: Claim::Within(0.03 * radius.powi(2)),
        long: false,
        run: Box::new(move || {
            let chain = Chain {
                radius,
                parts: &[(8, 1.0)],
                load: 3e-6 * radius,
                origin: 0.0,
            };
            let (tip, report) = match moving {
                true => chain.tip::<R, _>(|m| CoMoving(Continuum::full(m)))?,
                false => chain.tip::<R, _>(Continuum::full)?,
            };
            Ok(Answer::statics(tip, chain.truth(), &report))
        }),
    })
}

/// A load that bends by half a radian, on as many elements as thickness locking needs to cost
/// less than a thousandth.
fn bent<R: Real>(radius: f64) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let n = ((0.18 * radius.powi(2)).powf(-0.25).ceil() as usize).max(8);
    let mesh = 0.25 / (n as f64).powi(2) + 1e-3;
    Row {
        family: "slender, bent",
        case: format!("cantilever of {n} elements, P L^2/EI = 1, R/L = {radius:.0e}"),
        number: number::<R>(),
        form: "full",
        truth: "elastica",
        parameter: radius,
        claim: Claim::Within(mesh + 2.0 * radius.powi(2)),
        long: false,
        run: Box::new(move || {
            let chain = Chain {
                radius,
                parts: &[(n, 1.0)],
                load: 1.0,
                origin: 0.0,
            };
            let (tip, report) = chain.tip::<R, _>(Continuum::full)?;
            let truth = Elastica::under_transverse_load(1.0)?.deflection;
            Ok(Answer::statics(tip, truth, &report))
        }),
    }
}

/// Tip of a spatial cantilever over Timoshenko's.
fn poisson<R: Real>(nu: f64, remedy: &'static str) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 3>>: Formulation<R, FullyParameterised, 3, 8>,
{
    const N: usize = 8;
    let (young, radius) = (1e7, 1e-2_f64);
    let locks = matches!(remedy, "full" | "reduced");
    Row {
        family: "Poisson",
        case: format!("cantilever of {N} elements, nu = {nu}"),
        number: number::<R>(),
        form: remedy,
        truth: if locks {
            "locked Timoshenko"
        } else {
            "Timoshenko"
        },
        parameter: nu,
        // The clamp, which holds the section, counts more the more bending is locked.
        claim: Claim::Within(match locks {
            true => (1e-5 + 1e-6 / (1.0 - 2.0 * nu)).min(2e-2),
            false => 1e-5,
        }),
        long: false,
        run: Box::new(move || {
            let solid = SaintVenantKirchhoff::isotropic(R::lit(young), R::lit(nu))?;
            let form = match remedy {
                "full" => Continuum::full(solid),
                "reduced" => Continuum::reduced(solid),
                "selective" => Continuum::selective_reduced(solid),
                _ => Continuum::zero_poisson(solid),
            };
            let mut scene = Scene::<R, 3>::new();
            let beam = Beam::new(FullyParameterised, Disk::new(R::lit(radius))?, form);
            let end = [R::one(), R::zero(), R::zero()];
            let beam = scene.add(beam.straight([R::zero(); 3], end, N))?;
            scene.clamp(beam.start())?;
            let load = 1e-8;
            scene.force(beam.end(), [R::zero(), R::lit(load), R::zero()])?;
            let system = scene.assemble()?;
            let mut state = system.rest();
            let report = Statics::default().solve(&system, &mut state)?;
            let [_, tip, _] = system.displacement(&state, beam.end())?;
            let bending = 4.0 / (3.0 * young * PI * radius.powi(4));
            let shear = 2.0 * (1.0 + nu) / (young * PI * radius.powi(2));
            let softer = if locks {
                poisson_locked_ratio(nu)?
            } else {
                1.0
            };
            let truth = bending * softer * fully_parameterised_tip_ratio::<f64>(N)? + shear;
            let answer = Answer::statics(tip.value() / load, truth, &report);
            // For the figure: how far from the true beam.
            let error = (tip.value() / load / (bending + shear) - 1.0).abs();
            Ok(answer.with_curve(vec![[nu, error]]))
        }),
    }
}

/// Two beams of very unequal stiffness, or one of very many elements.
fn chain<R: Real>(case: &'static str, parts: &'static [(usize, f64)], radius: f64) -> Row
where
    Continuum<SaintVenantKirchhoff<R, 2>>: Formulation<R, FullyParameterised, 2, 6>,
{
    let n: usize = parts.iter().map(|(n, _)| n).sum();
    Row {
        family: "chain",
        case: format!("{case}, R/L = {radius:.0e}"),
        number: number::<R>(),
        form: "full",
        truth: "Timoshenko, element by element",
        parameter: n as f64,
        claim: Claim::Within(0.1 * radius.powi(2)),
        long: false,
        run: Box::new(move || {
            let chain = Chain {
                radius,
                parts,
                load: 1e-6 * radius,
                origin: 0.0,
            };
            let (tip, report) = chain.tip::<R, _>(Continuum::full)?;
            Ok(Answer::statics(tip, chain.truth(), &report))
        }),
    }
}

/// Poisson ratios of the study.
pub const POISSON: [f64; 8] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.49, 0.4999, 0.499_999_9];

/// All rows of this file.
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for radius in RADII {
        rows.extend(small::<f64>(radius));
        rows.extend(small::<f32>(radius));
    }
    for radius in RADII {
        rows.extend([bent::<f64>(radius), bent::<f32>(radius)]);
    }
    for remedy in ["full", "reduced", "selective", "zero Poisson"] {
        rows.extend(POISSON.map(|nu| poisson::<f64>(nu, remedy)));
    }
    for remedy in ["full", "reduced", "selective", "zero Poisson"] {
        rows.extend([0.0, 0.3, 0.4999, 0.499_999_9].map(|nu| poisson::<f32>(nu, remedy)));
    }
    for (case, parts, radius) in [
        ("10 000 elements", &[(10_000, 1.0)][..], 1e-1),
        ("10 000 elements", &[(10_000, 1.0)], 1e-2),
        ("root 1e6 stiffer than tip", &[(8, 1e6), (8, 1.0)], 1e-2),
        ("root 1e6 softer than tip", &[(8, 1.0), (8, 1e6)], 1e-2),
    ] {
        rows.push(chain::<f64>(case, parts, radius));
        rows.push(chain::<f32>(case, parts, radius));
    }
    rows
}
