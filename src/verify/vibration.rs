//! Natural frequencies of a short chain against beam theory: stiffness, mass and their assembly in
//! one number per mode.

use super::{Limit, Report};
use crate::element::Element;
use crate::error::{Result, positive};
use crate::formulation::Formulation;
use crate::scene::{Beam, Scene};
use crate::section::Section;
use crate::solver::{Modes, Structure};

/// A uniform beam and its mesh: what theory and chain share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rod {
    /// Length (m).
    pub length: f64,
    /// Number of elements.
    pub elements: usize,
    /// Young's modulus (Pa).
    pub young: f64,
    /// Shear modulus times the shear factor (Pa): a section-linear element shears with factor 1.
    pub shear: f64,
    /// Density (kg/m^3).
    pub density: f64,
    /// Largest relative error of a frequency that passes.
    pub tolerance: f64,
}

/// How many of the lowest modes are compared, for each bending direction there is.
const MODES: usize = 2;

/// Compares the lowest bending frequencies of a chain held at its ends by spherical joints with
/// those of the simply supported beam of Timoshenko (S. P. Timoshenko, *Vibration Problems in
/// Engineering*, 1928), twice as many as there are bending directions; those of Euler and Bernoulli are listed beside
/// them. The beam must be slender enough for its bending modes to come first.
///
/// # Errors
/// Those of the scene and of [`Modes::vibration`].
pub fn frequencies<E, F, X, const D: usize, const S: usize>(
    element: &E,
    formulation: &F,
    section: &X,
    rod: &Rod,
) -> Result<Report>
where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
    X: Section<f64>,
{
    let mut end = [0.0; D];
    end[0] = rod.length;
    let mut scene = Scene::<f64, D>::new();
    let beam = scene.add(
        Beam::new(*element, section, formulation)
            .straight([0.0; D], end, rod.elements)
            .density(rod.density),
    )?;
    scene.pin(beam.start())?;
    scene.pin(beam.end())?;
    let system = scene.assemble()?;

    let p = section.properties()?;
    let mut truth: Vec<(f64, f64, String)> = Vec::new();
    for (axis, second) in [(1, p.izz), (2, p.iyy)].into_iter().take(D - 1) {
        // A flat section has several modes the one way before the first the other way.
        for mode in 1..=4 * MODES {
            let [timoshenko, euler] = simply_supported(rod, p.area, second, mode);
            truth.push((timoshenko, euler, format!("mode {mode} along X_{axis}")));
        }
    }
    truth.sort_by(|a, b| a.0.total_cmp(&b.0));
    truth.truncate(MODES * (D - 1));
    // Spinning about the axis costs nothing when the ends are spherical joints.
    let lowest = positive("lowest frequency of the beam [rad/s]", truth[0].0)?;
    let modes = Modes::lowest((truth.len() + 1).min(system.unknowns().count()));
    let mut modes = modes.vibration(&system, &system.rest(), 1.0)?;
    let spins = |value: f64| D == 3 && value.abs() <= 1e-4 * lowest * lowest;
    if let Some(spinning) = modes.iter().position(|mode| spins(mode.value)) {
        modes.remove(spinning);
    }
    let found: Vec<f64> = modes.iter().map(|mode| mode.frequency()).collect();
    let mut report = Report::new(format!("{element:?} in {D} dimensions on {section:?}"));
    for (k, (timoshenko, euler, case)) in truth.into_iter().enumerate() {
        let measured = found.get(k).copied().unwrap_or(f64::NAN);
        report.push(
            "frequency over Euler and Bernoulli's",
            &case,
            measured / euler,
            Limit::None,
        );
        let error = (measured / timoshenko - 1.0).abs();
        report.push(
            "frequency against Timoshenko's",
            case,
            error,
            Limit::AtMost(rod.tolerance),
        );
    }
    Ok(report)
}

/// Circular frequencies (rad/s) of a simply supported beam: Timoshenko's and Euler's.
fn simply_supported(rod: &Rod, area: f64, second: f64, mode: usize) -> [f64; 2] {
    let q2 = (mode as f64 * std::f64::consts::PI / rod.length).powi(2);
    let bending = rod.young * second;
    let mass = rod.density * area;
    // a w^4 - b w^2 + c = 0, smaller root, without cancellation.
    let a = rod.density * rod.density * second / rod.shear;
    let b = mass + q2 * second * rod.density * (1.0 + rod.young / rod.shear);
    let c = bending * q2 * q2;
    let square = 2.0 * c / (b + (b * b - 4.0 * a * c).sqrt());
    [square.sqrt(), (c / mass).sqrt()]
}
