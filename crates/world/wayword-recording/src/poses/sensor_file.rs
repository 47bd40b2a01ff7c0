//! Reads where a camera is on the body that carries it, from the `sensor.yaml` in the folder of a camera of EuRoC or TUM-VI.

use super::rows::{CameraMounting, parse_number, pose_from_matrix};
use std::path::Path;
use wayword_world::files;

pub(super) const SENSOR_FILE: &str = "sensor.yaml";
/// Largest file that is read, bytes.
const MAX_BYTES: u64 = 64 << 10;

/// body_from_camera (`T_BS`) in such a file; `None` where there is none.
pub(super) fn read_mounting(file: &Path) -> Option<CameraMounting> {
    let text = files::text_if_there(file, MAX_BYTES, "").ok()??;
    // The matrix is the first list after its key, over several lines.
    let (_, after) = text.split_once("T_BS")?;
    let (_, list) = after.split_once("data:")?.1.split_once('[')?;
    let (list, _) = list.split_once(']')?;
    let numbers: Vec<f64> = list.split(',').map(parse_number).collect::<Result<_, _>>().ok()?;
    let (matrix, _) = numbers.split_first_chunk::<12>().filter(|_| numbers.len() == 16)?;
    let (position, columns) = pose_from_matrix(*matrix);
    Some(CameraMounting { position, columns })
}
