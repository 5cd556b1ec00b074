//! A shallow arch pressed down by a load like itself, a half wave of a sine: the path of equilibria through its
//! limit points, the branch on which it tips to one side before it comes to the first, and where both
//! should be by the closed form for shallow arches (Y. C. Fung, A. Kaplan, NACA TN 2840, 1952). Draws
//! `target/snap_through.svg` and `.png`.
use std::f64::consts::{PI, TAU};

use ancf::prelude::*;
use plot::{Axis, Panel, Series, Sheet, Stroke, colour};

#[allow(dead_code, reason = "the papers draw more than this example")]
#[path = "../papers/orzechowski-2012/plot.rs"]
mod plot;

/// Span (m), rise (m), radius of the rod (m), modulus (Pa) and number of elements.
const SPAN: f64 = 1.0;
const RISE: f64 = 0.0135;
const RADIUS: f64 = 0.005;
const YOUNG: f64 = 2.1e11;
const ELEMENTS: usize = 32;
/// The radius of gyration of a disk (m).
const GYRATION: f64 = RADIUS / 2.0;

/// Load (N/m at the crown) at a height of the crown (m) while the arch stays symmetric.
fn symmetric(height: f64) -> f64 {
    let thrust = height * (RISE * RISE - height * height) / (4.0 * GYRATION * GYRATION);
    bending() * (RISE - height + thrust)
}

/// The same while it leans to one side, under the thrust of Euler's second load.
fn leaning(height: f64) -> f64 {
    bending() * (RISE - height + 4.0 * height)
}

/// Load per change of height that bending alone resists.
fn bending() -> f64 {
    let area = PI * RADIUS * RADIUS;
    YOUNG * area * GYRATION * GYRATION * (PI / SPAN).powi(4)
}

/// The arch, pinned at both ends, under a load of `peak` (N/m) at the crown, and the coordinate that is
/// the crown's deflection.
fn arch(peak: f64) -> Result<(System<f64, 2>, usize)> {
    // Of so shallow an arch the fourth power of the slope counts for nothing.
    let slope = RISE * PI / SPAN;
    let stretch = slope * slope / 4.0;
    let axis = move |s: f64| {
        // The share of the span that belongs to a share of the arc length, by fixed points.
        let along = |x: f64| x + stretch / (1.0 + stretch) * (TAU * x).sin() / TAU;
        let x = (0..20).fold(s, |x, _| x + s - along(x));
        let tangent = [1.0, slope * (PI * x).cos()];
        let [cos, sin] = tangent.map(|t| t / tangent[1].hypot(1.0));
        let position = [SPAN * x, RISE * (PI * x).sin()];
        (position, [[cos, sin], [-sin, cos]])
    };
    let length = SPAN * (1.0 + stretch);
    let steel = SaintVenantKirchhoff::<f64, 2>::isotropic(YOUNG, 0.3)?;
    let beam = Beam::new(Cable, Disk::new(RADIUS)?, EulerBernoulli::new(&steel))
        .curved(length, ELEMENTS, axis);
    let mut scene = Scene::<f64, 2>::new();
    let beam = scene.add(beam)?;
    scene.pin(beam.start())?;
    scene.pin(beam.end())?;
    for k in 1..ELEMENTS {
        let share = (PI * k as f64 / ELEMENTS as f64).sin() * SPAN / ELEMENTS as f64;
        scene.force(beam.node(k), [0.0, -peak * share])?;
    }
    let system = scene.assemble()?;
    let crown = system.coordinate(beam.node(ELEMENTS / 2), NodalVector::Position)? + 1;
    Ok((system, crown))
}

/// Points of a path as parts of equal stability, solid where it is stable.
#[derive(Default)]
struct Drawn(Vec<(bool, Vec<[f64; 2]>)>);

