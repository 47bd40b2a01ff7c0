//! Walks through a room that the test draws itself.

use super::estimate_film_steps;
use image::{Rgb, RgbImage};
use std::collections::BTreeMap;
use wayword_core::{CameraMotion, CameraStep, FilmTurnRules, Image, MotionSource, Side, find_film_turns};

const WIDTH: u32 = 160;
const HEIGHT: u32 = 120;
const FOV_RAD: f64 = 1.3;

/// Where a camera is in the room, and how it looks.
#[derive(Clone, Copy, Default)]
struct Eye {
    x_m: f64,
    z_m: f64,
    yaw_rad: f64,
    pitch_rad: f64,
}

fn steps(pictures: &[RgbImage]) -> Vec<CameraStep> {
    let image = |picture: &RgbImage| Image::new(WIDTH, HEIGHT, picture.as_raw().clone()).unwrap();
    let images: Vec<Image> = pictures.iter().map(image).collect();
    estimate_film_steps(&images, FOV_RAD)
}

/// A number from 0 to 1 that looks random, for three whole numbers.
fn noise(a: i64, b: i64, c: i64) -> f64 {
    let mixed = (a.wrapping_mul(0x9E37_79B9) ^ b.wrapping_mul(0x85EB_CA6B) ^ c.wrapping_mul(0xC2B2_AE35))
        .wrapping_mul(0x27D4_EB2F);
    ((mixed ^ (mixed >> 15)).wrapping_mul(0x2C1B_3C6D) >> 12 & 0xFFFF) as f64 / 65535.0
}

/// The brightness of a wall: tiles of random greys, 0.4 m wide and 0.6 m high, on a wall of its own grey.
fn wall(side: i64, along_m: f64, up_m: f64) -> f64 {
    60.0 + 40.0 * noise(side, 99, 7) + 90.0 * noise(side, (along_m / 0.4).floor() as i64, (up_m / 0.6).floor() as i64)
}

/// What a camera sees in a room 8 m long, 6 m wide and 2.8 m high, around the origin.
fn draw(eye: Eye) -> RgbImage {
    let focal_px = f64::from(WIDTH) / 2.0 / libm::tan(FOV_RAD / 2.0);
    RgbImage::from_fn(WIDTH, HEIGHT, |column, row| {
        let right = (f64::from(column) + 0.5 - f64::from(WIDTH) / 2.0) / focal_px;
        let up = -(f64::from(row) + 0.5 - f64::from(HEIGHT) / 2.0) / focal_px;
        let (up, ahead) = (
            up * libm::cos(eye.pitch_rad) + libm::sin(eye.pitch_rad),
            libm::cos(eye.pitch_rad) - up * libm::sin(eye.pitch_rad),
        );
        let x = right * libm::cos(eye.yaw_rad) + ahead * libm::sin(eye.yaw_rad);
        let z = ahead * libm::cos(eye.yaw_rad) - right * libm::sin(eye.yaw_rad);
        let reach =
            |from: f64, way: f64, half: f64| if way == 0.0 { f64::MAX } else { (half * way.signum() - from) / way };
        let (far_x, far_z, far_y) = (reach(eye.x_m, x, 3.0), reach(eye.z_m, z, 4.0), reach(0.0, up, 1.4));
        let far = far_x.min(far_z).min(far_y);
        let (x_m, y_m, z_m) = (eye.x_m + far * x, far * up, eye.z_m + far * z);
        let grey = if far == far_y {
            wall(if up > 0.0 { 5 } else { 6 }, x_m, z_m)
        } else if far == far_x {
            wall(if x > 0.0 { 1 } else { 2 }, z_m, y_m)
        } else {
            wall(if z > 0.0 { 3 } else { 4 }, x_m, y_m)
        };
        Rgb([grey as u8; 3])
    })
}

fn yaws(eyes: &[Eye]) -> Vec<Option<f64>> {
    let pictures: Vec<RgbImage> = eyes.iter().map(|&eye| draw(eye)).collect();
    steps(&pictures).iter().map(|step| step.turn_rad).collect()
}

#[test]
fn yaw_on_the_spot_is_measured_to_either_side() {
    for degrees in [-25.0_f64, -10.0, -3.0, 3.0, 10.0, 25.0] {
        let from = Eye { x_m: 0.4, z_m: -1.0, yaw_rad: 0.3, ..Eye::default() };
        let to = Eye { yaw_rad: 0.3 + degrees.to_radians(), ..from };
        let yaw = yaws(&[from, to])[0].unwrap().to_degrees();
        assert!((yaw - degrees).abs() < 1.0, "{degrees}: {yaw}");
    }
}

