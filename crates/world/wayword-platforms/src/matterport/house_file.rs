//! Reads `SCAN.house`: levels, regions, panoramas and objects of a building.
//!
//! Format: Matterport3D's `data_organization.md`, "house_segmentations": ASCII, one record per line, and the first word
//! is the kind of the record. Read here: `L` levels, `R` regions, `P` panoramas, `O` objects, `C` categories, and how many there are of
//! each by `H`: a file that was cut off has fewer.

use super::file_reading;
use glam::DVec3;
use std::{collections::BTreeMap, path::Path};
use wayword_core::{ObjectId, PlatformError, ViewpointId};
use wayword_world::object_names;

/// Largest file, bytes; a larger one is refused.
const MAX_BYTES: u64 = 64 << 20;
/// Most words of a line that are read; the records have fewer than 40.
const MAX_WORDS: usize = 64;
/// The advice in errors about such a file.
const HOUSE_FILE_HINT: &str = "get the file again from Matterport3D's house_segmentations";

/// The contents of a `.house` file.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct MatterportHouseFile {
    /// Height of each level, metres, by its index in the file.
    levels_m: BTreeMap<i64, f64>,
    /// Regions by their index in the file.
    regions: BTreeMap<i64, HouseFileRegion>,
    /// The index of the region of each viewpoint.
    panoramas: BTreeMap<ViewpointId, i64>,
    pub(crate) objects: Vec<HouseObject>,
}

/// A region of a building: the level it belongs to, and the letter of its kind of room.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HouseFileRegion {
    level: i64,
    letter: char,
}

/// An object of a `.house` file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct HouseObject {
    pub(crate) id: ObjectId,
    /// In plain words; `None` if the annotators gave no name.
    pub(crate) name: Option<String>,
    /// Index of its region.
    pub(crate) region: i64,
    /// Centre of its box, metres, world frame.
    pub(crate) centre: DVec3,
}

impl MatterportHouseFile {
    /// The storey of a viewpoint; the lowest is 1.
    pub(crate) fn storey_of_viewpoint(&self, viewpoint: &ViewpointId) -> Option<u32> {
        let region = self.regions.get(self.panoramas.get(viewpoint)?)?;
        let height_m = self.levels_m.get(&region.level)?;
        // Storeys are numbered from the lowest, whatever the order in the file is.
        let lower = self.levels_m.iter().filter(|(index, other_m)| (**other_m, **index) < (*height_m, region.level));
        u32::try_from(lower.count() + 1).ok()
    }

    /// The letter of a viewpoint's region.
    pub(crate) fn room_letter(&self, viewpoint: &ViewpointId) -> Option<char> {
        self.regions.get(self.panoramas.get(viewpoint)?).map(|region| region.letter)
    }

    /// The objects in a viewpoint's region.
    pub(crate) fn objects_around(&self, viewpoint: &ViewpointId) -> impl Iterator<Item = &HouseObject> {
        let region = self.panoramas.get(viewpoint).copied();
        self.objects.iter().filter(move |object| Some(object.region) == region)
    }
}

/// Reads a `.house` file; `None` if there is none.
///
/// # Errors
/// If the file does not have this format; the message names the line and the column.
pub(crate) fn read_house_file(file: &Path) -> Result<Option<MatterportHouseFile>, PlatformError> {
    let Some(text) = file_reading::text_if_there(file, MAX_BYTES, HOUSE_FILE_HINT)? else {
        return Ok(None);
    };
    parse_house_file(&text).map(Some).map_err(|reason| file_reading::file_error(file, reason, HOUSE_FILE_HINT))
}

