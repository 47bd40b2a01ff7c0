use super::*;
use crate::made_buildings::{make_building, make_corridor};
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// Two loops that share a way, without any two ways of the same length.
fn loops() -> KnownBuilding {
    let places = [
        (0.0, 0.0, 0.0, ""),
        (0.1, 2.0, 0.0, ""),
        (2.3, 2.1, 0.0, ""),
        (2.6, -0.2, 0.0, ""),
        (4.9, 2.4, 0.0, ""),
        (5.3, 0.1, 0.0, ""),
        (2.2, 4.7, 0.0, ""),
    ];
    make_building(&places, &[(0, 1), (1, 2), (2, 3), (3, 0), (2, 4), (4, 5), (5, 3), (2, 6), (1, 6)])
}

/// All walks from a start that pass no viewpoint twice, up to a number of hops.
fn simple_walks(building: &KnownBuilding, walk: &[usize], most_hops: usize) -> Vec<Vec<usize>> {
    let mut walks = vec![walk.to_vec()];
    if walk.len() <= most_hops {
        for to in &building.viewpoints[*walk.last().unwrap()].neighbours {
            if !walk.contains(to) {
                walks.extend(simple_walks(building, &[walk, &[*to]].concat(), most_hops));
            }
        }
    }
    walks
}

fn length_m(building: &KnownBuilding, walk: &[usize]) -> f64 {
    walk.windows(2).map(|pair| building.distance_m(pair[0], pair[1])).sum()
}

/// The shortest walk to each viewpoint, from all walks.
fn shortest_walks(building: &KnownBuilding, start: usize) -> BTreeSet<Vec<usize>> {
    let walks = simple_walks(building, &[start], building.len());
    let to = |end: usize| walks.iter().filter(move |walk| walk.last() == Some(&end));
    let shortest =
        |end| to(end).min_by(|a, b| length_m(building, a).total_cmp(&length_m(building, b))).unwrap().clone();
    (0..building.len()).map(shortest).collect()
}

fn walks_of(tree: &WalkTree) -> Vec<Vec<usize>> {
    (0..tree.len()).map(|walk| tree.viewpoints(walk)).collect()
}

#[test]
fn note_ways_finds_ways_straight_on_and_to_the_sides() {
    let ways = |turns: &[f64]| {
        let mut ways = NodeWays::default();
        ways.note_ways(turns);
        (ways.onward, ways.aside)
    };
    assert_eq!(ways(&[]), (false, [false; 2]));
    assert_eq!(ways(&[0.5]), (true, [false; 2]));
    assert_eq!(ways(&[-0.5]), (true, [false; 2]));
    assert_eq!(ways(&[0.7, -0.7]), (false, [false; 2]));
    assert_eq!(ways(&[-0.9, 3.0]), (false, [true, false]));
    assert_eq!(ways(&[2.3, -2.5]), (false, [false, true]));
}

#[test]
fn compare_turn_counts_straighter_and_squarer_ways() {
    let compare = |taken: f64, turns: &[f64]| {
        let mut ways = NodeWays::default();
        ways.compare_turn(turns, taken);
        (ways.straighter, ways.squarer)
    };
    let turns = [0.0, 1.0, -1.0, 1.5, 3.0];
    assert_eq!(compare(1.0, &turns), (1, 1));
    assert_eq!(compare(-1.0, &turns), (1, 0));
    assert_eq!(compare(1.5, &turns), (3, 0));
    assert_eq!(compare(3.0, &turns), (4, 2));
    assert_eq!(compare(0.0, &turns), (0, 0));
    // A difference of less than 0.2 is none.
    assert_eq!(compare(1.0, &[0.9, 1.1]), (0, 0));
    assert_eq!(compare(1.0, &[0.7, 1.3]), (1, 1));
    assert_eq!(compare(-1.0, &[-0.7, -1.3]), (1, 1));
}

