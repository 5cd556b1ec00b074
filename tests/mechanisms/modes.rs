//! Frequencies and buckling loads under nonlinear constraints, against the closed forms of beams.

use ancf::prelude::*;

const RADIUS: f64 = 0.002;
const YOUNG: f64 = 2.0e11;
const DENSITY: f64 = 7800.0;

/// The limit of values on meshes of 8 and 16 elements, whose error is of second order (a director's
/// curvature is constant within an element), to the fourth.
fn limit(value: impl Fn(usize) -> f64) -> f64 {
    (4.0 * value(16) - value(8)) / 3.0
}

fn rod(n: usize) -> (Scene<f64, 2>, Placed) {
    let steel = SaintVenantKirchhoff::isotropic(YOUNG, 0.0).unwrap();
    let disk = Disk::new(RADIUS).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(steel));
    let mut scene = Scene::<f64, 2>::new();
    let beam = beam.straight([0.0; 2], [1.0, 0.0], n).density(DENSITY);
    let beam = scene.add(beam).unwrap();
    (scene, beam)
}

/// The frequencies of a cantilever with a body at its tip, its mass and rotary inertia in those of
/// the beam, `mu = m / (rho A l)` and `nu = J / (rho A l^3)`: roots of the determinant of
/// `w'' = nu b^4 w'`, `w''' = -mu b^4 w` at the tip.
#[test]
fn a_cantilever_carries_a_body() {
    let area = std::f64::consts::PI * RADIUS * RADIUS;
    let beam = DENSITY * area;
    let (mass, inertia) = (0.5 * beam, 0.02 * beam);
    let frequency = |n: usize, k: usize| {
        let (mut scene, rod) = rod(n);
        let mut tensor = [[0.0; 3]; 3];
        tensor[2][2] = inertia;
        let body = RigidBody::new(mass, tensor).at([1.0, 0.0]);
        let body = scene.add_body(body).unwrap();
        scene.clamp(rod.start()).unwrap();
        scene.join(rod.end(), body.start(), Joint::Rigid).unwrap();
        let system = scene.assemble().unwrap();
        let modes = Modes::lowest(3).vibration(&system, &system.rest(), 1.0);
        modes.unwrap()[k].frequency()
    };
    let determinant = |b: f64| {
        let (mu, nu) = (mass / beam * b, inertia / beam * b.powi(3));
        let (s, c, sh, ch) = (b.sin(), b.cos(), b.sinh(), b.cosh());
        let moment = [ch + c - nu * (sh + s), sh + s - nu * (ch - c)];
        let force = [sh - s + mu * (ch - c), ch + c + mu * (sh - s)];
        moment[0] * force[1] - moment[1] * force[0]
    };
    let mut roots = Vec::new();
    let mut b = 0.1;
    while roots.len() < 3 {
        let (mut low, mut high) = (b, b + 0.05);
        if determinant(low) * determinant(high) < 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                match determinant(low) * determinant(middle) > 0.0 {
                    true => low = middle,
                    false => high = middle,
                }
            }
            roots.push(low);
        }
        b += 0.05;
    }
    let unit = (YOUNG * area * RADIUS * RADIUS / 4.0 / beam).sqrt();
    for (k, b) in roots.into_iter().enumerate() {
        let ratio = limit(|n| frequency(n, k)) / (b * b * unit);
        // The fourth order leaves 2e-4 of the third mode, shear 1e-4.
        assert!((ratio - 1.0).abs() < 1e-3, "{k}: {ratio}");
    }
}

/// A point on the line `y = 0`, said in a way that is not linear.
#[derive(Debug)]
struct Guide;

impl Constraint<f64, 2, 1, 1> for Guide {
    fn residual<T: Algebra<f64>>(&self, _: T, [[_, y]]: &[[T; 2]; 1]) -> [T; 1] {
        [*y + *y * *y * *y]
    }
}

/// A column clamped at one end and guided at the other buckles at `20.1907 E I / l^2`.
#[test]
fn a_guided_column_buckles() {
    let load = |n: usize| {
        let (mut scene, rod) = rod(n);
        scene.clamp(rod.start()).unwrap();
        let tip = [(rod.end(), NodalVector::Position)];
        scene.bind(tip, Guide).unwrap();
        scene.force(rod.end(), [-1.0, 0.0]).unwrap();
        let system = scene.assemble().unwrap();
        let modes = Modes::lowest(1).buckling(&system, &system.rest(), 0.0);
        modes.unwrap()[0].value
    };
    let stiffness = YOUNG * std::f64::consts::PI * RADIUS.powi(4) / 4.0;
    let ratio = limit(load) / (20.1907 * stiffness);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}
