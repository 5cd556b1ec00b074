//! One dynamic run and what is kept of it: the tip on a time grid, the energies, where it
//! stopped and why. Failing is a result here: the fixed-step study is about it.

use std::error::Error;

use ancf::integrator::RunReport;
use ancf::prelude::*;

/// What to run.
#[derive(Debug, Clone, Copy)]
pub struct Plan {
    /// Method.
    pub method: Newmark,
    /// Step control.
    pub stepping: Stepping,
    /// End of the run (s).
    pub end: f64,
    /// Spacing of the samples (s).
    pub every: f64,
}

/// Tip and energies at one time.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Time (s).
    pub time: f64,
    /// Position of the tip (m).
    pub tip: [f64; 3],
    /// Energies (J) at the end of the step that contains the time.
    pub energies: Energies<f64>,
}

/// A finished run.
#[derive(Debug, Clone)]
pub struct Track {
    /// Samples from the start to the end or to the failure.
    pub samples: Vec<Sample>,
    /// Time reached (s).
    pub reached: f64,
    /// Energy balance at the end (J): kinetic, elastic and gravity less the work of loads.
    pub balance: f64,
    /// Effort.
    pub report: RunReport,
    /// Why the run stopped early.
    pub failure: Option<String>,
}

impl Track {
    /// Runs a plan and follows the position of a node. A step that fails ends the track and is
    /// not an error.
    ///
    /// # Errors
    /// When the run cannot be started.
    pub fn run(system: &System<f64, 3>, tip: Node, plan: &Plan) -> Result<Self> {
        let at = system.coordinate(tip, NodalVector::Position)?;
        let origin: [f64; 3] = std::array::from_fn(|c| system.reference()[at + c]);
        let mut run = Integration::start(system, system.rest(), &plan.method)?;
        let mut samples = vec![Sample {
            time: 0.0,
            tip: origin,
            energies: system.energies(run.state())?,
        }];
        let outcome = run.until(plan.end, plan.stepping, |step| {
            loop {
                // Rounding of the counted steps must not lose a sample at their end.
                let time = plan.every * samples.len() as f64;
                if time > step.after.time + 1e-9 {
                    break;
                }
                let inside = time.min(step.after.time);
                let mut tip = origin;
                for c in 0..3 {
                    tip[c] += step.displacement_at(inside, at + c)?;
                }
                samples.push(Sample {
                    time,
                    tip,
                    energies: system.energies(step.after)?,
                });
            }
            Ok(())
        });
        let failure = match outcome {
            Ok(_) => None,
            Err(ancf::Error::StepFailed { cause, .. }) => Some(cause.to_string()),
            Err(other) => return Err(other),
        };
        Ok(Self {
            samples,
            reached: run.state().time,
            balance: system.energies(run.state())?.balance(),
            report: run.report(),
            failure,
        })
    }

    /// Time and one component of the tip (m).
    pub fn component(&self, c: usize) -> Vec<[f64; 2]> {
        self.samples.iter().map(|s| [s.time, s.tip[c]]).collect()
    }

    /// The sample at a time of the grid.
    ///
    /// # Errors
    /// When the run did not get there.
    pub fn at(&self, time: f64) -> std::result::Result<&Sample, Box<dyn Error>> {
        self.samples
            .iter()
            .find(|s| (s.time - time).abs() < 1e-6)
            .ok_or_else(|| format!("the run has no sample at {time} s").into())
    }

    /// Largest distance of the tip (m) to a curve of time, x and y with the same grid, over the
    /// times up to `end` (s), taking every `stride`-th.
    pub fn distance(&self, curve: &[[f64; 3]], end: f64, stride: usize) -> f64 {
        let pairs = self.samples.iter().zip(curve).step_by(stride);
        pairs
            .filter(|(sample, _)| sample.time <= end + 1e-6)
            .map(|(sample, row)| (sample.tip[0] - row[1]).hypot(sample.tip[1] - row[2]))
            .fold(0.0, f64::max)
    }

    /// Largest size of the total energy (J), which starts from zero, up to `end` (s).
    pub fn energy_error(&self, end: f64) -> f64 {
        let before = self.samples.iter().filter(|s| s.time <= end + 1e-6);
        let sizes = before.map(|s| s.energies.total().abs());
        sizes.fold(0.0, f64::max)
    }

    /// Largest size of the energy balance (J), at the samples and at the end.
    pub fn worst_balance(&self) -> f64 {
        let sizes = self.samples.iter().map(|s| s.energies.balance().abs());
        sizes.fold(self.balance.abs(), f64::max)
    }

    /// Largest distance of the tip from the plane of the motion (m).
    pub fn out_of_plane(&self) -> f64 {
        let heights = self.samples.iter().map(|s| s.tip[2].abs());
        heights.fold(0.0, f64::max)
    }
}
