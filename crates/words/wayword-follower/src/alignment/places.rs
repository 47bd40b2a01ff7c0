//! The places of a walk between which the alignment cuts: the viewpoints of a graph, or a choice among frames that lie closer.

use crate::building::{KnownBuilding, wrap_angle};

/// Walks with hops of at least this mean length are cut at every viewpoint, metres. People's viewpoints lie about 2.2 m apart.
const MIN_MEAN_HOP_M: f64 = 1.3;
/// A frame of a dense walk is a place if the walk turns there by at least this angle, radians (30 degrees).
const MIN_TURN_RAD: f64 = 0.52;
/// It is one as well this far from the place before it, metres.
const SPACING_M: f64 = 2.2;
/// Turns nearer than this to the place before them belong to it, metres.
const MIN_SPACING_M: f64 = 0.4;

/// The indices into a walk of the places where it may be cut, with its first and its last.
pub(crate) fn walk_places(building: &KnownBuilding, walk: &[usize]) -> Vec<usize> {
    let hops: Vec<f64> = walk.windows(2).map(|hop| building.distance_m(hop[0], hop[1])).collect();
    let length_m: f64 = hops.iter().sum();
    if walk.len() < 3 || length_m >= MIN_MEAN_HOP_M * hops.len() as f64 {
        return (0..walk.len()).collect();
    }
    let bearing = |hop: usize| building.hop_between(walk[hop], walk[hop + 1]).0;
    let turns = |at: usize| match (bearing(at - 1), bearing(at)) {
        (Some(before), Some(after)) => wrap_angle(after - before).abs() >= MIN_TURN_RAD,
        _ => false,
    };
    let mut places = vec![0];
    let mut since_m = 0.0;
    for at in 1..walk.len() - 1 {
        since_m += hops[at - 1];
        let is_far = since_m + hops[at] / 2.0 >= SPACING_M;
        if is_far || (turns(at) && since_m >= MIN_SPACING_M) {
            places.push(at);
            since_m = 0.0;
        }
    }
    places.push(walk.len() - 1);
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        alignment::tests::{building_along, corner, dense_corner},
        made_buildings::make_corridor,
    };

    /// The places of the walk through all viewpoints of a building.
    fn all_places(building: &KnownBuilding) -> Vec<usize> {
        walk_places(building, &(0..building.len()).collect::<Vec<_>>())
    }

    #[test]
    fn a_walk_along_viewpoints_is_cut_at_each_of_them() {
        assert_eq!(all_places(&corner()), [0, 1, 2, 3, 4, 5]);
        assert_eq!(all_places(&make_corridor(&["hallway"; 9])), [0, 1, 2, 3, 4, 5, 6, 7, 8]);
        // Single short hops do not make a walk dense.
        assert_eq!(all_places(&building_along(&[[0.0, 0.0], [0.0, 0.3], [0.0, 3.0], [0.0, 6.0]])), [0, 1, 2, 3]);
    }

    #[test]
    fn a_dense_walk_is_cut_at_its_ends_its_corners_and_on_the_way() {
        assert_eq!(all_places(&dense_corner()), [0, 4, 6, 10, 14, 17]);
        let straight: Vec<[f64; 2]> = (0..=24).map(|at| [0.5 * f64::from(at), 0.0]).collect();
        assert_eq!(all_places(&building_along(&straight)), [0, 4, 8, 12, 16, 20, 24]);
    }

    #[test]
    fn a_short_walk_keeps_all_its_places() {
        assert_eq!(all_places(&building_along(&[[0.0, 0.0], [0.0, 0.2]])), [0, 1]);
        assert_eq!(walk_places(&dense_corner(), &[5]), [0]);
        assert_eq!(walk_places(&dense_corner(), &[3, 4, 5]), [0, 2], "places are counted along the walk");
    }

    #[test]
    fn a_bend_counts_from_thirty_degrees_on() {
        let bent_by = |deg: f64| {
            let rad = deg.to_radians();
            let behind = [0.5 * libm::sin(rad), 1.0 + 0.5 * libm::cos(rad)];
            all_places(&building_along(&[[0.0, 0.0], [0.0, 0.5], [0.0, 1.0], behind]))
        };
        assert_eq!([bent_by(20.0), bent_by(-20.0)], [[0, 3]; 2]);
        assert_eq!([bent_by(40.0), bent_by(-40.0)], [[0, 2, 3]; 2]);
    }

    #[test]
    fn a_turn_right_behind_a_corner_belongs_to_it() {
        let zigzag = [[0.0, 0.0], [0.0, 0.5], [0.0, 1.0], [0.25, 1.0], [0.25, 1.5], [0.25, 2.0]];
        assert_eq!(all_places(&building_along(&zigzag)), [0, 2, 5]);
        // Half a metre behind it, a turn is a place of its own.
        let wider = zigzag.map(|[east, north]| [2.0 * east, north]);
        assert_eq!(all_places(&building_along(&wider)), [0, 2, 3, 5]);
    }

    #[test]
    fn a_frame_counts_from_the_limits_of_its_distance_on() {
        let far = |next_m: f64| {
            let north = [-1.1, 0.0, next_m, next_m + 0.1, next_m + 0.2, next_m + 0.3];
            all_places(&building_along(&north.map(|north| [0.0, north])))
        };
        assert_eq!(far(2.2), [0, 1, 2, 5], "the middle of the second hop is 2.2 m away");
        assert_eq!(far(2.1), [0, 2, 5]);
        let turned = |first_m: f64| all_places(&building_along(&[[0.0, 0.0], [0.0, first_m], [0.4, first_m]]));
        assert_eq!(turned(0.4), [0, 1, 2]);
        assert_eq!(turned(0.39), [0, 2]);
    }
}