fn parse_house_file(text: &str) -> Result<MatterportHouseFile, String> {
    if !text.starts_with("ASCII") {
        return Err("line 1: does not begin with ASCII".into());
    }
    let mut house = MatterportHouseFile::default();
    let mut categories = BTreeMap::new();
    let mut objects = Vec::new();
    let mut counts = HouseFileCounts::default();
    for (number, line) in text.lines().enumerate().skip(1) {
        if !line.starts_with(['H', 'L', 'R', 'P', 'O', 'C']) {
            continue;
        }
        let record = HouseFileEntry { words: line.split_whitespace().take(MAX_WORDS).collect() };
        counts
            .count_entry(&record)
            .and_then(|()| add_entry(&record, &mut house, &mut categories, &mut objects))
            .map_err(|reason| format!("line {}: {reason}", number + 1))?;
    }
    counts.compare()?;
    house.objects = objects
        .into_iter()
        .map(|(object, category)| HouseObject { name: categories.get(&category).cloned().flatten(), ..object })
        .collect();
    Ok(house)
}

/// Adds one line of the file to the house. An object's name is its category, which may come later in the file, so
/// `objects` are collected with the number of their category.
fn add_entry(
    record: &HouseFileEntry<'_>,
    house: &mut MatterportHouseFile,
    categories: &mut BTreeMap<i64, Option<String>>,
    objects: &mut Vec<(HouseObject, i64)>,
) -> Result<(), String> {
    match record.word_at(0)? {
        "L" => {
            house.levels_m.insert(record.index_at(1)?, record.position_at(4)?.z);
        }
        "R" => {
            let letter = record.word_at(5)?.chars().next().unwrap_or('Z');
            house.regions.insert(record.index_at(1)?, HouseFileRegion { level: record.index_at(2)?, letter });
        }
        "P" => {
            let viewpoint = ViewpointId::new(record.word_at(1)?).map_err(|error| error.to_string())?;
            house.panoramas.insert(viewpoint, record.index_at(3)?);
        }
        "O" => {
            let id = ObjectId::new(record.word_at(1)?).map_err(|error| error.to_string())?;
            let object = HouseObject { id, name: None, region: record.index_at(2)?, centre: record.position_at(4)? };
            objects.push((object, record.index_at(3)?));
        }
        "C" => {
            categories.insert(record.index_at(1)?, object_names::plain_name(record.word_at(3)?));
        }
        _ => {}
    }
    Ok(())
}

/// Kinds of records, each with its name and the column of `H` that holds their number.
const COUNTED_KINDS: [(&str, &str, usize); 5] =
    [("P", "panoramas", 4), ("O", "objects", 8), ("C", "categories", 9), ("R", "regions", 10), ("L", "levels", 12)];

/// The records of each kind of [`COUNTED_KINDS`]: those in the file, and those that `H` announces.
#[derive(Default)]
struct HouseFileCounts {
    found: [i64; COUNTED_KINDS.len()],
    announced: Option<[i64; COUNTED_KINDS.len()]>,
}

impl HouseFileCounts {
    fn count_entry(&mut self, record: &HouseFileEntry<'_>) -> Result<(), String> {
        let kind = record.word_at(0)?;
        if kind == "H" {
            let mut announced = [0; COUNTED_KINDS.len()];
            for (count, (_, _, column)) in announced.iter_mut().zip(COUNTED_KINDS) {
                *count = record.index_at(column)?;
            }
            self.announced = Some(announced);
        }
        for (count, (counted, _, _)) in self.found.iter_mut().zip(COUNTED_KINDS) {
            *count += i64::from(kind == counted);
        }
        Ok(())
    }

    fn compare(&self) -> Result<(), String> {
        for ((announced, found), (_, name, _)) in self.announced.iter().flatten().zip(&self.found).zip(COUNTED_KINDS) {
            if found < announced {
                return Err(format!("it announces {announced} {name} and has {found}, so a part of it is lost"));
            }
        }
        Ok(())
    }
}

/// The words of a line.
struct HouseFileEntry<'a> {
    words: Vec<&'a str>,
}

