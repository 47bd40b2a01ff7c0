use super::*;
use crate::{
    dialogue::OPENING,
    style::{Profile, built_in},
    walk::Walk,
    writer::Complaint,
};
use wayword_core::{
    Check, DVec3, Distinction, Finding, Motion, ObjectId, Observation, Path, SceneId, Side, Target, Verdict, path::Stop,
};

fn transcript() -> Vec<Exchange> {
    [
        ("Describe in detail what you see.", "There is a bed in the middle."),
        ("Is there a mirror?", "No, there is no mirror."),
    ]
    .map(|(question, answer)| Exchange::new(question, answer))
    .to_vec()
}

fn walk() -> Walk {
    let stop = |x: f64, y: f64, z: f64| Stop { position: DVec3::new(x, y, z), viewpoint: None, level: None };
    let frames = Path::frames_along(
        vec![stop(0.0, 0.0, 1.5), stop(0.0, 3.0, 1.5), stop(2.0, 3.0, 1.5), stop(4.0, 3.0, 4.3)],
        None,
    );
    let target = Target {
        object: ObjectId::new("7").unwrap(),
        name: "lamp".into(),
        told_by: vec![Distinction::NextTo { neighbour: "bed".into() }],
        has_namesake: true,
    };
    let path =
        Path { id: "p".into(), scene: SceneId::new("s").unwrap(), frames, motion: Motion::Known, target: Some(target) };
    let summaries =
        ["A hallway with a picture.", "A hallway with a plant.", "Some stairs.", "A bedroom with a bed and two lamps."];
    Walk::new(path, summaries.map(|summary| Observation { summary: summary.into(), ..Observation::default() }).to_vec())
}

#[test]
fn the_dialogue_prompts() {
    let prompts = Prompts::new(&[]).unwrap();
    insta::assert_snapshot!("question", prompts.question(&transcript()).unwrap());
    let answer = |manner| prompts.answer(manner, "What colour is the bed?", &transcript()).unwrap();
    insta::assert_snapshot!("answer", answer(Manner::Chat));
    assert_eq!(answer(Manner::Question), "What colour is the bed?");
    assert_eq!(
        answer(Manner::Completion),
        "Question: Is there a mirror? Answer: No, there is no mirror. Question: What colour is the bed? Answer:"
    );
    assert_eq!(prompts.answer(Manner::Question, OPENING, &[]).unwrap(), "");
    assert_eq!(prompts.answer(Manner::Completion, OPENING, &[]).unwrap(), "a photo of");
    let told = crate::dialogue::sightings(&transcript(), "test");
    insta::assert_snapshot!("summary", prompts.summary(&transcript(), &told, &[]).unwrap());
    let complaints = ["it names a mirror, which was denied".to_owned()];
    insta::assert_snapshot!("summary_again", prompts.summary(&transcript(), &told, &complaints).unwrap());
    insta::assert_snapshot!(
        "condense",
        prompts.condense(&[("north", "a bed"), ("east", "a window")], 20, &[]).unwrap()
    );
}

#[test]
fn the_writing_prompts() {
    let prompts = Prompts::new(&[]).unwrap();
    let walk = walk();
    for name in ["r2r", "reverie"] {
        let style = built_in(name).unwrap();
        let profile = Profile::measure(&style.references);
        let findings = vec![Finding {
            check: Check::Form,
            verdict: Verdict::Fail,
            reason: "22 words where the style asks for fewer than 20".into(),
            span: None,
        }];
        let complaints = [Complaint { text: "Go up.".into(), findings }];
        let complaints = if name == "reverie" { &complaints[..] } else { &[] };
        let brief = Brief { walk: &walk, style: &style, profile: &profile, seed: 0, complaints };
        insta::assert_snapshot!(format!("write_{name}"), prompts.write(&brief).unwrap());
    }
}

#[test]
fn who_writes_about_a_video_without_poses_is_told_to_make_no_motion_up() {
    let mut path = walk().path;
    path.motion = Motion::Unknown;
    path.target.as_mut().unwrap().told_by = vec![Distinction::OnSide { side: Side::Left }];
    let walk = Walk::new(path, walk().observations);
    let style = built_in("reverie").unwrap();
    let profile = Profile::measure(&style.references);
    let brief = Brief { walk: &walk, style: &style, profile: &profile, seed: 0, complaints: &[] };
    insta::assert_snapshot!("write_without_poses", Prompts::new(&[]).unwrap().write(&brief).unwrap());
}

#[test]
fn a_style_without_tasks_is_given_none_to_end_in() {
    let (prompts, walk) = (Prompts::new(&[]).unwrap(), walk());
    let tells_task = |name: &str| {
        let style = built_in(name).unwrap();
        let profile = Profile::measure(&style.references);
        let brief = Brief { walk: &walk, style: &style, profile: &profile, seed: 0, complaints: &[] };
        prompts.write(&brief).unwrap().contains("ends in a task")
    };
    assert!(!tells_task("r2r") && tells_task("reverie"));
}

#[test]
fn a_question_without_an_answer_is_not_told_again() {
    let prompts = Prompts::new(&[]).unwrap();
    let history = [Exchange::new(OPENING, "A bed."), Exchange::new("Is there a rug?", "")];
    for manner in [Manner::Chat, Manner::Completion] {
        assert!(!prompts.answer(manner, "Is there a lamp?", &history).unwrap().contains("rug"));
    }
}

#[test]
fn a_prompt_of_ones_own_takes_the_place_of_the_built_in_one_and_changes_the_hash() {
    let own = Prompts::new(&[("answer".into(), "{{ question }}!".into())]).unwrap();
    assert_eq!(own.answer(Manner::Chat, "What", &[]).unwrap(), "What!");
    assert_ne!(own.hash(), Prompts::new(&[]).unwrap().hash());
}

#[test]
fn prompts_that_cannot_be_used_are_refused() {
    assert!(matches!(Prompts::new(&[("poem".into(), String::new())]), Err(PromptError::Unknown { .. })));
    assert!(matches!(Prompts::new(&[("answer".into(), "{{ question".into())]), Err(PromptError::Template { .. })));
    for name in ["question", "answer", "summary", "condense", "write"] {
        let asks_too_much = Prompts::new(&[(name.into(), "{{ nothing }}".into())]);
        assert!(matches!(asks_too_much, Err(PromptError::Template { name: told, .. }) if told == name));
    }
}
