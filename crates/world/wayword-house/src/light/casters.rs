//! Turns each piece of furniture into a few boxes that cast its shadow, and measures how much light they block.

use super::{
    super::{
        catalogue::FurnitureKind,
        model::FurniturePiece,
        rect::{RectCm, WallSide},
    },
    to_metres,
};
use glam::Vec3;

/// A box that light does not pass, metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShadowBlock {
    /// Number of the piece that it belongs to; 0 for none.
    pub(super) owner: u32,
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

/// Thickness of the boxes of table tops and seats, centimetres: more than the real thickness, because only a long stretch
/// within a box blocks all light of a lamp.
const SHADOW_TOP_CM: i32 = 10;

/// The boxes of a piece. There are none for a piece that is flat, hangs on a wall, is made of glass, or is a lamp at the
/// ceiling.
pub(super) fn shadow_blocks(piece: &FurniturePiece) -> Vec<ShadowBlock> {
    use FurnitureKind as K;
    let (area, height) = (piece.footprint, piece.height_cm);
    let boxed = |area: RectCm, low: i32, high: i32| ShadowBlock {
        owner: piece.id,
        low: Vec3::new(to_metres(area.x0), to_metres(area.y0), to_metres(piece.base_cm + low)),
        high: Vec3::new(to_metres(area.x1), to_metres(area.y1), to_metres(piece.base_cm + high)),
    };
    let back = |part: i32| back_strip(&area, piece.quarter_turns, part);
    let legs = |high: i32| leg_footprints(&area).map(|foot| boxed(foot, 0, high));
    let middle = |percent: i32| {
        let (dx, dy) = (area.width() * (100 - percent) / 200, area.depth() * (100 - percent) / 200);
        RectCm::new(area.x0 + dx, area.y0 + dy, area.x1 - dx, area.y1 - dy)
    };
    match piece.kind {
        K::CeilingLight | K::Chandelier | K::Shower => Vec::new(),
        kind if kind.is_flat() || kind.is_slim_on_wall() => Vec::new(),
        K::CoffeeTable
        | K::DiningTable
        | K::SideTable
        | K::ConsoleTable
        | K::Desk
        | K::Workbench
        | K::IroningBoard
        | K::BarStool
        | K::Bench => {
            let mut all = vec![boxed(area, height - SHADOW_TOP_CM, height)];
            all.extend(legs(height - SHADOW_TOP_CM));
            all
        }
        K::Chair | K::OfficeChair => {
            let seat = height / 2;
            let mut all = vec![boxed(area, seat - SHADOW_TOP_CM, seat), boxed(back(15), seat, height)];
            all.extend(legs(seat - SHADOW_TOP_CM));
            all
        }
        K::Sofa | K::Armchair | K::Toilet => vec![boxed(area, 0, height * 55 / 100), boxed(back(28), 0, height)],
        K::Bed => vec![boxed(area, 0, height * 55 / 100), boxed(back(5), 0, height)],
        K::Car => vec![boxed(area, 20, height * 60 / 100), boxed(middle(70), 20, height)],
        K::FloorLamp | K::TableLamp | K::CoatRack | K::Bicycle | K::ClothesRack => {
            vec![boxed(middle(30), 0, height)]
        }
        K::Plant | K::Vase | K::Globe => vec![boxed(middle(60), 0, height)],
        _ => vec![boxed(area, 0, height)],
    }
}

/// The strip at the back of a footprint, `percent` of its depth.
fn back_strip(area: &RectCm, quarter_turns: u8, percent: i32) -> RectCm {
    let wall = WallSide::ALL[usize::from(quarter_turns) % 4];
    let deep = (if wall.along_x() { area.depth() } else { area.width() }) * percent / 100;
    match wall {
        WallSide::North => RectCm::new(area.x0, area.y1 - deep, area.x1, area.y1),
        WallSide::South => RectCm::new(area.x0, area.y0, area.x1, area.y0 + deep),
        WallSide::West => RectCm::new(area.x0, area.y0, area.x0 + deep, area.y1),
        WallSide::East => RectCm::new(area.x1 - deep, area.y0, area.x1, area.y1),
    }
}

/// Four legs of 6 cm at a footprint's corners.
fn leg_footprints(area: &RectCm) -> [RectCm; 4] {
    let leg = |x: i32, y: i32| RectCm::new(x, y, x + 6, y + 6);
    [(area.x0, area.y0), (area.x1 - 6, area.y0), (area.x0, area.y1 - 6), (area.x1 - 6, area.y1 - 6)]
        .map(|(x, y)| leg(x, y))
}

/// The share of light that boxes block on the straight line from `from` to `from + way`, 0..=1. A stretch of `soft` metres
/// within a box blocks all of it and a shorter one a part, which makes the edge of the shadow soft. Boxes of the piece
/// `own` do not count.
pub(super) fn blocked_share(blocks: &[ShadowBlock], own: Option<u32>, from: Vec3, way: Vec3, soft: f32) -> f32 {
    let length = way.length();
    let per_step = way.recip();
    let mut passes = 1.0;
    let (low, high) = (from.min(from + way), from.max(from + way));
    let may_block =
        |block: &&ShadowBlock| low.cmplt(block.high).all() && high.cmpgt(block.low).all() && own != Some(block.owner);
    for block in blocks.iter().filter(may_block) {
        let (a, b) = ((block.low - from) * per_step, (block.high - from) * per_step);
        let enters = a.min(b).max_element().max(0.0);
        let leaves = a.max(b).min_element().min(1.0);
        if enters < leaves {
            passes *= 1.0 - ((leaves - enters) * length / soft).min(1.0);
            if passes <= 0.0 {
                return 1.0;
            }
        }
    }
    1.0 - passes
}
