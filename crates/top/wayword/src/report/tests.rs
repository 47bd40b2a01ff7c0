//! The page of a small run that was made up here.

use super::*;
use crate::{
    run::{Map, Rejected, WalkRecord, file},
    settings::Asked,
};
use std::collections::BTreeSet;
use wayword_core::{
    Caption, Check, DVec3, Exchange, Finding, Gaze, Heading, Instruction, Look, Mention, MentionKind, Motion,
    Observation, Path as WalkPath, Provenance, SceneId, Sighting, Target, Verdict, Where, Witness, path::Stop,
};
use wayword_formats::jsonl::Record;

const SCRIPT: &str = "<script>alert('x')</script>";

fn path(id: &str) -> WalkPath {
    let stop = |x: f64, y: f64| Stop { position: DVec3::new(x, y, 1.5), viewpoint: None, level: Some(1) };
    let target = Target {
        object: wayword_core::ObjectId::new("7").unwrap(),
        name: "lamp".into(),
        told_by: vec![],
        has_namesake: true,
    };
    WalkPath {
        id: id.into(),
        scene: SceneId::new("made-up").unwrap(),
        frames: WalkPath::frames_along(vec![stop(0.0, 0.0), stop(0.0, 3.0), stop(2.0, 3.0)], None),
        motion: Motion::Known,
        target: Some(target),
    }
}

fn observation(room: &str, thing: &str) -> Observation {
    let sighting = |name: &str, witness| Sighting {
        name: name.into(),
        witness,
        place: Some(Where::Left),
        colour: None,
        several: false,
        by: "labels".into(),
    };
    let text = format!("A {room} with a {thing} on the left.");
    let caption = Caption {
        text: text.clone(),
        room: Some(room.into()),
        sightings: vec![sighting(thing, Witness::Seen), sighting("piano", Witness::Denied)],
        transcript: vec![Exchange::new("Is there a piano?", "No.")],
        by: None,
    };
    Observation { looks: vec![Look { gaze: Gaze::quarter(Heading::NORTH), caption }], summary: text, by: None }
}

fn walk(id: &str) -> WalkRecord {
    WalkRecord {
        platform: "house".into(),
        path: path(id),
        observations: vec![
            observation("hallway", "bench"),
            observation("hallway", "mirror"),
            observation("study", "lamp"),
        ],
        originals: vec!["Go to the study.".into()],
        map: Map { nodes: vec![[0.0, 0.0], [0.0, 3.0], [2.0, 3.0], [-2.0, 1.0]], edges: vec![[0, 1], [1, 2], [0, 3]] },
        has_pictures: false,
    }
}

fn instruction(text: &str, words: &[(&str, MentionKind, usize)], findings: Vec<Finding>) -> Instruction {
    let mention = |(word, kind, frame): &(&str, MentionKind, usize)| {
        let start = text.find(word).unwrap();
        Mention { span: [start, start + word.len()], kind: *kind, frame: *frame }
    };
    Instruction {
        text: text.into(),
        style: "r2r".into(),
        mentions: words.iter().map(mention).collect(),
        verdict: Verdict::of(&findings),
        findings,
        provenance: Provenance {
            wayword: "0.0.0".into(),
            asker: "rules".into(),
            answerer: "labels".into(),
            summariser: "rules".into(),
            writer: "rules".into(),
            checked_against: "labels".into(),
            seed: 0,
            style_hash: "0123456789abcdef".into(),
            prompts_hash: None,
            repairs: 1,
            finished_for: None,
        },
    }
}

fn finding(check: Check, verdict: Verdict, reason: &str) -> Finding {
    Finding { check, verdict, reason: reason.into(), span: None }
}

fn good() -> Instruction {
    let words =
        [("mirror", MentionKind::Landmark, 1), ("right", MentionKind::Turn, 1), ("lamp", MentionKind::Target, 2)];
    instruction(
        "Pass the mirror and turn right. Stop at the lamp.",
        &words,
        vec![finding(Check::Turns, Verdict::Pass, "")],
    )
}

