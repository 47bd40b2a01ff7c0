//! Fills voxels with triangles, and cuts those that Recast cannot cut.

use glam::Vec3A;
use rerecast::{AreaType, Heightfield, TriMesh};
use wayword_core::contain::contained;

/// How often a triangle is cut into four at most.
const CUTS: u32 = 4;

/// A triangle that cannot be cut along the voxels, however small its pieces are.
#[derive(Debug, thiserror::Error)]
#[error("the triangle with the corners {0:?}, {1:?} and {2:?} cannot be cut along the voxels")]
struct Uncut([f32; 3], [f32; 3], [f32; 3]);

/// Marks the voxels that each triangle touches.
///
/// Recast cuts a triangle along the voxels into pieces of seven corners at most. Where an edge runs nearly along a row of
/// voxels, rounding makes more of them, and rerecast panics. Such a triangle is cut into four, which touch the same voxels.
pub(super) fn fill(solid: &mut Heightfield, mesh: &TriMesh, climb: u16) -> Result<(), Box<dyn std::error::Error>> {
    for (corners, area) in mesh.indices.iter().zip(&mesh.area_types) {
        let triangle = corners.to_array().map(|corner| mesh.vertices[corner as usize]);
        fill_one(solid, triangle, *area, climb, CUTS)?;
    }
    Ok(())
}

fn fill_one(
    solid: &mut Heightfield,
    triangle: [Vec3A; 3],
    area: AreaType,
    climb: u16,
    cuts: u32,
) -> Result<(), Box<dyn std::error::Error>> {
    // It panics while it cuts, and only adds whole spans: those that are there stay sound.
    match contained(|| solid.rasterize_triangle(triangle, area, climb)) {
        Some(done) => Ok(done?),
        None if cuts == 0 => {
            let [a, b, c] = triangle.map(|corner| corner.to_array());
            Err(Uncut(a, b, c).into())
        }
        None => quarters(triangle).into_iter().try_for_each(|piece| fill_one(solid, piece, area, climb, cuts - 1)),
    }
}

/// A triangle cut at the middles of its sides.
fn quarters([a, b, c]: [Vec3A; 3]) -> [[Vec3A; 3]; 4] {
    let (ab, bc, ca) = (a.midpoint(b), b.midpoint(c), c.midpoint(a));
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_are_as_large_as_the_whole() {
        let area = |[a, b, c]: [Vec3A; 3]| (b - a).cross(c - a).length();
        let leaf = [[0.19, 0.29, -4.9], [0.18, 0.29, -4.85], [0.32, 0.31, -4.85]].map(Vec3A::from);
        assert!((quarters(leaf).map(area).iter().sum::<f32>() / area(leaf) - 1.0).abs() < 1e-4);
    }
}
