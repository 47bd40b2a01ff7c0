//! The plan of a house: what stands where, what a person sees, and where one can walk.

use wayword_core::DVec3;
use wayword_house::{House, HouseGround, RectCm, model::RoomKind};

/// A thing on another storey is at least this far above the feet, or its upper edge this far below them, metres.
const STOREY_REACH_M: [f64; 2] = [2.5, 0.5];
/// A line of sight is tested at places this far apart, metres.
const SIGHT_STEP_M: f64 = 0.1;
/// A line of sight changes rooms within this distance of the middle line of an opening's wall, centimetres.
const THRESHOLD_CM: i32 = 15;
/// An opening begins at most this far above or below the feet, metres.
const SILL_REACH_M: f64 = 1.2;
/// Places that are tested when it is asked whether a person can walk straight on are this far apart, metres.
const WALK_STEP_M: f64 = 0.1;

/// A thing in a house: furniture or a window.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlanThing {
    /// Its name in the plan.
    pub(super) name: String,
    /// The floor that it takes, or hangs over.
    pub(super) footprint: RectCm,
    /// Its lower and its upper edge, metres above z = 0.
    pub(super) heights_m: [f64; 2],
    /// The room that it is in.
    pub(super) room: usize,
}

impl PlanThing {
    /// The distance from a walker's feet to the nearest side of it, metres along the floor; infinite on another storey.
    pub(super) fn distance_m(&self, feet: DVec3) -> f64 {
        let [low, high] = self.heights_m;
        if low >= feet.z + STOREY_REACH_M[0] || high <= feet.z - STOREY_REACH_M[1] {
            return f64::INFINITY;
        }
        let off = |at: f64, from: i32, to: i32| {
            let (from, to) = (f64::from(from) / 100.0, f64::from(to) / 100.0);
            (from - at).max(at - to).max(0.0)
        };
        let area = &self.footprint;
        libm::hypot(off(feet.x, area.x0, area.x1), off(feet.y, area.y0, area.y1))
    }

    /// The distance between the nearest sides of two things, metres along the floor.
    pub(super) fn gap_m(&self, other: &Self) -> f64 {
        let (a, b) = (&self.footprint, &other.footprint);
        let off = |low: i32, high: i32| f64::from(low.max(high).max(0)) / 100.0;
        libm::hypot(off(b.x0 - a.x1, a.x0 - b.x1), off(b.y0 - a.y1, a.y0 - b.y1))
    }

    /// The corners of its footprint, metres, at the height of a place.
    pub(super) fn corners_m(&self, height_m: f64) -> [DVec3; 4] {
        let area = &self.footprint;
        [(area.x0, area.y0), (area.x1, area.y0), (area.x1, area.y1), (area.x0, area.y1)]
            .map(|(x, y)| DVec3::new(f64::from(x) / 100.0, f64::from(y) / 100.0, height_m))
    }
}

/// A house as this generator sees it.
#[derive(Debug)]
pub(super) struct HousePlan {
    house: House,
    ground: HouseGround,
    /// All furniture and windows.
    pub(super) things: Vec<PlanThing>,
}

impl HousePlan {
    /// The plan of a house.
    pub(super) fn new(house: House) -> Self {
        let height = |low_cm: i32, high_cm: i32| [f64::from(low_cm) / 100.0, f64::from(high_cm) / 100.0];
        let furniture = house.furniture.iter().map(|piece| PlanThing {
            name: piece.name.clone(),
            footprint: piece.footprint,
            heights_m: height(piece.base_cm, piece.base_cm.saturating_add(piece.height_cm)),
            room: piece.room,
        });
        let windows = house.windows.iter().map(|window| PlanThing {
            name: "window".to_owned(),
            footprint: window.span.thickened_by(THRESHOLD_CM),
            heights_m: height(window.sill_cm, window.head_cm),
            room: window.room,
        });
        let things = furniture.chain(windows).collect();
        Self { ground: HouseGround::for_house(&house), things, house }
    }

    /// The index of the room in which a place of the floor lies.
    pub(super) fn room_index(&self, place: DVec3) -> Option<usize> {
        let room = self.house.room_at(place.x, place.y, place.z)?;
        self.house.rooms.iter().position(|other| std::ptr::eq(other, room))
    }

    /// What a room is for.
    pub(super) fn room_kind(&self, room: usize) -> Option<RoomKind> {
        self.house.rooms.get(room).map(|room| room.kind)
    }

