//! Computes the light of a room from its sun, windows and lamps, with the shadows of furniture. The light is baked: it is
//! stored once at the corners of the meshes, so that drawing needs no lamps.
//!
//! The renderer multiplies gamma-encoded colours. So light is computed linearly, and its square root is stored (a gamma
//! of 2, which needs no mathematics library).

mod casters;
mod cut;
mod sun;

use super::model::{House, HouseRoom, HouseWindow};
use casters::{ShadowBlock, blocked_share, shadow_blocks};
pub(super) use cut::{LightFactors, SurfaceGrain, cut_part};
use glam::Vec3;
use sun::{SunAperture, build_wings, sun_reaches_pane, towards_sun};

/// The light that reaches every surface, also without lamps and windows. Light of 1 shows a surface in its own colour.
const AMBIENT_LIGHT: f32 = 0.30;
/// How far the shadow of an inner edge reaches, metres.
const EDGE_M: f32 = 0.55;
/// How far the dark rim around a piece of furniture reaches, metres.
const CONTACT_M: f32 = 0.25;
/// Sunlight that falls at a right angle onto a surface.
const DIRECT_SUNLIGHT: f32 = 1.5;
/// Most light that a surface gets.
const MAX_LIGHT: f32 = 1.8;
/// Light fainter than this casts no shadow, which saves the search for obstacles.
const MIN_SHADOWED_LIGHT: f32 = 0.02;
/// The strength of lamps in a room with windows: by day they add less.
const LAMPS_BY_DAY: f32 = 0.6;
/// Light of a lamp or a window is blocked fully after this length within a piece, metres. Shorter stretches block a part
/// of it, which makes shadows soft.
const SOFT_M: f32 = 0.12;

/// The light of one room.
#[derive(Debug)]
pub(super) struct RoomLight {
    /// Lower and upper corner of the space between the walls, metres, world frame.
    low: Vec3,
    high: Vec3,
    /// Where the lamps are.
    lamps: Vec<Vec3>,
    windows: Vec<WindowLight>,
    /// The boxes that cast shadows.
    blocks: Vec<ShadowBlock>,
    /// Unit vector towards the sun.
    sun: Vec3,
    /// The windows through which the sun shines.
    apertures: Vec<SunAperture>,
    /// The other rooms of the house, which can lie between a window and the sun.
    wings: Vec<ShadowBlock>,
}

/// A window as a source of soft light.
#[derive(Debug)]
struct WindowLight {
    middle: Vec3,
    inward: Vec3,
    /// Three places on the pane, from which light is taken to come.
    places: [Vec3; 3],
    area_m2: f32,
}

fn to_metres(cm: i32) -> f32 {
    cm as f32 / 100.0
}

impl WindowLight {
    fn for_window(window: &HouseWindow, (dx, dy): (i32, i32)) -> Self {
        let (span, z) = (window.span, [window.sill_cm, window.head_cm]);
        let place = |along: i32, height: i32| {
            let share =
                |from: i32, to: i32, percent: i32| to_metres(from) + to_metres(to - from) * percent as f32 / 100.0;
            let (along, at) = (share(span.from, span.to, along), to_metres(span.at));
            let (x, y) = if span.along_x { (along, at) } else { (at, along) };
            Vec3::new(x, y, share(z[0], z[1], height))
        };
        Self {
            middle: place(50, 50),
            inward: Vec3::new(dx as f32, dy as f32, 0.0),
            places: [place(20, 30), place(80, 30), place(50, 75)],
            area_m2: to_metres(span.length()) * to_metres(z[1] - z[0]),
        }
    }
}

impl RoomLight {
    pub(super) fn for_room(house: &House, index: usize) -> Self {
        let room = &house.rooms[index];
        let inner = room.inner_area();
        let low = Vec3::new(to_metres(inner.x0), to_metres(inner.y0), to_metres(room.base_cm()));
        let high = Vec3::new(to_metres(inner.x1), to_metres(inner.y1), to_metres(room.base_cm() + room.height_cm));
        let sun = towards_sun(house);
        let windows = house.windows.iter().filter(|window| window.room == index);
        let windows = windows.filter_map(|window| Some((window, room.outline.wall_of(&window.span)?.inward())));
        Self {
            low,
            high,
            lamps: place_lamps(room, low, high),
            windows: windows.clone().map(|(window, inward)| WindowLight::for_window(window, inward)).collect(),
            blocks: house.furniture.iter().filter(|piece| piece.room == index).flat_map(shadow_blocks).collect(),
            sun,
            apertures: windows.filter_map(|(window, inward)| SunAperture::for_window(window, inward, sun)).collect(),
            wings: build_wings(house, index),
        }
    }

    /// Factors for a corner of the room's shell, which furniture shades.
    pub(super) fn on_shell(&self, at: Vec3, normal: Vec3) -> LightFactors {
        let shade = self.blocks.iter().map(|block| {
            let distance = (at - at.clamp(block.low, block.high)).length();
            1.0 - 0.3 * fade_out(distance, CONTACT_M)
        });
        self.light_factors(at, normal, None, shade.product::<f32>().max(0.5))
    }

    /// Factors for a corner of something in the room. A piece of furniture (`own` is its number) is not shaded by its own
    /// boxes, which are coarser than its shape.
    pub(super) fn on_thing(&self, at: Vec3, normal: Vec3, own: Option<u32>) -> LightFactors {
        self.light_factors(at, normal, own, 1.0)
    }

