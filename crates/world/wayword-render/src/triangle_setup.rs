//! Turns the clusters of a scene into triangles on the pixel grid.
//!
//! Clusters outside the view are skipped. A triangle that reaches behind the eye or far beyond the picture is clipped; one
//! that faces away or covers no pixel's centre is dropped.

use crate::clip::{ClipVertex, clip_triangle};
use crate::cluster::{SceneTriangle, TriangleCluster};
use crate::scene::RenderScene;
use crate::view::{ClipPlane, SUBPIXEL_STEPS, ScreenCorner, ViewProjection};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::{Add, Mul};

/// Marks a triangle without an entry in [`TriangleBatch::cuts`], because it was not clipped.
const NO_CUT: u32 = u32::MAX;

/// A triangle that covers, or may cover, pixels of the picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScreenTriangle {
    /// Wound so that the doubled area of [`ScreenTriangle::twice_area`] is positive.
    pub(crate) corners: [ScreenCorner; 3],
    /// Index into the scene's triangles.
    pub(crate) triangle: u32,
    /// Index into its batch's cuts, or [`NO_CUT`].
    cut: u32,
    /// Whether the last two corners were swapped to make the area positive.
    swapped: bool,
    /// Rows of pixels it can cover, both ends included.
    pub(crate) rows: [u16; 2],
}

/// The triangles that one cluster puts on the screen.
#[derive(Debug)]
pub(crate) struct TriangleBatch {
    pub(crate) triangles: Vec<ScreenTriangle>,
    /// For parts of clipped triangles: for each of their corners, the weights of the whole triangle's corners.
    cuts: Vec<[Vec3; 3]>,
    /// Index into the scene's surfaces.
    pub(crate) surface: u32,
    /// Rows of pixels its triangles can cover, both ends included.
    pub(crate) rows: [u16; 2],
}

impl ScreenTriangle {
    /// Twice the area, in square steps.
    pub(crate) fn twice_area(&self) -> i64 {
        doubled_area(&self.corners)
    }

    /// The values of the corners, given those of the corners of the scene's triangle.
    pub(crate) fn at_corners<T>(&self, batch: &TriangleBatch, whole: [T; 3]) -> [T; 3]
    where
        T: Copy + Add<Output = T> + Mul<f32, Output = T>,
    {
        let [a, b, c] = match batch.cuts.get(self.cut as usize) {
            None => whole,
            Some(cut) => cut.map(|w| whole[0] * w.x + whole[1] * w.y + whole[2] * w.z),
        };
        if self.swapped { [a, c, b] } else { [a, b, c] }
    }
}

/// The clusters of a scene that lie within a view.
pub(crate) fn clusters_within<'a>(scene: &'a RenderScene, view: &ViewProjection) -> Vec<&'a TriangleCluster> {
    let frustum = view.frustum_planes();
    let visible = |cluster: &&TriangleCluster| !view.misses_box(&frustum, cluster.centre, cluster.half_extent);
    scene.soup.clusters.iter().filter(visible).collect()
}

/// The triangles that clusters put on the screen, in the order of the clusters.
pub(crate) fn batches_for_clusters(
    scene: &RenderScene,
    view: &ViewProjection,
    clusters: &[&TriangleCluster],
) -> Vec<TriangleBatch> {
    let clip_planes = view.clip_planes();
    clusters.par_iter().filter_map(|cluster| batch_for_cluster(scene, view, &clip_planes, cluster)).collect()
}

/// The triangles that a cluster puts on the screen; `None` if there are none.
fn batch_for_cluster(
    scene: &RenderScene,
    view: &ViewProjection,
    clip_planes: &[ClipPlane],
    cluster: &TriangleCluster,
) -> Option<TriangleBatch> {
    let surface = &scene.surfaces[cluster.surface as usize];
    let double_sided = scene.materials[surface.material].double_sided;
    let mut builder = TriangleBatchBuilder {
        size: [view.width, view.height],
        double_sided,
        batch: TriangleBatch {
            triangles: Vec::with_capacity(cluster.triangles as usize),
            cuts: Vec::new(),
            surface: cluster.surface,
            rows: [u16::MAX, 0],
        },
    };
    let corners = usable_corners(scene, view, cluster);
    let first = cluster.first_triangle as usize;
    for (index, triangle) in (first..).zip(&scene.soup.triangles[first..first + cluster.triangles as usize]) {
        let [a, b, c] = triangle.corners.map(|v| corners[(v - cluster.first_vertex) as usize]);
        if let (Some(a), Some(b), Some(c)) = (a, b, c) {
            builder.push_triangle([a, b, c], index as u32, None);
        } else {
            push_clipped(&mut builder, scene, view, clip_planes, triangle, index as u32);
        }
    }
    (!builder.batch.triangles.is_empty()).then_some(builder.batch)
}

