//! Hangs pictures, mirrors, cloths and coats on the stretches of wall that furniture leaves bare.
//!
//! Each wall is searched in three bands of height. Bare stretches of a band are filled with things side by side.

use super::super::{
    catalogue::FurnitureKind as K,
    model::RoomKind,
    rect::{RectCm, WallSide},
};
use super::placing::RoomFurnisher;

/// Distance between two hanging things side by side, and to a room's corner, centimetres.
const GAP_CM: i32 = 9;
/// Width of the strips in which a wall is searched, centimetres.
const STRIP_CM: i32 = 5;
/// The narrowest stretch of wall that gets a hanging, centimetres.
const NARROWEST_CM: i32 = 36;

/// A hanging thing gets a colour that this many things of its kind before it do not have.
const LIKE_COLOURS_APART_PIECES: usize = 4;
/// How often another colour is drawn to achieve this; the last colour then stays, even if it repeats.
const MAX_COLOUR_DRAWS: usize = 8;

/// The bands of height for hanging things, centimetres above the floor: over the bare floor, over low furniture, and over
/// high furniture.
const WALL_BANDS: [WallBand; 3] =
    [WallBand { base: 58, top: 226 }, WallBand { base: 116, top: 226 }, WallBand { base: 160, top: 226 }];

/// Lower and upper edge of a band of height.
#[derive(Debug, Clone, Copy)]
struct WallBand {
    base: i32,
    top: i32,
}

/// The things that may hang in a kind of room, each with its share in percent; the shares of a room sum to 100.
fn usual_hangings(kind: RoomKind) -> &'static [(K, i32)] {
    match kind {
        RoomKind::Hallway | RoomKind::Entryway | RoomKind::Staircase => {
            &[(K::Photos, 28), (K::Painting, 34), (K::Tapestry, 14), (K::Mirror, 10), (K::CoatHooks, 14)]
        }
        RoomKind::Bathroom => &[(K::Mirror, 25), (K::Towel, 35), (K::Painting, 40)],
        RoomKind::Closet | RoomKind::LaundryRoom => &[(K::CoatHooks, 45), (K::Painting, 25), (K::Towel, 30)],
        RoomKind::Garage => &[(K::ToolBoard, 70), (K::BulletinBoard, 30)],
        RoomKind::Office => &[(K::BulletinBoard, 22), (K::Photos, 28), (K::Painting, 40), (K::Tapestry, 10)],
        RoomKind::Kitchen => &[(K::Painting, 50), (K::BulletinBoard, 20), (K::Photos, 30)],
        RoomKind::Bedroom => &[(K::Painting, 40), (K::Photos, 24), (K::Tapestry, 22), (K::Mirror, 14)],
        RoomKind::LivingRoom | RoomKind::DiningRoom => {
            &[(K::Painting, 46), (K::Photos, 26), (K::Tapestry, 14), (K::Mirror, 14)]
        }
    }
}

/// Least and greatest usual width of a hanging thing, and its greatest height, centimetres.
fn hanging_size(kind: K) -> ([i32; 2], i32) {
    match kind {
        K::Mirror => ([46, 74], 150),
        K::Towel => ([44, 64], 110),
        K::Tapestry => ([80, 130], 166),
        K::Photos => ([56, 190], 160),
        K::CoatHooks => ([70, 130], 150),
        K::ToolBoard => ([90, 180], 130),
        K::BulletinBoard => ([80, 140], 110),
        _ => ([48, 112], 140),
    }
}

