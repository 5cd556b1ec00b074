//! Results as text: comma-separated values under a line that says which sweep they belong to, so
//! that the tables of shards can be merged, and others cannot.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::Results;
use crate::error::{Error, Result};
use crate::scalar::Real;

/// A number that changes with any digit of the parameters and with their order (FNV-1a).
pub(super) fn fingerprint<R: Real>(parameters: &[R]) -> u64 {
    let bytes = parameters
        .iter()
        .flat_map(|x| x.value().to_bits().to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

impl<R: Real, const P: usize> Results<R, P> {
    /// The results as a table: a line on the sweep, one of `names` (of the experiment, of its
    /// parameters and of its outputs), and one for each row, numbers with all their digits. A row
    /// that failed has no outputs, and its error in the last column.
    ///
    /// # Errors
    /// [`Error::Length`] unless there is a name for every parameter and output.
    pub fn table(&self, experiment: &str, names: &[&str]) -> Result<String> {
        let mut text = format!(
            "# {experiment}: {} rows, {:016x}\nrow,{},error\n",
            self.total,
            self.fingerprint,
            names.join(",")
        );
        for row in &self.rows {
            let mut cells = vec![row.index.to_string()];
            cells.extend(row.parameters.iter().map(|x| format!("{:e}", x.value())));
            match &row.outputs {
                Ok(outputs) => {
                    Error::check_length("number of names", names.len(), P + outputs.len())?;
                    cells.extend(outputs.iter().map(|x| format!("{:e}", x.value())));
                    cells.push(String::new());
                }
                Err(error) => {
                    cells.resize(1 + names.len().max(P), String::new());
                    let message = error.to_string().replace('\n', " ").replace('"', "\"\"");
                    cells.push(format!("\"{message}\""));
                }
            }
            // Writing to a string does not fail.
            let _ = writeln!(text, "{}", cells.join(","));
        }
        Ok(text)
    }
}

/// Merges the [tables](Results::table) of all shards of one sweep, in any order, into that of the
/// whole sweep, byte for byte.
///
/// # Errors
/// [`Error::Unsupported`] for tables of different sweeps, and for rows that are missing, given
/// twice or not of the sweep.
pub fn merge<T: AsRef<str>>(tables: &[T]) -> Result<String> {
    let fault = |what: String| Error::Unsupported {
        what,
        remedy: "merge every shard of one sweep, each once, as the same program wrote them",
    };
    let mut head = None;
    let mut rows = BTreeMap::new();
    for (n, table) in tables.iter().enumerate() {
        let mut lines = table.as_ref().lines();
        let own = [lines.next(), lines.next()];
        if *head.get_or_insert(own) != own {
            return Err(fault(format!("table {n} is of another sweep than table 0")));
        }
        for line in lines {
            let index = line.split(',').next().and_then(|cell| cell.parse().ok());
            let Some(index): Option<usize> = index else {
                return Err(fault(format!(
                    "table {n} has the line {line:?}, which is no row"
                )));
            };
            if rows.insert(index, line).is_some() {
                return Err(fault(format!(
                    "row {index} is given twice, again in table {n}"
                )));
            }
        }
    }
    let Some([Some(first), Some(second)]) = head else {
        return Err(fault("no table with a heading".into()));
    };
    let count = first
        .rsplit_once(": ")
        .and_then(|(_, rest)| rest.split_once(" rows, "));
    let Some(total) = count.and_then(|(count, _)| count.parse::<usize>().ok()) else {
        return Err(fault(format!(
            "the heading {first:?} is not that of a sweep"
        )));
    };
    if let Some(missing) = (0..total).find(|index| !rows.contains_key(index)) {
        return Err(fault(format!("row {missing} of {total} is missing")));
    }
    if let Some((beyond, _)) = rows.range(total..).next() {
        return Err(fault(format!(
            "row {beyond} is beyond the {total} of the sweep"
        )));
    }
    let mut text = format!("{first}\n{second}\n");
    for line in rows.values() {
        let _ = writeln!(text, "{line}");
    }
    Ok(text)
}
