//! Reads REVERIE's `objpos.json`: the centres of objects, `{scan: {objId: [x, y, z]}}`, metres, world frame.

use super::file_reading;
use glam::DVec3;
use std::{collections::BTreeMap, path::Path};
use wayword_core::PlatformError;

/// Largest file, bytes; the real one for all 90 buildings has about 2 MB.
const MAX_BYTES: u64 = 8 << 20;
const OBJECT_POSITIONS_HINT: &str = "download the file again from REVERIE's repository";

/// Centres by scan and object.
pub(crate) type ObjectPositions = BTreeMap<String, BTreeMap<String, DVec3>>;

/// Reads all centres; there are none if there is no such file.
///
/// # Errors
/// If the file does not have this format; the message names the scan and the object.
pub(crate) fn read_object_positions(file: &Path) -> Result<ObjectPositions, PlatformError> {
    let Some(bytes) = file_reading::json_if_there(file, MAX_BYTES, OBJECT_POSITIONS_HINT)? else {
        return Ok(ObjectPositions::new());
    };
    parse_object_positions(&bytes).map_err(|reason| file_reading::file_error(file, reason, OBJECT_POSITIONS_HINT))
}

fn parse_object_positions(bytes: &[u8]) -> Result<ObjectPositions, String> {
    let scans: BTreeMap<String, BTreeMap<String, [f64; 3]>> =
        serde_json::from_slice(bytes).map_err(|error| format!("is not {{scan: {{objId: [x, y, z]}}}}: {error}"))?;
    let mut positions = ObjectPositions::new();
    for (scan, objects) in scans {
        let mut centres = BTreeMap::new();
        for (object, [x, y, z]) in objects {
            for number in [x, y, z] {
                file_reading::check_coordinate(number)
                    .map_err(|reason| format!("scan {scan:.40}, object {object:.40}: {reason}"))?;
            }
            centres.insert(object, DVec3::new(x, y, z));
        }
        positions.insert(scan, centres);
    }
    Ok(positions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_are_found_by_scan_and_object() {
        let positions = parse_object_positions(br#"{"s": {"4": [1.0, 2, -3]}}"#).unwrap();
        assert_eq!(positions["s"]["4"], DVec3::new(1.0, 2.0, -3.0));
    }

    #[test]
    fn errors_name_the_object() {
        assert_eq!(
            parse_object_positions(br#"{"s": {"4": [1e9, 2, 3]}}"#).unwrap_err(),
            "scan s, object 4: 1e9 is not a plausible coordinate"
        );
        assert!(parse_object_positions(br#"{"s": {"4": [1, 2]}}"#).unwrap_err().contains("is not {scan"));
    }
}
