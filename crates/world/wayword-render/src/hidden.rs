//! Skips clusters of triangles that lie behind what is drawn already: in a house, most of what a view's cone holds is in other rooms.

use crate::{
    cluster::TriangleCluster,
    raster::{PictureBand, TILE_WIDTH_PX},
    view::{SUBPIXEL_STEPS, ScreenCorner, ViewProjection},
};
use glam::Vec3;

/// A cluster counts as nearer than it is by this share, because nearness is rounded.
const NEARNESS_SLACK: f32 = 1e-3;

/// The clusters that a view can show, the nearest first. The renderer draws them in groups of this order.
pub(crate) fn sort_by_distance<'a>(
    clusters: Vec<&'a TriangleCluster>,
    view: &ViewProjection,
) -> Vec<&'a TriangleCluster> {
    let distance_m = |cluster: &TriangleCluster| {
        let off = (view.to_view(cluster.centre)).length() - cluster.half_extent.length();
        off.max(0.0)
    };
    let mut sorted: Vec<(f32, &TriangleCluster)> =
        clusters.into_iter().map(|cluster| (distance_m(cluster), cluster)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    sorted.into_iter().map(|(_, cluster)| cluster).collect()
}

/// Whether everything of a cluster lies behind what the bands show. False where that is not certain.
pub(crate) fn is_hidden(cluster: &TriangleCluster, view: &ViewProjection, bands: &[PictureBand]) -> bool {
    let Some((corners, nearness)) = box_on_screen(cluster, view) else { return false };
    let pixel =
        |steps: i32, end: u32| (steps.div_euclid(SUBPIXEL_STEPS)).clamp(0, end.saturating_sub(1) as i32) as usize;
    let bounds = |of: fn(&ScreenCorner) -> i32| {
        let values = corners.iter().map(of);
        values.fold((i32::MAX, i32::MIN), |(low, high), value| (low.min(value), high.max(value)))
    };
    let ((left, right), (top, bottom)) = (bounds(|corner| corner.x), bounds(|corner| corner.y));
    let columns = pixel(left - SUBPIXEL_STEPS, view.width)..=pixel(right + SUBPIXEL_STEPS, view.width);
    let rows = pixel(top - SUBPIXEL_STEPS, view.height)..=pixel(bottom + SUBPIXEL_STEPS, view.height);
    let nearest = nearness * (1.0 + NEARNESS_SLACK);
    bands.iter().filter(|band| band.holds_rows(&rows)).all(|band| {
        let tiles = columns.start() / TILE_WIDTH_PX..=columns.end() / TILE_WIDTH_PX;
        band.tiles.get(tiles).is_some_and(|tiles| tiles.iter().all(|farthest| *farthest > nearest))
    })
}

/// The corners of a cluster's box on the screen, and the nearness of the nearest; `None` where a corner cannot be projected.
fn box_on_screen(cluster: &TriangleCluster, view: &ViewProjection) -> Option<([ScreenCorner; 8], f32)> {
    let mut corners = [ScreenCorner { x: 0, y: 0, nearness: 0.0 }; 8];
    for (number, corner) in corners.iter_mut().enumerate() {
        let sign = |bit: usize| if number >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let point = cluster.centre + cluster.half_extent * Vec3::new(sign(0), sign(1), sign(2));
        let in_view = view.to_view(point);
        if !view.within_guard(in_view) {
            return None;
        }
        *corner = view.to_corner(in_view);
    }
    let nearest = corners.iter().map(|corner| corner.nearness).fold(f32::NEG_INFINITY, f32::max);
    Some((corners, nearest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{PinholeCamera, raster::BatchTriangleIndex};
    use glam::DVec3;

    fn view() -> ViewProjection {
        ViewProjection::for_camera(&PinholeCamera {
            position: DVec3::ZERO,
            heading_rad: 0.0,
            elevation_rad: 0.0,
            vertical_fov_rad: 1.2,
            width: 64,
            height: 48,
        })
    }

    fn cluster(north_m: f32) -> TriangleCluster {
        TriangleCluster {
            first_triangle: 0,
            triangles: 1,
            first_vertex: 0,
            vertices: 3,
            surface: 0,
            centre: Vec3::new(0.0, north_m, 0.0),
            half_extent: Vec3::splat(0.2),
        }
    }

    /// Bands of which every pixel shows something at one distance.
    fn wall_at(distance_m: f32) -> Vec<PictureBand> {
        let wall = |first_row: u32| {
            let mut band = PictureBand::new(64, first_row, 12);
            band.nearness.fill(1.0 / distance_m);
            band.seen.fill(BatchTriangleIndex { batch: 0, place: 0 });
            band.measure_tiles();
            band
        };
        (0..4).map(|band| wall(12 * band)).collect()
    }

    #[test]
    fn a_cluster_is_hidden_only_behind_what_covers_all_of_it() {
        let mut bands = wall_at(2.0);
        assert!(is_hidden(&cluster(3.0), &view(), &bands));
        assert!(!is_hidden(&cluster(2.1), &view(), &bands), "its front is before the wall");
        assert!(!is_hidden(&cluster(0.1), &view(), &bands), "it reaches behind the eye");
        // A hole in the wall, where the cluster is.
        let middle = 11 * 64 + 32;
        bands[1].nearness[middle] = f32::NEG_INFINITY;
        bands[1].measure_tiles();
        assert!(!is_hidden(&cluster(3.0), &view(), &bands));
    }

    #[test]
    fn nearer_clusters_come_first() {
        let clusters = [cluster(9.0), cluster(1.0), cluster(5.0)];
        let sorted = sort_by_distance(clusters.iter().collect(), &view());
        let north: Vec<f32> = sorted.iter().map(|cluster| cluster.centre.y).collect();
        assert_eq!(north, [1.0, 5.0, 9.0]);
    }
}
