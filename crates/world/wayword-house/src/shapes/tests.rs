use super::{super::dice::HouseDice, *};
use glam::Vec3;

fn look(kind: FurnitureKind) -> FurnitureLook {
    let mut dice = HouseDice::new(3, &["shapes"]);
    let [w, d, h] = kind.size_cm(&mut dice).map(|side| side as f32 / 100.0);
    FurnitureLook { w, d, h, colour: kind.draw_colour(&mut dice), variant: 5 }
}

#[test]
fn shapes_fill_their_size_and_do_not_leave_it() {
    for kind in FurnitureKind::ALL {
        let look = look(*kind);
        let points: Vec<Vec3> =
            build_shape(*kind, &look).parts.iter().flat_map(|part| part.positions.clone()).collect();
        let low = points.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = points.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        let bound = Vec3::new(look.w / 2.0, look.d / 2.0, look.h);
        // Handles may stick out by 12 cm, and taps may stand 20 cm above basins.
        let tap = Vec3::Z * 0.2;
        assert!(
            high.cmple(bound + 0.12 + tap).all() && low.cmpge(Vec3::new(-bound.x, -bound.y, 0.0) - 0.12).all(),
            "{kind:?} {low} {high}"
        );
        assert!((high.z - low.z) > 0.6 * look.h, "{kind:?} is {} m high", high.z - low.z);
        assert!((high.x - low.x) > 0.6 * look.w, "{kind:?} is {} m wide", high.x - low.x);
    }
}

#[test]
fn shapes_are_whole_and_modest() {
    for kind in FurnitureKind::ALL {
        let shape = build_shape(*kind, &look(*kind));
        let triangles: usize = shape.parts.iter().map(|part| part.triangles.len()).sum();
        assert!((2..4000).contains(&triangles), "{kind:?} has {triangles} triangles");
        for part in &shape.parts {
            assert_eq!(part.positions.len(), part.normals.len());
            assert_eq!(part.positions.len(), part.uvs.len());
            assert!(part.triangles.iter().flatten().all(|index| (*index as usize) < part.positions.len()));
            assert!(part.positions.iter().all(|position| position.is_finite()));
        }
    }
}
