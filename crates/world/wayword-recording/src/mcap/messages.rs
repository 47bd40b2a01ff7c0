//! Parses the ROS 2 messages that are used (`common_interfaces`: `sensor_msgs`, `geometry_msgs`, `nav_msgs`; `tf2_msgs`).

use super::cdr::CdrReader;
use glam::{DQuat, DVec3};

/// The kind of a topic's messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MessageKind {
    /// `sensor_msgs/msg/Image`.
    Raw,
    /// `sensor_msgs/msg/CompressedImage`.
    Compressed,
    /// `sensor_msgs/msg/CameraInfo`.
    Lens,
    /// `geometry_msgs/msg/PoseStamped`, or `PoseWithCovarianceStamped`, which has its covariance after the pose.
    Pose,
    /// `nav_msgs/msg/Odometry`.
    Odometry,
    /// `tf2_msgs/msg/TFMessage`.
    Transforms,
}

impl MessageKind {
    /// The kind for a schema's name; `None` if it cannot be read.
    pub(crate) fn from_schema(schema: &str) -> Option<Self> {
        // Some writers leave out `msg`, and IDL has colons.
        match schema.replace("::", "/").replace("/msg/", "/").as_str() {
            "sensor_msgs/Image" => Some(Self::Raw),
            "sensor_msgs/CompressedImage" => Some(Self::Compressed),
            "sensor_msgs/CameraInfo" => Some(Self::Lens),
            "geometry_msgs/PoseStamped" | "geometry_msgs/PoseWithCovarianceStamped" => Some(Self::Pose),
            "nav_msgs/Odometry" => Some(Self::Odometry),
            "tf2_msgs/TFMessage" | "tf/tfMessage" => Some(Self::Transforms),
            _ => None,
        }
    }

    pub(crate) fn is_picture(self) -> bool {
        matches!(self, Self::Raw | Self::Compressed)
    }

    pub(crate) fn is_pose(self) -> bool {
        matches!(self, Self::Pose | Self::Odometry | Self::Transforms)
    }

    /// Most bytes of a message that are read while the file is indexed: a whole pose, but of a picture only its time,
    /// frame and encoding.
    pub(crate) fn max_indexed_bytes(self) -> u64 {
        if self.is_pose() { 16 << 20 } else { 4 << 10 }
    }
}

/// `std_msgs/msg/Header`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct MessageHead {
    /// Time of the data, nanoseconds; 0 if it is not set.
    pub(crate) stamp_ns: i64,
    /// Frame of the data, without the slash that older programs put before it.
    pub(crate) frame: String,
}

/// Reads the header with which most messages begin.
fn read_head(cdr: &mut CdrReader<'_>) -> Result<MessageHead, String> {
    let (seconds, nanoseconds) = (cdr.read_i32()?, cdr.read_u32()?);
    Ok(MessageHead { stamp_ns: i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds), frame: read_frame(cdr)? })
}

/// Reads the name of a frame, without a slash before it.
fn read_frame(cdr: &mut CdrReader<'_>) -> Result<String, String> {
    let frame = cdr.read_text()?;
    Ok(frame.strip_prefix('/').map_or(frame.clone(), str::to_owned))
}

/// The beginning of a picture's message, for which its first few hundred bytes are enough.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct PictureHead {
    pub(crate) head: MessageHead,
    /// `bgr8`, `jpeg`, `rgb8; jpeg compressed bgr8`.
    pub(crate) encoding: String,
}

impl PictureHead {
    pub(crate) fn read(kind: MessageKind, message: &[u8]) -> Result<Self, String> {
        let mut cdr = CdrReader::new(message)?;
        let head = read_head(&mut cdr)?;
        if kind == MessageKind::Raw {
            let (_height_px, _width_px) = (cdr.read_u32()?, cdr.read_u32()?);
        }
        Ok(Self { head, encoding: cdr.read_text()? })
    }
}

/// `sensor_msgs/msg/Image` after its header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RawPicture<'a> {
    pub(crate) width_px: u32,
    pub(crate) height_px: u32,
    pub(crate) encoding: String,
    pub(crate) big_endian: bool,
    /// Distance from one row to the next, bytes.
    pub(crate) row_bytes: u32,
    pub(crate) pixels: &'a [u8],
}

impl<'a> RawPicture<'a> {
    pub(crate) fn read(message: &'a [u8]) -> Result<Self, String> {
        let mut cdr = CdrReader::new(message)?;
        read_head(&mut cdr)?;
        let (height_px, width_px) = (cdr.read_u32()?, cdr.read_u32()?);
        let (encoding, big_endian) = (cdr.read_text()?, cdr.read_u8()? != 0);
        Ok(Self { width_px, height_px, encoding, big_endian, row_bytes: cdr.read_u32()?, pixels: cdr.read_bytes()? })
    }
}

/// `sensor_msgs/msg/CompressedImage` after its header: its format, and the bytes of a picture file.
pub(crate) fn read_compressed(message: &[u8]) -> Result<(String, &[u8]), String> {
    let mut cdr = CdrReader::new(message)?;
    read_head(&mut cdr)?;
    Ok((cdr.read_text()?, cdr.read_bytes()?))
}

/// The lens in `sensor_msgs/msg/CameraInfo`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CameraLens {
    pub(crate) head: MessageHead,
    /// Radians; `None` if the camera is not calibrated, or the angle is not from 10 to 160 degrees.
    pub(crate) horizontal_fov_rad: Option<f64>,
}

