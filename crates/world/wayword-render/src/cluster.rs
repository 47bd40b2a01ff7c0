//! Sorts triangles into groups that lie close together, so that a whole group outside the view is skipped at once.

use crate::mesh::Mesh;
use glam::{Vec2, Vec3};

/// Triangles per cluster, at most.
pub(crate) const MAX_CLUSTER_TRIANGLES: usize = 256;

/// Marks a vertex that is not stored yet.
const NOT_STORED: u32 = u32::MAX;

/// A triangle of a [`TriangleSoup`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct SceneTriangle {
    /// Indices into the soup's vertices.
    pub(crate) corners: [u32; 3],
    /// Number in the caller's order. At equal depth the triangle with the lower number is visible, so that the division into
    /// clusters does not change the picture.
    pub(crate) source: u32,
}

/// A run of triangles and of the vertices they use.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TriangleCluster {
    pub(crate) first_triangle: u32,
    /// Number of its triangles.
    pub(crate) triangles: u32,
    pub(crate) first_vertex: u32,
    /// Number of its vertices.
    pub(crate) vertices: u32,
    /// Index into the scene's surfaces.
    pub(crate) surface: u32,
    /// Middle of the box around its triangles, metres, world frame.
    pub(crate) centre: Vec3,
    /// From the middle of the box to its sides, metres.
    pub(crate) half_extent: Vec3,
}

/// All meshes of a scene as clusters. A vertex that two clusters use is stored twice.
#[derive(Debug, Default)]
pub(crate) struct TriangleSoup {
    pub(crate) clusters: Vec<TriangleCluster>,
    pub(crate) triangles: Vec<SceneTriangle>,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) uvs: Vec<Vec2>,
    pub(crate) colours: Vec<[f32; 3]>,
}

impl TriangleSoup {
    /// Adds a checked mesh; `surface` is the index that its clusters get.
    pub(crate) fn add_mesh(&mut self, mesh: &Mesh, surface: u32) {
        let first_source = self.triangles.len() as u32;
        let order = morton_order(mesh);
        // Where each of the mesh's vertices was stored last.
        let mut stored = vec![NOT_STORED; mesh.positions.len()];
        for group in order.chunks(MAX_CLUSTER_TRIANGLES) {
            self.add_cluster(mesh, group, first_source, surface, &mut stored);
        }
    }

    /// Adds a cluster of the triangles in `group`, numbers within the mesh. `stored` has the place of each vertex of the mesh.
    fn add_cluster(&mut self, mesh: &Mesh, group: &[u32], first_source: u32, surface: u32, stored: &mut [u32]) {
        let (first_vertex, first_triangle) = (self.positions.len() as u32, self.triangles.len() as u32);
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for &index in group {
            let corners = mesh.triangles[index as usize].map(|vertex| {
                let vertex = vertex as usize;
                // Places before this cluster's belong to other clusters.
                if stored[vertex] == NOT_STORED || stored[vertex] < first_vertex {
                    let position = mesh.positions[vertex];
                    (low, high) = (low.min(position), high.max(position));
                    stored[vertex] = self.positions.len() as u32;
                    self.positions.push(position);
                    self.uvs.push(mesh.uvs.get(vertex).copied().unwrap_or_default());
                    self.colours.push(mesh.colours.get(vertex).copied().unwrap_or([1.0; 3]));
                }
                stored[vertex]
            });
            self.triangles.push(SceneTriangle { corners, source: first_source + index });
        }
        self.clusters.push(TriangleCluster {
            first_triangle,
            triangles: group.len() as u32,
            first_vertex,
            vertices: self.positions.len() as u32 - first_vertex,
            surface,
            centre: (low + high) * 0.5,
            half_extent: (high - low) * 0.5,
        });
    }
}

/// The numbers of a mesh's triangles, in an order in which neighbours in space are near each other (Morton order of the
/// centroids).
fn morton_order(mesh: &Mesh) -> Vec<u32> {
    let mut order: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    if order.len() <= MAX_CLUSTER_TRIANGLES {
        return order;
    }
    let centroid = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
        (a + b + c) / 3.0
    };
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for triangle in &mesh.triangles {
        let point = centroid(triangle);
        (low, high) = (low.min(point), high.max(point));
    }
    // The same scale on all axes, or clusters of a flat mesh would be long and thin.
    let scale = 1023.0 / (high - low).max_element().max(f32::MIN_POSITIVE);
    let keys: Vec<u32> = mesh.triangles.iter().map(|t| morton_code((centroid(t) - low) * scale)).collect();
    order.sort_by_key(|&index| keys[index as usize]);
    order
}

/// Interleaves the low ten bits of the coordinates. Sorted by this number, cells follow a Z-shaped curve through space.
fn morton_code(cell: Vec3) -> u32 {
    let spread = |value: f32| {
        let mut bits = (value as u32).min(1023);
        bits = (bits | bits << 16) & 0x0300_00ff;
        bits = (bits | bits << 8) & 0x0300_f00f;
        bits = (bits | bits << 4) & 0x030c_30c3;
        (bits | bits << 2) & 0x0924_9249
    };
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_contain_every_triangle_once() {
        let positions: Vec<Vec3> = (0..1000).map(|i| Vec3::new((i * 37 % 100) as f32, i as f32, 1.0)).collect();
        let triangles: Vec<[u32; 3]> = (0..900).map(|i| [i, i + 1, (i * 7) % 1000]).collect();
        let mesh = Mesh { positions, triangles, ..Mesh::default() };
        let mut soup = TriangleSoup::default();
        soup.add_mesh(&Mesh { triangles: vec![[0, 1, 2]], ..mesh.clone() }, 0);
        soup.add_mesh(&mesh, 1);
        assert_eq!(soup.clusters.len(), 1 + 900usize.div_ceil(MAX_CLUSTER_TRIANGLES));
        let mut sources: Vec<u32> = soup.triangles.iter().map(|t| t.source).collect();
        sources.sort_unstable();
        assert_eq!(sources, (0..901).collect::<Vec<u32>>());
        for cluster in &soup.clusters {
            let first = cluster.first_triangle as usize;
            for triangle in &soup.triangles[first..first + cluster.triangles as usize] {
                for corner in triangle.corners {
                    assert!((cluster.first_vertex..cluster.first_vertex + cluster.vertices).contains(&corner));
                    let offset = soup.positions[corner as usize] - cluster.centre;
                    assert!((offset.abs() - cluster.half_extent).max_element() < 1e-3);
                }
            }
        }
        let again = soup.triangles.iter().find(|t| t.source == 1 + 500).unwrap();
        let want = mesh.triangles[500].map(|v| mesh.positions[v as usize]);
        assert_eq!(again.corners.map(|v| soup.positions[v as usize]), want);
    }

    #[test]
    fn morton_interleaves() {
        assert_eq!(morton_code(Vec3::new(1.0, 0.0, 0.0)), 1);
        assert_eq!(morton_code(Vec3::new(0.0, 3.0, 0.0)), 0b010_010);
        assert_eq!(morton_code(Vec3::splat(1023.0)), (1 << 30) - 1);
    }
}
