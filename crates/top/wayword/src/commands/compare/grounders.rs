//! Grounders by their names.

use super::kept::Kept;
use crate::{encoder, error::Error, output::Output};
use std::sync::Arc;
use wayword_core::Grounder;
use wayword_navigation::grounders::{Lexical, Sees, Similar};

/// What scores views in a comparison.
pub(super) struct Grounders {
    /// For agents that look at whole views.
    pub(super) views: Box<dyn Grounder>,
    /// For agents that look for boxes.
    pub(super) boxes: Box<dyn Grounder>,
    /// Whether they look at pictures.
    pub(super) need_pictures: bool,
}

impl Grounders {
    /// The grounders that a comparison names.
    ///
    /// # Errors
    /// When there is none of that name, or its model cannot be loaded.
    pub(super) fn open(kept: &Kept, output: &Output) -> Result<Self, Error> {
        match (kept.grounder.as_str(), &kept.encoder) {
            ("labels", Some(encoder)) => {
                let encoder = Arc::from(encoder::encoder(encoder)?);
                let grounder = |sees| Box::new(Similar::new(sees, Arc::clone(&encoder)));
                Ok(Self { views: grounder(Sees::Views), boxes: grounder(Sees::Boxes), need_pictures: false })
            }
            ("labels/lexical", _) => {
                let grounder = |sees| Box::new(Lexical::new(sees));
                Ok(Self { views: grounder(Sees::Views), boxes: grounder(Sees::Boxes), need_pictures: false })
            }
            (name, _) if name.starts_with("hf/") => {
                let by_detector = kept.agents.iter().any(|agent| agent == super::agents::BY_DETECTOR);
                if by_detector {
                    return Err(Error::usage(
                        format!("--grounder {name}: glip-nav needs a detector, and this program has no GLIP network"),
                        "leave glip-nav out with --agents clip-nav,seq-clip-nav, or use --grounder labels, whose detector reads labels",
                    ));
                }
                // No agent looks for boxes then.
                let boxes = Box::new(Lexical::new(Sees::Boxes));
                Ok(Self { views: clip(name, output)?, boxes, need_pictures: true })
            }
            (name, _) => Err(Error::usage(
                format!("--grounder {name}: there is no such grounder"),
                "give labels, labels/lexical, or a CLIP model as hf/openai/clip-vit-base-patch32",
            )),
        }
    }
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
