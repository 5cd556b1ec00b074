//! Elementary functions of every family of numbers against each other, and their derivatives
//! against Richardson's finite differences.

use num_dual::{Dual, DualSVec, HyperDual};
use simba::simd::{WideF32x8, WideF64x4};

use super::{Algebra, Field, Jet, LaneWork, Laned, Lanes, Real, Scalar};

const COUNT: usize = 19;

fn all<T: Field>(x: T) -> [T; COUNT] {
    let shifted = x - T::lit(0.5);
    [
        x.sqrt(),
        x.recip(),
        x.exp(),
        shifted.exp_m1(),
        x.ln(),
        shifted.ln_1p(),
        x.sin(),
        x.cos(),
        x.tan(),
        shifted.asin(),
        shifted.acos(),
        shifted.atan(),
        shifted.sinh(),
        x.cosh(),
        shifted.tanh(),
        x.powf(2.5),
        shifted.powi(5),
        x.powi(-3),
        shifted.powi(0),
    ]
}

/// Inside every domain, on both sides of one half.
const POINTS: [f64; 4] = [0.125, 0.4375, 0.5625, 0.875];

fn close(what: &str, k: usize, found: f64, truth: f64, tolerance: f64) {
    let error = (found - truth).abs();
    let limit = tolerance * truth.abs().max(1.0);
    assert!(
        error <= limit,
        "{what}, function {k}: {found:e}, not {truth:e}"
    );
}

/// Richardson's extrapolation of central differences.
fn slopes<const N: usize>(f: impl Fn(f64) -> [f64; N], x: f64) -> [f64; N] {
    let central = |h: f64| {
        let (plus, minus) = (f(x + h), f(x - h));
        std::array::from_fn::<_, N, _>(|k| (plus[k] - minus[k]) / (2.0 * h))
    };
    let [coarse, fine, finest] = [4e-3, 2e-3, 1e-3].map(central);
    std::array::from_fn(|k| {
        let [first, second] = [(coarse[k], fine[k]), (fine[k], finest[k])]
            .map(|(coarse, fine)| (4.0 * fine - coarse) / 3.0);
        (16.0 * second - first) / 15.0
    })
}

/// First derivatives of all functions by the dual numbers of a type over itself.
fn first<R: Real>(x: f64) -> [f64; COUNT] {
    let x = R::lit(x).variable::<2>(1);
    all(x).map(|f| {
        assert_eq!(R::derivative::<2>(&f, 0).value(), 0.0);
        R::derivative::<2>(&f, 1).value()
    })
}

#[test]
fn functions_agree_in_all_numbers_and_derive() {
    for x in POINTS {
        let plain = all(x);
        let std = [
            x.sqrt(),
            1.0 / x,
            x.exp(),
            (x - 0.5).exp_m1(),
            x.ln(),
            (x - 0.5).ln_1p(),
        ];
        for k in 0..std.len() {
            close("f64", k, plain[k], std[k], 1e-15);
        }
        let identities = [
            plain[8] - x.tan(),
            plain[15] - x.powf(2.5),
            plain[17] * x.powi(3) - 1.0,
        ];
        assert!(identities.iter().all(|d| d.abs() < 1e-14), "{identities:?}");
        let single = all(x as f32);
        let slope = slopes(all::<f64>, x);
        let curvature = slopes(first::<f64>, x);
        let dual = all(Dual::from_re(x).derivative());
        let vector = all(DualSVec::<f64, 1>::from_re(x).derivative(0));
        let nested = all(Dual::new(Dual::new(x, 1.0), Dual::from_re(1.0)));
        let hyper = all(HyperDual::from_re(x).derivative1().derivative2());
        let lanes = all(WideF64x4::from([x; 4]).variable::<1>(0));
        let wide = all(WideF32x8::from([x as f32; 8]));
        let over = WideF64x4::from([x; 4]).variable::<1>(0);
        let jets = all(Jet {
            re: over,
            eps: [Jet::lit(1.0)],
        });
        let packs = all(<f64 as Laned>::pack(|_| x));
        for k in 0..COUNT {
            close("f32", k, single[k].into(), plain[k], 1e-5);
            close(
                "f32 lanes",
                k,
                <[f32; 8]>::from(wide[k].0)[3].into(),
                plain[k],
                1e-5,
            );
            close(
                "lanes",
                k,
                <[f64; 4]>::from(lanes[k].re.0)[2],
                plain[k],
                1e-15,
            );
            close("packs", k, f64::unpack(packs[k], 5), plain[k], 1e-15);
            let eps = |lanes: WideF64x4| <[f64; 4]>::from(lanes.0)[1];
            for (what, found) in [
                ("dual", dual[k].eps),
                ("vector of duals", f64::derivative::<1>(&vector[k], 0)),
                ("nested duals", nested[k].re.eps),
                ("hyper-dual", hyper[k].eps1),
                ("jet of lanes", eps(lanes[k].eps[0])),
                ("jet of jets", eps(jets[k].re.eps[0])),
                ("f32 duals", first::<f32>(x)[k]),
            ] {
                let tolerance = if what == "f32 duals" { 1e-5 } else { 1e-9 };
                close(what, k, found, slope[k], tolerance);
            }
            for (what, found) in [
                ("nested duals", nested[k].eps.eps),
                ("hyper-dual", hyper[k].eps1eps2),
                ("jet of jets", eps(jets[k].eps[0].eps[0])),
            ] {
                close(what, k, found, curvature[k], 1e-9);
            }
        }
    }
}

