//! What a check returns: rows of measured values beside the limits theory sets them.

use std::fmt;

use crate::error::{Error, Result};

/// What a measured value must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// At most this: errors and counts.
    AtMost(f64),
    /// At least this.
    AtLeast(f64),
    /// Above this.
    Above(f64),
    /// Anything: the row informs and cannot fail.
    None,
    /// Nothing to check: the type leaves this derivative to dual numbers, which the check would compare
    /// with themselves. Told by agreement to the last bit in every state tried, which closed forms
    /// of the same operations have, too: the constant elasticity of a linear law.
    Derived,
}

impl Limit {
    /// Whether `value` keeps to the limit; NaN keeps to none that there is.
    #[must_use]
    pub fn allows(self, value: f64) -> bool {
        match self {
            Self::AtMost(limit) => value <= limit,
            Self::AtLeast(limit) => value >= limit,
            Self::Above(limit) => value > limit,
            Self::None | Self::Derived => true,
        }
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::AtMost(limit) => format!("<= {}", number(*limit)),
            Self::AtLeast(limit) => format!(">= {}", number(*limit)),
            Self::Above(limit) => format!("> {}", number(*limit)),
            Self::None => "-".into(),
            Self::Derived => "derived".into(),
        };
        f.pad(&text)
    }
}

/// Whole numbers as such, others with three digits.
fn number(x: f64) -> String {
    if x.fract() == 0.0 && x.abs() < 1e4 {
        format!("{x:.0}")
    } else if (0.1..1e4).contains(&x.abs()) {
        format!("{x:.5}")
    } else {
        format!("{x:.2e}")
    }
}

/// One line of a report.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was checked.
    pub check: &'static str,
    /// In which case: a direction, an order, a degree; may be empty.
    pub case: String,
    /// What was measured; errors are relative unless the check says otherwise.
    pub value: f64,
    /// What it must be.
    pub limit: Limit,
}

impl Row {
    /// Whether the row can fail.
    #[must_use]
    pub fn demands(&self) -> bool {
        !matches!(self.limit, Limit::None | Limit::Derived)
    }

    /// Whether the value keeps to its limit.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.limit.allows(self.value)
    }
}

/// The outcome of a check; prints as a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    subject: String,
    rows: Vec<Row>,
}

impl Report {
    /// An empty report on `subject`.
    #[must_use]
    pub fn new(subject: impl Into<String>) -> Self {
        Self {
            subject: subject.into(),
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    pub fn push(&mut self, check: &'static str, case: impl Into<String>, value: f64, limit: Limit) {
        self.rows.push(Row {
            check,
            case: case.into(),
            value,
            limit,
        });
    }

    /// Adds the error of a derivative that a type may give in closed form, against dual numbers.
    pub(super) fn push_derivative(
        &mut self,
        check: &'static str,
        case: impl Into<String>,
        error: f64,
        limit: f64,
    ) {
        let limit = match error {
            0.0 => Limit::Derived,
            _ => Limit::AtMost(limit),
        };
        self.push(check, case, error, limit);
    }

    /// What was examined.
    #[must_use]
    pub fn subject(&self) -> &str {
        &self.subject
    }

    /// Every row, in the order of the checks.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The rows that did not keep to their limit.
    pub fn failed(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| !row.passed())
    }

    /// Whether every row passed.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.failed().next().is_none()
    }

    /// This report followed by the rows of another.
    #[must_use]
    pub fn and(mut self, other: Self) -> Self {
        let known = |subject| self.subject.split("; ").any(|own| own == subject);
        let new: Vec<_> = other.subject.split("; ").filter(|s| !known(*s)).collect();
        if !new.is_empty() {
            self.subject = format!("{}; {}", self.subject, new.join("; "));
        }
        self.rows.extend(other.rows);
        self
    }

    /// The report itself if every row passed: what a test ends with.
    ///
    /// # Errors
    /// [`Error::CheckFailed`] with every failed row, its value and its limit.
    pub fn into_result(self) -> Result<Self> {
        if self.passed() {
            return Ok(self);
        }
        let rows: Vec<String> = self
            .failed()
            .map(|row| {
                let case = if row.case.is_empty() {
                    String::new()
                } else {
                    format!(" ({})", row.case)
                };
                let Row {
                    check,
                    value,
                    limit,
                    ..
                } = row;
                format!("{check}{case} is {}, must be {limit}", number(*value))
            })
            .collect();
        Err(Error::CheckFailed {
            subject: self.subject,
            rows: rows.join("; "),
        })
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widest = |text: fn(&Row) -> usize, title: &str| {
            self.rows
                .iter()
                .map(text)
                .max()
                .unwrap_or(0)
                .max(title.len())
        };
        let check = widest(|row| row.check.chars().count(), "check");
        let case = widest(|row| row.case.chars().count(), "case");
        writeln!(f, "{}", self.subject)?;
        let [c, k, m, l] = ["check", "case", "measured", "limit"];
        writeln!(f, "  {c:check$}  {k:case$}  {m:>10}  {l:>12}")?;
        for row in &self.rows {
            let value = number(row.value);
            let verdict = match (row.demands(), row.passed()) {
                (false, _) => "",
                (true, true) => "  passed",
                (true, false) => "  FAILED",
            };
            writeln!(
                f,
                "  {:check$}  {:case$}  {value:>10}  {:>12}{verdict}",
                row.check, row.case, row.limit
            )?;
        }
        let failed = self.failed().count();
        let bound = self.rows.iter().filter(|row| row.demands()).count();
        write!(f, "  {} of {bound} checks passed", bound - failed)?;
        let derived = self.rows.iter().filter(|r| r.limit == Limit::Derived);
        match derived.count() {
            0 => Ok(()),
            n => write!(f, ", {n} left out: equal to dual numbers' to the last bit"),
        }
    }
}
