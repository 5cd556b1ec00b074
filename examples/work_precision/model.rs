//! How a beam is modelled: element, formulation and Poisson ratio under one name, to be placed in a
//! scene of either dimension and any number type.

use ancf::prelude::*;
use ancf::verify::ByPoints;

/// Shear factor of the rods that made the references (Cowper's for a disk at Poisson ratio 0.3).
const SHEAR: f64 = 0.88636364;

/// Elements with what gives them their elasticity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Fully parameterised, full integration at section points: the paper's own.
    FullAtPoints,
    /// Fully parameterised, the paper's reduced rule at section points.
    ReducedAtPoints,
    /// Fully parameterised, full integration, section integrated once.
    Full,
    /// The same at Poisson ratio 0.3, which locks.
    Locked,
    /// Fully parameterised, selective reduced, Poisson ratio 0.3.
    Selective,
    /// Fully parameterised, the uncoupled part only, Poisson ratio 0.3.
    ZeroPoisson,
    /// Quadratic, the continuum on two axial points.
    QuadraticSolid,
    /// Quadratic, structural mechanics.
    QuadraticRod,
    /// Cable, Euler and Bernoulli.
    Cable,
}

impl Family {
    /// Name in tables and legends.
    pub fn name(self) -> &'static str {
        match self {
            Self::FullAtPoints => "paper: full, section points",
            Self::ReducedAtPoints => "paper: reduced, section points",
            Self::Full => "full",
            Self::Locked => "full, nu = 0.3",
            Self::Selective => "selective reduced, nu = 0.3",
            Self::ZeroPoisson => "zero Poisson, nu = 0.3",
            Self::QuadraticSolid => "quadratic continuum",
            Self::QuadraticRod => "quadratic rod",
            Self::Cable => "cable",
        }
    }

    /// Whether its limit is the rod with Poisson ratio 0.3 and not the section-linear continuum with
    /// none.
    pub fn is_rod(self) -> bool {
        match self {
            Self::FullAtPoints | Self::ReducedAtPoints | Self::Full | Self::QuadraticSolid => false,
            Self::Locked | Self::Selective | Self::ZeroPoisson => true,
            Self::QuadraticRod | Self::Cable => true,
        }
    }

    fn poisson(self) -> f64 {
        if self.is_rod() { 0.3 } else { 0.0 }
    }
}

/// A round beam along the x axis, of length 1 m.
#[derive(Debug, Clone, Copy)]
pub struct Specimen {
    /// Its elements.
    pub family: Family,
    /// How many.
    pub elements: usize,
    /// Young's modulus (Pa).
    pub young: f64,
    /// Radius (m).
    pub radius: f64,
    /// Density (kg/m^3).
    pub density: f64,
}

impl Specimen {
    fn material<R: Real, const D: usize>(&self) -> Result<SaintVenantKirchhoff<R, D>> {
        SaintVenantKirchhoff::isotropic(R::lit(self.young), R::lit(self.family.poisson()))
    }

    fn add<R, E, F, const D: usize, const S: usize>(
        &self,
        scene: &mut Scene<R, D>,
        element: E,
        law: F,
    ) -> Result<Placed>
    where
        R: Real,
        E: Element<D, S>,
        F: Formulation<R, E, D, S> + Clone,
        CoMoving<F>: Formulation<R, E, D, S>,
    {
        let section = Disk::new(R::lit(self.radius))?;
        let to = std::array::from_fn(|c| if c == 0 { R::one() } else { R::zero() });
        let (from, n, density) = ([R::zero(); D], self.elements, R::lit(self.density));
        // In the beam's own frame short numbers keep the digits of small strains.
        if R::EPSILON > 1e-8 {
            let beam = Beam::new(element, section, CoMoving(law));
            return scene.add(beam.straight(from, to, n).density(density));
        }
        let beam = Beam::new(element, section, law);
        scene.add(beam.straight(from, to, n).density(density))
    }
}

/// Scenes that take a specimen: those of the plane and of space.
pub trait Place {
    /// Adds the beam.
    ///
    /// # Errors
    /// Whatever the library refuses.
    fn place(&mut self, specimen: &Specimen) -> Result<Placed>;
}

macro_rules! place {
    ($d:literal) => {
        impl<R: Real> Place for Scene<R, $d> {
            fn place(&mut self, specimen: &Specimen) -> Result<Placed> {
                let m = specimen.material::<R, $d>()?;
                let full = FullyParameterised;
                match specimen.family {
                    Family::FullAtPoints => specimen.add(self, full, Continuum::full(ByPoints(m))),
                    Family::ReducedAtPoints => {
                        specimen.add(self, full, Continuum::reduced(ByPoints(m)))
                    }
                    Family::Full | Family::Locked => specimen.add(self, full, Continuum::full(m)),
                    Family::Selective => specimen.add(self, full, Continuum::selective_reduced(m)),
                    Family::ZeroPoisson => specimen.add(self, full, Continuum::zero_poisson(m)),
                    Family::QuadraticSolid => {
                        let law = Continuum::selective_reduced(m).axial(2);
                        specimen.add(self, Quadratic, law)
                    }
                    Family::QuadraticRod => {
                        let law = StructuralMechanics::new(&m);
                        let law = law.with_shear_factors([R::lit(SHEAR); 2]);
                        specimen.add(self, Quadratic, law)
                    }
                    Family::Cable => specimen.add(self, Cable, EulerBernoulli::new(&m)),
                }
            }
        }
    };
}
place!(2);
place!(3);
