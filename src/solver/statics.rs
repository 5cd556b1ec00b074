//! Static equilibrium by load stepping: the out-of-balance forces of the state given are brought
//! in by steps that shrink when Newton's method fails and grow back when it does well. From a state
//! at rest this is a growing load; from any other it is the way from what the state carries to the
//! load asked for.

use super::newton::{Equations, Newton, Rest, Stability, Workspace};
use super::unknowns::Unknowns;
use super::{Rate, State, Structure};
use crate::error::{Error, Result};
use crate::scalar::Real;

/// Static solver with load stepping.
///
/// It looks for an equilibrium under the whole load, by steps as long as Newton's method bears. Such
/// a step may end on another branch than it began on, as stable as the one left, which no count of
/// unstable directions tells: a truss pushed beyond its limit is found snapped through. To be
/// told of it, follow the path: [`Continuation`](super::Continuation) takes no point that does not go
/// on from the last one, and with [`Control::Load`](super::Control::Load) it stops where `Statics`
/// would jump.
///
/// Loads with a course in time are taken at the state's time. On failure the state holds the last
/// equilibrium found, and the error says at which share of the load that was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statics {
    /// Number of equal load steps to try.
    pub steps: usize,
    /// How often a step may be halved before giving up.
    pub cutbacks: usize,
    /// Newton's method at each load level.
    pub newton: Newton,
    /// Whether to refuse a step after which the equilibrium is unstable in another number of
    /// directions than before: it has passed a limit or bifurcation point or jumped to another
    /// branch. Statics then stops before that point. Under follower loads only whether that number
    /// is even or odd is known.
    pub hold_stability: bool,
}

impl Default for Statics {
    fn default() -> Self {
        Self {
            steps: 1,
            cutbacks: 12,
            newton: Newton::default(),
            hold_stability: false,
        }
    }
}

/// What a static solution took.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StaticReport {
    /// Load levels solved.
    pub steps: usize,
    /// Steps that failed and were halved.
    pub cutbacks: usize,
    /// Newton iterations of all converged levels.
    pub iterations: usize,
    /// Residual over the force scale at the full load.
    pub residual: f64,
    /// Whether that residual is the one rounding leaves, above the tolerance asked for.
    pub at_floor: bool,
    /// What one more correction would change of the displacements, as a share of them: where
    /// [`at_floor`](Self::at_floor), an estimate of what rounding of the solution has taken, and `-log10`
    /// of it that of the digits left. Rounding of the data, and what stored coordinates round in the
    /// strains, moves the solution besides, on slender beams in single precision by ten times as much.
    pub rounding: f64,
    /// Directions in which the equilibrium is unstable: the negative eigenvalues of its tangent. 0
    /// for a stable equilibrium, `None` where the factorisation does not tell (unsymmetric
    /// tangents).
    pub unstable: Option<usize>,
}

impl Statics {
    /// The default solver with a number of load steps.
    pub fn in_steps(steps: usize) -> Self {
        Self {
            steps,
            ..Self::default()
        }
    }

