//! Numbers that people write down, and what they may be.

/// Numbers from the first to the second.
#[derive(Clone, Copy)]
pub enum Range {
    /// With both ends.
    From(f64, f64),
    /// Without the first.
    Above(f64, f64),
}

impl Range {
    /// What the number must be, and what it is, where it is outside.
    ///
    /// # Errors
    /// What the number must be, and what it is.
    pub fn check(self, x: f64) -> Result<(), String> {
        let (inside, words) = match self {
            Self::From(low, high) => (low <= x && x <= high, format!("from {low} to {high}")),
            Self::Above(low, f64::INFINITY) => (low < x, format!("above {low}")),
            Self::Above(low, high) => (
                low < x && x <= high,
                format!("above {low} and up to {high}"),
            ),
        };
        if inside {
            return Ok(());
        }
        let finite = if x.is_finite() { "" } else { "finite and " };
        Err(format!("must be {finite}{words}, not {x:?}"))
    }

    /// The same for each of some numbers.
    ///
    /// # Errors
    /// Those of the first that is outside.
    pub fn check_all<'a>(self, all: impl IntoIterator<Item = &'a f64>) -> Result<(), String> {
        all.into_iter().try_for_each(|x| self.check(*x))
    }
}

/// A value of a file that cannot be: `(key, what it must be)`.
pub(crate) type Unusable = (String, String);

/// Fails with the key where a value does not meet its condition.
pub(crate) fn require(ok: bool, key: &str, what: &str) -> Result<(), Unusable> {
    if ok {
        Ok(())
    } else {
        Err((key.to_owned(), what.to_owned()))
    }
}

/// Fails with the key where a value is out of its range.
pub(crate) fn within(x: f64, range: Range, key: &str) -> Result<(), Unusable> {
    range.check(x).map_err(|what| (key.to_owned(), what))
}

#[cfg(test)]
mod tests {
    use super::Range::{Above, From};

    #[test]
    fn both_ends_and_what_is_no_number() {
        assert!(From(0.0, 1.0).check_all(&[0.0, 1.0]).is_ok());
        assert!(Above(0.0, 1.0).check(0.0).is_err() && Above(0.0, 1.0).check(1.0).is_ok());
        let told = From(-1.0, 1.0).check(f64::NAN);
        assert_eq!(
            told,
            Err("must be finite and from -1 to 1, not NaN".to_owned())
        );
        assert_eq!(
            Above(0.0, 1.0).check(2.0),
            Err("must be above 0 and up to 1, not 2.0".to_owned())
        );
        assert_eq!(
            Above(0.0, f64::INFINITY).check(-1.0),
            Err("must be above 0, not -1.0".to_owned())
        );
        assert!(Above(0.0, f64::INFINITY).check(f64::INFINITY).is_ok());
    }
}