    /// All light at a place with a normal, per channel, encoded for storage. `shade` dims everything but the sun.
    fn light_factors(&self, at: Vec3, normal: Vec3, own: Option<u32>, shade: f32) -> LightFactors {
        let ambient = AMBIENT_LIGHT * (0.8 + 0.12 * normal.z + 0.1 * normal.x.abs());
        let strength = if self.windows.is_empty() { 1.0 } else { LAMPS_BY_DAY };
        let lamps: f32 = self.lamps.iter().map(|lamp| self.lamplight(at, normal, own, *lamp) * strength).sum();
        let windows: f32 = self.windows.iter().map(|window| self.daylight(at, normal, own, window)).sum();
        let sun = self.sunlight(at, normal, own);
        let dim = shade * self.edge_shadow(at, normal);
        // Sun and lamps are warm, windows cool.
        let channel = |warm: f32, cool: f32, sunny: f32| {
            ((ambient + lamps * warm + windows * cool) * dim + sun * sunny).clamp(0.02, MAX_LIGHT).sqrt()
        };
        [channel(1.03, 0.97, 1.06), channel(1.0, 1.0, 1.0), channel(0.93, 1.05, 0.84)]
    }

    /// Direct sun on a surface, through the windows.
    fn sunlight(&self, at: Vec3, normal: Vec3, own: Option<u32>) -> f32 {
        let facing = normal.dot(self.sun);
        if facing <= 0.0 {
            return 0.0;
        }
        let through = self.apertures.iter().find_map(|aperture| aperture.sun_through(at, self.sun));
        through.map_or(0.0, |(pane, share)| {
            if !sun_reaches_pane(&self.wings, pane, self.sun) {
                return 0.0;
            }
            DIRECT_SUNLIGHT * facing * share * (1.0 - blocked_share(&self.blocks, own, at, pane - at, 0.06))
        })
    }

    /// Soft light from a window, dimmed by the furniture between.
    fn daylight(&self, at: Vec3, normal: Vec3, own: Option<u32>, window: &WindowLight) -> f32 {
        let towards = window.middle - at;
        let distance_sq = towards.length_squared().max(0.04);
        let direction = towards / distance_sq.sqrt();
        let facing = (normal.dot(direction) * 0.85 + 0.15).max(0.0) * (-direction.dot(window.inward)).max(0.0);
        let full = 1.2 * window.area_m2 * facing / (1.2 + distance_sq);
        if full <= MIN_SHADOWED_LIGHT {
            return full;
        }
        let blocked = window.places.map(|place| blocked_share(&self.blocks, own, at, place - at, SOFT_M));
        full * (1.0 - 0.9 * blocked.iter().sum::<f32>() / 3.0)
    }

    fn lamplight(&self, at: Vec3, normal: Vec3, own: Option<u32>, lamp: Vec3) -> f32 {
        let full = lamp_strength(at, normal, lamp);
        if full <= MIN_SHADOWED_LIGHT {
            full
        } else {
            full * (1.0 - 0.9 * blocked_share(&self.blocks, own, at, lamp - at, SOFT_M))
        }
    }

    /// Shadow near the shell's inner edges, except at the face on which the corner itself lies.
    fn edge_shadow(&self, at: Vec3, normal: Vec3) -> f32 {
        let near = |distance: f32, facing: f32| {
            let is_own_face = facing > 0.5 && distance < 0.02;
            if is_own_face { 1.0 } else { 1.0 - 0.26 * fade_out(distance.max(0.0), EDGE_M) }
        };
        near(at.x - self.low.x, normal.x)
            * near(self.high.x - at.x, -normal.x)
            * near(at.y - self.low.y, normal.y)
            * near(self.high.y - at.y, -normal.y)
            * near(at.z - self.low.z, normal.z)
            * near(self.high.z - at.z, -normal.z)
    }
}

/// From 1 at distance 0 to 0 at `reach`.
fn fade_out(distance: f32, reach: f32) -> f32 {
    let remaining = (1.0 - distance / reach).max(0.0);
    remaining * remaining
}

/// The light of a lamp at a place with a normal, without shadows.
fn lamp_strength(at: Vec3, normal: Vec3, lamp: Vec3) -> f32 {
    let towards = lamp - at;
    let distance_sq = towards.length_squared().max(0.01);
    let facing = (normal.dot(towards) / distance_sq.sqrt() * 0.75 + 0.25).max(0.0);
    1.5 * facing / (1.4 + distance_sq * 0.55)
}

/// One lamp in the middle of the ceiling, several in long rooms, and one above each floor of a staircase.
fn place_lamps(room: &HouseRoom, low: Vec3, high: Vec3) -> Vec<Vec3> {
    let (middle, size) = ((low + high) / 2.0, high - low);
    let count = ((size.x.max(size.y) / 3.2) as usize).clamp(1, 4);
    let along = if size.x > size.y { Vec3::X * size.x } else { Vec3::Y * size.y };
    let heights = if room.height_cm > 400 { vec![high.z - 0.5, low.z + 2.4] } else { vec![high.z - 0.5] };
    let place = |step: usize, z: f32| {
        let offset = (step as f32 + 0.5) / count as f32 - 0.5;
        Vec3::new(middle.x, middle.y, z) + along * offset
    };
    heights.iter().flat_map(|z| (0..count).map(move |step| place(step, *z))).collect()
}

#[cfg(test)]
mod tests;
