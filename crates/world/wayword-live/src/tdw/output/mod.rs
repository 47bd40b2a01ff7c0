//! Output data of the build: one frame for each kind of data that a command asked for. A frame is a FlatBuffer with a
//! four-letter id. Slots and defaults are those of the classes in `tdw/FBOutput` of the Python client, version 1.13.0.0.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod read;

use super::flatbuffer_reader::FlatBufferError;
pub(super) use read::frame_id;

/// One frame of output data. All positions and rotations are Unity's (see [`crate::unity`]).
#[derive(Debug, Clone, PartialEq)]
pub enum BuildOutput<'a> {
    /// `imag`: pictures of an avatar's camera.
    Images(AvatarImages<'a>),
    /// `segm`: which colour each object has in the `_id` pass.
    Segmentation(Vec<SegmentedObject<'a>>),
    /// `path`: a way over the navmesh.
    Path(NavMeshPath),
    /// `sreg`: boxes of the scene's rooms.
    Regions(Vec<TdwRegion>),
    /// `occu`: which cells of the floor are free.
    Occupancy(TdwOccupancyMap),
    /// `avki`: where a kinematic avatar is.
    Avatar(AvatarPose<'a>),
    /// `tran`: where objects are.
    Transforms(Vec<TdwObjectTransform>),
    /// `boun`: how large objects are.
    Bounds(Vec<TdwObjectBounds>),
    /// `cate`: which colour each category has in the `_category` pass.
    Categories(Vec<(&'a str, [u8; 3])>),
    /// `cama`: matrices of a camera.
    Camera(TdwCameraMatrices<'a>),
    /// `imse`: an avatar's cameras.
    Sensors(&'a str, Vec<AvatarSensor<'a>>),
    /// `isnm`: whether a position is on the navmesh.
    OnNavMesh(OnNavMesh),
    /// `quit`: the build ends; true where it ends without an error.
    Quit(bool),
    /// `vers`: which build it is.
    Version(VersionOutput<'a>),
    /// `ftre`: the build did not receive the commands and asks for them again.
    FailedToReceive,
    /// Anything else, by its id.
    Other([u8; 4]),
}

/// Pictures of one camera at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct AvatarImages<'a> {
    /// The avatar.
    pub avatar: &'a str,
    /// Its camera.
    pub sensor: &'a str,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One picture for each pass.
    pub passes: Vec<PicturePass<'a>>,
}

/// One pass of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PicturePass<'a> {
    /// Which: 1 `_img`, 2 `_id`, 4 `_category`, 16 `_depth`.
    pub mask: i32,
    /// The file, or raw pixels for `_depth`.
    pub bytes: &'a [u8],
    /// 1 PNG, 2 JPEG.
    pub extension: u8,
}

/// An object in the `_id` pass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SegmentedObject<'a> {
    /// The object.
    pub id: i32,
    /// Name of its model.
    pub name: &'a str,
    /// Category of the object, such as `sofa`.
    pub category: &'a str,
    /// Its colour.
    pub colour: [u8; 3],
}

/// A way over the navmesh.
#[derive(Debug, Clone, PartialEq)]
pub struct NavMeshPath {
    /// The id of the request.
    pub id: i32,
    /// Whether it leads all the way (state 1), to the nearest point (2), or nowhere (4).
    pub state: u8,
    /// Its corners.
    pub corners: Vec<[f32; 3]>,
}

/// A room's box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TdwRegion {
    /// Its number.
    pub id: i32,
    /// Its middle.
    pub centre: [f32; 3],
    /// Its size.
    pub size: [f32; 3],
}

/// Free and occupied cells of the floor, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct TdwOccupancyMap {
    /// Rows and columns: the build's `shape[1]` and `shape[0]`, because the client reshapes to them in this order.
    pub shape: [usize; 2],
    /// 0 free, 1 occupied, -1 outside.
    pub cells: Vec<i8>,
    /// x and z of each cell's middle.
    pub positions: Vec<[f32; 2]>,
}

/// Where an avatar is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvatarPose<'a> {
    /// The avatar.
    pub id: &'a str,
    /// Its position.
    pub position: [f32; 3],
    /// Its rotation, x y z w.
    pub rotation: [f32; 4],
    /// Where it looks.
    pub forward: [f32; 3],
}

/// Where an object is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TdwObjectTransform {
    /// The object.
    pub id: i32,
    /// Its position: the middle of its bottom.
    pub position: [f32; 3],
    /// Its rotation, x y z w.
    pub rotation: [f32; 4],
    /// Where its front looks.
    pub forward: [f32; 3],
}

/// How large an object is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TdwObjectBounds {
    /// The object.
    pub id: i32,
    /// Middles of its box's sides: front, back, right, left, top, bottom; then the box's own middle.
    pub points: [[f32; 3]; 7],
}

/// Matrices of a camera, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct TdwCameraMatrices<'a> {
    /// The avatar.
    pub avatar: &'a str,
    /// Its camera.
    pub sensor: &'a str,
    /// From camera to clip space.
    pub projection: [f32; 16],
    /// From world to camera.
    pub camera: [f32; 16],
}

/// One of an avatar's cameras.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvatarSensor<'a> {
    /// Its name.
    pub name: &'a str,
    /// Whether it takes pictures.
    pub is_on: bool,
    /// Its rotation, x y z w.
    pub rotation: [f32; 4],
    /// Where it looks.
    pub forward: [f32; 3],
    /// Vertical field of view, degrees.
    pub field_of_view_deg: f32,
}

/// Whether a position is on the navmesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OnNavMesh {
    /// The id of the request.
    pub id: i32,
    /// Whether the position is on the navmesh.
    pub is_on: bool,
    /// The nearest position on the navmesh.
    pub position: [f32; 3],
}

/// Which build it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VersionOutput<'a> {
    /// TDW's own version.
    pub tdw: &'a str,
    /// Unity's version.
    pub unity: &'a str,
    /// Whether it is a build rather than Unity's editor.
    pub standalone: bool,
}

/// A frame that cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("output data `{id}`, {source}")]
pub struct OutputError {
    /// The frame's id.
    pub id: String,
    /// Position and expected content.
    pub source: FlatBufferError,
}
