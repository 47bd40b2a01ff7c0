//! Projects points of the world onto the pixel grid, for a camera with perspective or for a map without.

use crate::camera::PinholeCamera;
use glam::{DMat3, DVec3, Vec3};

/// Surfaces nearer than this to a camera are cut away (Habitat's near plane).
pub(crate) const NEAR_M: f32 = 0.01;

/// Sub-pixel steps per pixel: corners snap to this grid, so that coverage is decided in integers and shared edges
/// leave neither gaps nor double hits.
pub(crate) const SUBPIXEL_STEPS: i32 = 256;

/// Corners further than this from the picture's centre are clipped, to keep the integers of coverage small.
const GUARD_PX: f32 = 16_384.0;

/// No corner lies further out than this, in steps. After clipping, only rounding can put one there, and only for a
/// triangle that is a thousand kilometres long.
const LIMIT_STEPS: f32 = 2.0 * GUARD_PX * SUBPIXEL_STEPS as f32;

/// The half-space of view points `p` with `normal . p + offset >= 0`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClipPlane {
    pub(crate) normal: Vec3,
    pub(crate) offset: f32,
}

impl ClipPlane {
    pub(crate) fn signed_distance(&self, point: Vec3) -> f32 {
        self.normal.dot(point) + self.offset
    }
}

/// A corner on the sub-pixel grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScreenCorner {
    /// Steps from the left edge of the picture.
    pub(crate) x: i32,
    /// Steps from the top edge.
    pub(crate) y: i32,
    /// Larger is nearer, and linear on the screen: 1 / depth, or -depth on a map.
    pub(crate) nearness: f32,
}

/// A view frame (x right, y down, z forward) with its projection. All single precision, in a fixed order of
/// operations, so a point gives the same corner in every triangle.
#[derive(Clone, Debug)]
pub(crate) struct ViewProjection {
    pub(crate) width: u32,
    pub(crate) height: u32,
    origin: Vec3,
    right: Vec3,
    down: Vec3,
    forward: Vec3,
    /// True for a camera, false for a map.
    perspective: bool,
    /// Pixels per tangent, or per metre on a map.
    scale_px: f32,
    centre_px: [f32; 2],
}

impl ViewProjection {
    /// The projection of a pinhole camera.
    pub(crate) fn for_camera(camera: &PinholeCamera) -> Self {
        let axes = camera.world_from_camera();
        Self::new(camera.position, axes, true, camera.focal_px(), [camera.width, camera.height])
    }

    /// A map seen from `origin` straight down, north up. `origin` falls on the picture's centre, and everything above it is cut
    /// away.
    pub(crate) fn for_map(origin: DVec3, px_per_m: f64, size: [u32; 2]) -> Self {
        Self::new(origin, DMat3::IDENTITY, false, px_per_m, size)
    }

    fn new(origin: DVec3, axes: DMat3, perspective: bool, scale_px: f64, [width, height]: [u32; 2]) -> Self {
        Self {
            width,
            height,
            origin: origin.as_vec3(),
            right: axes.x_axis.as_vec3(),
            down: (-axes.y_axis).as_vec3(),
            forward: (-axes.z_axis).as_vec3(),
            perspective,
            scale_px: scale_px as f32,
            centre_px: [0.5 * width as f32, 0.5 * height as f32],
        }
    }

    /// View coordinates of a world point.
    pub(crate) fn to_view(&self, point: Vec3) -> Vec3 {
        let offset = point - self.origin;
        Vec3::new(offset.dot(self.right), offset.dot(self.down), offset.dot(self.forward))
    }

    /// The planes that a triangle must lie within for its corners to be usable, near plane first.
    pub(crate) fn clip_planes(&self) -> [ClipPlane; 5] {
        self.planes_at([GUARD_PX; 2])
    }

    /// The planes around what the picture shows, near plane first.
    pub(crate) fn frustum_planes(&self) -> [ClipPlane; 5] {
        // One more pixel on each side, because of rounding.
        self.planes_at(self.centre_px.map(|half| half + 1.0))
    }

