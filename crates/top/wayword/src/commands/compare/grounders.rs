//! Grounders by their names.

use super::kept::Kept;
use crate::{calls::Calls, encoder, error::Error, output::Output};
use std::sync::Arc;
use wayword_core::{Detector, Grounded, Grounder};
use wayword_navigation::grounders::{Lexical, Sees, Similar};

/// What scores views in a comparison.
pub(super) struct Grounders {
    /// For agents that look at whole views.
    pub(super) views: Box<dyn Grounder>,
    /// For agents that look for boxes.
    pub(super) boxes: Box<dyn Grounder>,
    /// What a score of a box is, where a detector gives it.
    pub(super) score: Option<String>,
    /// Whether they look at pictures.
    pub(super) need_pictures: bool,
}

impl Grounders {
    /// The grounders that a comparison names.
    ///
    /// # Errors
    /// When there is none of that name, or its model cannot be loaded.
    pub(super) fn open(kept: &Kept, calls: Option<&Calls>, output: &Output) -> Result<Self, Error> {
        let detector = kept.detector.as_deref().zip(calls).map(|(name, calls)| calls.detector(name)).transpose()?;
        if kept.detects_views() {
            return Self::by_detector(detector);
        }
        let (score, need_pictures) = (detector.as_ref().map(score), detector.is_some());
        let detector = detector.map(|detector| Box::new(Grounded::new(detector)) as Box<dyn Grounder>);
        let of = |labels: &dyn Fn(Sees) -> Box<dyn Grounder>, detector: Option<Box<dyn Grounder>>| Self {
            views: labels(Sees::Views),
            boxes: detector.unwrap_or_else(|| labels(Sees::Boxes)),
            score: score.clone(),
            need_pictures,
        };
        match (kept.grounder.as_str(), &kept.encoder) {
            ("labels", Some(encoder)) => {
                let encoder = Arc::from(encoder::encoder(encoder)?);
                Ok(of(&|sees| Box::new(Similar::new(sees, Arc::clone(&encoder))), detector))
            }
            ("labels/lexical", _) => Ok(of(&|sees| Box::new(Lexical::new(sees)), detector)),
            (name, _) if name.starts_with("hf/") => {
                let walks_by_boxes = kept.agents.iter().any(|agent| agent == super::agents::BY_DETECTOR);
                if walks_by_boxes && detector.is_none() {
                    return Err(Error::usage(
                        format!("--grounder {name}: glip-nav needs a detector, and none is named"),
                        "name one, as in --detector hf/google/owlv2-base-patch16-ensemble, or leave glip-nav out with --agents clip-nav,seq-clip-nav",
                    ));
                }
                // Without a detector, no agent looks for boxes.
                let boxes = detector.unwrap_or_else(|| Box::new(Lexical::new(Sees::Boxes)));
                Ok(Self { views: clip(name, output)?, boxes, score, need_pictures: true })
            }
            (name, _) => Err(Error::usage(
                format!("--grounder {name}: there is no such grounder"),
                "give labels, labels/lexical, detector (with --detector), or a CLIP model as hf/openai/clip-vit-base-patch32",
            )),
        }
    }

    /// The detector scores whole views too.
    fn by_detector(detector: Option<Arc<dyn Detector>>) -> Result<Self, Error> {
        let Some(detector) = detector else {
            return Err(Error::usage(
                "--grounder detector: no detector is named",
                "name one, as in --detector hf/google/owlv2-base-patch16-ensemble",
            ));
        };
        let score = Some(score(&detector));
        let views = Box::new(Grounded::new(Arc::clone(&detector)));
        Ok(Self { views, boxes: Box::new(Grounded::new(detector)), score, need_pictures: true })
    }
}

fn score(detector: &Arc<dyn Detector>) -> String {
    detector.scoring().means.to_owned()
}

#[cfg(feature = "local")]
fn clip(name: &str, output: &Output) -> Result<Box<dyn Grounder>, Error> {
    use crate::download_bar::DownloadBar;
    use wayword_local::{Clip, ClipGrounder, Device, Hub, HubConfig, ModelName, Needs, Precision};
    let needs = Needs::default()
        .weights()
        .required(&["config.json", "tokenizer.json"])
        .optional(&["preprocessor_config.json", "processor_config.json"]);
    let folder =
        Hub::new(HubConfig::from_env()?)?.folder(&ModelName::parse(name)?, &needs, &DownloadBar::new(output))?;
    let clip = Clip::load(name, &folder.path, &Device::cpu(), Precision::F32)?;
    Ok(Box::new(ClipGrounder::new(clip)))
}

#[cfg(not(feature = "local"))]
fn clip(name: &str, _: &Output) -> Result<Box<dyn Grounder>, Error> {
    Err(Error::usage(
        format!("--grounder {name}: this build runs no models in process"),
        "build it with `cargo build --release --features full`, or use --grounder labels/lexical",
    ))
}
