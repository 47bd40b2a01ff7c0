//! One walk in many conventions: each gives the same walk, or an error that names the setting with which it is the same walk.

use super::*;
use crate::{
    axes::PoseBody,
    pose_reading::{PoseReading, PositionUnit},
};
use std::f64::consts::FRAC_PI_2;
use wayword_core::DVec3;

const POSES: usize = 49;
const STEP_S: f64 = 0.5;

/// A pose of the true walk, in Wayword's frame.
struct TruePose {
    position: DVec3,
    ahead: DVec3,
    right: DVec3,
    up: DVec3,
}

/// How a walk goes.
#[derive(Debug, Clone, Copy)]
struct WalkShape {
    start_rad: f64,
    /// 1 to the right, -1 to the left, 0 for no turn.
    turn: f64,
    /// Metres that it rises after the turn.
    rise_m: f64,
}

/// Start, turn and rise of the walks.
const SHAPES: [(f64, f64, f64); 3] = [(0.0, 1.0, 0.0), (2.0, 1.0, 3.0), (4.0, -1.0, -3.0)];

/// Six metres on, a turn, six metres on; a camera that is held a little askew.
fn true_walk(shape: WalkShape) -> Vec<TruePose> {
    let along = |rad: f64| DVec3::new(rad.sin(), rad.cos(), 0.0);
    let (first, second) = (shape.start_rad, shape.start_rad + shape.turn * FRAC_PI_2);
    let half = POSES / 2;
    let pose = |at: usize| {
        let (before, after) = (at.min(half) as f64 * 0.25, at.saturating_sub(half) as f64 * 0.25);
        let rise = DVec3::Z * (1.5 + shape.rise_m * after / 6.0);
        // It turns over three steps.
        let turned = ((at as f64 - half as f64 + 2.0) / 3.0).clamp(0.0, 1.0);
        let heading = along(first + (second - first) * turned);
        let right = heading.cross(DVec3::Z);
        let ahead = (heading - DVec3::Z * 0.1).normalize();
        let right = (right + DVec3::Z * 0.05).normalize();
        let right = (right - ahead * right.dot(ahead)).normalize();
        TruePose {
            position: along(first) * before + along(second) * after + rise,
            ahead,
            right,
            up: right.cross(ahead),
        }
    };
    (0..POSES).map(pose).collect()
}

/// A convention in which poses are written.
#[derive(Debug, Clone, Copy)]
struct Convention {
    reading: PoseReading,
    metres_per_unit: f64,
}

/// A pose in a convention: the position and the columns of the rotation.
fn recorded_pose(pose: &TruePose, convention: Convention) -> (DVec3, [DVec3; 3]) {
    let PoseReading { axes, numbers } = convention.reading;
    let to_recorded = |DVec3 { x, y, z }: DVec3| match axes.world {
        WorldUpAxis::ZUp => DVec3::new(x, y, z),
        WorldUpAxis::YUp => DVec3::new(x, z, -y),
        WorldUpAxis::YDown => DVec3::new(x, -z, y),
        WorldUpAxis::Unity => DVec3::new(x, z, y),
        WorldUpAxis::Unreal => DVec3::new(y, x, z),
        WorldUpAxis::Ned => DVec3::new(y, x, -z),
    };
    let body = match (axes.body, axes.world) {
        (PoseBody::Robot, WorldUpAxis::Unreal) => [pose.ahead, pose.right, pose.up],
        (PoseBody::Robot, _) => [pose.ahead, -pose.right, pose.up],
        (PoseBody::Optical, _) => [pose.right, -pose.up, pose.ahead],
        (PoseBody::OpenGl, _) => [pose.right, pose.up, -pose.ahead],
        (PoseBody::Unity, _) => [pose.right, pose.up, pose.ahead],
        (PoseBody::Frd, _) => [pose.ahead, pose.right, -pose.up],
    };
    // The inverse of a transform is turned round by the same function.
    numbers.direction.world_from_camera(to_recorded(pose.position) / convention.metres_per_unit, body.map(to_recorded))
}

/// x, y, z, w of a rotation.
fn quaternion([a, b, c]: [DVec3; 3]) -> [f64; 4] {
    let scores = [1.0 + a.x - b.y - c.z, 1.0 - a.x + b.y - c.z, 1.0 - a.x - b.y + c.z, 1.0 + a.x + b.y + c.z];
    let largest = (0..4).max_by(|i, j| scores[*i].total_cmp(&scores[*j])).unwrap();
    let s = scores[largest].sqrt() * 2.0;
    match largest {
        0 => [s / 4.0, (a.y + b.x) / s, (a.z + c.x) / s, (b.z - c.y) / s],
        1 => [(a.y + b.x) / s, s / 4.0, (b.z + c.y) / s, (c.x - a.z) / s],
        2 => [(a.z + c.x) / s, (b.z + c.y) / s, s / 4.0, (a.y - b.x) / s],
        _ => [(b.z - c.y) / s, (c.x - a.z) / s, (a.y - b.x) / s, s / 4.0],
    }
}

