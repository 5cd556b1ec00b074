//! Elementary functions against values of mpmath with 45 digits.

use ancf::scalar::{DoubleDouble, Real};
use num_dual::DualNum;

type Function = fn(&DoubleDouble) -> DoubleDouble;

#[rustfmt::skip]
const TABLE: &[(&str, Function, f64, &str)] = &[
    ("sqrt", DoubleDouble::sqrt, 2.0, "1.41421356237309504880168872420969808"),
    ("sqrt", DoubleDouble::sqrt, 0.3125, "5.59016994374947424102293417182819059e-1"),
    ("sqrt", DoubleDouble::sqrt, 1e+21, "3.16227766016837933199889354443271853e+10"),
    ("sqrt", DoubleDouble::sqrt, 7e-280, "2.64575131106459062656880627264314696e-140"),
    ("cbrt", DoubleDouble::cbrt, 2.0, "1.25992104989487316476721060727822835"),
    ("cbrt", DoubleDouble::cbrt, -0.3125, "-6.78604404148726642879522367419872301e-1"),
    ("cbrt", DoubleDouble::cbrt, 1e+21, "1.0e+7"),
    ("exp", DoubleDouble::exp, 1.0, "2.7182818284590452353602874713526625"),
    ("exp", DoubleDouble::exp, -0.375, "6.8728927879097219854520233914651359e-1"),
    ("exp", DoubleDouble::exp, 0.0078125, "1.00784309720644797769345355976012358"),
    ("exp", DoubleDouble::exp, 30.5, "1.76190179513556314121609847609319352e+13"),
    ("exp", DoubleDouble::exp, -700.25, "7.67872381311087221164988744437894446e-305"),
    ("exp", DoubleDouble::exp, 700.75, "2.14712927672311171023986317316275069e+304"),
    ("exp2", DoubleDouble::exp2, 0.5, "1.41421356237309504880168872420969808"),
    ("exp2", DoubleDouble::exp2, -9.25, "1.64237581104241121685766694576799784e-3"),
    ("exp_m1", DoubleDouble::exp_m1, 0.0009765625, "9.77039492416535242845292611606506466e-4"),
    ("exp_m1", DoubleDouble::exp_m1, -0.25, "-2.21199216928595131754829733021679353e-1"),
    ("exp_m1", DoubleDouble::exp_m1, 0.75, "1.11700001661267466854536981983709561"),
    ("exp_m1", DoubleDouble::exp_m1, -3.5, "-9.69802616577681499260213707636380155e-1"),
    ("ln", DoubleDouble::ln, 2.0, "6.93147180559945309417232121458176568e-1"),
    ("ln", DoubleDouble::ln, 3.0, "1.0986122886681096913952452369225257"),
    ("ln", DoubleDouble::ln, 0.0625, "-2.77258872223978123766892848583270627"),
    ("ln", DoubleDouble::ln, 1.0009765625, "9.76085973055458895960824908017186673e-4"),
    ("ln", DoubleDouble::ln, 1e+300, "6.90775527898213705257902196660513681e+2"),
    ("ln", DoubleDouble::ln, 3e-300, "-6.8967691560954559543368279227679068e+2"),
    ("log2", DoubleDouble::log2, 3.0, "1.58496250072115618145373894394781651"),
    ("log10", DoubleDouble::log10, 3.0, "4.77121254719662437295027903255115309e-1"),
    ("log10", DoubleDouble::log10, 0.5, "-3.01029995663981195213738894724493027e-1"),
    ("ln_1p", DoubleDouble::ln_1p, 9.094947017729282e-13, "9.09494701772514647608762799434692471e-13"),
    ("ln_1p", DoubleDouble::ln_1p, -0.25, "-2.87682072451780927439219005993827432e-1"),
    ("ln_1p", DoubleDouble::ln_1p, 0.75, "5.59615787935422686270888500526826593e-1"),
    ("ln_1p", DoubleDouble::ln_1p, 10.0, "2.3978952727983705440619435779651293"),
    ("sin", DoubleDouble::sin, 0.5, "4.79425538604203000273287935215571388e-1"),
    ("sin", DoubleDouble::sin, 1.0, "8.41470984807896506652502321630299e-1"),
    ("sin", DoubleDouble::sin, std::f64::consts::PI, "1.224646799147353177226065932274998e-16"),
    ("sin", DoubleDouble::sin, -2.5, "-5.98472144103956494051854702186162272e-1"),
    ("sin", DoubleDouble::sin, 1000.5, "9.95273957105213542774042442904904327e-1"),
    ("sin", DoubleDouble::sin, 1000000000000000.0, "8.58272793170235835523886390848406647e-1"),
    ("sin", DoubleDouble::sin, 8.673617379884035e-19, "8.67361737988403547205962240695953369e-19"),
    ("cos", DoubleDouble::cos, 0.5, "8.77582561890372716116281582603829652e-1"),
    ("cos", DoubleDouble::cos, std::f64::consts::FRAC_PI_2, "6.12323399573676588613032966137500146e-17"),
    ("cos", DoubleDouble::cos, -2.5, "-8.01143615546933714833502790467351664e-1"),
    ("cos", DoubleDouble::cos, 1000.5, "9.71069014443852641226388708242569888e-2"),
    ("tan", DoubleDouble::tan, 0.5, "5.46302489843790513255179465780285383e-1"),
    ("tan", DoubleDouble::tan, 2.5, "-7.47022297238660279355352687825274558e-1"),
    ("asin", DoubleDouble::asin, 0.5, "5.23598775598298873077107230546583814e-1"),
    ("asin", DoubleDouble::asin, -0.9990234375, "-1.5265985556491813013047550036769962"),
    ("asin", DoubleDouble::asin, 9.094947017729282e-13, "9.09494701772928237915039187886064088e-13"),
    ("acos", DoubleDouble::acos, 0.5, "1.04719755119659774615421446109316763"),
    ("acos", DoubleDouble::acos, -0.75, "2.41885840577637762728426603063816952"),
    ("acos", DoubleDouble::acos, 0.9990234375, "4.41977711457153179265666879627552431e-2"),
    ("atan", DoubleDouble::atan, 0.5, "4.63647609000806116214256231461214402e-1"),
    ("atan", DoubleDouble::atan, -3.0, "-1.24904577239825442582991707728109012"),
    ("atan", DoubleDouble::atan, 10000000000.0, "1.57079632669489661923132169164008478"),
    ("atan", DoubleDouble::atan, 9.313225746154785e-10, "9.31322574615478515355735477684561304e-10"),
    ("sinh", DoubleDouble::sinh, 0.0078125, "7.81257947310223279375816682325287456e-3"),
    ("sinh", DoubleDouble::sinh, -0.25, "-2.52612316808168307914125150542057906e-1"),
    ("sinh", DoubleDouble::sinh, 0.5, "5.21095305493747361622425626411491559e-1"),
    ("sinh", DoubleDouble::sinh, 20.0, "2.42582597704895137953976604051491365e+8"),
    ("cosh", DoubleDouble::cosh, 0.5, "1.12762596520638078522622516140267201"),
    ("cosh", DoubleDouble::cosh, -3.0, "1.00676619957777658419539360351158898e+1"),
    ("tanh", DoubleDouble::tanh, 0.0078125, "7.8123410581610138213918161984760595e-3"),
    ("tanh", DoubleDouble::tanh, -0.5, "-4.62117157260009758502318483643672549e-1"),
    ("tanh", DoubleDouble::tanh, 20.0, "9.99999999999999991503291489416822045e-1"),
    ("asinh", DoubleDouble::asinh, 0.0078125, "7.81242052932300746507094733263108091e-3"),
    ("asinh", DoubleDouble::asinh, -0.5, "-4.81211825059603447497758913424368423e-1"),
    ("asinh", DoubleDouble::asinh, 20.0, "3.68950386898890564082165357096109333"),
    ("acosh", DoubleDouble::acosh, 1.0009765625, "4.41905780831100944299637635287994671e-2"),
    ("acosh", DoubleDouble::acosh, 20.0, "3.68825386736129666761816757203235189"),
    ("atanh", DoubleDouble::atanh, 0.0078125, "7.81265895154042091032347127604017267e-3"),
    ("atanh", DoubleDouble::atanh, -0.5, "-5.49306144334054845697622618461262852e-1"),
    ("atanh", DoubleDouble::atanh, 0.96875, "2.07156736319576634394792160864411557"),
    ("sph_j0", DoubleDouble::sph_j0, 0.0625, "9.99349085478083177354904106723692054e-1"),
    ("sph_j0", DoubleDouble::sph_j0, 3.5, "-1.00223779339891385177248228583895881e-1"),
    ("sph_j1", DoubleDouble::sph_j1, 0.0625, "2.0825196447744443584584268365731142e-2"),
    ("sph_j1", DoubleDouble::sph_j1, 3.5, "2.38923687985972843577545542310818452e-1"),
    ("sph_j2", DoubleDouble::sph_j2, 0.0625, "2.60344013650114705140774831402762656e-4"),
    ("sph_j2", DoubleDouble::sph_j2, 3.5, "3.05015511899296679672287264850311697e-1"),
];

