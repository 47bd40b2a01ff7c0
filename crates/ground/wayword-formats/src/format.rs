//! The dataset formats, and how the format of a file is recognised.

use crate::{Episode, FormatError, input, jsonl, r2r, reverie, rxr, strict_json::StrictJson, vlnce};
use serde::de::{Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::{cell::RefCell, fmt, path::Path, str::FromStr};

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
}

/// There is no format of that name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no format {0:?}; choose one of r2r, reverie, rxr, vlnce, wayword")]
pub struct UnknownFormat(String);

impl DatasetFormat {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::R2r, Self::Reverie, Self::Rxr, Self::Vlnce, Self::Wayword];

    /// Its name, as `--format` takes it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::R2r => "r2r",
            Self::Reverie => "reverie",
            Self::Rxr => "rxr",
            Self::Vlnce => "vlnce",
            Self::Wayword => "wayword",
        }
    }

    /// Reads a file of this format.
    ///
    /// # Errors
    /// The same as the format's own `read`.
    pub fn read_file(self, file: &Path) -> Result<Vec<Episode>, FormatError> {
        match self {
            Self::R2r => r2r::read_r2r_file(file),
            Self::Reverie => reverie::read_reverie_file(file),
            Self::Rxr => rxr::read_rxr_file(file),
            Self::Vlnce => vlnce::read_vlnce_file(file).map(|dataset| dataset.episodes),
            Self::Wayword => jsonl::read_records(file).map(|records| jsonl::episodes_from_records(&records)),
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

/// Reads a file of any of the formats.
///
/// # Errors
/// When its format is not recognised, and when the format's own `read` fails.
pub fn read_any_format(file: &Path) -> Result<Vec<Episode>, FormatError> {
    detect_format(file)?.read_file(file)
}

/// Recognises a file's format by its beginning:
///
/// - a list is REVERIE where its first item has an object (`objId`) or an `id` that begins with its `path_id`, else
///   R2R;
/// - an object or line with `instruction_id` is RxR, with `format` Wayword's, with `episodes` or `instruction_vocab`
///   VLN-CE.
///
/// # Errors
/// When it cannot be read, or its beginning is none of these.
pub fn detect_format(file: &Path) -> Result<DatasetFormat, FormatError> {
    let mut parser = input::json_parser(file)?;
    let detected = RefCell::new(None);
    // Stopping early is an error as well, so only the format that was found before it counts.
    let read = (&mut parser).deserialize_any(BeginningVisitor(&detected));
    let format = detected.take();
    format.ok_or_else(|| {
        let why = match read {
            Ok(()) => "it is neither a list of objects nor an object with a field of a known format".to_owned(),
            Err(error) if error.is_eof() && (error.line(), error.column()) == (1, 0) => "it is empty".to_owned(),
            Err(error) if error.is_eof() => {
                let problem = format!("the file is cut off at line {}, column {}", error.line(), error.column());
                return FormatError::for_document(file, problem, "fetch it again");
            }
            Err(error) => error.to_string(),
        };
        let problem = format!("its beginning does not fit any known format: {why}");
        FormatError::for_document(file, problem, "give a file in one of the formats r2r, reverie, rxr, vlnce, wayword")
    })
}

/// Looks at the first item of a list, or at an object's keys up to the first that decides, and puts the format into its
/// field.
struct BeginningVisitor<'a>(&'a RefCell<Option<DatasetFormat>>);

impl<'de> Visitor<'de> for BeginningVisitor<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of items, or an object")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        if let Some(Value::Object(item)) = list.next_element_seed(StrictJson(&RefCell::default()))? {
            *self.0.borrow_mut() = Some(if is_reverie(&item) { DatasetFormat::Reverie } else { DatasetFormat::R2r });
        }
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        while let Some(key) = entries.next_key::<String>()? {
            let format = match key.as_str() {
                "instruction_id" => DatasetFormat::Rxr,
                "episodes" | "instruction_vocab" => DatasetFormat::Vlnce,
                "format" => DatasetFormat::Wayword,
                _ => {
                    entries.next_value::<IgnoredAny>()?;
                    continue;
                }
            };
            *self.0.borrow_mut() = Some(format);
            return Ok(());
        }
        Ok(())
    }
}

/// Whether an item of a list is REVERIE's and not R2R's.
fn is_reverie(item: &Map<String, Value>) -> bool {
    let name = |field: &str| item.get(field).and_then(crate::item::name_of);
    let begins = |id: String, path: String| id == path || id.starts_with(&format!("{path}_"));
    item.contains_key("objId") || name("id").zip(name("path_id")).is_some_and(|(id, path)| begins(id, path))
}
