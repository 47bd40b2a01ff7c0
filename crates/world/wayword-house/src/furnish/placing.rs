//! Places pieces in a room one by one. A piece is placed only where it fits, blinds no window, and leaves every door
//! within reach.

use super::super::{
    catalogue::FurnitureKind,
    colour::Colour,
    dice::HouseDice,
    layout::{HouseLayout, floor_before_opening},
    model::{CEILING_CM, DoorLeaf, FurniturePiece, HouseRoom, WallOpening},
    rect::{RectCm, SpanCm, WallSide},
};
use super::{HousePalette, finish::RoomFinishes, reachable_floor};

/// A room while it is being furnished.
pub(super) struct RoomFurnisher<'a> {
    pub(super) dice: HouseDice,
    pub(super) taste: HousePalette,
    pub(super) finishes: RoomFinishes,
    pub(super) room: &'a HouseRoom,
    /// Index of the room in the plan.
    index: usize,
    /// The area between the walls.
    pub(super) inner: RectCm,
    /// The floor in front of each opening.
    doorsteps: Vec<RectCm>,
    /// Where the room's openings are on its walls.
    holes: Vec<SpanCm>,
    /// Floor under door leaves that are open into the room.
    leaves: Vec<RectCm>,
    /// Where the front door is, if this room has it.
    front_door: Option<SpanCm>,
    /// Windows of the room: where, and the height of the lower edge above the room's floor, centimetres.
    pub(super) windows: Vec<(SpanCm, i32)>,
    /// Floor that must stay free so that a piece can be used.
    reserved: Vec<RectCm>,
    pieces: Vec<FurniturePiece>,
}

/// Which places along a wall are tried first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum WallPreference {
    /// Those nearest to the middle of the wall.
    Middle,
    /// Those nearest to the corners of the room.
    Ends,
    /// All, in random order.
    Anywhere,
}

/// Least distance between a hanging piece and its neighbours on the wall, centimetres.
const MIN_HANGING_GAP_CM: i32 = 8;

/// Least distance between a hanging piece and the opening of a door or a window, centimetres.
const MIN_GAP_TO_OPENING_CM: i32 = 10;
/// Least distance between a hanging piece and an open door's leaf, centimetres.
const MIN_GAP_TO_LEAF_CM: i32 = 12;

/// A piece in the room: its index in the list.
pub(super) type PieceIndex = usize;

/// The main material of a piece. The colour can override the catalogue: a glass table is not made of wood.
fn material_name(kind: FurnitureKind, colour: Colour) -> &'static str {
    if colour == Colour::Glass { "glass" } else { kind.entry().material }
}

impl<'a> RoomFurnisher<'a> {
    pub(super) fn new(seed: u64, layout: &'a HouseLayout, index: usize, taste: HousePalette) -> Self {
        let room = &layout.rooms[index];
        let touches_room = |opening: &&WallOpening| opening.room == index || opening.beyond == Some(index);
        let openings = || layout.openings.iter().filter(touches_room);
        let windows = layout.windows.iter().filter(|window| window.room == index);
        Self {
            dice: HouseDice::new(seed, &["furniture", &index.to_string()]),
            taste,
            finishes: RoomFinishes::for_room(seed, index, room.kind, taste.wood),
            room,
            index,
            inner: room.inner_area(),
            doorsteps: openings()
                .filter(|opening| opening.leaf != DoorLeaf::Garage)
                .filter_map(|opening| floor_before_opening(&room.outline, &opening.span))
                .collect(),
            holes: openings().map(|opening| opening.span).collect(),
            leaves: openings()
                .filter(|opening| matches!(opening.leaf, DoorLeaf::Open { into, .. } if into == index))
                .flat_map(|opening| opening.open_leaf(&layout.rooms))
                .collect(),
            front_door: openings().find(|opening| opening.leaf == DoorLeaf::Closed).map(|opening| opening.span),
            windows: windows.map(|window| (window.span, window.sill_cm - room.base_cm())).collect(),
            // Only a car may stand in front of a garage door.
            reserved: openings()
                .filter(|opening| opening.leaf == DoorLeaf::Garage)
                .filter_map(|opening| floor_before_opening(&room.outline, &opening.span))
                .collect(),
            pieces: Vec::new(),
        }
    }

