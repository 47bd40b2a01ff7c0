//! Draws views of meshes and of cube maps, and top-down maps, on the CPU. A picture is the same on every machine.
//!
//! The renderer knows meshes, materials, textures and ids, but not rooms or platforms. Like Habitat it draws without
//! lights: the light is already baked into vertex colours or textures. All geometry is in the world frame:
//! right-handed, metres, z up; headings are 0 along +y and grow clockwise seen from above.
//!
//! The steps of drawing, in order: `scene` checks the meshes and sorts them into clusters (`cluster`), `view` projects
//! corners to the pixel grid, `triangle_setup` and `clip` make screen triangles, `raster` finds the nearest triangle of each
//! pixel, and `shade` gives the pixel its colour.
//!
//! ```
//! use glam::{DVec3, Vec3};
//! use wayword_render::{Mesh, MeshMaterial, PinholeCamera, RenderScene, render_scene};
//!
//! let wall = Mesh {
//!     positions: vec![Vec3::new(-1.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0), Vec3::new(0.0, 2.0, 2.0)],
//!     triangles: vec![[0, 1, 2]],
//!     id: 7,
//!     ..Mesh::default()
//! };
//! let scene = RenderScene::new(vec![wall], vec![MeshMaterial::default()], vec![])?;
//! let camera = PinholeCamera {
//!     position: DVec3::new(0.0, 0.0, 1.0),
//!     heading_rad: 0.0,
//!     elevation_rad: 0.0,
//!     vertical_fov_rad: 60f64.to_radians(),
//!     width: 64,
//!     height: 48,
//! };
//! let picture = render_scene(&scene, &camera)?;
//! assert_eq!(picture.ids[24 * 64 + 32], 7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where things are
//! - `hidden`: what lies behind nearer things, which is not drawn.
//! - `evident`: which objects of a picture are visible enough to be named; `visibility` counts their pixels.
//! - `panorama`, `storey`, `top_down`: panoramas, and maps from above.
//! - `mipmap`, `texture`: how textures are looked up.
//! - `cubemap`, `cube_row`: views out of photographs.
//! - `camera`, `mesh`: the input of the renderer; `picture`: its result and its errors.
//! - `render`: the entry that carries out the steps; `background`: the colour where no triangle is; `bilinear`: colours between the
//!   centres of pixels.

mod background;
mod bilinear;
mod camera;
mod clip;
mod cluster;
mod cube_row;
mod cubemap;
mod evident;
mod hidden;
mod mesh;
mod mipmap;
mod panorama;
mod picture;
mod raster;
mod render;
mod scene;
mod shade;
mod storey;
mod texture;
mod top_down;
mod triangle_setup;
mod view;
mod visibility;

pub use background::PictureBackground;
pub use camera::{PinholeCamera, to_flat_gaze};
pub use cubemap::{CubeFace, CubeMap, CubeMapError, sample_view};
pub use evident::{box_corners, evident_objects};
pub use mesh::{Mesh, MeshMaterial};
pub use panorama::{Panorama, PanoramaError, QuarterView, join_panorama};
pub use picture::{MAX_SIDE_PX, RenderError, RenderedPicture};
pub use render::{render_ids, render_scene};
pub use scene::{MAX_COORDINATE_M, MAX_TRIANGLES, RenderScene, SceneError};
pub use storey::draw_storey;
pub use texture::{MAX_TEXTURE_SIDE, Texture, TextureError, TextureFilter};
pub use top_down::top_down;
pub use visibility::{VisibleObject, visible_objects};
