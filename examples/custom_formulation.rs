//! A formulation of your own is a strain energy: a planar beam that yields, with the bending moment
//! `EI k0 tanh(kappa / k0)`, on the element without section; checked, and rolled up.
use ancf::formulation::{Reference, Sample, SampledKernel, SectionLaw, changes};
use ancf::{prelude::*, quadrature::gauss_legendre, verify};

/// `EA` (N), `EI` (N m^2) and the curvature `k0` (1/m) at which the beam yields.
#[derive(Debug, Clone, Copy)]
struct Yielding<R>(R, R, R);

impl<R: Real> SectionLaw<R, 2, 2> for Yielding<R> {
    /// Energy per length from `r'` and `r''`, at rest and their changes.
    fn energy<T: Algebra<R>>(&self, rest: &[[R; 2]; 2], change: &[[T; 2]; 2]) -> T {
        let Self(ea, ei, k0) = *self;
        let half = R::lit(0.5);
        // Strains are formed as changes since the state of rest: they keep their digits.
        let [t, b] = changes(rest, change);
        let square = t[0] * t[0] + t[1] * t[1];
        let stretch = square.sqrt().change;
        let curvature = ((t[0] * b[1] - t[1] * b[0]) / square).change;
        // ln cosh x = ln(1 + 2 sinh^2(x / 2)), which is small where the curvature is.
        let sinh = curvature.times(half / k0).sinh();
        let bending = (sinh * sinh).times(R::lit(2.0)).ln_1p();
        (stretch * stretch).times(half * ea) + bending.times(ei * k0 * k0)
    }
}

impl<R: Real> Formulation<R, Cable, 2, 4> for Yielding<R> {
    type Kernel = SampledKernel<R, Self, 2, 4, 2>;
    /// What the energy is a function of, and the points along the element where it is sampled.
    fn kernel(
        &self,
        element: &Cable,
        reference: &Reference<R, 2, 4>,
        _: &dyn Section<R>,
    ) -> Result<Self::Kernel> {
        let (samples, points) = ([Sample::First(0), Sample::Second(0, 0)], gauss_legendre(3)?);
        Ok(SampledKernel::new().with_part(element, reference, *self, samples, &points))
    }
}

fn main() -> Result<()> {
    let (law, disk) = (Yielding(1e6, 10.0, 4.0), Disk::new(0.01)?);
    let report = verify::formulation(&Cable, &law, &disk, 0.1)?;
    println!("{}", report.into_result()?);
    for load in [0.2, 0.5, 0.8_f64] {
        let mut scene = Scene::<f64, 2>::new();
        let beam = Beam::new(Cable, disk, law).straight([0.0; 2], [1.0, 0.0], 16);
        let (beam, moment) = (scene.add(beam)?, [0.0, 0.0, load * law.1 * law.2]);
        scene.clamp(beam.start())?;
        scene.moment(beam.end(), Moment::new(moment, MomentLaw::SlopeRotation(0)))?;
        let (system, curvature) = (scene.assemble()?, law.2 * load.atanh());
        let (mut state, exact) = (system.rest(), (1.0 - curvature.cos()) / curvature);
        Statics::default().solve(&system, &mut state)?;
        let tip = system.position(&state, beam.end())?[1];
        println!("tip at {tip:.6} m, exact {exact:.6} m");
    }
    Ok(())
}
