//! Checks whether a viewpoint graph lies in its scene: eyes are over a floor, and edges do not cross walls. If a graph
//! fits in other axes (z and y swapped, mirrored, in centimetres), the error names the mistake and how to correct it.

use crate::triangle_columns::TriangleColumns;
use wayword_core::{DVec3, GraphFit};
use wayword_world::connectivity::{ConnectivityGraph, PanoramaViewpoint};

/// Distance from an eye down to its floor, metres: from a robot's camera to one on a tall stand.
const FLOOR_M: std::ops::RangeInclusive<f64> = 0.3..=2.5;
/// Least share of viewpoints over a floor: scans have holes.
const MIN_OVER_FLOOR_SHARE: f64 = 0.9;
/// Greatest share of edges that cross a wall: a door may have been closed when the building was scanned.
const MAX_THROUGH_WALLS_SHARE: f64 = 0.02;
/// An edge is tested at the height of the eyes and this far below; only a wall blocks both, a lamp or a table does not. Metres.
const LOWER_M: f64 = 0.4;
/// Greatest distance from the floor of viewpoints that should lie on it, metres: a navmesh is a little above or below.
const ON_FLOOR_M: f64 = 0.3;
/// Most edges that are examined, spread over the graph; the others count neither as open nor as blocked.
const MAX_EXAMINED_EDGES: usize = 20_000;
/// Most tests of a triangle for one graph: about a second.
const TRIANGLE_BUDGET: u64 = 200_000_000;

const OWN_GRAPH_HINT: &str =
    "give this scene's own graph, with poses in metres and in the frame of the scan, z up, as in Matterport3D";

/// A mistake with which viewpoints may be written: axes, a unit or a height.
struct MistakenAxes {
    /// The mistake, as the end of a sentence about the viewpoints.
    mistake: &'static str,
    hint: &'static str,
    /// The true place of a viewpoint, or of its floor if it lies on the floor.
    place: fn(DVec3) -> DVec3,
    lies_on_floor: bool,
}

/// The right axes: those of the scan.
const SCAN_AXES: MistakenAxes = MistakenAxes { mistake: "fit", hint: "", place: |at| at, lies_on_floor: false };

/// The known mistakes, the most usual first.
const MISTAKEN_AXES: [MistakenAxes; 11] = [
    MistakenAxes {
        mistake: "have y up, as in Habitat",
        hint: "write each pose again, z up: pose[7] becomes -pose[11], and pose[11] becomes the old pose[7]",
        place: |at| DVec3::new(at.x, -at.z, at.y),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "have y up, as in Habitat, and lie on the floor",
        hint: "write each pose again, z up: pose[7] becomes -pose[11], and pose[11] becomes the old pose[7] + height",
        place: |at| DVec3::new(at.x, -at.z, at.y),
        lies_on_floor: true,
    },
    MistakenAxes {
        mistake: "lie on the floor, not at the eye's height",
        hint: "write each pose again: pose[11] becomes pose[11] + height",
        place: |at| at,
        lies_on_floor: true,
    },
    MistakenAxes {
        mistake: "have y and z swapped",
        hint: "write each pose again: swap pose[7] and pose[11]",
        place: |at| DVec3::new(at.x, at.z, at.y),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "have x and y swapped",
        hint: "write each pose again: swap pose[3] and pose[7]",
        place: |at| DVec3::new(at.y, at.x, at.z),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "are mirrored along x",
        hint: "write each pose again: pose[3] becomes -pose[3]",
        place: |at| DVec3::new(-at.x, at.y, at.z),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "are mirrored along y",
        hint: "write each pose again: pose[7] becomes -pose[7]",
        place: |at| DVec3::new(at.x, -at.y, at.z),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "are turned by half a turn",
        hint: "write each pose again: pose[3] becomes -pose[3], and pose[7] becomes -pose[7]",
        place: |at| DVec3::new(-at.x, -at.y, at.z),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "are turned by a quarter to the right",
        hint: "write each pose again: pose[3] becomes -pose[7], and pose[7] becomes the old pose[3]",
        place: |at| DVec3::new(-at.y, at.x, at.z),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "are turned by a quarter to the left",
        hint: "write each pose again: pose[3] becomes pose[7], and pose[7] becomes the old -pose[3]",
        place: |at| DVec3::new(at.y, -at.x, at.z),
        lies_on_floor: false,
    },
    MistakenAxes {
        mistake: "are in centimetres",
        hint: "write each pose again, in metres: divide pose[3], pose[7] and pose[11] by 100",
        place: |at| at / 100.0,
        lies_on_floor: false,
    },
];

