use super::*;
use crate::{
    dialogue::{CaptionSummariser, OPENING_REQUEST, QuestionAsker},
    prompts::{PromptManner, Prompts, trial_fill},
    style::{StyleProfile, built_in},
    writer::{FramePicture, InstructionWriter, WriteError, WritingBrief},
};
use std::sync::{Arc, Mutex};
use wayword_core::{
    AnswerForm, DialogueExchange, FinishReason, Heading, Image, PathMotion, Pose, View, ViewAnswerer, ViewQuestion,
};

/// A model that gives prepared replies in their order, and keeps the requests.
pub(crate) struct Scripted {
    replies: Mutex<Vec<Result<ModelReply, ModelError>>>,
    pub(crate) heard: Mutex<Vec<ModelRequest>>,
}

impl Scripted {
    pub(crate) fn new(replies: &[&str]) -> Arc<Self> {
        let said = |text: &&str| Ok(ModelReply { text: (*text).to_owned(), finish: FinishReason::Stop, usage: None });
        Self::with(replies.iter().map(said).collect())
    }

    fn with(mut replies: Vec<Result<ModelReply, ModelError>>) -> Arc<Self> {
        replies.reverse();
        Arc::new(Self { replies: Mutex::new(replies), heard: Mutex::default() })
    }

    fn prompts(&self) -> Vec<String> {
        self.heard.lock().unwrap().iter().map(|request| request.messages[0].text.clone()).collect()
    }
}

impl LanguageModel for Scripted {
    fn name(&self) -> &str {
        "test/scripted"
    }

    fn complete_requests(&self, requests: &[ModelRequest]) -> Vec<Result<ModelReply, ModelError>> {
        self.heard.lock().unwrap().extend_from_slice(requests);
        requests.iter().map(|_| self.replies.lock().unwrap().pop().expect("it was asked too often")).collect()
    }
}

fn prompts() -> Arc<Prompts> {
    Arc::new(Prompts::new(&[]).unwrap())
}

fn transcript() -> Vec<DialogueExchange> {
    vec![
        DialogueExchange::new(OPENING_REQUEST, "There is a bed in the middle and a mirror on the left."),
        DialogueExchange::new("Which room is this?", "It is a bedroom."),
        DialogueExchange::new("Is there a mirror?", "No, there is no mirror."),
    ]
}

#[test]
fn a_summary_with_a_denied_thing_is_requested_again_with_the_reason() {
    let model = Scripted::new(&["A bedroom with a bed and a mirror.", "Summary: A bedroom with a bed."]);
    let caption = ModelSummariser::new(model.clone(), prompts()).sum_up(&transcript(), "test").unwrap();
    assert_eq!((caption.text.as_str(), caption.by), ("A bedroom with a bed.", None));
    let prompts = model.prompts();
    assert!(!prompts[0].contains("refused") && prompts[1].contains("refused: ") && prompts[1].contains("mirror"));
}

#[test]
fn a_summary_that_stays_wrong_is_written_by_rules() {
    let model = Scripted::new(&["A bed and a mirror.", "A bed, a mirror and a piano."]);
    let caption = ModelSummariser::new(model, prompts()).sum_up(&transcript(), "test").unwrap();
    assert_eq!(caption.text, "A bedroom with a bed in the middle.");
    let by = caption.by.unwrap();
    assert!(by.starts_with("rules, because") && by.contains("piano"), "{by}");
}

#[test]
fn a_condensed_description_is_short_and_covers_all_directions() {
    let long = "There is a bed and there is a bed and there is a bed and there is a bed and there is a bed.";
    let model = Scripted::new(&[long, "A bedroom with a bed."]);
    let summariser = ModelSummariser::new(model.clone(), prompts());
    let caption = crate::dialogue::RulesSummariser.sum_up(&transcript(), "test").unwrap();
    let condensed = summariser.condense(&[("ahead", &caption)], 20).unwrap();
    assert_eq!((condensed.text.as_str(), condensed.by), ("A bedroom with a bed.", None));
    assert!(model.prompts()[1].contains("fewer than 20"));
}

#[test]
fn a_condensed_description_that_stays_wrong_is_written_by_rules() {
    let model = Scripted::new(&["A piano.", "A piano and a bed."]);
    let caption = crate::dialogue::RulesSummariser.sum_up(&transcript(), "test").unwrap();
    let condensed = ModelSummariser::new(model, prompts()).condense(&[("ahead", &caption)], 20).unwrap();
    assert_eq!(condensed.text, "a bedroom with a bed");
    let by = condensed.by.unwrap();
    assert!(by.starts_with("rules, because") && by.contains("piano"), "{by}");
}

#[test]
fn a_model_asks_with_the_dialogue_so_far() {
    let model = Scripted::new(&["What colour is the bed?"]);
    let question = ModelAsker::new(model.clone(), prompts()).next_question(&transcript()).unwrap().unwrap();
    assert_eq!(question, "What colour is the bed?");
    assert!(model.prompts()[0].contains("Is there a mirror?"));
}

