//! Scores how well a text fits the pictures ahead of a path's frames, with a CLIP model in process ([`PictureScores`] has the figures).
//!
//! CLIP recognises the things in a picture. It hardly distinguishes left from right, and it has no sense of order: a text with
//! all turns the wrong way round scores as well as the right one.

pub mod args;
mod frames;
mod parts;

pub use frames::PathPictures;

use crate::by_pictures::args::PictureCriticArgs;
use parts::split_into_parts;
use std::path::{Path, PathBuf};
use wayword_core::{ModelError, PhraseGrounder, View};
use wayword_metrics::picture_scores::{CLIP_PROMPT_PREFIX, PictureScores};
use wayword_run::{error::CommandError, output::CommandOutput};

/// A model that scores a phrase on a view by the cosine of their vectors.
pub trait CosineGrounder: PhraseGrounder {
    /// Whether the model reads the whole phrase: a CLIP cuts off the end of a phrase that is too long for it.
    ///
    /// # Errors
    /// When the phrase cannot be read.
    fn reads_whole_phrase(&self, phrase: &str) -> Result<bool, ModelError>;
}

#[cfg(feature = "local")]
impl CosineGrounder for wayword_local::ClipGrounder {
    fn reads_whole_phrase(&self, phrase: &str) -> Result<bool, ModelError> {
        Self::reads_whole_phrase(self, phrase)
    }
}

/// A CLIP model with the pictures that it scores texts by.
pub struct PictureCritic {
    eye: Box<dyn CosineGrounder>,
    /// The pictures ahead of the frames of the paths that the texts describe.
    pub frames: PathPictures,
}

impl PictureCritic {
    /// Opens the critic that the flags ask for; `None` if they name no CLIP. The pictures come from the run that the flags name,
    /// or from the platform that they name, which draws them along the paths of `file`. Otherwise the first of `runs` with
    /// pictures supplies them.
    ///
    /// # Errors
    /// When the model cannot be loaded, or there are no pictures.
    pub fn open(
        asked: &PictureCriticArgs,
        runs: &[PathBuf],
        file: &Path,
        output: &CommandOutput,
    ) -> Result<Option<Self>, CommandError> {
        match &asked.clip {
            Some(name) => {
                // The pictures are opened first, so that missing ones are reported before a model is downloaded.
                let frames = PathPictures::open(asked, runs, file)?;
                Ok(Some(Self::new(load_clip(name, output)?, frames)))
            }
            None if asked.platform.platform.is_some()
                || asked.platform.data.is_some()
                || asked.platform.at.is_some() =>
            {
                Err(CommandError::usage(
                    "a platform is named, but nothing looks at its pictures",
                    "name a model with --clip, as in --clip hf/openai/clip-vit-base-patch32, or leave the platform out",
                ))
            }
            None => Ok(None),
        }
    }

    /// Joins a loaded model and the pictures.
    #[must_use]
    pub fn new(eye: Box<dyn CosineGrounder>, frames: PathPictures) -> Self {
        Self { eye, frames }
    }

    /// The name of the model.
    #[must_use]
    pub fn name(&self) -> &str {
        self.eye.name()
    }

    /// How well each text agrees with pictures. `None` for a text without words, and for every text if there are no pictures.
    ///
    /// # Errors
    /// When the model fails.
    pub fn score_texts(&self, pictures: &[View], texts: &[&str]) -> Result<Vec<Option<PictureScores>>, CommandError> {
        score_agreement(self.eye.as_ref(), pictures, texts)
    }
}

/// Scores each text, as a whole and by its parts, on all pictures. The model gets the phrases of all texts in one call.
fn score_agreement(
    eye: &dyn CosineGrounder,
    pictures: &[View],
    texts: &[&str],
) -> Result<Vec<Option<PictureScores>>, CommandError> {
    let phrase = |text: &str| format!("{CLIP_PROMPT_PREFIX}{}", text.trim());
    let mut phrases = Vec::new();
    // The index of each text's first phrase, which is the whole text. The phrases of its parts follow.
    let mut starts = Vec::new();
    for text in texts {
        starts.push(phrases.len());
        phrases.push(phrase(text));
        phrases.extend(split_into_parts(text, |part| eye.reads_whole_phrase(&phrase(part)))?.into_iter().map(phrase));
    }
    starts.push(phrases.len());
    let views: Vec<&View> = pictures.iter().collect();
    let phrases: Vec<&str> = phrases.iter().map(String::as_str).collect();
    let scores = eye.score_phrases(&views, &phrases).into_iter().collect::<Result<Vec<_>, _>>()?;
    if scores.len() != views.len() || scores.iter().any(|row| row.len() != phrases.len()) {
        let reason = "it did not give one score for each picture and phrase".to_owned();
        return Err(ModelError::Failed { model: eye.name().to_owned(), reason }.into());
    }
    let cosines = |at: usize| -> Vec<f64> { scores.iter().map(|row| f64::from(row[at])).collect() };
    // `bounds` has the indices at which the phrases of this text and of the next one start.
    let score_text = |bounds: &[usize]| {
        let parts: Vec<Vec<f64>> = (bounds[0] + 1..bounds[1]).map(cosines).collect();
        PictureScores::from_cosines(&cosines(bounds[0]), &parts)
    };
    Ok(starts.windows(2).map(score_text).collect())
}

