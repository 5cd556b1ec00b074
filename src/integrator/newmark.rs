//! Newmark's method, the integrator of the paper, and the family it grew into: the methods of
//! Hilber, Hughes and Taylor and of Chung and Hulbert differ from it by two weights, so all are one
//! implementation. Their accelerations are kept in the form of Arnold and Bruels (2007), in which
//! equilibrium holds at the end of the step and the weights act on an auxiliary acceleration.

use super::{Method, Scheme, mean_squares, prepare};
use crate::error::{Error, Result};
use crate::scalar::{Elementwise, Real, elementwise};
use crate::solver::{
    Equations, Newton, Rate, Rest, Sample, Solved, State, Structure, Tape, Workspace,
};

/// How the local error of a Newmark step is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Estimator {
    /// Li, Zeng and Wiberg (1993), the paper's choice: the exact third-order terms for a jerk that
    /// varies linearly over this step and the last, as long as errors are estimated in both; else as the
    /// other estimator.
    #[default]
    LiZengWiberg,
    /// Zienkiewicz and Xie (1991): `(beta - 1/6) dt^2 (a_{n+1} - a_n)`.
    ZienkiewiczXie,
}

/// The family of generalised-alpha methods: `u_{n+1} = u + dt v + dt^2 ((1/2 - beta) w + beta
/// w_{n+1})` and `v_{n+1} = v + dt ((1 - gamma) w + gamma w_{n+1})` with
/// `(1 - alpha_m) w_{n+1} + alpha_m w = (1 - alpha_f) a_{n+1} + alpha_f a`, where `a` is the
/// acceleration of equilibrium (Chung and Hulbert 1993, in the form of Arnold and Bruels 2007). With
/// both weights zero this is Newmark's method, with `alpha_m` zero that of Hilber, Hughes and
/// Taylor (1977).
///
/// ```
/// use ancf::prelude::*;
///
/// // No dissipation where the step resolves the motion, a factor 0.8 per step where it does not.
/// let method = Newmark::generalised_alpha(0.8);
/// assert!((method.alpha_f - 4.0 / 9.0).abs() < 1e-15);
/// assert_eq!(Newmark::hht(0.0), Newmark::trapezoidal());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newmark {
    /// Weight of the new acceleration in the displacement.
    pub beta: f64,
    /// Weight of the new acceleration in the velocity.
    pub gamma: f64,
    /// Weight of the old acceleration in the balance of inertia.
    pub alpha_m: f64,
    /// Weight of the old forces in the balance.
    pub alpha_f: f64,
    /// Newton's method within a step.
    pub newton: Newton,
    /// Local error estimator of the adaptive step.
    pub estimator: Estimator,
}

impl Default for Newmark {
    fn default() -> Self {
        Self::trapezoidal()
    }
}

impl Newmark {
    /// Constant average acceleration, the trapezoidal rule: `beta = 1/4`, `gamma = 1/2`; second
    /// order, no numerical damping.
    pub fn trapezoidal() -> Self {
        Self::weighted(0.0, 0.0)
    }

    /// The method of Hilber, Hughes and Taylor with their `-alpha`, from 0 (the trapezoidal rule)
    /// to 1/3 (most dissipation): second order.
    pub fn hht(alpha: f64) -> Self {
        Self::weighted(0.0, alpha)
    }

    /// The method of Chung and Hulbert that multiplies motions far above the step's resolution by
    /// `radius` per step, from 0 (they vanish) to 1 (no dissipation), and dissipates least below:
    /// second order.
    pub fn generalised_alpha(radius: f64) -> Self {
        Self::weighted(
            (2.0 * radius - 1.0) / (radius + 1.0),
            radius / (radius + 1.0),
        )
    }

    /// The member of second order with these weights that dissipates most at high frequencies.
    fn weighted(alpha_m: f64, alpha_f: f64) -> Self {
        let lag = alpha_f - alpha_m;
        Self {
            beta: 0.25 * (1.0 + lag) * (1.0 + lag),
            gamma: 0.5 + lag,
            alpha_m,
            alpha_f,
            newton: Newton::default(),
            estimator: Estimator::default(),
        }
    }

    /// The same method with other settings of Newton's method.
    pub fn with_newton(mut self, newton: Newton) -> Self {
        self.newton = newton;
        self
    }

    /// The same method with another error estimator.
    pub fn with_estimator(mut self, estimator: Estimator) -> Self {
        self.estimator = estimator;
        self
    }
}

impl<R: Real> Scheme<R> for Newmark {
    type Method = NewmarkMethod<R>;

