//! Claims about outlines that are none: each is refused by an error that says what is wrong.

use ancf::prelude::*;

fn polygon(points: &[[f64; 2]]) -> Loop<f64> {
    Loop::polygon(points.iter().copied())
}

fn square(half: f64, [y, z]: [f64; 2]) -> Loop<f64> {
    polygon(&[
        [y - half, z - half],
        [y + half, z - half],
        [y + half, z + half],
        [y - half, z + half],
    ])
}

fn refused<T: std::fmt::Debug>(result: Result<T>) -> Error {
    let error = result.expect_err("must be refused");
    assert!(error.to_string().len() > 40, "{error}");
    error
}

#[test]
fn bad_outlines_are_refused() {
    let outline = |points: &[[f64; 2]]| refused(Outline::new(polygon(points)));
    let few = |error| matches!(error, Error::TooFew { value, .. } if value < 3);
    assert!(few(outline(&[])) && few(outline(&[[0.0, 0.0]])));
    assert!(few(outline(&[[0.0, 0.0], [1.0, 0.0]])));
    assert!(few(outline(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]])));
    assert!(few(refused(Outline::new(
        Loop::start([0.0, 0.0]).arc_to([0.0, 0.0], 1.0)
    ))));
    for bad in [f64::NAN, f64::INFINITY] {
        let error = outline(&[[0.0, 0.0], [1.0, bad], [0.0, 1.0]]);
        assert!(matches!(error, Error::NotFinite { .. }));
        let bulging = Loop::start([0.0, 0.0])
            .arc_to([1.0, 0.0], bad)
            .line_to([0.0, 1.0]);
        assert!(matches!(
            refused(Outline::new(bulging)),
            Error::NotFinite { .. }
        ));
    }
    assert!(matches!(
        refused(Outline::new(Loop::circle([0.0, 0.0], f64::NAN))),
        Error::NotFinite { .. }
    ));
    let flat = |error: Error| matches!(error, Error::NotPositive { .. });
    assert!(flat(outline(&[[0.0, 0.0], [0.1, 0.1], [0.3, 0.3]])));
    assert!(flat(outline(&[
        [0.0, 0.0],
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0]
    ])));
    assert!(flat(refused(Outline::new(Loop::circle([1.0, 0.0], 0.0)))));
    assert!(flat(refused(Outline::new(Loop::circle([0.0, 0.0], -1.0)))));
    let slit = Loop::start([0.0, 0.0])
        .arc_to([1.0, 0.0], 0.5)
        .arc_to([0.0, 0.0], -0.5);
    assert!(flat(refused(Outline::new(slit))));

    let meets = |error: Error, loops, edges| {
        assert!(
            matches!(&error, Error::EdgesMeet { loops: l, edges: e, .. } if *l == loops && *e == edges),
            "{error:?}"
        );
    };
    // A lopsided bow tie, a corner on an edge, an edge back along its neighbour, a corner
    // touched twice, and an arc through the edge after the next.
    meets(
        outline(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]]),
        [0, 0],
        [0, 2],
    );
    meets(
        outline(&[[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 0.0], [0.0, 2.0]]),
        [0, 0],
        [0, 2],
    );
    meets(
        outline(&[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]]),
        [0, 0],
        [0, 1],
    );
    meets(
        outline(&[
            [0.0, 0.0],
            [1.0, 1.0],
            [2.0, 0.0],
            [2.0, 2.0],
            [1.0, 1.0],
            [0.0, 2.0],
        ]),
        [0, 0],
        [0, 3],
    );
    let swollen = Loop::start([0.0, 0.0])
        .arc_to([1.0, 0.0], -1.0)
        .line_to([1.0, 0.2])
        .line_to([0.0, 0.2]);
    meets(refused(Outline::new(swollen)), [0, 0], [0, 2]);

    let plate = Outline::new(square(1.0, [0.0; 2])).unwrap();
    let holed = plate.clone().with_hole(square(0.25, [0.5, 0.5])).unwrap();
    let cut = |hole: Loop<f64>| refused(holed.clone().with_hole(hole));
    let where_to = |error, number: usize, word: &str| {
        assert!(
            matches!(error, Error::HoleMisplaced { hole, fault } if hole == number && fault.contains(word)),
            "{word}"
        );
    };
    where_to(cut(square(0.25, [3.0, 0.0])), 2, "outside");
    where_to(cut(square(2.0, [0.0, 0.0])), 2, "outside");
    where_to(cut(square(0.125, [0.5, 0.5])), 2, "within another");
    where_to(cut(Loop::circle([0.5, 0.5], 0.45)), 2, "around another");
    // Leaving, touching from inside by an edge, a corner or an arc, overlapping another hole.
    let across = |error: Error| matches!(error, Error::EdgesMeet { .. });
    assert!(across(cut(square(0.5, [1.0, 0.0]))));
    assert!(across(cut(square(0.25, [-0.75, 0.0]))));
    assert!(across(cut(polygon(&[
        [-1.0, 0.0],
        [0.0, 0.1],
        [0.0, -0.1]
    ]))));
    assert!(across(cut(Loop::circle([-0.5, -0.5], 0.5))));
    assert!(across(cut(square(0.25, [0.25, 0.25]))));
    assert!(across(cut(square(0.25, [0.5, 0.5]))));
    assert!(across(cut(Loop::circle([0.0, 0.0], 0.45))));
    // A circle within a circle that touches it, and the same with room.
    let round = Outline::new(Loop::circle([0.0, 0.0], 1.0)).unwrap();
    assert!(across(refused(
        round.clone().with_hole(Loop::circle([0.25, 0.0], 0.75))
    )));
    round.with_hole(Loop::circle([0.25, 0.0], 0.7499)).unwrap();

    assert!(matches!(
        refused(plate.rule(21)),
        Error::NoRule { degree: 21, .. }
    ));
    assert!(matches!(
        refused(plate.rule(usize::MAX)),
        Error::NoRule { .. }
    ));
    assert!(matches!(
        refused(plate.moment(usize::MAX, 2)),
        Error::Unsupported { .. }
    ));
    assert!(matches!(
        refused(plate.moved([0.0, f64::NAN])),
        Error::NotFinite { .. }
    ));
}

