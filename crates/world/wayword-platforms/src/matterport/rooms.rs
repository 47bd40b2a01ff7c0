//! Reads `panorama_to_region.txt`: the room of each viewpoint.
//!
//! The file has one line per panorama: index, viewpoint, region, letter of the region's label (Matterport3D
//! `house_segmentations`, data organisation, "region labels").

use super::file_reading;
use std::{collections::BTreeMap, path::Path};
use wayword_core::{PlatformError, ViewpointId};

/// Largest file, bytes; a larger one is refused.
const MAX_BYTES: u64 = 4 << 20;
const ROOMS_HINT: &str = "get the file again from Matterport3D's house_segmentations";

/// The room of each viewpoint, as a letter.
pub(crate) type RoomLetters = BTreeMap<ViewpointId, char>;

/// Reads the rooms; `None` if there is no such file.
///
/// # Errors
/// If a line does not have this format; the message names the line.
pub(crate) fn read_rooms(file: &Path) -> Result<Option<RoomLetters>, PlatformError> {
    let Some(text) = file_reading::text_if_there(file, MAX_BYTES, ROOMS_HINT)? else {
        return Ok(None);
    };
    parse_rooms(&text).map(Some).map_err(|reason| file_reading::file_error(file, reason, ROOMS_HINT))
}

fn parse_rooms(text: &str) -> Result<RoomLetters, String> {
    let mut rooms = RoomLetters::new();
    for (number, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().take(5).collect();
        if words.is_empty() {
            continue;
        }
        let (viewpoint, letter) = parse_room_line(&words).map_err(|reason| format!("line {}: {reason}", number + 1))?;
        if rooms.insert(viewpoint, letter).is_some() {
            return Err(format!("line {}: viewpoint {} is listed twice", number + 1, words.get(1).unwrap_or(&"")));
        }
    }
    Ok(rooms)
}

fn parse_room_line(words: &[&str]) -> Result<(ViewpointId, char), String> {
    let [_, viewpoint, _, label] = words else {
        return Err("does not have four columns: index, viewpoint, region, letter".into());
    };
    let viewpoint = ViewpointId::new(*viewpoint).map_err(|error| error.to_string())?;
    let mut letters = label.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => Ok((viewpoint, letter)),
        _ => Err(format!("the room is {:?}, not one letter", label.chars().take(20).collect::<String>())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_world::region_letters;

    #[test]
    fn a_line_gives_a_viewpoint_its_room() {
        let rooms = parse_rooms("0 aa 3 k\n1 bb 0 Z\n\n").unwrap();
        let words: Vec<_> = rooms.values().map(|letter| region_letters::room_for_letter(*letter)).collect();
        assert_eq!(words, [Some("kitchen"), None]);
    }

    #[test]
    fn errors_name_the_line() {
        assert_eq!(
            parse_rooms("0 a 0 k\n1 b 0").unwrap_err(),
            "line 2: does not have four columns: index, viewpoint, region, letter"
        );
        assert_eq!(parse_rooms("0 a 0 kitchen").unwrap_err(), "line 1: the room is \"kitchen\", not one letter");
        assert_eq!(parse_rooms("0 a 0 k\n1 a 1 b").unwrap_err(), "line 2: viewpoint a is listed twice");
        assert!(parse_rooms("0 ../a 0 k").unwrap_err().contains("path separators"));
    }
}
