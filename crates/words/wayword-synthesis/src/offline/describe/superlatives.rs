//! Superlatives of the target among the objects of its name in view: the leftmost, the nearest, the highest.

use super::properties::TargetContext;
use wayword_core::{ObjectDistinction, Side};

/// Least angle between the target and the next object in a row, degrees; closer ones make the row unclear.
const MIN_APART_DEG: f64 = 5.0;
/// The widest row, degrees. If things lie all around the walker, none of them is the leftmost.
const MAX_ROW_WIDTH_DEG: f64 = 150.0;
/// The nearest object has to be nearer than this share of the distance of the next.
const CLEARLY_NEAREST_SHARE: f64 = 0.75;
/// The highest object has to be higher than the next by this, metres.
const HIGHER_M: f64 = 0.3;
/// Things above one another are at most so far aside, metres.
const STACKED_M: f64 = 1.5;
/// The longest row in which people count ("the third from the left"), objects.
const MAX_COUNTED_ROW: usize = 5;

impl TargetContext<'_> {
    /// The superlatives that hold clearly of the target among itself and the given rivals, each with its cost.
    pub(super) fn superlatives_among(&self, among: &[bool]) -> Vec<(f64, ObjectDistinction)> {
        let others: Vec<usize> =
            self.rivals.iter().zip(among).filter(|(_, among)| **among).map(|(rival, _)| *rival).collect();
        self.row_superlative(&others)
            .into_iter()
            .chain(self.range_superlative(&others))
            .chain(self.height_superlative(&others))
            .collect()
    }

    /// "The leftmost", "the second from the right". `None` where the objects make no clear row.
    fn row_superlative(&self, others: &[usize]) -> Option<(f64, ObjectDistinction)> {
        let own = self.turn_rad(self.target)?.to_degrees();
        let turns: Option<Vec<f64>> = others.iter().map(|other| Some(self.turn_rad(*other)?.to_degrees())).collect();
        let turns = turns?;
        let all = || turns.iter().copied().chain([own]);
        let (first, last) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        // A row behind the walker's back has no clear left end.
        let is_clear = last - first <= MAX_ROW_WIDTH_DEG && first > -165.0 && last < 165.0;
        if !is_clear || turns.iter().any(|turn| (turn - own).abs() < MIN_APART_DEG) {
            return None;
        }
        let left = turns.iter().filter(|turn| **turn < own).count();
        let (of, right) = (turns.len() + 1, turns.len() - left);
        let (place, from) = if left <= right { (left + 1, Side::Left) } else { (right + 1, Side::Right) };
        let cost = match (place, of) {
            (1, _) => 1.7,
            _ if of > MAX_COUNTED_ROW => return None,
            _ => 2.3,
        };
        Some((cost, ObjectDistinction::InRow { place, of, from }))
    }

    /// "The nearest" or "the furthest", where that is clear.
    fn range_superlative(&self, others: &[usize]) -> Option<(f64, ObjectDistinction)> {
        let own_m = self.distance_m(self.target)?;
        let others: Option<Vec<f64>> = others.iter().map(|other| self.distance_m(*other)).collect();
        let others = others?;
        let nearest = others.iter().all(|other_m| own_m < CLEARLY_NEAREST_SHARE * other_m);
        let furthest = others.iter().all(|other_m| own_m * CLEARLY_NEAREST_SHARE > *other_m);
        (nearest || furthest).then_some((2.0, ObjectDistinction::Range { nearest }))
    }

    /// "The highest" or "the lowest", where that is clear.
    fn height_superlative(&self, others: &[usize]) -> Option<(f64, ObjectDistinction)> {
        let own = self.object_at(self.target).position?;
        // Only of things above one another, one is the lower.
        let is_aside = |other: &usize| {
            self.object_at(*other).position.is_none_or(|there| (there - own).truncate().length() > STACKED_M)
        };
        if others.iter().any(is_aside) {
            return None;
        }
        let own_m = own.z;
        let others: Option<Vec<f64>> = others.iter().map(|other| Some(self.object_at(*other).position?.z)).collect();
        let others = others?;
        let highest = others.iter().all(|other_m| own_m > other_m + HIGHER_M);
        let lowest = others.iter().all(|other_m| own_m + HIGHER_M < *other_m);
        (highest || lowest).then_some((1.8, ObjectDistinction::Height { highest }))
    }
}
