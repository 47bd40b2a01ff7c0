//! Opens the grounders that `--grounder` and `--detector` name.

use super::settings::ComparisonSettings;
use crate::encoder;
use std::sync::Arc;
use wayword_core::{DetectorGrounder, ObjectDetector, PhraseGrounder};
use wayword_navigation::grounders::{EncoderGrounder, GrounderScope, LexicalGrounder};
use wayword_run::{calls::ModelCalls, error::CommandError, output::CommandOutput};

/// The grounders of a comparison, which score how well a phrase fits a view.
pub(super) struct ComparisonGrounders {
    /// For agents that look at whole views.
    pub(super) views: Box<dyn PhraseGrounder>,
    /// For agents that look for boxes.
    pub(super) boxes: Box<dyn PhraseGrounder>,
    /// The meaning of a box's score, if a detector gives it.
    pub(super) score: Option<String>,
    /// Whether they look at pictures.
    pub(super) need_pictures: bool,
}

impl ComparisonGrounders {
    /// The grounders that a comparison names, before its detector is loaded.
    ///
    /// # Errors
    /// When there is none of that name, or its model cannot be loaded.
    pub(super) fn open(kept: &ComparisonSettings, output: &CommandOutput) -> Result<Self, CommandError> {
        let of = |labels: &dyn Fn(GrounderScope) -> Box<dyn PhraseGrounder>| Self {
            views: labels(GrounderScope::Views),
            boxes: labels(GrounderScope::Boxes),
            score: None,
            need_pictures: false,
        };
        let lexical = || of(&|sees| Box::new(LexicalGrounder::new(sees)));
        match (kept.grounder.as_str(), &kept.encoder) {
            // The detector takes the place of both.
            _ if kept.detects_views() && kept.detector.is_some() => Ok(lexical()),
            _ if kept.detects_views() => Err(CommandError::usage(
                "--grounder detector: no detector is named",
                "name one, as in --detector hf/google/owlv2-base-patch16-ensemble",
            )),
            ("labels", Some(encoder)) => {
                let encoder = Arc::from(encoder::open_encoder(encoder)?);
                Ok(of(&|sees| Box::new(EncoderGrounder::new(sees, Arc::clone(&encoder)))))
            }
            ("labels/lexical", _) => Ok(lexical()),
            (name, _) if name.starts_with("hf/") => {
                let walks_by_boxes = kept.agents.iter().any(|agent| agent == super::thresholds::BY_DETECTOR);
                if walks_by_boxes && kept.detector.is_none() {
                    return Err(CommandError::usage(
                        format!("--grounder {name}: glip-nav needs a detector, and none is named"),
                        "name one, as in --detector hf/google/owlv2-base-patch16-ensemble, or leave glip-nav out with --agents clip-nav,seq-clip-nav",
                    ));
                }
                // Without a detector, no agent looks for boxes.
                Ok(Self { views: load_clip_grounder(name, output)?, need_pictures: true, ..lexical() })
            }
            (name, _) => Err(CommandError::usage(
                format!("--grounder {name}: there is no such grounder"),
                "give labels, labels/lexical, detector (with --detector), or a CLIP model as hf/openai/clip-vit-base-patch32",
            )),
        }
    }

    /// Replaces grounders by the comparison's detector, if it names one.
    ///
    /// # Errors
    /// When it cannot be loaded.
    pub(super) fn with_detector(
        self,
        kept: &ComparisonSettings,
        calls: Option<&ModelCalls>,
    ) -> Result<Self, CommandError> {
        let Some((name, calls)) = kept.detector.as_deref().zip(calls) else { return Ok(self) };
        let detector = calls.open_detector(name)?;
        let grounded = || Box::new(DetectorGrounder::new(Arc::clone(&detector)));
        let views: Box<dyn PhraseGrounder> = if kept.detects_views() { grounded() } else { self.views };
        Ok(Self { views, boxes: grounded(), score: Some(scoring_meaning(&detector)), need_pictures: true })
    }
}

fn scoring_meaning(detector: &Arc<dyn ObjectDetector>) -> String {
    detector.scoring().means.to_owned()
}

#[cfg(feature = "local")]
fn load_clip_grounder(name: &str, output: &CommandOutput) -> Result<Box<dyn PhraseGrounder>, CommandError> {
    Ok(Box::new(wayword_run::clip::load_grounder(name, output)?))
}

#[cfg(not(feature = "local"))]
fn load_clip_grounder(name: &str, _: &CommandOutput) -> Result<Box<dyn PhraseGrounder>, CommandError> {
    Err(CommandError::usage(
        format!("--grounder {name}: this build runs no models in process"),
        "build it with `cargo build --release --features full`, or use --grounder labels/lexical",
    ))
}
