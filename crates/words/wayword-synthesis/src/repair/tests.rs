use super::*;
use crate::{
    dialogue::{RulesAsker, RulesSummariser},
    offline::LabelAnswerer,
    style::built_in,
    writer::RulesWriter,
    writer::WriteError,
};
use proptest::prelude::*;
use std::sync::{Arc, Mutex};
use wayword_core::{
    Caption, CaptionedView, DVec3, FrameObservation, Image, ObjectSighting, Path, PathMotion, SceneId, ViewAnswerer,
    ViewGaze, ViewQuestion, ViewThird, WitnessAnswer, path::PathStop,
};

/// A writer that gives prepared texts in their order, and counts the complaints that it gets.
pub(super) struct Scripted {
    texts: Mutex<Vec<Result<String, WriteError>>>,
    complaints: Mutex<Vec<usize>>,
}

impl Scripted {
    pub(super) fn new(mut texts: Vec<Result<String, WriteError>>) -> Self {
        texts.reverse();
        Self { texts: Mutex::new(texts), complaints: Mutex::default() }
    }
}

impl InstructionWriter for Scripted {
    fn name(&self) -> &str {
        "test/scripted"
    }

    fn write(&self, brief: &WritingBrief<'_>) -> Result<String, WriteError> {
        self.complaints.lock().unwrap().push(brief.complaints.len());
        self.texts.lock().unwrap().pop().expect("it was asked too often")
    }
}

pub(super) fn walk() -> ObservedWalk {
    along(&[(0.0, 0.0), (0.0, 3.0), (3.0, 3.0)], &["sofa", "lamp", "sink"])
}

/// A walk over places, from each of which one thing is seen.
fn along(places: &[(f64, f64)], things: &[&str]) -> ObservedWalk {
    let stop = |(x, y): &(f64, f64)| PathStop { position: DVec3::new(*x, *y, 1.5), viewpoint: None, level: None };
    let path = Path {
        id: "p".into(),
        scene: SceneId::new("s").unwrap(),
        frames: Path::frames_along(places.iter().map(stop).collect(), None),
        motion: PathMotion::Known,
        target: None,
    };
    let seen = |name: &str| ObjectSighting {
        place: Some(ViewThird::Middle),
        ..ObjectSighting::new(name, WitnessAnswer::Seen, "test")
    };
    let observations = path.frames.iter().zip(things).map(|(frame, name)| {
        let caption = Caption { text: format!("A {name}."), sightings: vec![seen(name)], ..Caption::default() };
        let look = CaptionedView { gaze: ViewGaze::quarter_view(frame.pose.heading), caption };
        FrameObservation { summary: look.caption.text.clone(), looks: vec![look], by: None }
    });
    let observations = observations.collect();
    ObservedWalk::new(path, observations)
}

/// An order for a single text about a walk, without further wishes.
pub(super) fn order<'a>(
    walk: &'a ObservedWalk,
    memory: &'a WalkMemory,
    evidence: &'a Evidence,
    style: &'a InstructionStyle,
    profile: &'a StyleProfile,
) -> InstructionOrder<'a> {
    InstructionOrder {
        walk,
        memory,
        evidence,
        evidence_memory: memory,
        style,
        profile,
        style_hash: "",
        seed: 0,
        repairs: 8,
        candidates: 1,
        only: None,
        follower: None,
        earlier: &[],
        pictures: &[],
        views: &[],
        refinements: 0,
        together: &OneByOne,
    }
}

/// Observers that ask by fixed queries; labels answer.
pub(super) fn observers<'a>(asker: &'a RulesAsker, answerer: &'a LabelAnswerer) -> ObservationRoles<'a> {
    ObservationRoles {
        asker,
        answerer,
        summariser: &RulesSummariser,
        mode: DialogueMode::Fixed,
        prompts_hash: None,
        detector: None,
    }
}

fn outcome(
    texts: Vec<Result<String, WriteError>>,
    finisher: bool,
    repairs: u32,
) -> (Result<WritingOutcome, ModelError>, Vec<usize>) {
    let walk = walk();
    let evidence = walk.evidence().unwrap();
    outcome_against(&walk, &evidence, DialogueMode::Dialogue { questions: 9 }, texts, finisher, repairs)
}

