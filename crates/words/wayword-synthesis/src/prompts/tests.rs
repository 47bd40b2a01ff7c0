use super::*;
use crate::{
    dialogue::OPENING_REQUEST,
    style::{StyleProfile, built_in},
    walk::ObservedWalk,
    writer::TextComplaint,
};
use wayword_core::{
    Caption, CaptionedView, CheckFinding, CheckKind, DVec3, FrameObservation, InstructionStyle, ObjectDistinction,
    ObjectId, Path, PathMotion, PathTarget, SceneId, Side, Verdict, ViewGaze, ViewThird, path::PathStop,
};

fn transcript() -> Vec<DialogueExchange> {
    [
        ("Describe in detail what you see.", "There is a bed in the middle."),
        ("Is there a mirror?", "No, there is no mirror."),
    ]
    .map(|(question, answer)| DialogueExchange::new(question, answer))
    .to_vec()
}

fn walk() -> ObservedWalk {
    let stop = |x: f64, y: f64, z: f64| PathStop { position: DVec3::new(x, y, z), viewpoint: None, level: None };
    let frames = Path::frames_along(
        vec![stop(0.0, 0.0, 1.5), stop(0.0, 3.0, 1.5), stop(2.0, 3.0, 1.5), stop(4.0, 3.0, 4.3)],
        None,
    );
    let target = PathTarget {
        object: ObjectId::new("7").unwrap(),
        name: "lamp".into(),
        told_by: vec![ObjectDistinction::NextTo { neighbour: "bed".into() }],
        has_namesake: true,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    };
    let path = Path {
        id: "p".into(),
        scene: SceneId::new("s").unwrap(),
        frames,
        motion: PathMotion::Known,
        target: Some(target),
    };
    let summaries =
        ["A hallway with a picture.", "A hallway with a plant.", "Some stairs.", "A bedroom with a bed and two lamps."];
    ObservedWalk::new(
        path,
        summaries.map(|summary| FrameObservation { summary: summary.into(), ..FrameObservation::default() }).to_vec(),
    )
}

#[test]
fn the_dialogue_prompts() {
    let prompts = Prompts::new(&[]).unwrap();
    insta::assert_snapshot!("question", prompts.question_prompt(&transcript()).unwrap());
    let answer = |manner| prompts.answer_prompt(manner, "What colour is the bed?", &transcript()).unwrap();
    insta::assert_snapshot!("answer", answer(PromptManner::Chat));
    assert_eq!(answer(PromptManner::Question), "What colour is the bed?");
    assert_eq!(
        answer(PromptManner::Completion),
        "Question: Is there a mirror? Answer: No, there is no mirror. Question: What colour is the bed? Answer:"
    );
    assert_eq!(prompts.answer_prompt(PromptManner::Question, OPENING_REQUEST, &[]).unwrap(), "");
    assert_eq!(prompts.answer_prompt(PromptManner::Completion, OPENING_REQUEST, &[]).unwrap(), "a photo of");
    let told = crate::dialogue::dialogue_sightings(&transcript(), "test");
    insta::assert_snapshot!("summary", prompts.summary_prompt(&transcript(), &told, &[]).unwrap());
    let complaints = ["it names a mirror, which was denied".to_owned()];
    insta::assert_snapshot!("summary_again", prompts.summary_prompt(&transcript(), &told, &complaints).unwrap());
    insta::assert_snapshot!(
        "condense",
        prompts.condense_prompt(&[("north", "a bed"), ("east", "a window")], 20, &[]).unwrap()
    );
}

