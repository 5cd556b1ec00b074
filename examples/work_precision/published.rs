//! Three published beams against codes of another kind: the 45 degree bend of Bathe and Bolourchi
//! (1979), the right-angle cantilever (1988) and the spin-up manoeuvre (1986) of Simo and Vu-Quoc.

use std::f64::consts::{FRAC_PI_4, PI};

use ancf::prelude::*;

use crate::measure::Watch;
use crate::model::PointByPoint;
use crate::sweep::{Study, usual};
use crate::table::rows;

/// The bend under 600: tip of a rod with the torsion constant of sections that do not warp.
const BEND: [f64; 3] = [15.68480053, 47.15043857, 53.47485879];

/// The bend, static, in space; length of the arc 100 pi / 4, section 1 x 1, `E` = 1e7.
///
/// # Errors
/// Whatever the library refuses.
pub fn bend(study: &mut Study) -> Result<()> {
    let solid = SaintVenantKirchhoff::<f64, 3>::isotropic(1e7, 0.0)?;
    let full = Continuum::full(PointByPoint(solid));
    let name = "paper: full, section points";
    let meshes = [4, 8, 16, 32, 64, 128];
    bent(study, name, &meshes, FullyParameterised, full)?;
    let full = Continuum::full(solid);
    bent(study, "full", &meshes, FullyParameterised, full.clone())?;
    let two = full.axial(2);
    bent(
        study,
        "quadratic continuum",
        &[2, 4, 8, 16, 32],
        Quadratic,
        two,
    )?;
    let rod = StructuralMechanics::new(&solid);
    bent(
        study,
        "quadratic rod",
        &[2, 4, 8, 16, 32, 64, 128],
        Quadratic,
        rod,
    )
}

fn bent<R, E, F, const S: usize>(
    study: &mut Study,
    family: &str,
    meshes: &[usize],
    element: E,
    law: F,
) -> Result<()>
where
    R: Real,
    E: Element<3, S> + Copy,
    F: Formulation<R, E, 3, S> + Clone,
{
    let radius = 100.0;
    let lit = |v: [f64; 3]| v.map(R::lit);
    let axis = move |s: R| {
        let (sin, cos) = (s.value() * FRAC_PI_4).sin_cos();
        let position = [radius * (1.0 - cos), radius * sin, 0.0];
        let frame = [[sin, cos, 0.0], [-cos, sin, 0.0], [0.0, 0.0, 1.0]];
        (lit(position), frame.map(lit))
    };
    for &elements in meshes {
        let section = Rectangle::new(R::one(), R::one())?;
        let mut scene = Scene::<R, 3>::new();
        let length = R::lit(radius * FRAC_PI_4);
        let beam = Beam::new(element, section, law.clone()).curved(length, elements, axis);
        let beam = scene.add(beam)?;
        scene.clamp(beam.start())?;
        scene.force(beam.end(), lit([0.0, 0.0, 600.0]))?;
        let system = scene.assemble()?;
        let rest = system.position(&system.rest(), beam.end())?;
        let travel = (0..3).map(|c| (rest[c].value() - BEND[c]).powi(2));
        let travel = travel.sum::<f64>().sqrt();
        study.statics(family, elements, &system, beam.end(), (&BEND, travel));
    }
    Ok(())
}

/// A beam given by its stiffness.
fn rod<R: Real>(axial: f64, shear: f64, bending: f64) -> Result<StructuralMechanics<R>> {
    StructuralMechanics::with_stiffness(BeamStiffness {
        axial: R::lit(axial),
        shear: [R::lit(shear); 2],
        torsion: R::lit(bending),
        bending: [R::lit(bending); 2],
    })
}

/// Two legs of 10 under a force at the elbow out of their plane, to 4 s: elbow and tip. The reference is
/// known to some ten-thousandths of the tip's way.
///
/// # Errors
/// Whatever the library refuses.
pub fn right_angle(study: &mut Study) -> Result<()> {
    let methods = usual(0.1);
    let double = rod::<f64>(1e6, 1e6, 1e3)?;
    let meshes = [1, 2, 4, 8, 16];
    study.sweep("quadratic rod", &meshes, &methods, |n| {
        elbow(Quadratic, double, n)
    })
}