impl RoomFurnisher<'_> {
    /// Covers bare walls, one band of height after another.
    pub(super) fn dress_walls(&mut self) {
        for wall in WallSide::ALL {
            for band in WALL_BANDS {
                for (from, to) in self.bare_runs(wall, band) {
                    self.fill_run(wall, band, from, to);
                }
            }
        }
    }

    /// The stretches of a wall that are bare in a band of height.
    fn bare_runs(&self, wall: WallSide, band: WallBand) -> Vec<(i32, i32)> {
        let edge = self.inner.edge_at(wall);
        let mut runs: Vec<(i32, i32)> = Vec::new();
        let (from, to) = (edge.from + GAP_CM, edge.to - GAP_CM);
        for at in (from..to - STRIP_CM).step_by(STRIP_CM as usize) {
            let strip = self.footprint_at_wall(wall, at, [STRIP_CM, 4, 0]);
            if !self.wall_is_bare(wall, &strip, band.base, band.top, true) {
                continue;
            }
            match runs.last_mut() {
                Some((_, end)) if *end == at => *end = at + STRIP_CM,
                _ => runs.push((at, at + STRIP_CM)),
            }
        }
        runs.retain(|(from, to)| to - from >= NARROWEST_CM);
        runs
    }

    /// Hangs things side by side, at equal distances.
    fn fill_run(&mut self, wall: WallSide, band: WallBand, from: i32, to: i32) {
        let mut chosen: Vec<(K, i32)> = Vec::new();
        let mut free_cm = to - from;
        while free_cm >= NARROWEST_CM {
            let last = chosen.last().map(|(kind, _)| *kind);
            let (kind, width) = self.choose_hanging(free_cm, last);
            free_cm -= width + GAP_CM;
            chosen.push((kind, width));
        }
        let gap = (free_cm + GAP_CM) / (chosen.len() as i32 + 1);
        let mut at = from + gap;
        for (kind, width) in chosen {
            let band_height = band.top - band.base;
            let height = hanging_size(kind).1.min(band_height);
            // Coats and cloths hang down from the top; pictures have their middle at the height of the eyes.
            let spare = band_height - height;
            let base =
                band.base + if matches!(kind, K::CoatHooks | K::Tapestry | K::Towel) { spare } else { spare / 2 };
            let depth = kind.entry().size_cm[1];
            let area = self.footprint_at_wall(wall, at, [width, depth, height]);
            self.hang_apart(kind, area, base, height, wall);
            at += width + GAP_CM + gap.max(0);
        }
    }

    /// Hangs a thing in a colour that the last things of its kind do not have, so that no two like pictures hang side by side.
    pub(super) fn hang_apart(&mut self, kind: K, area: RectCm, base: i32, height: i32, wall: WallSide) {
        let before = self.last_colours(kind, LIKE_COLOURS_APART_PIECES);
        let piece = self.add_piece(kind, area, base, height, wall);
        for _ in 0..MAX_COLOUR_DRAWS {
            if !before.contains(&self.piece_at(piece).colour) {
                return;
            }
            let colour = kind.draw_colour(&mut self.dice);
            self.set_colour(piece, colour);
        }
    }

    /// Chooses a thing that fits into the free width and differs from its neighbour. Returns it with its width.
    fn choose_hanging(&mut self, free_cm: i32, neighbour: Option<K>) -> (K, i32) {
        let fits = |kind: K| hanging_size(kind).0[0] <= free_cm && Some(kind) != neighbour;
        let fitting: Vec<_> = usual_hangings(self.room.kind).iter().filter(|(kind, _)| fits(*kind)).collect();
        let mut drawn = self.dice.draw_between(1, fitting.iter().map(|(_, share)| share).sum());
        let mut is_drawn = |share: i32| {
            drawn -= share;
            drawn <= 0
        };
        // A picture can be as narrow as the rest of the stretch.
        let kind = fitting.iter().find(|(_, share)| is_drawn(*share)).map_or(K::Painting, |(kind, _)| *kind);
        let [least, most] = hanging_size(kind).0;
        let width = self.dice.draw_stepped(least.min(free_cm), most.min(free_cm), 2);
        // If the rest would be too narrow for another thing, this one takes it too.
        let rest = free_cm - width - GAP_CM;
        (kind, if rest < NARROWEST_CM && free_cm <= most { free_cm } else { width })
    }
}
