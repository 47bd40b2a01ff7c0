//! Turns on the spot in a world of another program: when a walker turns right, all things move to the left of the picture. A world
//! whose pictures are mirrored, or that takes headings for counter-clockwise, does it the other way.

use super::{DoctorFinding, DoctorGrade, ok_finding};
use wayword_core::{Frame, Image, Platform, PlatformError, SceneId, ViewGaze};

/// Directions from which a turn begins, all around.
const DIRECTIONS: u32 = 8;
/// How far each turn leads to the right, radians: 12 degrees. And the tangent of that.
const TURN_RAD: f64 = 12.0 * std::f64::consts::PI / 180.0;
const TURN_TANGENT: f64 = 0.212_556_561_670_022;
/// Columns that a picture is compared in.
const COLUMNS: usize = 160;
/// Bands of rows, from a quarter to three quarters of the height. Farther up and down, a turn also moves things vertically.
const BANDS: usize = 12;
/// Pictures that differ by less than this show too little to tell, grey levels.
const MIN_DIFFERENCE: f64 = 1.0;
/// One turn fits if it leaves at most this share of the difference that the others leave.
const FITTING_SHARE: f64 = 0.7;
const TURNING_HINT: &str = "a heading is in radians, 0 along +y, and grows when one turns right (clockwise from above): \
                            docs/PROCESS.md, Frame. Give the negative heading to a simulator that counts counter-clockwise, and flip \
                            pictures and boxes that are mirrored";
const STILL_HINT: &str = "draw the view of `heading_rad`: docs/PROCESS.md, `observe`";

/// A picture as the mean grey levels of columns in bands of rows.
struct ColumnLevels(Vec<[f64; COLUMNS]>);

/// How much pictures differ after a turn, if it led to the right, to the left, or nowhere.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct TurnDifferences {
    right: f64,
    left: f64,
    none: f64,
}

/// Turns around at a place of a world, and compares the pictures; `None` if the world has none. Labels that contradict each other
/// are an error of the platform.
///
/// # Errors
/// When the world fails to answer, or contradicts itself.
pub(super) fn turning_finding(
    platform: &dyn Platform,
    scene: &SceneId,
    frame: &Frame,
) -> Result<Option<DoctorFinding>, PlatformError> {
    let (mut sum, mut pictures) = (TurnDifferences::default(), 0);
    for direction in 0..DIRECTIONS {
        let from = frame.pose.heading.turned_by(f64::from(direction) * std::f64::consts::TAU / f64::from(DIRECTIONS));
        let look = |heading| platform.look_from(scene, frame, ViewGaze::quarter_view(heading));
        let (before, after) = (look(from)?, look(from.turned_by(TURN_RAD))?);
        // Without pictures the labels of all views are still checked.
        if let (Some(before), Some(after)) = (before.image, after.image) {
            sum.add_turn(&before, &after);
            pictures += 1;
        }
    }
    Ok((pictures > 0).then(|| sum.to_finding()))
}

impl ColumnLevels {
    fn from_image(image: &Image) -> Self {
        let (width, height) = (image.width_px() as usize, image.height_px() as usize);
        let mut bands = vec![[0.0; COLUMNS]; BANDS];
        for (band, levels) in bands.iter_mut().enumerate() {
            let row = |at: usize| height / 4 + height * at / (2 * BANDS);
            for (column, level) in levels.iter_mut().enumerate() {
                let from = width * column / COLUMNS;
                let to = (width * (column + 1) / COLUMNS).max(from + 1);
                let (mut sum, mut count) = (0.0, 0.0);
                for row in row(band)..row(band + 1).max(row(band) + 1) {
                    let pixels = image.rgb_bytes().get((row * width + from) * 3..(row * width + to) * 3);
                    sum += pixels.unwrap_or_default().iter().map(|byte| f64::from(*byte)).sum::<f64>();
                    count += ((to - from) * 3) as f64;
                }
                *level = sum / count;
            }
        }
        Self(bands)
    }

