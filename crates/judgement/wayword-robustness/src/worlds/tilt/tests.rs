use super::*;
use crate::worlds::{AlteredPlatform, testing::*};
use wayword_core::{Heading, ObjectId, Platform, Pose};

fn tilted(pitch_deg: f64, roll_deg: f64) -> AlteredPlatform<House, CameraTilt> {
    AlteredPlatform::new(House, CameraTilt::new(pitch_deg, roll_deg).unwrap())
}

/// Views along a path, ahead of each frame.
fn views(platform: &impl Platform) -> Vec<View> {
    let (scene, path) = walk();
    let look = |frame: &Frame| platform.look_from(&scene, frame, ViewGaze::quarter_view(frame.pose.heading)).unwrap();
    path.frames.iter().map(look).collect()
}

#[test]
fn no_tilt_is_the_identity_and_hardly_any_is_nearly() {
    for ((level, none), hardly) in views(&House).iter().zip(views(&tilted(0.0, 0.0))).zip(views(&tilted(1e-7, 1e-7))) {
        assert_eq!((&level.image, labels(level)), (&none.image, labels(&none)));
        let rgb = |view: &View| view.image.clone().unwrap().rgb_bytes().to_vec();
        let off = rgb(level).into_iter().zip(rgb(&hardly)).filter(|(a, b)| a.abs_diff(*b) > 1).count();
        assert!(off < 60, "{off}");
        let objects = |view: &View| labels(view).iter().map(|label| label.object.clone()).collect::<Vec<ObjectId>>();
        assert_eq!(objects(level), objects(&hardly));
    }
}

#[test]
fn tilts_that_no_level_view_reaches_are_refused() {
    assert_eq!(CameraTilt::new(31.0, 0.0), Err(TiltError::Pitch(31.0)));
    assert!(CameraTilt::new(0.0, f64::NAN).is_err());
    assert!(CameraTilt::new(-30.0, 45.0).is_ok());
}

#[test]
fn the_whole_picture_is_covered_within_the_limits() {
    for (pitch_deg, roll_deg) in [(30.0, 0.0), (-30.0, 0.0), (0.0, 45.0), (15.0, 20.0)] {
        let tilt = CameraTilt::new(pitch_deg, roll_deg).unwrap();
        let fov = std::f64::consts::FRAC_PI_2;
        let warp = TiltWarp {
            level_from_tilted: tilt.level_from_tilted(),
            level_tan: libm::tan(tilt.covering_rad(fov) / 2.0),
            tilted_tan: libm::tan(fov / 2.0),
            size: [640.0, 480.0],
        };
        for corner in [[0.5, 0.5], [639.5, 0.5], [0.5, 479.5], [639.5, 479.5]] {
            assert!(warp.level_px(corner).is_some(), "{pitch_deg} {roll_deg} {corner:?}");
        }
    }
}

/// A label at a direction from an eye that looks north.
fn at(heading_deg: f64, elevation_deg: f64) -> ObjectLabel {
    ObjectLabel {
        object: ObjectId::new("1").unwrap(),
        name: "lamp".to_owned(),
        heading: Heading::NORTH.turned_by(heading_deg.to_radians()),
        elevation_rad: elevation_deg.to_radians(),
        box_px: None,
        distance_m: None,
        position: None,
        colour: None,
        room: None,
    }
}

#[test]
fn a_camera_that_looks_up_loses_the_floor_and_one_that_is_rolled_turns_its_picture() {
    let warp = |pitch_deg: f64, roll_deg: f64| TiltWarp {
        level_from_tilted: CameraTilt::new(pitch_deg, roll_deg).unwrap().level_from_tilted(),
        level_tan: 3.0,
        tilted_tan: 1.0,
        size: [640.0, 480.0],
    };
    let seen = |warp: &TiltWarp, label: ObjectLabel| warp.tilt_label(label, Heading::NORTH, true).is_some();
    let (level, up) = (warp(0.0, 0.0), warp(20.0, 0.0));
    assert!(seen(&level, at(0.0, -30.0)) && !seen(&up, at(0.0, -30.0)));
    assert!(!seen(&level, at(0.0, 50.0)) && seen(&up, at(0.0, 50.0)));
    // A thing 20 degrees up is in the middle of a camera that looks there.
    let [x, y] = up.tilted_px([320.0, 240.0 - 320.0 / 3.0 * libm::tan(20f64.to_radians())]).unwrap();
    assert!((x - 320.0).abs() < 1e-9 && (y - 240.0).abs() < 1e-9);
    // Rolled clockwise, things on the right move up.
    let [x, y] = warp(0.0, 45.0).tilted_px([420.0, 240.0]).unwrap();
    assert!(x > 320.0 && y < 240.0, "{x} {y}");
    let [back_x, back_y] = warp(12.0, -9.0).level_px(warp(12.0, -9.0).tilted_px([400.0, 200.0]).unwrap()).unwrap();
    assert!((back_x - 400.0).abs() < 1e-9 && (back_y - 200.0).abs() < 1e-9);
}

#[test]
fn boxes_go_with_their_pixels() {
    // A white square in a grey level picture is where its box is after the tilt.
    let mut rgb = vec![90; 160 * 120 * 3];
    for y in 50..60 {
        rgb[(y * 160 + 70) * 3..(y * 160 + 80) * 3].fill(255);
    }
    let level = Image::new(160, 120, rgb).unwrap();
    let warp = TiltWarp {
        level_from_tilted: CameraTilt::new(8.0, 10.0).unwrap().level_from_tilted(),
        level_tan: 1.5,
        tilted_tan: 1.0,
        size: [160.0, 120.0],
    };
    let [x, y, width, height] = warp.tilted_box([70.0, 50.0, 10.0, 10.0]).unwrap();
    let tilted = redraw_tilted(&warp, &level);
    for (number, pixel) in tilted.rgb_bytes().chunks_exact(3).enumerate().filter(|(_, pixel)| pixel[0] > 200) {
        let [px, py] = [(number % 160) as f64 + 0.5, (number / 160) as f64 + 0.5];
        assert!((x..=x + width).contains(&px) && (y..=y + height).contains(&py), "{px} {py} {pixel:?}");
    }
    assert!(tilted.rgb_bytes().iter().filter(|level| **level > 200).count() > 300);
}

#[test]
fn a_tilted_view_contains_its_elevation_and_has_no_depth() {
    let (scene, path) = walk();
    let gaze = ViewGaze::quarter_view(path.frames[0].pose.heading);
    let view = tilted(-10.0, 0.0).look_from(&scene, &path.frames[0], gaze).unwrap();
    let pose = Pose {
        elevation_rad: (-10f64).to_radians(),
        ..Pose::looking_level(path.frames[0].pose.position, gaze.heading)
    };
    assert_eq!(view.pose, pose);
    assert_eq!(view.horizontal_fov_rad, gaze.horizontal_fov_rad);
    assert!(tilted(-10.0, 0.0).ground().view_depth(&scene, &path.frames[0], gaze).unwrap().is_none());
}