/// The walk as text in a format: the name of the file and its content.
fn written(format: &str, walk: &[TruePose], convention: Convention) -> (String, String) {
    let order = convention.reading.numbers.order;
    let columns = match order {
        QuaternionOrder::Xyzw => ["qx", "qy", "qz", "qw"],
        QuaternionOrder::Wxyz => ["qw", "qx", "qy", "qz"],
    };
    let mut lines = match format {
        "named" => vec![format!("# timestamp tx ty tz {}", columns.join(" "))],
        "csv" => vec![format!("timestamp,x,y,z,{}", columns.join(","))],
        _ => Vec::new(),
    };
    for (at, pose) in walk.iter().enumerate() {
        let (place, columns) = recorded_pose(pose, convention);
        let [x, y, z, w] = quaternion(columns);
        let q = if order == QuaternionOrder::Wxyz { [w, x, y, z] } else { [x, y, z, w] };
        let numbers: Vec<String> = place.to_array().iter().chain(&q).map(|number| format!("{number:.6}")).collect();
        let time_s = at as f64 * STEP_S;
        lines.push(match format {
            "json" => format!(
                "{{\"time_s\": {time_s}, \"position\": [{}], \"orientation\": [{}]}}",
                numbers[..3].join(", "),
                numbers[3..].join(", ")
            ),
            "csv" => format!("{time_s},{}", numbers.join(",")),
            "kitti" => {
                let [a, b, c] = columns;
                let rows = [[a.x, b.x, c.x, place.x], [a.y, b.y, c.y, place.y], [a.z, b.z, c.z, place.z]];
                rows.iter().flatten().map(|number| format!("{number:.6}")).collect::<Vec<_>>().join(" ")
            }
            _ => format!("{time_s} {}", numbers.join(" ")),
        });
    }
    match format {
        "json" => ("poses.json".to_owned(), format!("[{}]", lines.join(",\n"))),
        "csv" => ("poses.csv".to_owned(), lines.join("\n")),
        _ => ("poses.txt".to_owned(), lines.join("\n")),
    }
}

fn read(file: &(String, String), described: &RecordingDescription) -> Result<CameraTrack, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(&file.0);
    std::fs::write(&path, &file.1).unwrap();
    let times_s: Vec<f64> = (0..POSES).map(|at| at as f64 * STEP_S).collect();
    read_track(&path, described, &times_s, &|at| format!("{at}.png")).map_err(|error| error.to_string())
}

/// Whether a track is the true walk, whichever way it was turned and shifted as a whole.
fn is_true(track: &CameraTrack, walk: &[TruePose]) -> bool {
    let turn = |vector: DVec3, rad: f64| {
        let (sine, cosine) = rad.sin_cos();
        DVec3::new(vector.x * cosine - vector.y * sine, vector.x * sine + vector.y * cosine, vector.z)
    };
    let true_heading = |pose: &TruePose| pose.ahead.x.atan2(pose.ahead.y);
    let fix = |at: usize| track.fix_at(at as f64 * STEP_S).unwrap();
    let heading = |at: usize| fix(at).heading.map_or(f64::NAN, wayword_core::Heading::rad);
    walk.iter().enumerate().all(|(at, pose)| {
        let found = turn(fix(at).position - fix(0).position, heading(0));
        let wanted = turn(pose.position - walk[0].position, true_heading(&walk[0]));
        let off = (heading(at) - heading(0)) - (true_heading(pose) - true_heading(&walk[0]));
        found.distance(wanted) < 0.01 && off.sin().abs() < 0.02 && off.cos() > 0.0
    })
}

fn all_conventions() -> Vec<Convention> {
    let bodies = [PoseBody::Robot, PoseBody::Optical, PoseBody::OpenGl];
    let right_handed = [WorldUpAxis::ZUp, WorldUpAxis::YUp, WorldUpAxis::YDown];
    let mut axes: Vec<PoseAxes> = right_handed
        .into_iter()
        .flat_map(|world| bodies.map(|body| PoseAxes { world, ..PoseAxes::for_body(body) }))
        .collect();
    axes.push(PoseAxes { world: WorldUpAxis::Unity, ..PoseAxes::for_body(PoseBody::Unity) });
    axes.push(PoseAxes { world: WorldUpAxis::Ned, ..PoseAxes::for_body(PoseBody::Frd) });
    axes.push(PoseAxes { world: WorldUpAxis::Unreal, ..PoseAxes::for_body(PoseBody::Robot) });
    let mut all = Vec::new();
    for axes in axes {
        for order in [QuaternionOrder::Xyzw, QuaternionOrder::Wxyz] {
            for direction in [TransformDirection::CameraToWorld, TransformDirection::WorldToCamera] {
                let usual = if axes.world == WorldUpAxis::Unreal { 0.01 } else { 1.0 };
                // Millimetres in every world, but not with every order of numbers.
                let is_usual = (order, direction) == (QuaternionOrder::Xyzw, TransformDirection::CameraToWorld);
                let units = if is_usual { &[usual, 0.001][..] } else { &[usual] };
                for metres_per_unit in units.iter().copied() {
                    let reading = PoseReading { axes, numbers: NumberReading { order, direction } };
                    all.push(Convention { reading, metres_per_unit });
                }
            }
        }
    }
    all
}

