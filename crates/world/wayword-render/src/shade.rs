//! Computes the colour of a covered pixel: texture times base colour times baked light.
//!
//! Texture coordinates and light are interpolated between the triangle's corners in perspective: attributes divided by the
//! depth are linear on the screen, so the weights of the corners are divided by their depths.

use crate::mesh::MeshMaterial;
use crate::raster::BatchTriangleIndex;
use crate::scene::RenderScene;
use crate::triangle_setup::TriangleBatch;
use crate::view::{SUBPIXEL_STEPS, ViewProjection};
use glam::{Vec2, Vec3};

/// One triangle, prepared for shading its pixels.
pub(crate) struct TriangleShader<'a> {
    scene: &'a RenderScene,
    material: &'a MeshMaterial,
    /// The corners, in sub-pixel steps.
    corners: [[i64; 2]; 3],
    /// 1 / twice the area of the triangle on the screen.
    inverse_area: f32,
    /// 1 / depth of each corner; 1 on a map. `w` is the customary name of the divisor in perspective.
    inverse_w: Vec3,
    /// Attributes at the corners.
    uvs: [Vec2; 3],
    light: [Vec3; 3],
}

impl<'a> TriangleShader<'a> {
    pub(crate) fn new(
        scene: &'a RenderScene,
        view: &ViewProjection,
        batches: &[TriangleBatch],
        seen: BatchTriangleIndex,
    ) -> Self {
        let batch = &batches[seen.batch as usize];
        let triangle = &batch.triangles[seen.place as usize];
        let material = &scene.materials[scene.surfaces[batch.surface as usize].material];
        let vertices = scene.soup.triangles[triangle.triangle as usize].corners.map(|v| v as usize);
        let uvs = vertices.map(|v| scene.soup.uvs[v]);
        let [r, g, b, _] = material.base_colour;
        let light = vertices.map(|v| Vec3::from(scene.soup.colours[v]) * Vec3::new(r, g, b));
        Self {
            scene,
            material,
            corners: triangle.corners.map(|c| [i64::from(c.x), i64::from(c.y)]),
            inverse_area: 1.0 / triangle.twice_area() as f32,
            inverse_w: Vec3::from(triangle.corners.map(|c| view.inverse_w(c.nearness))),
            uvs: triangle.at_corners(batch, uvs),
            light: triangle.at_corners(batch, light),
        }
    }

    /// Texture times base colour times light at a pixel's centre.
    pub(crate) fn shade_pixel(&self, column: usize, row: usize) -> [u8; 3] {
        let share = self.corner_weights(column, row) * self.inverse_w;
        let w = 1.0 / (share.x + share.y + share.z);
        let share = share * w;
        let light = self.light[0] * share.x + self.light[1] * share.y + self.light[2] * share.z;
        let texel = match self.material.texture {
            None => Vec3::splat(255.0),
            Some(texture) => {
                let uv = self.uv_at(share);
                self.scene.textures[texture].sample_at(uv, || self.uv_footprint(share, w))
            }
        };
        // Casting saturates.
        (light * texel + Vec3::splat(0.5)).to_array().map(|value| value as u8)
    }

    /// Texture coordinates for these shares of the three corners.
    fn uv_at(&self, share: Vec3) -> Vec2 {
        self.uvs[0] * share.x + self.uvs[1] * share.y + self.uvs[2] * share.z
    }

    /// Weights of the corners at a pixel's centre, linear on the screen: the areas opposite them.
    fn corner_weights(&self, column: usize, row: usize) -> Vec3 {
        let [x, y] =
            [column, row].map(|pixel| pixel as i64 * i64::from(SUBPIXEL_STEPS) + i64::from(SUBPIXEL_STEPS / 2));
        let area = |from: [i64; 2], to: [i64; 2]| (to[0] - from[0]) * (y - from[1]) - (to[1] - from[1]) * (x - from[0]);
        let [a, b, c] = self.corners;
        Vec3::new(area(b, c) as f32, area(c, a) as f32, area(a, b) as f32) * self.inverse_area
    }

    /// How the texture coordinates change to the next pixel on the right and below (their exact derivatives).
    fn uv_footprint(&self, share: Vec3, w: f32) -> [Vec2; 2] {
        let [a, b, c] = self.corners;
        let scale = SUBPIXEL_STEPS as f32 * self.inverse_area;
        let edges = [(b, c), (c, a), (a, b)];
        let across = edges.map(|(from, to)| (from[1] - to[1]) as f32);
        let down = edges.map(|(from, to)| (to[0] - from[0]) as f32);
        [across, down].map(|change| {
            let change = Vec3::from(change) * scale * self.inverse_w;
            let total = change.x + change.y + change.z;
            self.uv_at((change - share * total) * w)
        })
    }
}
