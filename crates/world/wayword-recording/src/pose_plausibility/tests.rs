//! Tests of the doubt about poses, on paths that are made here in the axes of the test.

use super::*;
use std::f64::consts::FRAC_PI_2;
use wayword_core::DVec3;

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
fn a_body_that_is_taken_for_another_is_refused_where_the_walk_turns() {
    let Some(PoseDoubt::Misread(words)) = found(&level(), PoseAxes::for_body(PoseBody::Robot)) else {
        panic!("it is misread")
    };
    assert!(words.contains("Write orientation = \"open-gl\" into"), "{words}");
    // On a straight walk it may be chance.
    let straight = walk(&[[0.0, 0.0, 1.5], [0.0, 8.0, 1.5]], 0.2);
    let told = found(&straight, PoseAxes::for_body(PoseBody::Robot));
    assert!(matches!(&told, Some(PoseDoubt::Odd(words)) if words.contains("orientation = \"open-gl\"")), "{told:?}");
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
fn a_camera_on_its_head_is_refused_whatever_the_user_set_and_a_short_walk_is_not_judged() {
    let upside_down = level().into_iter().map(|sample| {
        let held = sample.recorded_from_body.map(|[x, y, z]| [-x, -y, z]);
        PoseSample { recorded_from_body: held, ..sample }
    });
    let upside_down: Vec<PoseSample> = upside_down.collect();
    // Read as an optical frame it would be upright, but look back.
    let set = RecordingDescription {
        world: Some(WorldUpAxis::ZUp),
        orientation: Some(PoseBody::OpenGl),
        ..RecordingDescription::default()
    };
    for described in [RecordingDescription::default(), set] {
        let told = find_doubt(&upside_down, OPEN_GL, &described);
        let Some(PoseDoubt::Misread(words)) = &told else { panic!("{told:?}") };
        assert!(words.contains("the camera is upside down. Set `world` and `orientation`"), "{words}");
    }
    assert_eq!(found(&with_y_up(walk(&[[0.0, 0.0, 1.5], [0.0, 2.0, 1.5]], 0.2)), OPEN_GL), None);
}

#[test]
fn poses_of_unity_are_asked_for_beside_the_world_that_turns_them_over() {
    // x right, y up, z ahead: mirrored.
    let turn = |place: DVec3| DVec3::new(place.x, place.z, place.y);
    let in_unity = level().into_iter().map(|sample| PoseSample {
        position: turn(sample.position),
        recorded_from_body: sample.recorded_from_body.map(|[x, y, z]| [turn(x), turn(y), turn(-z)]),
    });
    let in_unity: Vec<PoseSample> = in_unity.collect();
    let Some(PoseDoubt::Misread(words)) = found(&in_unity, PoseAxes::for_body(PoseBody::Robot)) else {
        panic!("it is misread")
    };
    assert!(words.contains("world = \"y-down\" and orientation = \"optical\" (y points down)"), "{words}");
    assert!(words.contains("world = \"unity\" (left-handed, y points up: Unity)"), "{words}");
    // The user knows which axis points up, and has set an orientation, which the world would not replace.
    let described = RecordingDescription {
        world: Some(WorldUpAxis::YUp),
        orientation: Some(PoseBody::Optical),
        ..RecordingDescription::default()
    };
    let axes = described.axes_or_usual(OPEN_GL);
    let Some(PoseDoubt::Misread(words)) = find_doubt(&in_unity, axes, &described) else { panic!("it is upside down") };
    assert!(words.contains("the camera is upside down"), "{words}");
    assert!(words.contains("world = \"unity\" and orientation = \"unity\""), "{words}");
    let described = RecordingDescription { world: Some(WorldUpAxis::Unity), ..RecordingDescription::default() };
    assert_eq!(find_doubt(&in_unity, described.axes_or_usual(OPEN_GL), &described), None);
}

#[test]
fn a_camera_that_looks_back_or_aside_is_not_turned_over() {
    for turn_rad in [FRAC_PI_2, 2.0 * FRAC_PI_2, -FRAC_PI_2] {
        for places in [&[[0.0, 0.0, 1.5], [0.0, 8.0, 1.5]][..], &[[0.0, 0.0, 1.5], [0.0, 6.0, 1.5], [6.0, 6.0, 1.5]]] {
            let turned = walk(places, 0.1).into_iter().map(|sample| {
                let turn = |vector: DVec3| {
                    let (sine, cosine) = turn_rad.sin_cos();
                    DVec3::new(vector.x * cosine - vector.y * sine, vector.x * sine + vector.y * cosine, vector.z)
                };
                PoseSample { recorded_from_body: sample.recorded_from_body.map(|held| held.map(turn)), ..sample }
            });
            let turned: Vec<PoseSample> = turned.collect();
            assert_eq!(found(&turned, OPEN_GL), None, "{turn_rad} {places:?}");
        }
    }
}
