//! What lies outside a house, on each of its four sides.

use super::{
    dice::Dice,
    model::{House, Leaf},
    rect::Wall,
};

/// What one sees out of the windows of one side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Outlook {
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

/// The outlook of each side of a house, in the order of [`Wall::ALL`]: four different ones. The front door leads to the
/// street.
pub(crate) fn outlooks(house: &House) -> [Outlook; 4] {
    use Outlook::{Garden, Hills, Meadow, Sea, Street, Woods, Yard};
    let mut others = [Garden, Yard, Woods, Hills, Sea, Meadow];
    Dice::new(house.seed, &["outlook"]).shuffle(&mut others);
    let mut sides = [others[0], others[1], others[2], others[3]];
    if let Some(front) = front(house) {
        sides[usize::from(front.quarter_turns()) % 4] = Street;
    }
    sides
}

/// The side on which the front door is.
fn front(house: &House) -> Option<Wall> {
    let door = house.openings.iter().find(|opening| opening.leaf == Leaf::Closed)?;
    house.rooms.get(door.room)?.outline.wall_of(&door.span)
}

#[cfg(test)]
mod tests {
    use super::super::generate;
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_four_sides_differ_and_the_front_door_leads_to_the_street() {
        for seed in 0..20 {
            let house = generate(seed);
            let sides = outlooks(&house);
            assert_eq!(BTreeSet::from(sides).len(), 4, "house {seed}: {sides:?}");
            let front = front(&house).unwrap();
            assert_eq!(sides[usize::from(front.quarter_turns())], Outlook::Street, "house {seed}");
        }
    }

    #[test]
    fn houses_differ() {
        let all: BTreeSet<_> = (0..20).map(|seed| outlooks(&generate(seed))).collect();
        assert!(all.len() > 12, "{all:?}");
    }
}
