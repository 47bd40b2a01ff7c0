use super::*;
use crate::worlds::{AlteredPlatform, testing::*};
use wayword_core::{Platform, ViewGaze};

/// One view through a change, and the view without it.
fn seen(change: PictureChange) -> [View; 2] {
    let (scene, path) = walk();
    let gaze = ViewGaze::quarter_view(path.frames[1].pose.heading);
    let after = AlteredPlatform::new(House, change).look_from(&scene, &path.frames[1], gaze).unwrap();
    [after, House.look_from(&scene, &path.frames[1], gaze).unwrap()]
}

fn difference(change: PictureChange) -> f64 {
    let [after, before] = seen(change);
    mean_difference(&after, &before)
}

fn mean(view: &View, colour: usize) -> f64 {
    let rgb = view.image.as_ref().unwrap().rgb_bytes();
    rgb.chunks_exact(3).map(|pixel| f64::from(pixel[colour])).sum::<f64>() / (rgb.len() / 3) as f64
}

#[test]
fn the_dose_of_no_change_is_the_identity() {
    let none = [
        PictureChange::Exposure { stops: 0.0 },
        PictureChange::ColourTemperature { kelvin: 6500.0 },
        PictureChange::Blur { sigma_px: 0.0 },
        PictureChange::Noise { percent: 0.0, seed: 1 },
        PictureChange::Jpeg { quality_percent: 100 },
    ];
    for change in none {
        let [after, before] = seen(change);
        assert_eq!(after.image, before.image, "{change:?}");
        assert_eq!(after.ground_truth(), before.ground_truth());
    }
}

#[test]
fn more_of_a_change_is_more_different() {
    for [less, more] in [
        [PictureChange::Exposure { stops: -1.0 }, PictureChange::Exposure { stops: -3.0 }],
        [PictureChange::ColourTemperature { kelvin: 5000.0 }, PictureChange::ColourTemperature { kelvin: 2500.0 }],
        [PictureChange::Blur { sigma_px: 0.7 }, PictureChange::Blur { sigma_px: 4.0 }],
        [PictureChange::Noise { percent: 2.0, seed: 1 }, PictureChange::Noise { percent: 10.0, seed: 1 }],
        [PictureChange::Jpeg { quality_percent: 90 }, PictureChange::Jpeg { quality_percent: 5 }],
    ] {
        let [less, more] = [less, more].map(difference);
        assert!(0.0 < less && less < more, "{less} {more}");
    }
}

#[test]
fn light_gets_darker_and_warmer() {
    let [dark, before] = seen(PictureChange::Exposure { stops: -2.0 });
    assert!(mean(&dark, 1) < 0.7 * mean(&before, 1));
    let [warm, before] = seen(PictureChange::ColourTemperature { kelvin: 3000.0 });
    assert!(mean(&warm, 0) > mean(&before, 0) && mean(&warm, 2) < mean(&before, 2));
}

#[test]
fn a_blur_spreads_one_pixel_and_keeps_its_light() {
    let mut rgb = vec![0; 41 * 41 * 3];
    rgb[(20 * 41 + 20) * 3] = 255;
    let after = blur::blur_image(&Image::new(41, 41, rgb).unwrap(), 1.0).unwrap();
    let light: f64 = after.rgb_bytes().iter().map(|level| light::linear_from_srgb(*level)).sum();
    assert!((light - 1.0).abs() < 0.02, "{light}");
    let at = |x: usize, y: usize| after.rgb_bytes()[(y * 41 + x) * 3];
    assert_eq!([at(19, 20), at(20, 19), at(20, 21)], [at(21, 20); 3]);
    // The middle of a gaussian of one pixel holds 0.399 of each of its two factors.
    assert_eq!(at(20, 20), light::srgb_from_linear(0.399_f64 * 0.399));
}

#[test]
fn noise_is_the_same_for_the_same_look_and_has_its_spread() {
    let noise = |seed| seen(PictureChange::Noise { percent: 4.0, seed })[0].image.clone();
    assert_eq!(noise(1), noise(1));
    assert_ne!(noise(1), noise(2));
    let grey = Image::new(100, 100, vec![128; 30_000]).unwrap();
    let noisy = noise::add_noise(&grey, 4.0, &mut wayword_core::seeded_rng(1, &["test"])).unwrap();
    let squares: f64 = noisy.rgb_bytes().iter().map(|level| (f64::from(*level) - 128.0).powi(2)).sum();
    let deviation = (squares / 30_000.0).sqrt();
    assert!((deviation - 10.2).abs() < 0.3, "{deviation}");
}
