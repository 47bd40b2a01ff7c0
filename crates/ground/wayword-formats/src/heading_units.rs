//! Tells headings in degrees from headings in radians, by all headings of a file. A single one can be either.

use crate::{DatasetItem, FormatError};
use std::f64::consts::TAU;

/// Files in radians have headings of up to a turn, or of a little more where somebody turned on. This is more.
const MAX_USUAL_RAD: f64 = 10.0;
/// Radians beyond two turns are not believed, even where the other headings are small.
const MAX_BELIEVED_RAD: f64 = 2.0 * TAU;
const HINT: &str = "write headings in radians (degrees * pi / 180); if they are radians, bring them to one turn";

/// The headings of a file so far.
#[derive(Default)]
pub(crate) struct HeadingUnits {
    /// The headings other than 0, which means the same in both units.
    turned: usize,
    /// Those of them that are unusual in radians.
    unusual: usize,
    /// Whether one is more than two turns in radians.
    is_far_beyond: bool,
    /// The first item with an unusual heading, as an error about it.
    first_unusual: Option<FormatError>,
}

impl HeadingUnits {
    /// Takes in the heading of an item, as the file has it.
    pub(crate) fn note_heading(&mut self, item: &DatasetItem<'_>, heading: f64) {
        self.turned += usize::from(heading != 0.0);
        self.is_far_beyond |= heading.abs() > MAX_BELIEVED_RAD;
        if heading.abs() > MAX_USUAL_RAD {
            self.unusual += 1;
            self.first_unusual.get_or_insert_with(|| item.wrong_field("heading", format!("it is {heading}"), HINT));
        }
    }

    /// Refuses a file whose headings look like degrees: most are unusual in radians, or one is more than two
    /// turns.
    ///
    /// # Errors
    /// The first item with such a heading, and how many there are.
    pub(crate) fn refuse_degrees(self) -> Result<(), FormatError> {
        let is_likely = self.is_far_beyond || self.unusual * 2 > self.turned;
        match self.first_unusual {
            Some(FormatError::Item(mut item)) if is_likely => {
                item.problem += &format!(
                    "; {} of the {} headings of the file other than 0 are that large, so they look like degrees",
                    self.unusual, self.turned
                );
                Err(item.into())
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ItemPlace;
    use serde_json::json;
    use std::path::Path;

    fn told(headings: &[f64]) -> Option<String> {
        let mut units = HeadingUnits::default();
        for (index, heading) in headings.iter().enumerate() {
            let item = DatasetItem::new(Path::new("f.json"), ItemPlace::Item(index), json!({})).unwrap();
            units.note_heading(&item, *heading);
        }
        units.refuse_degrees().err().map(|error| error.to_string())
    }

    #[test]
    fn degrees_are_told_by_all_headings_of_a_file() {
        for degrees in
            [&[180.0][..], &[0.0, 5.0, 90.0], &[-170.0, -1.0, 3.0, 6.0], &[0.0, 0.0, 11.0], &[12.0, 11.0, 1.0]]
        {
            let told = told(degrees).unwrap_or_default();
            assert!(told.contains("look like degrees") && told.contains("degrees * pi / 180"), "{degrees:?}: {told}");
        }
        let first = told(&[1.0, 180.0, 90.0]).unwrap();
        assert!(first.starts_with("f.json: item 1: field \"heading\": it is 180; 2 of the 3"), "{first}");
    }

    #[test]
    fn radians_stay_as_they_are() {
        for radians in
            [&[0.0, 6.2, 7.0][..], &[-3.1, 3.1], &[7.2], &[], &[0.0], &[9.9], &[1.0, 2.0, 3.0, 11.0], &[-6.2]]
        {
            assert_eq!(told(radians), None, "{radians:?}");
        }
    }
}
