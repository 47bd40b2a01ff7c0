//! Reads Matterport3D's `.house` files as Habitat uses them: the names of the objects of a semantic mesh, and the boxes
//! of the rooms.
//!
//! Format: Matterport3D's `data_organization.md`. This reader uses the lines `R` (regions with their boxes), `O` (objects)
//! and `C` (categories), and skips the others.

use super::{HouseRegion, SemanticThing, broken_lines::refuse_if_most_broken};
use std::collections::BTreeMap;
use wayword_core::{DVec3, ObjectId};

/// The contents of the file.
#[derive(Debug, Default, PartialEq)]
pub(super) struct MatterportHouse {
    pub(super) things: Vec<SemanticThing>,
    /// Index in `things` of the thing of each number; the mesh refers to things by these numbers.
    pub(super) by_number: BTreeMap<u32, usize>,
    pub(super) regions: Vec<HouseRegion>,
    /// The lines that cannot be read, each with its reason. Their rooms and objects are left out.
    pub(super) broken_lines: Vec<String>,
}

/// Parses the file. A line that cannot be read is left out; the error names the first of them if they are most of the lines.
pub(super) fn parse_house(text: &str) -> Result<MatterportHouse, String> {
    if !text.starts_with("ASCII") {
        return Err("line 1: does not begin with ASCII".to_owned());
    }
    let (mut regions, mut broken_lines) = (Vec::new(), Vec::new());
    let mut categories: BTreeMap<i64, &str> = BTreeMap::new();
    let mut objects: BTreeMap<u32, i64> = BTreeMap::new();
    for (number, line) in text.lines().enumerate().skip(1) {
        let words: Vec<&str> = line.split_whitespace().take(32).collect();
        let record = HouseLine { words: &words };
        let mut read = || -> Result<(), String> {
            match words.first().copied() {
                Some("R") => regions.push(record.read_region()?),
                Some("O") => insert_once(&mut objects, record.number_at(1)?, record.number_at(3)?)?,
                Some("C") => insert_once(&mut categories, record.number_at(1)?, record.word_at(3)?)?,
                _ => {}
            }
            Ok(())
        };
        if let Err(reason) = read() {
            broken_lines.push(format!("line {}: {reason}", number + 1));
        }
    }
    refuse_if_most_broken(&broken_lines, regions.len() + categories.len() + objects.len())?;
    let mut house = MatterportHouse { regions, broken_lines, ..MatterportHouse::default() };
    for (number, category) in objects {
        let id = ObjectId::new(number.to_string()).map_err(|error| error.to_string())?;
        house.by_number.insert(number, house.things.len());
        house.things.push(SemanticThing::new(id, categories.get(&category).copied().unwrap_or_default()));
    }
    Ok(house)
}

/// Adds what a line tells of a number, which no earlier line may have told of.
fn insert_once<N: Ord, T>(known: &mut BTreeMap<N, T>, number: N, told: T) -> Result<(), String> {
    if known.contains_key(&number) {
        return Err("an earlier line has the same number".to_owned());
    }
    known.insert(number, told);
    Ok(())
}

/// The words of a line, by column.
struct HouseLine<'a, 'b> {
    words: &'b [&'a str],
}

impl<'a> HouseLine<'a, '_> {
    fn word_at(&self, column: usize) -> Result<&'a str, String> {
        let count = self.words.len();
        self.words.get(column).copied().ok_or_else(|| format!("has {count} columns; column {} is missing", column + 1))
    }

    fn number_at<T: std::str::FromStr>(&self, column: usize) -> Result<T, String> {
        let word = self.word_at(column)?;
        word.parse().map_err(|_| format!("column {}: {word:.20?} is not a valid number", column + 1))
    }

    fn place_at(&self, column: usize) -> Result<DVec3, String> {
        let place = DVec3::new(self.number_at(column)?, self.number_at(column + 1)?, self.number_at(column + 2)?);
        if place.is_finite() { Ok(place) } else { Err(format!("column {}: is not a position", column + 1)) }
    }

    /// `R index level 0 0 label px py pz xlo ylo zlo xhi yhi zhi height ...`
    fn read_region(&self) -> Result<HouseRegion, String> {
        // Z is Matterport3D's letter for regions that are no rooms.
        let letter = self.word_at(5)?.chars().next().unwrap_or('Z');
        Ok(HouseRegion { low: self.place_at(9)?, high: self.place_at(12)?, letter })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ASCII 1.1\n\
        R 0 0 0 0 k 0 0 0 -1 -2 0 3 4 2.5 2.5 0 0 0\n\
        O 1 0 9 1 1 0.5 1 0 0 0 1 0 1 1 1 0 0 0 0 0 0 0 0\n\
        C 9 3 coffee#table 5 table 0 0 0 0 0\n";

    #[test]
    fn objects_are_found_by_their_number() {
        let house = parse_house(TEXT).unwrap();
        let names: Vec<_> = house.things.iter().map(|thing| thing.name.as_deref()).collect();
        assert_eq!((names.as_slice(), house.by_number.get(&1)), (&[Some("coffee table")][..], Some(&0)));
        assert_eq!(
            house.regions,
            [HouseRegion { low: DVec3::new(-1.0, -2.0, 0.0), high: DVec3::new(3.0, 4.0, 2.5), letter: 'k' }]
        );
    }

    #[test]
    fn a_broken_line_leaves_out_its_own_room_or_object() {
        let house = parse_house(&format!("{TEXT}O x 0 9\nR 1 0 0 0 k 0 0 0 -1 -2 0 3 four 2.5 2.5 0 0 0\n")).unwrap();
        assert_eq!((house.things.len(), house.regions.len()), (1, 1));
        let told =
            ["line 5: column 2: \"x\" is not a valid number", "line 6: column 14: \"four\" is not a valid number"];
        assert_eq!(house.broken_lines, told);
    }

    #[test]
    fn errors_name_the_line_and_the_column() {
        assert_eq!(parse_house("ply").unwrap_err(), "line 1: does not begin with ASCII");
        assert_eq!(parse_house("ASCII\nO 0 0").unwrap_err(), "line 2: has 3 columns; column 4 is missing");
        assert_eq!(
            parse_house("ASCII\nO 9999999999 0 0").unwrap_err(),
            "line 2: column 2: \"9999999999\" is not a valid number"
        );
    }
}
