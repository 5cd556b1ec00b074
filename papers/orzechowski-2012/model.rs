//! The paper's three beams as scenes. Every study states only what it varies (mesh, section,
//! Poisson ratio, integration rule), so that two runs that should differ in one thing do.

use ancf::material::PoissonSplit;
use ancf::prelude::*;

/// Length of every beam in the paper (m).
pub const LENGTH: f64 = 1.0;
/// Density of the pendulum and of the ramp's cantilever (kg/m^3).
pub const DENSITY: f64 = 7200.0;
/// Acceleration of gravity (m/s^2).
pub const GRAVITY: f64 = 9.81;

/// How the strain energy of an element is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rule {
    /// Exact: 5 axial points, disk rule of order 3.
    Full,
    /// The paper's faster rule: 4 axial points, disk rule of order 2.
    Reduced,
    /// 5 axial points and a section rule exact to this degree.
    Degree(usize),
    /// The Poisson-coupled part on the axis only.
    SelectiveReduced,
    /// Without the Poisson-coupled part.
    ZeroPoisson,
}

impl Rule {
    /// The formulation of this rule.
    pub fn of<M: Material<f64, 3> + PoissonSplit>(self, material: M) -> Continuum<M> {
        match self {
            Self::Full => Continuum::full(material),
            Self::Reduced => Continuum::reduced(material),
            Self::Degree(degree) => Continuum::sampled(material, 5, degree),
            Self::SelectiveReduced => Continuum::selective_reduced(material),
            Self::ZeroPoisson => Continuum::zero_poisson(material),
        }
    }

    /// Name used in tables.
    pub fn name(self) -> String {
        match self {
            Self::Full => "full".into(),
            Self::Reduced => "reduced".into(),
            Self::Degree(degree) => format!("degree {degree}"),
            Self::SelectiveReduced => "selective reduced".into(),
            Self::ZeroPoisson => "zero Poisson".into(),
        }
    }
}

/// A beam along the x axis: what the paper's examples have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// Number of elements.
    pub elements: usize,
    /// Young's modulus (Pa).
    pub young: f64,
    /// Poisson ratio.
    pub poisson: f64,
    /// Integration rule.
    pub rule: Rule,
}

impl Specimen {
    /// The material of this beam.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn material(&self) -> Result<SaintVenantKirchhoff<f64, 3>> {
        SaintVenantKirchhoff::isotropic(self.young, self.poisson)
    }

    /// A scene that holds this beam with a section.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn scene(
        &self,
        section: impl Section<f64>,
        density: Option<f64>,
    ) -> Result<(Scene<f64, 3>, Placed)> {
        self.scene_of(self.material()?, section, density)
    }

    /// The same of another material.
    fn scene_of<M>(
        &self,
        material: M,
        section: impl Section<f64>,
        density: Option<f64>,
    ) -> Result<(Scene<f64, 3>, Placed)>
    where
        M: Material<f64, 3> + PoissonSplit,
        Continuum<M>: Formulation<f64, FullyParameterised, 3, 8>,
    {
        let mut beam = Beam::new(FullyParameterised, section, self.rule.of(material)).straight(
            [0.0; 3],
            [LENGTH, 0.0, 0.0],
            self.elements,
        );
        if let Some(density) = density {
            beam = beam.density(density);
        }
        let mut scene = Scene::new();
        let placed = scene.add(beam)?;
        Ok((scene, placed))
    }

    /// The pendulum of section 5.2: pinned at the origin, horizontal, at rest, under gravity.
    /// A component of gravity `sideways` (m/s^2) takes it out of its plane.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn pendulum(
        &self,
        section: impl Section<f64>,
        sideways: f64,
    ) -> Result<(System<f64, 3>, Placed)> {
        self.pendulum_of(self.material()?, section, sideways)
    }

    /// The same of another material.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn pendulum_of<M>(
        &self,
        material: M,
        section: impl Section<f64>,
        sideways: f64,
    ) -> Result<(System<f64, 3>, Placed)>
    where
        M: Material<f64, 3> + PoissonSplit,
        Continuum<M>: Formulation<f64, FullyParameterised, 3, 8>,
    {
        let (mut scene, beam) = self.scene_of(material, section, Some(DENSITY))?;
        scene.pin(beam.start())?;
        scene.gravity([0.0, -GRAVITY, sideways])?;
        Ok((scene.assemble()?, beam))
    }

    /// The cantilever of section 5.3: clamped, its tip force growing by 1 N each second.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn ramp(&self, section: impl Section<f64>) -> Result<(System<f64, 3>, Placed)> {
        let (mut scene, beam) = self.scene(section, Some(DENSITY))?;
        scene.clamp(beam.start())?;
        scene.force_in_time(beam.end(), [0.0, 1.0, 0.0], |t| t)?;
        Ok((scene.assemble()?, beam))
    }

    /// The same cantilever under a constant tip force (N), for statics.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn cantilever(
        &self,
        section: impl Section<f64>,
        force: f64,
    ) -> Result<(System<f64, 3>, Placed)> {
        let (mut scene, beam) = self.scene(section, None)?;
        scene.clamp(beam.start())?;
        scene.force(beam.end(), [0.0, force, 0.0])?;
        Ok((scene.assemble()?, beam))
    }
}
