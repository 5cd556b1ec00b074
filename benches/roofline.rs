//! How close the kernels come to what the processor can do: `cargo bench --bench roofline`. A number
//! type that counts its operations runs through every kernel and gives its flops; loops of fused
//! multiply-adds in the same lanes, in the same run, give the peak. Kernels of one element stay in
//! the first cache, so that arithmetic is all that bounds them; what bounds long chains, whose factors
//! do not, is how fast memory is read and written.

use std::cell::Cell;
use std::hint::black_box;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use std::time::{Duration, Instant};

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::scalar::{Jet, LaneWork, Lanes};
use ancf::verify::ByPoints;
use num_traits::{One, Zero};
use timed::{Timed, bent};

mod timed;

/// Operations so far on this thread.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    sums: u64,
    products: u64,
    fused: u64,
    quotients: u64,
    functions: u64,
}

impl Count {
    fn flops(self) -> u64 {
        self.sums + self.products + 2 * self.fused + self.quotients + self.functions
    }
}

thread_local! {
    static COUNT: Cell<Count> = const {
        Cell::new(Count { sums: 0, products: 0, fused: 0, quotients: 0, functions: 0 })
    };
}

fn count(one: impl FnOnce(&mut Count)) {
    let mut count = COUNT.get();
    one(&mut count);
    COUNT.set(count);
}

/// A number that counts what is done with it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Counted(f64);

macro_rules! operator {
    ($($trait:ident $method:ident $assign:ident $assign_method:ident $op:tt $field:ident;)*) => {$(
        #[allow(clippy::suspicious_arithmetic_impl, reason = "the sum is the count's")]
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                count(|c| c.$field += 1);
                Self(self.0 $op other.0)
            }
        }
        impl $assign for Counted {
            fn $assign_method(&mut self, other: Self) {
                *self = $trait::$method(*self, other);
            }
        }
    )*};
}
operator! {
    Add add AddAssign add_assign + sums;
    Sub sub SubAssign sub_assign - sums;
    Mul mul MulAssign mul_assign * products;
    Div div DivAssign div_assign / quotients;
}

impl Neg for Counted {
    type Output = Self;
    // A flipped bit, which compilers fold into the next operation.
    fn neg(self) -> Self {
        Self(-self.0)
    }
}
impl Zero for Counted {
    fn zero() -> Self {
        Self(0.0)
    }
    fn is_zero(&self) -> bool {
        self.0 == 0.0
    }
}
impl One for Counted {
    fn one() -> Self {
        Self(1.0)
    }
}
impl Scalar for Counted {
    fn lit(x: f64) -> Self {
        Self(x)
    }
    fn plus_product(self, a: Self, b: Self) -> Self {
        count(|c| c.fused += 1);
        Self(a.0.mul_add(b.0, self.0))
    }
}

fn function(value: f64) -> Counted {
    count(|c| c.functions += 1);
    Counted(value)
}

macro_rules! counted {
    ($($function:ident)*) => {$(
        fn $function(self) -> Self {
            function(self.0.$function())
        }
    )*};
}
impl Field for Counted {
    fn sqrt(self) -> Self {
        function(self.0.sqrt())
    }
    fn recip(self) -> Self {
        Self(1.0) / self
    }
    counted!(exp exp_m1 ln ln_1p sin cos asin acos atan sinh cosh tanh);
    fn frozen(self) -> Self {
        self
    }
}
impl Algebra<f64> for Counted {
    type Dual<const N: usize> = Jet<Self, N>;
    fn lift(r: f64) -> Self {
        Self(r)
    }
    fn times(self, r: f64) -> Self {
        self * Self(r)
    }
    fn plus_times(self, r: f64, a: Self) -> Self {
        self.plus_product(a, Self(r))
    }
    fn constant<const N: usize>(self) -> Jet<Self, N> {
        let eps = [Self(0.0); N];
        Jet { re: self, eps }
    }
    fn variable<const N: usize>(self, k: usize) -> Jet<Self, N> {
        let mut jet: Jet<Self, N> = self.constant();
        jet.eps[k] = Self(1.0);
        jet
    }
    fn real_part<const N: usize>(dual: &Jet<Self, N>) -> Self {
        dual.re
    }
    fn derivative<const N: usize>(dual: &Jet<Self, N>, k: usize) -> Self {
        dual.eps[k]
    }
}

/// Chains of fused multiply-adds that wait for nothing but themselves.
struct Peak {
    times: u64,
}

impl<R: Real> LaneWork<R> for Peak {
    type Output = (usize, Duration);

    #[inline(always)]
    fn run<L: Lanes<R>>(self) -> (usize, Duration) {
        const CHAINS: usize = 12;
        let (a, b) = black_box((L::lit(1.0 + 1e-7), L::lit(1e-7)));
        let mut sums = [L::zero(); CHAINS];
        let start = Instant::now();
        for _ in 0..self.times {
            for sum in &mut sums {
                *sum = sum.plus_product(a, b);
            }
        }
        let spent = start.elapsed();
        black_box(&sums);
        (CHAINS * L::WIDTH, spent)
    }
}

