//! Fills a strip of the plan with rooms of equal depth, one after another.

use super::{
    super::{dice::HouseDice, model::RoomKind},
    program::usual_widths,
};

/// Divides `range` (centimetres) among rooms: `first` as far as they fit, then some of `more`. All rooms then share the
/// width that is left. Returns each room with its two ends along the strip.
pub(super) fn fill_strip(
    dice: &mut HouseDice,
    range: (i32, i32),
    first: &[RoomKind],
    more: &[RoomKind],
) -> Vec<(RoomKind, i32, i32)> {
    let length = range.1 - range.0;
    let least = |kinds: &[RoomKind]| kinds.iter().map(|kind| usual_widths(*kind).0).sum::<i32>();
    let most = |kinds: &[RoomKind]| kinds.iter().map(|kind| usual_widths(*kind).1).sum::<i32>();
    let mut kinds = Vec::new();
    for kind in first {
        kinds.push(*kind);
        if least(&kinds) > length && kinds.len() > 1 {
            kinds.pop();
        }
    }
    let mut rest = more.to_vec();
    dice.shuffle(&mut rest);
    // The list is tried twice, so that a long strip does not end in one enormous room.
    for kind in rest.iter().chain(&rest) {
        if most(&kinds) < length && least(&kinds) + usual_widths(*kind).0 <= length {
            kinds.push(*kind);
        }
    }
    spread_rooms(&kinds, range)
}

/// Gives each room its least width, and shares the rest among the rooms by how much wider each may be.
fn spread_rooms(kinds: &[RoomKind], (start, end): (i32, i32)) -> Vec<(RoomKind, i32, i32)> {
    let least: i32 = kinds.iter().map(|kind| usual_widths(*kind).0).sum();
    let give: i32 = kinds.iter().map(|kind| usual_widths(*kind).1 - usual_widths(*kind).0).sum();
    let slack = end - start - least;
    let mut from = start;
    let last = kinds.len().saturating_sub(1);
    let cell = |(index, kind): (usize, &RoomKind)| {
        let (low, high) = usual_widths(*kind);
        let width = low + slack * (high - low) / give.max(1);
        let to = if index == last { end } else { from + width / 5 * 5 };
        let cell = (*kind, from, to);
        from = to;
        cell
    };
    kinds.iter().enumerate().map(cell).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_strip_is_filled_without_gap_and_no_room_is_a_slit(seed: u64, length in 300..1200i32) {
            let mut dice = HouseDice::new(seed, &["strip"]);
            let first = [RoomKind::Entryway, RoomKind::Bedroom];
            let more = [RoomKind::Closet, RoomKind::Office, RoomKind::Bathroom];
            let cells = fill_strip(&mut dice, (100, 100 + length), &first, &more);
            prop_assert_eq!(cells[0].1, 100);
            prop_assert_eq!(cells[cells.len() - 1].2, 100 + length);
            prop_assert!(cells.windows(2).all(|pair| pair[0].2 == pair[1].1));
            prop_assert!(cells.iter().all(|(_, from, to)| to - from >= 135));
        }
    }
}
