//! A cube map must be sampled in the orientation in which it was given.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use glam::{DMat3, DVec3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use wayword_render::{CubeMap, CubeMapError, Face, sample_view};

const SIDE: u32 = 16;

/// Faces of noise, so that no face looks like another or like itself turned.
fn noise() -> CubeMap {
    let mut state = 1u32;
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    CubeMap::new(std::array::from_fn(|_| Face { side_px: SIDE, rgb: (0..SIDE * SIDE * 3).map(|_| byte()).collect() }))
        .unwrap()
}

/// The pose whose skybox x is east, y down and z north.
fn upright() -> DMat3 {
    DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y)
}

fn assert_shows(pose: &DMat3, heading: f64, elevation: f64, face: usize) {
    let cube = noise();
    let view = sample_view(&cube, pose, heading, elevation, FRAC_PI_2, SIDE, SIDE).unwrap();
    let off = view.iter().zip(&cube.faces()[face].rgb).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(off <= Some(1), "face {face}: off by {off:?}");
}

#[test]
fn a_square_view_of_a_quarter_turn_is_the_face_itself() {
    for (heading, face) in [(0.0, 3), (FRAC_PI_2, 4), (PI, 1), (-FRAC_PI_2, 2)] {
        assert_shows(&upright(), heading, 0.0, face);
    }
    assert_shows(&upright(), PI, FRAC_PI_2, 0);
    assert_shows(&upright(), PI, -FRAC_PI_2, 5);
}

#[test]
fn a_turned_pose_turns_the_view() {
    // Counter-clockwise from above: north of the skybox is west of the world.
    let turned = DMat3::from_rotation_z(FRAC_PI_2) * upright();
    assert_shows(&turned, -FRAC_PI_2, 0.0, 3);
    assert_shows(&turned, 0.0, 0.0, 4);
}

#[test]
fn a_strip_is_its_faces_side_by_side() {
    let cube = noise();
    let side = SIDE as usize;
    let mut strip = Vec::new();
    for row in 0..side {
        for face in cube.faces() {
            strip.extend_from_slice(&face.rgb[3 * side * row..3 * side * (row + 1)]);
        }
    }
    assert_eq!(CubeMap::from_strip(6 * SIDE, SIDE, &strip), Ok(cube));
    let cut = CubeMap::from_strip(6 * SIDE, SIDE, &strip[1..]);
    assert!(matches!(cut, Err(CubeMapError::Strip { .. })));
    assert!(CubeMap::from_strip(0, 0, &[]).is_err());
    assert!(CubeMap::from_strip(u32::MAX, u32::MAX, &[]).is_err());
}

#[test]
fn refuses_torn_faces_and_impossible_views() {
    let mut faces = noise().faces().clone();
    faces[4].rgb.pop();
    assert!(matches!(CubeMap::new(faces), Err(CubeMapError::Face { face: 4, .. })));
    let view = |heading, fov, width| sample_view(&noise(), &upright(), heading, 0.0, fov, width, 4);
    assert!(view(f64::NAN, 1.0, 4).is_err());
    assert!(view(0.0, 4.0, 4).is_err());
    assert!(view(0.0, 1.0, 0).is_err());
    assert!(sample_view(&noise(), &DMat3::NAN, 0.0, 0.0, 1.0, 4, 4).is_err());
}

proptest! {
    #[test]
    fn every_direction_finds_its_face(heading in 0.0..6.3f64, elevation in -1.57..1.57f64) {
        let faces = std::array::from_fn(|n| Face { side_px: 4, rgb: vec![40 * n as u8; 48] });
        let cube = CubeMap::new(faces).unwrap();
        let centre = sample_view(&cube, &upright(), heading, elevation, 0.01, 1, 1).unwrap()[0];
        let (east, north) = (heading.sin() * elevation.cos(), heading.cos() * elevation.cos());
        let up = elevation.sin();
        let sides = [(up, 0), (-north, 1), (-east, 2), (north, 3), (east, 4), (-up, 5)];
        let mut ranked = sides;
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        prop_assume!(ranked[0].0 - ranked[1].0 > 1e-5);
        prop_assert_eq!(centre, 40 * ranked[0].1);
    }
}