/// A graph that does not lie in its scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GraphMisfit {
    pub(super) fit: GraphFit,
    /// The fault of the graph, as a sentence.
    pub(super) reason: String,
    pub(super) hint: &'static str,
}

/// Judges how a graph lies in its scene. `columns` must include the scene's walls.
pub(super) fn judge_fit(columns: &TriangleColumns, graph: &ConnectivityGraph) -> Result<GraphFit, GraphMisfit> {
    let fit = fit_in_axes(columns, graph, &SCAN_AXES);
    if is_plausible(&fit) {
        return Ok(fit);
    }
    let refused = |mistake: &str, hint| GraphMisfit {
        fit,
        reason: format!("the viewpoints of this graph {mistake}: {fit}"),
        hint,
    };
    if fit.viewpoints == 0 {
        return Err(refused("are none that is included", "give this scene a graph with included viewpoints"));
    }
    let others = MISTAKEN_AXES.iter().map(|frame| (fit_in_axes(columns, graph, frame), frame));
    let fitting = others.filter(|(fit, _)| is_plausible(fit));
    // Of several that fit equally well, the most usual one.
    match fitting.min_by_key(|(fit, _)| (fit.through_walls, fit.viewpoints - fit.over_floor)) {
        Some((_, frame)) => Err(refused(frame.mistake, frame.hint)),
        None => {
            let expected = format!(
                "do not lie in this scene (expected: at least {:.0} % over a floor, and at most {:.0} % of the edges through walls)",
                100.0 * MIN_OVER_FLOOR_SHARE,
                100.0 * MAX_THROUGH_WALLS_SHARE
            );
            Err(refused(&expected, OWN_GRAPH_HINT))
        }
    }
}

fn is_plausible(fit: &GraphFit) -> bool {
    let (viewpoints, edges) = (fit.viewpoints as f64, fit.edges as f64);
    fit.viewpoints > 0
        && fit.over_floor as f64 >= MIN_OVER_FLOOR_SHARE * viewpoints
        && fit.through_walls as f64 <= MAX_THROUGH_WALLS_SHARE * edges
}

/// The figures of a graph if its viewpoints are read in these axes.
fn fit_in_axes(columns: &TriangleColumns, graph: &ConnectivityGraph, frame: &MistakenAxes) -> GraphFit {
    let eye = |at: &PanoramaViewpoint| {
        let place = (frame.place)(at.position);
        if frame.lies_on_floor { place + DVec3::Z * at.height_m } else { place }
    };
    let eyes: Vec<DVec3> = graph.viewpoints.iter().map(eye).collect();
    let is_over_floor = |(eye, at): &(&DVec3, &PanoramaViewpoint)| {
        let is_floor = |drop_m: f64| !frame.lies_on_floor || (drop_m - at.height_m).abs() <= ON_FLOOR_M;
        columns.drop_m(**eye).is_some_and(|drop_m| FLOOR_M.contains(&drop_m) && is_floor(drop_m))
    };
    let mut pairs: Vec<(usize, usize)> = graph.edges.iter().map(|(a, b)| (*a.min(b), *a.max(b))).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let (mut budget, mut fit) =
        (TRIANGLE_BUDGET, GraphFit { viewpoints: eyes.len(), over_floor: 0, edges: 0, through_walls: 0 });
    fit.over_floor = eyes.iter().zip(&graph.viewpoints).filter(is_over_floor).count();
    // The budget may run out early, so the edges are taken in an order that is spread over the graph.
    for (a, b) in spread_pairs(&pairs) {
        if budget == 0 {
            break;
        }
        let (from, to, down) = (eyes[a], eyes[b], DVec3::Z * LOWER_M);
        let open = columns.is_open(from, to, &mut budget) || columns.is_open(from - down, to - down, &mut budget);
        fit.edges += 1;
        fit.through_walls += usize::from(!open);
    }
    fit
}

