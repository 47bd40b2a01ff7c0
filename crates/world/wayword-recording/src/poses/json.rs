//! Reads poses from JSON: Wayword's own list of poses, NeRF's `transforms.json`, or the `metadata` of Record3D (a phone's app).

use super::rows::{KnownConventions, PoseFacing, PoseKey, PoseRow, PoseRows, RowKind, pose_from_matrix};
use crate::axes::{PoseAxes, PoseBody, WorldUpAxis};
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};
use wayword_core::DVec3;

const EXPECTED_JSON: &str = "expected `transforms.json`, or a list of {\"image\" or \"time_s\", \"position\": [x, y, z]} \
                        with \"orientation\": [x, y, z, w], \"yaw_rad\" or \"heading_deg\"";
/// The fields of a pose of Wayword's own format.
const POSE_FIELDS: [&str; 6] = ["image", "time_s", "position", "orientation", "yaw_rad", "heading_deg"];
/// The last row of a matrix that places a camera.
const LAST_ROW: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// Reads the rows of a JSON file.
pub(super) fn read_json(text: &str) -> Result<PoseRows, String> {
    let value: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let list = |name: &str| value.get(name).and_then(Value::as_array);
    if let Some(frames) = list("frames") {
        let usual = PoseAxes::for_body(PoseBody::OpenGl);
        return read_items(frames, RowKind::Frame, (usual, KnownConventions::BODY_ONLY), &read_frame);
    }
    let poses = list("poses").or_else(|| value.as_array()).ok_or(EXPECTED_JSON)?;
    if poses.first().is_some_and(Value::is_array) {
        let arkit = PoseAxes { world: WorldUpAxis::YUp, ..PoseAxes::for_body(PoseBody::OpenGl) };
        return read_items(poses, RowKind::Pose, (arkit, KnownConventions::ALL), &read_record3d);
    }
    let known = KnownConventions { angle_unit: true, ..KnownConventions::BODY_ONLY };
    let rows = read_items(poses, RowKind::Pose, (PoseAxes::for_body(PoseBody::Robot), known), &read_pose)?;
    let angle_name = rows.rows.iter().find_map(|row| match row.facing {
        PoseFacing::Yaw(_) => Some("yaw_rad"),
        PoseFacing::Heading(_) => Some("heading_deg"),
        PoseFacing::Unknown | PoseFacing::Quaternion(_) | PoseFacing::Columns(_) => None,
    });
    Ok(PoseRows { angle_name, ..rows })
}

/// Reads the items of a list, with the conventions of their format. The error names the item.
fn read_items(
    items: &[Value],
    kind: RowKind,
    (usual, known): (PoseAxes, KnownConventions),
    read: &dyn Fn(usize, &Value) -> Result<PoseRow, String>,
) -> Result<PoseRows, String> {
    let what = if kind == RowKind::Frame { "frame" } else { "pose" };
    let rows = items.iter().enumerate();
    let rows = rows.map(|(at, item)| read(at, item).map_err(|reason| format!("{what} {at}: {reason}")));
    let rows = rows.collect::<Result<_, _>>()?;
    Ok(PoseRows { kind, ..PoseRows::new(usual, known, rows) })
}

/// A frame of `transforms.json`: the name of a picture and world_from_camera, row by row.
fn read_frame(at: usize, item: &Value) -> Result<PoseRow, String> {
    let fields = as_fields(item)?;
    let rows: Vec<[f64; 4]> = need_field(fields, "transform_matrix")?;
    let ([a, b, c], last) = match *rows.as_slice() {
        [a, b, c] => ([a, b, c], LAST_ROW),
        [a, b, c, last] => ([a, b, c], last),
        _ => return Err(format!("`transform_matrix` has {} rows instead of 4", rows.len())),
    };
    if last != LAST_ROW {
        return Err(format!("the last row of `transform_matrix` is {last:?} instead of 0, 0, 0, 1"));
    }
    let ([ax, ay, az, x], [bx, by, bz, y], [cx, cy, cz, z]) = (a, b, c);
    let (position, columns) = pose_from_matrix([ax, ay, az, x, bx, by, bz, y, cx, cy, cz, z]);
    let key = PoseKey::Picture(need_field(fields, "file_path")?);
    Ok(PoseRow { at, key, position, facing: PoseFacing::Columns(columns) })
}

/// A pose of Record3D: qx, qy, qz, qw, x, y, z of ARKit's camera, for each picture.
fn read_record3d(at: usize, item: &Value) -> Result<PoseRow, String> {
    let [qx, qy, qz, qw, x, y, z] = parse_value::<[f64; 7]>(item)?;
    let facing = PoseFacing::Quaternion([qx, qy, qz, qw]);
    Ok(PoseRow { at, key: PoseKey::Number(at), position: DVec3::new(x, y, z), facing })
}

