//! Reads `preprocessor_config.json`, which prescribes how pictures are resized, cropped and normalised.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

use super::{PictureProcessor, ResizeRule, resample::ResampleFilter};
use crate::{LocalError, json};
use serde::Deserialize;
use std::path::Path;

/// The longest edge of a picture that a configuration may ask for, pixels. A longer one is refused.
const MAX_EDGE_PX: usize = 2048;

/// OpenAI's means and standard deviations of red, green and blue, which CLIP and BLIP share.
const CLIP_MEANS_RGB: [f64; 3] = [0.48145466, 0.4578275, 0.40821073];
const CLIP_DEVIATIONS_RGB: [f64; 3] = [0.26862954, 0.26130258, 0.27577711];

/// `preprocessor_config.json` in its old and new forms.
#[derive(Debug, Deserialize)]
pub(super) struct PictureConfig {
    #[serde(alias = "feature_extractor_type")]
    image_processor_type: Option<String>,
    size: Option<ResizeEdges>,
    crop_size: Option<ResizeEdges>,
    do_resize: Option<bool>,
    do_center_crop: Option<bool>,
    do_rescale: Option<bool>,
    do_normalize: Option<bool>,
    resample: Option<u32>,
    rescale_factor: Option<f64>,
    image_mean: Option<[f64; 3]>,
    image_std: Option<[f64; 3]>,
}

/// A size, in any of the forms that files use.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(untagged)]
enum ResizeEdges {
    /// Both edges, pixels.
    Both { height: usize, width: usize },
    /// The shorter edge, pixels.
    Shortest { shortest_edge: usize },
    /// A single number of pixels: CLIP's shorter edge, or both edges of BLIP.
    One(usize),
}

/// The family of the processor. CLIP and BLIP have different defaults.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ProcessorFamily {
    Clip,
    Blip,
}

impl PictureConfig {
    /// The processor that a model's folder describes.
    pub(super) fn read_processor(folder: &Path) -> Result<PictureProcessor, LocalError> {
        let (config, file): (Self, _) = json::read_picture_config(folder)?;
        config.build_processor().map_err(|problem| LocalError::File {
            file,
            problem,
            hint: "choose a CLIP, BLIP or BLIP-2 model; if this is one, its file is damaged: delete the folder models--ORG--NAME that holds it, and run `wayword models fetch hf/ORG/NAME`",
        })
    }

    fn build_processor(&self) -> Result<PictureProcessor, String> {
        let family = self.processor_family()?;
        if self.do_resize == Some(false) {
            return Err("do_resize: pictures that are not resized are not supported".to_owned());
        }
        let (size, (height_px, width_px)) = self.resize_rule(family)?;
        let filter = match self.resample.unwrap_or(3) {
            2 => ResampleFilter::Bilinear,
            3 => ResampleFilter::Bicubic,
            other => return Err(format!("resample: {other} is neither 2 (bilinear) nor 3 (bicubic)")),
        };
        Ok(PictureProcessor { size, height_px, width_px, filter, numbers: self.byte_values()? })
    }

    /// The family. The oldest files do not name it, and are CLIP's.
    fn processor_family(&self) -> Result<ProcessorFamily, String> {
        match self.image_processor_type.as_deref() {
            None => Ok(ProcessorFamily::Clip),
            Some(name) if name.starts_with("CLIP") => Ok(ProcessorFamily::Clip),
            Some(name) if name.starts_with("Blip") => Ok(ProcessorFamily::Blip),
            Some(name) => Err(format!("image_processor_type: {name} is neither CLIP's nor BLIP's")),
        }
    }

    /// The rule for resizing, and the height and width of the output.
    fn resize_rule(&self, family: ProcessorFamily) -> Result<(ResizeRule, (usize, usize)), String> {
        let size = self.size.unwrap_or(match family {
            ProcessorFamily::Clip => ResizeEdges::Shortest { shortest_edge: 224 },
            ProcessorFamily::Blip => ResizeEdges::Both { height: 384, width: 384 },
        });
        let size = match (size, family) {
            (ResizeEdges::One(edge), ProcessorFamily::Clip) => ResizeEdges::Shortest { shortest_edge: edge },
            (ResizeEdges::One(edge), ProcessorFamily::Blip) => ResizeEdges::Both { height: edge, width: edge },
            (size, _) => size,
        };
        let crops = self.do_center_crop.unwrap_or(family == ProcessorFamily::Clip);
        let crop = match self.crop_size.unwrap_or(ResizeEdges::One(224)) {
            _ if !crops => None,
            ResizeEdges::One(edge) | ResizeEdges::Shortest { shortest_edge: edge } => Some((edge, edge)),
            ResizeEdges::Both { height, width } => Some((height, width)),
        };
        let (size, out) = match (size, crop) {
            (ResizeEdges::Both { height, width }, None) => {
                (ResizeRule::Whole, (check_edge(height)?, check_edge(width)?))
            }
            (ResizeEdges::Both { height, width }, Some(crop)) => {
                (ResizeRule::Cropped(check_edge(height)?, check_edge(width)?), crop)
            }
            (ResizeEdges::Shortest { shortest_edge: edge } | ResizeEdges::One(edge), Some(crop)) => {
                (ResizeRule::ShortestEdge(check_edge(edge)?), crop)
            }
            _ => return Err("size: with only a shortest edge, pictures must be cropped".to_owned()),
        };
        Ok((size, (check_edge(out.0)?, check_edge(out.1)?)))
    }

    /// The model's input for each value of a byte, for each colour.
    fn byte_values(&self) -> Result<[[f32; 256]; 3], String> {
        let factor = if self.do_rescale == Some(false) { 1.0 } else { self.rescale_factor.unwrap_or(1.0 / 255.0) };
        let (mean, deviation) = match self.do_normalize {
            Some(false) => ([0.0; 3], [1.0; 3]),
            _ => (self.image_mean.unwrap_or(CLIP_MEANS_RGB), self.image_std.unwrap_or(CLIP_DEVIATIONS_RGB)),
        };
        if deviation.contains(&0.0) || !deviation.iter().chain(&mean).chain([&factor]).all(|number| number.is_finite())
        {
            return Err("image_mean, image_std and rescale_factor must be finite, and image_std not 0".to_owned());
        }
        #[allow(clippy::cast_possible_truncation, reason = "the models compute with 32 bit floats")]
        let values = |mean: f64, deviation: f64| {
            std::array::from_fn(|byte| ((byte as f64 * factor) as f32 - mean as f32) / deviation as f32)
        };
        let ([red, green, blue], [red_deviation, green_deviation, blue_deviation]) = (mean, deviation);
        Ok([values(red, red_deviation), values(green, green_deviation), values(blue, blue_deviation)])
    }
}

fn check_edge(edge: usize) -> Result<usize, String> {
    match edge {
        1..=MAX_EDGE_PX => Ok(edge),
        _ => Err(format!("size: an edge of {edge} pixels is not between 1 and {MAX_EDGE_PX}")),
    }
}
