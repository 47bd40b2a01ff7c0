//! Random draws for one text, each by a name such as "stop". Each name has its own random generator, so a draw does not
//! depend on the draws before it: if one thing of the walk changes, the words for the others stay the same.

use super::{TextComplaint, WritingBrief};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{CheckKind, Verdict, seed, seeded_rng};

/// The source of all random draws of one text.
#[derive(Debug, Clone, Copy)]
pub(super) struct TextDice {
    seed: u64,
}

impl TextDice {
    /// The draws of one text. If an earlier text failed only because of its landmarks, the next one draws the same
    /// values and avoids these landmarks.
    pub(super) fn for_brief(brief: &WritingBrief<'_>) -> Self {
        let (attempt, candidate) = (drawn_before(brief.complaints).to_string(), brief.candidate.to_string());
        let names = ["rules", brief.style.draw_name(), &brief.walk.path.id, &attempt, &candidate];
        Self { seed: seed::derive_seed(brief.seed, &names) }
    }

    /// A source of other values for the same names.
    pub(super) fn other_draws(self, number: usize) -> Self {
        Self { seed: seed::derive_seed(self.seed, &["other", &number.to_string()]) }
    }

    /// The random generator for a draw with these names.
    pub(super) fn named_rng(self, names: &[&str]) -> ChaCha8Rng {
        seeded_rng(self.seed, names)
    }

    /// A value from 0 to 1 for the place with this number. Consecutive places get values far apart.
    pub(super) fn spread_share(self, purpose: &str, number: usize) -> f64 {
        (self.named_rng(&[purpose]).random_range(0.0..1.0) + number as f64 * GOLDEN_RATIO_FRACTION).fract()
    }

    /// The random generator for one purpose at a frame.
    pub(super) fn rng_at_frame(self, purpose: &str, frame: usize) -> ChaCha8Rng {
        self.named_rng(&[purpose, &frame.to_string()])
    }
}

/// Multiples of the golden ratio, without their whole parts, spread evenly.
const GOLDEN_RATIO_FRACTION: f64 = 0.618_033_988_749_894_9;

/// Number of earlier texts after which everything is drawn anew: those with other faults than landmarks, and repeated
/// ones.
fn drawn_before(complaints: &[TextComplaint]) -> usize {
    let has_other_faults = |complaint: &TextComplaint| {
        let mut faults = complaint.findings.iter().filter(|finding| finding.verdict != Verdict::Pass);
        faults.any(|finding| finding.check != CheckKind::Landmarks || finding.span.is_none())
    };
    let came_before = |at: usize| complaints[..at].iter().any(|before| before.text == complaints[at].text);
    (0..complaints.len()).filter(|at| has_other_faults(&complaints[*at]) || came_before(*at)).count()
}
