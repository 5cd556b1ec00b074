//! The three problems of Orzechowski (2012): a beam rolled up by an end moment, a soft pendulum
//! released from the horizontal, a slender cantilever under a growing tip force. Continua without
//! Poisson's ratio answer to the section-linear continuum, all others to the rod.

use std::f64::consts::{PI, TAU};

use ancf::analytical::{BendingSection, EndMoment, pure_bending};
use ancf::prelude::*;
use ancf::verify::ByPoints;

use crate::measure::{Integrator, Method, Watch};
use crate::model::{Limit, Model, PointByPoint, SHEAR, Specimen};
use crate::sweep::{Study, all, collocation, original, steps, usual};
use crate::table::rows;

/// A model of the paper's element.
fn paper<F>(name: &'static str, law: F, limit: Limit) -> Model<FullyParameterised, F> {
    let element = FullyParameterised;
    Model {
        name,
        element,
        law,
        limit,
    }
}

/// A quadratic rod of a material.
fn rod<R: Real, const D: usize>(material: &SaintVenantKirchhoff<R, D>) -> StructuralMechanics<R> {
    StructuralMechanics::new(material).with_shear_factors([R::lit(SHEAR); 2])
}

/// A model of the quadratic element.
fn quadratic<F>(name: &'static str, law: F, limit: Limit) -> Model<Quadratic, F> {
    let element = Quadratic;
    Model {
        name,
        element,
        law,
        limit,
    }
}

/// Which of the two dynamic problems.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Problem {
    Pendulum,
    Ramp,
}

impl Problem {
    fn specimen(self) -> Specimen {
        let (young, radius) = match self {
            Self::Pendulum => (2e7, 0.01),
            Self::Ramp => (2e11, 2.5e-3),
        };
        let density = 7200.0;
        Specimen {
            young,
            radius,
            density,
        }
    }