#[test]
fn the_writing_prompts() {
    let prompts = Prompts::new(&[]).unwrap();
    let walk = walk();
    for name in ["r2r", "reverie"] {
        let style = built_in(name).unwrap();
        let profile = StyleProfile::from_references(&style.references);
        let findings = vec![CheckFinding {
            check: CheckKind::Form,
            verdict: Verdict::Fail,
            reason: "22 words where the style asks for fewer than 20".into(),
            span: None,
        }];
        let complaints = [TextComplaint { text: "Go up.".into(), findings }];
        let complaints = if name == "reverie" { &complaints[..] } else { &[] };
        let memory = walk.memory();
        let brief = WritingBrief { complaints, ..WritingBrief::new(&walk, &memory, &style, &profile, 0) };
        insta::assert_snapshot!(format!("write_{name}"), prompts.writing_prompt(&brief).unwrap());
    }
}

#[test]
fn writing_prompt_without_poses_forbids_invented_motion() {
    let mut path = walk().path;
    path.motion = PathMotion::Unknown;
    path.target.as_mut().unwrap().told_by = vec![ObjectDistinction::OnSide { side: Side::Left }];
    let walk = ObservedWalk::new(path, walk().observations);
    let style = built_in("reverie").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let memory = walk.memory();
    let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
    insta::assert_snapshot!("write_without_poses", Prompts::new(&[]).unwrap().writing_prompt(&brief).unwrap());
}

#[test]
fn a_style_without_tasks_is_given_none_to_end_in() {
    let (prompts, walk) = (Prompts::new(&[]).unwrap(), walk());
    let tells_task = |name: &str| {
        let style = built_in(name).unwrap();
        let profile = StyleProfile::from_references(&style.references);
        let memory = walk.memory();
        let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
        prompts.writing_prompt(&brief).unwrap().contains("ends in a task")
    };
    assert!(!tells_task("r2r") && tells_task("reverie"));
}

/// The prompt after one refusal, about some words of the refused text.
fn after_refusal(text: &str, check: CheckKind, words: &str, reason: &str) -> String {
    let start = text.find(words).unwrap();
    let span = Some([start, start + words.len()]);
    let finding = CheckFinding { check, verdict: Verdict::Fail, reason: reason.into(), span };
    let complaints = [TextComplaint { text: text.into(), findings: vec![finding] }];
    let (walk, style) = (walk(), built_in("r2r").unwrap());
    let profile = StyleProfile::from_references(&style.references);
    let memory = walk.memory();
    let brief = WritingBrief { complaints: &complaints, ..WritingBrief::new(&walk, &memory, &style, &profile, 0) };
    Prompts::new(&[]).unwrap().writing_prompt(&brief).unwrap()
}

#[test]
fn reasons_of_a_refusal_contain_the_correction() {
    let reason = "the path does not turn left there";
    let one = after_refusal("Walk on. Turn left. Go up the stairs.", CheckKind::Turns, "Turn left", reason);
    assert!(
        one.contains(
            "you wrote \"Turn left\": the path does not turn left there (the walk turns right there, at Frame 1)"
        ),
        "{one}"
    );
    let two = after_refusal("Turn left. Turn left. Stop.", CheckKind::Turns, "Turn left", reason);
    assert!(two.contains("the turns of the walk are, in order: turns right at Frame 1"), "{two}");
    let down = after_refusal("Go down the stairs.", CheckKind::Floors, "down the stairs", "it does not go down");
    assert!(down.contains("it goes up stairs from Frame 2"), "{down}");
    let piano =
        after_refusal("Go past the piano.", CheckKind::Landmarks, "piano", "no frame of the path shows \"piano\"");
    assert!(piano.contains("name something that the parts show"), "{piano}");
}

#[test]
fn a_prompt_shows_at_most_10_references_whatever_the_style_has() {
    let references: Vec<String> = (0..500).map(|at| format!("Walk past chair {at}.")).collect();
    let style = InstructionStyle { references, ..built_in("r2r").unwrap() };
    let (walk, profile) = (walk(), StyleProfile::from_references(&style.references));
    let memory = walk.memory();
    let of = |seed| {
        Prompts::new(&[]).unwrap().writing_prompt(&WritingBrief::new(&walk, &memory, &style, &profile, seed)).unwrap()
    };
    assert_eq!(of(1).matches("Walk past chair").count(), 10);
    assert_eq!(of(1), of(1));
    assert_ne!(of(1), of(2));
}

