//! Cuts triangles at planes, one plane after another (Sutherland and Hodgman's algorithm).

use crate::view::ClipPlane;
use glam::Vec3;

/// A corner of a cut triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClipVertex {
    /// View coordinates.
    pub(crate) point: Vec3,
    /// Weights of the three corners of the triangle it was cut from.
    pub(crate) weights: Vec3,
}

/// The part of a triangle that lies inside all `planes`: a convex polygon with the triangle's winding, or empty.
///
/// Two triangles that share an edge get the same points on it, because a cut is always computed from the end inside the
/// plane to the end outside.
pub(crate) fn clip_triangle(triangle: [Vec3; 3], planes: &[ClipPlane]) -> Vec<ClipVertex> {
    let [a, b, c] = triangle;
    let mut polygon = vec![
        ClipVertex { point: a, weights: Vec3::X },
        ClipVertex { point: b, weights: Vec3::Y },
        ClipVertex { point: c, weights: Vec3::Z },
    ];
    let mut kept = Vec::with_capacity(8);
    for plane in planes {
        kept.clear();
        for (i, &vertex) in polygon.iter().enumerate() {
            let next = polygon[(i + 1) % polygon.len()];
            let (here, there) = (plane.signed_distance(vertex.point), plane.signed_distance(next.point));
            if here >= 0.0 {
                kept.push(vertex);
                if there < 0.0 {
                    kept.push(cut_edge(vertex, next, here / (here - there)));
                }
            } else if there >= 0.0 {
                kept.push(cut_edge(next, vertex, there / (there - here)));
            }
        }
        std::mem::swap(&mut polygon, &mut kept);
        if polygon.len() < 3 {
            return Vec::new();
        }
    }
    polygon
}

fn cut_edge(kept: ClipVertex, dropped: ClipVertex, share: f32) -> ClipVertex {
    ClipVertex {
        point: kept.point + (dropped.point - kept.point) * share,
        weights: kept.weights + (dropped.weights - kept.weights) * share,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NEAR: ClipPlane = ClipPlane { normal: Vec3::Z, offset: -1.0 };

    #[test]
    fn one_corner_behind_leaves_four() {
        let triangle = [Vec3::new(0.0, 0.0, 3.0), Vec3::new(1.0, 0.0, 3.0), Vec3::new(0.0, 0.0, -1.0)];
        let polygon = clip_triangle(triangle, &[NEAR]);
        assert_eq!(polygon.len(), 4);
        assert!(polygon.iter().all(|v| v.point.z >= 1.0 - 1e-6));
        assert!(clip_triangle(triangle.map(|p| p - Vec3::Z * 3.0), &[NEAR]).is_empty());
        assert_eq!(clip_triangle(triangle.map(|p| p + Vec3::Z * 3.0), &[NEAR]).len(), 3);
    }

    fn point() -> impl Strategy<Value = Vec3> {
        [-5.0..5.0f32, -5.0..5.0f32, -5.0..5.0f32].prop_map(Vec3::from)
    }

    proptest! {
        #[test]
        fn weights_give_back_the_points(a in point(), b in point(), c in point()) {
            for vertex in clip_triangle([a, b, c], &[NEAR, ClipPlane { normal: Vec3::X, offset: 2.0 }]) {
                let again = a * vertex.weights.x + b * vertex.weights.y + c * vertex.weights.z;
                prop_assert!((again - vertex.point).length() < 1e-4);
                prop_assert!(vertex.point.z > 1.0 - 1e-4 && vertex.point.x > -2.0 - 1e-4);
            }
        }

        #[test]
        fn neighbours_cut_their_edge_at_the_same_point(a in point(), b in point(), c in point(), d in point()) {
            let cuts = |polygon: Vec<ClipVertex>, unused: fn(Vec3) -> f32| -> Vec<Vec3> {
                let on_edge = |v: &&ClipVertex| unused(v.weights) == 0.0 && v.weights.max_element() < 1.0;
                let mut points: Vec<Vec3> = polygon.iter().filter(on_edge).map(|v| v.point).collect();
                points.sort_by(|p, q| p.x.total_cmp(&q.x));
                points
            };
            // The edge from a to b is run through in opposite directions.
            let one = cuts(clip_triangle([a, b, c], &[NEAR]), |w| w.z);
            let other = cuts(clip_triangle([b, a, d], &[NEAR]), |w| w.z);
            prop_assert_eq!(one, other);
        }
    }
}
