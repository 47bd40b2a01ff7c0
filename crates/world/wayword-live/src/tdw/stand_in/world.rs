//! The house that the stand-in shows, in Unity's coordinates.

use super::{super::scenes, StandInFurnishing};
use crate::{
    houses::StandInHouses,
    unity::{unity_from_wayword, wayword_from_unity},
};
use std::sync::Arc;
use wayword_core::DVec3;
use wayword_house::{House, HouseGround, HouseScene, NumberedObject, ObjectRole, generate_house};

/// Step of the search for a position on the navmesh, metres.
const SNAP_STEP_M: f64 = 0.05;

/// A house with its drawing and its walkable ground.
#[derive(Debug)]
pub struct StandInWorld {
    pub(super) scene: HouseScene,
    ground: HouseGround,
    /// Whether doors and windows are objects with a number, as furniture is.
    counts_fixtures: bool,
}

/// The houses of a stand-in. Only the loaded one is in memory, because each takes some 15 MB.
#[derive(Debug, Clone)]
pub(super) struct StandInWorlds {
    houses: StandInHouses,
    furnished: StandInFurnishing,
    seed: u64,
    shown: WorldStates,
}

/// The two states of a scene: after loading, and after the first object was added.
#[derive(Debug, Clone)]
struct WorldStates {
    loaded: Arc<StandInWorld>,
    furnished: Arc<StandInWorld>,
}

impl StandInWorlds {
    /// The first house is loaded.
    pub(super) fn new(houses: StandInHouses, furnished: StandInFurnishing) -> Self {
        let seed = seed_for_scene(&houses, "");
        Self { houses, furnished, seed, shown: WorldStates::from_seed(seed, furnished) }
    }

    /// Loads the house of a scene.
    pub(super) fn enter_scene(&mut self, scene: &str) {
        let seed = seed_for_scene(&self.houses, scene);
        if seed != self.seed {
            self.shown = WorldStates::from_seed(seed, self.furnished);
            self.seed = seed;
        }
    }

    /// The world after the scene was loaded.
    pub(super) fn loaded_world(&self) -> Arc<StandInWorld> {
        self.shown.loaded.clone()
    }

    /// The world after an object was added.
    pub(super) fn furnished_world(&self) -> Arc<StandInWorld> {
        self.shown.furnished.clone()
    }
}

/// The seed of the house that a scene shows.
fn seed_for_scene(houses: &StandInHouses, scene: &str) -> u64 {
    let place = scenes::floor_plan_names().iter().position(|plan| plan == scene).unwrap_or(0);
    houses.seeds().get(place).or(houses.seeds().first()).copied().unwrap_or(0)
}

impl WorldStates {
    fn from_seed(seed: u64, furnished: StandInFurnishing) -> Self {
        if furnished != StandInFurnishing::OnceAdded {
            let world = Arc::new(StandInWorld::from_house(
                first_one_storey_house(seed),
                furnished == StandInFurnishing::WithFixtures,
            ));
            return Self { loaded: world.clone(), furnished: world };
        }
        let furnished = StandInWorld::from_house(first_one_storey_house(seed), false);
        let bare = House { furniture: Vec::new(), ..furnished.scene.house.clone() };
        Self { loaded: Arc::new(StandInWorld::from_house(bare, false)), furnished: Arc::new(furnished) }
    }
}

/// The first house with a single storey from a seed on: TDW's floor plans have one.
#[allow(clippy::expect_used, reason = "a stand-in is for tests, and one house in a few has one storey")]
fn first_one_storey_house(seed: u64) -> House {
    (seed..).map(generate_house).find(|house| house.storeys == 1).expect("a house with one storey")
}

impl StandInWorld {
    /// The first house with a single storey from a seed on: TDW's floor plans have one.
    ///
    /// # Panics
    /// Never: generated houses can be drawn, and one in a few has one storey.
    #[must_use]
    pub fn with_one_storey(seed: u64) -> Self {
        Self::from_house(first_one_storey_house(seed), true)
    }