#[test]
fn writing_prompt_lists_things_of_frames_and_marks_an_unseen_target() {
    let style = built_in("reverie").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let prompt = |walk: &ObservedWalk| {
        Prompts::new(&[])
            .unwrap()
            .writing_prompt(&WritingBrief::new(walk, &walk.memory(), &style, &profile, 0))
            .unwrap()
    };
    let mut seen = walk();
    let target = seen.path.target.as_mut().unwrap();
    (target.has_namesake, target.name) = (false, "lamp".into());
    assert!(prompt(&seen).contains("lamp (nobody described it"), "{}", prompt(&seen));
    let sighting = |name: &str, witness, place| ObjectSighting {
        place,
        colour: Some("white".into()),
        ..ObjectSighting::new(name, witness, "test")
    };
    let sightings = vec![
        sighting("lamp", WitnessAnswer::Seen, Some(ViewThird::Left)),
        sighting("bed", WitnessAnswer::Seen, None),
        sighting("mirror", WitnessAnswer::Denied, None),
        sighting("soft", WitnessAnswer::Seen, None),
    ];
    let gaze = ViewGaze::quarter_view(seen.path.frames[3].pose.heading);
    seen.observations[3].looks = vec![CaptionedView { gaze, caption: Caption { sightings, ..Caption::default() } }];
    let prompt = prompt(&seen);
    assert!(!prompt.contains("nobody described it"), "{prompt}");
    assert!(prompt.contains("- seen from the last frame: white lamp (left); white bed\n"), "{prompt}");
    assert!(!prompt.contains("soft"), "no thing is called that: {prompt}");
}

/// A hallway with a sofa on the left that two frames show, and then a bedroom.
#[test]
fn writing_prompt_describes_each_thing_and_room_once() {
    let mut walk = walk();
    let looks = [
        ("hallway", ViewThird::Left),
        ("hallway", ViewThird::Left),
        ("hallway", ViewThird::Right),
        ("bedroom", ViewThird::Middle),
    ];
    for (at, (room, place)) in looks.into_iter().enumerate() {
        let gaze = ViewGaze::quarter_view(walk.path.frames[at].pose.heading);
        let sofa = ObjectSighting {
            place: Some(place),
            colour: Some("grey".into()),
            ..ObjectSighting::new("sofa", WitnessAnswer::Seen, "test")
        };
        let sightings = if at < 2 { vec![sofa] } else { Vec::new() };
        let caption = Caption { room: Some(room.into()), sightings, ..Caption::default() };
        walk.observations[at].looks = vec![CaptionedView { gaze, caption }];
    }
    let style = built_in("r2r").unwrap();
    let profile = StyleProfile::from_references(&style.references);
    let prompt = Prompts::new(&[])
        .unwrap()
        .writing_prompt(&WritingBrief::new(&walk, &walk.memory(), &style, &profile, 0))
        .unwrap();
    let told = prompt.split("not sure.").nth(1).unwrap().split("The style,").next().unwrap();
    assert!(told.contains("Frame 0, hallway: straight on, 3.0 metres\n- also in sight: grey sofa (left)"), "{told}");
    assert!(told.contains("Frame 1, hallway: turn right (90 degrees), 2.0 metres\n"), "{told}");
    assert!(
        told.contains(
            "Frame 2, hallway: straight on, 3.4 metres, up 2.8 metres of stairs, then through a door into the bedroom\n"
        ),
        "{told}"
    );
    assert!(told.contains("Frame 3, bedroom: the end\n"), "{told}");
    assert_eq!(told.matches("sofa").count(), 1, "{told}");
}

