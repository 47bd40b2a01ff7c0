//! Tests of the choice of frames, on recordings that are painted in memory.

use super::*;
use crate::{
    describe::RecordingDescription,
    reel::{PictureReel, TakePicture},
    track::{CameraTrack, TrackFix},
};
use proptest::prelude::*;
use wayword_core::DVec3;

/// Pictures that are painted on demand.
struct Painted {
    times_s: Vec<f64>,
    paint: fn(usize) -> Image,
}

impl PictureReel for Painted {
    fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    fn picture_name(&self, number: usize) -> String {
        number.to_string()
    }

    fn hand_out_pictures(&self, wanted: &[usize], take: &mut TakePicture<'_>) -> Result<(), PlatformError> {
        wanted.iter().try_for_each(|number| take(*number, (self.paint)(*number)))
    }
}

/// Stripes at a position that depends on the number; `blur` widens their edges, pixels.
fn stripes(number: usize, blur: usize) -> Image {
    let (width, height) = (320, 240);
    let row: Vec<f64> =
        (0..width).map(|x| if ((x + 7 * number) / 16).is_multiple_of(2) { 220.0 } else { 30.0 }).collect();
    let blurred = |x: usize| {
        let near = x.saturating_sub(blur)..=(x + blur).min(width - 1);
        let count = near.clone().count() as f64;
        near.map(|at| row[at]).sum::<f64>() / count
    };
    let pixels: Vec<u8> = (0..width).flat_map(|x| [blurred(x) as u8; 3]).collect();
    Image::new(width as u32, height, pixels.repeat(height as usize)).unwrap()
}

fn recording(count: usize, paint: fn(usize) -> Image, track: Option<Vec<TrackFix>>) -> Recording {
    let times_s = (0..count).map(|at| at as f64 / 10.0).collect();
    let reel = Box::new(Painted { times_s, paint });
    let track = track.and_then(CameraTrack::new);
    Recording { reel, track, horizontal_fov_rad: None, described: RecordingDescription::default() }
}

fn fix(at: usize, x_m: f64, deg: f64) -> TrackFix {
    TrackFix {
        time_s: at as f64 / 10.0,
        position: DVec3::new(x_m, 0.0, 1.5),
        heading: Heading::new(deg.to_radians()).ok(),
    }
}

fn chosen(recording: &Recording) -> FrameChoice {
    choose_frames(recording, &mut |_, _| {}).unwrap()
}

#[test]
fn without_poses_frames_are_equally_far_apart_in_time() {
    let choice = chosen(&recording(101, |number| stripes(number, 0), None));
    assert_eq!(choice.stops, [0, 20, 40, 60, 80, 100]);
    assert_eq!((choice.blurred, choice.alike, choice.without_pose), (0, 0, 0));
}