    pub(super) fn into_pieces(self) -> Vec<FurniturePiece> {
        self.pieces
    }

    pub(super) fn piece_at(&self, piece: PieceIndex) -> &FurniturePiece {
        &self.pieces[piece]
    }

    /// The wall behind a piece.
    pub(super) fn wall_behind(&self, piece: PieceIndex) -> WallSide {
        WallSide::ALL[usize::from(self.pieces[piece].quarter_turns) % 4]
    }

    /// Sets the colour of a piece, so that it matches the pieces around it.
    pub(super) fn set_colour(&mut self, piece: PieceIndex, colour: Colour) {
        let piece = &mut self.pieces[piece];
        piece.colour = colour;
        piece.material = material_name(piece.kind, colour).to_owned();
    }

    /// Gives a wooden piece the finish of its room, or now and then another one.
    pub(super) fn apply_finish(&mut self, piece: PieceIndex) {
        let colour = self.finishes.draw_finish(self.pieces[piece].kind);
        self.set_colour(piece, colour);
    }

    /// Adds a piece without checking whether it fits.
    pub(super) fn add_piece(
        &mut self,
        kind: FurnitureKind,
        footprint: RectCm,
        base_cm: i32,
        height_cm: i32,
        wall: WallSide,
    ) -> PieceIndex {
        let entry = kind.entry();
        let colour = kind.draw_colour(&mut self.dice);
        self.pieces.push(FurniturePiece {
            id: 0,
            kind,
            name: entry.name.to_owned(),
            colour,
            material: material_name(kind, colour).to_owned(),
            room: self.index,
            footprint,
            base_cm: self.room.base_cm() + base_cm,
            height_cm,
            quarter_turns: wall.quarter_turns(),
            variant: self.dice.draw_between(0, 9999).unsigned_abs(),
        });
        self.pieces.len() - 1
    }

    /// Places a piece with its back to the first of `walls` where it fits, with `clearance` centimetres of free floor in
    /// front. Returns `None` if it fits nowhere, as all functions here do.
    pub(super) fn stand_at_walls(
        &mut self,
        kind: FurnitureKind,
        walls: &[WallSide],
        along: WallPreference,
        clearance: i32,
    ) -> Option<PieceIndex> {
        let size = kind.size_cm(&mut self.dice);
        self.stand_sized(kind, size, walls, along, clearance)
    }

    /// As [`Self::stand_at_walls`], on any wall, in random order.
    pub(super) fn stand_anywhere(
        &mut self,
        kind: FurnitureKind,
        along: WallPreference,
        clearance: i32,
    ) -> Option<PieceIndex> {
        let walls = self.shuffled_walls();
        self.stand_at_walls(kind, &walls, along, clearance)
    }

    /// As [`Self::stand_at_walls`], with a given size: width, depth and height, centimetres.
    pub(super) fn stand_sized(
        &mut self,
        kind: FurnitureKind,
        size: [i32; 3],
        walls: &[WallSide],
        along: WallPreference,
        clearance: i32,
    ) -> Option<PieceIndex> {
        for wall in walls {
            for from in self.wall_offsets(*wall, size[0], along) {
                let footprint = self.footprint_at_wall(*wall, from, size);
                let before = self.floor_in_front(footprint, *wall, clearance);
                if !self.blinds_window(*wall, &footprint, size[2]) && self.is_free(&footprint, &before) {
                    self.reserved.push(before);
                    return Some(self.add_piece(kind, footprint, 0, size[2], *wall));
                }
            }
        }
        None
    }