#[cfg(feature = "local")]
fn load_clip(name: &str, output: &CommandOutput) -> Result<Box<dyn CosineGrounder>, CommandError> {
    Ok(Box::new(wayword_run::clip::load_grounder(name, output)?))
}

#[cfg(not(feature = "local"))]
fn load_clip(name: &str, _: &CommandOutput) -> Result<Box<dyn CosineGrounder>, CommandError> {
    Err(CommandError::not_built(format!("--clip {name}: this build runs no models in process")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use wayword_core::{DVec3, Heading, Pose};

    /// Scores a phrase by its number of letters, and reads at most twenty letters behind the prefix.
    #[derive(Default)]
    struct Letters {
        asked: Mutex<Vec<String>>,
        is_broken: bool,
    }

    impl PhraseGrounder for Letters {
        fn name(&self) -> &str {
            "letters"
        }

        fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
            *self.asked.lock().unwrap() = phrases.iter().map(|phrase| (*phrase).to_owned()).collect();
            let of_view = |at: usize| {
                let scored = phrases.iter().skip(usize::from(self.is_broken));
                Ok(scored
                    .map(|phrase| (phrase.len() - CLIP_PROMPT_PREFIX.len()) as f32 / 100.0 - at as f32 * 0.1)
                    .collect())
            };
            (0..views.len()).map(of_view).collect()
        }
    }

    impl CosineGrounder for Letters {
        fn reads_whole_phrase(&self, phrase: &str) -> Result<bool, ModelError> {
            Ok(phrase.len() <= CLIP_PROMPT_PREFIX.len() + 20)
        }
    }

    fn views(count: usize) -> Vec<View> {
        let pose = Pose::looking_level(DVec3::ZERO, Heading::NORTH);
        (0..count).map(|_| View::new(pose, 1.0, None, None)).collect()
    }

    #[test]
    fn score_agreement_asks_for_the_whole_text_and_its_parts() {
        let eye = Letters::default();
        let found = score_agreement(&eye, &views(2), &["Pass the sofa. Stop.", "Wait"]).unwrap();
        let asked = eye.asked.lock().unwrap().clone();
        let told: Vec<&str> = asked.iter().map(|phrase| phrase.strip_prefix("A photo depicts ").unwrap()).collect();
        assert_eq!(told, ["Pass the sofa. Stop.", "Pass the sofa.", "Stop.", "Wait", "Wait"]);
        // Of 20 letters: 0.2 and 0.1; of 14 and 5 the first picture: 0.14 and 0.05.
        let first = found[0].unwrap();
        assert!((first.whole - 2.5 * 0.15).abs() < 1e-6 && (first.parts - 2.5 * 0.095).abs() < 1e-6, "{first:?}");
        // The second picture has a cosine below zero, which is no score.
        assert!((found[1].unwrap().whole - 2.5 * 0.02).abs() < 1e-6);
    }

    #[test]
    fn score_agreement_is_none_without_words_or_pictures() {
        assert_eq!(score_agreement(&Letters::default(), &views(1), &[" ... "]).unwrap(), [None]);
        assert_eq!(score_agreement(&Letters::default(), &[], &["Stop."]).unwrap(), [None]);
    }

    #[test]
    fn a_model_that_leaves_scores_out_is_refused() {
        let broken = Letters { is_broken: true, ..Letters::default() };
        assert!(score_agreement(&broken, &views(1), &["Stop."]).unwrap_err().to_string().contains("letters"));
    }

    #[test]
    fn a_platform_without_a_model_is_refused() {
        let mut asked = PictureCriticArgs::default();
        asked.platform.platform = Some("house".to_owned());
        let refused = PictureCritic::open(&asked, &[], Path::new("x"), &CommandOutput::new(false, true))
            .err()
            .unwrap()
            .to_string();
        assert!(refused.contains("--clip"), "{refused}");
        let nothing =
            PictureCritic::open(&PictureCriticArgs::default(), &[], Path::new("x"), &CommandOutput::new(false, true));
        assert!(nothing.unwrap().is_none());
    }
}
