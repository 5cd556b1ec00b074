//! What single and double precision lose on slender beams: the error of the transverse elastic
//! force of a cantilever under `P = E I / L^2`, over that load, with the library's strain and
//! with the textbook's, `(J^T J - I)/2`; each against double-double at the very same state.
//! `cargo run --release --features double-double --example precision_study`

mod plot;

use ancf::formulation::{Reference, Sample::*, SampledKernel, SectionLaw};
use ancf::prelude::*;
use ancf::quadrature::gauss_legendre;
use ancf::scalar::DoubleDouble;
use num_dual::DualNum;
use num_traits::Zero;
use std::array::from_fn;

/// A material whose strain is formed from total nodal vectors, as textbooks do.
#[derive(Debug, Clone)]
struct Textbook<M>(M);
#[derive(Debug)]
struct TextbookSection<M, R>(M, Cubature<R, 2>);

impl<R: Real, M: Material<R, 3>> SectionLaw<R, 3, 5> for TextbookSection<M, R> {
    fn energy<T: Algebra<R>>(&self, _: &[[R; 3]; 5], g: &[[T; 3]; 5]) -> T {
        self.1.integrate(|[y, z]| {
            let first = from_fn(|c| g[0][c] + g[3][c].times(y) + g[4][c].times(z));
            let j: [[T; 3]; 3] = [first, g[1], g[2]];
            let dot =
                |a: usize, b: usize| j[a][0] * j[b][0] + j[a][1] * j[b][1] + j[a][2] * j[b][2];
            let unit = |a, b| if a == b { T::one() } else { T::zero() };
            let strain = |a, b| (dot(a, b) - unit(a, b)).times(R::lit(0.5));
            self.0.energy(&from_fn(|a| from_fn(|b| strain(a, b))))
        })
    }
}

impl<R: Real, M: Material<R, 3>> Formulation<R, FullyParameterised, 3, 8> for Textbook<M> {
    type Kernel = SampledKernel<R, TextbookSection<M, R>, 3, 8, 5>;
    fn kernel(
        &self,
        element: &FullyParameterised,
        reference: &Reference<R, 3, 8>,
        section: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        let law = TextbookSection(self.0.clone(), section.rule(5)?);
        let samples = [First(0), First(1), First(2), Second(0, 1), Second(0, 2)];
        Ok(SampledKernel::new().with_part(element, reference, law, samples, &gauss_legendre(5)?))
    }
}

/// A cantilever of length 1 and ten elements with unit bending stiffness and tip load.
fn cantilever<R: Real>(radius: f64, textbook: bool) -> Result<System<R, 3>> {
    let young = (4.0 / std::f64::consts::PI / radius.powi(4)) as f32;
    // Rounded to single precision, so that the beam is the same in every type.
    let material = SaintVenantKirchhoff::isotropic(R::lit(young.into()), R::zero())?;
    let section = Disk::new(R::lit((radius as f32).into()))?;
    let end = [R::one(), R::zero(), R::zero()];
    let mut scene = Scene::new();
    let beam = if textbook {
        let beam = Beam::new(FullyParameterised, section, Textbook(material));
        scene.add(beam.straight([R::zero(); 3], end, 10))?
    } else {
        let beam = Beam::new(FullyParameterised, section, Continuum::full(material));
        scene.add(beam.straight([R::zero(); 3], end, 10))?
    };
    scene.clamp(beam.start())?;
    scene.force(beam.end(), [R::zero(), R::one(), R::zero()])?;
    scene.assemble()
}

/// Nodal vectors and the transverse direction.
type Shape = (Vec<DoubleDouble>, [DoubleDouble; 3]);

fn turned(e: &[DoubleDouble], angle: f64) -> Shape {
    let angle = DoubleDouble::lit(angle);
    let (s, c) = (Field::sin(angle), Field::cos(angle));
    let turn = |v: &[DoubleDouble]| [v[0] * c - v[1] * s, v[0] * s + v[1] * c, v[2]];
    (e.chunks(3).flat_map(turn).collect(), [-s, c, Zero::zero()])
}