fn outcome_against(
    walk: &ObservedWalk,
    evidence: &Evidence,
    mode: DialogueMode,
    texts: Vec<Result<String, WriteError>>,
    finisher: bool,
    repairs: u32,
) -> (Result<WritingOutcome, ModelError>, Vec<usize>) {
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let memory = walk.memory();
    let order = InstructionOrder { repairs, ..order(walk, &memory, evidence, &style, &profile) };
    let asker = RulesAsker::default();
    let observers = ObservationRoles {
        asker: &asker,
        answerer: &LabelAnswerer::default(),
        summariser: &RulesSummariser,
        mode,
        prompts_hash: Some("hash"),
        detector: None,
    };
    let writer = Scripted::new(texts);
    let finisher = finisher.then_some(&RulesWriter as &dyn InstructionWriter);
    let outcome = write_and_repair(WriterPair { writer: &writer, finisher }, observers, order);
    (outcome, writer.complaints.into_inner().unwrap())
}

fn said(text: &str) -> Result<String, WriteError> {
    Ok(text.to_owned())
}

pub(super) const GOOD: &str = "Walk past the sofa to the lamp and turn right. Stop at the sink.";
const WITH_A_PIANO: &str = "Walk past the piano to the lamp and turn right. Stop at the sink.";

#[test]
fn a_text_with_a_hallucinated_object_goes_back_with_the_reason_until_it_is_right() {
    let cut_off = Err(WriteError::Unusable { text: "Walk past".into(), reason: "it was cut off".into() });
    let (outcome, complaints) = outcome(vec![said(WITH_A_PIANO), cut_off, said(GOOD)], true, 3);
    let WritingOutcome::Accepted(instruction) = outcome.unwrap() else { panic!("it was rejected") };
    assert_eq!((instruction.text.as_str(), instruction.provenance.repairs), (GOOD, 2));
    assert_eq!(instruction.provenance.writer, "test/scripted");
    assert_eq!(instruction.provenance.prompts_hash.as_deref(), Some("hash"));
    assert_eq!(instruction.provenance.finished_for, None);
    assert_eq!(complaints, [0, 1, 2]);
}

#[test]
fn finisher_by_rules_takes_over_and_is_recorded() {
    let (outcome, complaints) = outcome(vec![said(WITH_A_PIANO), said(WITH_A_PIANO)], true, 1);
    let WritingOutcome::Accepted(instruction) = outcome.unwrap() else { panic!("it was rejected") };
    assert!(!instruction.text.contains("piano"), "{}", instruction.text);
    assert_eq!(instruction.provenance.writer, "rules");
    assert_eq!(instruction.provenance.finished_for.as_deref(), Some("test/scripted"));
    assert_eq!(complaints.len(), 2);
}

#[test]
fn without_a_finisher_it_is_rejected_with_the_reason() {
    let (outcome, _) = outcome(vec![said(WITH_A_PIANO)], false, 0);
    let WritingOutcome::Rejected { last, reason, .. } = outcome.unwrap() else { panic!("it was accepted") };
    assert!(reason.contains("piano") && last.unwrap().text == WITH_A_PIANO, "{reason}");
}

#[test]
fn an_empty_text_is_rejected_with_the_reason() {
    let empty = || Err(WriteError::Unusable { text: String::new(), reason: "it was empty".into() });
    let (outcome, _) = outcome(vec![empty(), empty()], false, 1);
    let WritingOutcome::Rejected { last: None, reason, .. } = outcome.unwrap() else { panic!("there is a text") };
    assert!(reason.contains("it was empty"), "{reason}");
}

#[test]
fn a_failing_model_ends_the_writing() {
    let failed = ModelError::Failed { model: "test/scripted".into(), reason: "content filter".into() };
    let (outcome, _) = outcome(vec![Err(failed.clone().into())], true, 3);
    assert_eq!(outcome, Err(failed));
}

