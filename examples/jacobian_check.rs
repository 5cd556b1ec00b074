//! Draws how finite differences approach an exact tangent and leave it again: a bent cantilever in
//! double and single precision, to `target/jacobian_check.svg` and `.png`.
use ancf::{prelude::*, verify};
use plot::{Axis, Panel, Series, Sheet, Stroke, colour};
use verify::{Curve, Scheme, structure_tangent};

#[allow(dead_code, reason = "the papers draw more than this example")]
#[path = "../papers/orzechowski-2012/plot.rs"]
mod plot;

fn cantilever<R: Real>() -> Result<Curve> {
    let [zero, one, radius] = [0.0, 1.0, 0.05].map(R::lit);
    let rubber = SaintVenantKirchhoff::isotropic(R::lit(2.0e7), R::lit(0.3))?;
    let mut scene = Scene::<R, 3>::new();
    let beam = Beam::new(
        FullyParameterised,
        Disk::new(radius)?,
        Continuum::full(rubber),
    );
    let beam = scene.add(beam.straight([zero; 3], [one, zero, zero], 4))?;
    scene.clamp(beam.start())?;
    scene.moment(beam.end(), Moment::about_z(R::lit(100.0)))?;
    let system = scene.assemble()?;
    let mut state = system.rest();
    Statics::default().solve(&system, &mut state)?;
    structure_tangent(&system, zero, &state.displacement)
}

fn panel(title: &str, curve: &Curve) -> Panel {
    let tints = [colour::BLUE, colour::ORANGE, colour::GREEN];
    let series = Scheme::ALL.into_iter().zip(tints).map(|(s, tint)| {
        let (name, points) = (format!("{s:?}"), curve.points(s).collect());
        Series::new(&name, tint, Stroke::Marked, points)
    });
    let x = Axis::log("increment (relative)", 1e-15, 1.0);
    let y = Axis::log("error of the tangent (relative)", 1e-15, 1e2);
    Panel::new(title, x, y, series.collect())
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let (double, single) = (cantilever::<f64>()?, cantilever::<f32>()?);
    println!("double precision: {}", double.report(1e3).into_result()?);
    println!("single precision: {}", single.report(1e3).into_result()?);
    plot::prepare()?;
    let panels = vec![panel("double", &double), panel("single", &single)];
    let sheet = Sheet::row([1800, 760], 3, panels);
    sheet.save("target".as_ref(), "jacobian_check")
}