#[test]
fn single_walk_has_the_turns_and_lengths_of_its_hops() {
    let places =
        [(0.0, 0.0, 0.0, ""), (0.0, 2.0, 0.0, ""), (3.0, 2.0, 4.0, ""), (3.0, 2.0, 6.0, ""), (3.0, 0.0, 6.0, "")];
    let building = make_building(&places, &[(0, 1), (1, 2), (2, 3), (3, 4)]);
    let tree = WalkTree::single_walk(&building, &[0, 1, 2, 3, 4], 0.5);
    let turns: Vec<f64> = tree.nodes.iter().map(|node| node.turn_rad).collect();
    let expected = [0.0, -0.5, FRAC_PI_2, 0.0, FRAC_PI_2];
    assert!(turns.iter().zip(expected).all(|(turn, expected)| near(*turn, expected)), "{turns:?}");
    let headings = [0.5, 0.0, FRAC_PI_2, FRAC_PI_2, std::f64::consts::PI];
    assert!(tree.nodes.iter().zip(headings).all(|(node, heading)| near(node.heading_rad, heading)));
    assert!(tree.nodes.iter().zip([0.0, 2.0, 5.0, 2.0, 2.0]).all(|(node, length)| near(node.length_m, length)));
    assert_eq!(
        tree.nodes.iter().map(|node| (node.hops, node.before)).collect::<Vec<_>>(),
        [(0, 0), (1, 0), (2, 1), (3, 2), (4, 3)]
    );
    assert_eq!(tree.viewpoints(4), [0, 1, 2, 3, 4]);
    assert_eq!(tree.nodes_back(3).collect::<Vec<_>>(), [3, 2, 1, 0]);
}

#[test]
fn single_walk_notes_the_ways_that_it_does_not_take() {
    // A crossing at 1: the walk turns right there, past a way straight on and one to the left.
    let places =
        [(0.0, 0.0, 0.0, ""), (0.0, 2.0, 0.0, ""), (2.0, 2.0, 0.0, ""), (0.0, 4.0, 0.0, ""), (-2.0, 2.0, 0.0, "")];
    let building = make_building(&places, &[(0, 1), (1, 2), (1, 3), (1, 4)]);
    let tree = WalkTree::single_walk(&building, &[0, 1, 2], 0.0);
    let ways: Vec<_> = tree.nodes.iter().map(|node| node.ways).collect();
    assert_eq!((ways[0].onward, ways[0].aside), (true, [false; 2]));
    assert_eq!((ways[1].onward, ways[1].aside, ways[1].straighter), (true, [true; 2], 0));
    assert_eq!((ways[2].onward, ways[2].aside, ways[2].straighter, ways[2].squarer), (false, [false; 2], 1, 0));
}

#[test]
fn single_walk_of_nothing_is_empty() {
    let tree = WalkTree::single_walk(&KnownBuilding::default(), &[], 0.0);
    assert_eq!((tree.len(), tree.is_empty(), tree.end_viewpoint(0)), (1, true, 0));
    let building = make_corridor(&["", "", ""]);
    assert!(WalkTree::single_walk(&building, &[1], 0.0).is_empty());
    assert!(!WalkTree::single_walk(&building, &[1, 2], 0.0).is_empty());
}

#[test]
fn shortest_paths_are_the_shortest_of_all_walks() {
    let building = loops();
    for start in 0..building.len() {
        let tree = WalkTree::from_prior(&building, start, 0.0, WalkPrior::Shortest(9));
        let walks = walks_of(&tree);
        assert_eq!(walks[0], [start]);
        assert_eq!(walks.len(), building.len());
        assert_eq!(walks.into_iter().collect::<BTreeSet<_>>(), shortest_walks(&building, start));
        // Nearer ends come first.
        let far: Vec<f64> = (0..tree.len()).map(|walk| length_m(&building, &tree.viewpoints(walk))).collect();
        assert!(far.windows(2).all(|pair| pair[0] <= pair[1]), "{far:?}");
    }
}

#[test]
fn shortest_paths_end_after_the_most_hops_and_leave_out_what_no_way_leads_to() {
    let mut building = make_corridor(&["", "", "", "", ""]);
    building.viewpoints.push(building.viewpoints[0].clone());
    building.viewpoints[5].neighbours.clear();
    let tree = |hops| WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(hops));
    assert_eq!([tree(0).len(), tree(1).len(), tree(3).len(), tree(9).len()], [1, 2, 4, 5]);
    assert_eq!(WalkPrior::default(), WalkPrior::Shortest(8));
}

