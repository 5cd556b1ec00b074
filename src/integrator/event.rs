//! Events: functions of the state whose sign changes end a run at the moment they change.

use crate::error::{Result, finite};
use crate::scalar::Real;
use crate::solver::State;

/// Which change of sign is an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Crossing {
    /// From below zero.
    Rising,
    /// From above zero.
    Falling,
    /// Either way.
    #[default]
    Any,
}

/// What the driver asks after every step it could take.
pub(super) trait Watch<R: Real> {
    /// How far before (negative) or behind the event a state is, if the step from `before` to
    /// `after` meets it.
    ///
    /// # Errors
    /// When the function is not finite.
    fn meets(&mut self, before: &State<R>, after: &State<R>) -> Result<Option<[R; 2]>>;

    /// How far before (negative) or behind the event a state is.
    fn distance(&mut self, state: &State<R>) -> R;
}

/// No event.
pub(super) struct Never;

impl<R: Real> Watch<R> for Never {
    fn meets(&mut self, _before: &State<R>, _after: &State<R>) -> Result<Option<[R; 2]>> {
        Ok(None)
    }
    fn distance(&mut self, _state: &State<R>) -> R {
        R::zero()
    }
}

/// The event of a function.
pub(super) struct Event<F, R> {
    crossing: Crossing,
    function: F,
    /// Sign that turns the crossing being located into a rising one.
    sign: R,
}

impl<R: Real, F: FnMut(&State<R>) -> R> Event<F, R> {
    pub(super) fn new(crossing: Crossing, function: F) -> Self {
        let sign = R::one();
        Self {
            crossing,
            function,
            sign,
        }
    }
}

impl<R: Real, F: FnMut(&State<R>) -> R> Watch<R> for Event<F, R> {
    fn meets(&mut self, before: &State<R>, after: &State<R>) -> Result<Option<[R; 2]>> {
        let ends = [(self.function)(before), (self.function)(after)];
        for value in ends {
            finite("function of the state whose zero is the event", value)?;
        }
        let rises = |[a, b]: [R; 2]| a < R::zero() && b >= R::zero();
        let (up, down) = (ends, ends.map(|x| -x));
        let (sign, ends) = match self.crossing {
            Crossing::Rising | Crossing::Any if rises(up) => (R::one(), up),
            Crossing::Falling | Crossing::Any if rises(down) => (-R::one(), down),
            _ => return Ok(None),
        };
        self.sign = sign;
        Ok(Some(ends))
    }

    fn distance(&mut self, state: &State<R>) -> R {
        self.sign * (self.function)(state)
    }
}

/// Finds the shortest step that is not before an event: `distance` takes a step length to the
/// signed distance after it. Bisection, sped up by the secant with weights halved at an end that
/// stays (Illinois). Returns the step; its attempt is the last one made.
pub(super) fn locate<R: Real>(
    [mut low, mut high]: [R; 2],
    [mut before, mut behind]: [R; 2],
    resolution: R,
    mut distance: impl FnMut(R) -> Result<R>,
) -> Result<R> {
    let half = R::lit(0.5);
    let mut stands = false;
    let mut last = high;
    let mut kept = 0;
    while high - low > resolution && !behind.is_zero() {
        let secant = low - before * (high - low) / (behind - before);
        // An end that will not move is bisected away; so is a secant that rounds to an end.
        let inside = secant > low && secant < high;
        let trial = if inside && kept < 3 {
            secant
        } else {
            half * (low + high)
        };
        if trial <= low || trial >= high {
            break;
        }
        let value = distance(trial)?;
        last = trial;
        kept += 1;
        if value >= R::zero() {
            (high, behind) = (trial, value);
            before = if stands { before * half } else { before };
            kept = if stands { kept } else { 0 };
            stands = true;
        } else {
            (low, before) = (trial, value);
            behind = if stands { behind } else { behind * half };
            kept = if stands { 0 } else { kept };
            stands = false;
        }
    }
    if last != high {
        distance(high)?;
    }
    Ok(high)
}