    /// Places a piece at exactly this footprint if it fits there; reserved floor does not count where `close` is set.
    pub(super) fn place_at_if_free(
        &mut self,
        kind: FurnitureKind,
        footprint: RectCm,
        wall: WallSide,
        close: bool,
    ) -> Option<PieceIndex> {
        let fits = self.inner.contains(&footprint)
            && !self.touches_fixed(&footprint)
            && (close || !self.reserved.iter().any(|area| area.overlaps(&footprint)))
            && self.keeps_ways_open(&footprint);
        let height = kind.entry().size_cm[2];
        fits.then(|| self.add_piece(kind, footprint, 0, height, wall))
    }

    /// As [`Self::place_at_if_free`], pushed in under `table`.
    pub(super) fn place_under_if_free(
        &mut self,
        kind: FurnitureKind,
        footprint: RectCm,
        wall: WallSide,
        table: &RectCm,
    ) -> Option<PieceIndex> {
        let others = |area: &RectCm| area != table && area.overlaps(&footprint);
        let fits = self.inner.contains(&footprint)
            && !self.doorsteps.iter().any(|area| area.overlaps(&footprint))
            && !self.standing_footprints().any(|area| others(&area))
            && self.keeps_ways_open(&footprint);
        let height = kind.entry().size_cm[2];
        fits.then(|| self.add_piece(kind, footprint, 0, height, wall))
    }

    /// Places a piece next to another at the same wall, `gap` centimetres further along it, or before it if `gap` is negative.
    pub(super) fn place_beside(&mut self, anchor: PieceIndex, kind: FurnitureKind, gap: i32) -> Option<PieceIndex> {
        let wall = self.wall_behind(anchor);
        let size = kind.size_cm(&mut self.dice);
        let anchor = self.pieces[anchor].footprint;
        let (low, high) = if wall.along_x() { (anchor.x0, anchor.x1) } else { (anchor.y0, anchor.y1) };
        let from = if gap > 0 { high + gap } else { low + gap - size[0] };
        let footprint = self.footprint_at_wall(wall, from, size);
        let fits = self.inner.contains(&footprint)
            && !self.touches_fixed(&footprint)
            && !self.blinds_window(wall, &footprint, size[2])
            && self.keeps_ways_open(&footprint);
        fits.then(|| self.add_piece(kind, footprint, 0, size[2], wall))
    }

    /// The colours of the last `count` pieces of a kind.
    pub(super) fn last_colours(&self, kind: FurnitureKind, count: usize) -> Vec<Colour> {
        let alike = self.pieces.iter().rev().filter(|piece| piece.kind == kind);
        alike.take(count).map(|piece| piece.colour).collect()
    }

    /// Takes the last piece away again.
    pub(super) fn forget_last(&mut self) {
        self.pieces.pop();
    }

    /// Whether a piece (other than a flat one) or the floor in front of an opening overlaps an area.
    pub(super) fn overlaps_any(&self, area: &RectCm) -> bool {
        self.pieces.iter().any(|piece| !piece.kind.is_flat() && piece.footprint.overlaps(area))
            || self.doorsteps.iter().any(|step| step.overlaps(area))
    }

    /// The wall with the front door, and the point 50 cm in front of the door.
    pub(super) fn front_doorstep(&self) -> Option<(WallSide, (i32, i32))> {
        let span = self.front_door?;
        let wall = self.room.outline.wall_of(&span)?;
        let ((x, y), (dx, dy)) = (span.middle(), wall.inward());
        Some((wall, (x + dx * 50, y + dy * 50)))
    }

    /// The four walls in random order.
    pub(super) fn shuffled_walls(&mut self) -> [WallSide; 4] {
        let mut walls = WallSide::ALL;
        self.dice.shuffle(&mut walls);
        walls
    }

    /// Walls in random order, those without openings first.
    pub(super) fn quiet_walls(&mut self) -> Vec<WallSide> {
        let mut walls = self.shuffled_walls().to_vec();
        walls.sort_by_key(|wall| self.holes.iter().filter(|span| self.is_span_on_wall(*wall, span)).count());
        walls
    }

    /// Whether a span lies on this wall of the room.
    fn is_span_on_wall(&self, wall: WallSide, span: &SpanCm) -> bool {
        self.room.outline.wall_of(span) == Some(wall)
    }