impl<'a> HouseFileEntry<'a> {
    fn word_at(&self, column: usize) -> Result<&'a str, String> {
        let count = self.words.len();
        self.words.get(column).copied().ok_or_else(|| format!("has {count} columns; column {} is missing", column + 1))
    }

    fn index_at(&self, column: usize) -> Result<i64, String> {
        let word = self.word_at(column)?;
        word.parse().map_err(|_| format!("column {}: {word:.20?} is not an index", column + 1))
    }

    fn position_at(&self, column: usize) -> Result<DVec3, String> {
        let number = |column: usize| {
            let word = self.word_at(column)?;
            let number: f64 =
                word.parse().map_err(|_| format!("column {}: {word:.20?} is not a number", column + 1))?;
            file_reading::check_coordinate(number).map_err(|reason| format!("column {}: {reason}", column + 1))
        };
        Ok(DVec3::new(number(column)?, number(column + 1)?, number(column + 2)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ASCII 1.1\n\
        H - - 1 2 0 0 0 1 1 2 0 2\n\
        L 0 1 - 0 0 3.0 0 0 0 1 1 1 0 0 0 0 0\n\
        L 1 1 - 0 0 0.0 0 0 0 1 1 1 0 0 0 0 0\n\
        R 0 0 0 0 b 0 0 0 0 0 0 1 1 1 2.5 0 0 0 0\n\
        R 1 1 0 0 k 0 0 0 0 0 0 1 1 1 2.5 0 0 0 0\n\
        P upper 0 0 0 1 2 4.5 0 0 0 0 0\n\
        P lower 1 1 0 1 2 1.5 0 0 0 0 0\n\
        O 5 1 9 1 1 0.5 1 0 0 0 1 0 1 1 1 0 0 0 0 0 0 0 0\n\
        C 9 3 coffee#table 5 table 0 0 0 0 0\n\
        E 0 0 0\n";

    fn id(name: &str) -> ViewpointId {
        ViewpointId::new(name).unwrap()
    }

    #[test]
    fn levels_are_numbered_from_the_lowest_whatever_their_order() {
        let house = parse_house_file(TEXT).unwrap();
        assert_eq!(
            (house.storey_of_viewpoint(&id("lower")), house.storey_of_viewpoint(&id("upper"))),
            (Some(1), Some(2))
        );
        assert_eq!(house.storey_of_viewpoint(&id("elsewhere")), None);
        assert_eq!(house.room_letter(&id("upper")), Some('b'));
    }

    #[test]
    fn objects_have_the_names_of_their_categories() {
        let house = parse_house_file(TEXT).unwrap();
        let around: Vec<_> = house.objects_around(&id("lower")).collect();
        assert_eq!(around.len(), 1);
        assert_eq!((around[0].id.as_str(), around[0].name.as_deref()), ("5", Some("coffee table")));
        assert_eq!(house.objects_around(&id("upper")).count(), 0);
    }

    #[test]
    fn a_file_that_was_cut_off_is_refused() {
        let cut =
            TEXT.lines().filter(|line| !line.starts_with('O')).map(|line| format!("{line}\n")).collect::<String>();
        let reason = parse_house_file(&cut).unwrap_err();
        assert_eq!(reason, "it announces 1 objects and has 0, so a part of it is lost");
        let half_a_line = TEXT.split_once("C 9").unwrap().0;
        assert!(parse_house_file(half_a_line).unwrap_err().contains("1 categories"));
    }

    #[test]
    fn errors_name_the_line_and_the_column() {
        assert_eq!(parse_house_file("ply\n").unwrap_err(), "line 1: does not begin with ASCII");
        assert_eq!(parse_house_file("ASCII\nL 0 1").unwrap_err(), "line 2: has 3 columns; column 5 is missing");
        assert_eq!(
            parse_house_file("ASCII\nL 0 1 - 0 nan 3").unwrap_err(),
            "line 2: column 6: NaN is not a plausible coordinate"
        );
        assert_eq!(parse_house_file("ASCII\nP v 0 x 0 0 0 0").unwrap_err(), "line 2: column 4: \"x\" is not an index");
    }
}