    fn reference(self, limit: Limit) -> &'static str {
        match (self, limit) {
            (Self::Pendulum, Limit::Rod) => {
                include_str!("../../papers/orzechowski-2012/data/pendulum_rod_nu03.csv")
            }
            (Self::Pendulum, Limit::Continuum) => {
                include_str!("../../papers/orzechowski-2012/data/pendulum_ancf_limit_nu0.csv")
            }
            (Self::Ramp, Limit::Rod) => {
                include_str!("../../papers/orzechowski-2012/data/ramp_rod_nu03.csv")
            }
            (Self::Ramp, Limit::Continuum) => {
                include_str!("../../papers/orzechowski-2012/data/ramp_ancf_limit_nu0.csv")
            }
        }
    }

    /// The beam under its supports and loads, and the reference of its tip.
    fn build<R, E, F, const D: usize, const S: usize>(
        self,
        model: &Model<E, F>,
        elements: usize,
    ) -> Result<(System<R, D>, Watch)>
    where
        R: Real,
        E: Element<D, S> + Copy,
        F: Formulation<R, E, D, S> + Clone,
    {
        let upwards = |v: f64| std::array::from_fn(|c| R::lit(if c == 1 { v } else { 0.0 }));
        let mut scene = Scene::<R, D>::new();
        let beam = self.specimen().place(&mut scene, model, elements)?;
        let (start, tip) = (beam.start(), beam.end());
        let end = match self {
            Self::Pendulum => {
                scene.pin(start)?;
                scene.gravity(upwards(-9.81))?;
                0.5
            }
            Self::Ramp => {
                scene.clamp(start)?;
                scene.force_in_time(tip, upwards(1.0), |t| t)?;
                1.0
            }
        };
        let system = scene.assemble()?;
        let truth = rows(self.reference(model.limit), [1, 2], end);
        let watch = Watch::node(&system, &[(tip, 0), (tip, 1)], truth)?;
        Ok((system, watch))
    }

    fn sweep<R, E, F, const D: usize, const S: usize>(
        self,
        study: &mut Study,
        model: &Model<E, F>,
        meshes: &[usize],
        methods: &[Method],
    ) -> Result<()>
    where
        R: Real,
        E: Element<D, S> + Copy,
        F: Formulation<R, E, D, S> + Clone,
    {
        study.sweep(model.name, meshes, methods, |n| {
            self.build::<R, E, F, D, S>(model, n)
        })
    }

    fn run(self, study: &mut Study) -> Result<()> {
        let specimen = self.specimen();
        let (base, theirs, finest, small) = match self {
            Self::Pendulum => (1e-2, [6, 10, 20, 48, 64, 192], [32, 64, 128], 2..=4),
            Self::Ramp => (2e-2, [6, 10, 20, 48, 64, 80], [16, 32, 64], 4..=7),
        };
        // As close as the references are known.
        let mut close = collocation(&steps(base, small));
        let second_order = |step| Method::fixed(Integrator::Trapezoidal, step);
        close.extend(steps(base, 6..=9).into_iter().map(second_order));
        let (original, ours) = (original(base), usual(base));
        let second = &ours[..6];
        let (coarse, fine) = ([6, 10, 20, 48, 96], [2, 4, 8, 16, 32]);
        let (none, rods) = (Limit::Continuum, Limit::Rod);
        let s = study;

        let solid = specimen.material::<f64, 3>(0.0)?;
        let points = Continuum::full(PointByPoint(solid));
        let model = paper("paper: full, section points", points, none);
        self.sweep::<f64, _, _, 3, 8>(s, &model, &theirs[..4], &original)?;
        self.sweep::<f64, _, _, 3, 8>(s, &model, &theirs[4..], &original[..6])?;
        let points = Continuum::reduced(PointByPoint(solid));
        let model = paper("paper: reduced, section points", points, none);
        self.sweep::<f64, _, _, 3, 8>(s, &model, &coarse[..4], &original[..6])?;
        let points = Continuum::full(ByPoints(solid));
        let model = paper("full, section points in lanes", points, none);
        self.sweep::<f64, _, _, 3, 8>(s, &model, &coarse[..4], second)?;
        let model = paper("full", Continuum::full(solid), none);
        self.sweep::<f64, _, _, 3, 8>(s, &model, &coarse[..4], &ours)?;

        let flat = specimen.material::<f64, 2>(0.0)?;
        let real = specimen.material::<f64, 2>(0.3)?;
        let model = paper("full", Continuum::full(flat), none);
        self.sweep::<f64, _, _, 2, 6>(s, &model, &coarse, &ours)?;
        let model = paper("full, nu = 0.3", Continuum::full(real), rods);
        self.sweep::<f64, _, _, 2, 6>(s, &model, &coarse[..4], second)?;
        let remedy = Continuum::selective_reduced(real);
        let model = paper("selective reduced, nu = 0.3", remedy, rods);
        self.sweep::<f64, _, _, 2, 6>(s, &model, &coarse[..4], second)?;
        let model = paper(
            "zero Poisson, nu = 0.3",
            Continuum::zero_poisson(real),
            rods,
        );
        self.sweep::<f64, _, _, 2, 6>(s, &model, &coarse[..4], second)?;
        let model = quadratic("quadratic continuum", Continuum::full(flat).axial(2), none);
        self.sweep::<f64, _, _, 2, 6>(s, &model, &fine, &ours)?;
        self.sweep::<f64, _, _, 2, 6>(s, &model, &finest, &close)?;

        let model = quadratic(
            "quadratic rod",
            rod(&specimen.material::<f64, 3>(0.3)?),
            rods,
        );
        self.sweep::<f64, _, _, 3, 9>(s, &model, &fine[..4], second)?;
        let model = quadratic("quadratic rod", rod(&real), rods);
        self.sweep::<f64, _, _, 2, 6>(s, &model, &fine, &ours)?;
        self.sweep::<f64, _, _, 2, 6>(s, &model, &finest, &close)?;
        // In the beam's own frame short numbers keep the digits of small strains.
        let short = CoMoving(rod(&specimen.material::<f32, 2>(0.3)?));
        let single = quadratic("quadratic rod", short, rods);
        self.sweep::<f32, _, _, 2, 6>(s, &single, &fine[..4], second)?;
        let (element, law) = (Cable, EulerBernoulli::new(&real));
        let cable = Model {
            name: "cable",
            element,
            law,
            limit: rods,
        };
        self.sweep::<f64, _, _, 2, 4>(s, &cable, &fine, &ours)?;
        let explicit = [0.9, 0.3].map(|share| Method {
            integrator: Integrator::Central,
            refresh: Refresh::Never,
            stepping: Stepping::Stable(share),
        });
        self.sweep::<f64, _, _, 2, 4>(s, &cable, &fine[..4], &explicit)?;
        // The sections of the steel beam in the ramp move a thousand times faster than its axis.
        if self == Self::Pendulum {
            self.sweep::<f64, _, _, 2, 6>(s, &model, &fine[..4], &explicit)?;
        }

        // What the integrators themselves miss.
        let mut methods = all(base);
        for refresh in [Refresh::EveryIteration, Refresh::EverySolve] {
            methods.extend(steps(base, 0..=5).into_iter().map(|step| Method {
                refresh,
                ..Method::fixed(Integrator::Trapezoidal, step)
            }));
        }
        let built = self.build::<f64, _, _, 2, 6>(&model, 8)?;
        s.integrators((model.name, 8), base / 256.0, &methods, &built)
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

/// The roll-up of section 5.1; limits in closed form.
///
/// # Errors
/// Whatever the library refuses.
pub fn roll_up(study: &mut Study) -> Result<()> {
    let (coarse, fine) = ([6, 10, 20, 40, 80, 160], [1, 2, 4, 8, 16, 32, 64, 128, 256]);
    let (none, rods) = (Limit::Continuum, Limit::Rod);
    let steel = Specimen {
        young: 2e11,
        radius: 0.02,
        density: 1.0,
    };
    let (solid, flat) = (
        steel.material::<f64, 3>(0.0)?,
        steel.material::<f64, 2>(0.0)?,
    );
    let points = Continuum::full(PointByPoint(solid));
    let model = paper("paper: full, section points", points, none);
    rolled::<f64, _, _, 3, 8>(study, &steel, &model, &coarse[..5])?;
    let model = paper("full", Continuum::full(solid), none);
    rolled::<f64, _, _, 3, 8>(study, &steel, &model, &coarse)?;
    let model = paper("full", Continuum::full(flat), none);
    rolled::<f64, _, _, 2, 6>(study, &steel, &model, &coarse)?;
    let model = quadratic("quadratic continuum", Continuum::full(flat).axial(2), none);
    rolled::<f64, _, _, 2, 6>(study, &steel, &model, &fine[..6])?;
    let model = quadratic("quadratic rod", rod(&solid), rods);
    rolled::<f64, _, _, 3, 9>(study, &steel, &model, &fine[..6])?;
    let model = quadratic("quadratic rod", rod(&flat), rods);
    rolled::<f64, _, _, 2, 6>(study, &steel, &model, &fine)?;
    let short = CoMoving(rod(&steel.material::<f32, 2>(0.0)?));
    let model = quadratic("quadratic rod", short, rods);
    rolled::<f32, _, _, 2, 6>(study, &steel, &model, &fine[..5])?;
    let (element, law) = (Cable, EulerBernoulli::new(&flat));
    let model = Model {
        name: "cable",
        element,
        law,
        limit: rods,
    };
    rolled::<f64, _, _, 2, 4>(study, &steel, &model, &fine)
}

fn rolled<R, E, F, const D: usize, const S: usize>(
    study: &mut Study,
    specimen: &Specimen,
    model: &Model<E, F>,
    meshes: &[usize],
) -> Result<()>
where
    R: Real,
    E: Element<D, S> + Copy,
    F: Formulation<R, E, D, S> + Clone,
{
    let moment = TAU * specimen.young * PI * specimen.radius.powi(4) / 4.0;
    let limit = match model.limit {
        // The rod closes; the continuum softens and overlaps.
        Limit::Rod => [0.0; 2],
        Limit::Continuum => {
            let section = BendingSection::disk(specimen.young, specimen.radius);
            let bent = pure_bending(&section, moment, EndMoment::Conjugate)?;
            let radius = bent.axial_stretch / bent.curvature;
            let (sin, cos) = bent.curvature.sin_cos();
            [radius * sin, radius * (1.0 - cos)]
        }
    };
    // Sections turn by their own slope, a cable by that of its axis.
    let across = E::VECTORS.contains(&NodalVector::Slope(1));
    let law = MomentLaw::SlopeRotation(usize::from(across));
    for &elements in meshes {
        let mut scene = Scene::<R, D>::new();
        let beam = specimen.place(&mut scene, model, elements)?;
        scene.clamp(beam.start())?;
        let vector = [R::zero(), R::zero(), R::lit(moment)];
        scene.moment(beam.end(), Moment::new(vector, law))?;
        let system = scene.assemble()?;
        study.statics(model.name, elements, &system, beam.end(), (&limit, 1.0));
    }
    Ok(())
}
