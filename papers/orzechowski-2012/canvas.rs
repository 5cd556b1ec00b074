//! Geometry of the plots that needs no canvas: tick values, clipping to a panel, dashes.

use super::{Axis, Scale};

/// Values to label on an axis, with their labels.
pub fn ticks(axis: &Axis) -> Vec<(f64, String)> {
    let [from, to] = axis.range;
    match axis.scale {
        Scale::Log => {
            let (first, last) = (from.log10().ceil() as i32, to.log10().floor() as i32);
            // Wide axes label every second or third decade, narrow ones 2 and 5 as well.
            let stride = (last - first) / 8 + 1;
            let factors: &[f64] = if last - first <= 2 {
                &[1.0, 2.0, 5.0]
            } else {
                &[1.0]
            };
            let values = (first - 1..=last).filter(|e| (e - first) % stride == 0);
            values
                .flat_map(|e| factors.iter().map(move |f| f * 10_f64.powi(e)))
                .filter(|v| (from * 0.999..=to * 1.001).contains(v))
                .map(|v| (v, label(v, v)))
                .collect()
        }
        Scale::Linear => {
            let rough = (to - from) / 6.0;
            let decade = 10_f64.powf(rough.log10().floor());
            let steps = [1.0, 2.0, 2.5, 5.0, 10.0];
            let step = steps.iter().map(|s| s * decade).find(|s| *s >= rough);
            let step = step.unwrap_or(10.0 * decade);
            let first = (from / step - 1e-9).ceil() as i64;
            let last = (to / step + 1e-9).floor() as i64;
            (first..=last)
                .map(|k| k as f64 * step)
                .map(|v| (v, label(v, step)))
                .collect()
        }
    }
}

fn label(value: f64, step: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e4).contains(&step.abs()) {
        return format!("{value:.0e}");
    }
    let digits = (2.0 - step.abs().log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        text
    }
}

/// The parts of a polyline inside a box given by left, top, right and bottom.
pub fn clip(points: &[[f64; 2]], within: [f64; 4]) -> Vec<Vec<[f64; 2]>> {
    let [left, top, right, bottom] = within;
    if let [[x, y]] = points {
        let inside = (left..=right).contains(x) && (top..=bottom).contains(y);
        return if inside {
            vec![points.to_vec()]
        } else {
            vec![]
        };
    }
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    for pair in points.windows(2) {
        let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        let mut outside = !(x0 + y0 + x1 + y1).is_finite();
        for (rate, room) in [
            (-dx, x0 - left),
            (dx, right - x0),
            (-dy, y0 - top),
            (dy, bottom - y0),
        ] {
            if rate == 0.0 {
                outside |= room < 0.0;
            } else if rate < 0.0 {
                enter = enter.max(room / rate);
            } else {
                leave = leave.min(room / rate);
            }
        }
        if outside || enter > leave {
            continue;
        }
        let at = |s: f64| [x0 + s * dx, y0 + s * dy];
        let from = at(enter);
        match pieces.last_mut() {
            Some(piece) if enter == 0.0 && piece.last() == Some(&from) => piece.push(at(leave)),
            _ => pieces.push(vec![from, at(leave)]),
        }
    }
    pieces
}

/// Dashes of a length and gap along a polyline.
pub fn dashes(points: &[[f64; 2]], length: f64, gap: f64) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = Vec::new();
    let Some(first) = points.first() else {
        return pieces;
    };
    let (mut on, mut left) = (true, length);
    let mut piece = vec![*first];
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        loop {
            let distance = (to[0] - from[0]).hypot(to[1] - from[1]);
            if distance < left {
                left -= distance;
                piece.push(to);
                break;
            }
            let share = left / distance;
            from = [
                from[0] + share * (to[0] - from[0]),
                from[1] + share * (to[1] - from[1]),
            ];
            piece.push(from);
            if on {
                pieces.push(std::mem::take(&mut piece));
            }
            piece = vec![from];
            on = !on;
            left = if on { length } else { gap };
        }
    }
    if on && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}
