//! Which registers work in lanes is done in: the widest that the processor has, found while running, so
//! that one build serves every processor. They can be limited, to measure and to test what older
//! processors do.

use std::sync::atomic::{AtomicU8, Ordering};

/// Registers of x86-64 that numbers are worked on in, with the instructions that come with them.
///
/// On other architectures there is one kind, which counts as [`Baseline`](Self::Baseline): the registers
/// that a build is compiled for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Registers {
    /// What every processor has: one number at a time, without fused multiply-add.
    Baseline,
    /// AVX2 with fused multiply-add, those of x86-64-v3, which hold four numbers in `f64` and eight in `f32`;
    /// forces of continua of constant elasticity go through two at once.
    Avx2,
    /// AVX-512, which hold twice as many. Work on far more numbers than registers hold, tangents and
    /// factorisation, gains nothing by them and keeps to AVX2, but for packs.
    Avx512,
}

/// The widest that may be used.
static LIMIT: AtomicU8 = AtomicU8::new(Registers::Avx512 as u8);

impl Registers {
    /// The widest registers of this processor within the [limit](Self::limit).
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

    /// All that may be used, from the narrowest to the [widest](Self::widest).
    ///
    /// ```
    /// use ancf::scalar::Registers;
    ///
    /// for registers in Registers::available() {
    ///     Registers::limit(registers);
    ///     assert_eq!(Registers::widest(), registers);
    /// }
    /// ```
    pub fn available() -> impl Iterator<Item = Self> {
        let widest = Self::widest();
        let all = [Self::Baseline, Self::Avx2, Self::Avx512];
        all.into_iter().filter(move |one| *one <= widest)
    }

    /// Has this process use none wider from now on, on all its threads: set it between runs, not in one.
    /// Results of [`Avx2`](Self::Avx2) and [`Avx512`](Self::Avx512) are the same to the last bit; those of
    /// [`Baseline`](Self::Baseline) differ by rounding, for nothing is fused there.
    pub fn limit(widest: Self) {
        LIMIT.store(widest as u8, Ordering::Relaxed);
    }
}