/// Shortest time (ns) of one repetition over many tries, each far shorter than the turns that others
/// on the machine take, and what is done in it.
fn best(run: impl Fn(u64) -> (usize, Duration)) -> (f64, usize) {
    let (mut best, mut many) = (f64::INFINITY, 1);
    let mut times = 1;
    let start = Instant::now();
    for _ in 0..1000 {
        let (size, spent) = run(times);
        let nanoseconds = spent.as_secs_f64() * 1e9 / times as f64;
        (best, many) = (best.min(nanoseconds), size);
        times = (1e5 / best).clamp(1.0, 1e6) as u64;
        if start.elapsed() > Duration::from_secs(2) {
            break;
        }
    }
    (best, many)
}

/// Flops of a kernel on one element.
fn flops<Kn, const D: usize, const S: usize>(kernel: &Kn, tangent: bool) -> Count
where
    Kn: ElementKernel<f64, D, S>,
{
    let u: [[Counted; D]; S] = bent::<f64, Counted, D, S>();
    let mut q = [[Counted(0.0); D]; S];
    let mut k: Tangent<Counted, D, S> = [[[[Counted(0.0); D]; S]; D]; S];
    COUNT.set(Count::default());
    match tangent {
        true => kernel.upper_tangent(&u, &mut k),
        false => kernel.force(&u, &mut q),
    }
    COUNT.get()
}

/// A row of the table; `peak` is in flops per nanosecond.
fn row<Kn, const TANGENT: bool, const D: usize, const S: usize>(name: &str, kernel: &Kn, peak: f64)
where
    Kn: ElementKernel<f64, D, S>,
{
    let count = flops(kernel, TANGENT);
    let (alone, _) = best(|times| timed::alone::<f64, _, TANGENT, D, S>(kernel, times));
    let (group, width) = best(|times| kernel.dispatch(Timed::<TANGENT> { times }));
    let lanes = group / width as f64;
    let flops = count.flops() as f64;
    let what = if TANGENT { "tangent" } else { "force" };
    println!(
        "| {name}: {what} | {flops} | {:.0} % | {} | {alone:.0} | {lanes:.1} | {:.1} | {:.0} % |",
        200.0 * count.fused as f64 / flops,
        count.quotients + count.functions,
        flops / lanes,
        100.0 * flops / lanes / peak,
    );
}

fn of<E, F, const D: usize, const S: usize>(name: &str, element: E, law: F, peak: f64)
where
    E: Element<D, S>,
    F: Formulation<f64, E, D, S>,
{
    let axes = std::array::from_fn(|a| std::array::from_fn(|c| f64::from(u8::from(a == c))));
    let reference = Reference::straight(&element, 0.1, axes);
    let disk = Disk::new(0.01).expect("a radius");
    let kernel = law.kernel(&element, &reference, &disk);
    let kernel = kernel.expect("a rule of full rank");
    row::<_, false, D, S>(name, &kernel, peak);
    row::<_, true, D, S>(name, &kernel, peak);
}

/// GB/s of one thread that reads, and that reads and writes, numbers far from any cache.
fn memory() -> [f64; 2] {
    let mut numbers = vec![1.0_f64; 1 << 25];
    let gigabytes = (numbers.len() * size_of::<f64>()) as f64 / 1e9;
    let mut best = [f64::INFINITY; 2];
    for _ in 0..7 {
        let start = Instant::now();
        let mut sums = [0.0; 32];
        for row in numbers.chunks_exact(sums.len()) {
            for (sum, x) in sums.iter_mut().zip(row) {
                *sum += x;
            }
        }
        black_box(sums);
        best[0] = best[0].min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        numbers.iter_mut().for_each(|x| *x *= 1.0 + 1e-9);
        black_box(&mut numbers);
        best[1] = best[1].min(start.elapsed().as_secs_f64());
    }
    [gigabytes / best[0], 2.0 * gigabytes / best[1]]
}

fn main() {
    let [read, changed] = memory();
    println!("memory: {read:.1} GB/s read, {changed:.1} GB/s read and written");
    let (time, flops) = best(|times| f64::dispatch(Peak { times }));
    let peak = 2.0 * flops as f64 / time;
    println!("peak of fused multiply-adds: {peak:.1} Gflop/s");
    println!(
        "| kernel | flops | fused | divisions, roots | ns alone | ns in lanes | Gflop/s | of peak |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    macro_rules! dimension {
        ($d:literal, $s:literal, $q:literal, $room:literal) => {
            let rubber = SaintVenantKirchhoff::<f64, $d>::isotropic(2e7, 0.3);
            let rubber = rubber.expect("admissible constants");
            let points = Continuum::full(ByPoints(rubber));
            let full = FullyParameterised;
            of::<_, _, $d, $s>(concat!($room, ", section points"), full, points, peak);
            let moments = Continuum::selective_reduced(rubber);
            of::<_, _, $d, $s>(
                concat!($room, ", section once"),
                full,
                moments.clone(),
                peak,
            );
            let two = moments.axial(2);
            of::<_, _, $d, $q>(
                concat!($room, ", quadratic continuum"),
                Quadratic,
                two,
                peak,
            );
            let rod = StructuralMechanics::new(&rubber);
            of::<_, _, $d, $q>(concat!($room, ", quadratic rod"), Quadratic, rod, peak);
            let cable = EulerBernoulli::new(&rubber);
            of::<_, _, $d, 4>(concat!($room, ", cable"), Cable, cable, peak);
        };
    }
    dimension!(3, 8, 9, "space");
    dimension!(2, 6, 6, "plane");
}