/// The corner of each vertex of a cluster; `None` where the vertex needs clipping.
fn usable_corners(scene: &RenderScene, view: &ViewProjection, cluster: &TriangleCluster) -> Vec<Option<ScreenCorner>> {
    let first = cluster.first_vertex as usize;
    let positions = &scene.soup.positions[first..first + cluster.vertices as usize];
    let corner = |&position: &Vec3| {
        let point = view.to_view(position);
        view.within_guard(point).then(|| view.to_corner(point))
    };
    positions.iter().map(corner).collect()
}

/// Clips a triangle, and adds the convex polygon that remains as a fan of triangles.
fn push_clipped(
    builder: &mut TriangleBatchBuilder,
    scene: &RenderScene,
    view: &ViewProjection,
    clip_planes: &[ClipPlane],
    triangle: &SceneTriangle,
    index: u32,
) {
    let points = triangle.corners.map(|v| view.to_view(scene.soup.positions[v as usize]));
    if clip_planes.iter().any(|plane| points.iter().all(|&p| plane.signed_distance(p) < 0.0)) {
        return;
    }
    let polygon = clip_triangle(points, clip_planes);
    let corner = |vertex: &ClipVertex| view.to_corner(vertex.point);
    for i in 2..polygon.len() {
        let fan = [&polygon[0], &polygon[i - 1], &polygon[i]];
        builder.push_triangle(fan.map(corner), index, Some(fan.map(|vertex| vertex.weights)));
    }
}

/// Collects the triangles of a batch that can be seen.
struct TriangleBatchBuilder {
    /// Width and height of the picture, pixels.
    size: [u32; 2],
    double_sided: bool,
    batch: TriangleBatch,
}

impl TriangleBatchBuilder {
    /// Adds a triangle unless it has no area, faces away or covers no pixel. `cut` has the weights of the corners of a
    /// clipped one.
    fn push_triangle(&mut self, mut corners: [ScreenCorner; 3], triangle: u32, cut: Option<[Vec3; 3]>) {
        // Counter-clockwise in the world is a negative area here, where y runs down.
        let area = doubled_area(&corners);
        if area == 0 || (area > 0 && !self.double_sided) {
            return;
        }
        let swapped = area < 0;
        if swapped {
            corners.swap(1, 2);
        }
        let [width, height] = self.size;
        let columns = centres_between(corners.map(|c| c.x), width);
        let rows = centres_between(corners.map(|c| c.y), height);
        let (Some(_), Some(rows)) = (columns, rows) else { return };
        let batch = &mut self.batch;
        batch.rows = [batch.rows[0].min(rows[0]), batch.rows[1].max(rows[1])];
        let cut = cut.map_or(NO_CUT, |weights| {
            batch.cuts.push(weights);
            batch.cuts.len() as u32 - 1
        });
        batch.triangles.push(ScreenTriangle { corners, triangle, cut, swapped, rows });
    }
}

/// Twice the signed area of a triangle on the screen, in square steps.
fn doubled_area([a, b, c]: &[ScreenCorner; 3]) -> i64 {
    let (ab, ac) = ([b.x - a.x, b.y - a.y].map(i64::from), [c.x - a.x, c.y - a.y].map(i64::from));
    ab[0] * ac[1] - ab[1] * ac[0]
}

/// The first and last of `count` pixels that have their centre between the smallest and largest of `steps`; `None` if there
/// is no such pixel.
pub(crate) fn centres_between(steps: [i32; 3], count: u32) -> Option<[u16; 2]> {
    let [a, b, c] = steps;
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let first = (low + SUBPIXEL_STEPS / 2 - 1).div_euclid(SUBPIXEL_STEPS).max(0);
    let last = (high - SUBPIXEL_STEPS / 2).div_euclid(SUBPIXEL_STEPS).min(count as i32 - 1);
    (first <= last).then_some([first as u16, last as u16])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centres_are_found_to_the_step() {
        assert_eq!(centres_between([128, 128, 128], 4), Some([0, 0]));
        assert_eq!(centres_between([129, 200, 383], 4), None);
        assert_eq!(centres_between([129, 200, 384], 4), Some([1, 1]));
        assert_eq!(centres_between([-9000, 200, 9000], 4), Some([0, 3]));
        assert_eq!(centres_between([-900, -200, -300], 4), None);
        assert_eq!(centres_between([1024, 2000, 3000], 4), None);
    }
}
