//! Reads changes as users write them: `mirror`, `platform=SPEC`, `NAME=NUMBER,NUMBER`.

use super::{Change, DoseKind, PLATFORM_CHANGE_NAME, WholeChange};

/// A text that names no change.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ChangeError {
    /// A name that no change has. [`Change::all_names`] lists the known ones.
    #[error("there is no change \"{name}\"; there are {}", Change::all_names().collect::<Vec<_>>().join(", "))]
    UnknownName {
        /// The name.
        name: String,
    },
    /// A change that needs a dose was written without one.
    #[error("{} needs a number between {} and {} {}, as in {}={}", .0.name(), .0.value_range().0, .0.value_range().1, .0.unit(), .0.name(), .0.example_values())]
    NoDose(DoseKind),
    /// A change without a dose was written with one.
    #[error("{} has no number, and {given:?} was given: write just {}", change.name(), change.name())]
    NeedlessDose {
        /// The change.
        change: WholeChange,
        /// The dose that was given.
        given: String,
    },
    /// A dose is not a number.
    #[error("{}: {text:?} is not a number; give numbers between {} and {} {}, as in {}={}", dose.name(), dose.value_range().0, dose.value_range().1, dose.unit(), dose.name(), dose.example_values())]
    NotANumber {
        /// The kind of the dose.
        dose: DoseKind,
        /// The text that was given.
        text: String,
    },
    /// A number that is too small or too large.
    #[error("{}: {value} is not between {} and {} {}; give numbers as in {}={}", dose.name(), dose.value_range().0, dose.value_range().1, dose.unit(), dose.name(), dose.example_values())]
    OutOfRange {
        /// The kind of the dose.
        dose: DoseKind,
        /// The number.
        value: f64,
    },
    /// A number with a fraction, where only whole ones have a meaning.
    #[error("{}: {value} is not a whole number; give numbers as in {}={}", dose.name(), dose.name(), dose.example_values())]
    NotWhole {
        /// The kind of the dose.
        dose: DoseKind,
        /// The number.
        value: f64,
    },
    /// The same number twice.
    #[error("{}: {value} is given twice; leave one out", dose.name())]
    Twice {
        /// The kind of the dose.
        dose: DoseKind,
        /// The number.
        value: f64,
    },
    /// Another platform without its name.
    #[error("platform needs a name, as in platform=habitat or platform=habitat:/data/scenes")]
    NoPlatform,
    /// Several changes where there is room for one.
    #[error("{text:?} is {count} changes where one was expected: give one number")]
    Several {
        /// The text that was given.
        text: String,
        /// How many changes it is.
        count: usize,
    },
}

impl Change {
    /// Reads one or more changes of one name: `mirror`, `platform=NAME[:DATA][@ADDRESS]`,
    /// `camera_height_m=0.3,0.88,1.6`. Blanks around names and numbers do not count.
    ///
    /// # Errors
    /// When the change is unknown, or a number is missing, superfluous, malformed, out of range or given twice.
    pub fn parse_list(text: &str) -> Result<Vec<Self>, ChangeError> {
        let (name, given) = match text.split_once('=') {
            Some((name, given)) => (name.trim(), Some(given.trim())),
            None => (text.trim(), None),
        };
        if name == PLATFORM_CHANGE_NAME {
            let spec = given.filter(|spec| !spec.is_empty() && !spec.starts_with([':', '@']));
            return Ok(vec![Self::Platform(spec.ok_or(ChangeError::NoPlatform)?.to_owned())]);
        }
        if let Some(change) = WholeChange::ALL.into_iter().find(|whole| whole.name() == name) {
            return match given {
                None => Ok(vec![Self::Whole(change)]),
                Some(given) => Err(ChangeError::NeedlessDose { change, given: given.to_owned() }),
            };
        }
        let dose = DoseKind::ALL.into_iter().find(|dose| dose.name() == name);
        let dose = dose.ok_or_else(|| ChangeError::UnknownName { name: name.to_owned() })?;
        let values = parse_values(dose, given.filter(|given| !given.is_empty()).ok_or(ChangeError::NoDose(dose))?)?;
        Ok(values.into_iter().map(|value| Self::By(dose, value)).collect())
    }
}

/// The numbers of a list, in its order.
fn parse_values(dose: DoseKind, list: &str) -> Result<Vec<f64>, ChangeError> {
    let mut values = Vec::new();
    for text in list.split(',').map(str::trim) {
        let value: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite());
        // The sum makes a plain zero of a negative one, which would be written differently.
        let value = value.ok_or_else(|| ChangeError::NotANumber { dose, text: text.to_owned() })? + 0.0;
        let (low, high) = dose.value_range();
        if !(low..=high).contains(&value) {
            return Err(ChangeError::OutOfRange { dose, value });
        }
        if dose.is_whole() && value.fract() != 0.0 {
            return Err(ChangeError::NotWhole { dose, value });
        }
        if values.contains(&value) {
            return Err(ChangeError::Twice { dose, value });
        }
        values.push(value);
    }
    Ok(values)
}
