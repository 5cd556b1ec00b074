//! Two sections the library does not have: a round bar with hole and slot by its outline alone, a
//! hexagon as a type with its own rule. Cantilevers are bent; printed is the deflection over
//! Euler-Bernoulli's, which 16 elements meet but for 1/1024 of stiffness and a little shear.

use ancf::prelude::*;
use ancf::quadrature::{Cubature, gauss_legendre};

/// A regular hexagon with two corners on the z axis, of circumradius `self.0` (m).
#[derive(Debug)]
struct Hexagon(f64);

impl Section<f64> for Hexagon {
    /// Gauss points on each of the six triangles around the centre, collapsed squares.
    fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
        let line = gauss_legendre::<f64>((degree + 3) / 2)?;
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        let corners = &self.outline(6)[0];
        let places = |k: usize| line.iter().map(move |r| (k, r));
        let pairs = |x| line.iter().map(move |s| (x, s));
        for ((k, ([r], v)), ([s], w)) in (0..6).flat_map(places).flat_map(pairs) {
            let (p, q) = (corners[k], corners[(k + 1) % 6]);
            points.push([0, 1].map(|c| r * (p[c] + s * (q[c] - p[c]))));
            weights.push(v * w * r * (p[0] * q[1] - p[1] * q[0]));
        }
        Cubature::new(points, weights, degree)
    }

    fn outline(&self, _n: usize) -> Vec<Vec<[f64; 2]>> {
        let corner = |k| <[f64; 2]>::from((f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos());
        let corners = (0..6).rev().map(corner);
        vec![corners.map(|p| p.map(|x| self.0 * x)).collect()]
    }
}

fn bend(name: &str, section: impl Section<f64>) -> Result<()> {
    let (young, length, load) = (2.0e11, 1.0, 10.0);
    let exact = load * f64::powi(length, 3) / (3.0 * young * section.properties()?.izz);
    let steel = SaintVenantKirchhoff::isotropic(young, 0.0)?;
    let mut scene = Scene::<f64, 3>::new();
    let beam = Beam::new(FullyParameterised, section, Continuum::full(steel));
    let beam = scene.add(beam.straight([0.0; 3], [length, 0.0, 0.0], 16))?;
    scene.clamp(beam.start())?;
    scene.force(beam.end(), [0.0, -load, 0.0])?;
    let system = scene.assemble()?;
    let mut state = system.rest();
    Statics::in_steps(1).solve(&system, &mut state)?;
    let ratio = -system.position(&state, beam.end())?[1] / exact;
    println!("{name}: tip {ratio:.5} of {exact:.5e} m");
    Ok(())
}

fn main() -> Result<()> {
    let (r, q, s) = (0.02_f64, 0.008_f64, 0.004_f64);
    let at = |radius: f64| (radius * radius - s * s).sqrt();
    let bulge = |radius: f64| ((std::f64::consts::PI - (s / radius).asin()) / 2.0).tan();
    let bar = Loop::start([at(r), s]).arc_to([at(r), -s], bulge(r));
    let keyhole = bar.line_to([at(q), -s]).arc_to([at(q), s], -bulge(q));
    bend("keyhole", Outline::new(keyhole)?.centred()?)?;
    bend("hexagon", Hexagon(0.02))
}
