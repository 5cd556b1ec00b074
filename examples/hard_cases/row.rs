//! One row of the table: what is computed, against which truth, what it must keep, and what came
//! of it. A row that claims to have converged and keeps fewer digits than theory leaves has failed
//! silently; so has one that panics, and one that answers what has no answer.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use ancf::integrator::RunReport;
use ancf::prelude::*;
use ancf::solver::StaticReport;

/// What theory says of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Claim {
    /// An answer is at most this far from the truth, as a share of it, beside what its own report
    /// says of rounding: what the mesh or the step leaves.
    Within(f64),
    /// There is no answer: only a refusal is right.
    Refusal,
}

/// What a computation gives.
#[derive(Debug, Clone, Default)]
pub struct Answer {
    /// Distance to the truth, as a share of it.
    pub error: f64,
    /// What the library's report says that rounding may have taken.
    pub told: f64,
    /// Whether it ended at the residual that rounding leaves.
    pub at_floor: bool,
    /// Load or time steps, or points of a path.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// A curve to draw.
    pub curve: Vec<[f64; 2]>,
}

impl Answer {
    /// `found` for `truth`, by statics.
    pub fn statics(found: f64, truth: f64, report: &StaticReport) -> Self {
        Self {
            error: (found / truth - 1.0).abs(),
            told: report.rounding,
            at_floor: report.at_floor,
            steps: report.steps,
            iterations: report.iterations,
            curve: Vec::new(),
        }
    }

    /// An error, by dynamics.
    pub fn dynamics(error: f64, report: &RunReport) -> Self {
        Self {
            error,
            told: 0.0,
            at_floor: report.at_floor > 0,
            steps: report.steps,
            iterations: report.iterations,
            curve: Vec::new(),
        }
    }

    /// `found` for `truth`, along a path.
    pub fn path<S: Structure<R>, R: Real>(
        found: f64,
        truth: f64,
        path: &Continuation<'_, R, S>,
    ) -> Self {
        Self {
            error: (found / truth - 1.0).abs(),
            told: 0.0,
            at_floor: path.report().at_floor > 0,
            steps: path.report().points,
            iterations: path.report().corrections,
            curve: Vec::new(),
        }
    }

    /// The same with a curve.
    pub fn with_curve(mut self, curve: Vec<[f64; 2]>) -> Self {
        self.curve = curve;
        self
    }
}

/// A row before it is run.
pub struct Row {
    /// Figure or group it belongs to.
    pub family: &'static str,
    /// What is computed.
    pub case: String,
    /// Number type.
    pub number: &'static str,
    /// Formulation, or scheme.
    pub form: &'static str,
    /// What it is measured against.
    pub truth: &'static str,
    /// What is varied in the family.
    pub parameter: f64,
    /// What theory says.
    pub claim: Claim,
    /// Whether it takes more than some seconds.
    pub long: bool,
    /// The computation.
    pub run: Box<dyn Fn() -> Result<Answer>>,
}

/// What came of a row.
#[derive(Debug)]
pub enum Outcome {
    /// An answer.
    Answered(Answer),
    /// A refusal, by its message.
    Refused(String),
    /// A panic.
    Panicked(String),
}

/// A row that has been run.
pub struct Done {
    /// The row.
    pub row: Row,
    /// What came of it.
    pub outcome: Outcome,
    /// Time taken (s).
    pub seconds: f64,
}

/// What the report's estimate of rounding, one sample of noise, may be short of.
const ESTIMATE: f64 = 10.0;

/// Short name of a number type.
pub fn number<R: Real>() -> &'static str {
    match R::EPSILON {
        e if e > 1e-10 => "f32",
        e if e > 1e-20 => "f64",
        _ => "f64 x 2",
    }
}

impl Row {
    /// Runs it.
    pub fn run(self) -> Done {
        let start = Instant::now();
        let outcome = match catch_unwind(AssertUnwindSafe(|| (self.run)())) {
            Ok(Ok(answer)) => Outcome::Answered(answer),
            Ok(Err(error)) => Outcome::Refused(error.to_string()),
            Err(panic) => {
                let text = panic.downcast_ref::<String>().cloned();
                let word = panic.downcast_ref::<&str>().map(|s| (*s).to_string());
                Outcome::Panicked(text.or(word).unwrap_or_default())
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        Done {
            row: self,
            outcome,
            seconds,
        }
    }
}

impl Done {
    /// The answer, if there is one.
    pub fn answer(&self) -> Option<&Answer> {
        match &self.outcome {
            Outcome::Answered(answer) => Some(answer),
            _ => None,
        }
    }

    /// Decimal digits that agree with the truth.
    pub fn digits(&self) -> Option<f64> {
        let error = self.answer()?.error;
        Some(-error.clamp(1e-17, 1e9).log10())
    }

    /// Whether it gives a wrong answer without saying so, or panics.
    pub fn silent(&self) -> bool {
        match (&self.outcome, self.row.claim) {
            (Outcome::Refused(_), _) => false,
            (Outcome::Panicked(_), _) | (Outcome::Answered(_), Claim::Refusal) => true,
            // A NaN is within nothing.
            (Outcome::Answered(answer), Claim::Within(limit)) => {
                let limit = limit + ESTIMATE * answer.told;
                answer.error.partial_cmp(&limit).is_none_or(|o| o.is_gt())
            }
        }
    }

    /// Verdict in words.
    pub fn verdict(&self) -> String {
        let loud = if self.silent() {
            "SILENT FAILURE: "
        } else {
            ""
        };
        match &self.outcome {
            Outcome::Answered(Answer { at_floor: true, .. }) => format!("{loud}at rounding floor"),
            Outcome::Answered(_) => format!("{loud}converged"),
            Outcome::Refused(error) => format!("refused: {error}"),
            Outcome::Panicked(text) => format!("{loud}panic: {text}"),
        }
    }
}
