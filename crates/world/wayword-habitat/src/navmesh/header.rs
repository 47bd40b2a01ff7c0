//! The first 100 bytes of a tile, `dtMeshHeader` (Detour, `DetourNavMesh.h`): its place, its agent and its counts.

use super::{cursor::NavMeshCursor, error::NavMeshError};

/// "DNAV", read as a little-endian number.
const TILE_MAGIC: i32 = 0x444E_4156;
const TILE_VERSION: i32 = 7;
/// Bytes of the header itself.
pub(super) const HEADER_BYTES: u64 = 100;

/// Where a tile lies, for which agent it was made, and how many items of each kind it has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct TileHeader {
    /// Column, row and layer in the grid of tiles.
    pub(crate) place: [i32; 3],
    /// A number that only the writer understands.
    pub(crate) user_id: u32,
    pub(crate) polys: u32,
    pub(crate) verts: u32,
    pub(crate) links: u32,
    pub(crate) detail_meshes: u32,
    pub(crate) detail_verts: u32,
    pub(crate) detail_tris: u32,
    pub(crate) bv_nodes: u32,
    /// Off-mesh connections, Detour's links between places that no ground joins, and the index of their first polygon.
    pub(crate) off_mesh: u32,
    pub(crate) off_mesh_base: i32,
    /// Height, radius and climb of the agent, metres.
    pub(crate) agent_m: [f32; 3],
    /// The box around the tile: its smallest and its largest coordinates, metres, y up.
    pub(crate) low_m: [f32; 3],
    pub(crate) high_m: [f32; 3],
    /// Steps per metre in which the boxes of the tree are given.
    pub(crate) bv_quant_factor: f32,
}

impl TileHeader {
    pub(super) fn read(cursor: &mut NavMeshCursor<'_>) -> Result<Self, NavMeshError> {
        cursor.expect_magic("a tile's magic number", TILE_MAGIC, "not a tile of Detour with 32 bit references")?;
        cursor.expect_magic("a tile's version", TILE_VERSION, "bake it again with a current Habitat")?;
        let mut place = [0; 3];
        for number in &mut place {
            *number = cursor.read_i32("a tile's place")?;
        }
        Ok(Self {
            place,
            user_id: cursor.read_u32("a tile's user id")?,
            polys: cursor.read_count("a tile's number of polygons")?,
            verts: cursor.read_count("a tile's number of vertices")?,
            links: cursor.read_count("a tile's number of links")?,
            detail_meshes: cursor.read_count("a tile's number of detail meshes")?,
            detail_verts: cursor.read_count("a tile's number of detail vertices")?,
            detail_tris: cursor.read_count("a tile's number of detail triangles")?,
            bv_nodes: cursor.read_count("a tile's number of boxes")?,
            off_mesh: cursor.read_count("a tile's number of off-mesh connections")?,
            off_mesh_base: cursor.read_i32("a tile's first off-mesh polygon")?,
            agent_m: cursor.read_place("a tile's agent")?,
            low_m: cursor.read_place("a tile's bounds")?,
            high_m: cursor.read_place("a tile's bounds")?,
            bv_quant_factor: cursor.read_f32("a tile's quantisation")?,
        })
    }

    /// Bytes of the whole tile according to these counts. Each count has 31 bits, so the sum cannot overflow.
    pub(super) fn tile_bytes(&self) -> u64 {
        let parts = [
            (12, self.verts),
            (32, self.polys),
            (12, self.links),
            (12, self.detail_meshes),
            (12, self.detail_verts),
            (4, self.detail_tris),
            (16, self.bv_nodes),
            (36, self.off_mesh),
        ];
        HEADER_BYTES + parts.iter().map(|(bytes, count)| bytes * u64::from(*count)).sum::<u64>()
    }

    pub(super) fn write(&self, out: &mut Vec<u8>) {
        let mut put = |bytes: [u8; 4]| out.extend_from_slice(&bytes);
        put(TILE_MAGIC.to_le_bytes());
        put(TILE_VERSION.to_le_bytes());
        self.place.iter().for_each(|number| put(number.to_le_bytes()));
        let counts = [
            self.user_id,
            self.polys,
            self.verts,
            self.links,
            self.detail_meshes,
            self.detail_verts,
            self.detail_tris,
            self.bv_nodes,
            self.off_mesh,
        ];
        counts.iter().for_each(|count| put(count.to_le_bytes()));
        put(self.off_mesh_base.to_le_bytes());
        for number in [self.agent_m, self.low_m, self.high_m].iter().flatten() {
            put(number.to_le_bytes());
        }
        put(self.bv_quant_factor.to_le_bytes());
    }
}
