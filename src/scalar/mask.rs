//! Answers that simultaneous computations give: a statement about a pack holds in some of its lanes
//! and not in others. Solvers either keep such an answer lane by lane, or take it as one; and where
//! it is not one, the common run is void and every computation must go its own way.

use std::cell::Cell;
use std::ops::{BitAnd, BitOr, BitOrAssign, Not};

/// Where a statement holds: in which of the computations that a [`Real`](super::Real) carries. For
/// types that carry one it is all or nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mask(u32);

impl Mask {
    /// Holds everywhere.
    pub const ALL: Self = Self(u32::MAX);
    /// Holds nowhere.
    pub const NONE: Self = Self(0);

    /// The answers of `N` lanes, a divisor of 32. Bits beyond them repeat, so that all of them are
    /// set when all lanes agree.
    #[inline(always)]
    pub(super) fn of<const N: usize>(holds: impl Fn(usize) -> bool) -> Self {
        const { assert!(N > 0 && 32 % N == 0) };
        let mut bits = 0;
        for lane in 0..N {
            bits |= u32::from(holds(lane)) << lane;
        }
        let mut width = N;
        while width < 32 {
            bits |= bits << width;
            width *= 2;
        }
        Self(bits)
    }

    /// Answers that are the same in all lanes, or not.
    pub(crate) fn among(same: bool) -> Self {
        Self(if same { u32::MAX } else { 1 })
    }

    /// Whether the statement holds in the given lane.
    #[inline(always)]
    pub(super) fn lane(self, lane: usize) -> bool {
        self.0 >> lane & 1 == 1
    }

    /// Whether it holds in every lane.
    #[inline(always)]
    #[must_use]
    pub fn all(self) -> bool {
        self == Self::ALL
    }

    /// Whether it holds in any lane.
    #[inline(always)]
    #[must_use]
    pub fn any(self) -> bool {
        self != Self::NONE
    }

    /// The one answer of all lanes. Where they differ it is `false`, and the run is
    /// [void](together).
    #[inline(always)]
    #[must_use]
    pub fn common(self) -> bool {
        if self.any() && !self.all() {
            part();
        }
        self.all()
    }
}

impl From<bool> for Mask {
    #[inline(always)]
    fn from(holds: bool) -> Self {
        if holds { Self::ALL } else { Self::NONE }
    }
}
impl BitAnd for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}
impl BitOr for Mask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}
impl BitOrAssign for Mask {
    #[inline(always)]
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}
impl Not for Mask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

thread_local! {
    static PARTED: Cell<bool> = const { Cell::new(false) };
}

#[cold]
fn part() {
    PARTED.set(true);
}

/// Whether lanes have parted on this thread, in the work that [`together`] does.
#[inline]
pub(super) fn parted() -> bool {
    PARTED.get()
}

/// Does work in [`Pack`](super::Pack)s, and gives its result if all lanes went the same way: every
/// comparison of packs had one answer, and so every lane's result is, to the last bit, what the work
/// would have given in the plain number type. `None` if the lanes would have parted; then do
/// the work in the plain type, lane by lane. From there on no pack is
/// [finite](super::Real::finite), so that solvers end soon.
///
/// The work must stay on this thread.
///
/// ```
/// use ancf::scalar::{Laned, Pack, Real, together};
///
/// fn larger_root<R: Real>(b: R) -> R {
///     if b > R::zero() { b } else { -b }
/// }
/// let pack = |from: f64| Pack(std::array::from_fn(|lane| from + lane as f64));
/// let root = together(|| larger_root(pack(1.0)));
/// assert_eq!(root.map(|root| f64::unpack(root, 7)), Some(8.0));
/// assert!(together(|| larger_root(pack(-4.0))).is_none());
/// ```
pub fn together<T>(work: impl FnOnce() -> T) -> Option<T> {
    let outer = PARTED.replace(false);
    let result = work();
    let parted = PARTED.replace(outer);
    (!parted).then_some(result)
}
