//! The log of a run tells of every step that was tried and not taken, no more and no less, with what
//! the run does next.

use std::cell::RefCell;

use ancf::prelude::*;

use super::models::{Particle, Spring, pendulum};

/// A refusal, and the state's time when the next step was accepted.
#[derive(Debug)]
struct Entry {
    time: f64,
    step: f64,
    retry: Option<f64>,
    inaccurate: bool,
    text: String,
}

fn entry(refused: Refusal<'_, f64>) -> Entry {
    Entry {
        time: refused.time,
        step: refused.step,
        retry: refused.retry,
        inaccurate: matches!(refused.cause, Error::Inaccurate { .. }),
        text: refused.cause.to_string(),
    }
}

/// The hasty Newton's method of a rod dropped with long steps.
fn hasty() -> Newmark {
    Newmark::trapezoidal().with_newton(Newton {
        iterations: 4,
        ..Newton::default()
    })
}

/// Runs, and gives the log, the accepted steps `[start, end]` and how it went.
fn logged(
    scheme: &impl Scheme<f64>,
    stepping: Stepping,
    end: f64,
) -> (Vec<Entry>, Vec<[f64; 2]>, RunReport, Result<Ending>) {
    let (system, _) = pendulum(6);
    let log = RefCell::new(Vec::new());
    let mut taken = Vec::new();
    let mut run = Integration::start(&system, system.rest(), scheme)
        .unwrap()
        .logging(|refused| log.borrow_mut().push(entry(refused)));
    let result = run.until(end, stepping, |step| {
        assert_eq!(step.length(), step.after.time - step.before.time);
        taken.push([step.before.time, step.after.time]);
    });
    let report = run.report();
    drop(run);
    (log.into_inner(), taken, report, result)
}

/// Log and count agree, and each refusal is followed by the step it announces or a shorter one.
fn agree(log: &[Entry], report: &RunReport) {
    assert!(!log.is_empty());
    let inaccurate = log.iter().filter(|entry| entry.inaccurate).count();
    assert_eq!(inaccurate, report.rejected);
    assert_eq!(log.len() - inaccurate, report.failed);
    for entry in log {
        assert!(
            entry.retry.is_none_or(|retry| retry < entry.step),
            "{entry:?}"
        );
    }
}

#[test]
fn rejections_of_error_control() {
    let control = Stepping::Adaptive(Adaptive::to(1e-5));
    let (log, taken, report, result) = logged(&Newmark::trapezoidal(), control, 0.3);
    assert_eq!(result, Ok(Ending::End));
    agree(&log, &report);
    assert!(report.failed == 0 && report.steps == taken.len());
    for (i, entry) in log.iter().enumerate() {
        assert!(
            entry.text.contains("above the tolerance of 1.00e-5"),
            "{entry:?}"
        );
        // What comes next from the same time: another refusal, or the step taken.
        let next = log.get(i + 1).filter(|next| next.time == entry.time);
        let [start, end] = *taken
            .iter()
            .find(|[start, _]| *start == entry.time)
            .unwrap();
        let tried = next.map_or(end - start, |next| next.step);
        assert!(
            tried <= entry.retry.unwrap() * (1.0 + 1e-9),
            "{entry:?}, then {tried}"
        );
    }
}

#[test]
fn failures_are_halved() {
    let stepping = Stepping::Halved {
        step: 0.03,
        halvings: 6,
    };
    let (log, _, report, result) = logged(&hasty(), stepping, 0.6);
    assert_eq!(result, Ok(Ending::End));
    agree(&log, &report);
    assert_eq!(report.rejected, 0);
    for entry in log {
        assert_eq!(entry.retry, Some(0.5 * entry.step));
        assert!(entry.text.contains("after 4 iterations"), "{entry:?}");
    }
}

/// The step that ends a run is in the log, too, and nothing is tried instead.
#[test]
fn the_step_that_ends_a_run() {
    let mut short = Adaptive::to(1e-12);
    short.shortest = 1e-5;
    for (scheme, stepping) in [
        (hasty(), Stepping::Fixed(0.03)),
        (Newmark::trapezoidal(), Stepping::Adaptive(short)),
    ] {
        let (log, taken, report, result) = logged(&scheme, stepping, 0.6);
        agree(&log, &report);
        let last = log.last().unwrap();
        let reached = taken.last().map_or(0.0, |[_, end]| *end);
        assert!(last.retry.is_none() && last.time == reached, "{last:?}");
        assert!(log.iter().rev().skip(1).all(|entry| entry.retry.is_some()));
        match result.unwrap_err() {
            Error::StepFailed { time, step, .. } => assert_eq!([time, step], [reached, last.step]),
            other => panic!("{other}"),
        }
    }
}

/// A single step refused counts and is told, too.
#[test]
fn a_single_step() {
    let spring = Particle::new(Spring(50.0));
    let log = RefCell::new(Vec::new());
    let scheme = CentralDifference::default();
    let run = Integration::start(&spring, spring.at(1.0, 0.0), &scheme).unwrap();
    let mut run = run.logging(|refused| log.borrow_mut().push(entry(refused)));
    run.step(0.05).unwrap_err();
    assert_eq!(run.report().failed, 1);
    assert!(log.borrow()[0].text.contains("stability limit"));
}

/// The share of the way grows to one, over all calls and from wherever the state's clock stood.
#[test]
fn the_share_of_the_way() {
    let spring = Particle::new(Spring(5.0));
    let mut state = spring.at(1.0, 0.0);
    state.time = 2.0;
    let mut run = Integration::start(&spring, state, &Newmark::trapezoidal()).unwrap();
    let mut shares = Vec::new();
    for end in [2.5, 3.0] {
        run.until(end, Stepping::Fixed(0.125), |step| {
            shares.push((step.after.time, step.report.steps, step.share()));
        })
        .unwrap();
    }
    let wanted = |n: usize| {
        let time = 2.0 + 0.125 * n as f64;
        (time, n, (time - 2.0) / if n <= 4 { 0.5 } else { 1.0 })
    };
    assert_eq!(shares, (1..=8).map(wanted).collect::<Vec<_>>());
}
