//! Room for numbers that is not filled before they are written: that of lanes is kilobytes long, and to
//! fill it with zeros first would take a fifth of a force.

use std::mem::MaybeUninit;

/// The array of `f(0)`, `f(1)`, ..: `std::array::from_fn` for kernels, which must be inlined whole to
/// be compiled for the registers of lanes.
#[inline(always)]
pub(crate) fn array<T: Copy, const N: usize>(mut f: impl FnMut(usize) -> T) -> [T; N] {
    let mut all = [const { MaybeUninit::uninit() }; N];
    each!(i in 0..N, { all[i] = MaybeUninit::new(f(i)) });
    // SAFETY: all of them have been written, and an array of these is laid out as one of their values.
    unsafe { all.as_ptr().cast::<[T; N]>().read() }
}

/// Room for an array, which is written before it is read.
#[derive(Debug)]
pub struct Room<A>(MaybeUninit<A>);

impl<A> Room<A> {
    /// An empty one.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self(MaybeUninit::uninit())
    }
}

impl<T: Copy, const N: usize> Room<[T; N]> {
    /// Makes it an array of what is put on a stack, in place: to hand arrays of lanes on is to copy them.
    ///
    /// # Panics
    /// If fewer are put there, or more.
    #[inline(always)]
    pub(crate) fn fill(&mut self, put: impl FnOnce(&mut Stack<'_, T>)) -> &mut [T; N] {
        let first = self.0.as_mut_ptr().cast();
        let mut stack = Stack {
            // SAFETY: so long is the array, which is borrowed alone, and nothing is said of what is in it.
            room: unsafe { std::slice::from_raw_parts_mut(first, N) },
            count: 0,
        };
        put(&mut stack);
        // Of what the stack holds, for `put` may have made it another.
        let Stack { room, count } = stack;
        assert!(count == N && room.len() >= N, "a full array");
        // SAFETY: so many have been written.
        unsafe { &mut *room.as_mut_ptr().cast() }
    }
}

/// Two numbers for each pair of `S` vectors, and one more.
#[derive(Debug)]
#[repr(C)]
pub struct Pairs<T, const S: usize>([[T; S]; S], [T; S], T);

impl<T: Copy, const S: usize> Room<Pairs<T, S>> {
    /// A stack in this room.
    #[inline(always)]
    pub(crate) fn stack(&mut self) -> Stack<'_, T> {
        let first = self.0.as_mut_ptr().cast();
        Stack {
            // SAFETY: so many numbers follow each other without gaps, they are borrowed alone, and nothing is
            // said of what is in them.
            room: unsafe { std::slice::from_raw_parts_mut(first, S * (S + 1) + 1) },
            count: 0,
        }
    }
}

/// Numbers put one after the other. How many is not kept where they are, or it would be read again
/// after each.
#[derive(Debug)]
pub struct Stack<'r, T> {
    room: &'r mut [MaybeUninit<T>],
    count: usize,
}

impl<T: Copy> Stack<'_, T> {
    /// Puts some numbers on top.
    ///
    /// # Panics
    /// If there is no more room.
    #[inline(always)]
    pub(crate) fn push<const N: usize>(&mut self, numbers: [T; N]) {
        let room = &mut self.room[self.count..][..N];
        for n in 0..N {
            room[n].write(numbers[n]);
        }
        self.count += N;
    }

    /// Puts what `f` makes of some things on top.
    ///
    /// # Panics
    /// If there is no more room.
    #[inline(always)]
    pub(crate) fn push_each<P>(&mut self, things: &[P], mut f: impl FnMut(&P) -> T) {
        let room = &mut self.room[self.count..][..things.len()];
        for (room, thing) in room.iter_mut().zip(things) {
            room.write(f(thing));
        }
        self.count += things.len();
    }

    /// All that was put on it.
    #[inline(always)]
    pub(crate) fn numbers(&self) -> &[T] {
        let all = &self.room[..self.count];
        // SAFETY: so many have been written.
        unsafe { std::slice::from_raw_parts(all.as_ptr().cast(), all.len()) }
    }

    /// The same, to change.
    #[inline(always)]
    pub(crate) fn numbers_mut(&mut self) -> &mut [T] {
        let all = &mut self.room[..self.count];
        // SAFETY: so many have been written.
        unsafe { std::slice::from_raw_parts_mut(all.as_mut_ptr().cast(), all.len()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_holds_what_was_put_on_it_and_no_more() {
        let mut room = Room::<Pairs<u64, 2>>::new();
        let mut stack = room.stack();
        assert!(stack.numbers().is_empty());
        stack.push([1, 2]);
        stack.push_each(&[10, 20, 30], |x| x + 1);
        stack.numbers_mut()[0] = 7;
        assert_eq!(stack.numbers(), [7, 2, 11, 21, 31]);
        stack.push([5; 2]);
        assert_eq!(stack.numbers().len(), 2 * 3 + 1);
        let more = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| stack.push([9])));
        assert!(more.is_err());
        let more = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            stack.push_each(&[9], |x| *x);
        }));
        assert!(more.is_err());
        assert_eq!(stack.numbers(), [7, 2, 11, 21, 31, 5, 5]);
    }

    /// What `f` leaves unfinished is not read.
    #[test]
    fn what_panics_half_way_is_not_there() {
        let mut room = Room::<Pairs<u64, 1>>::new();
        let mut stack = room.stack();
        let panics = |x: &u64| if *x == 2 { panic!("{x}") } else { *x };
        let half = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            stack.push_each(&[1, 2, 3], panics);
        }));
        assert!(half.is_err() && stack.numbers().is_empty());
    }

    #[test]
    fn an_array_is_filled_whole() {
        let mut room = Room::<[u64; 3]>::new();
        let less = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            room.fill(|stack| stack.push([1, 2]));
        }));
        assert!(less.is_err());
        assert_eq!(room.fill(|stack| stack.push([1, 2, 3])), &[1, 2, 3]);
        let other = Box::leak(Box::new(Room::<Pairs<u64, 1>>::new()));
        let swapped = room.fill(|stack| {
            *stack = other.stack();
            stack.push([4, 5, 6]);
        });
        assert_eq!(swapped, &[4, 5, 6]);
    }
}
