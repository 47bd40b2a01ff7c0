//! The parameters of the agents that walk by phrases. The papers do not publish them; the defaults come from our sweeps.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How an agent that walks by phrases decides. Neither paper publishes these (arXiv 2211.16649; arXiv 2403.11487, section 4).
///
/// The defaults were swept on REVERIE's train split: `wayword-measure sweep` repeats that.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PhraseWalkParameters {
    /// A key phrase is done when its score in the best view is at least this; the next one is current from the next step on.
    pub phrase_threshold: f32,
    /// The walk ends when the activity has at least this score in any view.
    pub stop_threshold: f32,
    /// The activity only counts when at most this many key phrases are left.
    pub stop_with_phrases_left: usize,
    /// Most hops, those back included.
    pub max_hops: usize,
    /// Whether the agent only goes to the neighbours at which it has been the fewest times.
    pub shun_visited: bool,
    /// Going back; `None` for an agent that never does.
    pub back: Option<BacktrackParameters>,
}

/// When and how far an agent goes back.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BacktrackParameters {
    /// The sequence score is the mean, over this many looks, of how well the current phrase fits the best view.
    pub window: usize,
    /// The agent goes back when the sequence score is below this.
    pub threshold: f32,
    /// How many nodes it goes back.
    pub nodes: usize,
}

/// As many phrases as an instruction can have: the activity always counts.
const ANY_PHRASES_LEFT: usize = 12;

impl PhraseWalkParameters {
    /// The default parameters of an agent with a grounder: `clip-nav` never goes back, `glip-nav` uses boxes.
    #[must_use]
    pub fn default_of(agent: &str, grounder: &str) -> Self {
        let by_boxes = agent == "glip-nav";
        let (phrase_threshold, stop_threshold, stop_with_phrases_left, back) = match (grounder, by_boxes) {
            // Cosines of a sentence encoder between a phrase and a name.
            ("labels", false) => {
                (0.8, 0.4, ANY_PHRASES_LEFT, BacktrackParameters { window: 8, threshold: 0.2, nodes: 1 })
            }
            ("labels", true) => {
                (0.6, 0.6, ANY_PHRASES_LEFT, BacktrackParameters { window: 8, threshold: 0.05, nodes: 2 })
            }
            // Shares of the named places that the labels have.
            ("labels/lexical", false) => (0.6, 0.4, 1, BacktrackParameters { window: 12, threshold: 0.05, nodes: 1 }),
            ("labels/lexical", true) => {
                (0.6, 0.3, ANY_PHRASES_LEFT, BacktrackParameters { window: 12, threshold: 0.05, nodes: 4 })
            }
            // Scores of a detector's boxes. Not swept: there were no weights. At half of the full score, detectors' makers show a
            // box.
            ("detector", _) => {
                (0.5, 0.5, ANY_PHRASES_LEFT, BacktrackParameters { window: 8, threshold: 0.1, nodes: 1 })
            }
            // Cosines of CLIP between a phrase and a picture, all close to each other. Not swept: there were no photographs.
            _ => (0.26, 0.28, 0, BacktrackParameters { window: 8, threshold: 0.2, nodes: 1 }),
        };
        Self {
            phrase_threshold,
            stop_threshold,
            stop_with_phrases_left,
            max_hops: 40,
            shun_visited: true,
            back: (agent != "clip-nav").then_some(back),
        }
    }

    /// All of them by name, for reports.
    #[must_use]
    pub fn by_name(&self) -> BTreeMap<String, String> {
        let mut named = BTreeMap::from([
            ("phrase_threshold", self.phrase_threshold.to_string()),
            ("stop_threshold", self.stop_threshold.to_string()),
            ("stop_with_phrases_left", self.stop_with_phrases_left.to_string()),
            ("max_hops", self.max_hops.to_string()),
            ("shun_visited", self.shun_visited.to_string()),
        ]);
        if let Some(back) = self.back {
            named.insert("back.window", back.window.to_string());
            named.insert("back.threshold", back.threshold.to_string());
            named.insert("back.nodes", back.nodes.to_string());
        }
        named.into_iter().map(|(name, value)| (name.to_owned(), value)).collect()
    }
}