    fn start<S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<NewmarkMethod<R>> {
        self.newton.check()?;
        // The family of Chung and Hulbert is known by its radius, which the weights hold to rounding.
        let radius = self.alpha_f / (1.0 - self.alpha_f);
        let of_radius = Self::generalised_alpha(radius).alpha_m;
        if (self.alpha_m - of_radius).abs() < 1e-12 && !(0.0..=1.0).contains(&radius) {
            return Err(Error::OutOfRange {
                what: "spectral radius of the generalised-alpha method",
                value: (radius * 1e12).round() / 1e12,
                range: "[0, 1]",
                remedy: "use Newmark::generalised_alpha with 0 to 1, with 1 for no dissipation",
            });
        }
        for (what, value, least, most) in [
            ("Newmark's beta", self.beta, f64::MIN_POSITIVE, 1.0),
            ("Newmark's gamma", self.gamma, 0.5, 1.5),
            (
                "alpha_f of the generalised-alpha method",
                self.alpha_f,
                0.0,
                0.5,
            ),
            (
                "alpha_m of the generalised-alpha method",
                self.alpha_m,
                -1.0,
                self.alpha_f,
            ),
        ] {
            if !(least..=most).contains(&value) {
                return Err(Error::OutOfRange {
                    what,
                    value,
                    range: "(0, 1] for beta, [1/2, 3/2] for gamma, [0, 1/2] for alpha_f and [-1, alpha_f] for alpha_m",
                    remedy: "use Newmark::trapezoidal (1/4, 1/2), Newmark::hht with 0 to 1/3, Newmark::generalised_alpha with 0 to 1, or gamma >= 1/2 with beta >= gamma / 2",
                });
            }
        }
        let workspace = prepare(structure, state)?;
        let zeros = || vec![R::zero(); state.displacement.len()];
        let weighs = self.alpha_m != 0.0 || self.alpha_f != 0.0;
        let differs = weighs || !structure.multipliers().is_empty();
        Ok(NewmarkMethod {
            settings: *self,
            workspace,
            auxiliary: differs.then(|| [state.acceleration.clone(), zeros()]),
            before: zeros(),
            noted: None,
            estimating: false,
            step_before: None,
            step: None,
        })
    }
}

/// Newmark's method at work on a structure.
#[derive(Debug)]
pub struct NewmarkMethod<R> {
    settings: Newmark,
    workspace: Workspace<R>,
    /// Auxiliary accelerations of the last step taken and of the last one tried, where they differ from
    /// those of equilibrium: where old ones have a weight, or constraints take a share of these.
    auxiliary: Option<[Vec<R>; 2]>,
    /// Acceleration one step earlier and the length of that step, where the estimate of its error asks for
    /// them in the next; whether that of this step does.
    before: Vec<R>,
    noted: Option<R>,
    estimating: bool,
    /// Length of the last step taken.
    step_before: Option<R>,
    /// Length of the last step tried, to which a kept tangent belongs.
    step: Option<R>,
}

elementwise! {
    /// The acceleration, kept, and what it makes of displacements.
    Guess(step, half): [a, v, u] -> [acceleration, guess] {
        *acceleration = a;
        *guess = u + (step * v + half * a);
    }
}

elementwise! {
    /// What a correction of displacements makes of accelerations and velocities.
    Follow(rate, step, gamma): [moved, v] -> [acceleration, velocity] {
        let change = rate * moved;
        *velocity = v + step * (*acceleration + gamma * change);
        *acceleration += change;
    }
}

elementwise! {
    /// The auxiliary acceleration of constant ones, what it makes of the acceleration, and displacements.
    LaggingGuess(ratio, share, alpha_f, step, half): [a, v, u, old] -> [new, acceleration, guess] {
        *new = a + ratio * (old - a);
        *acceleration = share * (*new - alpha_f * a);
        *guess = u + (step * v + half * *new);
    }
}

elementwise! {
    /// What a correction of displacements makes of either acceleration and of velocities.
    LaggingFollow(rate, inertia, step, gamma): [moved, v] -> [new, acceleration, velocity] {
        let change = rate * moved;
        *acceleration += inertia * moved;
        *velocity = v + step * (*new + gamma * change);
        *new += change;
    }
}