/// The registers that the processor at hand has.
#[test]
fn functions_agree_in_registers() {
    struct Work<'a>(&'a [f64]);
    impl LaneWork<f64> for Work<'_> {
        type Output = Vec<[f64; 2]>;
        fn run<L: Lanes<f64>>(self) -> Self::Output {
            let x = L::load(self.0).variable::<1>(0);
            let number = |lane: L| {
                let mut numbers = [0.0; 32];
                lane.store(&mut numbers);
                numbers[L::WIDTH - 1]
            };
            let parts = |f: L::Dual<1>| {
                let slope = L::derivative::<1>(&f, 0);
                [L::real_part::<1>(&f), slope].map(number)
            };
            all(x).map(parts).to_vec()
        }
    }
    let found = f64::dispatch(Work(&[0.4375; 32]));
    let (values, slopes) = (all(0.4375), first::<f64>(0.4375));
    for k in 0..COUNT {
        close("register", k, found[k][0], values[k], 1e-14);
        close("derivative in a register", k, found[k][1], slopes[k], 1e-14);
    }
}

#[cfg(feature = "double-double")]
#[test]
fn double_doubles_know_the_same_functions() {
    use super::DoubleDouble;
    for x in POINTS {
        let (precise, plain) = (all(DoubleDouble::lit(x)), all(x));
        let (slopes, double) = (first::<DoubleDouble>(x), first::<f64>(x));
        for k in 0..COUNT {
            close("double-double", k, precise[k].value(), plain[k], 1e-14);
            close("derivative", k, slopes[k], double[k], 1e-13);
        }
    }
    // To all digits, by identities.
    let x = DoubleDouble::lit(0.4375);
    let [s, c, ch, t] = [x.sinh(), x.cosh() - x.exp(), x.cosh(), x.tanh()];
    for error in [
        s + c,
        t * ch - s,
        x.exp_m1().ln_1p() - x,
        x.atan().tan() - x,
        x.acos().cos() - x,
    ] {
        assert!(error.value().abs() < 1e-30, "{error}");
    }
}

#[test]
fn small_arguments_keep_their_digits_and_powers_their_signs() {
    fn check<T: Field>(part: impl Fn(T) -> f64) {
        let x = T::lit(1e-9);
        let series = 1e-9 * (1.0 - 0.5e-9);
        assert!((part(x.ln_1p()) / series - 1.0).abs() < 1e-6 / 1e3);
        assert!((part((-x).exp_m1()) / series + 1.0).abs() < 1e-6 / 1e3);
        assert_eq!(part(T::lit(-2.0).powi(3)), -8.0);
        assert_eq!(part(T::lit(-2.0).powi(-2)), 0.25);
        assert_eq!(part(T::lit(0.0).powi(2)), 0.0);
    }
    check(|x: f64| x);
    check(|x: Dual<f64>| x.re);
    check(|x: HyperDual<f64>| x.re);
    check(|x: WideF64x4| <[f64; 4]>::from(x.0)[0]);
    check(|x: <f64 as Laned>::Pack| x.lane(3));
    // A power has a derivative at zero.
    let zero = Dual::new(0.0, 1.0);
    assert_eq!([0, 1, 2].map(|n| zero.powi(n).eps), [0.0, 1.0, 0.0]);
}