    /// The area between the walls of a room.
    pub(super) fn room_area(&self, room: usize) -> Option<RectCm> {
        self.house.rooms.get(room).map(|room| room.inner_area())
    }

    /// Whether no wall stands between two places of a storey. Furniture hides nothing here, so a person may see less.
    pub(super) fn is_clear(&self, from: DVec3, to: DVec3) -> bool {
        let across = DVec3::new(to.x - from.x, to.y - from.y, 0.0);
        let steps = (across.length() / SIGHT_STEP_M).ceil().max(1.0) as usize;
        let mut last = self.room_index(from);
        for step in 1..=steps {
            let place = from + across * (step as f64 / steps as f64);
            let room = self.room_index(place);
            if room.is_none() || room != last && !self.is_in_opening(place) {
                return false;
            }
            last = room;
        }
        true
    }

    /// Whether a place is in a doorway or an open door.
    fn is_in_opening(&self, place: DVec3) -> bool {
        self.house.openings.iter().filter(|opening| opening.is_passable()).any(|opening| {
            let rise_m = f64::from(opening.base_cm) / 100.0 - place.z;
            rise_m.abs() < SILL_REACH_M && opening.span.thickened_by(THRESHOLD_CM).holds_m(place.x, place.y)
        })
    }

    /// Whether a person can walk straight from a place of the floor over a horizontal distance, metres.
    pub(super) fn can_walk(&self, from: DVec3, along: DVec3, distance_m: f64) -> bool {
        let steps = (distance_m / WALK_STEP_M).round() as usize;
        (1..=steps).all(|step| self.ground.is_walkable(from + along * (step as f64 * WALK_STEP_M)))
    }
}

#[cfg(test)]
mod tests {
    use super::{super::test_plan::hallway_house, *};
    use wayword_house::generate_house;

    fn thing(footprint: RectCm) -> PlanThing {
        PlanThing { name: "bed".into(), footprint, heights_m: [0.0, 1.0], room: 0 }
    }

    #[test]
    fn distance_m_is_that_of_the_nearest_side_on_the_same_storey() {
        let bed = thing(RectCm::new(100, 0, 300, 200));
        assert_eq!(bed.distance_m(DVec3::new(0.0, 1.0, 0.0)), 1.0);
        assert_eq!(bed.distance_m(DVec3::new(2.0, 1.0, 0.0)), 0.0);
        assert_eq!(bed.distance_m(DVec3::new(0.0, 1.0, 3.0)), f64::INFINITY);
        assert!((bed.gap_m(&thing(RectCm::new(600, 600, 700, 700))) - 5.0).abs() < 1e-9);
        assert_eq!(bed.gap_m(&thing(RectCm::new(200, 100, 700, 700))), 0.0);
    }

    #[test]
    fn is_clear_leads_through_openings_and_not_through_walls() {
        let plan = HousePlan::new(hallway_house());
        let hall = DVec3::new(8.5, 0.8, 0.0);
        assert!(plan.is_clear(hall, DVec3::new(8.5, 5.0, 0.0)), "through the doorway");
        assert!(!plan.is_clear(DVec3::new(10.5, 0.8, 0.0), DVec3::new(10.5, 5.0, 0.0)), "through the wall");
        assert!(!plan.is_clear(hall, DVec3::new(8.5, -3.0, 0.0)), "out of the house");
    }

    #[test]
    fn can_walk_ends_at_walls() {
        let plan = HousePlan::new(hallway_house());
        let hall = DVec3::new(8.5, 0.8, 0.0);
        assert!(plan.can_walk(hall, DVec3::X, 1.5));
        assert!(!plan.can_walk(hall, -DVec3::Y, 1.5));
    }

    #[test]
    fn new_takes_all_furniture_and_every_thing_lies_in_its_room() {
        let house = generate_house(3);
        let plan = HousePlan::new(house.clone());
        assert_eq!(plan.things.len(), house.furniture.len() + house.windows.len());
        let middle = house.rooms[2].outline.centre();
        let place = DVec3::new(
            f64::from(middle.0) / 100.0,
            f64::from(middle.1) / 100.0,
            f64::from(house.rooms[2].base_cm()) / 100.0,
        );
        assert_eq!(plan.room_index(place), Some(2));
        assert_eq!(plan.room_kind(2), Some(house.rooms[2].kind));
        assert_eq!(plan.room_kind(999), None);
    }
}