#[test]
fn elementary_functions_have_all_digits() {
    for (name, f, x, truth) in TABLE {
        let truth: DoubleDouble = truth.parse().unwrap();
        let value = f(&DoubleDouble::from(*x));
        let error = ((value - truth) / truth).value().abs() / DoubleDouble::EPSILON;
        // An exponential multiplies the rounding of a large argument.
        let allowed = if name.starts_with("exp") {
            6.0 + x.abs()
        } else {
            6.0
        };
        assert!(
            error < allowed,
            "{name}({x:e}): {value}, wrong by {error} units"
        );
    }
}

#[test]
fn the_arc_tangent_knows_all_quadrants() {
    let number = DoubleDouble::from;
    for (y, x) in [
        (0.0, -1.0),
        (1.0, 0.0),
        (-3.0, -1.0),
        (2.0, -5.0),
        (-1.0, 4.0),
        (1.0, 1.0),
    ] {
        let angle = number(y).atan2(number(x));
        assert!((angle.value() - f64::atan2(y, x)).abs() < 1e-15);
        let size = DualNum::sqrt(&(number(x) * x + number(y) * y));
        let (sin, cos) = angle.sin_cos();
        assert!((sin * size - y).value().abs() < 1e-31 && (cos * size - x).value().abs() < 1e-30);
    }
}