    /// The mean difference between this view of 90 degrees and that after a turn to the right, where both show the same things. The
    /// turn is given by its tangent.
    fn difference_after(&self, after: &Self, turn: f64) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for column in 0..COLUMNS {
            // The middle of a column of the second view, as a tangent, and where the first view shows the same direction.
            let tangent = (column as f64 + 0.5) / COLUMNS as f64 * 2.0 - 1.0;
            let before = turned(tangent, turn);
            let before = ((before + 1.0) / 2.0 * COLUMNS as f64).floor();
            // The same columns for turns to both sides, so that their differences can be compared.
            if before < 0.0 || before >= COLUMNS as f64 || turned(tangent, -turn).abs() > 1.0 {
                continue;
            }
            for (first, second) in self.0.iter().zip(&after.0) {
                sum += (first[before as usize] - second[column]).abs();
                count += 1.0;
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// The tangent of the sum of two angles, by theirs.
fn turned(tangent: f64, turn: f64) -> f64 {
    (tangent + turn) / (1.0 - tangent * turn)
}

impl TurnDifferences {
    /// Compares the views before and after a turn to the right.
    fn add_turn(&mut self, before: &Image, after: &Image) {
        let (before, after) = (ColumnLevels::from_image(before), ColumnLevels::from_image(after));
        self.right += before.difference_after(&after, TURN_TANGENT);
        self.left += before.difference_after(&after, -TURN_TANGENT);
        self.none += before.difference_after(&after, 0.0);
    }

    fn to_finding(self) -> DoctorFinding {
        let Self { right, left, none } = self;
        let per_turn = none.max(left).max(right) / f64::from(DIRECTIONS);
        let problem = |told: &str, hint: &str| DoctorFinding {
            state: DoctorGrade::Problem,
            about: "turning".to_owned(),
            told: told.to_owned(),
            hint: Some(hint.to_owned()),
        };
        if none <= f64::EPSILON && per_turn >= MIN_DIFFERENCE {
            return problem("the pictures stay the same when the walker turns around", STILL_HINT);
        }
        if per_turn < MIN_DIFFERENCE {
            return ok_finding(
                "turning",
                "the pictures show too little to tell whether turns go the right way".to_owned(),
            );
        }
        let fits = |fitting: f64, one: f64, other: f64| fitting < FITTING_SHARE * one.min(other);
        if fits(left, right, none) {
            problem(
                "when the walker turns right, the things in the pictures move to the right: the world turns the other way, or its \
                 pictures are mirrored",
                TURNING_HINT,
            )
        } else if fits(right, left, none) {
            ok_finding("turning", "when the walker turns right, things move to the left, as they should".to_owned())
        } else {
            ok_finding("turning", "the pictures do not show clearly whether turns go the right way".to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a world of many posts shows in a direction: a picture of 90 degrees, drawn column by column.
    fn picture(heading_rad: f64, is_mirrored: bool) -> Image {
        let (width, height) = (320_u32, 240_u32);
        let column = |x: u32| {
            let x = if is_mirrored { width - 1 - x } else { x };
            let tangent = (f64::from(x) + 0.5) / f64::from(width) * 2.0 - 1.0;
            let direction = (heading_rad + tangent.atan()).rem_euclid(std::f64::consts::TAU);
            (127.0 + 60.0 * (direction * 5.0).sin() + 40.0 * (direction * 13.0 + 1.0).sin()) as u8
        };
        let row: Vec<u8> = (0..width).flat_map(|x| [column(x); 3]).collect();
        Image::new(width, height, row.repeat(height as usize)).unwrap()
    }

    fn turn_around(draw: impl Fn(f64) -> Image) -> DoctorFinding {
        let mut sum = TurnDifferences::default();
        for direction in 0..DIRECTIONS {
            let from = f64::from(direction) * std::f64::consts::TAU / f64::from(DIRECTIONS);
            sum.add_turn(&draw(from), &draw(from + TURN_RAD));
        }
        sum.to_finding()
    }

    #[test]
    fn turns_to_the_wrong_side_are_found() {
        let right = turn_around(|heading| picture(heading, false));
        assert!(right.state == DoctorGrade::Ok && right.told.contains("as they should"), "{}", right.told);
        for wrong in [turn_around(|heading| picture(-heading, false)), turn_around(|heading| picture(heading, true))] {
            assert!(wrong.state == DoctorGrade::Problem && wrong.told.contains("move to the right"), "{}", wrong.told);
        }
        // Mirrored, and turning the other way: both faults cancel out, as in a mirrored world. Labels tell it, pictures cannot.
        assert!(turn_around(|heading| picture(-heading, true)).state == DoctorGrade::Ok);
        let still = turn_around(|_| picture(1.0, false));
        assert!(still.state == DoctorGrade::Problem && still.told.contains("stay the same"), "{}", still.told);
        let grey = turn_around(|_| Image::new(8, 8, vec![128; 192]).unwrap());
        assert!(grey.state == DoctorGrade::Ok && grey.told.contains("too little"), "{}", grey.told);
    }
}
