//! Chooses the direction of the sun for a house, and finds how it shines into a room through the windows.

use super::{
    super::{
        dice::HouseDice,
        model::{HALF_WALL_CM, House, HouseWindow},
    },
    casters::{ShadowBlock, blocked_share},
    to_metres,
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
    let mut dice = HouseDice::new(house.seed, &["sun"]);
    let (x, y) = dice.pick([(1.0, 2.0), (2.0, 1.0), (2.0, 3.0), (3.0, 2.0)]);
    let rise = dice.draw_between(48, 80) as f32 / 100.0;
    let quarters = [(x, y), (-x, y), (-x, -y), (x, -y)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let lit = quarters.map(|level| sunny_window_cm2(house, level));
    let most = lit.iter().copied().max().unwrap_or(0);
    let mut good: Vec<Vec3> =
        quarters.iter().zip(lit).filter(|(_, area)| area * 4 >= most * 3).map(|(way, _)| *way).collect();
    dice.shuffle(&mut good);
    let level = good.first().copied().unwrap_or(quarters[0]);
    (level + Vec3::Z * level.length() * rise).normalize_or_zero()
}

/// Area of the windows that face the sun, square centimetres.
fn sunny_window_cm2(house: &House, sun: Vec3) -> i64 {
    let faces = |window: &&HouseWindow| {
        let wall = house.rooms[window.room].outline.wall_of(&window.span);
        wall.is_some_and(|wall| {
            let (dx, dy) = wall.inward();
            sun.x * dx as f32 + sun.y * (dy as f32) < 0.0
        })
    };
    let area = |window: &HouseWindow| i64::from(window.span.length()) * i64::from(window.head_cm - window.sill_cm);
    house.windows.iter().filter(faces).map(area).sum()
}

/// A window through which the sun shines.
#[derive(Debug)]
pub(super) struct SunAperture {
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

impl SunAperture {
    /// The sunlit opening of a window; `None` if the window faces away from the sun. `inward` points from the wall into the
    /// room.
    pub(super) fn for_window(window: &HouseWindow, inward: (i32, i32), sun: Vec3) -> Option<Self> {
        let step = inward.0 + inward.1;
        let out = Vec3::new(-inward.0 as f32, -inward.1 as f32, 0.0);
        let span = window.span;
        let bar_cm = window.sill_cm + (window.head_cm - window.sill_cm) * 62 / 100;
        (out.dot(sun) > 0.0).then(|| Self {
            along_x: span.along_x,
            planes: [to_metres(span.at), to_metres(span.at + step * HALF_WALL_CM)],
            along: [to_metres(span.from + 2), to_metres(span.to - 2)],
            z: [to_metres(window.sill_cm), to_metres(window.head_cm - 2)],
            bar_z: to_metres(bar_cm),
        })
    }

    /// The point where the line from a place to the sun crosses the pane, and how much of the sun passes the window, 0..=1.
    /// `None` if the line misses the window.
    pub(super) fn sun_through(&self, at: Vec3, sun: Vec3) -> Option<(Vec3, f32)> {
        let [pane, inner] = self.planes.map(|plane| self.plane_crossing(at, sun, plane));
        let (pane, inner) = (pane?, inner.unwrap_or(at));
        let share = self.inside_share(pane) * self.inside_share(inner) * self.between_bars(pane);
        (share > 0.0).then_some((pane, share))
    }

    /// Where the line from a place to the sun crosses a plane along the wall; `None` if the plane lies behind the place.
    fn plane_crossing(&self, at: Vec3, sun: Vec3, plane: f32) -> Option<Vec3> {
        let (from, speed) = if self.along_x { (at.y, sun.y) } else { (at.x, sun.x) };
        let steps = (plane - from) / speed;
        (steps > 0.0).then(|| at + sun * steps)
    }

    fn place_along_wall(&self, at: Vec3) -> f32 {
        if self.along_x { at.x } else { at.y }
    }

    /// How much of the sun passes the window's frame at this point, 0..=1.
    fn inside_share(&self, at: Vec3) -> f32 {
        let within =
            |value: f32, [low, high]: [f32; 2]| (((value - low).min(high - value)) / SOFT_M + 0.5).clamp(0.0, 1.0);
        within(self.place_along_wall(at), self.along) * within(at.z, self.z)
    }

    /// How much of the sun passes the window's two bars: 0.15 behind a bar, 1 beside it, and a soft edge between.
    fn between_bars(&self, pane: Vec3) -> f32 {
        let middle = (self.along[0] + self.along[1]) / 2.0;
        let past = |distance: f32| (0.15 + (distance.abs() - HALF_BAR_M) / SOFT_M).clamp(0.15, 1.0);
        past(self.place_along_wall(pane) - middle) * past(pane.z - self.bar_z)
    }
}

/// The other rooms of a house, as boxes that can lie between a window and the sun.
pub(super) fn build_wings(house: &House, index: usize) -> Vec<ShadowBlock> {
    let others = house.rooms.iter().enumerate().filter(|(other, _)| *other != index);
    let block = |(_, room): (usize, &super::super::model::HouseRoom)| {
        let (area, base) = (room.outline, room.base_cm());
        ShadowBlock {
            owner: 0,
            low: Vec3::new(to_metres(area.x0), to_metres(area.y0), to_metres(base)),
            high: Vec3::new(to_metres(area.x1), to_metres(area.y1), to_metres(base + room.height_cm)),
        }
    };
    others.map(block).collect()
}

/// Whether the sun reaches a place on a pane past the other rooms.
pub(super) fn sun_reaches_pane(wings: &[ShadowBlock], pane: Vec3, sun: Vec3) -> bool {
    blocked_share(wings, None, pane, sun * FAR_M, 0.2) < 0.5
}
