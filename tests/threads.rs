//! Claims about long chains, which are evaluated in shares: they are the sum of their elements wherever
//! they are cut and held, and the threads that take the shares change no bit of a result.

use ancf::formulation::{ElementKernel, Reference, Tangent};
use ancf::prelude::*;
use ancf::scalar::Algebra;
use ancf::scene::Placed;
use ancf::solver::{Matrix, Profile, Structure, Unknowns};

/// Enough for several cuts, and not a multiple of anything.
const ELEMENTS: usize = 2603;
const LENGTH: f64 = 0.25;

fn axis<const D: usize>(k: usize) -> [f64; D] {
    std::array::from_fn(|c| if c == k { 1.0 } else { 0.0 })
}

fn rule<const D: usize>() -> Continuum<SaintVenantKirchhoff<f64, D>> {
    Continuum::selective_reduced(SaintVenantKirchhoff::isotropic(1e6, 0.3).unwrap())
}

/// A chain clamped at its start and pinned inside a share.
fn system<const D: usize, const S: usize>() -> System<f64, D>
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let end = axis(0).map(|c: f64| c * LENGTH * ELEMENTS as f64);
    let beam = Beam::new(FullyParameterised, Disk::new(0.05).unwrap(), rule());
    let beam = beam.straight([0.0; D], end, ELEMENTS).density(1000.0);
    let mut scene = Scene::<f64, D>::new();
    let beam = scene.add(beam).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.pin(beam.node(777)).unwrap();
    scene.assemble().unwrap()
}

fn moved<const D: usize>(system: &System<f64, D>, phase: f64) -> Vec<f64> {
    let wave = |i: usize| 0.05 * (1.7 * i as f64 + phase).sin();
    let mut u = (0..system.reference().len()).map(wave).collect::<Vec<_>>();
    system.unknowns().follow(&mut u);
    u
}

/// The entries of a chain's matrix near the diagonal.
fn entries(matrix: &Matrix<f64>, half: usize) -> Vec<f64> {
    let size = matrix.stored().size();
    let near = |i: usize| (i.saturating_sub(half)..size.min(i + half)).map(move |j| (i, j));
    let entry = |(i, j)| matrix.stored().get(i, j);
    (0..size).flat_map(near).map(entry).collect()
}

fn check<const D: usize, const S: usize>()
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let system = system::<D, S>();
    let u = moved(&system, 0.0);
    let frame = std::array::from_fn(axis);
    let reference = Reference::straight(&FullyParameterised, LENGTH, frame);
    let disk = Disk::new(0.05).unwrap();
    let kernel = rule()
        .kernel(&FullyParameterised, &reference, &disk)
        .unwrap();
    let mut expected = vec![0.0; u.len()];
    let stride = S * D / 2;
    for symmetric in [true, false] {
        let mut sum = Matrix::zero(system.unknowns(), false);
        expected.fill(0.0);
        for start in (0..ELEMENTS).map(|n| n * stride) {
            let own: [[f64; D]; S] =
                std::array::from_fn(|i| std::array::from_fn(|c| u[start + i * D + c]));
            let mut q = [[0.0; D]; S];
            let mut k: Tangent<f64, D, S> = [[[[0.0; D]; S]; D]; S];
            kernel.tangent(&own, &mut q, &mut k);
            for (e, q) in expected[start..].iter_mut().zip(q.as_flattened()) {
                *e += *q;
            }
            let block = k.as_flattened().as_flattened().as_flattened();
            sum.add_block(start, S * D, block).unwrap();
        }
        let mut force = vec![0.0; u.len()];
        system.add_internal(&u, &mut force);
        let mut tangent = Matrix::zero(system.unknowns(), symmetric);
        // What was there before must not show.
        for _ in 0..2 {
            tangent.clear();
            system.add_tangent(0.0, 1.0, &u, &mut tangent).unwrap();
        }
        let pairs = [
            (force, expected.clone()),
            (entries(&tangent, S * D), entries(&sum, S * D)),
        ];
        for (ours, theirs) in pairs {
            let top = theirs.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            assert!(top > 1.0);
            for (a, b) in ours.iter().zip(&theirs) {
                assert!((a - b).abs() < 200.0 * f64::EPSILON * top, "{a} {b}");
            }
        }
    }
}

#[test]
fn a_long_chain_is_the_sum_of_its_elements() {
    check::<3, 8>();
    check::<2, 6>();
}

