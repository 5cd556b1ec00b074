//! A cantilever of one or more beams with its exact tip, for the rows and the tests of the hard
//! cases.

use std::f64::consts::PI;

use ancf::prelude::*;
use ancf::solver::StaticReport;

/// Beams of unit length and of unit bending stiffness in a chain: each a number of elements and a
/// factor of the stiffness.
pub struct Chain<'a> {
    /// Radius over the length of the whole.
    pub radius: f64,
    /// Elements and stiffness factor of the beams, which share the length in equal parts.
    pub parts: &'a [(usize, f64)],
    /// Load across at the tip, over `E I / L^2`.
    pub load: f64,
    /// Where the chain starts (m).
    pub origin: f64,
}

impl Chain<'_> {
    /// Tip deflection over the load, and what statics took.
    ///
    /// # Errors
    /// Whatever the library refuses.
    pub fn tip<R: Real, F>(
        &self,
        form: impl Fn(SaintVenantKirchhoff<R, 2>) -> F,
    ) -> Result<(f64, StaticReport)>
    where
        F: Formulation<R, FullyParameterised, 2, 6> + 'static,
    {
        let mut scene = Scene::<R, 2>::new();
        let disk = Disk::new(R::lit(self.radius))?;
        let mut last: Option<Placed> = None;
        let share = 1.0 / self.parts.len() as f64;
        for (k, (elements, factor)) in self.parts.iter().enumerate() {
            let young = factor * 4.0 / PI / self.radius.powi(4);
            let solid = SaintVenantKirchhoff::isotropic(R::lit(young), R::zero())?;
            let [from, to] =
                [k, k + 1].map(|k| [R::lit(self.origin + share * k as f64), R::lit(self.origin)]);
            let beam = Beam::new(FullyParameterised, disk, form(solid));
            let beam = scene.add(beam.straight(from, to, *elements))?;
            match last {
                None => scene.clamp(beam.start())?,
                Some(last) => scene.join(last.end(), beam.start(), Joint::Rigid)?,
            }
            last = Some(beam);
        }
        let Some(last) = last else {
            return Err(Error::EmptyScene);
        };
        scene.force(last.end(), [R::zero(), R::lit(self.load)])?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        let report = Statics::default().solve(&system, &mut state)?;
        let [_, tip] = system.displacement(&state, last.end())?;
        Ok((tip.value() / self.load, report))
    }

    /// The same after Euler and Bernoulli, Timoshenko's shear and what constant curvature in each
    /// element costs: exact for small loads but for the clamp, which holds the section.
    pub fn truth(&self) -> f64 {
        let (mut tip, count) = (0.0, self.parts.len() as f64);
        for (k, (elements, factor)) in self.parts.iter().enumerate() {
            let [far, near] = [k, k + 1].map(|k| 1.0 - k as f64 / count);
            let h = 1.0 / count / *elements as f64;
            let lost = *elements as f64 * h.powi(3) / 12.0;
            let shear = 0.5 * self.radius.powi(2) / count;
            tip += ((far.powi(3) - near.powi(3)) / 3.0 - lost + shear) / factor;
        }
        tip
    }
}