#[test]
fn a_model_is_not_asked_again_for_an_unverified_text() {
    let walk = walk();
    let nothing = Evidence::for_path_alone(&walk.path);
    let mode = DialogueMode::Dialogue { questions: 9 };
    let (outcome, complaints) = outcome_against(&walk, &nothing, mode, vec![said(WITH_A_PIANO)], true, 3);
    let WritingOutcome::Accepted(instruction) = outcome.unwrap() else { panic!("it was rejected") };
    assert_eq!((instruction.verdict, complaints.len()), (Verdict::Unverified, 1));
}

#[test]
fn provenance_names_the_summariser_of_panoramas_without_a_dialogue() {
    let mut walk = walk();
    let summariser = |walk: &ObservedWalk| {
        let evidence = walk.evidence().unwrap();
        let (outcome, _) = outcome_against(walk, &evidence, DialogueMode::Single, vec![said(GOOD)], false, 0);
        let WritingOutcome::Accepted(instruction) = outcome.unwrap() else { panic!("it was rejected") };
        instruction.provenance.summariser
    };
    assert_eq!(summariser(&walk), "nobody");
    let look = walk.observations[2].looks[0].clone();
    walk.observations[2].looks.push(look);
    assert_eq!(summariser(&walk), "rules");
}

#[test]
fn a_path_of_one_viewpoint_gets_a_text_without_movement() {
    let observers = ObservationRoles {
        asker: &RulesAsker::default(),
        answerer: &LabelAnswerer::default(),
        summariser: &RulesSummariser,
        mode: DialogueMode::Fixed,
        prompts_hash: None,
        detector: None,
    };
    for room in [None, Some("kitchen")] {
        let mut walk = along(&[(0.0, 0.0)], &["sink"]);
        walk.observations[0].looks[0].caption.room = room.map(str::to_owned);
        let evidence = walk.evidence().unwrap();
        for style in ["r2r", "reverie"].map(|name| built_in(name).unwrap()) {
            let profile = StyleProfile::from_references(&style.references);
            for seed in 0..40 {
                let memory = walk.memory();
                let order = InstructionOrder { seed, repairs: 0, ..order(&walk, &memory, &evidence, &style, &profile) };
                let writers = WriterPair { writer: &RulesWriter, finisher: None };
                let outcome = write_and_repair(writers, observers, order).unwrap();
                let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
                // A path of one place decides nothing of a text.
                assert_eq!(instruction.verdict, Verdict::Unverified, "{instruction:?}");
                for word in ["go", "walk", "head", "enter", "straight", "move", "proceed", "step"] {
                    assert!(
                        !wayword_language::text::split_words(&instruction.text).contains(&word.to_owned()),
                        "{}",
                        instruction.text
                    );
                }
            }
        }
    }
}

#[test]
fn a_text_that_the_walk_already_has_is_written_again() {
    const OTHER: &str = "Head past the sofa to the lamp and turn right. Wait at the sink.";
    let walk = walk();
    let memory = walk.memory();
    let evidence = walk.evidence().unwrap();
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let asker = RulesAsker::default();
    let labels = LabelAnswerer::default();
    let observers = observers(&asker, &labels);
    let write = |writer: &dyn InstructionWriter, earlier: &[String]| {
        let order = InstructionOrder { earlier, ..order(&walk, &memory, &evidence, &style, &profile) };
        match write_and_repair(WriterPair { writer, finisher: None }, observers, order).unwrap() {
            WritingOutcome::Accepted(instruction) => instruction,
            rejected => panic!("{rejected:?}"),
        }
    };
    let again = GOOD.to_uppercase();
    let writer = Scripted::new(vec![said(&again), said(OTHER), said(GOOD)]);
    let second = write(&writer, &[GOOD.to_owned()]);
    assert_eq!((second.text.as_str(), second.provenance.repairs), (OTHER, 1));
    let mut texts: Vec<String> = Vec::new();
    for _ in 0..4 {
        let text = write(&RulesWriter, &texts).text;
        assert!(!texts.contains(&text), "{text}");
        texts.push(text);
    }
}

