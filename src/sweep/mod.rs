//! Ensembles: one [`Experiment`] run for many rows of parameters, by lanes, threads and shards. A
//! row's result is that of its own run to the last bit, whatever it shares a register, a thread or
//! a process with; what cannot go in lanes goes alone, and an error stays with its row.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::{Error, Result};
use crate::scalar::{Algebra, Laned, Real, together};

mod table;

pub use table::merge;

/// A model and what is asked of it, as a function of `P` parameters in any real number type: run in
/// plain numbers it gives results, in [`Pack`](crate::scalar::Pack)s those of several rows, in dual
/// numbers [`derivatives`].
///
/// ```
/// use ancf::prelude::*;
/// use ancf::sweep::{Experiment, Sweep, derivatives};
///
/// /// Deflection (m) of a cantilever for a Young's modulus (Pa) and a load (N).
/// struct Cantilever;
///
/// impl Experiment<2> for Cantilever {
///     fn run<R: Real>(&self, [young, load]: [R; 2]) -> Result<Vec<R>> {
///         let steel = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
///         let section = Disk::new(R::lit(0.01))?;
///         let mut scene = Scene::<R, 3>::new();
///         let rod = Beam::new(FullyParameterised, section, Continuum::selective_reduced(steel))
///             .straight([R::zero(); 3], [R::one(), R::zero(), R::zero()], 2);
///         let rod = scene.add(rod)?;
///         scene.clamp(rod.start())?;
///         scene.force(rod.end(), [R::zero(), -load, R::zero()])?;
///         let system = scene.assemble()?;
///         let mut state = system.rest();
///         Statics::default().solve(&system, &mut state)?;
///         let [_, y, _] = system.position(&state, rod.end())?;
///         Ok(vec![-y])
///     }
/// }
///
/// let sweep = Sweep::grid([&[1.0e11, 2.0e11], &[10.0, 20.0, 30.0, -1.0]])?.in_lanes();
/// let results = sweep.run(&Cantilever);
/// assert_eq!(results.rows()[1].parameters, [1.0e11, 20.0]);
/// let down = |row: usize| results.rows()[row].outputs.clone().map(|y| y[0]);
/// assert_eq!(down(1)?, Cantilever.run([1.0e11, 20.0])?[0]);
/// assert!(down(3)? < 0.0);
///
/// // Under small loads the deflection is proportional to the load.
/// let [(y, [_, slope])] = derivatives(&Cantilever, [1.0e11, 0.2])?[..] else { panic!() };
/// assert!((slope - y / 0.2).abs() < 1e-5 * slope);
/// # Ok::<(), ancf::Error>(())
/// ```
pub trait Experiment<const P: usize>: Sync {
    /// Runs the model for one row; as many outputs for every row.
    ///
    /// # Errors
    /// Those of the model.
    fn run<R: Real>(&self, parameters: [R; P]) -> Result<Vec<R>>;
}

/// The outputs of an experiment, each with its derivatives by the parameters, exact.
///
/// # Errors
/// Those of the experiment.
pub fn derivatives<const P: usize>(
    experiment: &impl Experiment<P>,
    parameters: [f64; P],
) -> Result<Vec<(f64, [f64; P])>> {
    let unknown = |k: usize| parameters[k].variable::<P>(k);
    let outputs = experiment.run(std::array::from_fn(unknown))?;
    let with_slopes = |y: &_| {
        let slope = |k| f64::derivative::<P>(y, k);
        (f64::real_part::<P>(y), std::array::from_fn(slope))
    };
    Ok(outputs.iter().map(with_slopes).collect())
}

/// Rows of parameters to run an [`Experiment`] for, and how.
#[derive(Debug, Clone)]
pub struct Sweep<R, const P: usize> {
    parameters: Vec<[R; P]>,
    shard: Range<usize>,
    lanes: bool,
    threads: usize,
}

/// One row of a sweep.
#[derive(Debug, Clone)]
pub struct Row<R, const P: usize> {
    /// Its number in the whole sweep, from zero.
    pub index: usize,
    /// What it was run for.
    pub parameters: [R; P],
    /// What came out, or why nothing did.
    pub outputs: Result<Vec<R>>,
}

/// The rows of a sweep, or of one of its shards, in order.
#[derive(Debug, Clone)]
pub struct Results<R, const P: usize> {
    rows: Vec<Row<R, P>>,
    /// Rows of the whole sweep.
    total: usize,
    /// Of all parameters of the whole sweep.
    fingerprint: u64,
}