impl<R: Real> Method<R> for NewmarkMethod<R> {
    fn advance<S: Structure<R>>(
        &mut self,
        structure: &S,
        now: &State<R>,
        next: &mut State<R>,
        step: R,
    ) -> Result<Solved> {
        let settings = &self.settings;
        let [beta, gamma, alpha_m, alpha_f] = [
            settings.beta,
            settings.gamma,
            settings.alpha_m,
            settings.alpha_f,
        ]
        .map(R::lit);
        let share = R::one() / (R::one() - alpha_f);
        let square = step * step;
        // The auxiliary acceleration lags by a share of the step: another step, another lag.
        let ratio = self.step_before.map_or(R::one(), |before| step / before);
        // The guess is the motion with constant acceleration; each metre of correction then
        // changes the acceleration by 1 / (beta dt^2).
        let half = square * R::lit(0.5);
        let [a, v, u] = [&now.acceleration, &now.velocity, &now.displacement].map(|x| &x[..]);
        let guessed = [&mut next.acceleration[..], &mut next.displacement];
        match &mut self.auxiliary {
            None => Guess { step, half }.run([a, v, u], guessed),
            Some([old, new]) => {
                let guess = LaggingGuess {
                    ratio,
                    share,
                    alpha_f,
                    step,
                    half,
                };
                let [acceleration, guessed] = guessed;
                guess.run([a, v, u, &old[..]], [&mut new[..], acceleration, guessed]);
            }
        }
        // The mass term of a kept tangent belongs to one step size only.
        if self.step != Some(step) {
            self.workspace.forget();
            self.step = Some(step);
        }
        next.time = now.time + step;
        structure.impose(next.time, Rate::Displacement, &mut next.displacement)?;
        structure.impose(next.time, Rate::Acceleration, &mut next.acceleration)?;
        let rate = R::one() / (beta * square);
        let inertia = share * (R::one() - alpha_m) * rate;
        let equations = Equations {
            time: next.time,
            factor: R::one(),
            rest: Rest::Nothing,
            inertia: Some((inertia, &next.acceleration)),
        };
        let u = &mut next.displacement;
        let solved = self
            .workspace
            .solve(structure, &settings.newton, &equations, u)?;
        let known = [self.workspace.moved(), v];
        let following = [&mut next.acceleration[..], &mut next.velocity];
        match &mut self.auxiliary {
            None => Follow { rate, step, gamma }.run(known, following),
            Some([_, new]) => {
                let follow = LaggingFollow {
                    rate,
                    inertia,
                    step,
                    gamma,
                };
                let [acceleration, velocity] = following;
                follow.run(known, [&mut new[..], acceleration, velocity]);
            }
        }
        structure.impose(next.time, Rate::Velocity, &mut next.velocity)?;
        self.workspace.settle(structure, next)?;
        let ends = Sample::ends(now, next);
        next.work = now.work + self.workspace.work(structure, &ends, now, next)?;
        Ok(solved)
    }

    fn error<S: Structure<R>>(&mut self, structure: &S, now: &State<R>, next: &State<R>) -> (R, R) {
        let Some(step) = self.step else {
            return (R::zero(), R::zero());
        };
        self.estimating = self.settings.estimator == Estimator::LiZengWiberg;
        // The lag of the auxiliary acceleration acts like a change of beta.
        let lag = self.settings.alpha_f - self.settings.alpha_m;
        let beta = R::lit(self.settings.beta - 0.5 * lag);
        let cube = step * step * step / R::lit(24.0);
        let weight = |factor: f64| R::lit(12.0) * beta - R::lit(factor);
        mean_squares(structure, &next.displacement, |i| {
            let jerk = (next.acceleration[i] - now.acceleration[i]) / step;
            let (first, last) = match (self.settings.estimator, self.noted) {
                (Estimator::LiZengWiberg, Some(step_before)) => {
                    let jerk_before = (now.acceleration[i] - self.before[i]) / step_before;
                    let change = (jerk - jerk_before) * step / (step + step_before);
                    (jerk - change, jerk + change)
                }
                // A constant jerk turns the first formula into the second.
                _ => (jerk, jerk),
            };
            cube * (weight(3.0) * first + weight(1.0) * last)
        })
    }

    fn history(&mut self, tape: &mut Tape<R>) -> Result<()> {
        if let Some([old, _]) = &mut self.auxiliary {
            tape.numbers(old)?;
        }
        tape.option(&mut self.noted)?;
        if self.noted.is_some() {
            tape.numbers(&mut self.before)?;
        }
        tape.flag(&mut self.estimating)?;
        tape.option(&mut self.step_before)?;
        tape.option(&mut self.step)?;
        self.workspace.history(self.settings.newton.refresh, tape)
    }

    fn accept(&mut self, now: &State<R>, _next: &State<R>) {
        let estimated = std::mem::take(&mut self.estimating);
        if estimated {
            self.before.copy_from_slice(&now.acceleration);
        }
        self.noted = self.step.filter(|_| estimated);
        if let Some(auxiliary) = &mut self.auxiliary {
            auxiliary.swap(0, 1);
        }
        self.step_before = self.step;
    }
}
