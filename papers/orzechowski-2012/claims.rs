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
    /// Nothing: the figure is only reported.
    Nothing,
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

    /// A figure that is printed and not checked: it depends on rounding, so that no range would be
    /// right for every machine.
    pub fn reported(
        section: &'static str,
        statement: impl Into<String>,
        paper: impl Into<String>,
        measured: (f64, &'static str),
    ) -> Self {
        Self {
            expected: Expected::Nothing,
            ..Self::holds(
                section,
                statement,
                paper,
                measured,
                f64::NEG_INFINITY..=f64::INFINITY,
            )
        }
    }

    /// Whether there is an expectation to meet.
    pub fn checked(&self) -> bool {
        self.expected != Expected::Nothing
    }

    /// Whether the measurement is what was expected; always so when nothing was.
    pub fn passed(&self) -> bool {
        !self.checked() || self.range.contains(&self.measured)
    }

    fn verdict(&self) -> &'static str {
        match (self.passed(), self.expected) {
            (false, _) => "FAIL",
            (true, Expected::True) => "holds",
            (true, Expected::False(_)) => "does not hold",
            (true, Expected::Nothing) => "reported",
        }
    }

    /// Why a claim that does not hold was expected not to; empty otherwise.
    fn reason(&self) -> &'static str {
        match (self.passed(), self.expected) {
            (true, Expected::False(reason)) => reason,
            _ => "",
        }
    }

    /// The cells of the table.
    pub fn cells(&self) -> [String; 7] {
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
                _ if !self.checked() => "-".into(),
                (f64::NEG_INFINITY, end) => format!("at most {}", number(end)),
                (start, f64::INFINITY) => format!("at least {}", number(start)),
                (start, end) => format!("{} to {}", number(start), number(end)),
            },
            self.verdict().into(),
            self.reason().into(),
        ]
    }
}

/// Headings of the columns.
pub const HEADINGS: [&str; 7] = [
    "", "claim", "paper", "ours", "expected", "verdict", "reason",
];

/// Characters per line of the table.
const WIDTH: usize = 120;

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

/// Words on lines of at most `width` characters.
fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("there is always a line");
        if line.is_empty() {
            line.push_str(word);
        } else if line.chars().count() + 1 + word.chars().count() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.into());
        }
    }
    lines
}

/// The table as text: figures beside the first line of each claim, reasons on lines of their own.
pub fn table(claims: &[Claim]) -> String {
    let mut rows = vec![HEADINGS.map(String::from)];
    rows[0][6].clear();
    rows.extend(claims.iter().map(Claim::cells));
    let widest = |c: usize| rows.iter().map(|r| r[c].chars().count()).max().unwrap_or(0);
    let mut widths: [usize; 6] = std::array::from_fn(widest);
    // Claims take what the other columns leave, with two blanks between columns.
    let others: usize = widths.iter().sum::<usize>() - widths[1];
    widths[1] = WIDTH.saturating_sub(others + 10).max(24);
    let indent = " ".repeat(widths[0] + 2);
    let mut text = String::new();
    for row in &rows {
        let lines = wrap(&row[1], widths[1]);
        let mut first = String::new();
        for (c, width) in widths.into_iter().enumerate() {
            let cell = if c == 1 { &lines[0] } else { &row[c] };
            first += &format!("{cell:<width$}  ");
        }
        text += first.trim_end();
        text.push('\n');
        for line in &lines[1..] {
            text += &format!("{indent}{line}\n");
        }
        if !row[6].is_empty() {
            for line in wrap(&format!("(as expected: {})", row[6]), WIDTH - indent.len()) {
                text += &format!("{indent}{line}\n");
            }
        }
    }
    text
}