#[test]
fn a_writer_with_pictures_may_name_things_beyond_captions() {
    let (walk, style) = (walk(), built_in("r2r").unwrap());
    let (evidence, memory) = (walk.evidence().unwrap(), walk.memory());
    let profile = StyleProfile::for_style(&style);
    let image = Arc::new(Image::new(1, 1, vec![0; 3]).unwrap());
    let asker = RulesAsker::default();
    let labels = LabelAnswerer::default();
    let observers = observers(&asker, &labels);
    let is_accepted = |pictures: &[FramePicture]| {
        let order = InstructionOrder { repairs: 0, pictures, ..order(&walk, &memory, &evidence, &style, &profile) };
        let writer = Scripted::new(vec![said("Walk past the sofa to the piano and turn right. Stop at the sink.")]);
        let outcome = write_and_repair(WriterPair { writer: &writer, finisher: None }, observers, order).unwrap();
        matches!(outcome, WritingOutcome::Accepted(instruction) if instruction.verdict == Verdict::Unverified)
    };
    assert!(!is_accepted(&[]));
    assert!(is_accepted(&[FramePicture { frame: 0, image }]));
}

/// The same pictures as a video shows them: in their order, and without poses.
fn on_video(walk: &ObservedWalk) -> ObservedWalk {
    ObservedWalk::new(Path { motion: PathMotion::Unknown, ..walk.path.clone() }, walk.observations.clone())
}

#[test]
fn an_invented_turn_goes_back_with_the_reason() {
    let walk = on_video(&walk());
    let evidence = walk.evidence().unwrap();
    let told = "Walk past the sofa to the lamp. Stop at the sink.";
    let mode = DialogueMode::Dialogue { questions: 9 };
    let (outcome, complaints) = outcome_against(&walk, &evidence, mode, vec![said(GOOD), said(told)], false, 3);
    let WritingOutcome::Accepted(instruction) = outcome.unwrap() else { panic!("it was rejected") };
    assert_eq!((instruction.text.as_str(), instruction.verdict, complaints.len()), (told, Verdict::Pass, 2));
    let (outcome, _) = outcome_against(&walk, &evidence, mode, vec![said(GOOD)], false, 0);
    let WritingOutcome::Rejected { reason, .. } = outcome.unwrap() else { panic!("it was accepted") };
    assert!(reason.contains("it is not known how the path turns"), "{reason}");
    // A turn counts as made up even where there is no evidence at all.
    let nothing = Evidence::for_path_alone(&walk.path);
    let (outcome, _) = outcome_against(&walk, &nothing, mode, vec![said(GOOD)], false, 0);
    assert!(matches!(outcome.unwrap(), WritingOutcome::Rejected { .. }));
}

/// Random rooms and things for the frames of a video; either may be missing.
fn sights() -> impl Strategy<Value = Vec<(Option<&'static str>, Option<&'static str>)>> {
    let room = prop::sample::select(vec!["kitchen", "hallway", "stairs", "balcony", "bedroom", "garage"]);
    let thing = prop::sample::select(vec!["sofa", "lamp", "stairs", "door", "sink", "painting", "toilet", "rug"]);
    prop::collection::vec((prop::option::of(room), prop::option::of(thing)), 1..12)
}

proptest! {
    #[test]
    fn rules_make_no_motion_up(sights in sights(), seed in any::<u64>()) {
        let places: Vec<(f64, f64)> = (0..sights.len()).map(|at| (0.0, at as f64)).collect();
        let things: Vec<&str> = sights.iter().map(|(_, thing)| thing.unwrap_or("sofa")).collect();
        let mut walk = on_video(&along(&places, &things));
        for (observation, (room, thing)) in walk.observations.iter_mut().zip(&sights) {
            let caption = &mut observation.looks[0].caption;
            caption.room = room.map(str::to_owned);
            caption.sightings.retain(|_| thing.is_some());
            // As if the picture had it on a side.
            caption.sightings.iter_mut().for_each(|sighting| sighting.place = Some(ViewThird::Left));
        }
        let evidence = walk.evidence().unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
        let asker = RulesAsker::default();
        let labels = LabelAnswerer::default();
        let observers = observers(&asker, &labels);
        for style in ["r2r", "reverie"].map(|name| built_in(name).unwrap()) {
            let profile = StyleProfile::from_references(&style.references);
            let memory = walk.memory();
            let order = InstructionOrder { seed, ..order(&walk, &memory, &evidence, &style, &profile) };
            let writers = WriterPair { writer: &RulesWriter, finisher: None };
            let text = match write_and_repair(writers, observers, order).unwrap() {
                WritingOutcome::Accepted(instruction) => instruction.text,
                WritingOutcome::Rejected { reason, .. } => {
                    prop_assert!(!reason.contains("it is not known"), "{}", reason);
                    continue;
                }
            };
            let told = text.to_lowercase().replace("stop right there", "stop");
            for word in ["left", "right", "straight", "forward", "around", "upstairs", "downstairs", "floor", "level"] {
                prop_assert!(!wayword_language::text::split_words(&told).contains(&word.to_owned()), "{}", text);
            }
            let stays = text.to_lowercase().split_whitespace().any(|word| word == "stay" || word == "remain");
            prop_assert_eq!(stays, sights.len() == 1, "{}", text);
        }
    }
}

