//! Reads the tables of reference solutions.

/// Time and the numbers in some columns, up to a time; lines that do not begin with a number are
/// headings. References are part of the program: one that cannot be read is not.
pub fn rows<const N: usize>(text: &str, columns: [usize; N], end: f64) -> Vec<(f64, Vec<f64>)> {
    let line = |line: &str| {
        let cells: Vec<f64> = line
            .split(',')
            .map_while(|cell| cell.parse().ok())
            .collect();
        let time = *cells.first()?;
        let values: Option<Vec<f64>> = columns.iter().map(|c| cells.get(*c).copied()).collect();
        Some((time, values?))
    };
    let rows = text.lines().filter_map(line);
    rows.filter(|(time, _)| *time <= end + 1e-9).collect()
}