    /// The places along a wall at which a piece of this width fits, in the order in which they are tried.
    fn wall_offsets(&mut self, wall: WallSide, width: i32, along: WallPreference) -> Vec<i32> {
        let edge = self.inner.edge_at(wall);
        let spare = edge.length() - width;
        if spare < 0 {
            return Vec::new();
        }
        let mut offsets: Vec<i32> = (0..=spare / 5).map(|step| step * 5).chain([spare]).collect();
        match along {
            WallPreference::Middle => offsets.sort_by_key(|offset| ((2 * offset - spare).abs(), *offset)),
            WallPreference::Ends => offsets.sort_by_key(|offset| ((*offset).min(spare - offset), *offset)),
            WallPreference::Anywhere => self.dice.shuffle(&mut offsets),
        }
        offsets.into_iter().map(|offset| edge.from + offset).collect()
    }

    /// The footprint of a piece that has its back to a wall, from `from` along it.
    pub(super) fn footprint_at_wall(&self, wall: WallSide, from: i32, [width, depth, _]: [i32; 3]) -> RectCm {
        let edge = self.inner.edge_at(wall);
        let area = SpanCm { from, to: from + width, ..edge }.thickened_by(0);
        let (dx, dy) = wall.inward();
        RectCm::new(
            area.x0 + depth * dx.min(0),
            area.y0 + depth * dy.min(0),
            area.x1 + depth * dx.max(0),
            area.y1 + depth * dy.max(0),
        )
    }

    /// The floor in front of a piece, `depth` centimetres deep.
    pub(super) fn floor_in_front(&self, footprint: RectCm, wall: WallSide, depth: i32) -> RectCm {
        match wall {
            WallSide::North => RectCm::new(footprint.x0, footprint.y0 - depth, footprint.x1, footprint.y0),
            WallSide::South => RectCm::new(footprint.x0, footprint.y1, footprint.x1, footprint.y1 + depth),
            WallSide::West => RectCm::new(footprint.x1, footprint.y0, footprint.x1 + depth, footprint.y1),
            WallSide::East => RectCm::new(footprint.x0 - depth, footprint.y0, footprint.x0, footprint.y1),
        }
    }

    /// Whether a piece at a wall would reach more than 25 cm above the sill of a window there.
    fn blinds_window(&self, wall: WallSide, footprint: &RectCm, height: i32) -> bool {
        let covers = |span: &SpanCm| self.is_span_on_wall(wall, span) && span.thickened_by(20).overlaps(footprint);
        self.windows.iter().any(|(span, sill)| *sill < height - 25 && covers(span))
    }

    /// Whether a piece fits here, with the free floor `before` it.
    fn is_free(&self, footprint: &RectCm, before: &RectCm) -> bool {
        self.inner.contains(footprint)
            && self.inner.contains(before)
            && !self.touches_fixed(footprint)
            && !self.reserved.iter().any(|area| area.overlaps(footprint))
            && !self.standing_footprints().any(|area| area.overlaps(before))
            && self.keeps_ways_open(footprint)
    }

    /// Whether a footprint overlaps a doorstep, an open door or another piece.
    fn touches_fixed(&self, footprint: &RectCm) -> bool {
        self.doorsteps.iter().chain(&self.leaves).any(|area| area.overlaps(footprint))
            || self.standing_footprints().any(|area| area.overlaps(footprint))
    }

