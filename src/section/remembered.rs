//! A section that is asked for the same rules by every element of a beam.

use std::fmt::{self, Debug};
use std::sync::{Mutex, PoisonError};

use super::{Properties, Section};
use crate::error::Result;
use crate::quadrature::Cubature;
use crate::scalar::Real;

/// Results by degree, those that have been asked for.
struct Known<T>(Mutex<Vec<(usize, Result<T>)>>);

impl<T: Clone> Known<T> {
    fn new() -> Self {
        Self(Mutex::default())
    }

    fn of(&self, degree: usize, find: impl FnOnce() -> Result<T>) -> Result<T> {
        // A panic leaves what was known before; and nothing is locked while a section is at work.
        let all = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, result)) = all().iter().find(|(of, _)| *of == degree) {
            return result.clone();
        }
        let result = find();
        all().push((degree, result.clone()));
        result
    }
}

/// A section whose rules and properties are found once.
pub(crate) struct Remembered<'a, R> {
    section: &'a dyn Section<R>,
    rules: Known<Cubature<R, 2>>,
    planar: Known<Cubature<R, 1>>,
    properties: Known<Properties<R>>,
}

impl<'a, R: Real> Remembered<'a, R> {
    pub(crate) fn new(section: &'a dyn Section<R>) -> Self {
        Self {
            section,
            rules: Known::new(),
            planar: Known::new(),
            properties: Known::new(),
        }
    }
}

impl<R: Real> Debug for Remembered<'_, R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.section.fmt(f)
    }
}

impl<R: Real> Section<R> for Remembered<'_, R> {
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        self.rules.of(degree, || self.section.rule(degree))
    }
    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        self.section.outline(n)
    }
    fn properties(&self) -> Result<Properties<R>> {
        // The moments of degree two.
        self.properties.of(2, || self.section.properties())
    }
    fn planar_rule(&self, degree: usize) -> Result<Cubature<R, 1>> {
        self.planar.of(degree, || self.section.planar_rule(degree))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::error::Error;
    use crate::section::Disk;

    /// A disk that counts how often it is asked, and has no rule above degree 20.
    #[derive(Debug)]
    struct Asked(Disk<f64>, AtomicUsize);

    impl Section<f64> for Asked {
        fn rule(&self, degree: usize) -> Result<Cubature<f64, 2>> {
            self.1.fetch_add(1, Ordering::Relaxed);
            if degree > 20 {
                return Err(Error::Unsupported {
                    what: "a degree above 20".into(),
                    remedy: "ask for less",
                });
            }
            self.0.rule(degree)
        }
        fn outline(&self, n: usize) -> Vec<Vec<[f64; 2]>> {
            self.0.outline(n)
        }
    }

    #[test]
    fn a_section_is_asked_once_for_each_rule_and_answers_as_it_would_every_time() -> Result<()> {
        let asked = Asked(Disk::new(0.3)?, AtomicUsize::new(0));
        let remembered = Remembered::new(&asked);
        for _ in 0..3 {
            assert_eq!(remembered.rule(5)?, asked.0.rule(5)?);
            assert_eq!(remembered.rule(8)?, asked.0.rule(8)?);
            assert_eq!(remembered.planar_rule(5)?, asked.0.planar_rule(5)?);
            assert_eq!(remembered.properties()?, asked.0.properties()?);
            assert!(remembered.rule(21).is_err());
            assert!(remembered.planar_rule(22).is_err());
        }
        // Of them two for the planar rules, and one for the properties.
        assert_eq!(asked.1.load(Ordering::Relaxed), 6);
        Ok(())
    }
}