/// Everything that a chain adds, in one list of numbers.
#[cfg(feature = "rayon")]
fn all_of<const D: usize, const S: usize>(system: &System<f64, D>) -> Vec<f64>
where
    FullyParameterised: Element<D, S>,
    Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
{
    let [from, to] = [0.0, 1.0].map(|phase| moved(system, phase));
    let zeros = || vec![0.0; from.len()];
    let mut vectors = [zeros(), zeros(), zeros()];
    system.add_internal(&to, &mut vectors[0]);
    system.add_mass_times(2.0, &to, &mut vectors[0]);
    system.add_mass_times(-1.0, &from, &mut vectors[1]);
    system.add_secant(0.1, &from, &to, &mut vectors[2]);
    let mut symmetric = Matrix::zero(system.unknowns(), true);
    let mut general = Matrix::zero(system.unknowns(), false);
    system
        .add_tangent_and_mass(0.0, 1.0, &to, 100.0, &mut symmetric)
        .unwrap();
    system
        .add_secant_tangent((0.0, 1.0), 0.1, &from, &to, &mut general)
        .unwrap();
    let matrices = [&symmetric, &general].map(|k| entries(k, S * D));
    vectors.into_iter().chain(matrices).flatten().collect()
}

#[cfg(feature = "rayon")]
#[test]
fn threads_change_no_bit() {
    fn check<const D: usize, const S: usize>()
    where
        FullyParameterised: Element<D, S>,
        Continuum<SaintVenantKirchhoff<f64, D>>: Formulation<f64, FullyParameterised, D, S>,
    {
        let system = system::<D, S>();
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| all_of::<D, S>(&system))
        };
        let one = on(1);
        assert!(one.iter().all(|x| x.is_finite()) && one.iter().any(|x| x.abs() > 1.0));
        for threads in [2, 5] {
            assert!(one == on(threads), "{threads} threads");
        }
    }
    check::<3, 8>();
    check::<2, 6>();
}

/// Some steps of a beam on three supports, under its weight and a force: all displacements, and how many iterations they took. Another beam may be
/// `beside` it, held at both ends.
fn swung(elements: usize, beside: bool) -> (Vec<f64>, usize) {
    let mut scene = Scene::<f64, 3>::new();
    let straight = |length: f64, elements| {
        let beam = Beam::new(FullyParameterised, Disk::new(0.01).unwrap(), rule());
        let beam = beam.straight([0.0; 3], [length, 0.0, 0.0], elements);
        beam.density(7200.0)
    };
    let beam = scene
        .add(straight(0.1 * elements as f64, elements))
        .unwrap();
    scene.pin(beam.start()).unwrap();
    if beside {
        let other = scene.add(straight(0.1, 1)).unwrap();
        scene.clamp(other.start()).unwrap();
        scene.clamp(other.end()).unwrap();
    }
    // Where parts meet, and within one.
    for node in [300, 512] {
        scene.pin(beam.node(node)).unwrap();
    }
    scene.force(beam.end(), [0.1, 0.2, 0.3]).unwrap();
    scene.gravity([0.0, -9.81, 0.0]).unwrap();
    let system = scene.assemble().unwrap();
    let method = Newmark::trapezoidal();
    let mut run = Integration::start(&system, system.rest(), &method).unwrap();
    run.until(5e-3, Stepping::Fixed(1e-3), |_| {}).unwrap();
    let iterations = run.report().iterations;
    (run.into_state().displacement, iterations)
}

/// Long chains are eliminated while they are assembled; the nodes near the start do not feel that the
/// chain is longer.
#[test]
fn elimination_in_pieces_is_elimination_as_a_whole() {
    let ((short, few), (long, many)) = (swung(1000, false), swung(1100, false));
    assert_eq!(few, many);
    let near = 12 * 200;
    let top = short[..near].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    assert!(top > 1e-5);
    for (a, b) in short[..near].iter().zip(&long) {
        assert!((a - b).abs() < 1e-12 * top, "{a} {b}");
    }
}

/// A cantilever that is held where parts meet, too, under a force at its end.
fn bent(beside: bool, line_search: bool) -> Vec<f64> {
    let mut scene = Scene::<f64, 3>::new();
    let straight = |length: f64, elements| {
        let beam = Beam::new(FullyParameterised, Disk::new(0.01).unwrap(), rule());
        beam.straight([0.0; 3], [length, 0.0, 0.0], elements)
    };
    let beam = scene.add(straight(60.0, 600)).unwrap();
    scene.clamp(beam.start()).unwrap();
    scene.pin(beam.node(512)).unwrap();
    scene.force(beam.end(), [0.0, 1e-6, 2e-6]).unwrap();
    if beside {
        let other = scene.add(straight(0.1, 1)).unwrap();
        scene.clamp(other.start()).unwrap();
        scene.clamp(other.end()).unwrap();
    }
    let system = scene.assemble().unwrap();
    let mut state = system.rest();
    let newton = Newton {
        line_search,
        ..Newton::default()
    };
    let statics = Statics {
        newton,
        ..Statics::default()
    };
    statics.solve(&system, &mut state).unwrap();
    state.displacement
}

