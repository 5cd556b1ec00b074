//! Which registers work in lanes is done in: the widest that the processor has, found while running, so
//! that one build serves every processor. Fewer can be asked for, to measure and to test what older
//! processors do.

use std::sync::atomic::{AtomicU8, Ordering};

/// Registers that a processor has lanes in, by their width.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Registers {
    /// What every processor of the architecture has. On x86-64 one number at a time is worked on, without
    /// fused multiply-add.
    Baseline,
    /// AVX2 with fused multiply-add, those of x86-64-v3: four lanes of `f64`, eight of `f32`.
    Avx2,
    /// AVX-512: twice as many.
    Avx512,
}

/// The widest that may be used.
static LIMIT: AtomicU8 = AtomicU8::new(Registers::Avx512 as u8);

impl Registers {
    /// The widest registers of this processor within the [limit](Self::limit).
    ///
    /// ```
    /// use ancf::scalar::Registers;
    /// println!("lanes are those of {:?}", Registers::widest());
    /// ```
    #[inline]
    #[must_use]
    pub fn widest() -> Self {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            let limit = LIMIT.load(Ordering::Relaxed);
            if limit >= Self::Avx512 as u8 && is_x86_feature_detected!("avx512f") {
                return Self::Avx512;
            }
            if limit >= Self::Avx2 as u8 {
                return Self::Avx2;
            }
        }
        Self::Baseline
    }

    /// Has this process use no wider registers than these from now on, wherever it computes. Results of
    /// [`Avx2`](Self::Avx2) and [`Avx512`](Self::Avx512) are the same to the last bit; those of
    /// [`Baseline`](Self::Baseline) differ by rounding, for it has no fused multiply-add.
    pub fn limit(self) {
        LIMIT.store(self as u8, Ordering::Relaxed);
    }
}