/// What the owner of such poses would write.
fn all_settings(convention: Convention, names_order: bool) -> RecordingDescription {
    let PoseReading { axes, numbers } = convention.reading;
    let unit = (convention.metres_per_unit == 0.001).then_some(PositionUnit::Millimetres);
    RecordingDescription {
        world: Some(axes.world),
        orientation: Some(axes.body),
        quaternion: (!names_order).then_some(numbers.order),
        transform: Some(numbers.direction),
        unit,
        ..RecordingDescription::default()
    }
}

/// The settings that a question about the unit asks for, so that the next question can be read.
fn unit_settings(convention: Convention) -> RecordingDescription {
    let all = all_settings(convention, true);
    let world = (convention.reading.axes.world == WorldUpAxis::Unreal).then_some(WorldUpAxis::Unreal);
    RecordingDescription { unit: all.unit, world, ..RecordingDescription::default() }
}

/// The settings that an error has to name.
fn wanted_advice(format: &str, convention: Convention, names_order: bool) -> String {
    let usual = match format {
        "tum" | "named" => PoseAxes::for_body(PoseBody::Optical),
        "kitti" => PoseAxes { world: WorldUpAxis::YDown, ..PoseAxes::for_body(PoseBody::Optical) },
        _ => PoseAxes::for_body(PoseBody::Robot),
    };
    let axes = unit_settings(convention).axes_or_usual(usual);
    let mut wanted = convention.reading;
    if names_order {
        wanted.numbers.order = QuaternionOrder::Xyzw;
    }
    wanted.settings_from(PoseReading { axes, numbers: NumberReading::default() }, false)
}

#[test]
fn a_walk_in_any_convention_is_right_or_a_question_that_names_the_convention() {
    let mut all = 0;
    let mut wrong = Vec::new();
    for shape in SHAPES {
        let shape = WalkShape { start_rad: shape.0, turn: shape.1, rise_m: shape.2 };
        let walk = true_walk(shape);
        for convention in all_conventions() {
            for format in ["tum", "named", "csv", "json", "kitti"] {
                // A matrix has no quaternion.
                if format == "kitti" && convention.reading.numbers.order == QuaternionOrder::Wxyz {
                    continue;
                }
                let file = written(format, &walk, convention);
                let names_order = matches!(format, "named" | "csv");
                let case = || format!("{format} {shape:?} {convention:?}");
                let told = read(&file, &all_settings(convention, names_order));
                assert!(told.as_ref().is_ok_and(|track| is_true(track, &walk)), "{} as told: {told:?}", case());
                all += 1;
                let mut told = read(&file, &RecordingDescription::default());
                if told.as_ref().is_err_and(|error| error.contains("read in metres")) {
                    let unit = unit_settings(convention);
                    let setting = if unit.world.is_some() { "world = \"unreal\"" } else { "unit = \"mm\"" };
                    if convention.reading.axes.world != WorldUpAxis::Unreal || convention.metres_per_unit == 0.01 {
                        assert!(told.as_ref().unwrap_err().contains(setting), "{}: {told:?}", case());
                    }
                    told = read(&file, &unit);
                }
                match told {
                    Ok(track) if is_true(&track, &walk) => {}
                    // Nothing in a matrix file tells Unity's world from the usual one, in which up is down.
                    Ok(_) if format == "kitti" && convention.reading.axes.world == WorldUpAxis::Unity => {}
                    // A robot's poses in a world with z up look the same, turned over.
                    Ok(_) if matches!(format, "csv" | "json") && convention.reading.axes.world == WorldUpAxis::Ned => {}
                    Ok(track) => wrong.push(format!("SILENT {} {:?}", case(), track.doubt())),
                    Err(error) => {
                        let names = error.contains(&wanted_advice(format, convention, names_order));
                        if !names {
                            wrong.push(format!("UNNAMED {}: {error}", case()));
                        }
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {all}:\n{}", wrong.len(), wrong.join("\n"));
}
