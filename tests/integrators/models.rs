//! Structures of one unknown, and beams, that the claims are made about.

use ancf::prelude::*;
use ancf::solver::{Matrix, Profile, Unknowns};

/// A particle of unit mass in the potential `U(q)`: `q'' = -U'(q)`.
pub trait Potential {
    fn force(&self, q: f64) -> f64;
    fn stiffness(&self, q: f64) -> f64;
    /// `(U(b) - U(a)) / (b - a)` and its derivative by `b`.
    fn secant(&self, _a: f64, _b: f64) -> Option<[f64; 2]> {
        None
    }
}

/// A mathematical pendulum, `q'' = -sin q`.
pub struct Swing;

/// `(1 - cos x) / x`-like quotients lose their digits near zero; halves of the angle keep them.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        x.sin() / x
    }
}

fn sinc_slope(x: f64) -> f64 {
    match x.abs() < 1e-3 {
        true => -x / 3.0 + x.powi(3) / 30.0,
        false => (x.cos() - x.sin() / x) / x,
    }
}

impl Potential for Swing {
    fn force(&self, q: f64) -> f64 {
        q.sin()
    }
    fn stiffness(&self, q: f64) -> f64 {
        q.cos()
    }
    fn secant(&self, a: f64, b: f64) -> Option<[f64; 2]> {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let slope = middle.cos() * sinc(half) + middle.sin() * sinc_slope(half);
        Some([middle.sin() * sinc(half), 0.5 * slope])
    }
}

/// A spring of this natural frequency, `q'' = -omega^2 q`.
pub struct Spring(pub f64);

impl Potential for Spring {
    fn force(&self, q: f64) -> f64 {
        self.0 * self.0 * q
    }
    fn stiffness(&self, _: f64) -> f64 {
        self.0 * self.0
    }
    fn secant(&self, a: f64, b: f64) -> Option<[f64; 2]> {
        let half = 0.5 * self.stiffness(0.0);
        Some([half * (a + b), half])
    }
}

pub struct Particle<P> {
    pub potential: P,
    unknowns: Unknowns<f64>,
}

impl<P> Particle<P> {
    pub fn new(potential: P) -> Self {
        let unknowns = Unknowns::all(Profile::from_ranges(1, [0..1]).unwrap());
        Self {
            potential,
            unknowns,
        }
    }

    pub fn at(&self, q: f64, v: f64) -> State<f64> {
        State {
            time: 0.0,
            displacement: vec![q],
            velocity: vec![v],
            acceleration: vec![0.0],
            work: 0.0,
        }
    }
}

impl<P: Potential> Structure<f64> for Particle<P> {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.unknowns
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[f64] {
        &[1.0]
    }
    fn add_internal(&self, u: &[f64], q: &mut [f64]) {
        q[0] += self.potential.force(u[0]);
    }
    fn add_tangent(&self, _: f64, _: f64, u: &[f64], k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, self.potential.stiffness(u[0]))
    }
    fn secant(&self) -> Secant {
        self.potential
            .secant(0.0, 1.0)
            .map_or(Secant::Absent, |_| Secant::Path)
    }
    fn add_secant(&self, _: f64, from: &[f64], to: &[f64], q: &mut [f64]) {
        q[0] += self.potential.secant(from[0], to[0]).unwrap()[0];
    }
    fn add_secant_tangent(
        &self,
        _: (f64, f64),
        _: f64,
        from: &[f64],
        to: &[f64],
        k: &mut Matrix<f64>,
    ) -> Result<()> {
        k.add(0, 0, self.potential.secant(from[0], to[0]).unwrap()[1])
    }
    fn has_mass(&self) -> bool {
        true
    }
    fn add_mass_times(&self, factor: f64, a: &[f64], out: &mut [f64]) {
        out[0] += factor * a[0];
    }
    fn add_mass(&self, factor: f64, k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, factor)
    }
}

pub type Solid<const D: usize> = SaintVenantKirchhoff<f64, D>;

pub fn rubber<const D: usize>(poisson: f64) -> Solid<D> {
    Solid::isotropic(2.0e7, poisson).unwrap()
}

/// The paper's pendulum in the plane, of `n` elements.
pub fn pendulum(n: usize) -> (System<f64, 2>, Placed) {
    let mut scene = Scene::<f64, 2>::new();
    let disk = Disk::new(0.01).unwrap();
    let beam = Beam::new(FullyParameterised, disk, Continuum::full(rubber(0.0)));
    let beam = beam.straight([0.0; 2], [1.0, 0.0], n).density(7200.0);
    let beam = scene.add(beam).unwrap();
    scene.pin(beam.start()).unwrap();
    scene.gravity([0.0, -9.81]).unwrap();
    (scene.assemble().unwrap(), beam)
}

/// A soft, thick cantilever of two elements that falls under its weight: its fastest motion takes
/// 35 ms, so that small steps resolve all of it.
pub fn soft() -> System<f64, 2> {
    let mut scene = Scene::<f64, 2>::new();
    let jelly = Solid::isotropic(2.0e4, 0.3).unwrap();
    let beam = Beam::new(
        FullyParameterised,
        Disk::new(0.05).unwrap(),
        Continuum::full(jelly),
    );
    let beam = beam.straight([0.0; 2], [0.5, 0.0], 2).density(1000.0);
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.gravity([0.0, -9.81]).unwrap();
    scene
        .force_in_time(beam.end(), [0.3, 0.5], |t: f64| (5.0 * t).sin())
        .unwrap();
    scene.assemble().unwrap()
}

/// A free rubber rod of `n` elements that forces on its ends, gone after 0.2 s, have set spinning,
/// bent and sent off slowly.
pub fn thrown<F>(n: usize, formulation: F) -> System<f64, 2>
where
    F: Formulation<f64, FullyParameterised, 2, 6>,
{
    let mut scene = Scene::<f64, 2>::new();
    let disk = Disk::new(0.01).unwrap();
    let beam = Beam::new(FullyParameterised, disk, formulation);
    let beam = beam.straight([0.0; 2], [1.0, 0.0], n).density(7200.0);
    let beam = scene.add(beam).unwrap();
    let on = |t: f64| if t < 0.2 { 1.0 } else { 0.0 };
    scene.force_in_time(beam.end(), [5.0, 20.0], on).unwrap();
    scene
        .force_in_time(beam.start(), [-4.0, -18.0], on)
        .unwrap();
    scene
        .moment_in_time(beam.start(), Moment::about_z(0.3), on)
        .unwrap();
    scene.assemble().unwrap()
}
