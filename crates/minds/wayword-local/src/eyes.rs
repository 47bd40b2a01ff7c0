//! BLIP and BLIP-2 as minds that answer requests with a picture.

use crate::{
    LocalError,
    blip::{BlipCaptioner, BlipVqa},
    blip2::Blip2,
};
use wayword_core::{Image, Request};

/// Most tokens of an answer: these models were trained on short ones, and repeat themselves after.
const MOST_TOKENS: u32 = 40;

/// What one that only answers is asked where a description is wanted.
const DESCRIBE: &str = "what is in the picture?";

/// A model that answers about a picture.
pub(crate) trait Eye: Send + Sync {
    /// How it wants to be asked.
    fn kind(&self) -> EyeKind;

    /// The reply to a request.
    fn reply(&self, request: &Request) -> Result<String, LocalError>;
}

/// How a model that sees wants to be asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EyeKind {
    /// With a picture and a bare question; with a picture and no words it describes.
    Questions,
    /// With a picture and a text to go on with.
    Texts,
}

/// BLIP: one checkpoint answers, another one describes.
pub(crate) struct BlipEye {
    pub(crate) name: String,
    pub(crate) answers: Option<BlipVqa>,
    pub(crate) describes: Option<BlipCaptioner>,
}

impl Eye for BlipEye {
    fn kind(&self) -> EyeKind {
        EyeKind::Questions
    }

    fn reply(&self, request: &Request) -> Result<String, LocalError> {
        let (picture, words) = shown(&self.name, request)?;
        let most = request.sampling.max_tokens.min(MOST_TOKENS) as usize;
        match (&self.answers, &self.describes, words.is_empty()) {
            (_, Some(describes), true) => describes.caption(picture, "", most),
            (Some(answers), _, false) => answers.answer(picture, words, most),
            (Some(answers), None, true) => answers.answer(picture, DESCRIBE, most),
            (None, _, _) => Err(self.cannot_answer()),
        }
    }
}

impl BlipEye {
    fn cannot_answer(&self) -> LocalError {
        let problem = "it describes pictures and answers no questions; use --perception single, or name one that answers before \
                       it, as in --see hf/Salesforce/blip-vqa-base+Salesforce/blip-image-captioning-base";
        LocalError::Compute { model: self.name.clone(), problem: problem.to_owned() }
    }
}

/// BLIP-2.
pub(crate) struct Blip2Eye {
    pub(crate) name: String,
    pub(crate) model: Blip2,
}

impl Eye for Blip2Eye {
    fn kind(&self) -> EyeKind {
        EyeKind::Texts
    }

    fn reply(&self, request: &Request) -> Result<String, LocalError> {
        let (picture, words) = shown(&self.name, request)?;
        let most = request.sampling.max_tokens.min(MOST_TOKENS) as usize;
        self.model.answer(picture, words, most)
    }
}

/// The picture and the words of the one message that these models take.
fn shown<'a>(name: &str, request: &'a Request) -> Result<(&'a Image, &'a str), LocalError> {
    let wrong = |problem: &str| LocalError::Compute { model: name.to_owned(), problem: problem.to_owned() };
    let [message] = &request.messages[..] else { return Err(wrong("it takes one message, and no conversation")) };
    let picture = message.image.as_deref();
    let picture = picture.ok_or_else(|| wrong("it answers about pictures and writes no texts: it can have the role that sees (--see of `generate`), and no other"))?;
    Ok((picture, message.text.trim()))
}
