//! Puts BLIP and BLIP-2 behind one trait, so that a request with a picture can go to either.

use crate::{
    LocalError,
    blip::{BlipCaptioner, BlipVqa},
    blip2::Blip2Model,
};
use wayword_core::{Image, ModelRequest};

/// The most tokens of an answer, also where a request allows more. These models were trained on short answers, and
/// repeat themselves in longer ones.
const MAX_ANSWER_TOKENS: u32 = 40;

/// The question that asks for a description, for a model that only answers questions.
const DESCRIBE_QUESTION: &str = "what is in the picture?";

/// A model that answers a request about one picture. Code calls it an eye.
pub(crate) trait PictureModel: Send + Sync {
    /// The form of request that the model takes.
    fn kind(&self) -> EyeKind;

    /// The reply to a request.
    fn reply_to(&self, request: &ModelRequest) -> Result<String, LocalError>;
}

/// The form of request that a model takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EyeKind {
    /// A picture and a question. Without a question the model describes the picture.
    Questions,
    /// A picture and a text that the model continues.
    Texts,
}

/// BLIP. One checkpoint answers questions, another describes pictures; either may be absent.
pub(crate) struct BlipEye {
    pub(crate) name: String,
    pub(crate) answers: Option<BlipVqa>,
    pub(crate) describes: Option<BlipCaptioner>,
}

impl PictureModel for BlipEye {
    fn kind(&self) -> EyeKind {
        EyeKind::Questions
    }

    fn reply_to(&self, request: &ModelRequest) -> Result<String, LocalError> {
        let (picture, words) = picture_and_words(&self.name, request)?;
        let max_tokens = request.sampling.max_tokens.min(MAX_ANSWER_TOKENS) as usize;
        match (&self.answers, &self.describes, words.is_empty()) {
            (_, Some(describes), true) => describes.describe_picture(picture, "", max_tokens),
            (Some(answers), _, false) => answers.answer_question(picture, words, max_tokens),
            (Some(answers), None, true) => answers.answer_question(picture, DESCRIBE_QUESTION, max_tokens),
            (None, _, _) => Err(self.cannot_answer()),
        }
    }
}

impl BlipEye {
    /// The error for a question to a BLIP that only describes pictures.
    fn cannot_answer(&self) -> LocalError {
        let problem = "it describes pictures but does not answer questions; use --perception single, or put a model that \
                       answers before it, as in --see hf/Salesforce/blip-vqa-base+Salesforce/blip-image-captioning-base";
        LocalError::Compute { model: self.name.clone(), problem: problem.to_owned() }
    }
}

/// BLIP-2.
pub(crate) struct Blip2Eye {
    pub(crate) name: String,
    pub(crate) model: Blip2Model,
}

impl PictureModel for Blip2Eye {
    fn kind(&self) -> EyeKind {
        EyeKind::Texts
    }

    fn reply_to(&self, request: &ModelRequest) -> Result<String, LocalError> {
        let (picture, words) = picture_and_words(&self.name, request)?;
        let max_tokens = request.sampling.max_tokens.min(MAX_ANSWER_TOKENS) as usize;
        self.model.continue_prompt(picture, words, max_tokens)
    }
}

/// The picture and the text of a request. These models take one message with one picture.
fn picture_and_words<'a>(name: &str, request: &'a ModelRequest) -> Result<(&'a Image, &'a str), LocalError> {
    let wrong = |problem: &str| LocalError::Compute { model: name.to_owned(), problem: problem.to_owned() };
    let [message] = &request.messages[..] else { return Err(wrong("it takes one message, not a conversation")) };
    let picture = match &message.images[..] {
        [] => None,
        [only] => Some(&**only),
        _ => return Err(wrong("it takes one picture at a time")),
    };
    let picture = picture.ok_or_else(|| wrong("it answers about pictures and does not write texts: use it to see (--see of `generate`), and for no other role"))?;
    Ok((picture, message.text.trim()))
}