#[test]
fn answerer_sends_the_picture_and_repeats_cut_answers() {
    let cut = || Ok(ModelReply { text: "A bed. A lamp and a".to_owned(), finish: FinishReason::Length, usage: None });
    let model = Scripted::with(vec![cut(), cut()]);
    let eye = ModelAnswerer::new(model.clone(), prompts(), PromptManner::Chat);
    let image = Arc::new(Image::new(1, 1, vec![0; 3]).unwrap());
    let view =
        View::new(Pose::looking_level(wayword_core::DVec3::ZERO, Heading::NORTH), 1.0, Some(image.clone()), None);
    let blind = View::new(Pose::looking_level(wayword_core::DVec3::ZERO, Heading::NORTH), 1.0, None, None);
    let ask = |view| ViewQuestion { view, question: OPENING_REQUEST, history: &[], answer: AnswerForm::Words };
    let answers = eye.answer_questions(&[ask(&blind), ask(&view)]);
    assert!(matches!(&answers[0], Err(ModelError::NothingToSee { .. })));
    assert_eq!(answers[1].as_deref(), Ok("A bed."));
    let heard = model.heard.lock().unwrap();
    assert_eq!((heard.len(), &heard[0].messages[0].images[0], &heard[1].messages[0].images[0]), (2, &image, &image));
    assert!(heard[1].messages[0].text.contains("say in one sentence"), "{}", heard[1].messages[0].text);
}

#[test]
fn a_text_of_two_megabytes_is_refused_and_not_sent_back_whole() {
    let long = "Go past the sofa and turn left at the lamp. ".repeat(50_000);
    let walk = trial_fill::trial_walk(PathMotion::Known).unwrap();
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let memory = walk.memory();
    let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
    let writer = ModelWriter::new(Scripted::new(&[&long]), prompts());
    let Err(WriteError::Unusable { text, reason }) = writer.write(&brief) else { panic!("it is used") };
    assert!(text.len() < 1000 && text.starts_with("Go past the sofa"), "{} bytes", text.len());
    assert!(reason.contains("2199999 bytes, more than 20000"), "{reason}");
}

#[test]
fn a_summary_of_two_megabytes_is_left_to_rules() {
    let long = "There is a bed. ".repeat(130_000);
    let caption =
        ModelSummariser::new(Scripted::new(&[&long, &long]), prompts()).sum_up(&transcript(), "test").unwrap();
    assert_eq!(caption.text, "A bedroom with a bed in the middle.");
    assert!(caption.by.unwrap().contains("more than 20000"));
}

#[test]
fn errors_of_a_model_are_passed_on() {
    let stop =
        ModelError::Stopped { reason: "the budget is spent".into(), hint: "raise --max-usd".into(), is_lost: false };
    let model = Scripted::with(vec![Err(stop.clone())]);
    assert_eq!(ModelAsker::new(model, prompts()).next_question(&[]), Err(stop));
}

#[test]
fn a_refusal_is_no_text_and_a_writer_that_sees_gets_the_pictures() {
    let walk = trial_fill::trial_walk(PathMotion::Known).unwrap();
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let image = Arc::new(Image::new(1, 1, vec![0; 3]).unwrap());
    let pictures = [FramePicture { frame: 1, image: Arc::clone(&image) }];
    let memory = walk.memory();
    let brief = WritingBrief { pictures: &pictures, ..WritingBrief::new(&walk, &memory, &style, &profile, 0) };
    let model = Scripted::new(&["I'm sorry, but I can't assist with that.", "Sure! Instruction: \"Go on. Stop.\""]);
    let writer = ModelWriter::new(model.clone(), prompts());
    assert!(matches!(writer.write(&brief), Err(WriteError::Unusable { reason, .. }) if reason.contains("refused")));
    assert_eq!(writer.write(&brief).unwrap(), "Go on. Stop.");
    let heard = model.heard.lock().unwrap();
    assert_eq!(heard[0].messages[0].images, [image]);
    assert!(heard[0].messages[0].text.contains("attached, in this order: Frame 1."), "{}", heard[0].messages[0].text);
}

#[test]
fn a_cut_summary_is_requested_again_and_then_used_in_part() {
    let cut = || {
        Ok(ModelReply { text: "A bedroom with a bed. In the".to_owned(), finish: FinishReason::Length, usage: None })
    };
    let model = Scripted::with(vec![cut(), cut()]);
    let caption = ModelSummariser::new(model.clone(), prompts()).sum_up(&transcript(), "test").unwrap();
    assert_eq!((caption.text.as_str(), caption.by), ("A bedroom with a bed.", None));
    assert!(model.prompts()[1].contains("it was cut off"));
}

#[test]
fn a_text_in_chinese_is_asked_for_and_english_words_in_it_are_refused() {
    let walk = trial_fill::trial_walk(PathMotion::Known).unwrap();
    let style = built_in("r2r").unwrap().in_language("zh");
    let profile = StyleProfile::for_style(&style);
    let memory = walk.memory();
    let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
    let model = Scripted::new(&[
        "Walk into the bedroom and stop.",
        "走进卧室，停在 lamp 旁边。",
        "抱歉，我无法提供帮助。",
        "好的，以下是导航指令：走进卧室，停在台灯旁边。",
        "好的！走进卧室，停在台灯旁边。",
    ]);
    let writer = ModelWriter::new(model.clone(), prompts());
    for wanted in ["it is not in Chinese", "it has the word \"lamp\"", "it refused"] {
        let Err(WriteError::Unusable { reason, .. }) = writer.write(&brief) else { panic!("{wanted}: it is used") };
        assert!(reason.contains(wanted), "{reason}");
    }
    for _chatter in ["an announcement", "a word of agreement"] {
        assert_eq!(writer.write(&brief).unwrap(), "走进卧室，停在台灯旁边。");
    }
    let prompt = &model.prompts()[0];
    assert!(prompt.contains("Write it in Simplified Chinese alone") && prompt.contains("lamp 灯"), "{prompt}");
}
