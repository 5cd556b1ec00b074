//! Element kernels in whatever lanes: what the benchmarks of speed and of the share of the peak time.

use std::hint::black_box;
use std::time::{Duration, Instant};

use ancf::formulation::{ElementKernel, Tangent};
use ancf::scalar::{Algebra, LaneWork, Lanes, Real};

/// Nodal displacements of a bent, sheared and stretched element.
pub fn bent<R, T: Algebra<R>, const D: usize, const S: usize>() -> [[T; D]; S] {
    std::array::from_fn(|i| std::array::from_fn(|c| T::lit(1e-2 * ((3 * i + c + 1) as f64).sin())))
}

/// Evaluates the force of a group of elements, one in each lane, or as assembly asks for it their
/// `TANGENT`, a number of times; says how many and how long. `HEAVY` work keeps to AVX2; of chains,
/// tangents are.
pub struct Timed<'a, Kn, const TANGENT: bool, const HEAVY: bool, const D: usize, const S: usize> {
    /// The kernel.
    pub kernel: &'a Kn,
    /// How often.
    pub times: u64,
}

impl<R, Kn, const TANGENT: bool, const HEAVY: bool, const D: usize, const S: usize> LaneWork<R>
    for Timed<'_, Kn, TANGENT, HEAVY, D, S>
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    type Output = (usize, Duration);

    const HEAVY: bool = HEAVY;

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> (usize, Duration) {
        let u: [[L; D]; S] = bent::<R, L, D, S>();
        let mut k: Tangent<L, D, S> = [[[[L::zero(); D]; S]; D]; S];
        let start = Instant::now();
        for _ in 0..self.times {
            let mut q = [[L::zero(); D]; S];
            if TANGENT {
                self.kernel.upper_tangent(black_box(&u), &mut k);
            } else {
                self.kernel.force(black_box(&u), &mut q);
            }
            black_box((&q, &k));
        }
        (L::WIDTH, start.elapsed())
    }
}
