//! What a run costs and how far it ends from the truth: processor time of the thread, best of
//! several, and the largest distance of what is watched to a reference.

use ancf::integrator::RunReport;
use ancf::prelude::*;
use cpu_time::ThreadTime;

/// One run, as a line of the table.
#[derive(Debug, Clone)]
pub struct Record {
    /// Problem.
    pub problem: &'static str,
    /// Elements and formulation, dimension and number type.
    pub model: String,
    /// Number of elements.
    pub elements: usize,
    /// Integrator or solver, and when its tangent is renewed.
    pub method: String,
    /// Step (s), tolerance or number of load steps.
    pub setting: String,
    /// Processor time (s); of the solution alone, the system is assembled before.
    pub seconds: f64,
    /// Largest distance to the reference over the tip's largest displacement.
    pub error: f64,
    /// The same to the converged solution of the same mesh, the integrator's own.
    pub own_error: Option<f64>,
    /// The order in which theory makes that fall with the step; 0 in statics.
    pub order: usize,
    /// The step (s) where it is given; that of statics is none, that of error control not known.
    pub step: f64,
    /// Steps taken.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
}

/// What a run took and gave.
#[derive(Debug, Clone, Copy, Default)]
pub struct Effort {
    /// Steps taken.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
}

impl From<RunReport> for Effort {
    fn from(report: RunReport) -> Self {
        Self {
            steps: report.steps,
            iterations: report.iterations,
        }
    }
}

/// Does work three times and until some hundredths of a second have gone into it, long work twice, and says
/// how long it took at best (s).
///
/// # Errors
/// Those of the work.
pub fn timed<T>(mut work: impl FnMut() -> Result<T>) -> Result<(f64, T)> {
    let (mut best, mut spent, mut tries) = (f64::INFINITY, 0.0, 0);
    loop {
        let start = ThreadTime::now();
        let done = work()?;
        let seconds = start.elapsed().as_secs_f64();
        (best, spent, tries) = (best.min(seconds), spent + seconds, tries + 1);
        if tries >= 2 && spent > if tries == 2 { 0.2 } else { 0.02 } {
            return Ok((best, done));
        }
    }
}

/// Coordinates over time: what a reference says of them.
#[derive(Debug, Clone)]
pub struct Watch {
    /// Their indices.
    pub coordinates: Vec<usize>,
    /// Their values in the reference state (m).
    pub origin: Vec<f64>,
    /// Times (s) and values (m).
    pub rows: Vec<(f64, Vec<f64>)>,
}

impl Watch {
    /// Watches components of a node's position.
    ///
    /// # Errors
    /// For a node of another scene.
    pub fn node<R: Real, const D: usize>(
        system: &System<R, D>,
        nodes: &[(Node, usize)],
        rows: Vec<(f64, Vec<f64>)>,
    ) -> Result<Self> {
        let mut coordinates = Vec::new();
        for (node, component) in nodes {
            let first = system.coordinate(*node, NodalVector::Position)?;
            coordinates.push(first + component);
        }
        let origin = coordinates.iter().map(|i| system.reference()[*i].value());
        Ok(Self {
            origin: origin.collect(),
            coordinates,
            rows,
        })
    }

    /// Largest displacement in the reference (m).
    fn travel(&self) -> f64 {
        let sizes = self.rows.iter().map(|(_, row)| apart(row, &self.origin));
        sizes.fold(0.0, f64::max)
    }

    /// Largest distance of values at the times of the rows to them, over the largest displacement.
    pub fn error(&self, found: &[Vec<f64>]) -> f64 {
        if found.len() != self.rows.len() {
            return f64::NAN;
        }
        let pairs = self.rows.iter().zip(found);
        let worst = pairs.map(|((_, row), found)| apart(row, found));
        worst.fold(0.0, f64::max) / self.travel()
    }

    /// Watches the same coordinates against values found by another run.
    pub fn against(&self, found: Vec<Vec<f64>>) -> Self {
        let times = self.rows.iter().map(|(time, _)| *time);
        Self {
            rows: times.zip(found).collect(),
            ..self.clone()
        }
    }

    /// Runs from rest to the last row and returns the values at all of them.
    ///
    /// # Errors
    /// When a step fails.
    pub fn follow<R: Real, const D: usize>(
        &self,
        system: &System<R, D>,
        method: &Method,
    ) -> Result<(Vec<Vec<f64>>, Effort)> {
        let newton = Newton {
            refresh: method.refresh,
            ..Newton::default()
        };
        let alpha = Newmark::generalised_alpha(0.8);
        let energy = EnergyMomentum::conserving();
        match method.integrator {
            Integrator::Trapezoidal => {
                self.run(system, method, &Newmark::trapezoidal().with_newton(newton))
            }
            Integrator::Alpha => self.run(system, method, &alpha.with_newton(newton)),
            Integrator::Hht => self.run(system, method, &Newmark::hht(0.1).with_newton(newton)),
            Integrator::Midpoint => self.run(system, method, &Midpoint { newton }),
            // To rounding, as it must be, or energy is not kept.
            Integrator::Energy => self.run(system, method, &energy),
            Integrator::Gauss(s) => {
                self.run(system, method, &Collocation::gauss(s).with_newton(newton))
            }
            Integrator::Radau(s) => {
                self.run(system, method, &Collocation::radau(s).with_newton(newton))
            }
            Integrator::Central => self.run(system, method, &CentralDifference::default()),
        }
    }

