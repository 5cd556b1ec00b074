//! Independent cases on all cores: a shared counter hands out the next case to whichever thread
//! is free, and results come back in the order of the cases.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use indicatif::ProgressBar;

/// Runs every case and returns the results in the order of the cases. Give long cases first.
pub fn map<C: Sync, T: Send>(
    cases: &[C],
    bar: &ProgressBar,
    run: impl Fn(&C) -> T + Sync,
) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::with_capacity(cases.len()));
    let threads = std::thread::available_parallelism().map_or(2, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(cases.len()) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = cases.get(index) else { break };
                    let result = run(case);
                    results
                        .lock()
                        .expect("no case panics while it stores its result")
                        .push((index, result));
                    bar.inc(1);
                }
            });
        }
    });
    let mut results = results.into_inner().expect("all threads have ended");
    results.sort_unstable_by_key(|(index, _)| *index);
    results.into_iter().map(|(_, result)| result).collect()
}
