//! How well an alignment finds the stretches that people gave to the parts of texts.

use super::people_parts::PeopleAlignedText;
use crate::fit_follower::texts::FollowerScene;
use rayon::prelude::*;
use serde::Serialize;
use wayword_core::Side;
use wayword_follower::{
    WalkTree,
    alignment::{AlignmentCase, AlignmentWeights, PartedText, WalkAlignment},
};

/// A text with people's stretches, ready to be aligned.
pub(super) struct AlignedCase<'a> {
    pub(super) text: &'a PeopleAlignedText,
    parted: &'a PartedText,
    pub(super) case: AlignmentCase<'a>,
    /// The parts of which the walk itself shows where they begin.
    evident: Vec<EvidentPart>,
}

/// A part of which the walk itself shows where it begins or what it holds.
struct EvidentPart {
    part: usize,
    kind: EvidentKind,
}

enum EvidentKind {
    /// The text's only turn to a side; the walk has one clear turn to that side, at this place.
    Turn(usize),
    /// The text's only climb.
    Climb,
}

/// The figures of an alignment over texts with people's stretches. Distances are viewpoints; shares are percent of the boundaries between parts.
#[derive(Debug, Default, Serialize)]
pub(super) struct AlignmentFigures {
    texts: usize,
    boundaries: usize,
    /// Boundaries at people's place, by the likeliest place.
    exact_pct: f64,
    /// The same, as the alignment itself expects it.
    expected_exact_pct: f64,
    /// At most one viewpoint from people's, by the median.
    within_one_pct: f64,
    /// Mean distance from people's, by the median.
    mean_error: f64,
    /// The same with weights that know only how many words the parts have.
    exact_pct_words_hidden: f64,
    mean_error_words_hidden: f64,
    /// The same where all parts are equally long; halves are rounded up.
    exact_pct_equal_parts: f64,
    mean_error_equal_parts: f64,
    /// The same where parts are as long as their words, rounded up.
    exact_pct_by_words: f64,
    mean_error_by_words: f64,
    /// Texts with one turn to a side on walks with one clear turn to it (60 degrees or more, no other of 25 or more).
    clear_turns: usize,
    /// Of these, the parts that begin at that turn, and those whose stretch holds it.
    turn_begins_pct: f64,
    turn_held_pct: f64,
    /// The same for people's stretches.
    turn_begins_pct_people: f64,
    turn_held_pct_people: f64,
    /// Boundaries before the text's only climb.
    climbs: usize,
    climb_exact_pct: f64,
    climb_mean_error: f64,
}

/// A turn of at least this angle is clear, degrees.
const CLEAR_DEG: f64 = 60.0;
/// A clear turn must be the only one of at least this angle to its side, degrees.
const OTHER_DEG: f64 = 25.0;

impl<'a> AlignedCase<'a> {
    pub(super) fn new(
        text: &'a PeopleAlignedText,
        parted: &'a PartedText,
        scene: &FollowerScene,
        walk: &[usize],
        case: AlignmentCase<'a>,
    ) -> Self {
        let tree = WalkTree::single_walk(&scene.building, walk, text.heading_rad);
        let turns_deg: Vec<f64> = tree.turns_rad(tree.len() - 1).into_iter().map(f64::to_degrees).collect();
        let mut evident = Vec::new();
        for side in [Side::Left, Side::Right] {
            let sign = if side == Side::Left { -1.0 } else { 1.0 };
            let told: Vec<usize> = parted.parts_with_turn(side);
            // The opening turn is seldom told, and no boundary lies there.
            let inner = || turns_deg.iter().enumerate().skip(1).map(|(place, deg)| (place, deg * sign));
            let wide: Vec<usize> = inner().filter(|(_, deg)| *deg >= OTHER_DEG).map(|(place, _)| place).collect();
            let clear = wide.first().copied().filter(|place| wide.len() == 1 && turns_deg[*place] * sign >= CLEAR_DEG);
            if let (&[part], Some(place)) = (told.as_slice(), clear) {
                evident.push(EvidentPart { part, kind: EvidentKind::Turn(place) });
            }
        }
        if let [part] = parted.parts_with_climb().as_slice() {
            evident.push(EvidentPart { part: *part, kind: EvidentKind::Climb });
        }
        evident.retain(|evident| evident.part > 0);
        Self { text, parted, case, evident }
    }

    /// People's boundary behind each part but the last.
    fn boundaries(&self) -> impl Iterator<Item = usize> + '_ {
        let stretches = &self.text.stretches;
        stretches.iter().take(stretches.len() - 1).map(|stretch| stretch[1])
    }

    /// Where the boundaries lie if each part has a share of the walk, rounded up. `share` is the share of all parts up to a part.
    fn boundaries_by_share<'b>(&'b self, share: impl Fn(usize) -> f64 + 'b) -> impl Iterator<Item = usize> + 'b {
        let hops = (self.text.walk.len() - 1) as f64;
        (1..self.text.stretches.len()).map(move |parts| (share(parts) * hops - 1e-9).ceil().max(0.0) as usize)
    }
}

/// Sums over boundaries.
#[derive(Default)]
struct BoundarySums {
    count: usize,
    exact: f64,
    within_one: f64,
    error: f64,
}

impl BoundarySums {
    fn add(&mut self, place: usize, known: usize) {
        let off = place.abs_diff(known);
        self.count += 1;
        self.exact += f64::from(u8::from(off == 0));
        self.within_one += f64::from(u8::from(off <= 1));
        self.error += off as f64;
    }