    fn run<R: Real, const D: usize>(
        &self,
        system: &System<R, D>,
        method: &Method,
        scheme: &impl Scheme<R>,
    ) -> Result<(Vec<Vec<f64>>, Effort)> {
        // Rounding of the counted steps must not lose a row at their end.
        let slack = 1e-6;
        let mut found = Vec::with_capacity(self.rows.len());
        let mut run = Integration::start(system, system.rest(), scheme)?;
        let end = self.rows.last().map_or(0.0, |(time, _)| *time);
        run.until(R::lit(end), method.stepping, |step| -> Result<()> {
            while let Some((time, _)) = self.rows.get(found.len()) {
                let now = step.after.time.value();
                if *time > now + slack {
                    break;
                }
                let inside = R::lit(time.min(now));
                let at = |(i, origin): (&usize, &f64)| {
                    Ok(step.displacement_at(inside, *i)?.value() + origin)
                };
                let pairs = self.coordinates.iter().zip(&self.origin);
                found.push(pairs.map(at).collect::<Result<Vec<f64>>>()?);
            }
            Ok(())
        })?;
        Ok((found, run.report().into()))
    }
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f64>().sqrt()
}

/// Time integration schemes under one type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Integrator {
    /// Newmark's trapezoidal rule.
    Trapezoidal,
    /// Generalised-alpha with a spectral radius of 0.8.
    Alpha,
    /// Hilber, Hughes and Taylor's method with a parameter of 0.1.
    Hht,
    /// Implicit midpoint rule.
    Midpoint,
    /// The conserving energy-momentum method.
    Energy,
    /// Collocation at Gauss points.
    Gauss(usize),
    /// Collocation at Radau points.
    Radau(usize),
    /// Central differences.
    Central,
}

impl Integrator {
    /// Name in tables and legends.
    pub fn name(self) -> String {
        match self {
            Self::Trapezoidal => "trapezoidal".into(),
            Self::Alpha => "generalised-alpha".into(),
            Self::Hht => "HHT".into(),
            Self::Midpoint => "midpoint".into(),
            Self::Energy => "energy-momentum".into(),
            Self::Gauss(s) => format!("Gauss {s}"),
            Self::Radau(s) => format!("Radau {s}"),
            Self::Central => "central differences".into(),
        }
    }

    /// Order of accuracy in theory.
    pub fn order(self) -> usize {
        match self {
            Self::Gauss(s) => 2 * s,
            Self::Radau(s) => 2 * s - 1,
            _ => 2,
        }
    }
}

/// An integrator with all its settings.
#[derive(Debug, Clone, Copy)]
pub struct Method {
    /// Scheme.
    pub integrator: Integrator,
    /// When its tangent is renewed.
    pub refresh: Refresh,
    /// Steps.
    pub stepping: Stepping,
}

impl Method {
    /// Fixed steps (s), tangent renewed when slow.
    pub fn fixed(integrator: Integrator, step: f64) -> Self {
        Self {
            integrator,
            refresh: Refresh::WhenSlow,
            stepping: Stepping::Fixed(step),
        }
    }

    /// Error control to a tolerance, tangent renewed when slow.
    pub fn adaptive(integrator: Integrator, tolerance: f64) -> Self {
        Self {
            stepping: Stepping::Adaptive(Adaptive::smoothly_to(tolerance)),
            ..Self::fixed(integrator, 0.0)
        }
    }

    /// The paper's: the tangent renewed in every iteration.
    pub fn full_newton(self) -> Self {
        Self {
            refresh: Refresh::EveryIteration,
            ..self
        }
    }

    /// The step (s); more than any where it is not given.
    pub fn step(&self) -> f64 {
        match self.stepping {
            Stepping::Fixed(step) | Stepping::Halved { step, .. } => step,
            Stepping::Stable(_) | Stepping::Adaptive(_) => f64::INFINITY,
        }
    }

    /// Name in tables.
    pub fn name(&self) -> String {
        let adaptive = if matches!(self.stepping, Stepping::Adaptive(_)) {
            ", adaptive"
        } else {
            ""
        };
        let newton = match (self.integrator, self.refresh) {
            (Integrator::Central | Integrator::Energy, _) => "",
            (_, Refresh::EveryIteration) => ", full Newton",
            (_, Refresh::EverySolve) => ", one tangent a step",
            _ => "",
        };
        format!("{}{adaptive}{newton}", self.integrator.name())
    }

    /// Step or tolerance, in tables.
    pub fn setting(&self) -> String {
        match self.stepping {
            Stepping::Fixed(step) | Stepping::Halved { step, .. } => format!("dt {step:.1e} s"),
            Stepping::Stable(share) => format!("{share} of the stable step"),
            Stepping::Adaptive(control) => format!("tolerance {:.0e}", control.tolerance),
        }
    }
}
