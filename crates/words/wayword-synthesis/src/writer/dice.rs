//! What a text draws by chance. Each draw has a name, so that no draw depends on those before it: what a thing draws stays as it
//! is where another thing comes or goes.

use super::{Brief, Complaint};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use wayword_core::{Check, Verdict, rng, seed};

/// Draws by name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dice {
    seed: u64,
}

impl Dice {
    /// The draws of one text. Where only landmarks of earlier texts were wrong, it draws what they drew, and the writer
    /// avoids the landmarks.
    pub(super) fn of(brief: &Brief<'_>) -> Self {
        let (attempt, candidate) = (drawn_before(brief.complaints).to_string(), brief.candidate.to_string());
        let names = ["rules", &brief.style.name, &brief.walk.path.id, &attempt, &candidate];
        Self { seed: seed::derive(brief.seed, &names) }
    }

    /// Other draws by the same names.
    pub(super) fn other(self, number: usize) -> Self {
        Self { seed: seed::derive(self.seed, &["other", &number.to_string()]) }
    }

    /// What is drawn by some names.
    pub(super) fn by(self, names: &[&str]) -> ChaCha8Rng {
        rng(self.seed, names)
    }

    /// A share from 0 to 1 for the place of that number among several: places in a row get shares that lie apart.
    pub(super) fn in_turn(self, purpose: &str, number: usize) -> f64 {
        (self.by(&[purpose]).random_range(0.0..1.0) + number as f64 * GOLDEN).fract()
    }

    /// What is drawn for one purpose at a frame.
    pub(super) fn at(self, purpose: &str, frame: usize) -> ChaCha8Rng {
        self.by(&[purpose, &frame.to_string()])
    }
}

/// Multiples of the golden ratio, without their whole parts, spread evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// How many of the earlier texts have to be drawn anew: those with other faults than landmarks, and those that came twice.
fn drawn_before(complaints: &[Complaint]) -> usize {
    let has_other_faults = |complaint: &Complaint| {
        let mut faults = complaint.findings.iter().filter(|finding| finding.verdict != Verdict::Pass);
        faults.any(|finding| finding.check != Check::Landmarks || finding.span.is_none())
    };
    let came_before = |at: usize| complaints[..at].iter().any(|before| before.text == complaints[at].text);
    (0..complaints.len()).filter(|at| has_other_faults(&complaints[*at]) || came_before(*at)).count()
}
