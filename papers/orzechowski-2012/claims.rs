//! The table of claims: what the paper says, what was measured, and the range the measurement
//! must lie in. A claim of the paper that is not true has its refutation as the check, so that
//! the program fails when either the library or this account of the paper is wrong.

use std::ops::RangeInclusive;

/// What a claim is expected to turn out as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Expected {
    /// The paper, or the theory quoted, is right.
    True,
    /// The paper is not right, for this reason.
    False(&'static str),
}

/// One line of the table.
#[derive(Debug, Clone)]
pub struct Claim {
    section: &'static str,
    statement: String,
    paper: String,
    measured: f64,
    unit: &'static str,
    range: RangeInclusive<f64>,
    expected: Expected,
}

impl Claim {
    /// A claim that holds when `measured` lies in `range`.
    pub fn holds(
        section: &'static str,
        statement: impl Into<String>,
        paper: impl Into<String>,
        (measured, unit): (f64, &'static str),
        range: RangeInclusive<f64>,
    ) -> Self {
        Self {
            section,
            statement: statement.into(),
            paper: paper.into(),
            measured,
            unit,
            range,
            expected: Expected::True,
        }
    }

    /// A claim that is wrong for `reason`, which `measured` shows by lying in `range`.
    pub fn refuted(
        section: &'static str,
        statement: impl Into<String>,
        paper: impl Into<String>,
        measured: (f64, &'static str),
        range: RangeInclusive<f64>,
        reason: &'static str,
    ) -> Self {
        Self {
            expected: Expected::False(reason),
            ..Self::holds(section, statement, paper, measured, range)
        }
    }

    /// A figure that must agree with `figure` within `tolerance`.
    pub fn close(
        section: &'static str,
        statement: impl Into<String>,
        paper: impl Into<String>,
        measured: (f64, &'static str),
        figure: f64,
        tolerance: f64,
    ) -> Self {
        let range = figure - tolerance..=figure + tolerance;
        Self::holds(section, statement, paper, measured, range)
    }

    /// Whether the measurement is what was expected.
    pub fn passed(&self) -> bool {
        self.range.contains(&self.measured)
    }

    fn verdict(&self) -> String {
        match (self.passed(), self.expected) {
            (false, _) => "FAIL".into(),
            (true, Expected::True) => "holds".into(),
            (true, Expected::False(reason)) => format!("does not hold (as expected: {reason})"),
        }
    }

    /// The cells of the table.
    pub fn cells(&self) -> [String; 6] {
        let unit = match self.unit {
            "" => String::new(),
            unit => format!(" {unit}"),
        };
        [
            self.section.into(),
            self.statement.clone(),
            self.paper.clone(),
            format!("{}{unit}", number(self.measured)),
            match (*self.range.start(), *self.range.end()) {
                (f64::NEG_INFINITY, end) => format!("at most {}", number(end)),
                (start, f64::INFINITY) => format!("at least {}", number(start)),
                (start, end) => format!("{} to {}", number(start), number(end)),
            },
            self.verdict(),
        ]
    }
}

/// Headings of the columns.
pub const HEADINGS: [&str; 6] = ["", "claim", "paper", "ours", "expected", "verdict"];

/// A number with as many digits as the table needs.
pub fn number(x: f64) -> String {
    let size = x.abs();
    if x.is_nan() {
        "none".into()
    } else if x.fract() == 0.0 && size < 1e6 {
        format!("{x:.0}")
    } else if (1e-2..1e5).contains(&size) {
        let digits = (5 - size.log10().floor() as i32).clamp(0, 6) as usize;
        let text = format!("{x:.digits$}");
        text.trim_end_matches('0').trim_end_matches('.').into()
    } else {
        format!("{x:.2e}")
    }
}

/// The table as text, one claim per line.
pub fn table(claims: &[Claim]) -> String {
    let mut rows = vec![HEADINGS.map(String::from)];
    rows.extend(claims.iter().map(Claim::cells));
    let width = |c: usize| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0);
    let widths: [usize; 5] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        for (cell, width) in row.iter().zip(widths) {
            text += &format!("{cell:<width$}  ");
        }
        text += &row[5];
        text.push('\n');
    }
    text
}