    /// Footprints of the pieces that take floor.
    fn standing_footprints(&self) -> impl Iterator<Item = RectCm> + '_ {
        // A piece that begins higher than this, such as a cabinet on the wall, takes no floor.
        let low = self.room.base_cm() + 150;
        let takes_floor = move |piece: &&FurniturePiece| {
            !piece.kind.is_flat() && !piece.kind.is_slim_on_wall() && piece.base_cm < low
        };
        self.pieces.iter().filter(takes_floor).map(|piece| piece.footprint)
    }

    /// Whether all doors can still be reached if a piece is placed here.
    fn keeps_ways_open(&self, footprint: &RectCm) -> bool {
        let obstacles: Vec<_> =
            self.standing_footprints().chain(self.leaves.iter().copied()).chain([*footprint]).collect();
        reachable_floor::ways_stay_open(&self.inner, &obstacles, &self.doorsteps)
    }

    /// Puts a small thing on top of a piece, `shift` centimetres along it from its middle and `forward` from its middle
    /// towards its front.
    pub(super) fn place_on_top(
        &mut self,
        below: PieceIndex,
        kind: FurnitureKind,
        shift: i32,
        forward: i32,
    ) -> PieceIndex {
        let [width, depth, height] = kind.size_cm(&mut self.dice);
        let (wall, base) = (self.wall_behind(below), self.pieces[below].base_cm + self.pieces[below].height_cm);
        let (cx, cy) = self.pieces[below].footprint.centre();
        let (fx, fy) = wall.inward();
        // Along the wall, counter-clockwise from its inward normal.
        let (ax, ay) = (-fy, fx);
        let (x, y) = (cx + ax * shift + fx * forward, cy + ay * shift + fy * forward);
        let (w, d) = if wall.along_x() { (width, depth) } else { (depth, width) };
        let footprint = RectCm::new(x - w / 2, y - d / 2, x - w / 2 + w, y - d / 2 + d);
        self.add_piece(kind, footprint, base - self.room.base_cm(), height, wall)
    }

    /// Lays a flat piece on the floor, centred on a point, and cuts it at the walls.
    pub(super) fn lay_flat(
        &mut self,
        kind: FurnitureKind,
        (x, y): (i32, i32),
        [width, depth, height]: [i32; 3],
        wall: WallSide,
    ) -> Option<PieceIndex> {
        let (w, d) = if wall.along_x() { (width, depth) } else { (depth, width) };
        let wanted = RectCm::new(x - w / 2, y - d / 2, x - w / 2 + w, y - d / 2 + d);
        let inner = self.inner.inset(8);
        let cut = RectCm::new(
            wanted.x0.max(inner.x0),
            wanted.y0.max(inner.y0),
            wanted.x1.min(inner.x1),
            wanted.y1.min(inner.y1),
        );
        (cut.width() > 40 && cut.depth() > 40).then(|| self.add_piece(kind, cut, 0, height, wall))
    }

    /// Hangs a lamp from the middle of the ceiling.
    pub(super) fn hang_from_ceiling(&mut self, kind: FurnitureKind) -> PieceIndex {
        let [width, depth, height] = kind.size_cm(&mut self.dice);
        let (x, y) = self.inner.centre();
        let footprint = RectCm::new(x - width / 2, y - depth / 2, x - width / 2 + width, y - depth / 2 + depth);
        self.add_piece(kind, footprint, CEILING_CM - height, height, WallSide::North)
    }

    /// Whether a stretch of wall between two heights is free: no opening, no window and no piece is there. A `slim` thing may
    /// also hang where people walk past it, next to a door.
    pub(super) fn wall_is_bare(&self, wall: WallSide, area: &RectCm, base: i32, top: i32, slim: bool) -> bool {
        let hole = self
            .holes
            .iter()
            .any(|span| self.is_span_on_wall(wall, span) && span.thickened_by(MIN_GAP_TO_OPENING_CM).overlaps(area));
        let window = self.windows.iter().any(|(span, sill)| {
            self.is_span_on_wall(wall, span) && span.thickened_by(MIN_GAP_TO_OPENING_CM).overlaps(area) && *sill < top
        });
        let floor = self.room.base_cm();
        let piece = self.pieces.iter().any(|piece| {
            let (low, high) = (piece.base_cm - floor, piece.base_cm - floor + piece.height_cm);
            low < top && base < high && piece.footprint.inset(-MIN_HANGING_GAP_CM).overlaps(area)
        });
        // A person who comes in would run into a deep piece, but not into a picture.
        let blocked = if slim {
            self.leaves.iter().any(|leaf| leaf.inset(-MIN_GAP_TO_LEAF_CM).overlaps(area))
        } else {
            self.doorsteps.iter().any(|step| step.overlaps(area))
        };
        !(hole || window || piece || blocked)
    }
}