#[test]
fn two_pieces_are_all_pairs_of_shortest_paths_without_a_return() {
    let building = loops();
    for (start, most_hops) in [(0, 9), (5, 9), (6, 9)] {
        let mut expected = shortest_walks(&building, start);
        for first in expected.clone() {
            for second in shortest_walks(&building, *first.last().unwrap()) {
                let whole = [&first[..], &second[1..]].concat();
                if whole.iter().collect::<BTreeSet<_>>().len() == whole.len() {
                    expected.insert(whole);
                }
            }
        }
        let tree = WalkTree::from_prior(&building, start, 0.3, WalkPrior::TwoPieces(most_hops));
        let walks = walks_of(&tree);
        assert!(expected.len() > building.len(), "the building has other walks than the shortest");
        assert_eq!(walks.iter().cloned().collect::<BTreeSet<_>>(), expected);
        assert_eq!(walks.len(), expected.len(), "no walk comes twice");
    }
    let tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::TwoPieces(2));
    assert!(walks_of(&tree).iter().all(|walk| walk.len() <= 3));
    assert!(walks_of(&tree).contains(&vec![0, 1, 6]) && walks_of(&tree).contains(&vec![0, 3, 2]));
}

#[test]
fn add_walk_reuses_the_walks_that_are_there() {
    let building = loops();
    let mut tree = WalkTree::from_prior(&building, 0, 0.0, WalkPrior::Shortest(9));
    let known = tree.find_walk(&[0, 3, 5]).unwrap();
    assert_eq!(tree.add_walk(&building, &[0, 3, 5]), known);
    assert_eq!((tree.len(), tree.add_walk(&building, &[0])), (7, 0));
    let added = tree.add_walk(&building, &[0, 3, 5, 3, 0]);
    assert_eq!((tree.len(), tree.viewpoints(added)), (9, vec![0, 3, 5, 3, 0]));
    assert_eq!(tree.find_walk(&[0, 3, 5, 3, 0]), Some(added));
    assert_eq!(tree.find_walk(&[0, 3, 5, 3]), Some(added - 1));
}

#[test]
fn find_walk_needs_every_viewpoint() {
    let building = make_corridor(&["", "", "", ""]);
    let tree = WalkTree::single_walk(&building, &[0, 1, 2, 3], 0.0);
    assert_eq!(tree.find_walk(&[0, 1, 2]), Some(2));
    assert_eq!(tree.find_walk(&[0]), Some(0));
    assert_eq!([&[][..], &[1, 2], &[0, 2], &[0, 3, 2], &[0, 1, 2, 3, 2]].map(|walk| tree.find_walk(walk)), [None; 5]);
}

#[test]
fn turns_rad_are_from_hop_to_hop_and_the_first_from_the_walker_s_direction() {
    let places =
        [(0.0, 0.0, 0.0, ""), (0.0, 2.0, 0.0, ""), (2.0, 2.0, 0.0, ""), (2.0, 2.0, 3.0, ""), (2.0, 0.0, 3.0, "")];
    let building = make_building(&places, &[(0, 1), (1, 2), (2, 3), (3, 4)]);
    let are_turns = |walk: &[usize], heading_rad: f64, expected: &[f64]| {
        let tree = WalkTree::single_walk(&building, walk, heading_rad);
        let turns = tree.turns_rad(tree.len() - 1);
        assert_eq!(turns.len(), expected.len());
        assert!(turns.iter().zip(expected).all(|(a, b)| near(*a, *b)), "{turns:?}");
    };
    // Straight up, the walker keeps its direction.
    are_turns(&[0, 1, 2, 3, 4], 0.5, &[-0.5, FRAC_PI_2, 0.0, FRAC_PI_2]);
    // To the west and then to the south, the shorter way round.
    are_turns(&[2, 1, 0], 2.5, &[1.5 * PI - 2.5, -FRAC_PI_2]);
    are_turns(&[2], 2.5, &[]);
}