/// An answerer of yes and no about pictures, which keeps its questions.
struct YesOrNo {
    answer: &'static str,
    asked: Mutex<Vec<String>>,
}

impl ViewAnswerer for YesOrNo {
    fn name(&self) -> &str {
        "test/eye"
    }

    fn answer_questions(&self, asks: &[ViewQuestion<'_>]) -> Vec<Result<wayword_core::AnswerText, ModelError>> {
        let mut asked = self.asked.lock().unwrap();
        asked.extend(asks.iter().map(|ask| ask.question.to_owned()));
        asks.iter().map(|_| Ok(self.answer.to_owned())).collect()
    }
}

/// The outcome of these texts where a witness was unsure of a mirror beside the lamp, and answers this when it is asked.
fn asked_about_a_mirror(texts: &[&str], answer: &'static str) -> (WritingOutcome, Vec<String>) {
    let mut walk = walk();
    let mirror = ObjectSighting {
        place: Some(ViewThird::Left),
        ..ObjectSighting::new("mirror", WitnessAnswer::Unsure, "test/eye")
    };
    walk.observations[1].looks[0].caption.sightings.push(mirror);
    let (evidence, memory) = (walk.evidence().unwrap(), walk.memory());
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::for_style(&style);
    let image = Arc::new(Image::new(1, 1, vec![0; 3]).unwrap());
    let view = |frame: &wayword_core::Frame| View::new(frame.pose, 1.5, Some(Arc::clone(&image)), None);
    let views: Vec<View> = walk.path.frames.iter().map(view).collect();
    let answerer = YesOrNo { answer, asked: Mutex::default() };
    let (asker, labels) = (RulesAsker::default(), LabelAnswerer::default());
    let observers = ObservationRoles { answerer: &answerer, ..observers(&asker, &labels) };
    let order = InstructionOrder { views: &views, repairs: 1, ..order(&walk, &memory, &evidence, &style, &profile) };
    let writer = Scripted::new(texts.iter().map(|text| said(text)).collect());
    let outcome = write_and_repair(WriterPair { writer: &writer, finisher: None }, observers, order).unwrap();
    (outcome, answerer.asked.into_inner().unwrap())
}

const PAST_A_MIRROR: &str = "Walk to the mirror and turn right. Stop at the sink.";

#[test]
fn what_the_checks_cannot_decide_is_asked_of_the_model_that_sees() {
    let (outcome, asked) = asked_about_a_mirror(&[PAST_A_MIRROR], "Yes, on the left.");
    let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
    assert_eq!((asked, instruction.provenance.drafts.len()), (vec!["Is there a mirror?".to_owned()], 0));
    let landmarks = instruction.findings.iter().filter(|finding| finding.check == CheckKind::Landmarks);
    assert_eq!(landmarks.map(|finding| finding.verdict).collect::<Vec<_>>(), [Verdict::Pass]);
    // What it denies is written again, and the draft is kept with its reason.
    let (outcome, _) = asked_about_a_mirror(&[PAST_A_MIRROR, GOOD], "No, there is no mirror.");
    let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
    assert_eq!((instruction.text.as_str(), instruction.provenance.drafts[0].text.as_str()), (GOOD, PAST_A_MIRROR));
    assert!(instruction.provenance.drafts[0].reasons[0].contains("shows no mirror"), "{instruction:?}");
    // The room at the end is asked for where no witness knew it.
    for (answer, verdict) in [("It is a kitchen.", Verdict::Pass), ("It is a garage.", Verdict::Unverified)] {
        let (outcome, asked) =
            asked_about_a_mirror(&["Walk straight ahead and turn right. Stop in the kitchen."], answer);
        let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
        assert_eq!((asked, instruction.verdict), (vec!["What room is this?".to_owned()], verdict));
    }
    // An answer that says nothing leaves it as it is.
    let (outcome, _) = asked_about_a_mirror(&[PAST_A_MIRROR], "I am not sure.");
    let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
    assert_eq!(instruction.verdict, Verdict::Unverified);
}

/// A follower that arrives the more surely the more words a text has, and wants the lamp.
struct LongTexts;

impl TextFollower for LongTexts {
    fn follow(&self, _: &str, _: &mut TextFindings) -> TextAmbiguity {
        TextAmbiguity { objects: 1, ..TextAmbiguity::default() }
    }