#[test]
fn walking_past_a_near_wall_is_no_yaw() {
    // Half a metre from the wall on the right.
    let eyes: Vec<Eye> =
        (0..8).map(|at| Eye { x_m: 2.5, z_m: -3.0 + 0.25 * f64::from(at), ..Eye::default() }).collect();
    let yaws = yaws(&eyes);
    assert!(yaws.iter().flatten().count() >= 5, "{yaws:?}");
    assert!(yaws.iter().flatten().all(|yaw| yaw.to_degrees().abs() < 2.0), "{yaws:?}");
}

#[test]
fn yaw_is_measured_while_the_camera_walks_and_nods() {
    let from = Eye { x_m: -1.0, z_m: -2.0, yaw_rad: 0.1, pitch_rad: 0.0 };
    let to = Eye { x_m: -0.95, z_m: -1.75, yaw_rad: 0.3, pitch_rad: 0.03 };
    let yaw = yaws(&[from, to])[0].unwrap();
    assert!((yaw - 0.2).abs() < 0.02, "{yaw}");
}

#[test]
fn pictures_that_share_nothing_are_undecided() {
    let from = Eye { x_m: 0.4, z_m: -1.0, ..Eye::default() };
    assert_eq!(yaws(&[from, Eye { yaw_rad: 2.0, ..from }]), vec![None]);
    let flat = RgbImage::from_pixel(WIDTH, HEIGHT, Rgb([90, 90, 90]));
    assert_eq!(steps(&[flat.clone(), flat])[0].turn_rad, None);
}

#[test]
fn a_fixed_camera_does_not_move_when_a_box_does() {
    let background = draw(Eye { z_m: -2.0, ..Eye::default() });
    let pictures: Vec<RgbImage> = (0..12_u32)
        .map(|at| {
            let mut picture = background.clone();
            for (column, row) in (0..40).flat_map(|column| (0..60).map(move |row| (column, row))) {
                let grey = (200.0 * noise(8, i64::from(column / 8), i64::from(row / 8))) as u8;
                picture.put_pixel(at * 9 + column, row + 40, Rgb([grey; 3]));
            }
            picture
        })
        .collect();
    let steps = steps(&pictures);
    let film = CameraMotion {
        source: MotionSource::Pictures,
        pictures: (0..pictures.len()).collect(),
        times_s: (0..pictures.len()).map(|at| at as f64 / 4.0).collect(),
        steps,
        frames: BTreeMap::new(),
    };
    assert!(film.stands_still(), "{film:?}");
    assert_eq!(find_film_turns(&film.turns_rad(), FilmTurnRules::at_rate(4.0)), vec![]);
}

#[test]
fn a_walk_with_a_turn_to_the_left_has_that_turn() {
    let mut eyes = vec![Eye { x_m: 1.0, z_m: -3.0, ..Eye::default() }];
    let mut go = |ahead_m: f64, turn_rad: f64| {
        let last = *eyes.last().unwrap();
        let yaw_rad = last.yaw_rad + turn_rad;
        let (x_m, z_m) = (last.x_m + ahead_m * libm::sin(yaw_rad), last.z_m + ahead_m * libm::cos(yaw_rad));
        eyes.push(Eye { x_m, z_m, yaw_rad, ..last });
    };
    (0..5).for_each(|_| go(0.25, 0.0));
    (0..5).for_each(|_| go(0.0, -15_f64.to_radians()));
    (0..5).for_each(|_| go(0.25, 0.0));
    let turns = find_film_turns(&yaws(&eyes), FilmTurnRules::at_rate(4.0));
    assert_eq!(turns.len(), 1, "{turns:?}");
    assert_eq!((turns[0].side, turns[0].from_frame, turns[0].to_frame), (Side::Left, 5, 10));
    assert!((turns[0].angle_rad.to_degrees() - 75.0).abs() < 3.0, "{turns:?}");
}

#[test]
fn a_bad_picture_is_bridged() {
    let eyes: Vec<Eye> = (0..5).map(|at| Eye { z_m: -1.0, yaw_rad: 0.12 * f64::from(at), ..Eye::default() }).collect();
    let mut pictures: Vec<RgbImage> = eyes.iter().map(|&eye| draw(eye)).collect();
    pictures[2] = RgbImage::new(WIDTH, HEIGHT);
    let turns: Option<Vec<f64>> = steps(&pictures).iter().map(|step| step.turn_rad).collect();
    let sum: f64 = turns.unwrap().iter().sum();
    assert!((sum - 0.48).abs() < 0.03, "{sum}");
}
