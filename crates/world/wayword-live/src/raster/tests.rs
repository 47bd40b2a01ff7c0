use super::*;
use proptest::prelude::*;

/// A raster from rows of text, the northernmost first; a dot is a free cell. Cells are half a metre wide.
fn drawn(rows: &[&str]) -> FloorRaster {
    let cells = rows.iter().rev().enumerate().flat_map(|(y, row)| {
        row.chars().enumerate().map(move |(x, cell)| ([x as f64 * 0.5, y as f64 * 0.5], cell == '.'))
    });
    FloorRaster::from_cells(&cells.collect::<Vec<_>>(), 0.5).unwrap()
}

fn two_rooms() -> FloorRaster {
    drawn(&["....#.....", "....#.....", "..........", "....#.....", "....#.....", "....#...#.", "....#...##"])
}

#[test]
fn shortest_leads_through_the_door_and_no_wall() {
    let raster = two_rooms();
    let way = raster.shortest_way([0.0, 0.0], [3.5, 0.0]).unwrap();
    assert_eq!((way[0], way[way.len() - 1]), ([0.0, 0.0], [3.5, 0.0]));
    assert!(way.iter().any(|corner| (corner[1] - 2.0).abs() < 0.3), "{way:?} misses the door");
    assert!(way.windows(2).all(|leg| raster.can_walk_straight(leg[0], leg[1])));
    assert!(!raster.can_walk_straight([0.0, 0.0], [3.5, 0.0]));
    assert_eq!(raster.shortest_way([0.0, 0.0], [2.0, 0.0]), None, "a goal inside a wall has no way");
}

#[test]
fn shortest_does_not_pass_between_touching_corners() {
    assert_eq!(drawn(&[".#", "#."]).shortest_way([0.0, 0.5], [0.5, 0.0]), None);
    assert!(drawn(&[".#", ".."]).shortest_way([0.0, 0.5], [0.5, 0.0]).is_some());
}

#[test]
fn keep_largest_part_removes_pockets() {
    let mut raster = drawn(&["...#.", "...##", "...#."]);
    assert!(raster.is_free([2.0, 0.0]));
    raster.keep_largest_part();
    assert!(!raster.is_free([2.0, 0.0]) && raster.is_free([0.0, 0.0]));
}

#[test]
fn the_graph_is_one_even_where_a_door_is_narrow() {
    let mut raster = two_rooms();
    raster.keep_largest_part();
    let eyes: Vec<DVec3> = raster.viewpoint_places().into_iter().map(|[x, y]| DVec3::new(x, y, 1.5)).collect();
    let graph = raster.viewpoint_graph(&eyes).unwrap();
    assert!(graph.len() >= 4);
    assert_eq!(graph.count_components(), 1);
}

#[test]
fn from_cells_refuses_huge_empty_and_invalid_floors() {
    let far = [([0.0, 0.0], true), ([1e9, 1e9], true)];
    assert_eq!(FloorRaster::from_cells(&far, 0.25), None);
    assert_eq!(FloorRaster::from_cells(&[([f64::NAN, 0.0], true)], 0.25), None);
    assert_eq!(FloorRaster::from_cells(&[], 0.25), None);
}

proptest! {
    #[test]
    fn shortest_ways_are_free_and_at_least_straight_line_long(
        cells in prop::collection::vec(prop::bool::weighted(0.7), 144),
        from in 0..144_usize, to in 0..144_usize,
    ) {
        let middle = |n: usize| [(n % 12) as f64 * 0.25, (n / 12) as f64 * 0.25];
        let listed: Vec<_> = cells.iter().enumerate().map(|(n, free)| (middle(n), *free)).collect();
        let raster = FloorRaster::from_cells(&listed, 0.25).unwrap();
        let found = raster.shortest_way(middle(from), middle(to));
        prop_assert_eq!(found.is_some(), raster.shortest_way(middle(to), middle(from)).is_some());
        if let Some(way) = found {
            let length: f64 = way.windows(2).map(|leg| floor_distance(leg[0], leg[1])).sum();
            prop_assert!(length >= floor_distance(middle(from), middle(to)) - 1e-9);
            prop_assert!(way.iter().all(|corner| raster.is_free(*corner)));
        }
        let mut largest = raster;
        largest.keep_largest_part();
        let places = largest.viewpoint_places();
        let eyes: Vec<DVec3> = places.iter().map(|[x, y]| DVec3::new(*x, *y, 1.5)).collect();
        prop_assert!(eyes.len() < 2 || largest.viewpoint_graph(&eyes).unwrap().count_components() == 1);
    }
}