/// A run folder of two items, and one that failed.
fn run_of(first: &WalkRecord, instruction: &Instruction) -> tempfile::TempDir {
    let run = tempfile::tempdir().unwrap();
    let second = walk("b");
    let wrong = Finding { span: Some([0, 9]), ..finding(Check::Turns, Verdict::Fail, "the path turns right there") };
    let last = self::instruction("Turn left. Stop at the lamp.", &[("left", MentionKind::Turn, 1)], vec![wrong]);
    let rejected = [
        Rejected {
            item: "b".into(),
            style: "r2r".into(),
            reason: "turns: the path turns right there".into(),
            last: Some(last),
        },
        Rejected { item: "c".into(), style: String::new(), reason: "no such viewpoint".into(), last: None },
    ];
    let config = toml::to_string(&Asked::default().resolve().unwrap()).unwrap();
    fs::write(run.path().join(file::CONFIG), config).unwrap();
    let mut walks = line(first);
    walks.push_str(&line(&second));
    fs::write(run.path().join(file::WALKS), walks).unwrap();
    let record = Record::new("house", first.path.clone(), instruction.clone());
    fs::write(run.path().join(file::INSTRUCTIONS), line(&record)).unwrap();
    fs::write(run.path().join(file::REJECTED), rejected.iter().map(line).collect::<String>()).unwrap();
    run
}

fn line(value: &impl Serialize) -> String {
    format!("{}\n", serde_json::to_string(value).unwrap())
}

fn page_of(run: &Path, most_items: usize) -> (String, Written) {
    let out = run.join(file::REPORT);
    let written = write(run, &out, most_items).unwrap();
    (fs::read_to_string(out).unwrap(), written)
}

fn add_picture(run: &Path) {
    fs::create_dir(run.join(file::FRAMES)).unwrap();
    image::RgbImage::new(8, 6).save(run.join("frames/a_1.jpg")).unwrap();
}

/// The values of an attribute.
fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    let opening = format!(" {attribute}=\"");
    page.split(opening.as_str()).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn the_page_of_a_small_run_is_as_before() {
    let run = run_of(&walk("a"), &good());
    let (page, _) = page_of(run.path(), 100);
    // The style sheet is for the eye.
    let (head, rest) = page.split_once("<style>").unwrap();
    let (_, body) = rest.split_once("</style>").unwrap();
    insta::assert_snapshot!(format!("{head}{body}"));
}

#[test]
fn a_walk_without_poses_shows_no_map_no_length_and_no_moves() {
    let mut video = walk("a");
    video.path.motion = Motion::Unknown;
    let run = run_of(&video, &good());
    let (page, _) = page_of(run.path(), 1);
    let (_, page) = page.split_once("<article").unwrap();
    assert!(page.contains("The recording has no poses: nothing is known of turns and distances."));
    for told in [" m ·", " m</p>", "5.0 m", "0.0 m", "<svg viewBox", "floor 1", "class=\"then\"><svg", "make no map"] {
        assert!(!page.contains(told), "{told}: {page}");
    }
    assert_eq!((page.matches("class=\"frame\"").count(), page.matches("the walk ends here").count()), (3, 1));
}

