//! Hangs things on walls, and curtains at windows.

use super::super::{catalogue::FurnitureKind, rect::WallSide};
use super::placing::{PieceIndex, RoomFurnisher};

impl RoomFurnisher<'_> {
    /// Hangs a thing above a piece, centred on it, its lower edge `gap` centimetres over the piece's top.
    pub(super) fn hang_over(&mut self, below: PieceIndex, kind: FurnitureKind, gap: i32) -> Option<PieceIndex> {
        let size = kind.size_cm(&mut self.dice);
        let wall = self.wall_behind(below);
        let piece = self.piece_at(below);
        let base = piece.base_cm + piece.height_cm - self.room.base_cm() + gap;
        let (x, y) = piece.footprint.centre();
        let from = if wall.along_x() { x } else { y } - size[0] / 2;
        self.hang_at(kind, wall, from, base, size)
    }

    /// Hangs a thing at a height of `base` centimetres, on the first wall with room for it.
    pub(super) fn hang_anywhere(&mut self, kind: FurnitureKind, base: i32) -> Option<PieceIndex> {
        let size = kind.size_cm(&mut self.dice);
        self.hang_sized(kind, size, base)
    }

    /// As [`Self::hang_anywhere`], with a given size.
    pub(super) fn hang_sized(&mut self, kind: FurnitureKind, size: [i32; 3], base: i32) -> Option<PieceIndex> {
        for wall in self.shuffled_walls() {
            let edge = self.inner.edge_at(wall);
            let spare = edge.length() - size[0];
            let mut offsets: Vec<i32> = (0..=spare.max(0) / 10).map(|step| step * 10).collect();
            offsets.sort_by_key(|offset| (2 * offset - spare).abs());
            for offset in offsets {
                if let Some(piece) = self.hang_at(kind, wall, edge.from + offset, base, size) {
                    return Some(piece);
                }
            }
        }
        None
    }

    /// Hangs a thing at a place, if the wall is bare there.
    pub(super) fn hang_at(
        &mut self,
        kind: FurnitureKind,
        wall: WallSide,
        from: i32,
        base: i32,
        size: [i32; 3],
    ) -> Option<PieceIndex> {
        let area = self.footprint_at_wall(wall, from, size);
        let fits =
            self.inner.contains(&area) && self.wall_is_bare(wall, &area, base, base + size[2], kind.is_slim_on_wall());
        fits.then(|| self.add_piece(kind, area, base, size[2], wall))
    }

    /// Hangs curtains on both sides of every window, where the wall is free.
    pub(super) fn hang_curtains(&mut self) {
        for (span, _) in self.windows.clone() {
            let Some(wall) = self.room.outline.wall_of(&span) else {
                continue;
            };
            for from in [span.from - 34, span.to - 16] {
                let size = [50, 8, 240];
                let area = self.footprint_at_wall(wall, from, size);
                if self.inner.contains(&area) && !self.overlaps_any(&area) {
                    let curtain = self.add_piece(FurnitureKind::Curtain, area, 2, size[2], wall);
                    self.set_colour(curtain, self.taste.curtain);
                }
            }
        }
    }

    /// Walls without a window in them, in the order given.
    pub(super) fn walls_without_windows(&self, walls: &[WallSide]) -> Vec<WallSide> {
        let has_window =
            |wall: &WallSide| self.windows.iter().any(|(span, _)| self.room.outline.wall_of(span) == Some(*wall));
        walls.iter().copied().filter(|wall| !has_window(wall)).collect()
    }
}
