//! A tile of Detour: polygons with their neighbours and their surfaces.

use super::{cursor::NavMeshCursor, error::NavMeshError, header::TileHeader, poly::TilePolygon};

/// The triangles over one polygon (`dtPolyDetail`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DetailMesh {
    /// Index of its first vertex and of its first triangle in the tile's lists.
    pub(crate) vert_base: u32,
    pub(crate) tri_base: u32,
    /// How many of each it has.
    pub(crate) verts: u8,
    pub(crate) tris: u8,
    /// Bytes without a meaning; they are kept.
    pub(crate) padding: [u8; 2],
}

/// A box of the tree of boxes around polygons (`dtBVNode`), with which Detour finds polygons. This program only preserves the
/// boxes, or makes them for Detour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BvNode {
    /// Smallest and largest coordinates, in steps from the tile's lowest corner.
    pub(crate) low: [u16; 3],
    pub(crate) high: [u16; 3],
    /// The polygon, or minus the number of nodes to skip.
    pub(crate) index: i32,
}

/// All contents of a tile.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct NavMeshTile {
    /// Detour's own number for the tile, as in the file.
    pub(crate) reference: u32,
    pub(crate) header: TileHeader,
    /// Metres, y up.
    pub(crate) verts: Vec<[f32; 3]>,
    pub(crate) polys: Vec<TilePolygon>,
    /// 12 bytes each. Detour fills them when it loads a tile; on disk they are arbitrary.
    pub(crate) links: Vec<u8>,
    pub(crate) detail_meshes: Vec<DetailMesh>,
    pub(crate) detail_verts: Vec<[f32; 3]>,
    /// Three corners and flags. The index of a corner counts the polygon's own vertices first, then the detail mesh's.
    pub(crate) detail_tris: Vec<[u8; 4]>,
    pub(crate) bv_nodes: Vec<BvNode>,
    /// 36 bytes each. Habitat makes none, and this program does not use them.
    pub(crate) off_mesh: Vec<u8>,
}

impl NavMeshTile {
    /// Reads a tile of `bytes` bytes. The caller has checked that the cursor has them.
    pub(super) fn read(cursor: &mut NavMeshCursor<'_>, reference: u32, bytes: u64) -> Result<Self, NavMeshError> {
        let start = cursor.byte_offset();
        let header = TileHeader::read(cursor)?;
        if header.tile_bytes() != bytes {
            let expected = format!("{bytes}, the tile's size: only tiles with 32 bit references can be read");
            let what = "the bytes that a tile's counts need";
            return Err(NavMeshError::bad_value(start, what, header.tile_bytes(), expected));
        }
        let mut tile = Self { reference, header, ..Self::default() };
        for _ in 0..header.verts {
            tile.verts.push(cursor.read_place("a vertex")?);
        }
        for _ in 0..header.polys {
            tile.polys.push(TilePolygon::read(cursor, &header)?);
        }
        tile.links = cursor.take_bytes(12 * u64::from(header.links), "the links")?.to_vec();
        tile.read_detail(cursor)?;
        for _ in 0..header.bv_nodes {
            let mut corners = [0; 6];
            for corner in &mut corners {
                *corner = cursor.read_u16("a box")?;
            }
            let [a, b, c, d, e, f] = corners;
            tile.bv_nodes.push(BvNode { low: [a, b, c], high: [d, e, f], index: cursor.read_i32("a box's polygon")? });
        }
        tile.off_mesh = cursor.take_bytes(36 * u64::from(header.off_mesh), "the off-mesh connections")?.to_vec();
        Ok(tile)
    }

    fn read_detail(&mut self, cursor: &mut NavMeshCursor<'_>) -> Result<(), NavMeshError> {
        let meshes_at = cursor.byte_offset();
        for _ in 0..self.header.detail_meshes {
            self.detail_meshes.push(DetailMesh {
                vert_base: cursor.read_u32("a detail mesh's first vertex")?,
                tri_base: cursor.read_u32("a detail mesh's first triangle")?,
                verts: cursor.read_u8("a detail mesh's number of vertices")?,
                tris: cursor.read_u8("a detail mesh's number of triangles")?,
                padding: cursor.read_u16("a detail mesh's padding")?.to_le_bytes(),
            });
        }
        for _ in 0..self.header.detail_verts {
            self.detail_verts.push(cursor.read_place("a detail vertex")?);
        }
        let tris_at = cursor.byte_offset();
        for corners in cursor.take_bytes(4 * u64::from(self.header.detail_tris), "the detail triangles")?.as_chunks().0
        {
            self.detail_tris.push(*corners);
        }
        self.check_detail(meshes_at, tris_at)
    }