#[test]
fn what_comes_from_files_and_models_stays_text() {
    let mut walk = walk(&format!("a{SCRIPT}"));
    walk.originals = vec![SCRIPT.into()];
    walk.observations[0].summary = SCRIPT.into();
    walk.observations[0].looks[0].caption = Caption {
        text: SCRIPT.into(),
        room: Some(SCRIPT.into()),
        sightings: vec![Sighting { name: SCRIPT.into(), ..walk.observations[0].looks[0].caption.sightings[0].clone() }],
        transcript: vec![Exchange::new(SCRIPT, "\" onload=\"alert(1)")],
        by: None,
    };
    walk.path.target.as_mut().unwrap().name = SCRIPT.into();
    let mut hostile = instruction(
        SCRIPT,
        &[("alert", MentionKind::Room, 1)],
        vec![finding(Check::Form, Verdict::Unverified, SCRIPT)],
    );
    hostile.style = SCRIPT.into();
    hostile.provenance.writer = SCRIPT.into();
    let run = run_of(&walk, &hostile);
    let (page, _) = page_of(run.path(), 100);
    assert!(!page.contains("<script") && !page.contains("\" onload"));
    assert!(page.matches("&lt;script&gt;").count() > 10);
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn every_link_leads_to_a_place_on_the_page_and_nothing_is_loaded() {
    let run = run_of(&WalkRecord { has_pictures: true, ..walk("a") }, &good());
    add_picture(run.path());
    let (page, _) = page_of(run.path(), 100);
    let places: BTreeSet<&str> = values(&page, "id").into_iter().collect();
    assert_eq!(places.len(), values(&page, "id").len(), "two places of one name");
    let links = values(&page, "href");
    for link in &links {
        assert!(link.strip_prefix('#').is_some_and(|place| places.contains(place)), "{link} leads nowhere");
    }
    for frame in ["#w1-f2", "#w1-f3", "#w2-f2"] {
        assert!(links.contains(&frame));
    }
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("url(") && !page.contains("@import"));
    let sources = values(&page, "src");
    assert!(sources.len() == 1 && sources.iter().all(|source| source.starts_with("data:image/jpeg;base64,")));
}

#[test]
fn mentions_are_links_to_their_frames() {
    let run = run_of(&walk("a"), &good());
    let (page, _) = page_of(run.path(), 100);
    let link = |kind: &str, frame: &str, word: &str| {
        let opening = format!("<a class=\"tie {kind}\" href=\"#{frame}\"");
        page.split(opening.as_str())
            .skip(1)
            .any(|rest| rest.split_once("<span class=\"told\">").is_some_and(|(_, rest)| rest.starts_with(word)))
    };
    assert!(link("landmark", "w1-f2", "mirror") && link("turn", "w1-f2", "right") && link("target", "w1-f3", "lamp"));
}

#[test]
fn pictures_are_within_the_page() {
    let record = WalkRecord { has_pictures: true, ..walk("a") };
    let run = run_of(&record, &good());
    add_picture(run.path());
    let (page, written) = page_of(run.path(), 100);
    assert_eq!((written.pictures, written.pictures_left_out), (1, 2));
    assert_eq!(values(&page, "src").len(), 1);
}

#[test]
fn only_the_first_items_are_shown_and_the_page_says_so() {
    let run = run_of(&walk("a"), &good());
    let (page, written) = page_of(run.path(), 1);
    assert_eq!((written.items, written.left_out), (1, 1));
    assert_eq!(page.matches("<article ").count(), 1);
    assert!(page.contains("the first 1 of 2 walks; 1 are left out"));
    let none = page_of(run.path(), 0).1;
    assert_eq!((none.items, none.left_out), (0, 2));
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let run = run_of(&walk("a"), &good());
    assert_eq!(page_of(run.path(), 100), page_of(run.path(), 100));
}

#[test]
fn hostile_frames_and_spans_do_no_harm() {
    let mut wild = walk("a");
    wild.map.edges.push([usize::MAX, 0]);
    wild.path.frames[1].pose.position.x = 1e308;
    wild.observations.truncate(1);
    let mut bad = good();
    bad.mentions = vec![
        Mention { span: [usize::MAX, 0], kind: MentionKind::Room, frame: 0 },
        Mention { span: [0, 4], kind: MentionKind::Room, frame: usize::MAX },
    ];
    let run = run_of(&wild, &bad);
    let (page, _) = page_of(run.path(), 100);
    assert!(page.contains("The positions of this path make no map."));
    assert!(page.contains("Pass the mirror and turn right. Stop at the lamp."));
}

#[test]
fn a_folder_that_is_no_run_is_refused_and_the_old_page_stays() {
    let run = run_of(&walk("a"), &good());
    let before = page_of(run.path(), 100);
    fs::write(run.path().join(file::WALKS), "nonsense\n").unwrap();
    let out = run.path().join(file::REPORT);
    assert!(write(run.path(), &out, 100).unwrap_err().to_string().contains("walks.jsonl: line 1"));
    assert_eq!(fs::read_to_string(&out).unwrap(), before.0);
    assert!(write(&run.path().join("nothing"), &out, 100).is_err());
}
