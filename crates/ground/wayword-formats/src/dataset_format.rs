//! The names of the dataset formats.

use std::{fmt, str::FromStr};

/// A format that can be read and written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DatasetFormat {
    /// Room-to-Room.
    R2r,
    /// REVERIE, either release.
    Reverie,
    /// RxR guide annotations.
    Rxr,
    /// VLN-CE episodes.
    Vlnce,
    /// Wayword's own records.
    Wayword,
    /// StreamVLN's trajectory data: recordings with texts.
    Streamvln,
    /// NaVILA's decisions: recordings with texts.
    Navila,
    /// The episodes of a LeRobot dataset of version 2, as InternNav has them: recordings with texts.
    Internnav,
    /// A LeRobot dataset of version 3: recordings with texts.
    Lerobot,
}

/// There is no format of that name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "there is no format {0:?}; choose one of r2r, reverie, rxr, vlnce, wayword, streamvln, navila, internnav, lerobot"
)]
pub struct UnknownFormat(String);

impl DatasetFormat {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::R2r,
        Self::Reverie,
        Self::Rxr,
        Self::Vlnce,
        Self::Wayword,
        Self::Streamvln,
        Self::Navila,
        Self::Internnav,
        Self::Lerobot,
    ];

    /// Whether its items are recordings with texts. Such a layout has pictures too, and is no file of items that could be written alone.
    #[must_use]
    pub fn holds_recordings(self) -> bool {
        matches!(self, Self::Streamvln | Self::Navila | Self::Internnav | Self::Lerobot)
    }

    /// Its name, as `--format` takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::R2r => "r2r",
            Self::Reverie => "reverie",
            Self::Rxr => "rxr",
            Self::Vlnce => "vlnce",
            Self::Wayword => "wayword",
            Self::Streamvln => "streamvln",
            Self::Navila => "navila",
            Self::Internnav => "internnav",
            Self::Lerobot => "lerobot",
        }
    }
}

impl FromStr for DatasetFormat {
    type Err = UnknownFormat;

    fn from_str(name: &str) -> Result<Self, UnknownFormat> {
        Self::ALL.into_iter().find(|format| format.name() == name).ok_or_else(|| UnknownFormat(name.to_owned()))
    }
}

impl fmt::Display for DatasetFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
