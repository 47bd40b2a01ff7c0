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
    /// The meaning of a box's score in words, if a detector gives the boxes.
    pub(super) score: Option<String>,
    /// Whether the grounders look at pictures. Otherwise they read labels.
    pub(super) need_pictures: bool,
}

impl ComparisonGrounders {
    /// The grounders that a comparison names, before its detector is loaded.
    ///
    /// # Errors
    /// When there is none of that name, or its model cannot be loaded.
    pub(super) fn open(config: &ComparisonSettings, output: &CommandOutput) -> Result<Self, CommandError> {
        let with_labels = |open_grounder: &dyn Fn(GrounderScope) -> Box<dyn PhraseGrounder>| Self {
            views: open_grounder(GrounderScope::Views),
            boxes: open_grounder(GrounderScope::Boxes),
            score: None,
            need_pictures: false,
        };
        let lexical = || with_labels(&|scope| Box::new(LexicalGrounder::new(scope)));
        match (config.grounder.as_str(), &config.encoder) {
            // Once the detector is loaded, `with_detector` replaces both grounders.
            _ if config.detects_views() && config.detector.is_some() => Ok(lexical()),
            _ if config.detects_views() => Err(CommandError::usage(
                "--grounder detector: no detector is named",
                "name one, as in --detector hf/google/owlv2-base-patch16-ensemble",
            )),
            ("labels", Some(encoder)) => {
                let encoder = Arc::from(encoder::open_encoder(encoder)?);
                Ok(with_labels(&|scope| Box::new(EncoderGrounder::new(scope, Arc::clone(&encoder)))))
            }
            ("labels/lexical", _) => Ok(lexical()),
            (name, _) if name.starts_with("hf/") => {
                let walks_by_boxes = config.agents.iter().any(|agent| agent == super::thresholds::GLIP_NAV_AGENT_NAME);
                if walks_by_boxes && config.detector.is_none() {
                    return Err(CommandError::usage(
                        format!("--grounder {name}: glip-nav needs a detector, and none is named"),
                        "name one, as in --detector hf/google/owlv2-base-patch16-ensemble, or leave glip-nav out with --agents clip-nav,seq-clip-nav",
                    ));
                }
                // Without a detector no agent looks for boxes, so the lexical grounder for boxes is never asked.
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
        config: &ComparisonSettings,
        calls: Option<&ModelCalls>,
    ) -> Result<Self, CommandError> {
        let Some((name, calls)) = config.detector.as_deref().zip(calls) else { return Ok(self) };
        let detector = calls.open_detector(name)?;
        let grounded = || Box::new(DetectorGrounder::new(Arc::clone(&detector)));
        let views: Box<dyn PhraseGrounder> = if config.detects_views() { grounded() } else { self.views };
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