    /// Finds the equilibrium under the full load, starting from the state given, whatever it
    /// carries. Accelerations become zero; velocities are left for a motion to start from.
    ///
    /// # Errors
    /// [`Error::StaticsFailed`] with the last error of Newton's method when the step has been
    /// halved [`cutbacks`](Self::cutbacks) times (a limit point, buckling, or too large a load) or
    /// with [`Error::StabilityChanged`] when that is [refused](Self::hold_stability);
    /// [`Error::NoDigits`] when rounding leaves not one digit of the displacements;
    /// [`Error::Mechanism`] for too few supports, [`Error::StiffnessLost`] for enough of them;
    /// [`Error::LoadNotFinite`]; typed errors for settings and states that do not fit.
    pub fn solve<R: Real, S: Structure<R>>(
        &self,
        structure: &S,
        state: &mut State<R>,
    ) -> Result<StaticReport> {
        self.newton.check()?;
        if self.steps == 0 {
            return Err(Error::TooFew {
                what: "number of load steps",
                value: 0,
                least: 1,
                remedy: "use at least one load step",
            });
        }
        let unknowns = structure.unknowns();
        state.check(unknowns.coordinates())?;
        let mut workspace = Workspace::new(structure);
        let mut report = StaticReport::default();
        let full = R::lit((self.steps as f64).recip());
        let smallest = full * R::lit(0.5_f64.powi(self.cutbacks as i32));
        let mut step = full;
        let mut reached = R::zero();
        let mut before: Option<(Vec<R>, R)> = None;
        let mut stability = Stability::default();
        let mut u = state.displacement.clone();
        let mut initial = vec![R::zero(); u.len()];
        structure.add_internal(&u, &mut initial);
        structure.add_holding(state.time, &u, &mut initial);
        let bound = Bound::new(structure, state)?;
        if self.hold_stability {
            let start = Equations {
                time: state.time,
                factor: R::zero(),
                rest: Rest::Start(&initial),
                inertia: None,
            };
            stability = workspace.stability(structure, &start, &u)?;
        }
        while reached < R::one() {
            let mut factor = (reached + step).smaller(R::one());
            // Do not leave a sliver for the last step.
            if R::one() - factor < full * R::lit(1e-6) {
                factor = R::one();
            }
            u.copy_from_slice(&state.displacement);
            if let Some((last, from)) = &before {
                let ratio = (factor - reached) / (reached - *from);
                for i in 0..u.len() {
                    u[i] += ratio * (state.displacement[i] - last[i]);
                }
            }
            bound.impose(unknowns, factor, &mut u);
            let equations = Equations {
                time: state.time,
                factor,
                rest: Rest::Start(&initial),
                inertia: None,
            };
            let last = factor >= R::one();
            let solved = workspace
                .solve(structure, &self.newton, &equations, &mut u)
                .and_then(|solved| {
                    if self.hold_stability || last {
                        let now = workspace.stability(structure, &equations, &u)?;
                        if let (Some([before, now]), true) =
                            (stability.differs(now), self.hold_stability)
                        {
                            return Err(Error::StabilityChanged { before, now });
                        }
                        stability = now;
                        report.unstable = now.unstable;
                    }
                    if last && workspace.factored() {
                        report.rounding = workspace.open(structure, &u)?;
                        if report.rounding > NO_DIGIT && loaded(structure, &equations, &u)? {
                            let share = report.rounding;
                            return Err(Error::NoDigits { share });
                        }
                    }
                    Ok(solved)
                });
            match solved {
                Ok(solved) => {
                    before = Some((state.displacement.clone(), reached));
                    state.displacement.copy_from_slice(&u);
                    reached = factor;
                    report.steps += 1;
                    report.iterations += solved.iterations;
                    report.residual = solved.residual;
                    report.at_floor = solved.at_floor;
                    // A full step asks nothing that lanes could differ in.
                    if step < full && solved.decide(|iterations| iterations <= 6) {
                        step = (step * R::lit(2.0)).smaller(full);
                    }
                }
                Err(error @ (Error::LoadNotFinite { .. } | Error::NoDigits { .. })) => {
                    return Err(error);
                }
                // Before any load has acted no smaller step can help.
                Err(
                    error @ (Error::Mechanism { .. }
                    | Error::StiffnessLost { .. }
                    | Error::Redundant { .. }),
                ) if report.steps == 0 => {
                    return Err(error);
                }
                Err(error) => {
                    step *= R::lit(0.5);
                    // An extrapolated guess that failed is not tried again.
                    before = None;
                    report.cutbacks += 1;
                    if step < smallest {
                        return Err(Error::StaticsFailed {
                            reached: reached.value(),
                            step: (step * R::lit(2.0)).value(),
                            cause: Box::new(error),
                        });
                    }
                }
            }
        }
        // What has come to rest has no acceleration.
        state.acceleration.fill(R::zero());
        Ok(report)
    }
}

/// Share of the displacements that rounding may take and leave a digit.
const NO_DIGIT: f64 = 0.1;

/// Whether anything acts on the unknowns; without loads displacements are rounding and may be.
fn loaded<R: Real, S: Structure<R>>(
    structure: &S,
    equations: &Equations<'_, R>,
    u: &[R],
) -> Result<bool> {
    let mut forces = vec![R::zero(); u.len()];
    structure.add_external(equations.time, R::one(), u, &mut forces)?;
    let unknowns = structure.unknowns();
    unknowns.reduce(&mut forces);
    Ok(unknowns.free().iter().any(|i| !forces[*i].is_zero()))
}

/// The coordinates that are not solved for on their way from where the state has them to where the
/// structure wants them: by how much each differs from what follows from the unknowns alone.
struct Bound<R> {
    from: Vec<R>,
    to: Vec<R>,
}

impl<R: Real> Bound<R> {
    fn new<S: Structure<R>>(structure: &S, state: &State<R>) -> Result<Self> {
        let mut from = state.displacement.clone();
        let mut to = state.displacement.clone();
        structure.impose(state.time, Rate::Displacement, &mut to)?;
        let mut following = state.displacement.clone();
        structure.unknowns().follow(&mut following);
        for (i, x) in following.into_iter().enumerate() {
            from[i] -= x;
            to[i] -= x;
        }
        Ok(Self { from, to })
    }

    /// Imposes the share `factor` of the way.
    fn impose(&self, unknowns: &Unknowns<R>, factor: R, u: &mut [R]) {
        unknowns.follow(u);
        for (u, (from, to)) in u.iter_mut().zip(self.from.iter().zip(&self.to)) {
            *u += *from + factor * (*to - *from);
        }
    }
}
