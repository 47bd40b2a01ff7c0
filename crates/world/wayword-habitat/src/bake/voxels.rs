//! Marks the voxels that triangles touch.
//!
//! The triangles are cut here, as Recast does it (`rasterizeTri`), and not by rerecast 0.5.0. Its cutting goes wrong where
//! rounding leaves nothing of a triangle for its last row or column of voxels: it then takes an old piece again, and walls
//! appear in other places. Each piece goes to rerecast as a triangle within one column of voxels, which it need not cut.

use glam::Vec3A;
use rerecast::{AreaType, Heightfield, TriMesh};

const X_AXIS: usize = 0;
const Z_AXIS: usize = 2;

/// Marks the voxels that each triangle touches.
pub(super) fn fill_voxels(
    solid: &mut Heightfield,
    mesh: &TriMesh,
    climb: u16,
) -> Result<(), Box<dyn std::error::Error>> {
    for (corners, area) in mesh.indices.iter().zip(&mesh.area_types) {
        let triangle = corners.to_array().map(|corner| mesh.vertices[corner as usize]);
        fill_triangle(solid, &triangle, *area, climb)?;
    }
    Ok(())
}

/// Cuts a triangle along rows and columns of voxels, and marks the height of each piece in its column.
fn fill_triangle(
    solid: &mut Heightfield,
    triangle: &[Vec3A; 3],
    area: AreaType,
    climb: u16,
) -> Result<(), Box<dyn std::error::Error>> {
    let (low, side) = (Vec3A::from(solid.aabb.min), solid.cell_size);
    let (rows, columns) = (i32::from(solid.height), i32::from(solid.width));
    for (row, in_row) in slice_polygon(triangle.to_vec(), Z_AXIS, low.z, side, rows) {
        for (column, piece) in slice_polygon(in_row, X_AXIS, low.x, side, columns) {
            let (bottom, top) = piece.iter().fold((f32::MAX, f32::MIN), |(b, t), at| (b.min(at.y), t.max(at.y)));
            let middle = low + Vec3A::new(column as f32 + 0.5, 0.0, row as f32 + 0.5) * side;
            let within = [bottom, top, top].map(|y| Vec3A::new(middle.x, y, middle.z));
            solid.rasterize_triangle(within, area, climb)?;
        }
    }
    Ok(())
}

/// Cuts a convex polygon into slices of equal thickness along an axis, each with its number. Slices before the first and
/// after the last of `count` are left out.
fn slice_polygon(mut rest: Vec<Vec3A>, axis: usize, low: f32, side: f32, count: i32) -> Vec<(i32, Vec<Vec3A>)> {
    let ends = rest.iter().fold((f32::MAX, f32::MIN), |(a, b), at| (a.min(at[axis]), b.max(at[axis])));
    let number = |at: f32| (((at - low) / side).floor() as i32).clamp(-1, count - 1);
    let (first, last) = (number(ends.0), number(ends.1));
    let mut slices = Vec::new();
    for slice in first..=last {
        let (below, above) = cut_polygon(&rest, axis, low + (slice + 1) as f32 * side);
        rest = above;
        if slice >= 0 && below.len() >= 3 {
            slices.push((slice, below));
        }
    }
    slices
}

/// Cuts a convex polygon at a position on an axis: the part below, and the part above.
fn cut_polygon(polygon: &[Vec3A], axis: usize, at: f32) -> (Vec<Vec3A>, Vec<Vec3A>) {
    let (mut below, mut above) = (Vec::with_capacity(polygon.len() + 1), Vec::with_capacity(polygon.len() + 1));
    for (a, b) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (left_a, left_b) = (at - a[axis], at - b[axis]);
        if left_a >= 0.0 {
            below.push(*a);
        }
        if left_a <= 0.0 {
            above.push(*a);
        }
        if left_a * left_b < 0.0 {
            let on_line = *a + (*b - *a) * (left_a / (left_a - left_b));
            below.push(on_line);
            above.push(on_line);
        }
    }
    (below, above)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rerecast::{Aabb3d, HeightfieldBuilder};

    fn area_m2(polygon: &[Vec3A]) -> f32 {
        let fan = (1..polygon.len().saturating_sub(1))
            .map(|n| (polygon[n] - polygon[0]).cross(polygon[n + 1] - polygon[0]).length() / 2.0);
        fan.sum()
    }

    proptest! {
        #[test]
        fn the_slices_of_a_triangle_are_as_large_as_the_triangle(
            corners in prop::array::uniform3((0.0..3.0f32, 0.0..2.0f32, 0.0..3.0f32)),
        ) {
            let triangle: Vec<Vec3A> = corners.iter().map(|(x, y, z)| Vec3A::new(*x, *y, *z)).collect();
            let rows = slice_polygon(triangle.clone(), Z_AXIS, 0.0, 0.05, 60);
            let columns = rows.iter().flat_map(|(_, row)| slice_polygon(row.clone(), X_AXIS, 0.0, 0.05, 60));
            let sum: f32 = columns.map(|(_, piece)| area_m2(&piece)).sum();
            prop_assert!((sum - area_m2(&triangle)).abs() < 1e-3, "{sum}");
        }
    }

    /// The columns of voxels that are filled.
    fn filled(triangle: [Vec3A; 3]) -> Vec<(u16, u16)> {
        let aabb = Aabb3d { min: glam::Vec3::ZERO, max: glam::Vec3::new(4.0, 2.5, 4.0) };
        let mut solid = HeightfieldBuilder { aabb, cell_size: 0.05, cell_height: 0.2 }.build().unwrap();
        fill_triangle(&mut solid, &triangle, AreaType::NOT_WALKABLE, 1).unwrap();
        let columns = (0..solid.height).flat_map(|z| (0..solid.width).map(move |x| (x, z)));
        columns
            .filter(|(x, z)| solid.spans[usize::from(*x) + usize::from(*z) * usize::from(solid.width)].is_some())
            .collect()
    }

    #[test]
    fn filled_voxels_lie_only_near_the_triangle() {
        // A post with its sides on the borders of voxels.
        for at in [1.0, 1.05, 2.1, 3.3, 3.85_f32] {
            let post = [Vec3A::new(at, 0.0, at), Vec3A::new(at + 0.15, 2.4, at), Vec3A::new(at, 2.4, at)];
            let columns = filled(post);
            let near = |n: u16| (f32::from(n) * 0.05 - at).abs() < 0.26;
            assert!(!columns.is_empty() && columns.iter().all(|(x, z)| near(*x) && near(*z)), "{at}: {columns:?}");
        }
    }
}
