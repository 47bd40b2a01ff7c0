//! Measures how well two texts for one path agree, from what each of them states (landmarks, turns, rooms, floors).

use crate::facts::TextFacts;
use serde::{Deserialize, Serialize};
use wayword_language::lexicon::names_agree;

/// Landmarks of two texts match if their names agree and their frames are at most this far apart: one writer may mention a thing when
/// it comes into view, and another one when the walker passes it.
const MAX_FRAMES_APART: usize = 1;

/// The agreement of two texts, from 0 to 1 for each kind of statement; `None` where neither has that kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct TextAgreement {
    /// F1 of landmarks at the same frames.
    pub landmarks: Option<f64>,
    /// 1 minus the edit distance of the turns divided by the length of the longer list.
    pub turns: Option<f64>,
    /// 1 minus the edit distance of the rooms divided by the length of the longer list.
    pub rooms: Option<f64>,
    /// 1 if both state the same about floors, else 0.
    pub floors: Option<f64>,
}

impl TextAgreement {
    /// Compares two texts. The order does not matter.
    #[must_use]
    pub fn from_facts(a: &TextFacts, b: &TextFacts) -> Self {
        Self {
            landmarks: landmark_f1(a, b),
            turns: sequence_similarity(&a.turns, &b.turns),
            rooms: sequence_similarity(&a.rooms, &b.rooms),
            floors: (!a.floors.is_empty() || !b.floors.is_empty()).then(|| f64::from(u8::from(a.floors == b.floors))),
        }
    }

    /// Landmarks, turns, rooms and floors, in this order.
    #[must_use]
    pub fn by_kind(&self) -> [Option<f64>; 4] {
        [self.landmarks, self.turns, self.rooms, self.floors]
    }
}

/// F1 of the landmarks, over the largest possible matching between both lists.
fn landmark_f1(a: &TextFacts, b: &TextFacts) -> Option<f64> {
    let all = a.landmarks.len() + b.landmarks.len();
    let is_same = |(name, frame): &(String, usize), (other_name, other_frame): &(String, usize)| {
        frame.abs_diff(*other_frame) <= MAX_FRAMES_APART && names_agree(name, other_name)
    };
    // For each landmark of `a`, the matching ones of `b`.
    let partners: Vec<Vec<usize>> = a
        .landmarks
        .iter()
        .map(|one| (0..b.landmarks.len()).filter(|at| is_same(one, &b.landmarks[*at])).collect())
        .collect();
    // For each landmark of `b`, the one of `a` that it is matched with.
    let mut taken: Vec<Option<usize>> = vec![None; b.landmarks.len()];
    let matched = (0..partners.len())
        .filter(|one| find_partner(*one, &partners, &mut taken, &mut vec![false; b.landmarks.len()]));
    let matched = matched.count();
    (all > 0).then(|| 2.0 * matched as f64 / all as f64)
}

/// Finds a partner for a landmark. `tried` marks the candidates of this search. If all candidates are taken, it tries to move another
/// landmark to a different partner, which makes the matching as large as possible (Kuhn 1955).
fn find_partner(landmark: usize, partners: &[Vec<usize>], taken: &mut [Option<usize>], tried: &mut [bool]) -> bool {
    for &partner in &partners[landmark] {
        if std::mem::replace(&mut tried[partner], true) {
            continue;
        }
        if taken[partner].is_none_or(|other| find_partner(other, partners, taken, tried)) {
            taken[partner] = Some(landmark);
            return true;
        }
    }
    false
}

/// 1 minus the edit distance (Levenshtein 1966) divided by the length of the longer list.
fn sequence_similarity<T: PartialEq>(a: &[T], b: &[T]) -> Option<f64> {
    let longer = a.len().max(b.len());
    // One row of the table of edit distances: `row[j]` belongs to the first `j` elements of `b`.
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (at, one) in a.iter().enumerate() {
        let mut before = row[0];
        row[0] = at + 1;
        for (to, other) in b.iter().enumerate() {
            let replaced = before + usize::from(one != other);
            before = row[to + 1];
            row[to + 1] = replaced.min(before + 1).min(row[to] + 1);
        }
    }
    (longer > 0).then(|| 1.0 - row[b.len()] as f64 / longer as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facts::FloorFact;
    use proptest::prelude::*;
    use wayword_core::Side;

    fn facts() -> impl Strategy<Value = TextFacts> {
        let name = prop_oneof![Just("sofa"), Just("couch"), Just("lamp"), Just("bed")];
        let landmarks = prop::collection::vec((name.prop_map(str::to_owned), 0..5_usize), 0..5);
        let turns = prop::collection::vec(prop_oneof![Just(Side::Left), Just(Side::Right)], 0..5);
        let rooms = prop::collection::vec(prop_oneof![Just("kitchen".to_owned()), Just("hallway".to_owned())], 0..4);
        (landmarks, turns, rooms).prop_map(|(landmarks, turns, rooms)| TextFacts {
            landmarks,
            turns,
            rooms,
            floors: Vec::new(),
        })
    }

    proptest! {
        #[test]
        fn agreement_is_symmetric(a in facts(), b in facts()) {
            prop_assert_eq!(TextAgreement::from_facts(&a, &b), TextAgreement::from_facts(&b, &a));
        }

        #[test]
        fn equal_texts_agree(a in facts()) {
            let agreement = TextAgreement::from_facts(&a, &a);
            prop_assert!(agreement.by_kind().into_iter().flatten().all(|share| share == 1.0));
        }

        #[test]
        fn agreement_is_between_0_and_1(a in facts(), b in facts()) {
            prop_assert!(TextAgreement::from_facts(&a, &b).by_kind().into_iter().flatten().all(|share| (0.0..=1.0).contains(&share)));
        }
    }

    #[test]
    fn agreement_compares_each_kind_of_statement() {
        let landmarks = |all: &[(&str, usize)]| all.iter().map(|(name, at)| ((*name).to_owned(), *at)).collect();
        let a = TextFacts {
            landmarks: landmarks(&[("sofa", 1), ("lamp", 4)]),
            turns: vec![Side::Left, Side::Right],
            rooms: vec!["kitchen".into()],
            floors: vec![FloorFact::Up],
        };
        let b = TextFacts {
            landmarks: landmarks(&[("couch", 2), ("lamp", 1)]),
            turns: vec![Side::Left],
            rooms: vec!["kitchen".into(), "hallway".into()],
            floors: vec![FloorFact::Down],
        };
        // A couch is a sofa, one frame on; the lamp is another one.
        assert_eq!(TextAgreement::from_facts(&a, &b).by_kind(), [Some(0.5), Some(0.5), Some(0.5), Some(0.0)]);
        assert_eq!(TextAgreement::from_facts(&TextFacts::default(), &TextFacts::default()).by_kind(), [None; 4]);
    }

    #[test]
    fn a_landmark_gives_way_to_one_that_has_no_other_partner() {
        let at = |frames: &[usize]| frames.iter().map(|frame| ("sofa".to_owned(), *frame)).collect();
        let a = TextFacts { landmarks: at(&[1, 0]), ..TextFacts::default() };
        let b = TextFacts { landmarks: at(&[1, 2]), ..TextFacts::default() };
        assert_eq!(TextAgreement::from_facts(&a, &b).landmarks, Some(1.0));
    }
}