#[test]
fn a_beam_beside_changes_no_bit_of_an_equilibrium() {
    for search in [false, true] {
        let (alone, beside) = (bent(false, search), bent(true, search));
        assert!(alone.iter().any(|x| x.abs() > 0.1));
        assert!(alone[..] == beside[..alone.len()], "{search}");
    }
}

/// A long beam alone is balanced and eliminated in parts, and as a whole where others are in the scene.
#[test]
fn a_beam_beside_changes_no_bit() {
    let ((alone, few), (beside, many)) = (swung(1100, false), swung(1100, true));
    assert_eq!(few, many);
    assert!(alone[..] == beside[..alone.len()]);
    assert!(beside[alone.len()..].iter().all(|x| *x == 0.0));
}

#[cfg(feature = "rayon")]
#[test]
fn threads_change_no_bit_of_a_run() {
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(|| swung(2200, false))
    };
    assert!(on(1) == on(2));
}

/// What acts on a chain, stated in its scene.
type Acts = dyn Fn(&mut Scene<f64, 2>, Placed);

/// A spring to the ground.
#[derive(Debug)]
struct Spring;

impl<R: Real> Connector<R, 2, 1> for Spring {
    fn energy<T: Algebra<R>>(&self, [[x, y]]: &[[T; 2]; 1]) -> T {
        (*x * *x + *y * *y) * T::lit(5e3)
    }
}

/// Shows long chains with what else acts on them, whether they are eliminated while they are assembled,
/// and whether their forces are evaluated in parts.
fn each_scene(mut show: impl FnMut(&str, &System<f64, 2>, [bool; 2])) {
    let scene = |add: &Acts| {
        let beam = Beam::new(FullyParameterised, Disk::new(0.05).unwrap(), rule());
        let beam = beam.straight([0.0; 2], [0.25 * 1200.0, 0.0], 1200);
        let mut scene = Scene::<f64, 2>::new();
        let beam = scene.add(beam.density(1000.0)).unwrap();
        scene.clamp(beam.start()).unwrap();
        add(&mut scene, beam);
        scene.assemble().unwrap()
    };
    let nothing = |_: &mut Scene<f64, 2>, _: Placed| {};
    let held = |scene: &mut Scene<f64, 2>, beam: Placed| {
        scene.pin(beam.node(300)).unwrap();
        scene.pin(beam.end()).unwrap();
        scene.force(beam.node(700), [1.0, 2.0]).unwrap();
    };
    let turned = |scene: &mut Scene<f64, 2>, beam: Placed| {
        let moment = Moment::about_z(1e3);
        scene.moment(beam.node(100), moment).unwrap();
    };
    let heavy = |scene: &mut Scene<f64, 2>, beam: Placed| {
        scene.mass(beam.node(100), 50.0).unwrap();
    };
    let sprung = |scene: &mut Scene<f64, 2>, beam: Placed| {
        let at = (beam.node(100), NodalVector::Position);
        scene.connect([at], Spring).unwrap();
    };
    let together = |scene: &mut Scene<f64, 2>, beam: Placed| {
        let [near, far] = [50, 60].map(|n| (beam.node(n), NodalVector::Position));
        scene
            .constrain(&[(near.0, near.1, 1, 1.0), (far.0, far.1, 1, -2.0)])
            .unwrap();
    };
    let two = |scene: &mut Scene<f64, 2>, beam: Placed| {
        let other = Beam::new(FullyParameterised, Disk::new(0.05).unwrap(), rule());
        let other = other.straight([0.0, 0.0], [0.0, 300.0], 1200);
        let other = scene.add(other.density(1000.0)).unwrap();
        scene
            .join(beam.start(), other.start(), Joint::Spherical)
            .unwrap();
    };
    let all: [(&str, &Acts, [bool; 2]); 7] = [
        ("nothing", &nothing, [true, true]),
        ("supports", &held, [true, true]),
        ("a moment", &turned, [false, true]),
        ("a mass", &heavy, [false, false]),
        ("a spring", &sprung, [false, false]),
        ("a condition", &together, [false, true]),
        ("two beams", &two, [false, false]),
    ];
    for (name, add, expected) in all {
        show(name, &scene(add), expected);
    }
}

/// Forces of parts are those of the whole, to the last bit and wherever a part is told to complete
/// them, whatever else acts on a chain.
#[test]
fn forces_of_parts_are_those_of_the_whole() {
    each_scene(|name, system, [_, several]| check_parts(name, system, several));
    check_parts("space", &system::<3, 8>(), true);
    #[cfg(feature = "rayon")]
    for threads in [2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        // Larger ones: two of 2048 elements at most, or one of 3072.
        pool.install(|| check_parts("threads", &system::<3, 8>(), threads == 2));
    }
}

