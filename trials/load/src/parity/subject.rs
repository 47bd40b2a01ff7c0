//! A detector of this program under test, and the comparison of its numbers with the expected ones.

use super::{
    Kind, Off,
    oracle::{Case, Numbers},
    picture,
};
use std::path::Path;
use wayword_core::{Found, Image};
use wayword_local::{Device, Dino, Glip, GlipFiles, Owl, Precision};
use wayword_run::error::Error;

/// A detector of one kind.
pub(super) enum Subject {
    Glip(Box<Glip>),
    Dino(Box<Dino>),
    Owl(Box<Owl>),
}

/// Boxes of two implementations that lie further apart than this are different finds.
const SAME_PX: f32 = 1.0;

impl Subject {
    /// Loads a detector from a folder. `short_px` is the short edge of pictures, for models with no such setting of their own.
    pub(super) fn load(kind: Kind, folder: &Path, short_px: Option<usize>) -> Result<Self, Error> {
        let (device, precision) = (Device::cpu(), Precision::F32);
        Ok(match kind {
            Kind::GlipT => {
                let weights = folder.join("glip.pth");
                let files = GlipFiles { weights, tokenizer: folder.to_owned(), identity: String::new() };
                let short_px = short_px.unwrap_or(Glip::SHORT_EDGE_PX);
                Self::Glip(Box::new(Glip::load("glip", &files, short_px, &device, precision)?))
            }
            Kind::Owlv2Base => Self::Owl(Box::new(Owl::load("owl", folder, &device, precision)?)),
            _ => Self::Dino(Box::new(Dino::load("dino", folder, &device, precision)?)),
        })
    }

    /// Finds phrases in a picture.
    pub(super) fn find(&self, image: &Image, phrases: &[&str]) -> Result<Vec<Vec<Found>>, Error> {
        Ok(match self {
            Self::Glip(glip) => glip.find(image, phrases)?,
            Self::Dino(dino) => dino.find(image, phrases)?,
            Self::Owl(owl) => owl.find(image, phrases)?,
        })
    }

    /// How far its numbers for a case are from the other implementation's.
    pub(super) fn off(&self, case: &Case, theirs: &Numbers<'_>) -> Result<Off, Error> {
        let (image, phrases) = (picture(case.size, 0)?, case.phrases.iter().map(String::as_str).collect::<Vec<_>>());
        let (width, height) = (case.size.0 as f32, case.size.1 as f32);
        match self {
            Self::Glip(glip) => {
                let (logits, _) = glip.raw(&image, &phrases)?;
                let boxes_px = finds_off(&glip.find(&image, &phrases)?, &case.found());
                Ok(Off { logits: off(&logits, &theirs.of("logits")?), boxes_px })
            }
            Self::Dino(dino) => {
                let order: Vec<u32> = theirs.of("picked")?.iter().map(|&at| at as u32).collect();
                let ours = dino.outputs(&image, &phrases, Some(&order))?;
                let boxes = scaled(&ours.boxes.concat(), [width, height]);
                Ok(Off {
                    logits: off(&ours.logits.concat(), &theirs.of("logits")?),
                    // Different candidates have different boxes, so boxes are compared only if the candidates are the same.
                    boxes_px: match same_set(&ours.picked, &order) {
                        true => off(&boxes, &scaled(&theirs.of("boxes")?, [width, height])),
                        false => f32::INFINITY,
                    },
                })
            }
            Self::Owl(owl) => {
                let ours = owl.outputs(&image, &phrases)?;
                let edge = [width.max(height); 2];
                let boxes = scaled(&ours.boxes.concat(), edge);
                Ok(Off {
                    logits: off(&ours.logits.concat(), &theirs.of("logits")?),
                    boxes_px: off(&boxes, &scaled(&theirs.of("boxes")?, edge)),
                })
            }
        }
    }
}

/// The largest absolute difference of two lists; infinite if their lengths differ or a value is not a number.
fn off(ours: &[f32], theirs: &[f32]) -> f32 {
    if ours.len() != theirs.len() {
        return f32::INFINITY;
    }
    let differences = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs());
    differences.map(|off| if off.is_nan() { f32::INFINITY } else { off }).fold(0.0, f32::max)
}

/// Shares of a picture in pixels.
fn scaled(shares: &[f32], edges: [f32; 2]) -> Vec<f32> {
    shares.iter().zip(edges.iter().cycle()).map(|(share, edge)| share * edge).collect()
}

fn same_set(ours: &[u32], theirs: &[u32]) -> bool {
    let sorted = |picked: &[u32]| {
        let mut picked = picked.to_vec();
        picked.sort_unstable();
        picked
    };
    sorted(ours) == sorted(theirs)
}

/// The largest difference between the edges of finds. Finds with nearly equal scores may come in another order. A find without a
/// counterpart gives an infinite difference.
fn finds_off(ours: &[Vec<Found>], theirs: &[Vec<Found>]) -> f32 {
    if ours.len() != theirs.len() {
        return f32::INFINITY;
    }
    let of_phrase = |(ours, theirs): (&Vec<Found>, &Vec<Found>)| {
        let nearest =
            |find: &Found| ours.iter().map(|our| off(&our.box_px, &find.box_px)).fold(f32::INFINITY, f32::min);
        let most = theirs.iter().map(nearest).fold(0.0, f32::max);
        if ours.len() == theirs.len() && most <= SAME_PX { most } else { f32::INFINITY }
    };
    ours.iter().zip(theirs).map(of_phrase).fold(0.0, f32::max)
}