impl Drawn {
    fn put(&mut self, point: [f64; 2], stable: bool) {
        match self.0.last_mut() {
            Some((same, points)) if *same == stable => points.push(point),
            last => {
                let joint = last.and_then(|(_, points)| points.last().copied());
                self.0
                    .push((stable, joint.into_iter().chain([point]).collect()));
            }
        }
    }

    fn series(self, name: &str, tint: plotters::style::RGBColor) -> Vec<Series> {
        let part = |(k, (stable, points)): (usize, (bool, Vec<_>))| {
            let stroke = if stable {
                Stroke::Solid
            } else {
                Stroke::Dashed
            };
            Series::new(if k == 0 { name } else { "" }, tint, stroke, points)
        };
        self.0.into_iter().enumerate().map(part).collect()
    }
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    // The crown's heights at which the symmetric arch has a limit point and at which it may tip.
    let limit = ((RISE * RISE - 4.0 * GYRATION * GYRATION) / 3.0).sqrt();
    let tips = (RISE * RISE - 16.0 * GYRATION * GYRATION).sqrt();
    let peak = symmetric(limit);
    let (system, crown) = arch(peak)?;
    let settings = Path {
        longest: 0.02,
        ..Path::by(Control::Sphere, 0.01)
    };

    let mut whole = Drawn::default();
    let mut path = Continuation::start(&system, system.rest(), 0.0, &settings)?;
    path.until(Target::Coordinate(crown, -2.3 * RISE), |point| {
        let fallen = -point.state.displacement[crown] / RISE;
        whole.put([fallen, point.factor], point.unstable == Some(0));
    })?;

    println!("                      crown at (mm)   load (N/m)   closed form");
    let truth = [tips, limit, -limit, -tips];
    let mut marks = Vec::new();
    for (critical, height) in path.criticals().iter().zip(truth) {
        let at = RISE + critical.state.displacement[crown];
        let (load, closed) = (critical.factor * peak, symmetric(height));
        let kind = format!("{:?}", critical.kind);
        println!("{kind:20} {:14.3} {load:12.2} {closed:13.2}", 1e3 * at);
        marks.push([1.0 - at / RISE, critical.factor]);
    }

    // From the first bifurcation along the branch, to just before it comes back to the path.
    let mut branch = Drawn::default();
    let mut side = Continuation::start(&system, system.rest(), 0.0, &settings)?;
    side.until(Target::Critical, |_| {})?;
    let bifurcation = side.criticals()[0].clone();
    side.switch(&bifurcation, 0.02)?;
    branch.put(marks[0], false);
    let mut worst = 0.0_f64;
    side.until(Target::Coordinate(crown, -RISE - 0.98 * tips), |point| {
        let height = RISE + point.state.displacement[crown];
        worst = worst.max((point.factor - leaning(height) / peak).abs());
        branch.put(
            [1.0 - height / RISE, point.factor],
            point.unstable == Some(0),
        );
    })?;
    println!("branch off its closed form by {worst:.1e} of the limit load at most");

    let heights = (0..=200).map(|k| RISE * (1.0 - 2.3 * f64::from(k) / 200.0));
    let closed = heights.map(|h| [1.0 - h / RISE, symmetric(h) / peak]);
    let mut series = vec![Series::new(
        "closed form",
        colour::GREY,
        Stroke::Solid,
        closed.collect(),
    )];
    series.extend(whole.series("symmetric (dashed: unstable)", colour::BLUE));
    series.extend(branch.series("leaning to one side", colour::ORANGE));
    series.push(Series::new(
        "critical points",
        colour::BLACK,
        Stroke::Crosses,
        marks,
    ));
    plot::prepare()?;
    let x = Axis::linear("deflection of the crown over the rise", 0.0, 2.3);
    let y = Axis::linear("load over the limit load", -0.6, 1.2);
    let panel = Panel::new("A shallow arch, snapped through", x, y, series);
    Sheet::row([1400, 900], 2, vec![panel]).save("target".as_ref(), "snap_through")
}