    /// The near plane, and the planes at this many pixels left, right, above and below the middle of the picture.
    fn planes_at(&self, half_px: [f32; 2]) -> [ClipPlane; 5] {
        let near = ClipPlane { normal: Vec3::Z, offset: if self.perspective { -NEAR_M } else { 0.0 } };
        let side = |axis: Vec3, half_px: f32| {
            let reach = half_px / self.scale_px;
            if self.perspective {
                ClipPlane { normal: axis + Vec3::Z * reach, offset: 0.0 }
            } else {
                ClipPlane { normal: axis, offset: reach }
            }
        };
        let [x, y] = half_px;
        [near, side(Vec3::X, x), side(Vec3::NEG_X, x), side(Vec3::Y, y), side(Vec3::NEG_Y, y)]
    }

    /// Whether a world-space box surely lies outside one of `planes`.
    pub(crate) fn misses_box(&self, planes: &[ClipPlane], centre: Vec3, half_extent: Vec3) -> bool {
        let view_centre = self.to_view(centre);
        planes.iter().any(|plane| {
            let normal = plane.normal;
            let world_normal = self.right * normal.x + self.down * normal.y + self.forward * normal.z;
            let reach = world_normal.abs().dot(half_extent);
            // Rounding of both terms grows with their size.
            let slack = 1e-5 * (reach + view_centre.abs().dot(normal.abs()) + 1e-3);
            plane.signed_distance(view_centre) + reach + slack < 0.0
        })
    }

    /// Whether the corner of a view point is usable without clipping.
    pub(crate) fn within_guard(&self, point: Vec3) -> bool {
        let reach = if self.perspective { GUARD_PX * point.z } else { GUARD_PX };
        let near = if self.perspective { NEAR_M } else { 0.0 };
        point.z >= near && (self.scale_px * point.x).abs() <= reach && (self.scale_px * point.y).abs() <= reach
    }

    /// The corner of a view point within the clip planes.
    pub(crate) fn to_corner(&self, point: Vec3) -> ScreenCorner {
        let (scale, nearness) = if self.perspective {
            let inverse = 1.0 / point.z.max(NEAR_M);
            (self.scale_px * inverse, inverse)
        } else {
            (self.scale_px, -point.z)
        };
        let [centre_x, centre_y] = self.centre_px;
        ScreenCorner {
            x: snap_to_step(centre_x + scale * point.x),
            y: snap_to_step(centre_y + scale * point.y),
            nearness,
        }
    }

    /// The factor that makes a corner's attributes linear on the screen.
    pub(crate) fn inverse_w(&self, nearness: f32) -> f32 {
        if self.perspective { nearness } else { 1.0 }
    }

    /// Distance along forward of a covered pixel.
    pub(crate) fn depth_m(&self, nearness: f32) -> f32 {
        if self.perspective { 1.0 / nearness } else { -nearness }
    }

    /// Sine of the elevation of the ray through the centre of pixel (x, y).
    pub(crate) fn sin_elevation(&self, x: usize, y: usize) -> f32 {
        if !self.perspective {
            return self.forward.z;
        }
        let across = (x as f32 + 0.5 - self.centre_px[0]) / self.scale_px;
        let down = (y as f32 + 0.5 - self.centre_px[1]) / self.scale_px;
        let z = self.forward.z + self.right.z * across + self.down.z * down;
        (z / (1.0 + across * across + down * down).sqrt()).clamp(-1.0, 1.0)
    }
}

/// The nearest step of the sub-pixel grid. (`f32::round` is a function call on the baseline x86-64.)
fn snap_to_step(px: f32) -> i32 {
    let steps = (px * SUBPIXEL_STEPS as f32).clamp(-LIMIT_STEPS, LIMIT_STEPS);
    (if steps >= 0.0 { steps + 0.5 } else { steps - 0.5 }) as i32
}
