//! Makes a navmesh tile from polygons, as `dtCreateNavMeshData` does (Detour, `DetourNavMeshBuilder.cpp`).

use super::{
    BvNode, DetailMesh, MAX_CORNERS, NavMesh, NavMeshSettings, NavMeshTile, TileGrid, TileHeader, TilePolygon,
};

/// `DT_NULL_LINK`.
const NO_LINK: u32 = u32::MAX;
/// Habitat's area and flag of walkable ground (`POLYAREA_GROUND`, `POLYFLAGS_WALK`).
const GROUND_AREA: u8 = 0;
const WALK_FLAG: u16 = 1;

/// The polygons of a tile that is to be made.
#[derive(Clone, Debug, Default)]
pub(crate) struct TileSurface {
    /// Metres, y up.
    pub(crate) verts: Vec<[f32; 3]>,
    pub(crate) pieces: Vec<TilePiece>,
    /// The box around the scene: its smallest and its largest coordinates.
    pub(crate) low_m: [f32; 3],
    pub(crate) high_m: [f32; 3],
}

/// One polygon with its surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct TilePiece {
    /// Three to six vertices.
    pub(crate) corners: Vec<u16>,
    /// For each corner, the index of the piece behind the edge that begins there, plus 1; 0 if the ground ends there.
    pub(crate) neighbours: Vec<u16>,
    /// Vertices of the detail mesh, without the corners.
    pub(crate) detail_verts: Vec<[f32; 3]>,
    /// Triangles of the surface, each as three vertices and flags ([`NavMeshTile`]).
    pub(crate) detail_tris: Vec<[u8; 4]>,
}

/// A navmesh of one tile, as Habitat bakes them. Detour's counts go up to 65,535: the caller must not exceed that.
pub(crate) fn single_tile(surface: &TileSurface, settings: NavMeshSettings) -> NavMesh {
    let (low_m, high_m) = (surface.low_m, surface.high_m);
    let polys = surface.pieces.len() as u32;
    let poly_bits = polys.max(1).next_power_of_two().ilog2();
    let mut tile = build_tile(surface, &settings);
    // Salt 1, tile 0: the reference that `dtNavMesh::init` gives to a single tile.
    tile.reference = 1_u32.checked_shl(poly_bits).unwrap_or(0);
    let grid = TileGrid {
        origin_m: low_m,
        tile_m: [high_m[0] - low_m[0], high_m[2] - low_m[2]],
        max_tiles: 1,
        max_polys: polys as i32,
    };
    NavMesh::new(grid, Some(settings), vec![tile])
}

/// A tile at place 0 of the grid.
pub(crate) fn build_tile(surface: &TileSurface, settings: &NavMeshSettings) -> NavMeshTile {
    let mut tile = NavMeshTile { verts: surface.verts.clone(), ..NavMeshTile::default() };
    for piece in &surface.pieces {
        let mut poly = TilePolygon {
            first_link: NO_LINK,
            flags: WALK_FLAG,
            vert_count: piece.corners.len().min(MAX_CORNERS) as u8,
            area_and_type: GROUND_AREA,
            ..TilePolygon::default()
        };
        for (slot, corner) in poly.verts.iter_mut().zip(&piece.corners) {
            *slot = *corner;
        }
        for (slot, neighbour) in poly.neis.iter_mut().zip(&piece.neighbours) {
            *slot = *neighbour;
        }
        tile.polys.push(poly);
        tile.detail_meshes.push(DetailMesh {
            vert_base: tile.detail_verts.len() as u32,
            tri_base: tile.detail_tris.len() as u32,
            verts: piece.detail_verts.len() as u8,
            tris: piece.detail_tris.len() as u8,
            padding: [0; 2],
        });
        tile.detail_verts.extend(&piece.detail_verts);
        tile.detail_tris.extend(&piece.detail_tris);
    }
    let edges: usize = surface.pieces.iter().map(|piece| piece.corners.len()).sum();
    // A link has 12 bytes.
    tile.links = vec![0; 12 * edges];
    tile.bv_nodes = build_box_tree(surface, settings.cell_size_m);
    tile.header = TileHeader {
        polys: tile.polys.len() as u32,
        verts: tile.verts.len() as u32,
        links: edges as u32,
        detail_meshes: tile.detail_meshes.len() as u32,
        detail_verts: tile.detail_verts.len() as u32,
        detail_tris: tile.detail_tris.len() as u32,
        bv_nodes: tile.bv_nodes.len() as u32,
        off_mesh_base: tile.polys.len() as i32,
        agent_m: [settings.agent_height_m, settings.agent_radius_m, settings.agent_max_climb_m],
        low_m: surface.low_m,
        high_m: surface.high_m,
        bv_quant_factor: 1.0 / settings.cell_size_m,
        ..TileHeader::default()
    };
    tile
}

/// Boxes around the pieces, split in halves along the longest side until each holds one piece (`createBVTree`). There
/// are twice as many nodes as pieces; the last node is empty.
fn build_box_tree(surface: &TileSurface, cell_size_m: f32) -> Vec<BvNode> {
    let steps = |metres: f32, low: f32| ((metres - low) / cell_size_m).clamp(0.0, f32::from(u16::MAX)) as u16;
    let mut boxes: Vec<BvNode> = Vec::with_capacity(surface.pieces.len());
    for (index, piece) in surface.pieces.iter().enumerate() {
        let corners = piece.corners.iter().filter_map(|corner| surface.verts.get(usize::from(*corner)));
        let (mut low, mut high) = ([u16::MAX; 3], [0; 3]);
        for place in corners.chain(&piece.detail_verts) {
            for axis in 0..3 {
                let step = steps(place[axis], surface.low_m[axis]);
                (low[axis], high[axis]) = (low[axis].min(step), high[axis].max(step));
            }
        }
        boxes.push(BvNode { low, high, index: index as i32 });
    }
    let mut nodes = Vec::with_capacity(2 * boxes.len());
    if !boxes.is_empty() {
        divide_boxes(&mut boxes, &mut nodes);
    }
    nodes.resize(2 * boxes.len(), BvNode { low: [0; 3], high: [0; 3], index: 0 });
    nodes
}

/// Adds the nodes for these boxes: a node around all of them, then the nodes of each half.
fn divide_boxes(boxes: &mut [BvNode], nodes: &mut Vec<BvNode>) {
    if let [only] = boxes {
        nodes.push(*only);
        return;
    }
    let (mut low, mut high) = ([u16::MAX; 3], [0; 3]);
    for each in boxes.iter() {
        low = std::array::from_fn(|axis| low[axis].min(each.low[axis]));
        high = std::array::from_fn(|axis: usize| high[axis].max(each.high[axis]));
    }
    let side = |axis: usize| high[axis].saturating_sub(low[axis]);
    // Of equally long sides the first, as in `longestAxis`.
    let longest = (1..3).fold(0, |best, axis| if side(axis) > side(best) { axis } else { best });
    boxes.sort_by_key(|each| each.low[longest]);
    let here = nodes.len();
    nodes.push(BvNode { low, high, index: 0 });
    let (first, second) = boxes.split_at_mut(boxes.len() / 2);
    divide_boxes(first, nodes);
    divide_boxes(second, nodes);
    nodes[here].index = -((nodes.len() - here) as i32);
}
