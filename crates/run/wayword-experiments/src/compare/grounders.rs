//! Opens the grounders that `--grounder` and `--detector` name.

use super::kept::Kept;
use crate::encoder;
use std::sync::Arc;
use wayword_core::{Detector, Grounded, Grounder};
use wayword_navigation::grounders::{Lexical, Sees, Similar};
use wayword_run::{calls::Calls, error::Error, output::Output};

/// The grounders of a comparison, which score how well a phrase fits a view.
pub(super) struct Grounders {
    /// For agents that look at whole views.
    pub(super) views: Box<dyn Grounder>,
    /// For agents that look for boxes.
    pub(super) boxes: Box<dyn Grounder>,
    /// The meaning of a box's score, if a detector gives it.
    pub(super) score: Option<String>,
    /// Whether they look at pictures.
    pub(super) need_pictures: bool,
}

impl Grounders {
    /// The grounders that a comparison names, before its detector is loaded.
    ///
    /// # Errors
    /// When there is none of that name, or its model cannot be loaded.
    pub(super) fn open(kept: &Kept, output: &Output) -> Result<Self, Error> {
        let of = |labels: &dyn Fn(Sees) -> Box<dyn Grounder>| Self {
            views: labels(Sees::Views),
            boxes: labels(Sees::Boxes),
            score: None,
            need_pictures: false,
        };
        let lexical = || of(&|sees| Box::new(Lexical::new(sees)));
        match (kept.grounder.as_str(), &kept.encoder) {
            // The detector takes the place of both.
            _ if kept.detects_views() && kept.detector.is_some() => Ok(lexical()),
            _ if kept.detects_views() => Err(Error::usage(
                "--grounder detector: no detector is named",
                "name one, as in --detector hf/google/owlv2-base-patch16-ensemble",
            )),
            ("labels", Some(encoder)) => {
                let encoder = Arc::from(encoder::encoder(encoder)?);
                Ok(of(&|sees| Box::new(Similar::new(sees, Arc::clone(&encoder)))))
            }
            ("labels/lexical", _) => Ok(lexical()),
            (name, _) if name.starts_with("hf/") => {
                let walks_by_boxes = kept.agents.iter().any(|agent| agent == super::agents::BY_DETECTOR);
                if walks_by_boxes && kept.detector.is_none() {
                    return Err(Error::usage(
                        format!("--grounder {name}: glip-nav needs a detector, and none is named"),
                        "name one, as in --detector hf/google/owlv2-base-patch16-ensemble, or leave glip-nav out with --agents clip-nav,seq-clip-nav",
                    ));
                }
                // Without a detector, no agent looks for boxes.
                Ok(Self { views: clip(name, output)?, need_pictures: true, ..lexical() })
            }
            (name, _) => Err(Error::usage(
                format!("--grounder {name}: there is no such grounder"),
                "give labels, labels/lexical, detector (with --detector), or a CLIP model as hf/openai/clip-vit-base-patch32",
            )),
        }
    }

    /// Replaces grounders by the comparison's detector, if it names one.
    ///
    /// # Errors
    /// When it cannot be loaded.
    pub(super) fn with_detector(self, kept: &Kept, calls: Option<&Calls>) -> Result<Self, Error> {
        let Some((name, calls)) = kept.detector.as_deref().zip(calls) else { return Ok(self) };
        let detector = calls.detector(name)?;
        let grounded = || Box::new(Grounded::new(Arc::clone(&detector)));
        let views: Box<dyn Grounder> = if kept.detects_views() { grounded() } else { self.views };
        Ok(Self { views, boxes: grounded(), score: Some(score(&detector)), need_pictures: true })
    }
}

fn score(detector: &Arc<dyn Detector>) -> String {
    detector.scoring().means.to_owned()
}

#[cfg(feature = "local")]
fn clip(name: &str, output: &Output) -> Result<Box<dyn Grounder>, Error> {
    Ok(Box::new(wayword_run::clip::grounder(name, output)?))
}

#[cfg(not(feature = "local"))]
fn clip(name: &str, _: &Output) -> Result<Box<dyn Grounder>, Error> {
    Err(Error::usage(
        format!("--grounder {name}: this build runs no models in process"),
        "build it with `cargo build --release --features full`, or use --grounder labels/lexical",
    ))
}