#[test]
fn walls_that_do_not_fit_are_refused() {
    for bad in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        for k in 0..4 {
            let mut d = [0.2, 0.1, 0.01, 0.006];
            d[k] = bad;
            assert!(matches!(
                refused(i_profile(d[0], d[1], d[2], d[3])),
                Error::NotPositive { .. }
            ));
            assert!(matches!(
                refused(c_profile(d[0], d[1], d[2], d[3])),
                Error::NotPositive { .. }
            ));
            assert!(matches!(
                refused(t_profile(d[0], d[1], d[2], d[3])),
                Error::NotPositive { .. }
            ));
            if k < 3 {
                assert!(matches!(
                    refused(l_profile(d[0], d[1], d[2])),
                    Error::NotPositive { .. }
                ));
                assert!(matches!(
                    refused(box_profile(d[0], d[1], d[2])),
                    Error::NotPositive { .. }
                ));
            }
        }
    }
    let thick = |e: Error| matches!(e, Error::OutOfRange { .. });
    assert!(thick(refused(i_profile(0.2, 0.1, 0.1, 0.006))));
    assert!(thick(refused(i_profile(0.2, 0.1, 0.01, 0.1))));
    assert!(thick(refused(c_profile(0.2, 0.1, 0.11, 0.006))));
    assert!(thick(refused(t_profile(0.2, 0.1, 0.2, 0.006))));
    assert!(thick(refused(l_profile(0.2, 0.1, 0.1))));
    assert!(thick(refused(box_profile(0.2, 0.1, 0.05))));
}