/// Eighteen frames with nine things each, and eight of them: the whole way is told, in few tokens.
#[test]
fn a_writing_prompt_tells_the_whole_walk_in_few_tokens() {
    const NAMES: [&str; 12] =
        ["sofa", "table", "lamp", "chair", "plant", "mirror", "picture", "bookshelf", "clock", "rug", "bench", "vase"];
    for (count, most_tokens) in [(18, 2_000), (8, 1_200)] {
        let stop = |at: usize| PathStop {
            position: DVec3::new((at / 4) as f64 * 2.0, (at - at / 4) as f64 * 0.8, 1.5),
            viewpoint: None,
            level: None,
        };
        let path =
            Path { frames: Path::frames_along((0..count).map(stop).collect(), None), target: None, ..walk().path };
        let look = |at: usize| {
            let places = [ViewThird::Left, ViewThird::Middle, ViewThird::Right];
            let sighting = |number: usize| ObjectSighting {
                place: Some(places[number % 3]),
                colour: Some(["red", "green", "blue"][(at / 3 + number) % 3].into()),
                is_far: number % 4 == 3,
                ..ObjectSighting::new(NAMES[(at / 3 + number) % NAMES.len()], WitnessAnswer::Seen, "test")
            };
            let room = ["hallway", "living room", "kitchen"][at * 3 / count];
            let sightings = (0..9).map(sighting).collect();
            let caption = Caption { room: Some(room.into()), sightings, is_structured: true, ..Caption::default() };
            let gaze = ViewGaze::quarter_view(path.frames[at].pose.heading);
            FrameObservation { looks: vec![CaptionedView { gaze, caption }], ..FrameObservation::default() }
        };
        let walk = ObservedWalk::new(path.clone(), (0..count).map(look).collect());
        let style = built_in("r2r").unwrap();
        let profile = StyleProfile::from_references(&style.references);
        let memory = walk.memory();
        let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
        let prompt = Prompts::new(&[]).unwrap().writing_prompt(&brief).unwrap();
        // A token has about four letters of English.
        assert!(prompt.len() / 4 <= most_tokens, "{} tokens: {prompt}", prompt.len() / 4);
        let end = prompt.split("The style,").next().unwrap();
        assert!(end.contains(&format!("{}, kitchen: ", count - 1)) && end.contains("the end\n- "), "{end}");
        // A model that reads less gets the whole way too, with fewer things and examples.
        let prompts = Prompts::new(&[]).unwrap();
        assert_eq!(prompts.writing_prompt_within(&brief, prompt.len()).unwrap(), (prompt.clone(), false));
        let (short, is_shortened) = prompts.writing_prompt_within(&brief, prompt.len() - 1).unwrap();
        let (least, _) = prompts.writing_prompt_within(&brief, 100).unwrap();
        assert!(is_shortened && least.len() < short.len() && short.len() < prompt.len());
        assert!(least.contains("the end\n- ") && least.len() / 4 <= 1_000, "{} tokens", least.len() / 4);
    }
}

#[test]
fn unanswered_questions_are_left_out_of_prompts() {
    let prompts = Prompts::new(&[]).unwrap();
    let history = [DialogueExchange::new(OPENING_REQUEST, "A bed."), DialogueExchange::new("Is there a rug?", "")];
    for manner in [PromptManner::Chat, PromptManner::Completion] {
        assert!(!prompts.answer_prompt(manner, "Is there a lamp?", &history).unwrap().contains("rug"));
    }
}

#[test]
fn a_user_prompt_replaces_the_built_in_one_and_changes_the_hash() {
    let own = Prompts::new(&[("answer".into(), "{{ question }}!".into())]).unwrap();
    assert_eq!(own.answer_prompt(PromptManner::Chat, "What", &[]).unwrap(), "What!");
    assert_ne!(own.hash(), Prompts::new(&[]).unwrap().hash());
}

/// Why a user's own prompt is refused.
fn refused(source: &str) -> String {
    Prompts::new(&[("answer".into(), source.into())]).unwrap_err().to_string()
}

