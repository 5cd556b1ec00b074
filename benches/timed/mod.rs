//! Element kernels in whatever lanes: what the benchmarks of speed and of the share of the peak time.

use std::hint::black_box;
use std::time::{Duration, Instant};

use ancf::formulation::{ElementKernel, KernelWork, Tangent};
use ancf::scalar::{Algebra, Lanes, Real};

/// Nodal displacements of a bent, sheared and stretched element.
pub fn bent<R, T: Algebra<R>, const D: usize, const S: usize>() -> [[T; D]; S] {
    std::array::from_fn(|i| std::array::from_fn(|c| T::lit(1e-2 * ((3 * i + c + 1) as f64).sin())))
}

/// Evaluates the force of a group of elements, one in each lane, or as assembly asks for it their
/// `TANGENT`, a number of times; says how many and how long.
pub struct Timed<const TANGENT: bool> {
    /// How often.
    pub times: u64,
}

impl<R: Real, const TANGENT: bool, const D: usize, const S: usize> KernelWork<R, D, S>
    for Timed<TANGENT>
{
    type Output = (usize, Duration);

    // As in chains.
    const HEAVY: bool = TANGENT;

    #[inline(always)]
    fn run<L: Lanes<R>, K: ElementKernel<R, D, S>>(self, kernel: &K) -> (usize, Duration) {
        let u: [[L; D]; S] = bent::<R, L, D, S>();
        let mut k: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
        let start = Instant::now();
        for _ in 0..self.times {
            let mut q = [[L::zero(); D]; S];
            if TANGENT {
                kernel.upper_tangent(black_box(&u), &mut k);
            } else {
                kernel.force(black_box(&u), &mut q);
            }
            black_box((&q, &k));
        }
        (L::WIDTH, start.elapsed())
    }
}

/// The same one element at a time.
pub fn alone<R, K, const TANGENT: bool, const D: usize, const S: usize>(
    kernel: &K,
    times: u64,
) -> (usize, Duration)
where
    R: Real,
    K: ElementKernel<R, D, S>,
{
    let work = Timed::<TANGENT> { times };
    KernelWork::<R, D, S>::run::<R, K>(work, kernel)
}