    fn leads_there(&self, text: &str) -> Option<f64> {
        Some(text.split(' ').count() as f64 / 20.0)
    }

    fn advice(&self, _: &Instruction) -> Vec<String> {
        vec!["no words tell where the lamp is".to_owned()]
    }
}

#[test]
fn a_text_by_which_a_follower_does_not_arrive_is_written_again_and_the_better_one_kept() {
    let walk = walk();
    let (evidence, memory) = (walk.evidence().unwrap(), walk.memory());
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::for_style(&style);
    const SHORT: &str = "Walk on and turn right. Stop at the sink.";
    for (second, kept, after) in [
        (GOOD, GOOD, Some(14.0 / 20.0)),
        ("Walk and turn right. Stop.", SHORT, Some(5.0 / 20.0)),
        (WITH_A_PIANO, SHORT, None),
    ] {
        let order = InstructionOrder {
            follower: Some(&LongTexts),
            refinements: 1,
            ..order(&walk, &memory, &evidence, &style, &profile)
        };
        let (asker, labels) = (RulesAsker::default(), LabelAnswerer::default());
        let writer = Scripted::new(vec![said(SHORT), said(second)]);
        let writers = WriterPair { writer: &writer, finisher: None };
        let outcome = write_and_repair(writers, observers(&asker, &labels), order).unwrap();
        let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
        assert_eq!(instruction.text, kept);
        let round = instruction.provenance.refined[0];
        assert_eq!((round.before, round.after, round.kept), (9.0 / 20.0, after, kept == GOOD), "{second}");
        assert_eq!(instruction.provenance.drafts.len(), 1);
        assert_eq!(writer.complaints.into_inner().unwrap(), [0, 1]);
    }
}

#[test]
fn candidates_that_were_not_chosen_are_kept_as_drafts() {
    let walk = walk();
    let (evidence, memory) = (walk.evidence().unwrap(), walk.memory());
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::for_style(&style);
    let order = InstructionOrder {
        candidates: 2,
        follower: Some(&LongTexts),
        ..order(&walk, &memory, &evidence, &style, &profile)
    };
    let (asker, labels) = (RulesAsker::default(), LabelAnswerer::default());
    let writer = Scripted::new(vec![said("Walk on and turn right. Stop at the sink."), said(WITH_A_PIANO), said(GOOD)]);
    let writers = WriterPair { writer: &writer, finisher: None };
    let outcome = write_and_repair(writers, observers(&asker, &labels), order).unwrap();
    let WritingOutcome::Accepted(instruction) = outcome else { panic!("{outcome:?}") };
    let drafts = &instruction.provenance.drafts;
    assert_eq!(instruction.text, GOOD);
    assert_eq!(drafts.iter().map(|draft| draft.candidate).collect::<Vec<_>>(), [1, 0]);
    assert!(drafts[0].reasons[0].contains("piano") && drafts[1].reasons[0].contains("another"), "{drafts:?}");
}
