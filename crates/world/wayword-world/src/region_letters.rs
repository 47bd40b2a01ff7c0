//! Turns the letter that Matterport3D gives to each region of a building into the name of a room. The letters are listed
//! in the dataset's description of its files (`house_segmentations`, data organisation, "region labels").

/// The everyday word for a region's letter; `None` if the letter does not stand for a room that a person would name.
#[must_use]
pub fn room_for_letter(letter: char) -> Option<&'static str> {
    Some(match letter {
        'a' => "bathroom",
        'b' => "bedroom",
        'c' => "closet",
        'd' => "dining room",
        'e' => "entryway",
        'f' => "family room",
        'g' => "garage",
        'h' => "hallway",
        'i' => "library",
        'j' => "laundry room",
        'k' => "kitchen",
        'l' => "living room",
        'm' => "meeting room",
        'n' => "lounge",
        'o' => "office",
        'p' => "porch",
        'r' => "game room",
        's' => "stairs",
        't' => "toilet",
        'u' => "utility room",
        'v' => "tv room",
        'w' => "gym",
        'x' => "outdoor area",
        'y' => "balcony",
        'B' => "bar",
        'C' => "classroom",
        'D' => "dining booth",
        'S' => "spa",
        // z "other", Z "junk", - "no label"
        _ => return None,
    })
}