#[test]
fn with_poses_frames_are_equally_far_apart_in_space_and_standing_makes_none() {
    // Half a metre a second for four seconds, a stop of six seconds, then half a metre a second again.
    let x_m = |at: usize| 0.05 * (at.min(40) + at.saturating_sub(100)) as f64;
    // A tracker's positions jitter.
    let fixes = (0..=140).map(|at| fix(at, x_m(at) + if at % 2 == 0 { 0.004 } else { -0.004 }, 90.0)).collect();
    let choice = chosen(&recording(141, |number| stripes(number, 0), Some(fixes)));
    let places: Vec<f64> = choice.stops.iter().map(|at| (10.0 * x_m(*at)).round() / 10.0).collect();
    assert_eq!(places, [0.0, 1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn pictures_that_are_nearly_an_interval_apart_are_all_frames() {
    let fixes = (0..=4).map(|at| fix(at, 0.94 * at as f64, 90.0)).collect();
    let choice = chosen(&recording(5, |number| stripes(number, 0), Some(fixes)));
    assert_eq!(choice.stops, [0, 1, 2, 3, 4]);
}

#[test]
fn a_blurred_picture_gives_way_to_a_sharp_neighbour_and_a_blurred_place_is_left_out() {
    let paint = |number: usize| stripes(number, if number == 20 || (35..=45).contains(&number) { 9 } else { 0 });
    let choice = chosen(&recording(101, paint, None));
    assert_eq!(choice.stops.len(), 5);
    assert!((17..=23).contains(&choice.stops[1]) && choice.stops[1] != 20, "{choice:?}");
    assert_eq!(choice.stops[2], 60);
    assert_eq!(choice.blurred, 1);
}

#[test]
fn repeated_pictures_become_one_frame_except_at_the_end() {
    let choice = chosen(&recording(101, |number| stripes(number.clamp(10, 70), 0), None));
    assert_eq!(choice.stops, [0, 20, 40, 60, 100]);
    assert_eq!(choice.alike, 1);
    let standing = chosen(&recording(101, |_| stripes(0, 0), None));
    assert_eq!(standing.stops, [0]);
}

#[test]
fn pictures_that_look_aside_are_left_out() {
    let deg = |at: usize| if (15..=25).contains(&at) { 200.0 } else { 90.0 };
    let fixes = (0..=60).map(|at| fix(at, at as f64 / 20.0, deg(at))).collect();
    let choice = chosen(&recording(61, |number| stripes(number, 0), Some(fixes)));
    assert_eq!((choice.stops, choice.turned_away), (vec![0, 40, 60], 1));
}

#[test]
fn only_pictures_that_a_walker_would_be_shown_are_frames() {
    // A view is 90 degrees wide: a picture that was taken 50 degrees off the way is not in the view ahead.
    let deg = |at: usize| if (15..=25).contains(&at) { 140.0 } else { 130.0 };
    let fixes = (0..=60).map(|at| fix(at, at as f64 / 20.0, deg(at))).collect();
    let choice = chosen(&recording(61, |number| stripes(number, 0), Some(fixes)));
    assert_eq!((choice.stops, choice.turned_away), (vec![0, 40, 60], 1));
}

#[test]
fn at_the_end_the_picture_along_the_way_is_taken_and_not_the_last_one() {
    // After arriving, the camera turns on the spot.
    let x_m = |at: usize| at.min(40) as f64 / 20.0;
    let fixes = (0..=60).map(|at| fix(at, x_m(at), if at > 44 { 180.0 } else { 90.0 })).collect();
    let choice = chosen(&recording(61, |number| stripes(number, 0), Some(fixes)));
    assert!((37..=44).contains(choice.stops.last().unwrap()), "{choice:?}");
}

#[test]
fn gaps_in_the_track_become_breaks() {
    // The camera moved ten metres while the tracker was lost.
    let fixes = (0..=40).map(|at| fix(at, at as f64 / 20.0, 90.0));
    let fixes = fixes.chain((70..=100).map(|at| fix(at, 10.0 + (at - 70) as f64 / 20.0, 90.0))).collect();
    let choice = chosen(&recording(101, |number| stripes(number, 0), Some(fixes)));
    let pieces: Vec<usize> = choice.breaks.iter().map(|at| choice.stops[*at]).collect();
    assert!(matches!(pieces[..], [69..=70]), "{choice:?}");

    // The camera looked sideways for five metres.
    let deg = |at: usize| if (10..=110).contains(&at) { 180.0 } else { 90.0 };
    let fixes = (0..=160).map(|at| fix(at, at as f64 / 20.0, deg(at))).collect();
    let choice = chosen(&recording(161, |number| stripes(number, 0), Some(fixes)));
    assert_eq!(choice.turned_away, 4);
    assert_eq!(choice.breaks.iter().map(|at| choice.stops[*at]).collect::<Vec<_>>(), [80]);

    // Without poses the way is not known at all, so there are no gaps.
    let choice = chosen(&recording(201, |number| stripes(number.clamp(20, 180), 0), None));
    let alike = chosen(&recording(201, |number| stripes(if number < 160 { 0 } else { number }, 0), None));
    assert!(choice.breaks.is_empty() && alike.breaks.is_empty() && alike.alike > 3, "{alike:?}");
}

#[test]
fn pictures_without_a_pose_are_counted_and_left_out() {
    let fixes = (20..=60).map(|at| fix(at, at as f64 / 20.0, 90.0)).collect();
    let choice = chosen(&recording(101, |number| stripes(number, 0), Some(fixes)));
    // A pose also counts for pictures a tenth of a second away, give or take rounding.
    assert!((19..=20).contains(&choice.stops[0]) && (60..=61).contains(choice.stops.last().unwrap()), "{choice:?}");
    assert!((101 - 43..=101 - 41).contains(&choice.without_pose), "{choice:?}");
}

#[test]
fn a_recording_without_pictures_has_no_frames() {
    assert_eq!(chosen(&recording(0, |number| stripes(number, 0), None)), FrameChoice::default());
    assert_eq!(chosen(&recording(1, |number| stripes(number, 0), None)).stops, [0]);
}

proptest! {
    #[test]
    fn any_recording_gives_frames_in_order(
        steps in prop::collection::vec((0.0..0.6f64, -30.0..30.0f64), 1..60), posed in any::<bool>(),
    ) {
        let (mut x_m, mut deg) = (0.0, 0.0);
        let fixes = steps.iter().enumerate().map(|(at, (step_m, turn))| {
            (x_m, deg) = (x_m + step_m, deg + turn);
            fix(at, x_m, deg)
        });
        let fixes: Vec<TrackFix> = fixes.collect();
        let choice = chosen(&recording(steps.len(), |number| stripes(number, number % 5), posed.then_some(fixes)));
        prop_assert!(!choice.stops.is_empty());
        prop_assert!(choice.stops.windows(2).all(|pair| pair[0] < pair[1]));
        prop_assert!(choice.stops.iter().all(|stop| *stop < steps.len()));
    }
}