    fn percent(&self, sum: f64) -> f64 {
        100.0 * self.mean(sum)
    }

    fn mean(&self, sum: f64) -> f64 {
        sum / self.count.max(1) as f64
    }
}

/// A text with its alignments: by its words, and by word counts alone.
pub(super) type AlignedPair<'a> = (&'a AlignedCase<'a>, [WalkAlignment; 2]);

/// Aligns texts with both sets of weights: for all words, and for word counts.
pub(super) fn align_all<'a>(cases: &[&'a AlignedCase<'a>], weights: &[AlignmentWeights; 2]) -> Vec<AlignedPair<'a>> {
    cases.par_iter().map(|case| (*case, weights.each_ref().map(|weights| case.case.align_parts(weights)))).collect()
}

impl AlignmentFigures {
    /// Measures alignments of texts.
    pub(super) fn measure(aligned: &[AlignedPair<'_>]) -> Self {
        let [mut likeliest, mut median, mut hidden_likeliest, mut hidden, mut equal, mut by_words, mut climb] =
            std::array::from_fn(|_| BoundarySums::default());
        let mut expected = 0.0;
        let mut turns = 0;
        // By the alignment, and by people.
        let [mut begins, mut held] = [[0; 2]; 2];
        for (case, [read, blind]) in aligned {
            let count = case.text.stretches.len();
            for (part, known) in case.boundaries().enumerate() {
                let place = read.parts[part].likeliest_end();
                likeliest.add(place, known);
                expected += read.parts[part].end_shares[place];
                median.add(read.parts[part].median_end(), known);
                hidden_likeliest.add(blind.parts[part].likeliest_end(), known);
                hidden.add(blind.parts[part].median_end(), known);
            }
            let words: Vec<usize> = case.parted.parts.iter().map(|part| part.word_count).collect();
            let all = words.iter().sum::<usize>().max(1) as f64;
            let shares = case.boundaries_by_share(|parts| parts as f64 / count as f64);
            shares.zip(case.boundaries()).for_each(|(place, known)| equal.add(place, known));
            let shares = case.boundaries_by_share(|parts| words[..parts].iter().sum::<usize>() as f64 / all);
            shares.zip(case.boundaries()).for_each(|(place, known)| by_words.add(place, known));
            for EvidentPart { part, kind } in &case.evident {
                let begin = read.parts[part - 1].likeliest_end();
                let known = case.text.stretches[*part];
                match kind {
                    EvidentKind::Turn(place) => {
                        turns += 1;
                        let stretches = [[begin, read.parts[*part].likeliest_end()], known];
                        for (by, [from, to]) in stretches.into_iter().enumerate() {
                            begins[by] += usize::from(from == *place);
                            held[by] += usize::from(from <= *place && *place < to);
                        }
                    }
                    EvidentKind::Climb => climb.add(begin, known[0]),
                }
            }
        }
        let share = |part: usize, whole: usize| 100.0 * part as f64 / whole.max(1) as f64;
        Self {
            texts: aligned.len(),
            boundaries: median.count,
            exact_pct: likeliest.percent(likeliest.exact),
            expected_exact_pct: likeliest.percent(expected),
            within_one_pct: median.percent(median.within_one),
            mean_error: median.mean(median.error),
            exact_pct_words_hidden: hidden_likeliest.percent(hidden_likeliest.exact),
            mean_error_words_hidden: hidden.mean(hidden.error),
            exact_pct_equal_parts: equal.percent(equal.exact),
            mean_error_equal_parts: equal.mean(equal.error),
            exact_pct_by_words: by_words.percent(by_words.exact),
            mean_error_by_words: by_words.mean(by_words.error),
            clear_turns: turns,
            turn_begins_pct: share(begins[0], turns),
            turn_held_pct: share(held[0], turns),
            turn_begins_pct_people: share(begins[1], turns),
            turn_held_pct_people: share(held[1], turns),
            climbs: climb.count,
            climb_exact_pct: climb.percent(climb.exact),
            climb_mean_error: climb.mean(climb.error),
        }
    }

    /// The figures as text.
    pub(super) fn to_lines(&self) -> String {
        format!(
            "{} boundaries of {} texts\n\
             aligned:       exact {:.1} % (expected {:.1}), within one {:.1} %, mean error {:.3}\n\
             words hidden:  exact {:.1} %, mean error {:.3}\n\
             equal parts:   exact {:.1} %, mean error {:.3}\n\
             by words:      exact {:.1} %, mean error {:.3}\n\
             the only clear turn ({}): its part begins there {:.1} %, holds it {:.1} % (people {:.1}, {:.1})\n\
             before the only climb ({}): exact {:.1} %, mean error {:.3}",
            self.boundaries,
            self.texts,
            self.exact_pct,
            self.expected_exact_pct,
            self.within_one_pct,
            self.mean_error,
            self.exact_pct_words_hidden,
            self.mean_error_words_hidden,
            self.exact_pct_equal_parts,
            self.mean_error_equal_parts,
            self.exact_pct_by_words,
            self.mean_error_by_words,
            self.clear_turns,
            self.turn_begins_pct,
            self.turn_held_pct,
            self.turn_begins_pct_people,
            self.turn_held_pct_people,
            self.climbs,
            self.climb_exact_pct,
            self.climb_mean_error,
        )
    }
}
