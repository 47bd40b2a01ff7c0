//! The type [`Change`]: one change of a world, its pictures or its paths, with a dose if it has one.

mod dose;
mod parse;
mod refusal;
mod without_dose;

pub use dose::DoseKind;
pub use parse::ChangeError;
pub use refusal::{ChangeSetting, OtherPlatform, SightSource};
pub use without_dose::WholeChange;

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};
use wayword_core::seed::derive_seed;

/// The name of the change to another platform.
const PLATFORM_CHANGE_NAME: &str = "platform";

/// One change of a world, its pictures or its paths. Its text is `NAME`, `NAME=DOSE` or `platform=SPEC`, as
/// [`Change::parse_list`] reads it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Change {
    /// The same poses on another platform, as the user wrote it: `NAME[:DATA][@ADDRESS]`.
    Platform(String),
    /// A change without a dose.
    Whole(WholeChange),
    /// A change with a dose, in the dose's unit. [`Change::parse_list`] makes sure that the number is in the dose's range.
    By(DoseKind, f64),
}

impl Change {
    /// The names of all changes, in the order in which they are explained.
    pub fn all_names() -> impl Iterator<Item = &'static str> {
        let whole = WholeChange::ALL.into_iter().map(WholeChange::name);
        [PLATFORM_CHANGE_NAME].into_iter().chain(whole).chain(DoseKind::ALL.into_iter().map(DoseKind::name))
    }

    /// The changes that are made by default: Habitat's rendering of the house, mirror, turn, remove, three heights of the camera,
    /// three fields of view, three distances between frames, and three heading noises.
    #[must_use]
    pub fn default_set() -> Vec<Self> {
        let doses = [
            (DoseKind::CameraHeight, [0.3, 0.88, 1.6]),
            (DoseKind::FieldOfView, [60.0, 90.0, 120.0]),
            (DoseKind::FrameSpacing, [0.5, 1.0, 3.0]),
            (DoseKind::HeadingNoise, [5.0, 15.0, 45.0]),
        ];
        let whole = [WholeChange::Mirror, WholeChange::Turn, WholeChange::Remove].map(Self::Whole);
        let by = doses.into_iter().flat_map(|(dose, values)| values.map(|value| Self::By(dose, value)));
        [Self::Platform("habitat".to_owned())].into_iter().chain(whole).chain(by).collect()
    }

    /// Its name, without its dose: "`camera_height_m`".
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Platform(_) => PLATFORM_CHANGE_NAME,
            Self::Whole(whole) => whole.name(),
            Self::By(dose, _) => dose.name(),
        }
    }

    /// Its dose, in [`unit`](Self::unit).
    #[must_use]
    pub fn dose_value(&self) -> Option<f64> {
        match self {
            Self::By(_, value) => Some(*value),
            Self::Platform(_) | Self::Whole(_) => None,
        }
    }

    /// The unit of its dose: "m", "degrees", "%".
    #[must_use]
    pub fn unit(&self) -> Option<&'static str> {
        self.dose_kind().map(DoseKind::unit)
    }

    /// The dose that changes nothing; `None` for a change without a dose, and if no dose leaves every path unchanged.
    #[must_use]
    pub fn unchanged_dose(&self) -> Option<f64> {
        self.dose_kind().and_then(DoseKind::unchanged_value)
    }

    /// How strong the change is, from 0 to 1: the distance of the dose from [`unchanged_dose`](Self::unchanged_dose), divided by the
    /// distance of the end of the range on the same side.
    #[must_use]
    pub fn dose_strength(&self) -> Option<f64> {
        let Self::By(dose, value) = self else { return None };
        let (unchanged, (low, high)) = (dose.unchanged_value()?, dose.value_range());
        let end = if *value < unchanged { low } else { high };
        let reach = (end - unchanged).abs();
        Some(if reach > 0.0 { ((value - unchanged) / reach).abs().min(1.0) } else { 0.0 })
    }

    /// A name for its files and folders, unique among changes: "camera-height-m-0.3".
    #[must_use]
    pub fn id(&self) -> String {
        let name = self.name().replace('_', "-");
        match self {
            Self::Whole(_) => name,
            Self::By(_, value) if *value < 0.0 => format!("{name}-minus-{}", -value),
            Self::By(_, value) => format!("{name}-{value}"),
            Self::Platform(spec) if spec.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit()) => {
                format!("{name}-{spec}")
            }
            // A path or an address can have characters that file names may not have, so a hash takes its place.
            Self::Platform(spec) => {
                let platform = spec.split([':', '@']).next().unwrap_or_default();
                let safe: String = platform.chars().filter(char::is_ascii_alphanumeric).collect();
                format!("{name}-{safe}-{:016x}", derive_seed(0, &[spec]))
            }
        }
    }

    /// Describes the effect in one sentence.
    #[must_use]
    pub fn describe_effect(&self) -> String {
        match self {
            Self::Platform(spec) => format!("The same poses are seen on {spec}."),
            Self::Whole(whole) => whole.describe_effect().to_owned(),
            Self::By(dose, value) => dose.describe_value(*value),
        }
    }

    fn dose_kind(&self) -> Option<DoseKind> {
        match self {
            Self::By(dose, _) => Some(*dose),
            Self::Platform(_) | Self::Whole(_) => None,
        }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Platform(spec) => write!(f, "{PLATFORM_CHANGE_NAME}={spec}"),
            Self::Whole(whole) => f.write_str(whole.name()),
            Self::By(dose, value) => write!(f, "{}={value}", dose.name()),
        }
    }
}

impl FromStr for Change {
    type Err = ChangeError;

    fn from_str(text: &str) -> Result<Self, ChangeError> {
        match <[Self; 1]>::try_from(Self::parse_list(text)?) {
            Ok([change]) => Ok(change),
            Err(several) => Err(ChangeError::Several { text: text.to_owned(), count: several.len() }),
        }
    }
}

impl TryFrom<String> for Change {
    type Error = ChangeError;

    fn try_from(text: String) -> Result<Self, ChangeError> {
        text.parse()
    }
}

impl From<Change> for String {
    fn from(change: Change) -> Self {
        change.to_string()
    }
}

#[cfg(test)]
mod tests;
