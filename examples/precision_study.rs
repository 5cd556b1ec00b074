//! What number types lose on slender beams: the error over the load of the transverse elastic force of
//! a bent and turned beam, in three forms of the strain, to `target/precision_study.svg` and `.png`.
use ancf::{prelude::*, scalar::DoubleDouble, verify::*};
use plot::{Axis, Panel, Series, Sheet, Stroke, colour::*};

#[allow(dead_code, reason = "the papers draw more than this example")]
#[path = "../papers/orzechowski-2012/plot.rs"]
mod plot;

/// A beam in any number type: its formulation, whether of total coordinates, made from a material.
macro_rules! beam {
    ($name:ident, $formulation:ty, $total:literal, $make:expr) => {
        struct $name;
        impl Slender<3, 8> for $name {
            type Element = FullyParameterised;
            type Section<R: Real> = Disk<R>;
            type Formulation<R: Real> = $formulation;
            const TOTAL: bool = $total;
            fn parts<R: Real>(&self, radius: R, young: R) -> Result<Parts<Self, R, 3, 8>> {
                let material = SaintVenantKirchhoff::isotropic(young, R::zero())?;
                Ok((FullyParameterised, Disk::new(radius)?, $make(material)))
            }
        }
    };
}
type Solid<R> = Continuum<SaintVenantKirchhoff<R, 3>>;
beam!(Total, Textbook<SaintVenantKirchhoff<R, 3>>, true, Textbook);
beam!(Plain, Solid<R>, false, Solid::full);
beam!(Moving, CoMoving<Solid<R>>, false, |m| CoMoving(
    Solid::full(m)
));

fn panel<B: Slender<3, 8>>(title: &str, beam: &B) -> Result<Panel> {
    let pose = Pose::default().turned(2.0);
    let poses = pose.sweep([1e-1, 1e-2, 1e-3, 1e-4, 1e-5]);
    let single = slender::<f32, DoubleDouble, _, 3, 8>(beam, &poses)?;
    let double = slender::<f64, DoubleDouble, _, 3, 8>(beam, &poses)?;
    let spread = slender_spread::<DoubleDouble, _, 3, 8>(beam, &poses)?;
    println!("{title} in f32\n{single}\n\n{title} in f64\n{double}\n");
    let series = [
        ("f32", ORANGE, single.points(|r| r.error)),
        ("f32, strains alone", AMBER, single.points(|r| r.strain)),
        ("f64", BLUE, double.points(|r| r.error)),
        ("f64, strains alone", SKY, double.points(|r| r.strain)),
        ("double-double", GREEN, spread),
    ]
    .map(|(name, tint, points)| Series::new(name, tint, Stroke::Marked, points));
    let x = Axis::log("R/L", 0.7e-5, 0.15);
    let y = Axis::log("error over the load", 1e-33, 1e7);
    Ok(Panel::new(title, x, y, series.into()))
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    plot::prepare()?;
    let total = panel("total coordinates", &Total)?;
    let plain = panel("displacements", &Plain)?;
    let moving = panel("co-moving frame", &Moving)?;
    let sheet = Sheet::row([2400, 900], 5, vec![total, plain, moving]);
    sheet.save("target".as_ref(), "precision_study")
}