impl CameraLens {
    pub(crate) fn read(message: &[u8]) -> Result<Self, String> {
        let mut cdr = CdrReader::new(message)?;
        let head = read_head(&mut cdr)?;
        let (_height_px, width_px) = (cdr.read_u32()?, cdr.read_u32()?);
        let distortion = cdr.read_text()?;
        for _ in 0..cdr.read_count(8)? {
            cdr.read_f64()?;
        }
        let [focal_px, ..] = cdr.read_f64s::<9>()?;
        let width_in_focal_lengths = f64::from(width_px) / focal_px;
        let fov = match distortion.as_str() {
            // In a fisheye picture, equal angles are equal distances.
            "equidistant" | "fisheye" => width_in_focal_lengths,
            _ => 2.0 * libm::atan(width_in_focal_lengths / 2.0),
        };
        let usual = 10_f64.to_radians()..=160_f64.to_radians();
        Ok(Self { head, horizontal_fov_rad: Some(fov).filter(|fov| usual.contains(fov)) })
    }
}

/// The position and rotation of one frame in another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RigidTransform {
    pub(crate) position: DVec3,
    /// Has length 1.
    pub(crate) rotation: DQuat,
}

impl RigidTransform {
    pub(crate) const IDENTITY_TRANSFORM: Self = Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY };

    /// `None` if the numbers are not a position and a rotation.
    pub(crate) fn new(position: [f64; 3], rotation: [f64; 4]) -> Option<Self> {
        let (position, rotation) = (DVec3::from(position), DQuat::from_array(rotation));
        let length = rotation.length();
        let is_valid = position.is_finite() && length.is_finite() && length > 1e-6;
        is_valid.then(|| Self { position, rotation: rotation / length })
    }

    /// Composes two placings: `self` places a frame in an outer one, and `inner` places something in that frame. The result
    /// places that thing in the outer frame.
    pub(crate) fn compose_with(self, inner: Self) -> Self {
        let position = self.position + self.rotation * inner.position;
        Self { position, rotation: (self.rotation * inner.rotation).normalize() }
    }

    /// A placing between this and another: on the straight line and the short turn.
    pub(crate) fn interpolate_to(self, other: Self, share: f64) -> Self {
        Self {
            position: self.position.lerp(other.position, share),
            rotation: self.rotation.lerp(other.rotation, share),
        }
    }
}

/// A placing of a frame at a time: a pose, or a transform.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StampedTransform {
    /// The time, and the outer frame.
    pub(crate) head: MessageHead,
    /// The frame that is placed; `None` for a pose, which does not name it.
    pub(crate) child_frame: Option<String>,
    pub(crate) placing: RigidTransform,
    /// Whether the rotation is known. A quaternion of zeros says that it is not.
    pub(crate) has_rotation: bool,
}

/// The poses or transforms in a message. Invalid ones are left out, but positions with a quaternion of zeros are not.
pub(crate) fn read_transforms(kind: MessageKind, message: &[u8]) -> Result<Vec<StampedTransform>, String> {
    /// A header of 12 bytes at least, a text of 4, and 7 numbers.
    const LEAST_BYTES: usize = 12 + 4 + 7 * 8;
    let mut cdr = CdrReader::new(message)?;
    let count = if kind == MessageKind::Transforms { cdr.read_count(LEAST_BYTES)? } else { 1 };
    let mut all = Vec::with_capacity(count);
    for _ in 0..count {
        let head = read_head(&mut cdr)?;
        let child_frame = if kind == MessageKind::Pose { None } else { Some(read_frame(&mut cdr)?) };
        let (position, rotation) = (cdr.read_f64s()?, cdr.read_f64s()?);
        let has_rotation = rotation != [0.0; 4];
        let rotation = if has_rotation { rotation } else { DQuat::IDENTITY.to_array() };
        all.extend(RigidTransform::new(position, rotation).map(|placing| StampedTransform {
            head,
            child_frame,
            placing,
            has_rotation,
        }));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schemas_are_known_by_each_of_their_names() {
        assert_eq!(MessageKind::from_schema("sensor_msgs/msg/CompressedImage"), Some(MessageKind::Compressed));
        assert_eq!(MessageKind::from_schema("sensor_msgs/Image"), Some(MessageKind::Raw));
        assert_eq!(MessageKind::from_schema("nav_msgs::msg::Odometry"), Some(MessageKind::Odometry));
        assert_eq!(MessageKind::from_schema("foxglove.CompressedImage"), None);
    }

    #[test]
    fn composed_placings_apply_both_rotations() {
        let quarter = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
        let robot = RigidTransform { position: DVec3::new(1.0, 2.0, 0.0), rotation: quarter };
        let camera = RigidTransform { position: DVec3::new(0.5, 0.0, 1.0), rotation: DQuat::IDENTITY };
        let placed = robot.compose_with(camera);
        assert!(placed.position.abs_diff_eq(DVec3::new(1.0, 2.5, 1.0), 1e-12));
        assert!(placed.rotation.abs_diff_eq(quarter, 1e-12));
        // A quaternion and its negative are the same rotation.
        let half =
            RigidTransform::IDENTITY_TRANSFORM.interpolate_to(RigidTransform { rotation: -quarter, ..robot }, 0.5);
        assert!((half.rotation * DVec3::X).abs_diff_eq(DVec3::new(0.5, 0.5, 0.0) * 2_f64.sqrt(), 1e-12));
    }

    #[test]
    fn placing_refuses_zero_and_nan_rotations() {
        assert_eq!(RigidTransform::new([0.0; 3], [0.0; 4]), None);
        assert_eq!(RigidTransform::new([f64::NAN, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]), None);
    }
}