fn elbow<R, E, F, const S: usize>(element: E, law: F, n: usize) -> Result<(System<R, 3>, Watch)>
where
    R: Real,
    E: Element<3, S> + Copy,
    F: Formulation<R, E, 3, S> + Copy,
{
    let lit = |v: [f64; 3]| v.map(R::lit);
    let section = Moments::new(R::one(), R::lit(10.0), R::lit(10.0))?;
    let leg = |from, to| {
        let beam = Beam::new(element, section, law);
        beam.straight(lit(from), lit(to), n).density(R::one())
    };
    let corner = [10.0, 0.0, 0.0];
    let mut scene = Scene::<R, 3>::new();
    let inner = scene.add(leg([0.0; 3], corner))?;
    let outer = scene.add(leg(corner, [10.0, 10.0, 0.0]))?;
    scene.clamp(inner.start())?;
    scene.join(inner.end(), outer.start(), Joint::Rigid)?;
    let hat = |t: R| R::lit((1.0 - (t.value() - 1.0).abs()).max(0.0));
    scene.force_in_time(inner.end(), lit([0.0, 0.0, 50.0]), hat)?;
    let data = include_str!("../../tests/data/right_angle_cantilever_simo_vuquoc_1988.csv");
    let system = scene.assemble()?;
    let watched = [(inner.end(), 2), (outer.end(), 2)];
    let watch = Watch::node(&system, &watched, rows(data, [1, 2], 4.0))?;
    Ok((system, watch))
}

/// Root angle of the spin-up manoeuvre.
#[derive(Debug, Clone, Copy)]
struct Root {
    /// Whether the axial slope is driven, or the one across.
    axial: bool,
}

impl<R: Real> Motion<R, 2> for Root {
    fn at<T: Algebra<R>>(&self, t: T) -> [T; 2] {
        let swing = (t * T::lit(PI / 7.5)).cos() - T::one();
        let angle = (t * t * T::lit(0.5) + swing * T::lit((7.5 / PI).powi(2))) * T::lit(0.4);
        match self.axial {
            true => [angle.cos(), angle.sin()],
            false => [-angle.sin(), angle.cos()],
        }
    }
}

/// A beam of 10 that a root spins up within 15 s, to 8 s, in the plane. The reference is given in the
/// frame of the root.
///
/// # Errors
/// Whatever the library refuses.
pub fn spin_up(study: &mut Study) -> Result<()> {
    let methods = usual(0.02);
    let meshes = [1, 2, 4, 8, 16];
    let law = rod::<f64>(2.8e7, 1e7, 1.4e4)?;
    study.sweep("quadratic rod", &meshes, &methods, |n| {
        spun(Quadratic, law, n)
    })?;
    let single = CoMoving(rod::<f32>(2.8e7, 1e7, 1.4e4)?);
    study.sweep("quadratic rod", &meshes[..4], &methods[..6], |n| {
        spun(Quadratic, single, n)
    })?;
    let cable = EulerBernoulli::with_stiffness(2.8e7, 1.4e4)?;
    study.sweep("cable", &meshes[1..], &methods, |n| spun(Cable, cable, n))
}

fn spun<R, E, F, const S: usize>(element: E, law: F, n: usize) -> Result<(System<R, 2>, Watch)>
where
    R: Real,
    E: Element<2, S> + Copy,
    F: Formulation<R, E, 2, S> + Copy,
{
    let section = Moments::new(R::lit(1.2), R::lit(6e-4), R::lit(6e-4))?;
    let mut scene = Scene::<R, 2>::new();
    let beam = Beam::new(element, section, law);
    let beam = beam.straight([R::zero(); 2], [R::lit(10.0), R::zero()], n);
    let beam = scene.add(beam.density(R::one()))?;
    scene.pin(beam.start())?;
    // Sections of a rod are turned by their own slope, a cable has that of its axis alone.
    let axial = !E::VECTORS.contains(&NodalVector::Slope(1));
    let slope = NodalVector::Slope(usize::from(!axial));
    scene.drive(beam.start(), slope, [true; 2], Root { axial })?;
    let data = include_str!("../../tests/data/spinup_simo_vuquoc_1986.csv");
    let mut rows = rows(data, [1, 2], 8.0);
    for (time, row) in &mut rows {
        let [cos, sin] = Motion::<f64, 2>::at(&Root { axial: true }, *time);
        let [x, y] = [10.0 + row[0], row[1]];
        *row = vec![x * cos - y * sin, x * sin + y * cos];
    }
    let system = scene.assemble()?;
    let tip = beam.end();
    let watch = Watch::node(&system, &[(tip, 0), (tip, 1)], rows)?;
    Ok((system, watch))
}
