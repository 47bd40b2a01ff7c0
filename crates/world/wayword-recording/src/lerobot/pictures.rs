//! The pictures of an episode: in its rows, or in a stretch of a video.

use super::{episodes::VideoClip, parquet::ParquetTable};
use crate::{
    file_kind::ENCODE_HINT,
    reel::{PictureReel, TakePicture},
    video::Mp4Film,
};
use wayword_core::PlatformError;
use wayword_world::files;

const DATASET_HINT: &str = "download the dataset again, or write it again with LeRobot's library";
const TIMES_HINT: &str = "the column `timestamp` and the video do not fit together: write the dataset again with LeRobot's library, \
                          or leave this episode out with --scan";
/// The advice for a video in another codec. The dataset's other files name its videos, so each is replaced.
const ENCODE_VIDEOS_HINT: &str = "write the dataset's videos again in place, as H.264 (keep a copy); in the dataset's folder: find \
                                  videos -name \"*.mp4\" | while read -r f; do ffmpeg -nostdin -i \"$f\" -c:v libx264 -pix_fmt \
                                  yuv420p -vf \"crop=trunc(iw/2)*2:trunc(ih/2)*2\" -an \"$f.new.mp4\" && mv \"$f.new.mp4\" \"$f\"; \
                                  done";

/// The pictures of an episode that are stored in its rows.
pub(super) struct RowReel {
    table: ParquetTable,
    /// The camera's column.
    column: String,
    /// The row of the first picture.
    first: u64,
    times_s: Vec<f64>,
    remarks: Vec<String>,
}

impl RowReel {
    pub(super) fn new(
        table: ParquetTable,
        column: String,
        first: u64,
        times_s: Vec<f64>,
        remarks: Vec<String>,
    ) -> Self {
        Self { table, column, first, times_s, remarks }
    }
}

impl PictureReel for RowReel {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        format!("{number:06}")
    }

    fn remarks(&self) -> &[String] {
        &self.remarks
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
    /// What the user has to be told about the episode.
    pub(super) remarks: Vec<String>,
}

impl VideoStretch {
    /// The pictures at these times after the beginning of the episode, seconds; `step_s` is the time between two
    /// pictures.
    ///
    /// # Errors
    /// When the video cannot be read, or has no picture for one of them.
    pub(super) fn open(clip: &VideoClip, times_s: &[f64], step_s: f64) -> Result<Self, PlatformError> {
        let film = Mp4Film::open(&clip.file, None).map_err(advise_in_place)?;
        let remarks = film.remarks().to_vec();
        let mut stretch = Self { film, numbers: Vec::new(), times_s: Vec::new(), remarks };
        for (row, time_s) in times_s.iter().copied().enumerate() {
            let wanted_s = clip.from_s + time_s;
            let number = nearest_time(stretch.film.times_s(), wanted_s, step_s / 2.0);
            let number = number.ok_or_else(|| {
                let reason =
                    format!("row {row} of the episode needs a picture at {wanted_s:.3} s, but the video has none near");
                files::file_error(&clip.file, reason, TIMES_HINT)
            })?;
            // Two rows may share a picture; the second of them is left out.
            if stretch.numbers.last().is_none_or(|last| *last < number) {
                stretch.numbers.push(number);
                stretch.times_s.push(time_s);
            }
        }
        Ok(stretch)
    }

    /// Width and height of the video's pictures, pixels, from the file's header.
    pub(super) fn size_px(&self) -> (u32, u32) {
        self.film.size_px()
    }
}

/// An error of a single video, with the advice for a video of a dataset.
fn advise_in_place(error: PlatformError) -> PlatformError {
    match error {
        PlatformError::File { file, reason, hint: ENCODE_HINT } => {
            PlatformError::File { file, reason, hint: ENCODE_VIDEOS_HINT }
        }
        other => other,
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

    fn remarks(&self) -> &[String] {
        &self.remarks
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        let numbers: Vec<usize> = wanted.iter().filter_map(|number| self.numbers.get(*number).copied()).collect();
        let decoded =
            self.film.decode_pictures(&numbers, &mut |number, image| match self.numbers.binary_search(&number) {
                Ok(index) => take(index, image),
                Err(_) => Ok(()),
            });
        decoded.map_err(advise_in_place)
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
