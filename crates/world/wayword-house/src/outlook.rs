//! Chooses the view out of the windows on each of a house's four sides.

use super::{
    dice::HouseDice,
    model::{DoorLeaf, House},
    rect::WallSide,
};

/// The view out of the windows of one side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum WindowOutlook {
    /// A street with houses opposite and a parked car.
    Street,
    /// A lawn with trees and a hedge.
    Garden,
    /// A lawn with a shed and a wooden fence.
    Yard,
    /// Trunks close together.
    Woods,
    /// Fields on hills.
    Hills,
    /// A beach, and a boat on the water.
    Sea,
    /// Grass with flowers, and one tree.
    Meadow,
}

/// The outlook of each side of a house, in the order of [`WallSide::ALL`]: four different ones. The front door leads to the
/// street.
pub(crate) fn choose_outlooks(house: &House) -> [WindowOutlook; 4] {
    use WindowOutlook::{Garden, Hills, Meadow, Sea, Street, Woods, Yard};
    let mut others = [Garden, Yard, Woods, Hills, Sea, Meadow];
    HouseDice::new(house.seed, &["outlook"]).shuffle(&mut others);
    let mut sides = [others[0], others[1], others[2], others[3]];
    if let Some(front) = front_side(house) {
        sides[usize::from(front.quarter_turns()) % 4] = Street;
    }
    sides
}

/// The side on which the front door is.
fn front_side(house: &House) -> Option<WallSide> {
    let door = house.openings.iter().find(|opening| opening.leaf == DoorLeaf::Closed)?;
    house.rooms.get(door.room)?.outline.wall_of(&door.span)
}

#[cfg(test)]
mod tests {
    use super::super::{generate_house, structure, surface::SurfacePattern};
    use super::*;
    use std::collections::{BTreeMap, BTreeSet};

    #[test]
    fn the_four_sides_differ_and_the_front_door_leads_to_the_street() {
        for seed in 0..20 {
            let house = generate_house(seed);
            let sides = choose_outlooks(&house);
            assert_eq!(BTreeSet::from(sides).len(), 4, "house {seed}: {sides:?}");
            let front = front_side(&house).unwrap();
            assert_eq!(sides[usize::from(front.quarter_turns())], WindowOutlook::Street, "house {seed}");
        }
    }

    #[test]
    fn outlooks_differ_between_houses() {
        let all: BTreeSet<_> = (0..20).map(|seed| choose_outlooks(&generate_house(seed))).collect();
        assert!(all.len() > 12, "{all:?}");
    }

    #[test]
    fn windows_on_two_sides_show_two_views_and_upstairs_shows_them_from_above() {
        let shows =
            |pattern: SurfacePattern| matches!(pattern, SurfacePattern::Outside(_) | SurfacePattern::FromAbove(_));
        let mut from_above = 0;
        for seed in 0..6 {
            let house = generate_house(seed);
            let sides = choose_outlooks(&house);
            let mut seen: BTreeMap<(bool, u8), SurfacePattern> = BTreeMap::new();
            for window in &house.windows {
                let wall = house.rooms[window.room].outline.wall_of(&window.span).unwrap();
                let parts = structure::build_window(&house, window, &sides).parts;
                let view = parts.iter().map(|part| part.surface.pattern).find(|pattern| shows(*pattern)).unwrap();
                let is_high = matches!(view, SurfacePattern::FromAbove(_));
                assert_eq!(*seen.entry((is_high, wall.quarter_turns())).or_insert(view), view, "house {seed}");
                assert!(!is_high || house.storeys == 2, "house {seed}");
                from_above += usize::from(is_high);
            }
            let different: BTreeSet<_> = seen.values().collect();
            assert!(different.len() == seen.len() && seen.len() > 1, "house {seed}: {seen:?}");
        }
        assert!(from_above > 0);
    }
}
