//! Reads and writes Habitat's `.navmesh` files, byte for byte.
//!
//! Layout: `PathFinder::loadNavMesh` and `saveNavMesh` of habitat-sim 0.3.3 (version 2), and RecastDemo's
//! `Sample::saveAll` (version 1, which has no settings); the tiles are Detour's, version 7, with 32 bit references. The
//! reader keeps every byte, so that a file is written back unchanged.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

#[allow(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "it makes navmeshes and reads none"
)]
pub(crate) mod build;
mod cursor;
mod error;
mod header;
mod poly;
mod settings;
#[cfg(test)]
mod tests;
mod tile;

pub use error::NavMeshError;
pub(crate) use header::TileHeader;
pub(crate) use poly::{EdgeNeighbour, MAX_CORNERS, TilePolygon};
pub use settings::NavMeshSettings;
pub(crate) use tile::{BvNode, DetailMesh, NavMeshTile};

use cursor::NavMeshCursor;
use header::HEADER_BYTES;

/// "MSET", read as a little-endian number.
const FILE_MAGIC: i32 = 0x4D53_4554;

/// A navmesh, as in its file.
#[derive(Clone, Debug, PartialEq)]
pub struct NavMesh {
    /// The grid of tiles (`dtNavMeshParams`).
    pub(crate) grid: TileGrid,
    /// How it was baked; a version 1 file does not contain this.
    pub(crate) settings: Option<NavMeshSettings>,
    pub(crate) tiles: Vec<NavMeshTile>,
    /// The bytes after the last tile; Habitat ignores them.
    rest: Vec<u8>,
}

/// The position and size of the tiles, and how many tiles and polygons there may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TileGrid {
    pub(crate) origin_m: [f32; 3],
    /// Width and height of a tile, metres.
    pub(crate) tile_m: [f32; 2],
    pub(crate) max_tiles: i32,
    pub(crate) max_polys: i32,
}

impl NavMesh {
    /// A navmesh that was not read from a file.
    pub(crate) fn new(grid: TileGrid, settings: Option<NavMeshSettings>, tiles: Vec<NavMeshTile>) -> Self {
        Self { grid, settings, tiles, rest: Vec::new() }
    }

    /// Reads a file's bytes. The memory it needs is bounded by their number, because every list must fit into them.
    ///
    /// # Errors
    /// [`NavMeshError`] names the byte, the value there, and what was expected.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, NavMeshError> {
        let mut cursor = NavMeshCursor::new(bytes);
        cursor.expect_magic("the file's magic number", FILE_MAGIC, "not a navmesh of Habitat or Recast")?;
        let version_at = cursor.byte_offset();
        let version = cursor.read_i32("the file's version")?;
        if !(1..=2).contains(&version) {
            return Err(NavMeshError::bad_value(
                version_at,
                "the file's version",
                version,
                "1 (Recast) or 2 (Habitat)",
            ));
        }
        let tiles_at = cursor.byte_offset();
        let count = cursor.read_count("the number of tiles")?;
        let grid = TileGrid::read(&mut cursor)?;
        let settings = if version == 2 { Some(NavMeshSettings::read(&mut cursor)?) } else { None };
        let room = cursor.bytes_left() as u64 / (8 + HEADER_BYTES);
        if u64::from(count) > room {
            let expected = format!("at most {room}, because the file has no room for more");
            return Err(NavMeshError::bad_value(tiles_at, "the number of tiles", count, expected));
        }
        let tiles = (0..count).map(|_| read_tile(&mut cursor)).collect::<Result<_, _>>()?;
        Ok(Self { grid, settings, tiles, rest: cursor.remaining_bytes().to_vec() })
    }

    /// The file's bytes. If the navmesh was read from a file, they are the same as in that file.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        out.extend_from_slice(&FILE_MAGIC.to_le_bytes());
        out.extend_from_slice(&i32::from(self.version()).to_le_bytes());
        out.extend_from_slice(&u32::try_from(self.tiles.len()).unwrap_or(u32::MAX).to_le_bytes());
        self.grid.write(&mut out);
        if let Some(settings) = &self.settings {
            settings.write(&mut out);
        }
        self.tiles.iter().for_each(|tile| tile.write(&mut out));
        out.extend_from_slice(&self.rest);
        out
    }

    /// 1 for Recast's own files, 2 for Habitat's, which contain the settings that they were baked with.
    #[must_use]
    pub fn version(&self) -> u8 {
        if self.settings.is_some() { 2 } else { 1 }
    }

    /// The settings that it was baked with, if the file contains them.
    #[must_use]
    pub fn settings(&self) -> Option<&NavMeshSettings> {
        self.settings.as_ref()
    }

    /// Number of polygons in all tiles.
    #[must_use]
    pub fn polygon_count(&self) -> usize {
        self.tiles.iter().map(|tile| tile.polys.len()).sum()
    }
}

fn read_tile(cursor: &mut NavMeshCursor<'_>) -> Result<NavMeshTile, NavMeshError> {
    let reference = cursor.read_u32("a tile's reference")?;
    let size_at = cursor.byte_offset();
    let bytes = u64::from(cursor.read_count("a tile's size")?);
    if bytes < HEADER_BYTES || bytes > cursor.bytes_left() as u64 {
        let expected = format!("{HEADER_BYTES} to {}, the bytes that are left", cursor.bytes_left());
        return Err(NavMeshError::bad_value(size_at, "a tile's size", bytes, expected));
    }
    NavMeshTile::read(cursor, reference, bytes)
}

impl TileGrid {
    fn read(cursor: &mut NavMeshCursor<'_>) -> Result<Self, NavMeshError> {
        Ok(Self {
            origin_m: cursor.read_place("the grid's origin")?,
            tile_m: [cursor.read_f32("a tile's width")?, cursor.read_f32("a tile's height")?],
            max_tiles: cursor.read_i32("the most tiles")?,
            max_polys: cursor.read_i32("the most polygons")?,
        })
    }

    fn write(&self, out: &mut Vec<u8>) {
        out.extend(self.origin_m.iter().chain(&self.tile_m).flat_map(|number| number.to_le_bytes()));
        out.extend_from_slice(&self.max_tiles.to_le_bytes());
        out.extend_from_slice(&self.max_polys.to_le_bytes());
    }
}
