//! The pictures of an episode: in its rows, or in a stretch of a video.

use super::{episodes::VideoClip, parquet::ParquetTable};
use crate::{
    reel::{PictureReel, TakePicture},
    video::Mp4Film,
};
use wayword_core::PlatformError;
use wayword_world::files;

const DATASET_HINT: &str = "download the dataset again, or write it again with LeRobot's library";

/// The pictures of an episode that are stored in its rows.
pub(super) struct RowReel {
    table: ParquetTable,
    /// The camera's column.
    column: String,
    /// The row of the first picture.
    first: u64,
    times_s: Vec<f64>,
}

impl RowReel {
    pub(super) fn new(table: ParquetTable, column: String, first: u64, times_s: Vec<f64>) -> Self {
        Self { table, column, first, times_s }
    }
}

impl PictureReel for RowReel {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        format!("{number:06}")
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let rows: Vec<u64> = wanted.iter().map(|number| self.first + *number as u64).collect();
        self.table.read_bytes(&self.column, &rows, &mut |row, bytes| {
            let wrong = |reason| {
                files::file_error(self.table.path(), format!("{} of row {row}: {reason}", self.column), DATASET_HINT)
            };
            let bytes =
                bytes.ok_or_else(|| wrong("only the picture's name is stored here, not the picture".to_owned()))?;
            let number = usize::try_from(row - self.first).map_err(|error| wrong(error.to_string()))?;
            take(number, files::decode_picture(bytes).map_err(wrong)?)
        })
    }
}

/// The pictures of an episode that are a stretch of a video.
pub(super) struct VideoStretch {
    film: Mp4Film,
    /// For each picture of the episode, its number in the video; ascending.
    numbers: Vec<usize>,
    times_s: Vec<f64>,
}

impl VideoStretch {
    /// The pictures at these times after the beginning of the episode, seconds; `step_s` is the time between two
    /// pictures.
    ///
    /// # Errors
    /// When the video cannot be read, or has no picture for one of them.
    pub(super) fn open(clip: &VideoClip, times_s: Vec<f64>, step_s: f64) -> Result<Self, PlatformError> {
        let film = Mp4Film::open(&clip.file, None)?;
        let mut stretch = Self { film, numbers: Vec::new(), times_s: Vec::new() };
        for (row, time_s) in times_s.into_iter().enumerate() {
            let wanted_s = clip.from_s + time_s;
            let number = nearest_time(stretch.film.times_s(), wanted_s, step_s / 2.0);
            let number = number.ok_or_else(|| {
                let reason =
                    format!("row {row} of the episode needs a picture at {wanted_s:.3} s, but the video has none near");
                files::file_error(&clip.file, reason, DATASET_HINT)
            })?;
            // Two rows may share a picture; the second of them is left out.
            if stretch.numbers.last().is_none_or(|last| *last < number) {
                stretch.numbers.push(number);
                stretch.times_s.push(time_s);
            }
        }
        Ok(stretch)
    }
}

/// Index of the time nearest to `wanted_s`; `None` if it is further away than `most_s`.
fn nearest_time(times_s: &[f64], wanted_s: f64, most_s: f64) -> Option<usize> {
    let next = times_s.partition_point(|time_s| *time_s < wanted_s);
    let off = |at: usize| times_s.get(at).map(|time_s| ((time_s - wanted_s).abs(), at));
    let nearest =
        [next.checked_sub(1).and_then(off), off(next)].into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.filter(|(off_s, _)| *off_s <= most_s).map(|(_, at)| at)
}

impl PictureReel for VideoStretch {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        format!("{number:06}")
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let numbers: Vec<usize> = wanted.iter().filter_map(|number| self.numbers.get(*number).copied()).collect();
        self.film.decode_pictures(&numbers, &mut |number, image| match self.numbers.binary_search(&number) {
            Ok(index) => take(index, image),
            Err(_) => Ok(()),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn nearest_finds_the_least_distance(mut times_s in prop::collection::vec(0.0..10.0f64, 1..20), wanted_s in -1.0..11.0f64) {
            times_s.sort_by(f64::total_cmp);
            let off_s = |time_s: f64| (time_s - wanted_s).abs();
            let least = times_s.iter().map(|time_s| off_s(*time_s)).fold(f64::MAX, f64::min);
            let found = nearest_time(&times_s, wanted_s, 0.5);
            prop_assert_eq!(found.is_some(), least <= 0.5);
            prop_assert!(found.is_none_or(|at| off_s(times_s[at]) == least));
        }
    }
}
