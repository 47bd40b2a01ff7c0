//! A polygon of a tile: `dtPoly`.

use super::{cursor::NavMeshCursor, error::NavMeshError, header::TileHeader};

/// Most corners of a polygon.
pub(crate) const MAX_CORNERS: usize = 6;
/// This bit is set if an edge leads into another tile.
const PORTAL_BIT: u16 = 0x8000;
/// Offset of the corners within a polygon, bytes.
const CORNERS_OFFSET: usize = 4;
/// Offset of the neighbours within a polygon, bytes.
const NEIGHBOURS_OFFSET: usize = 16;
/// Offset of the number of corners within a polygon, bytes.
const CORNER_COUNT_OFFSET: usize = 30;

/// The neighbour behind an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EdgeNeighbour {
    /// None: the walkable ground ends here.
    Border,
    /// Another polygon of the tile, by its index.
    Polygon(usize),
    /// The tile on this side: 0 is +x, 2 +z, 4 -x, 6 -z.
    Portal(u8),
}

/// A convex piece of ground, or an off-mesh connection: a link between two places that no ground joins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TilePolygon {
    /// A number that Detour sets when it loads the tile.
    pub(crate) first_link: u32,
    /// Indices of its vertices in the tile; `vert_count` of them count.
    pub(crate) verts: [u16; MAX_CORNERS],
    /// The neighbour behind the edge from corner i to the next, as in the file: 1-based, and 0 is none.
    pub(crate) neis: [u16; MAX_CORNERS],
    pub(crate) flags: u16,
    pub(crate) vert_count: u8,
    /// Six bits of area, two of type.
    pub(crate) area_and_type: u8,
}

impl TilePolygon {
    pub(super) fn read(cursor: &mut NavMeshCursor<'_>, header: &TileHeader) -> Result<Self, NavMeshError> {
        let start = cursor.byte_offset();
        let mut poly = Self { first_link: cursor.read_u32("a polygon's link")?, ..Self::default() };
        for vert in &mut poly.verts {
            *vert = cursor.read_u16("a polygon's corner")?;
        }
        for nei in &mut poly.neis {
            *nei = cursor.read_u16("a polygon's neighbour")?;
        }
        poly.flags = cursor.read_u16("a polygon's flags")?;
        poly.vert_count = cursor.read_u8("a polygon's number of corners")?;
        poly.area_and_type = cursor.read_u8("a polygon's area")?;
        poly.check_corners(start, header)?;
        Ok(poly)
    }

    /// Checks that the polygon's vertices and neighbours exist. `start` is its offset in the file.
    fn check_corners(&self, start: usize, header: &TileHeader) -> Result<(), NavMeshError> {
        let least = if self.is_ground() { 3 } else { 2 };
        if !(least..=MAX_CORNERS).contains(&usize::from(self.vert_count)) {
            let expected = format!("{least} to {MAX_CORNERS}");
            return Err(NavMeshError::bad_value(
                start + CORNER_COUNT_OFFSET,
                "a polygon's number of corners",
                self.vert_count,
                expected,
            ));
        }
        for (edge, (vert, found)) in self.corners().iter().zip(&self.neis).enumerate() {
            if u32::from(*vert) >= header.verts {
                let expected = format!("below {}", header.verts);
                return Err(NavMeshError::bad_value(
                    start + CORNERS_OFFSET + 2 * edge,
                    "a polygon's corner",
                    vert,
                    expected,
                ));
            }
            let behind = self.neighbour_behind(edge);
            if matches!(behind, EdgeNeighbour::Polygon(other) if other as u64 >= u64::from(header.polys)) {
                let expected = format!("at most {}", header.polys);
                return Err(NavMeshError::bad_value(
                    start + NEIGHBOURS_OFFSET + 2 * edge,
                    "a polygon's neighbour",
                    found,
                    expected,
                ));
            }
        }
        Ok(())
    }

    /// Whether it is ground and not an off-mesh connection.
    pub(crate) fn is_ground(&self) -> bool {
        self.area_and_type >> 6 == 0
    }

    /// The indices of its vertices in the tile.
    pub(crate) fn corners(&self) -> &[u16] {
        self.verts.get(..usize::from(self.vert_count)).unwrap_or(&self.verts)
    }

    /// The neighbour behind the edge from corner `edge` to the next.
    pub(crate) fn neighbour_behind(&self, edge: usize) -> EdgeNeighbour {
        match self.neis.get(edge).copied().unwrap_or(0) {
            0 => EdgeNeighbour::Border,
            portal if portal & PORTAL_BIT != 0 => {
                let [side, _] = portal.to_le_bytes();
                EdgeNeighbour::Portal(side)
            }
            polygon => EdgeNeighbour::Polygon(usize::from(polygon) - 1),
        }
    }

    /// Makes an edge a portal into the neighbouring tile on a side.
    #[cfg(test)]
    pub(crate) fn open(&mut self, edge: usize, side: u8) {
        self.neis[edge] = PORTAL_BIT | u16::from(side);
    }

    pub(super) fn write(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.first_link.to_le_bytes());
        out.extend([self.verts, self.neis].iter().flatten().flat_map(|number| number.to_le_bytes()));
        out.extend_from_slice(&self.flags.to_le_bytes());
        out.extend_from_slice(&[self.vert_count, self.area_and_type]);
    }
}