/// Equilibrium as the element finds it, the same turned by 2 rad, and a shape bent like a true
/// beam's; locking leaves the first two straighter the thinner the beam.
fn shapes(radius: f64) -> Result<[Shape; 3]> {
    let system = cantilever::<DoubleDouble>(radius, false)?;
    let mut state = system.rest();
    Statics::in_steps(10).solve(&system, &mut state)?;
    let both = system.reference().iter().zip(&state.displacement);
    let e: Vec<_> = both.map(|(e, u)| *e + *u).collect();
    let (mut bent, mut r, lit) = (Vec::new(), [DoubleDouble::lit(0.0); 2], DoubleDouble::lit);
    let direction = |s: DoubleDouble| DualNum::sin_cos(&(s * (-s + 2.0) * 0.46));
    for node in 0..=10 {
        let s = lit(f64::from(node)) / 10.0;
        for ([x], w) in gauss_legendre::<DoubleDouble>(8)?
            .iter()
            .filter(|_| node > 0)
        {
            let (sin, cos) = direction(s + (x - 1.0) / 10.0);
            r = [r[0] + cos * w / 10.0, r[1] + sin * w / 10.0];
        }
        let ((sin, cos), o) = (direction(s), lit(0.0));
        bent.extend([r[0], r[1], o, cos, sin, o, -sin, cos, o, o, o, lit(1.0)]);
    }
    Ok([turned(&e, 0.0), turned(&e, 2.0), turned(&bent, 0.0)])
}

/// Largest error of a node's force along the transverse direction, in the type `R`.
fn error<R: Real>(radius: f64, textbook: bool, (e, across): &Shape) -> Result<f64> {
    let system = cantilever::<R>(radius, textbook)?;
    let exact = cantilever::<DoubleDouble>(radius, textbook)?;
    let given = |(e, e0): (&DoubleDouble, &DoubleDouble)| match textbook {
        true => R::lit(e.value()),
        false => R::lit((*e - *e0).value()),
    };
    let x: Vec<R> = e.iter().zip(exact.reference()).map(given).collect();
    let same: Vec<_> = x.iter().map(|x| DoubleDouble::lit(x.value())).collect();
    let mut q = (vec![R::zero(); x.len()], vec![Zero::zero(); x.len()]);
    system.add_internal(&x, &mut q.0);
    exact.add_internal(&same, &mut q.1);
    let off = |i: usize| (-q.1[i] + q.0[i].value()).value();
    let along = |i: usize| (0..3).map(|c| off(i + c) * across[c].value()).sum::<f64>();
    Ok((12..x.len())
        .step_by(12)
        .map(|i| along(i).abs())
        .fold(0.0, f64::max))
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let names = [
        "f32, textbook",
        "f32, displacements",
        "f64, textbook",
        "f64, displacements",
    ];
    let mut sheet = ["equilibrium", "turned by 2 rad", "bent by 0.46 rad"]
        .map(|title| (title, names.map(|name| (name, Vec::new()))));
    println!(
        "R/L     {}",
        sheet
            .each_ref()
            .map(|(title, _)| format!("{title:42}"))
            .concat()
    );
    println!(
        "      {}",
        "f32: C         H    f64: C         H  ".repeat(3)
    );
    for radius in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
        print!("{radius:.0e}  ");
        for ((_, curves), shape) in sheet.iter_mut().zip(shapes(radius)?) {
            let single = [true, false].map(|form| error::<f32>(radius, form, &shape));
            let double = [true, false].map(|form| error::<f64>(radius, form, &shape));
            for (curve, error) in curves.iter_mut().zip(single.into_iter().chain(double)) {
                let error = error?;
                curve.1.push((radius, error));
                print!("{error:10.1e}");
            }
            print!("  ");
        }
        println!();
    }
    plot::draw("target/precision-study", &sheet)
}
