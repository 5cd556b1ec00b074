//! Reference curves that do not come from this library: a geometrically exact rod and the
//! section-linear continuum solved to about ten digits with high-order elements, see the headers
//! of the files in `data/`.

use std::error::Error;

/// Tip position over time, sampled every 0.01 s.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Rows of time (s), x and y of the tip (m).
    pub rows: Vec<[f64; 3]>,
}

impl Curve {
    fn parse(text: &str) -> Result<Self, Box<dyn Error>> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record?;
            let mut row = [0.0; 3];
            for (value, text) in row.iter_mut().zip(&record) {
                *value = text.parse()?;
            }
            rows.push(row);
        }
        Ok(Self { rows })
    }

    /// Position at a time that the file lists (s).
    pub fn at(&self, time: f64) -> Option<[f64; 2]> {
        let row = self.rows.iter().find(|row| (row[0] - time).abs() < 1e-9)?;
        Some([row[1], row[2]])
    }

    /// Pairs of time and x (m).
    pub fn x(&self) -> Vec<[f64; 2]> {
        self.rows.iter().map(|r| [r[0], r[1]]).collect()
    }

    /// Pairs of time and y (m).
    pub fn y(&self) -> Vec<[f64; 2]> {
        self.rows.iter().map(|r| [r[0], r[2]]).collect()
    }
}

/// All reference curves.
#[derive(Debug, Clone)]
pub struct References {
    /// Pendulum: section-linear continuum, zero Poisson ratio.
    pub pendulum_limit: Curve,
    /// Pendulum: geometrically exact rod, Poisson ratio 0.3.
    pub pendulum_rod: Curve,
    /// Ramp: section-linear continuum, zero Poisson ratio.
    pub ramp_limit: Curve,
    /// Ramp: section-linear continuum with full elasticity at 0.3, which locks.
    pub ramp_locked: Curve,
    /// Ramp: geometrically exact rod, Poisson ratio 0.3.
    pub ramp_rod: Curve,
}

impl References {
    /// Reads the files compiled into the program.
    ///
    /// # Errors
    /// When a file is not what it should be.
    pub fn load() -> Result<Self, Box<dyn Error>> {
        Ok(Self {
            pendulum_limit: Curve::parse(include_str!("data/pendulum_ancf_limit_nu0.csv"))?,
            pendulum_rod: Curve::parse(include_str!("data/pendulum_rod_nu03.csv"))?,
            ramp_limit: Curve::parse(include_str!("data/ramp_ancf_limit_nu0.csv"))?,
            ramp_locked: Curve::parse(include_str!("data/ramp_ancf_limit_nu03_locked.csv"))?,
            ramp_rod: Curve::parse(include_str!("data/ramp_rod_nu03.csv"))?,
        })
    }
}
