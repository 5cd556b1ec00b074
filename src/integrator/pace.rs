//! Equal steps, counted: where a run stands among them, also within one that is made of parts; and the
//! last steps before an end.

use crate::scalar::Real;

/// Most often that a step is halved: its parts are counted in doubles.
const HALVINGS: u32 = 50;

/// Whole steps are counted and not summed, so that rounding adds no sliver at the end, and so that a
/// run that was stopped goes on at the very times of one that was not.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Pace<R> {
    /// Time from which steps are counted (s).
    start: R,
    /// Step (s).
    step: R,
    /// Steps taken since.
    whole: u64,
    /// Length of the step under way (s), shorter than the others at the end, and its end (s).
    length: R,
    to: R,
    /// How often the step under way is halved, and parts taken of it.
    level: u32,
    part: u64,
}

impl<R: Real> Pace<R> {
    /// Steps of a length from `now` on: those under way if they have come to just here.
    pub(super) fn from(under_way: Option<Self>, now: R, step: R, end: R) -> Self {
        let fits = |pace: &Self| {
            pace.step == step && pace.reached() == now && (pace.part == 0 || pace.to <= end)
        };
        under_way.filter(fits).unwrap_or(Self {
            start: now,
            step,
            whole: 0,
            length: step,
            to: now + step,
            level: 0,
            part: 0,
        })
    }

    /// Steps the next part, of whole steps where one ends before `end`; none if no step is left.
    pub(super) fn next(&mut self, now: R, end: R) -> Option<R> {
        if self.part == 0 {
            let steps = ((end - self.start) / self.step).value() + 1e-6;
            (self.length, self.to) = if self.whole < steps.floor() as u64 {
                (self.step, self.counted(self.whole + 1))
            } else if end - now > self.step * R::lit(1e-6)
                // What rounding of the time leaves is no step.
                && end - now > end.abs().larger(now.abs()) * R::lit(4.0 * R::EPSILON)
            {
                (end - now, end)
            } else {
                return None;
            };
        }
        Some(self.piece())
    }

    /// Time at which the next part ends (s).
    pub(super) fn end(&self) -> R {
        self.to - self.piece() * R::lit(2.0_f64.powi(self.level as i32) - self.part as f64 - 1.0)
    }

    /// Counts the part; two halves are one whole.
    pub(super) fn advance(&mut self) {
        self.part += 1;
        while self.level > 0 && self.part.is_multiple_of(2) {
            self.part /= 2;
            self.level -= 1;
        }
        if self.level == 0 {
            self.part = 0;
            self.whole += 1;
        }
    }

    /// Halves the next part, if it may be halved once more, and tells the half (s).
    pub(super) fn halve(&mut self, halvings: u32) -> Option<R> {
        if self.level >= halvings.min(HALVINGS) {
            return None;
        }
        self.level += 1;
        self.part *= 2;
        Some(self.piece())
    }

    fn counted(&self, whole: u64) -> R {
        self.start + self.step * R::lit(whole as f64)
    }

    fn piece(&self) -> R {
        self.length * R::lit(0.5_f64.powi(self.level as i32))
    }

    /// Time up to which parts are counted (s).
    fn reached(&self) -> R {
        match self.part {
            0 => self.counted(self.whole),
            part => {
                let left = 2.0_f64.powi(self.level as i32) - part as f64;
                self.to - self.piece() * R::lit(left)
            }
        }
    }
}

/// A step towards an end `left` seconds away: two even steps rather than one and a sliver.
pub(super) fn even<R: Real>(left: R, step: R) -> R {
    match left {
        left if left <= step => left,
        left if left < step * R::lit(2.0) => left * R::lit(0.5),
        _ => step,
    }
}