    #[allow(clippy::expect_used, reason = "a stand-in is for tests, and a generated house can be drawn")]
    fn from_house(house: House, counts_fixtures: bool) -> Self {
        let ground = HouseGround::for_house(&house);
        Self { scene: HouseScene::new(house).expect("a drawing of the house"), ground, counts_fixtures }
    }

    fn counts_object(&self, object: &NumberedObject) -> bool {
        object.role == ObjectRole::Furniture || self.counts_fixtures && object.role == ObjectRole::Fixture
    }

    /// The house with its drawing.
    pub(crate) fn house_scene(&self) -> &HouseScene {
        &self.scene
    }

    /// The objects that have a colour in the `_id` pass, by number.
    pub(crate) fn coloured_objects(&self) -> impl Iterator<Item = (u32, &NumberedObject)> {
        self.scene.objects.iter().filter(|(_, object)| self.counts_object(object)).map(|(id, object)| (*id, object))
    }

    /// Whether a number belongs to an object that has a colour in the `_id` pass.
    pub(crate) fn is_object(&self, id: u32) -> bool {
        self.scene.objects.get(&id).is_some_and(|object| self.counts_object(object))
    }

    /// The rooms: number, middle and size, Unity's.
    pub(super) fn room_boxes(&self) -> impl Iterator<Item = (i32, [f32; 3], [f32; 3])> {
        self.scene.house.rooms.iter().enumerate().map(|(index, room)| {
            let (area, base_cm) = (room.outline, room.base_cm());
            let low = DVec3::new(area.x0.into(), area.y0.into(), base_cm.into()) / 100.0;
            let high = DVec3::new(area.x1.into(), area.y1.into(), (base_cm + room.height_cm).into()) / 100.0;
            (index as i32, unity_f32((low + high) / 2.0), unity_f32(high - low))
        })
    }

    /// Lower and upper corner of the whole house, metres, world frame.
    pub(super) fn house_extent(&self) -> (DVec3, DVec3) {
        let corners = self.room_boxes().map(|(_, centre, size)| {
            let half = size.map(|side| f64::from(side) / 2.0);
            let (centre, half) = (wayword_from_unity(centre.map(f64::from)), wayword_from_unity(half));
            (centre - half, centre + half)
        });
        corners.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), (a, b)| (low.min(a), high.max(b)))
    }

    /// Whether a point of the floor is inside the house, and whether it is walkable.
    pub(super) fn floor_state(&self, x: f64, z: f64) -> (bool, bool) {
        let floor = wayword_from_unity([x, 0.0, z]);
        (self.scene.house.room_at(floor.x, floor.y, 0.0).is_some(), self.ground.is_walkable(floor))
    }

    /// The walkable point nearest to a Unity position, within a distance.
    pub(super) fn nearest_walkable(&self, position: [f64; 3], max_distance: f64) -> Option<DVec3> {
        let place = wayword_from_unity(position).with_z(0.0);
        let reach = (max_distance.clamp(0.0, 2.0) / SNAP_STEP_M) as i32;
        let offsets = (-reach..=reach).flat_map(|dx| (-reach..=reach).map(move |dy| (dx, dy)));
        let near = offsets.map(|(dx, dy)| place + DVec3::new(dx.into(), dy.into(), 0.0) * SNAP_STEP_M);
        near.filter(|near| self.ground.is_walkable(*near))
            .min_by(|a, b| a.distance_squared(place).total_cmp(&b.distance_squared(place)))
    }

    /// The corners of a way over the ground between two Unity positions.
    pub(super) fn shortest_way(&self, from: [f64; 3], to: [f64; 3]) -> Option<Vec<DVec3>> {
        let (from, to) = (self.nearest_walkable(from, 0.5)?, self.nearest_walkable(to, 0.5)?);
        self.ground.shortest_route(from, to).ok().map(|way| way.corners)
    }
}

/// A place of the world frame as the build sends it.
pub(super) fn unity_f32(place: DVec3) -> [f32; 3] {
    unity_from_wayword(place).map(|number| number as f32)
}
