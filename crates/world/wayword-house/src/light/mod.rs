//! Light that is baked into mesh corners: from lamps and windows, with shadow at a room's edges and near furniture.
//!
//! The renderer multiplies colours as they are stored. So light is computed linearly, and its square root is stored (a
//! gamma of 2, which needs no mathematics library).

use super::model::{Furniture, House, Room};
use glam::Vec3;

/// Light of a room without any lamp.
const AMBIENT: f32 = 0.42;
/// How far the shadow of an inner edge reaches, metres.
const EDGE_M: f32 = 0.55;
/// How far the shadow of a piece of furniture reaches, metres.
const CONTACT_M: f32 = 0.4;

/// The light of one room.
pub(super) struct RoomLight {
    low: Vec3,
    high: Vec3,
    lamps: Vec<Vec3>,
    /// Middle, direction into the room, and area in square metres.
    windows: Vec<(Vec3, Vec3, f32)>,
    /// Boxes of the furniture that casts shadow: lower and upper corner, metres.
    boxes: Vec<(Vec3, Vec3)>,
}

fn metres(cm: i32) -> f32 {
    cm as f32 / 100.0
}

/// Lower and upper corner of a piece, metres.
fn bounds(piece: &Furniture) -> (Vec3, Vec3) {
    let area = piece.footprint;
    let top = piece.base_cm + piece.height_cm;
    (
        Vec3::new(metres(area.x0), metres(area.y0), metres(piece.base_cm)),
        Vec3::new(metres(area.x1), metres(area.y1), metres(top)),
    )
}

impl RoomLight {
    pub(super) fn of(house: &House, index: usize) -> Self {
        let room = &house.rooms[index];
        let inner = room.inner();
        let low = Vec3::new(metres(inner.x0), metres(inner.y0), metres(room.base_cm()));
        let high = Vec3::new(metres(inner.x1), metres(inner.y1), metres(room.base_cm() + room.height_cm));
        let pieces = || house.furniture.iter().filter(|piece| piece.room == index);
        let windows = house.windows.iter().filter(|window| window.room == index).filter_map(|window| {
            let (x, y) = window.span.middle();
            let (dx, dy) = room.outline.wall_of(&window.span)?.inward();
            let middle = Vec3::new(metres(x), metres(y), metres((window.sill_cm + window.head_cm) / 2));
            let area = metres(window.span.length()) * metres(window.head_cm - window.sill_cm);
            Some((middle, Vec3::new(dx as f32, dy as f32, 0.0), area))
        });
        let casts = |piece: &&Furniture| !piece.kind.is_flat() && !piece.kind.is_slim_on_wall();
        Self {
            low,
            high,
            lamps: lamps(room, low, high),
            windows: windows.collect(),
            boxes: pieces().filter(casts).map(bounds).collect(),
        }
    }

    /// Factors for a corner of the room's shell, which furniture shades.
    pub(super) fn on_shell(&self, at: Vec3, normal: Vec3) -> [f32; 3] {
        let shade = self.boxes.iter().map(|(low, high)| {
            let distance = (at - at.clamp(*low, *high)).length();
            1.0 - 0.5 * fading(distance, CONTACT_M)
        });
        self.factors(at, normal, shade.product::<f32>().max(0.35))
    }

    /// Factors for a corner of something in the room.
    pub(super) fn on_thing(&self, at: Vec3, normal: Vec3) -> [f32; 3] {
        self.factors(at, normal, 1.0)
    }

    fn factors(&self, at: Vec3, normal: Vec3, shade: f32) -> [f32; 3] {
        let toned = AMBIENT * (0.8 + 0.12 * normal.z + 0.1 * normal.x.abs());
        let lamps: f32 = self.lamps.iter().map(|lamp| lit(at, normal, *lamp)).sum();
        let windows: f32 = self.windows.iter().map(|window| self.daylight(at, normal, window)).sum();
        let dim = shade * self.edges(at, normal);
        // Lamps are warm, windows cool.
        let channel = |warm: f32, cool: f32| ((toned + lamps * warm + windows * cool) * dim).clamp(0.02, 1.6).sqrt();
        [channel(1.03, 0.97), channel(1.0, 1.0), channel(0.93, 1.05)]
    }

    fn daylight(&self, at: Vec3, normal: Vec3, (middle, inward, area): &(Vec3, Vec3, f32)) -> f32 {
        let towards = *middle - at;
        let distance_sq = towards.length_squared().max(0.04);
        let direction = towards / distance_sq.sqrt();
        let facing = (normal.dot(direction) * 0.8 + 0.2).max(0.0) * (-direction.dot(*inward)).max(0.0);
        0.9 * area * facing / (1.2 + distance_sq)
    }

    /// Shadow near the shell's inner edges, except at the face on which the corner itself lies.
    fn edges(&self, at: Vec3, normal: Vec3) -> f32 {
        let near = |distance: f32, facing: f32| {
            let own = facing > 0.5 && distance < 0.02;
            if own { 1.0 } else { 1.0 - 0.26 * fading(distance.max(0.0), EDGE_M) }
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
fn fading(distance: f32, reach: f32) -> f32 {
    let left = (1.0 - distance / reach).max(0.0);
    left * left
}

fn lit(at: Vec3, normal: Vec3, lamp: Vec3) -> f32 {
    let towards = lamp - at;
    let distance_sq = towards.length_squared().max(0.01);
    let facing = (normal.dot(towards) / distance_sq.sqrt() * 0.75 + 0.25).max(0.0);
    1.5 * facing / (1.4 + distance_sq * 0.55)
}

/// One lamp in the middle of the ceiling, several in long rooms, and one above each floor of a staircase.
fn lamps(room: &Room, low: Vec3, high: Vec3) -> Vec<Vec3> {
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
mod tests {
    use super::super::{catalogue::FurnitureKind, generate};
    use super::*;

    #[test]
    fn corners_are_darker_than_the_middle_and_light_is_bounded() {
        let house = generate(3);
        for index in 0..house.rooms.len() {
            let light = RoomLight::of(&house, index);
            let empty = RoomLight { boxes: Vec::new(), ..light };
            let (low, high) = (empty.low, empty.high);
            let middle = (low + high) / 2.0;
            let ceiling = |x: f32, y: f32| empty.on_shell(Vec3::new(x, y, high.z), -Vec3::Z)[1];
            assert!(ceiling(low.x + 0.01, low.y + 0.01) < ceiling(middle.x, middle.y));
            let all = empty.on_thing(middle, Vec3::Z);
            assert!(all.iter().all(|factor| (0.1..1.3).contains(factor)), "{all:?}");
        }
    }

    #[test]
    fn things_shade_the_floor_under_them() {
        let house = generate(3);
        let table = house.furniture.iter().find(|piece| piece.kind == FurnitureKind::DiningTable).unwrap();
        let light = RoomLight::of(&house, table.room);
        let (low, high) = bounds(table);
        let under = (low + high) / 2.0 * Vec3::new(1.0, 1.0, 0.0);
        let lit = RoomLight { boxes: Vec::new(), ..RoomLight::of(&house, table.room) };
        assert!(light.on_shell(under, Vec3::Z)[1] < 0.8 * lit.on_shell(under, Vec3::Z)[1]);
    }
}
