//! The three problems of Orzechowski (2012): a beam rolled up by an end moment, a soft pendulum
//! released from the horizontal, a slender cantilever under a growing tip force. Every family of
//! elements answers to its own limit: the continuum without Poisson's ratio to the section-linear
//! one, all others to the rod.

use std::f64::consts::{PI, TAU};

use ancf::analytical::{BendingSection, EndMoment, pure_bending};
use ancf::prelude::*;

use crate::measure::{Integrator, Method, Watch};
use crate::model::{Family, Place, Specimen};
use crate::sweep::{Study, all, original, steps, usual};
use crate::table::rows;

/// Which of the two dynamic problems.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Problem {
    Pendulum,
    Ramp,
}

impl Problem {
    /// Beam with `elements` of a family under its supports and loads, and the reference of its tip.
    fn build<R: Real, const D: usize>(
        self,
        family: Family,
        elements: usize,
    ) -> Result<(System<R, D>, Watch)>
    where
        Scene<R, D>: Place,
    {
        let (young, radius) = match self {
            Self::Pendulum => (2e7, 0.01),
            Self::Ramp => (2e11, 2.5e-3),
        };
        let specimen = Specimen {
            family,
            elements,
            young,
            radius,
            density: 7200.0,
        };
        let upwards = |v: f64| std::array::from_fn(|c| R::lit(if c == 1 { v } else { 0.0 }));
        let mut scene = Scene::<R, D>::new();
        let beam = scene.place(&specimen)?;
        let data = match self {
            Self::Pendulum => {
                scene.pin(beam.start())?;
                scene.gravity(upwards(-9.81))?;
                match family.is_rod() {
                    true => {
                        include_str!("../../papers/orzechowski-2012/data/pendulum_rod_nu03.csv")
                    }
                    false => include_str!(
                        "../../papers/orzechowski-2012/data/pendulum_ancf_limit_nu0.csv"
                    ),
                }
            }
            Self::Ramp => {
                scene.clamp(beam.start())?;
                scene.force_in_time(beam.end(), upwards(1.0), |t| t)?;
                match family.is_rod() {
                    true => include_str!("../../papers/orzechowski-2012/data/ramp_rod_nu03.csv"),
                    false => {
                        include_str!("../../papers/orzechowski-2012/data/ramp_ancf_limit_nu0.csv")
                    }
                }
            }
        };
        let end = if self == Self::Pendulum { 0.5 } else { 1.0 };
        let system = scene.assemble()?;
        let tip = beam.end();
        let watch = Watch::node(&system, &[(tip, 0), (tip, 1)], rows(data, [1, 2], end))?;
        Ok((system, watch))
    }

    fn sweep<R: Real, const D: usize>(
        self,
        study: &mut Study,
        family: Family,
        meshes: &[usize],
        methods: &[Method],
    ) -> Result<()>
    where
        Scene<R, D>: Place,
    {
        let build = |elements| self.build::<R, D>(family, elements);
        study.sweep(family.name(), meshes, methods, build)
    }

