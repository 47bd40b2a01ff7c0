//! A cube map must be sampled in the orientation in which it was given.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use glam::{DMat3, DVec3, Vec3};
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use wayword_render::{CubeFace, CubeMap, CubeMapError, PinholeCamera, sample_view};

const SIDE: u32 = 16;

/// Faces of noise, so that no face looks like another or like itself turned.
fn noise() -> [CubeFace; 6] {
    let mut state = 1u32;
    let mut byte = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    std::array::from_fn(|_| CubeFace { side_px: SIDE, rgb: (0..SIDE * SIDE * 3).map(|_| byte()).collect() })
}

/// The pose of a skybox with x to the east, y down and z to the north.
fn upright() -> DMat3 {
    DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y)
}

fn assert_shows(pose: &DMat3, heading: f64, elevation: f64, face: usize) {
    let faces = noise();
    let cube = CubeMap::new(faces.clone()).unwrap();
    let view = sample_view(&cube, pose, heading, elevation, FRAC_PI_2, SIDE, SIDE).unwrap();
    let off = view.iter().zip(&faces[face].rgb).map(|(a, b)| a.abs_diff(*b)).max();
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
    let faces = noise();
    let side = SIDE as usize;
    let mut strip = Vec::new();
    for row in 0..side {
        for face in &faces {
            strip.extend_from_slice(&face.rgb[3 * side * row..3 * side * (row + 1)]);
        }
    }
    assert_eq!(CubeMap::from_strip(6 * SIDE, SIDE, &strip), CubeMap::new(faces));
    let cut = CubeMap::from_strip(6 * SIDE, SIDE, &strip[1..]);
    assert!(matches!(cut, Err(CubeMapError::Strip { .. })));
    assert!(CubeMap::from_strip(0, 0, &[]).is_err());
    assert!(CubeMap::from_strip(u32::MAX, u32::MAX, &[]).is_err());
}

#[test]
fn refuses_torn_faces_and_impossible_views() {
    let mut faces = noise();
    faces[4].rgb.pop();
    assert!(matches!(CubeMap::new(faces), Err(CubeMapError::Face { face: 4, .. })));
    let cube = CubeMap::new(noise()).unwrap();
    let view = |heading, fov, width| sample_view(&cube, &upright(), heading, 0.0, fov, width, 4);
    assert!(view(f64::NAN, 1.0, 4).is_err());
    assert!(view(0.0, 4.0, 4).is_err());
    assert!(view(0.0, 1.0, 0).is_err());
    assert!(sample_view(&cube, &DMat3::NAN, 0.0, 0.0, 1.0, 4, 4).is_err());
    let flat = sample_view(&cube, &DMat3::ZERO, 0.0, 0.0, 1.0, 4, 4);
    assert!(flat.is_ok(), "no rotation, so no view; it must not panic either");
}

/// The colour in a direction as the definition has it: one ray at a time, between the four nearest pixels of its side.
fn looked_up(faces: &[CubeFace; 6], direction: Vec3) -> [u8; 3] {
    let Vec3 { x, y, z } = direction;
    let size = direction.abs();
    let (face, s, t, major) = if size.x >= size.y && size.x >= size.z {
        if x >= 0.0 { (2, -z, -y, size.x) } else { (4, z, -y, size.x) }
    } else if size.y >= size.z {
        if y >= 0.0 { (0, x, z, size.y) } else { (5, x, -z, size.y) }
    } else if z >= 0.0 {
        (1, x, -y, size.z)
    } else {
        (3, -x, -y, size.z)
    };
    let CubeFace { side_px, rgb } = &faces[face];
    let side = *side_px as usize;
    let split = |place: f32| {
        let at = ((place * (0.5 / major) + 0.5) * side as f32 - 0.5).clamp(0.0, (side - 1) as f32);
        (at as usize, (at as usize + 1).min(side - 1), at - at.floor())
    };
    let ((left, right, across), (above, below, down)) = (split(s), split(t));
    std::array::from_fn(|channel| {
        let pixel = |x: usize, y: usize| f32::from(rgb[3 * (y * side + x) + channel]);
        let top = pixel(left, above) + (pixel(right, above) - pixel(left, above)) * across;
        let bottom = pixel(left, below) + (pixel(right, below) - pixel(left, below)) * across;
        (top + (bottom - top) * down + 0.5) as u8
    })
}

proptest! {
    /// A row is drawn many columns at a time: that changes hardly a level. Widths around the columns of one step, and faces of any
    /// size down to one pixel.
    #[test]
    fn a_view_is_its_rays_one_by_one(
        heading in 0.0..6.3f64, elevation in -1.57..1.57f64, fov in 0.2..2.8f64, width in 1..150u32, side_px in 1..20u32,
    ) {
        let faces = noise().map(|face| CubeFace { side_px, rgb: face.rgb.repeat(2)[..3 * (side_px * side_px) as usize].into() });
        let height = 3;
        let camera = PinholeCamera {
            position: DVec3::ZERO, heading_rad: heading, elevation_rad: elevation, vertical_fov_rad: fov, width, height,
        };
        let axes = -(upright().transpose() * camera.world_from_camera());
        let (right, up, forward) = (axes.x_axis.as_vec3(), axes.y_axis.as_vec3(), -axes.z_axis.as_vec3());
        let pixel = ((0.5 * fov).tan() / (0.5 * f64::from(height))) as f32;
        let view = sample_view(&CubeMap::new(faces.clone()).unwrap(), &upright(), heading, elevation, fov, width, height).unwrap();
        for (at, colour) in (0..).zip(view.chunks(3)) {
            let (x, y) = ((at % width) as f32, (at / width) as f32);
            let start = forward + up * ((0.5 * height as f32 - (y + 0.5)) * pixel);
            let ray = start + right * ((x + 0.5 - 0.5 * width as f32) * pixel);
            let alone = looked_up(&faces, ray);
            prop_assert!(colour.iter().zip(alone).all(|(a, b)| a.abs_diff(b) <= 1), "pixel {at}: {colour:?}, {alone:?}");
        }
    }

    #[test]
    fn every_direction_finds_its_face(heading in 0.0..6.3f64, elevation in -1.57..1.57f64) {
        let faces = std::array::from_fn(|n| CubeFace { side_px: 4, rgb: vec![40 * n as u8; 48] });
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
