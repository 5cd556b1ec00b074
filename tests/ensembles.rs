//! Ensembles: rows in lanes, on threads and in shards are the rows one by one, to the last bit.

mod registers;

use ancf::prelude::*;
use ancf::scalar::{Laned, together};
use ancf::sweep::{Experiment, Results, Row, Sweep, derivatives, merge};

/// The tip of a spatial cantilever for `[E, R, load]`, loaded in steps.
struct Cantilever;
/// The tip of a falling pendulum for `[E, R]`, by a fixed step.
struct Pendulum<S>(S);

impl Experiment<3> for Cantilever {
    fn run<R: Real>(&self, row: [R; 3]) -> Result<Vec<R>> {
        Ok(bent(row)?.0)
    }
}

/// Where the tip of a spatial cantilever comes to rest, and Newton's iterations on the way.
fn bent<R: Real>([young, radius, load]: [R; 3]) -> Result<(Vec<R>, usize)> {
    let steel = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
    let formulation = Continuum::selective_reduced(steel);
    let mut scene = Scene::<R, 3>::new();
    let rod = Beam::new(FullyParameterised, Disk::new(radius)?, formulation).straight(
        [R::zero(); 3],
        [R::one(), R::zero(), R::zero()],
        3,
    );
    let rod = scene.add(rod)?;
    scene.clamp(rod.start())?;
    scene.force(rod.end(), [R::zero(), -load, load * R::lit(0.5)])?;
    let system = scene.assemble()?;
    let mut state = system.rest();
    let report = Statics::in_steps(5).solve(&system, &mut state)?;
    Ok((
        system.position(&state, rod.end())?.to_vec(),
        report.iterations,
    ))
}

/// The tip of a planar cantilever of `[offset, length, turn]` whose section lies off the axis, in the direction
/// of an angle, by products in two parts.
struct Bracket;

impl Experiment<3> for Bracket {
    fn run<R: Real>(&self, [offset, length, turn]: [R; 3]) -> Result<Vec<R>> {
        let steel = SaintVenantKirchhoff::isotropic(R::lit(2e7), R::lit(0.3))?;
        let formulation = CoMoving(Continuum::selective_reduced(steel));
        let plate = Rectangle::new(R::lit(0.02), R::lit(0.03))?;
        let section = Offset::new(plate, [offset, R::zero()])?;
        let mut scene = Scene::<R, 2>::new();
        let end = [length * Field::cos(turn), length * Field::sin(turn)];
        let rod = Beam::new(FullyParameterised, section, formulation);
        let rod = scene.add(rod.straight([R::zero(); 2], end, 3))?;
        scene.clamp(rod.start())?;
        scene.force(rod.end(), [R::lit(0.1), R::lit(-0.2)])?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        Statics::in_steps(2).solve(&system, &mut state)?;
        Ok(system.position(&state, rod.end())?.to_vec())
    }
}

/// The crown of an arch for `[E, R, load]`, clamped at its ends. Each of its elements has a kernel of its
/// own, which has no lanes in plain numbers: a quadratic form, or sampled with dual numbers (`ROD`).
struct Arch<const ROD: bool>;

impl<const ROD: bool> Experiment<3> for Arch<ROD> {
    fn run<R: Real>(&self, [young, radius, load]: [R; 3]) -> Result<Vec<R>> {
        let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
        let disk = Disk::new(radius)?;
        let axis = |s: R| {
            let (sin, cos) = (Field::sin(s * R::pi()), Field::cos(s * R::pi()));
            ([-cos, sin], [[sin, cos], [-cos, sin]])
        };
        let mut scene = Scene::<R, 2>::new();
        let arch = match ROD {
            true => {
                let beam = Beam::new(Quadratic, disk, StructuralMechanics::new(&rubber));
                scene.add(beam.curved(R::pi(), 4, axis))?
            }
            false => {
                let formulation = Continuum::selective_reduced(rubber);
                let beam = Beam::new(FullyParameterised, disk, formulation);
                scene.add(beam.curved(R::pi(), 4, axis))?
            }
        };
        let crown = arch.node(if ROD { 4 } else { 2 });
        scene.clamp(arch.start())?;
        scene.clamp(arch.end())?;
        scene.force(crown, [R::zero(), -load])?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        Statics::in_steps(3).solve(&system, &mut state)?;
        Ok(system.position(&state, crown)?.to_vec())
    }
}