#[test]
fn a_prompt_that_writes_without_bound_is_refused_with_the_bound() {
    for source in [
        "{{ question | indent(4000000000) }}",
        "{{ question | indent(width=4000000000, first=true) }}",
        "{% for a in range(1000) %}{{ question | indent(10000, true) }}{% endfor %}",
        "{{ range(1000) | join('00123456789') | replace('0', range(1000) | join('-')) }}",
        "{{ [range(1000) | join('0123456789')] | map('replace', '', range(1000) | join('-')) | join }}",
    ] {
        let why = refused(source);
        assert!(why.contains("prompt answer.j2: ") && why.contains("8388608 bytes"), "{source}: {why}");
    }
    let endless = "{% for a in range(1000) %}{% for b in range(1000) %}{% if a %}{% endif %}{% endfor %}{% endfor %}";
    assert!(refused(endless).contains("200000 steps"), "{}", refused(endless));
    assert!(refused("{{ range(100000) | length }}").contains("at most 1000"));
}

#[test]
fn templates_with_unlimited_constructs_are_refused() {
    for (source, what) in [
        ("A\n{% set a = question %}", "`set`"),
        ("A\n{%- macro f() %}{% endmacro %}", "`macro`"),
        ("A\n{% filter upper %}{% endfilter %}", "`filter`"),
        ("A\n{% include 'write' %}", "`include`"),
        ("A\n{% for a in history recursive %}{% endfor %}", "`recursive`"),
        ("A\n{{ question * 1000000000 }}", "`*`"),
        ("A\n{{ '}}' * 1000000000 }}", "`*`"),
        ("A\n{{ '%1000000000d' | format(1) }}", "`format`"),
        ("A\n{{ history | pprint }}", "`pprint`"),
    ] {
        let why = refused(source);
        assert!(why.contains("line 2") && why.contains(what), "{source}: {why}");
    }
    assert!(refused(&format!("{{{{ {} }}}}", vec!["question"; 100].join(" ~ "))).contains("at most 64"));
    for filter in ["format", "upper itself"] {
        let why = refused(&format!("{{{{ history | map('{filter}') | join }}}}"));
        assert!(why.contains("unknown filter"), "{filter}: {why}");
    }
    assert!(refused(&"a".repeat(70_000)).contains("65536 bytes"));
}

#[test]
fn common_filters_are_offered() {
    let source = "**A** * {# a * note #}{{ question | upper | replace('A', 'b') ~ '!' }} {{ history | length + 1 }} \
                  {{ history | map(attribute='answer') | join('; ') | indent(2, true) | trim }} {{ question | tojson }} \
                  {{ [3, 1, 2] | sort | first }}{{ nothing | default(4) }}{% raw %} {{ a * b }}{% endraw %}";
    let own = Prompts::new(&[("answer".into(), source.into())]).unwrap();
    let history = [DialogueExchange::new("Where?", "In a hall."), DialogueExchange::new("What?", "A <rug>.")];
    assert_eq!(
        own.answer_prompt(PromptManner::Chat, "what", &history).unwrap(),
        "**A** * WHbT! 3 In a hall.; A <rug>. \"what\" 14 {{ a * b }}"
    );
}

#[test]
fn the_longest_style_and_walk_that_are_allowed_fit_into_a_prompt() {
    let style = InstructionStyle { references: vec!["a ".repeat(2000); 1000], ..built_in("r2r").unwrap() };
    let profile = StyleProfile::from_references(&built_in("r2r").unwrap().references);
    let mut long = walk();
    long.path.frames = long.path.frames.iter().cycle().take(1000).cloned().collect();
    let summary = "A hallway with a picture. ".repeat(40);
    let observations = vec![FrameObservation { summary, ..FrameObservation::default() }; 1000];
    let walk = ObservedWalk::new(long.path, observations);
    let memory = walk.memory();
    let brief = WritingBrief::new(&walk, &memory, &style, &profile, 0);
    assert!(Prompts::new(&[]).unwrap().writing_prompt(&brief).is_ok());
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
