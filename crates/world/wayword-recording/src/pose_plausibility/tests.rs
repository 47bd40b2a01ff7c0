//! Tests of the doubt about poses, on paths that are made here in the axes of the test.

use super::*;
use std::f64::consts::FRAC_PI_2;

/// A path in a world with z up: its places, with an OpenGL camera that looks along each step, tilted down by some
/// radians.
fn walk(places: &[[f64; 3]], tilt_rad: f64) -> Vec<PoseSample> {
    let places: Vec<DVec3> = places.iter().map(|place| DVec3::from(*place)).collect();
    let mut samples = Vec::new();
    let mut ahead = DVec3::Y;
    for pair in places.windows(2) {
        ahead = (pair[1] - pair[0]).with_z(0.0).normalize_or(ahead);
        let right = ahead.cross(DVec3::Z);
        let looking = ahead * tilt_rad.cos() - DVec3::Z * tilt_rad.sin();
        let held = Some([right, right.cross(looking), -looking]);
        let steps = (pair[0].distance(pair[1]) / 0.25).ceil();
        let at = |step: usize| pair[0].lerp(pair[1], step as f64 / steps);
        samples.extend((0..steps as usize).map(|step| PoseSample { position: at(step), recorded_from_body: held }));
    }
    samples
}

/// A path through rooms: north, east, south, with 5 cm of bobbing.
fn level() -> Vec<PoseSample> {
    walk(&[[0.0, 0.0, 1.5], [0.0, 6.0, 1.55], [5.0, 6.0, 1.5], [5.0, 1.0, 1.55]], 0.2)
}

/// The same poses in a world with y up.
fn with_y_up(samples: Vec<PoseSample>) -> Vec<PoseSample> {
    let turn = |place: DVec3| DVec3::new(place.x, place.z, -place.y);
    let turned = |sample: PoseSample| PoseSample {
        position: turn(sample.position),
        recorded_from_body: sample.recorded_from_body.map(|held| held.map(turn)),
    };
    samples.into_iter().map(turned).collect()
}

fn without_orientation(samples: Vec<PoseSample>) -> Vec<PoseSample> {
    samples.into_iter().map(|sample| PoseSample { recorded_from_body: None, ..sample }).collect()
}

fn found(samples: &[PoseSample], axes: PoseAxes) -> Option<PoseDoubt> {
    find_doubt(samples, axes, &RecordingDescription::default())
}

const OPEN_GL: PoseAxes = PoseAxes::for_body(PoseBody::OpenGl);

#[test]
fn y_up_taken_for_z_up_is_refused_with_the_setting_that_mends_it() {
    let samples = with_y_up(level());
    let Some(PoseDoubt::Misread(words)) = found(&samples, OPEN_GL) else { panic!("it is misread") };
    assert!(words.contains("Write world = \"y-up\" into a recording.toml"), "{words}");
    assert_eq!(found(&samples, PoseAxes { world: WorldUpAxis::YUp, ..OPEN_GL }), None);
    // What the user set is not questioned.
    let described = RecordingDescription {
        world: Some(WorldUpAxis::ZUp),
        orientation: Some(PoseBody::OpenGl),
        ..RecordingDescription::default()
    };
    assert_eq!(find_doubt(&samples, OPEN_GL, &described), None);
}

#[test]
fn both_settings_are_named_where_both_are_wrong() {
    let Some(PoseDoubt::Misread(words)) = found(&with_y_up(level()), PoseAxes::for_body(PoseBody::Robot)) else {
        panic!("it is misread")
    };
    assert!(words.contains("Write world = \"y-up\" and orientation = \"open-gl\" into"), "{words}");
}

#[test]
fn a_body_that_is_taken_for_another_is_odd() {
    let Some(PoseDoubt::Odd(words)) = found(&level(), PoseAxes::for_body(PoseBody::Robot)) else { panic!("it is odd") };
    assert!(words.contains("Write orientation = \"open-gl\" into"), "{words}");
}

#[test]
fn places_alone_that_keep_to_an_upright_plane_are_odd() {
    let Some(PoseDoubt::Odd(words)) = found(&without_orientation(with_y_up(level())), OPEN_GL) else {
        panic!("it is odd")
    };
    assert!(words.contains("write world = \"y-up\""), "{words}");
    assert_eq!(found(&without_orientation(level()), OPEN_GL), None);
    let described = RecordingDescription { world: Some(WorldUpAxis::ZUp), ..RecordingDescription::default() };
    assert_eq!(
        find_doubt(&without_orientation(with_y_up(level())), OPEN_GL, &described),
        None,
        "what the user set is not questioned"
    );
}

#[test]
fn stairs_are_neither_refused_nor_odd() {
    let straight = walk(&[[0.0, 0.0, 1.5], [0.0, 2.0, 1.5], [0.0, 6.2, 4.4], [0.0, 8.0, 4.4]], 0.3);
    let around = walk(&[[0.0, 0.0, 1.5], [0.0, 2.6, 3.0], [1.0, 2.6, 3.0], [1.0, 0.0, 4.5], [4.0, 0.0, 4.5]], 0.3);
    for samples in [straight, around] {
        assert_eq!(found(&samples, OPEN_GL), None);
        assert_eq!(found(&without_orientation(samples), OPEN_GL), None);
    }
}

#[test]
fn drones_and_lifts_are_not_refused() {
    let rise = [[0.0, 0.0, 0.0], [0.0, 0.0, 20.0], [30.0, 0.0, 20.0], [30.0, 40.0, 25.0], [30.0, 40.0, 0.0]];
    let lift = [[0.0, 0.0, 1.5], [0.0, 6.0, 1.5], [0.0, 6.0, 13.5], [0.0, 0.0, 13.5]];
    for (places, tilt_rad) in [(&rise[..], 0.5), (&rise[..], FRAC_PI_2), (&rise[1..3], FRAC_PI_2), (&lift[..], 0.2)] {
        for world in [WorldUpAxis::ZUp, WorldUpAxis::YUp] {
            let samples = walk(places, tilt_rad);
            let samples = if world == WorldUpAxis::YUp { with_y_up(samples) } else { samples };
            let axes = PoseAxes { world, ..OPEN_GL };
            let told = found(&samples, axes);
            assert!(!matches!(told, Some(PoseDoubt::Misread(_))), "{places:?} {tilt_rad}: {told:?}");
            let told = found(&without_orientation(samples), axes);
            assert!(!matches!(told, Some(PoseDoubt::Misread(_))), "{places:?}: {told:?}");
        }
    }
}

#[test]
fn a_camera_on_its_head_is_odd_and_a_short_walk_is_not_judged() {
    let upside_down = level().into_iter().map(|sample| {
        let held = sample.recorded_from_body.map(|[x, y, z]| [-x, -y, z]);
        PoseSample { recorded_from_body: held, ..sample }
    });
    // Read as an optical frame it would be upright and look back, so the warning names that frame.
    let told = found(&upside_down.collect::<Vec<_>>(), OPEN_GL);
    assert!(matches!(&told, Some(PoseDoubt::Odd(words)) if words.contains("orientation = \"optical\"")), "{told:?}");
    assert_eq!(found(&with_y_up(walk(&[[0.0, 0.0, 1.5], [0.0, 2.0, 1.5]], 0.2)), OPEN_GL), None);
}