fn check_parts<const D: usize>(name: &str, system: &System<f64, D>, several: bool) {
    let (u, a) = (moved(system, 0.0), moved(system, 1.0));
    let zeros = || vec![0.0; u.len()];
    let (mut whole, mut sums) = ([zeros(), zeros()], [zeros(), zeros()]);
    system.add_internal(&u, &mut whole[0]);
    system.add_mass_times(3.0, &a, &mut whole[1]);
    let (mut told, mut times) = (u.len(), 0);
    system.each_part(&mut |part| {
        let own = part.coordinates.clone();
        assert!(own.end <= told, "{name}");
        // A part does not look beyond its coordinates.
        let mut known = vec![f64::NAN; u.len()];
        known[own.clone()].copy_from_slice(&u[own.clone()]);
        let [internal, inertia] = &mut sums;
        system.add_internal_of(part, &known, &mut internal[own.clone()]);
        system.add_mass_times_of(part, 3.0, &a[own.clone()], &mut inertia[own]);
        (told, times) = (part.complete, times + 1);
        for (sum, whole) in sums.iter().zip(&whole) {
            assert!(sum[told..] == whole[told..], "{name}: {told}");
        }
    });
    assert_eq!((told, times > 1), (0, several), "{name}");
}

/// What is told to be complete is what the whole tangent holds there, whatever else acts on a chain.
#[test]
fn complete_unknowns_gain_nothing_more() {
    each_scene(|name, system, [early, _]| {
        let u = moved(system, 0.0);
        let size = system.unknowns().count();
        let mut k = Matrix::zero(system.unknowns(), true);
        system
            .add_tangent_and_mass(0.3, 1.0, &u, 7.0, &mut k)
            .unwrap();
        let line = |k: &Matrix<f64>, i: usize| -> Vec<f64> {
            let last = size.min(i + 13);
            (i..last).map(|j| k.stored().get(i, j)).collect()
        };
        let whole: Vec<_> = (0..size).map(|i| line(&k, i)).collect();
        k.clear();
        let (mut told, mut times) = (0, 0);
        system
            .add_tangent_in_order(0.3, 1.0, &u, Some(7.0), &mut k, &mut |k, ready| {
                assert!(ready >= told && ready <= size, "{name}");
                for i in told..ready {
                    assert_eq!(line(k, i), whole[i], "{name}: unknown {i}");
                }
                (told, times) = (ready, times + 1);
                Ok(())
            })
            .unwrap();
        assert_eq!(
            times > 5 && told > size / 2,
            early,
            "{name}: {times} {told}"
        );
        for i in told..size {
            assert_eq!(line(&k, i), whole[i], "{name}: unknown {i}");
        }
    });
}

/// One spring, and one that goes slack as it is pushed back: then nothing is added for it.
struct Slack(Unknowns<f64>);

impl Structure<f64> for Slack {
    fn unknowns(&self) -> &Unknowns<f64> {
        &self.0
    }
    fn symmetric(&self) -> bool {
        true
    }
    fn measure(&self) -> &[f64] {
        &[1.0, 1.0]
    }
    fn add_internal(&self, u: &[f64], q: &mut [f64]) {
        q[0] += u[0];
        q[1] += u[1].max(0.0).powi(2);
    }
    fn add_external(&self, _: f64, _: f64, _: &[f64], q: &mut [f64]) -> Result<()> {
        q[0] += 1.0;
        q[1] -= 0.3;
        Ok(())
    }
    fn add_tangent(&self, _: f64, _: f64, u: &[f64], k: &mut Matrix<f64>) -> Result<()> {
        k.add(0, 0, 1.0)?;
        match u[1] > 0.0 {
            true => k.add(1, 1, 2.0 * u[1]),
            false => Ok(()),
        }
    }
    fn has_mass(&self) -> bool {
        false
    }
    fn add_mass_times(&self, _: f64, _: &[f64], _: &mut [f64]) {}
    fn add_mass(&self, _: f64, _: &mut Matrix<f64>) -> Result<()> {
        Ok(())
    }
}

/// A line that nothing was added to is zero, whatever factors were kept there before: here those of the
/// iterations at 2, 0.925 and 0.30 before the one at -0.35.
#[test]
fn what_is_not_added_is_not_stiff() {
    let profile = Profile::from_ranges(2, [0..1, 1..2]).unwrap();
    let slack = Slack(Unknowns::all(profile));
    let zeros = || vec![0.0; 2];
    let mut state = State {
        time: 0.0,
        displacement: vec![0.0, 2.0],
        velocity: zeros(),
        acceleration: zeros(),
        work: 0.0,
    };
    let solved = Statics::default().solve(&slack, &mut state);
    assert!(matches!(solved, Err(Error::Mechanism { .. })), "{solved:?}");
}