macro_rules! pendulum {
    ($($scheme:ty),*) => {$(
        impl Experiment<2> for Pendulum<$scheme> {
            fn run<R: Real>(&self, [young, radius]: [R; 2]) -> Result<Vec<R>> {
                let rubber = SaintVenantKirchhoff::isotropic(young, R::lit(0.3))?;
                let formulation = Continuum::selective_reduced(rubber);
                let mut scene = Scene::<R, 2>::new();
                let rod = Beam::new(FullyParameterised, Disk::new(radius)?, formulation)
                    .straight([R::zero(); 2], [R::one(), R::zero()], 4)
                    .density(R::lit(7200.0));
                let rod = scene.add(rod)?;
                scene.pin(rod.start())?;
                scene.gravity([R::zero(), R::lit(-9.81)])?;
                let system = scene.assemble()?;
                let mut run = Integration::start(&system, system.rest(), &self.0)?;
                run.until(R::lit(0.05), Stepping::Fixed(1e-3), |_| {})?;
                Ok(system.position(run.state(), rod.end())?.to_vec())
            }
        }
    )*};
}
pendulum!(Newmark, EnergyMomentum);

fn outputs<const P: usize>(results: &Results<f64, P>) -> Vec<Vec<f64>> {
    let all = results.rows().iter().map(|row| row.outputs.clone());
    all.collect::<Result<_>>().unwrap()
}

fn cantilevers() -> Sweep<f64, 3> {
    Sweep::grid([&[1e7, 2e7, 3e7], &[0.01, 0.02], &[0.05, 0.1]]).unwrap()
}

/// One by one is another number type, with its own arithmetic and decisions.
#[test]
fn statics_in_lanes_are_those_of_each_row() {
    let alone = outputs(&cantilevers().run(&Cantilever));
    assert!(alone[0][1] < -0.05, "the rod bends: {:?}", alone[0]);
    assert_eq!(outputs(&cantilevers().in_lanes().run(&Cantilever)), alone);
}

#[test]
fn motions_in_lanes_are_those_of_each_row() {
    fn check<S>(scheme: S)
    where
        Pendulum<S>: Experiment<2>,
    {
        let sweep = Sweep::grid([&[1e7, 2e7, 4e7], &[0.01, 0.011, 0.013]]).unwrap();
        let experiment = Pendulum(scheme);
        let alone = outputs(&sweep.run(&experiment));
        assert!(alone.iter().all(|tip| tip[1] < -0.005), "the rods fall");
        assert_eq!(outputs(&sweep.in_lanes().run(&experiment)), alone);
    }
    check(Newmark::trapezoidal());
    check(EnergyMomentum::conserving());
}

/// What parts is run alone, with the same result: that lanes stay together is a claim of its own.
fn check_together<const P: usize>(
    experiment: &impl Experiment<P>,
    row: impl Fn(usize) -> [f64; P],
) {
    let pack = std::array::from_fn(|k| f64::pack(|lane| row(lane)[k]));
    let packed = together(|| experiment.run(pack)).expect("the lanes part");
    let packed = packed.unwrap();
    for lane in 0..8 {
        let own: Vec<_> = packed.iter().map(|x| f64::unpack(*x, lane)).collect();
        assert_eq!(own, experiment.run(row(lane)).unwrap());
    }
}

/// Rows of which one has a symmetric section couple other products than the rest: they part.
#[test]
fn rows_of_other_symmetry_are_those_of_each_row() {
    let sweep = Sweep::grid([&[0.0, 2e-3, 4e-3, 0.0, 8e-3][..], &[1.0], &[0.0]]).unwrap();
    let alone = outputs(&sweep.run(&Bracket));
    assert_eq!(outputs(&sweep.in_lanes().run(&Bracket)), alone);
}

#[test]
fn lengths_and_directions_stay_together_in_lanes() {
    check_together(&Bracket, |lane| {
        [1e-3, 1.0 + 0.02 * lane as f64, 0.1 + 0.05 * lane as f64]
    });
}

#[test]
fn motions_stay_together_in_lanes() {
    let row = |lane: usize| {
        [
            1e7 * (1.0 + 0.1 * lane as f64),
            0.01 * (1.0 + 0.05 * lane as f64),
        ]
    };
    check_together(&Pendulum(Newmark::trapezoidal()), row);
}

/// Solves that end where rounding leaves a residual, by unsymmetric tangents with pivots to choose, after
/// as many iterations as each lane takes.
#[test]
fn conserving_motions_stay_together_in_lanes() {
    let row = |lane: usize| {
        let by = |share: f64| 1.0 + share * lane as f64;
        [1e7 * by(0.3), 0.01 * by(0.05)]
    };
    let conserving = EnergyMomentum::conserving();
    let newton = Newton {
        refresh: Refresh::EverySolve,
        ..conserving.newton
    };
    check_together(&Pendulum(conserving.with_newton(newton)), row);
}