    /// Checks that every detail mesh lies within the lists, and that every corner of a triangle exists.
    fn check_detail(&self, meshes_at: usize, tris_at: usize) -> Result<(), NavMeshError> {
        for (index, (mesh, poly)) in self.detail_meshes.iter().zip(&self.polys).enumerate() {
            let end = |base: u32, count: u8| u64::from(base) + u64::from(count);
            let within = |what, offset, end: u64, limit: u32| {
                let expected = format!("at most {limit}");
                if end <= u64::from(limit) { Ok(()) } else { Err(NavMeshError::bad_value(offset, what, end, expected)) }
            };
            let offset = meshes_at + 12 * index;
            within(
                "the end of a detail mesh's vertices",
                offset,
                end(mesh.vert_base, mesh.verts),
                self.header.detail_verts,
            )?;
            within(
                "the end of a detail mesh's triangles",
                offset + 4,
                end(mesh.tri_base, mesh.tris),
                self.header.detail_tris,
            )?;
            let corners = u32::from(poly.vert_count) + u32::from(mesh.verts);
            let first = mesh.tri_base as usize;
            let triangles = self.detail_tris.iter().skip(first).take(usize::from(mesh.tris));
            for (at, [a, b, c, _]) in triangles.enumerate() {
                if let Some(corner) = [a, b, c].into_iter().find(|corner| u32::from(**corner) >= corners) {
                    let offset = tris_at + 4 * (first + at);
                    let expected = format!("below {corners}");
                    return Err(NavMeshError::bad_value(offset, "a detail triangle's corner", corner, expected));
                }
            }
        }
        Ok(())
    }

    /// The triangles of a polygon's surface; a fan if there is no detail mesh.
    pub(crate) fn polygon_triangles(&self, poly: usize) -> Vec<[[f32; 3]; 3]> {
        let Some(polygon) = self.polys.get(poly) else { return Vec::new() };
        let corners = polygon.corners();
        let own = |corner: usize| self.verts.get(usize::from(*corners.get(corner)?)).copied();
        let Some(mesh) = self.detail_meshes.get(poly).filter(|mesh| mesh.tris > 0) else {
            return (2..corners.len()).filter_map(|last| Some([own(0)?, own(last - 1)?, own(last)?])).collect();
        };
        let place = |corner: u8| match usize::from(corner) {
            corner if corner < corners.len() => own(corner),
            corner => self.detail_verts.get(mesh.vert_base as usize + corner - corners.len()).copied(),
        };
        let triangles = self.detail_tris.iter().skip(mesh.tri_base as usize).take(usize::from(mesh.tris));
        triangles.filter_map(|[a, b, c, _]| Some([place(*a)?, place(*b)?, place(*c)?])).collect()
    }

    pub(super) fn write(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.reference.to_le_bytes());
        out.extend_from_slice(&u32::try_from(self.header.tile_bytes()).unwrap_or(u32::MAX).to_le_bytes());
        self.header.write(out);
        out.extend(self.verts.iter().flatten().flat_map(|number| number.to_le_bytes()));
        self.polys.iter().for_each(|poly| poly.write(out));
        out.extend_from_slice(&self.links);
        for mesh in &self.detail_meshes {
            out.extend_from_slice(&mesh.vert_base.to_le_bytes());
            out.extend_from_slice(&mesh.tri_base.to_le_bytes());
            out.extend_from_slice(&[mesh.verts, mesh.tris]);
            out.extend_from_slice(&mesh.padding);
        }
        out.extend(self.detail_verts.iter().flatten().flat_map(|number| number.to_le_bytes()));
        out.extend(self.detail_tris.iter().flatten());
        for node in &self.bv_nodes {
            out.extend([node.low, node.high].iter().flatten().flat_map(|number| number.to_le_bytes()));
            out.extend_from_slice(&node.index.to_le_bytes());
        }
        out.extend_from_slice(&self.off_mesh);
    }
}