    fn run(self, study: &mut Study) -> Result<()> {
        let base = if self == Self::Pendulum { 1e-2 } else { 2e-2 };
        let (paper, usual) = (original(base), usual(base));
        let coarse = [4, 6, 10, 20, 40, 80];
        let fine = [2, 4, 8, 16, 32];
        let s = &mut *study;
        self.sweep::<f64, 3>(s, Family::FullAtPoints, &coarse[1..], &paper)?;
        self.sweep::<f64, 3>(s, Family::ReducedAtPoints, &coarse[1..], &paper)?;
        self.sweep::<f64, 3>(s, Family::Full, &coarse[1..], &usual)?;
        self.sweep::<f64, 2>(s, Family::Full, &coarse, &usual)?;
        self.sweep::<f32, 2>(s, Family::Full, &coarse[..4], &usual[..7])?;
        self.sweep::<f64, 2>(s, Family::Locked, &coarse[..5], &usual[..7])?;
        self.sweep::<f64, 2>(s, Family::Selective, &coarse[..5], &usual[..7])?;
        self.sweep::<f64, 2>(s, Family::ZeroPoisson, &coarse[..5], &usual[..7])?;
        self.sweep::<f64, 2>(s, Family::QuadraticSolid, &fine, &usual)?;
        self.sweep::<f64, 3>(s, Family::QuadraticRod, &fine, &usual)?;
        self.sweep::<f64, 2>(s, Family::QuadraticRod, &fine, &usual)?;
        self.sweep::<f32, 2>(s, Family::QuadraticRod, &fine[..4], &usual[..7])?;
        self.sweep::<f64, 2>(s, Family::Cable, &fine, &usual)?;
        if self == Self::Pendulum {
            let explicit = [0.9, 0.3, 0.1].map(|share| Method {
                integrator: Integrator::Central,
                refresh: Refresh::Never,
                stepping: Stepping::Stable(share),
            });
            self.sweep::<f64, 2>(s, Family::Full, &coarse[..5], &explicit)?;
            self.sweep::<f64, 2>(s, Family::QuadraticRod, &fine[..4], &explicit)?;
            self.sweep::<f64, 2>(s, Family::Cable, &fine[..4], &explicit)?;
        }
        // What integrators miss on one mesh of each sort.
        let mut methods = all(base);
        for refresh in [Refresh::EveryIteration, Refresh::EverySolve] {
            methods.extend(steps(base, 1..=6).into_iter().map(|step| Method {
                refresh,
                ..Method::fixed(Integrator::Trapezoidal, step)
            }));
        }
        let name = Family::QuadraticRod.name();
        let built = self.build::<f64, 2>(Family::QuadraticRod, 8)?;
        study.integrators((name, 8), base / 400.0, &methods, &built)
    }
}

/// The pendulum of section 5.2 to 0.5 s.
///
/// # Errors
/// Whatever the library refuses.
pub fn pendulum(study: &mut Study) -> Result<()> {
    Problem::Pendulum.run(study)
}

/// The ramp of section 5.3.
///
/// # Errors
/// Whatever the library refuses.
pub fn ramp(study: &mut Study) -> Result<()> {
    Problem::Ramp.run(study)
}

/// The roll-up of section 5.1 in load steps; limits in closed form.
///
/// # Errors
/// Whatever the library refuses.
pub fn roll_up(study: &mut Study) -> Result<()> {
    let coarse = [4, 6, 10, 20, 40, 80, 160];
    let fine = [1, 2, 4, 8, 16, 32, 64];
    rolled::<f64, 3>(study, Family::FullAtPoints, &coarse)?;
    rolled::<f64, 3>(study, Family::Full, &coarse)?;
    rolled::<f64, 2>(study, Family::Full, &coarse)?;
    rolled::<f64, 2>(study, Family::Selective, &coarse)?;
    rolled::<f64, 2>(study, Family::QuadraticSolid, &fine)?;
    rolled::<f64, 3>(study, Family::QuadraticRod, &fine)?;
    rolled::<f64, 2>(study, Family::QuadraticRod, &fine)?;
    rolled::<f32, 2>(study, Family::QuadraticRod, &fine[..5])?;
    rolled::<f64, 2>(study, Family::Cable, &fine)
}

fn rolled<R: Real, const D: usize>(
    study: &mut Study,
    family: Family,
    meshes: &[usize],
) -> Result<()>
where
    Scene<R, D>: Place,
{
    let (young, radius) = (2e11, 0.02);
    let moment = TAU * young * PI * f64::powi(radius, 4) / 4.0;
    // The rod closes; the continuum softens and overlaps.
    let rod = matches!(family, Family::QuadraticRod | Family::Cable);
    let mut limit = [0.0; 2];
    if !rod {
        let section = BendingSection::disk(young, radius);
        let bent = pure_bending(&section, moment, EndMoment::Conjugate)?;
        let radius = bent.axial_stretch / bent.curvature;
        limit = [
            radius * bent.curvature.sin(),
            radius * (1.0 - bent.curvature.cos()),
        ];
    }
    for &elements in meshes {
        let specimen = Specimen {
            family,
            elements,
            young,
            radius,
            density: 1.0,
        };
        let mut scene = Scene::<R, D>::new();
        let beam = scene.place(&specimen)?;
        scene.clamp(beam.start())?;
        let law = match family {
            Family::Cable => MomentLaw::SlopeRotation(0),
            _ => MomentLaw::SlopeRotation(1),
        };
        let vector = [R::zero(), R::zero(), R::lit(moment)];
        scene.moment(beam.end(), Moment::new(vector, law))?;
        let system = scene.assemble()?;
        study.statics(family.name(), elements, &system, beam.end(), (&limit, 1.0));
    }
    Ok(())
}