/// A pose of Wayword's own format. Where it has a picture and a time, the picture counts.
fn read_pose(at: usize, item: &Value) -> Result<PoseRow, String> {
    let fields = as_fields(item)?;
    if let Some(unknown) = fields.keys().find(|name| !POSE_FIELDS.contains(&name.as_str())) {
        return Err(format!("there is no field {unknown:?}; {EXPECTED_JSON}"));
    }
    let picture = read_field(fields, "image")?.map(PoseKey::Picture);
    let time = read_field(fields, "time_s")?.map(PoseKey::Time);
    let key = picture.or(time).ok_or("expected `image` or `time_s`")?;
    let facings = [
        ("orientation", read_field(fields, "orientation")?.map(PoseFacing::Quaternion)),
        ("yaw_rad", read_field(fields, "yaw_rad")?.map(PoseFacing::Yaw)),
        ("heading_deg", read_field(fields, "heading_deg")?.map(|deg: f64| PoseFacing::Heading(deg.to_radians()))),
    ];
    let mut facings = facings.into_iter().filter_map(|(name, facing)| Some((name, facing?)));
    let facing = match (facings.next(), facings.next()) {
        (Some((name, _)), Some((other, _))) => return Err(format!("has `{name}` and `{other}`: keep one of them")),
        (facing, _) => facing.map_or(PoseFacing::Unknown, |(_, facing)| facing),
    };
    Ok(PoseRow { at, key, position: DVec3::from_array(need_field(fields, "position")?), facing })
}

fn as_fields(item: &Value) -> Result<&Map<String, Value>, String> {
    item.as_object().ok_or_else(|| EXPECTED_JSON.to_owned())
}

/// The value of a field; `None` where it is missing or null. The error names the field.
fn read_field<T: DeserializeOwned>(fields: &Map<String, Value>, name: &str) -> Result<Option<T>, String> {
    let value = fields.get(name).filter(|value| !value.is_null());
    value.map(|value| parse_value(value).map_err(|reason| format!("`{name}`: {reason}"))).transpose()
}

/// The value of a field that each item has.
fn need_field<T: DeserializeOwned>(fields: &Map<String, Value>, name: &str) -> Result<T, String> {
    read_field(fields, name)?.ok_or_else(|| format!("has no `{name}`"))
}

fn parse_value<T: DeserializeOwned>(value: &Value) -> Result<T, String> {
    T::deserialize(value).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn read_json_names_the_item_and_the_field() {
        for (text, told) in [
            (r#"[{"image": "0", "position": [0, 0]}]"#, "pose 0: `position`: invalid length 2"),
            (r#"[{"image": "0", "position": [0, 0, 1], "orientation": [0, 0, 1]}]"#, "pose 0: `orientation`: invalid"),
            (r#"[{"image": "0", "position": [0, 0, 1]}, {"image": "1", "psition": [0]}]"#, "no field \"psition\""),
            (r#"{"poses": [{"image": 7, "position": [0, 0, 1]}]}"#, "pose 0: `image`: invalid type"),
            (r#"[{"position": [0, 0, 0]}]"#, "pose 0: expected `image` or `time_s`"),
            (r#"[{"time_s": 1}]"#, "pose 0: has no `position`"),
            (r#"[7]"#, "pose 0: expected"),
            (r#"{"poses": [[0, 0, 0, 1, 0, 0, 0], [0, 0]]}"#, "pose 1: invalid length 2"),
            (r#"{"frames": [{"file_path": "0"}]}"#, "frame 0: has no `transform_matrix`"),
            (r#"{"frames": [{"transform_matrix": [[1, 2]]}]}"#, "frame 0: `transform_matrix`: invalid length 2"),
            (r#"{"frames": [{"transform_matrix": [[1, 0, 0, 0]]}]}"#, "has 1 rows instead of 4"),
        ] {
            let error = read_json(text).unwrap_err();
            assert!(error.contains(told), "{text}: {error}");
        }
    }

    #[test]
    fn read_json_refuses_two_directions_of_one_pose() {
        let pose = |facing: &str| format!(r#"[{{"time_s": 0, "position": [0, 0, 0], {facing}}}]"#);
        for (facing, told) in [
            (r#""orientation": [0, 0, 0, 1], "yaw_rad": 1"#, "has `orientation` and `yaw_rad`"),
            (r#""orientation": [0, 0, 0, 1], "heading_deg": 1"#, "has `orientation` and `heading_deg`"),
            (r#""yaw_rad": 0, "heading_deg": 1"#, "has `yaw_rad` and `heading_deg`"),
        ] {
            let error = read_json(&pose(facing)).unwrap_err();
            assert!(error.contains(told), "{error}");
        }
        assert!(read_json(&pose(r#""yaw_rad": null, "heading_deg": 1"#)).is_ok());
    }

    #[test]
    fn read_json_refuses_a_matrix_with_another_last_row() {
        let frame = |last: &str| {
            format!(
                r#"{{"frames": [{{"file_path": "0", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0]{last}]}}]}}"#
            )
        };
        assert!(read_json(&frame(",[9,9,9,9]")).unwrap_err().contains("the last row"));
        assert!(read_json(&frame(",[0,0,0,1]")).is_ok() && read_json(&frame("")).is_ok());
    }
}