/// At most [`MAX_EXAMINED_EDGES`] of the pairs, in an order that jumps through all of them.
fn spread_pairs(pairs: &[(usize, usize)]) -> impl Iterator<Item = (usize, usize)> {
    /// Number of rounds; each of them goes through the whole list.
    const SPREAD_ROUNDS: usize = 16;
    let step = pairs.len().div_ceil(MAX_EXAMINED_EDGES).max(1);
    (0..SPREAD_ROUNDS).flat_map(move |round| pairs.iter().copied().skip(round * step).step_by(SPREAD_ROUNDS * step))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use wayword_core::{DMat3, ViewpointId};

    /// A quad as two triangles.
    fn quad(out: &mut Vec<[Vec3; 3]>, [a, b, c, d]: [[f32; 3]; 4]) {
        let [a, b, c, d] = [a, b, c, d].map(Vec3::from);
        out.extend([[a, b, c], [a, c, d]]);
    }

    /// An L of two rooms, away from the origin: one of 8 x 4 m, and north of its west end one of 3 x 6 m; a doorway of
    /// 1 m joins them. Floors, ceilings at 2.6 m, walls.
    fn flat() -> TriangleColumns {
        let mut out = Vec::new();
        for z in [0.0, 2.6] {
            quad(&mut out, [[12.0, 1.0, z], [20.0, 1.0, z], [20.0, 5.0, z], [12.0, 5.0, z]]);
            quad(&mut out, [[12.0, 5.0, z], [15.0, 5.0, z], [15.0, 11.0, z], [12.0, 11.0, z]]);
        }
        let walls = [
            ([12.0, 1.0], [20.0, 1.0]),
            ([20.0, 1.0], [20.0, 5.0]),
            ([20.0, 5.0], [14.0, 5.0]),
            ([13.0, 5.0], [12.0, 5.0]),
            ([12.0, 1.0], [12.0, 11.0]),
            ([12.0, 11.0], [15.0, 11.0]),
            ([15.0, 11.0], [15.0, 5.0]),
        ];
        for ([ax, ay], [bx, by]) in walls {
            quad(&mut out, [[ax, ay, 0.0], [bx, by, 0.0], [bx, by, 2.6], [ax, ay, 2.6]]);
        }
        TriangleColumns::with_walls(out.into_iter())
    }

    /// A row through both rooms, joined through the doorway.
    fn graph() -> ConnectivityGraph {
        let places = [[19.0, 3.0], [17.0, 3.0], [15.0, 3.0], [13.5, 3.5], [13.5, 6.5], [13.5, 8.5], [13.5, 10.0]];
        let viewpoint = |(at, [x, y]): (usize, &[f64; 2])| PanoramaViewpoint {
            id: ViewpointId::new(format!("v{at}")).unwrap(),
            position: DVec3::new(*x, *y, 1.5),
            height_m: 1.5,
            world_from_skybox: DMat3::IDENTITY,
        };
        let edges = (1..places.len()).flat_map(|at| [(at - 1, at), (at, at - 1)]).collect();
        ConnectivityGraph { viewpoints: places.iter().enumerate().map(viewpoint).collect(), edges }
    }

    fn moved(place: impl Fn(DVec3) -> DVec3) -> ConnectivityGraph {
        let mut graph = graph();
        graph.viewpoints.iter_mut().for_each(|viewpoint| viewpoint.position = place(viewpoint.position));
        graph
    }

    #[test]
    fn a_graph_of_its_own_scene_fits() {
        let fit = judge_fit(&flat(), &graph()).unwrap();
        assert_eq!(fit, GraphFit { viewpoints: 7, over_floor: 7, edges: 6, through_walls: 0 });
    }

    #[test]
    fn judge_names_each_wrong_frame_with_a_hint() {
        type Wrong = (&'static str, fn(DVec3) -> DVec3, &'static str);
        let wrongs: [Wrong; 11] = [
            ("have y up, as in Habitat:", |p| DVec3::new(p.x, p.z, -p.y), "pose[7] becomes -pose[11]"),
            ("have y up, as in Habitat, and lie on the floor:", |p| DVec3::new(p.x, 0.02, -p.y), "pose[7] + height"),
            ("lie on the floor, not", |p| DVec3::new(p.x, p.y, 0.02), "pose[11] + height"),
            ("have y and z swapped:", |p| DVec3::new(p.x, p.z, p.y), "swap pose[7] and pose[11]"),
            ("have x and y swapped:", |p| DVec3::new(p.y, p.x, p.z), "swap pose[3] and pose[7]"),
            ("are mirrored along x:", |p| DVec3::new(-p.x, p.y, p.z), "pose[3] becomes -pose[3]"),
            ("are mirrored along y:", |p| DVec3::new(p.x, -p.y, p.z), "pose[7] becomes -pose[7]"),
            ("are turned by half a turn:", |p| DVec3::new(-p.x, -p.y, p.z), "pose[3] becomes -pose[3]"),
            ("are turned by a quarter to the right:", |p| DVec3::new(p.y, -p.x, p.z), "pose[3] becomes -pose[7]"),
            ("are turned by a quarter to the left:", |p| DVec3::new(-p.y, p.x, p.z), "pose[3] becomes pose[7]"),
            ("are in centimetres:", |p| 100.0 * p, "divide"),
        ];
        assert_eq!(MISTAKEN_AXES.len(), wrongs.len());
        for (told, place, hint) in wrongs {
            let misfit = judge_fit(&flat(), &moved(place)).unwrap_err();
            assert!(misfit.reason.contains(&format!("the viewpoints of this graph {told}")), "{told}: {misfit:?}");
            assert!(misfit.hint.contains(hint), "{told}: {misfit:?}");
        }
        let elsewhere = judge_fit(&flat(), &moved(|place| place + DVec3::new(40.0, 3.0, 9.0))).unwrap_err();
        assert!(elsewhere.reason.contains("do not lie in this scene (expected: at least 90 %"), "{elsewhere:?}");
        assert!(elsewhere.reason.ends_with("0 of 7 viewpoints stand over a floor, 0 of 6 edges cross a wall"));
    }

    #[test]
    fn an_edge_through_a_wall_is_counted_and_refused_beyond_two_in_a_hundred() {
        let mut graph = graph();
        // From the large room through its north wall into the other one.
        graph.edges.extend([(2, 5), (5, 2)]);
        let misfit = judge_fit(&flat(), &graph).unwrap_err();
        assert_eq!((misfit.fit.edges, misfit.fit.through_walls), (7, 1));
        assert!(misfit.reason.contains("do not lie in this scene"), "{misfit:?}");
        // One among a hundred edges in the open is tolerated.
        let copies = 20;
        for copy in 1..=copies {
            let offset = graph.viewpoints.len();
            let place = |viewpoint: &PanoramaViewpoint| PanoramaViewpoint {
                id: ViewpointId::new(format!("{}-{copy}", viewpoint.id)).unwrap(),
                ..viewpoint.clone()
            };
            let row: Vec<PanoramaViewpoint> = graph.viewpoints[..7].iter().map(place).collect();
            graph.viewpoints.extend(row);
            graph.edges.extend((1..7).map(|at| (offset + at - 1, offset + at)));
        }
        let fit = judge_fit(&flat(), &graph).unwrap();
        assert_eq!((fit.edges, fit.through_walls), (7 + 6 * copies, 1));
    }

    #[test]
    fn a_lamp_on_an_edge_is_no_wall() {
        let mut out = Vec::new();
        quad(&mut out, [[10.0, 0.0, 0.0], [20.0, 0.0, 0.0], [20.0, 12.0, 0.0], [10.0, 12.0, 0.0]]);
        quad(&mut out, [[18.0, 2.0, 1.3], [18.0, 4.0, 1.3], [18.0, 4.0, 1.9], [18.0, 2.0, 1.9]]);
        let fit = fit_in_axes(&TriangleColumns::with_walls(out.into_iter()), &graph(), &SCAN_AXES);
        assert_eq!((fit.edges, fit.through_walls), (6, 0));
    }

    #[test]
    fn a_graph_without_viewpoints_is_refused() {
        let misfit = judge_fit(&flat(), &ConnectivityGraph { viewpoints: Vec::new(), edges: Vec::new() }).unwrap_err();
        assert!(misfit.reason.contains("are none that is included"), "{misfit:?}");
    }

    #[test]
    fn all_edges_are_examined_once_in_a_spread_order() {
        for count in [0, 1, 5, 100, 20_001] {
            let pairs: Vec<(usize, usize)> = (0..count).map(|at| (at, at + 1)).collect();
            let mut spread: Vec<(usize, usize)> = spread_pairs(&pairs).collect();
            spread.sort_unstable();
            spread.dedup();
            assert_eq!(spread.len(), if count > MAX_EXAMINED_EDGES { count.div_ceil(2) } else { count });
        }
    }
}
