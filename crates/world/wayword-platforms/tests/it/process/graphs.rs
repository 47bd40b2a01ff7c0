//! Graphs of world programs that offer no graph.

use super::{actor, scene, started};
use wayword_core::{PathRequest, Platform};

#[test]
fn neighbours_make_the_graph_that_the_world_has() {
    let platform = started("neighbours").unwrap();
    let graph = platform.graph_for_scene(&scene("good")).unwrap();
    let names: Vec<&str> = graph.viewpoints().map(|id| id.as_str()).collect();
    assert_eq!(names, actor::PLACES.map(|(id, _)| id));
    let mut edges: Vec<String> = graph.edges().map(|(a, b, _)| format!("{a}{b}")).collect();
    edges.sort();
    assert_eq!(edges, ["ab", "bc", "cd"]);
}

#[test]
fn places_and_ways_make_a_graph_that_keeps_to_the_door() {
    let platform = started("walkable").unwrap();
    let graph = platform.graph_for_scene(&scene("good")).unwrap();
    assert_eq!((graph.len(), graph.count_components()), (50, 1));
    for (a, b, length_m) in graph.edges() {
        let (from, to) = (graph.position_of(a).unwrap(), graph.position_of(b).unwrap());
        assert!((from.x < 4.5) == (to.x < 4.5) || (from.y == 2.0 && to.y == 2.0), "{a} to {b} leads through the wall");
        assert!(length_m <= 3.0);
    }
    let request = PathRequest { hops: 3..=7, length_m: 5.0..=10.0 };
    let path = platform.sample_path(&scene("good"), &request, 1).unwrap();
    assert!(request.allows_length_of(&path));
    assert_eq!(path.target.unwrap().name, "lamp");
}