impl<R: Laned, const P: usize> Sweep<R, P> {
    /// A sweep over the rows given, one by one on this thread.
    ///
    /// # Errors
    /// [`Error::TooFew`] without rows.
    pub fn list(parameters: Vec<[R; P]>) -> Result<Self> {
        if parameters.is_empty() {
            return Err(Error::TooFew {
                what: "number of rows of a sweep",
                value: 0,
                least: 1,
                remedy: "give every parameter at least one value",
            });
        }
        Ok(Self {
            shard: 0..parameters.len(),
            parameters,
            lanes: false,
            threads: 1,
        })
    }

    /// A sweep over all combinations of the values given for each parameter, the last parameter
    /// changing first.
    ///
    /// # Errors
    /// [`Error::TooFew`] when a parameter has no value.
    pub fn grid(values: [&[R]; P]) -> Result<Self> {
        let total: usize = values.iter().map(|values| values.len()).product();
        let row = |mut index: usize| {
            let mut row = [R::zero(); P];
            for k in (0..P).rev() {
                row[k] = values[k][index % values[k].len()];
                index /= values[k].len();
            }
            row
        };
        Self::list((0..total).map(row).collect())
    }

    /// Runs as many rows at once as the widest registers hold numbers. That pays where they take
    /// the same way: scenes of one topology with fixed steps, whose tangents are renewed in every
    /// iteration or in every solve ([`Refresh`](crate::solver::Refresh)). Rows that part (adaptive
    /// steps, events, tangents renewed when slow, other pivots, a row that fails) are run alone, with
    /// the same result.
    #[must_use]
    pub fn in_lanes(mut self) -> Self {
        self.lanes = true;
        self
    }

    /// Runs on a number of threads. Their number and timing change no result.
    ///
    /// # Errors
    /// [`Error::TooFew`] for none.
    pub fn on_threads(mut self, threads: usize) -> Result<Self> {
        if threads == 0 {
            return Err(Error::TooFew {
                what: "number of threads of a sweep",
                value: 0,
                least: 1,
                remedy: "use at least one thread",
            });
        }
        self.threads = threads;
        Ok(self)
    }

    /// Keeps shard `index` of `count`, from zero: rows that follow each other, as many in every
    /// shard up to one. All shards together are the sweep, see [`merge`].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless `index < count`.
    pub fn shard(mut self, index: usize, count: usize) -> Result<Self> {
        if index >= count {
            return Err(Error::OutOfRange {
                what: "index of a shard",
                value: index as f64,
                range: "0 to the number of shards less one",
                remedy: "count shards from zero, as in --shard 0/4 .. --shard 3/4",
            });
        }
        let start = |index: usize| index * self.parameters.len() / count;
        self.shard = start(index)..start(index + 1);
        Ok(self)
    }

    /// Runs the experiment for every row.
    pub fn run(&self, experiment: &impl Experiment<P>) -> Results<R, P> {
        let width = if self.lanes { R::Pack::LANES } else { 1 };
        let groups: Vec<_> = self.shard.clone().step_by(width).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            let mut done = Vec::new();
            while let Some(&first) = groups.get(next.fetch_add(1, Ordering::Relaxed)) {
                let rows = first..self.shard.end.min(first + width);
                let outputs = group(experiment, &self.parameters[rows.clone()]);
                done.extend(rows.zip(outputs).map(|(index, outputs)| Row {
                    index,
                    parameters: self.parameters[index],
                    outputs,
                }));
            }
            done
        };
        let mut rows = std::thread::scope(|scope| {
            let others: Vec<_> = (1..self.threads.min(groups.len()))
                .map(|_| scope.spawn(work))
                .collect();
            let mut rows = work();
            for other in others {
                match other.join() {
                    Ok(done) => rows.extend(done),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            rows
        });
        rows.sort_by_key(|row| row.index);
        Results {
            rows,
            total: self.parameters.len(),
            fingerprint: table::fingerprint(self.parameters.as_flattened()),
        }
    }
}

/// The outputs of rows that fit into the lanes of a pack, or of one row.
fn group<R: Laned, const P: usize>(
    experiment: &impl Experiment<P>,
    rows: &[[R; P]],
) -> Vec<Result<Vec<R>>> {
    if rows.len() > 1 {
        // Lanes left over do what the last one does.
        let row = |lane: usize| &rows[lane.min(rows.len() - 1)];
        let packed = std::array::from_fn(|k| R::pack(|lane| row(lane)[k]));
        if let Some(Ok(outputs)) = together(|| experiment.run::<R::Pack>(packed)) {
            let lane = |lane: usize| outputs.iter().map(|y| R::unpack(*y, lane)).collect();
            return (0..rows.len()).map(|n| Ok(lane(n))).collect();
        }
    }
    rows.iter().map(|row| experiment.run(*row)).collect()
}

impl<R, const P: usize> Results<R, P> {
    /// The rows in the order of the sweep.
    pub fn rows(&self) -> &[Row<R, P>] {
        &self.rows
    }
}