/// Lanes that need fewer of Newton's iterations wait for the others.
#[test]
fn statics_stay_together_in_lanes() {
    let row = |lane: usize| {
        let by = |share: f64| 1.0 + share * lane as f64;
        [1e7 * by(0.05), 0.01 * by(0.02), 0.05 * by(0.1)]
    };
    let iterations: Vec<_> = (0..8).map(|lane| bent(row(lane)).unwrap().1).collect();
    let differ = iterations.iter().any(|other| *other != iterations[0]);
    assert!(differ, "no lane waits: {iterations:?}");
    check_together(&Cantilever, row);
}

/// Forms of packs are in registers there, too; all round as plain numbers do.
#[test]
fn elements_with_kernels_of_their_own_stay_together_in_lanes() {
    let row = |lane: usize| {
        let by = |share: f64| 1.0 + share * lane as f64;
        [1e7 * by(0.05), 0.02 * by(0.02), 0.5 * by(0.1)]
    };
    check_together(&Arch::<false>, row);
    check_together(&Arch::<true>, row);
}

#[test]
fn an_error_stays_with_its_row() {
    let mut list: Vec<_> = cantilevers()
        .run(&Cantilever)
        .rows()
        .iter()
        .map(|row| row.parameters)
        .collect();
    let alone = outputs(&Sweep::list(list.clone()).unwrap().run(&Cantilever));
    list[2][0] = -1.0;
    list[5][2] = f64::NAN;
    let results = Sweep::list(list).unwrap().in_lanes().run(&Cantilever);
    for Row { index, outputs, .. } in results.rows() {
        match (index, outputs) {
            (2, Err(Error::NotPositive { value, .. })) => assert_eq!(*value, -1.0),
            (5, Err(error)) => assert!(error.to_string().contains("NaN"), "{error}"),
            (_, Ok(outputs)) => assert_eq!(outputs, &alone[*index]),
            (_, Err(error)) => panic!("row {index}: {error}"),
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same() {
    let one = outputs(&cantilevers().in_lanes().run(&Cantilever));
    for threads in 2..=4 {
        for sweep in [cantilevers(), cantilevers().in_lanes()] {
            let sweep = sweep.on_threads(threads).unwrap();
            assert_eq!(outputs(&sweep.run(&Cantilever)), one, "{threads} threads");
        }
    }
}

#[test]
fn shards_merge_to_the_whole_and_nothing_else_does() {
    let names = ["E", "R", "F", "x", "y", "z"];
    let table = |sweep: Sweep<f64, 3>| {
        let results = sweep.in_lanes().run(&Cantilever);
        results.table("cantilever", &names).unwrap()
    };
    let whole = table(cantilevers());
    let part = |n: usize| table(cantilevers().shard(n, 5).unwrap());
    let mut parts: Vec<_> = (0..5).rev().map(part).collect();
    assert_eq!(merge(&parts).unwrap(), whole);
    assert_eq!(merge(&[&whole]).unwrap(), whole);

    let refused = |tables: &[String], why: &str| {
        let error = merge(tables).unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    };
    refused(&parts[1..], "missing");
    refused(&[&parts[..], &parts[..1]].concat(), "twice");
    refused(&[], "no table");
    let other = Sweep::grid([&[1e7, 2e7, 3e7], &[0.01, 0.03], &[0.05, 0.1]]).unwrap();
    parts[2] = table(other.shard(2, 5).unwrap());
    refused(&parts, "another sweep");
}

#[test]
fn sweeps_refuse_what_is_none() {
    assert!(matches!(
        Sweep::<f64, 1>::grid([&[]]),
        Err(Error::TooFew { .. })
    ));
    assert!(matches!(
        cantilevers().on_threads(0),
        Err(Error::TooFew { .. })
    ));
    for (index, count) in [(0, 0), (3, 3)] {
        assert!(matches!(
            cantilevers().shard(index, count),
            Err(Error::OutOfRange { .. })
        ));
    }
    let results = cantilevers().run(&Cantilever);
    assert!(matches!(
        results.table("", &["E"]),
        Err(Error::Length { .. })
    ));
}

/// Against central differences, whose own error is about 1e-9 of the slope here.
#[test]
fn derivatives_are_those_of_the_experiment() {
    let at = [2e-3, 1.1, 0.2];
    let exact = derivatives(&Bracket, at).unwrap();
    for k in 0..3 {
        let moved = |by: f64| {
            let mut at = at;
            at[k] *= 1.0 + by;
            Bracket.run(at).unwrap()
        };
        let (up, down) = (moved(1e-4), moved(-1e-4));
        for (i, (_, slope)) in exact.iter().enumerate() {
            let difference = (up[i] - down[i]) / (2e-4 * at[k]);
            assert!((difference - slope[k]).abs() < 1e-6 * slope[k].abs());
        }
    }
}
