//! Runs a problem over meshes and methods, and keeps what each run cost and missed. A run that fails
//! is left out with a line that says why.

use ancf::prelude::*;

use crate::measure::{Integrator, Method, Record, Watch, timed};

/// Name of a number type in tables.
fn number<R: Real>() -> &'static str {
    if R::EPSILON > 1e-8 { "f32" } else { "f64" }
}

/// Name of a model in tables and legends.
fn label<R: Real, const D: usize>(family: &str) -> String {
    let room = if D == 2 { "plane" } else { "space" };
    format!("{family}, {room}, {}", number::<R>())
}

/// A problem with the table of its runs.
#[derive(Debug)]
pub struct Study {
    /// Its name.
    pub problem: &'static str,
    /// Its runs.
    pub records: Vec<Record>,
    /// Leave out what is slow.
    pub quick: bool,
}

impl Study {
    /// A study without runs.
    pub fn new(problem: &'static str, quick: bool) -> Self {
        Self {
            problem,
            records: Vec::new(),
            quick,
        }
    }

    /// Runs every mesh with every method. `build` assembles the problem with a number of elements.
    ///
    /// # Errors
    /// When a system cannot be assembled.
    pub fn sweep<R: Real, const D: usize>(
        &mut self,
        family: &str,
        meshes: &[usize],
        methods: &[Method],
        build: impl Fn(usize) -> Result<(System<R, D>, Watch)>,
    ) -> Result<()> {
        let skipped = if self.quick { 2 } else { 0 };
        let kept = meshes.len().saturating_sub(skipped);
        for &elements in meshes.iter().take(kept) {
            let (system, watch) = build(elements)?;
            for method in methods {
                self.time::<R, D>((family, elements), &system, &watch, None, method);
            }
        }
        Ok(())
    }

    /// Runs methods on one mesh, whose converged solution tells their own error from the mesh's.
    ///
    /// # Errors
    /// When the converged solution cannot be found.
    pub fn integrators<R: Real, const D: usize>(
        &mut self,
        (family, elements): (&str, usize),
        step: f64,
        methods: &[Method],
        (system, watch): &(System<R, D>, Watch),
    ) -> Result<()> {
        let fine = Method::fixed(Integrator::Gauss(3), step);
        let own = watch.against(watch.follow(system, &fine)?.0);
        for method in methods {
            self.time((family, elements), system, watch, Some(&own), method);
        }
        Ok(())
    }

    /// Solves statics in several numbers of load steps, with the tangent renewed in every iteration
    /// and when it is slow. `limit` is where the tip should be (m), and how far from where it was.
    pub fn statics<R: Real, const D: usize>(
        &mut self,
        family: &str,
        elements: usize,
        system: &System<R, D>,
        tip: Node,
        (limit, travel): (&[f64], f64),
    ) {
        for steps in [1, 2, 4, 10, 20] {
            for refresh in [Refresh::EveryIteration, Refresh::WhenSlow] {
                let mut statics = Statics::in_steps(steps);
                // Steps that need halving are another number of steps.
                statics.cutbacks = 0;
                statics.newton.refresh = refresh;
                let solved = timed(|| {
                    let mut state = system.rest();
                    let report = statics.solve(system, &mut state)?;
                    Ok((system.position(&state, tip)?, report))
                });
                let Ok((seconds, (tip, report))) = solved else {
                    continue;
                };
                let parts = limit
                    .iter()
                    .zip(tip)
                    .map(|(to, at)| (at.value() - to).powi(2));
                self.records.push(Record {
                    problem: self.problem,
                    model: label::<R, D>(family),
                    elements,
                    method: match refresh {
                        Refresh::EveryIteration => "full Newton".into(),
                        _ => "tangent when slow".into(),
                    },
                    setting: format!("{steps} load steps"),
                    seconds,
                    error: parts.sum::<f64>().sqrt() / travel,
                    own_error: None,
                    order: 0,
                    step: 0.0,
                    steps: report.steps,
                    iterations: report.iterations,
                });
            }
        }
    }

    fn time<R: Real, const D: usize>(
        &mut self,
        (family, elements): (&str, usize),
        system: &System<R, D>,
        watch: &Watch,
        own: Option<&Watch>,
        method: &Method,
    ) {
        let model = label::<R, D>(family);
        match timed(|| watch.follow(system, method)) {
            Ok((seconds, (found, effort))) => self.records.push(Record {
                problem: self.problem,
                model,
                elements,
                method: method.name(),
                setting: method.setting(),
                seconds,
                error: watch.error(&found),
                own_error: own.map(|own| own.error(&found)),
                order: method.integrator.order(),
                step: method.step(),
                steps: effort.steps,
                iterations: effort.iterations,
            }),
            Err(error) => eprintln!(
                "{}: {model}, {elements} elements, {}, {}: {error}",
                self.problem,
                method.name(),
                method.setting()
            ),
        }
    }
}

/// Steps of a problem: `base` (s) divided by powers of two.
pub fn steps(base: f64, halvings: std::ops::RangeInclusive<i32>) -> Vec<f64> {
    halvings.map(|k| base * 0.5_f64.powi(k)).collect()
}

/// The methods whose best is a model's: second order at fixed and at controlled steps, collocation.
pub fn usual(base: f64) -> Vec<Method> {
    let mut methods = Vec::new();
    for step in steps(base, 0..=5) {
        methods.push(Method::fixed(Integrator::Trapezoidal, step));
    }
    methods.extend(collocation(&steps(2.0 * base, 0..=4)));
    for tolerance in [1e-3, 1e-4, 1e-5] {
        methods.push(Method::adaptive(Integrator::Trapezoidal, tolerance));
    }
    methods
}

/// Collocation at fixed steps: of fourth order, symplectic, and of fifth, which damps what is too fast.
pub fn collocation(steps: &[f64]) -> Vec<Method> {
    let both = [Integrator::Gauss(2), Integrator::Radau(3)];
    let at = |step: &f64| both.map(|integrator| Method::fixed(integrator, *step));
    steps.iter().flat_map(at).collect()
}

/// The paper's methods: Newmark's at fixed steps and with its error control, full Newton.
pub fn original(base: f64) -> Vec<Method> {
    let mut methods: Vec<Method> = steps(base, 0..=5)
        .into_iter()
        .map(|step| Method::fixed(Integrator::Trapezoidal, step).full_newton())
        .collect();
    for tolerance in [1e-3, 1e-4, 1e-5] {
        methods.push(Method {
            integrator: Integrator::Trapezoidal,
            refresh: Refresh::EveryIteration,
            stepping: Stepping::Adaptive(Adaptive::to(tolerance)),
        });
    }
    methods
}

/// Every integrator at fixed steps.
pub fn all(base: f64) -> Vec<Method> {
    let mut methods = Vec::new();
    for integrator in [
        Integrator::Trapezoidal,
        Integrator::Alpha,
        Integrator::Hht,
        Integrator::Midpoint,
        Integrator::Energy,
        Integrator::Gauss(2),
        Integrator::Gauss(3),
        Integrator::Radau(2),
        Integrator::Radau(3),
    ] {
        for step in steps(base, 0..=6) {
            methods.push(Method::fixed(integrator, step));
        }
    }
    methods
}
