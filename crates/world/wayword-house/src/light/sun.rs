//! Chooses the direction of the sun for a house, and finds how it shines into a room through the windows.

use super::{
    super::{
        dice::Dice,
        model::{HALF_WALL_CM, House, Window},
    },
    casters::{Block, blocked},
    metres,
};
use glam::Vec3;

/// Width over which the edge of a sun patch fades, metres: about as wide as the finest pieces of floor.
const SOFT_M: f32 = 0.04;
/// Half the width of a window's bars in the sun, metres.
const HALF_BAR_M: f32 = 0.02;
/// How far outside another part of the house can shade a window, metres.
const FAR_M: f32 = 40.0;

/// Unit vector towards the sun of a house. The sun shines on two sides of the house, never along a wall, and if possible on
/// sides that have many windows.
pub(in super::super) fn towards_sun(house: &House) -> Vec3 {
    let mut dice = Dice::new(house.seed, &["sun"]);
    let (x, y) = dice.pick([(1.0, 2.0), (2.0, 1.0), (2.0, 3.0), (3.0, 2.0)]);
    let rise = dice.between(48, 80) as f32 / 100.0;
    let quarters = [(x, y), (-x, y), (-x, -y), (x, -y)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let lit = quarters.map(|level| lit_cm2(house, level));
    let most = lit.iter().copied().max().unwrap_or(0);
    let mut good: Vec<Vec3> =
        quarters.iter().zip(lit).filter(|(_, area)| area * 4 >= most * 3).map(|(way, _)| *way).collect();
    dice.shuffle(&mut good);
    let level = good.first().copied().unwrap_or(quarters[0]);
    (level + Vec3::Z * level.length() * rise).normalize_or_zero()
}

/// Area of the windows that face the sun, square centimetres.
fn lit_cm2(house: &House, sun: Vec3) -> i64 {
    let faces = |window: &&Window| {
        let wall = house.rooms[window.room].outline.wall_of(&window.span);
        wall.is_some_and(|wall| {
            let (dx, dy) = wall.inward();
            sun.x * dx as f32 + sun.y * (dy as f32) < 0.0
        })
    };
    let area = |window: &Window| i64::from(window.span.length()) * i64::from(window.head_cm - window.sill_cm);
    house.windows.iter().filter(faces).map(area).sum()
}

/// A window through which the sun shines.
#[derive(Debug)]
pub(super) struct Aperture {
    along_x: bool,
    /// The pane and the inner face of the wall, on the axis across the wall, metres.
    planes: [f32; 2],
    /// Along the wall, metres.
    along: [f32; 2],
    /// Sill and head, metres.
    z: [f32; 2],
    /// Height of the bar across, metres.
    bar_z: f32,
}

impl Aperture {
    /// The sunlit opening of a window; `None` if the window faces away from the sun. `inward` points from the wall into the
    /// room.
    pub(super) fn of(window: &Window, inward: (i32, i32), sun: Vec3) -> Option<Self> {
        let step = inward.0 + inward.1;
        let out = Vec3::new(-inward.0 as f32, -inward.1 as f32, 0.0);
        let span = window.span;
        let bar_cm = window.sill_cm + (window.head_cm - window.sill_cm) * 62 / 100;
        (out.dot(sun) > 0.0).then(|| Self {
            along_x: span.along_x,
            planes: [metres(span.at), metres(span.at + step * HALF_WALL_CM)],
            along: [metres(span.from + 2), metres(span.to - 2)],
            z: [metres(window.sill_cm), metres(window.head_cm - 2)],
            bar_z: metres(bar_cm),
        })
    }

    /// The point where the line from a place to the sun crosses the pane, and how much of the sun passes the window, 0..=1.
    /// `None` if the line misses the window.
    pub(super) fn passes(&self, at: Vec3, sun: Vec3) -> Option<(Vec3, f32)> {
        let [pane, inner] = self.planes.map(|plane| self.crossing(at, sun, plane));
        let (pane, inner) = (pane?, inner.unwrap_or(at));
        let share = self.inside(pane) * self.inside(inner) * self.between_bars(pane);
        (share > 0.0).then_some((pane, share))
    }

    fn crossing(&self, at: Vec3, sun: Vec3, plane: f32) -> Option<Vec3> {
        let (from, speed) = if self.along_x { (at.y, sun.y) } else { (at.x, sun.x) };
        let steps = (plane - from) / speed;
        (steps > 0.0).then(|| at + sun * steps)
    }

    fn sideways(&self, at: Vec3) -> f32 {
        if self.along_x { at.x } else { at.y }
    }

    fn inside(&self, at: Vec3) -> f32 {
        let within =
            |value: f32, [low, high]: [f32; 2]| (((value - low).min(high - value)) / SOFT_M + 0.5).clamp(0.0, 1.0);
        within(self.sideways(at), self.along) * within(at.z, self.z)
    }

    fn between_bars(&self, pane: Vec3) -> f32 {
        let middle = (self.along[0] + self.along[1]) / 2.0;
        let past = |distance: f32| (0.15 + (distance.abs() - HALF_BAR_M) / SOFT_M).clamp(0.15, 1.0);
        past(self.sideways(pane) - middle) * past(pane.z - self.bar_z)
    }
}

/// The other rooms of a house, as boxes that can lie between a window and the sun.
pub(super) fn wings(house: &House, index: usize) -> Vec<Block> {
    let others = house.rooms.iter().enumerate().filter(|(other, _)| *other != index);
    let block = |(_, room): (usize, &super::super::model::Room)| {
        let (area, base) = (room.outline, room.base_cm());
        Block {
            owner: 0,
            low: Vec3::new(metres(area.x0), metres(area.y0), metres(base)),
            high: Vec3::new(metres(area.x1), metres(area.y1), metres(base + room.height_cm)),
        }
    };
    others.map(block).collect()
}

/// Whether the sun reaches a place on a pane past the other rooms.
pub(super) fn is_free(wings: &[Block], pane: Vec3, sun: Vec3) -> bool {
    blocked(wings, None, pane, sun * FAR_M, 0.2) < 0.5
}
