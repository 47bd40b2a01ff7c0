//! The page of a small made-up run.

use super::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
};
use wayword_core::{
    Caption, CaptionedView, CheckFinding, CheckKind, DVec3, DialogueExchange, FrameObservation, Heading, Instruction,
    InstructionPart, MentionKind, ObjectSighting, Path as WalkPath, PathMotion, PathTarget, SceneId, TextMention,
    TextProvenance, Verdict, ViewGaze, ViewThird, WitnessAnswer, path::PathStop,
};
use wayword_formats::jsonl::InstructionRecord;
use wayword_run::{
    check::CheckedText,
    run_folder::{PathMap, RejectedText, WalkRecord, file},
    settings::{AskedSettings, Walks},
};

const HOSTILE: &str = "<script>alert('x')</script>";

fn path(id: &str) -> WalkPath {
    let stop = |x: f64, y: f64| PathStop { position: DVec3::new(x, y, 1.5), viewpoint: None, level: Some(1) };
    let target = PathTarget {
        object: wayword_core::ObjectId::new("7").unwrap(),
        name: "lamp".into(),
        told_by: vec![],
        has_namesake: true,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    };
    WalkPath {
        id: id.into(),
        scene: SceneId::new("made-up").unwrap(),
        frames: WalkPath::frames_along(vec![stop(0.0, 0.0), stop(0.0, 3.0), stop(2.0, 3.0)], None),
        motion: PathMotion::Known,
        target: Some(target),
    }
}

fn observation(room: &str, thing: &str) -> FrameObservation {
    let sighting = |name: &str, witness| ObjectSighting {
        place: Some(ViewThird::Left),
        ..ObjectSighting::new(name, witness, "labels")
    };
    let text = format!("A {room} with a {thing} on the left.");
    let caption = Caption {
        text: text.clone(),
        room: Some(room.into()),
        sightings: vec![sighting(thing, WitnessAnswer::Seen), sighting("piano", WitnessAnswer::Denied)],
        transcript: vec![DialogueExchange::new("Is there a piano?", "No.")],
        ..Caption::default()
    };
    FrameObservation {
        looks: vec![CaptionedView { gaze: ViewGaze::quarter_view(Heading::NORTH), caption }],
        summary: text,
        by: None,
    }
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
        map: PathMap {
            nodes: vec![[0.0, 0.0], [0.0, 3.0], [2.0, 3.0], [-2.0, 1.0]],
            edges: vec![[0, 1], [1, 2], [0, 3]],
        },
        has_pictures: false,
        used: None,
    }
}

fn instruction(text: &str, words: &[(&str, MentionKind, usize)], findings: Vec<CheckFinding>) -> Instruction {
    let mention = |(word, kind, frame): &(&str, MentionKind, usize)| {
        let start = text.find(word).unwrap();
        TextMention { span: [start, start + word.len()], kind: *kind, frame: *frame }
    };
    Instruction {
        text: text.into(),
        style: "r2r".into(),
        mentions: words.iter().map(mention).collect(),
        parts: Vec::new(),
        verdict: Verdict::from_findings(&findings),
        findings,
        ambiguity: None,
        provenance: TextProvenance {
            wayword: "0.0.0".into(),
            asker: "rules".into(),
            answerer: "labels".into(),
            detector: None,
            summariser: "rules".into(),
            writer: "rules".into(),
            checked_against: "labels".into(),
            seed: 0,
            style_hash: "0123456789abcdef".into(),
            prompts_hash: None,
            repairs: 1,
            finished_for: None,
            chosen: None,
            drafts: Vec::new(),
            refined: Vec::new(),
            target_undescribed: false,
        },
    }
}

fn finding(check: CheckKind, verdict: Verdict, reason: &str) -> CheckFinding {
    CheckFinding { check, verdict, reason: reason.into(), span: None }
}

fn good() -> Instruction {
    let words =
        [("mirror", MentionKind::Landmark, 1), ("right", MentionKind::Turn, 1), ("lamp", MentionKind::Target, 2)];
    instruction(
        "Pass the mirror and turn right. Stop at the lamp.",
        &words,
        vec![finding(CheckKind::Turns, Verdict::Pass, "")],
    )
}

/// A run folder of two items, and one that failed.
fn run_of(first: &WalkRecord, instruction: &Instruction) -> tempfile::TempDir {
    let run = tempfile::tempdir().unwrap();
    let second = walk("b");
    let wrong =
        CheckFinding { span: Some([0, 9]), ..finding(CheckKind::Turns, Verdict::Fail, "the path turns right there") };
    let last = self::instruction("Turn left. Stop at the lamp.", &[("left", MentionKind::Turn, 1)], vec![wrong]);
    let rejected = [
        RejectedText {
            item: "b".into(),
            style: "r2r".into(),
            reason: "turns: the path turns right there".into(),
            last: Some(last),
            number: 0,
            drafts: Vec::new(),
            cost: None,
        },
        RejectedText {
            item: "c".into(),
            style: String::new(),
            reason: "no such viewpoint".into(),
            last: None,
            number: 0,
            drafts: Vec::new(),
            cost: None,
        },
    ];
    let config = toml::to_string(&AskedSettings::default().resolve().unwrap()).unwrap();
    fs::write(run.path().join(file::CONFIG), config).unwrap();
    let mut walks = line(first);
    walks.push_str(&line(&second));
    fs::write(run.path().join(file::WALKS), walks).unwrap();
    let record = InstructionRecord::new("house", first.path.clone(), instruction.clone());
    fs::write(run.path().join(file::INSTRUCTIONS), line(&record)).unwrap();
    fs::write(run.path().join(file::REJECTED), rejected.iter().map(line).collect::<String>()).unwrap();
    run
}

fn line(value: &impl Serialize) -> String {
    format!("{}\n", serde_json::to_string(value).unwrap())
}

fn page_of(run: &Path, most_items: usize) -> (String, WrittenReport) {
    let out = run.join(file::REPORT);
    let written = write_report(run, &out, most_items).unwrap();
    (without_script(&fs::read_to_string(out).unwrap()), written)
}

fn options(most_items: usize) -> ReportOptions {
    ReportOptions { most_items, is_single_file: false, again: CheckedAgain::default() }
}

/// A page without its own script, of which it has to have exactly one.
fn without_script(page: &str) -> String {
    let own = format!("<script>{SCRIPT}</script>");
    assert_eq!(page.matches(&own).count(), 1);
    page.replace(&own, "")
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
    // Without the style sheet.
    let (head, rest) = page.split_once("<style>").unwrap();
    let (_, body) = rest.split_once("</style>").unwrap();
    insta::assert_snapshot!(format!("{head}{body}"));
}

#[test]
fn a_walk_without_poses_shows_no_map_no_length_and_no_moves() {
    let mut video = walk("a");
    video.path.motion = PathMotion::Unknown;
    let run = run_of(&video, &good());
    let (page, _) = page_of(run.path(), 100);
    let (_, page) = page.split_once("<article id=\"w2\"").unwrap();
    assert!(page.contains("The recording has no poses, so its turns and distances are not known."));
    for told in [" m ·", " m</p>", "5.0 m", "0.0 m", "<svg viewBox", "storey 1", "class=\"then\"><svg", "as a map"] {
        assert!(!page.contains(told), "{told}: {page}");
    }
    assert_eq!((page.matches("class=\"frame\"").count(), page.matches("the path ends here").count()), (3, 1));
}

#[test]
fn page_escapes_texts_from_files_and_models() {
    let mut walk = walk(&format!("a{HOSTILE}"));
    walk.originals = vec![HOSTILE.into()];
    walk.observations[0].summary = HOSTILE.into();
    walk.observations[0].looks[0].caption = Caption {
        text: HOSTILE.into(),
        room: Some(HOSTILE.into()),
        sightings: vec![ObjectSighting {
            name: HOSTILE.into(),
            ..walk.observations[0].looks[0].caption.sightings[0].clone()
        }],
        transcript: vec![DialogueExchange::new(HOSTILE, "\" onload=\"alert(1)")],
        ..Caption::default()
    };
    walk.path.target.as_mut().unwrap().name = HOSTILE.into();
    let mut hostile = instruction(
        HOSTILE,
        &[("alert", MentionKind::Room, 1)],
        vec![finding(CheckKind::Form, Verdict::Unverified, HOSTILE)],
    );
    hostile.style = HOSTILE.into();
    hostile.provenance.writer = HOSTILE.into();
    let run = run_of(&walk, &hostile);
    let (page, _) = page_of(run.path(), 100);
    assert!(!page.contains("<script") && !page.contains("\" onload"));
    assert!(page.matches("&lt;script&gt;").count() > 10);
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn the_policy_allows_the_own_script_and_no_other() {
    let run = run_of(&walk("a"), &good());
    let (page, _) = page_of(run.path(), 100);
    let policy = values(&page, "content")[0].replace("&#x27;", "'").replace("&#x2f;", "/");
    let hash = data_uri::encode_base64(&Sha256::digest(SCRIPT));
    assert!(policy.contains(&format!("script-src 'sha256-{hash}';")), "{policy}");
    assert!(policy.starts_with("default-src 'none'; img-src 'self' file:;"), "{policy}");
    for forbidden in ["innerHTML", "eval(", "fetch(", "http", "</script"] {
        assert!(!SCRIPT.contains(forbidden), "{forbidden}");
    }
}

#[test]
fn page_has_a_target_for_every_link_and_loads_nothing_foreign() {
    let run = run_of(&WalkRecord { has_pictures: true, ..walk("a") }, &good());
    add_picture(run.path());
    let (page, _) = page_of(run.path(), 100);
    let places: BTreeSet<&str> = values(&page, "id").into_iter().collect();
    assert_eq!(places.len(), values(&page, "id").len(), "two places of one name");
    let links = values(&page, "href");
    for link in &links {
        assert!(link.strip_prefix('#').is_some_and(|place| places.contains(place)), "{link} leads nowhere");
    }
    for frame in ["#w1-f1", "#w2-f1", "#w2-f2"] {
        assert!(links.contains(&frame));
    }
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("url(") && !page.contains("@import"));
    let sources = values(&page, "src");
    assert!(!sources.is_empty() && sources.iter().all(|source| run.path().join(source).is_file()), "{sources:?}");
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
    assert!(link("landmark", "w2-f1", "mirror") && link("turn", "w2-f1", "right") && link("target", "w2-f2", "lamp"));
}

#[test]
fn parts_name_their_frames_and_light_them_up() {
    let part = |span, frames, confidence| InstructionPart { span, frames, confidence };
    let parts = vec![part([0, 31], [0, 1], Some(0.75)), part([32, 49], [1, 2], None)];
    let run = run_of(&walk("a"), &Instruction { parts: parts.clone(), ..good() });
    let (page, _) = page_of(run.path(), 100);
    let (_, page) = page.split_once("<article id=\"w2\"").unwrap();
    assert!(page.contains("<bdi>Pass the mirror and turn right.</bdi> <a href=\"#w2-f0\">frames 0 to 1</a>"), "{page}");
    // The script lights up what has these numbers.
    for told in [
        "75 %",
        "<span class=\"part\" data-part=\"1\" data-from=\"1\" data-to=\"2\">",
        "<li class=\"part\" data-part=\"0\" data-from=\"0\" data-to=\"1\">",
        "id=\"w2-f1\" data-frame=\"1\"",
        "href=\"#w2-f2\" data-frame=\"2\"",
        "data-hop=\"1\"",
    ] {
        assert!(page.contains(told), "{told}: {page}");
    }
    // A part with a frame that the path does not have could come from a damaged file: then no part is shown.
    let wrong = vec![parts[0].clone(), part([32, 49], [1, 7], None)];
    let run = run_of(&walk("a"), &Instruction { parts: wrong, ..good() });
    let (page, _) = page_of(run.path(), 100);
    let (_, page) = page.split_once("<article id=\"w2\"").unwrap();
    assert!(!page.contains("data-part"), "{page}");
}

#[test]
fn pictures_lie_beside_the_page_and_move_with_it() {
    let record = WalkRecord { has_pictures: true, ..walk("a") };
    let run = run_of(&record, &good());
    add_picture(run.path());
    let (page, written) = page_of(run.path(), 100);
    assert_eq!((written.pictures, written.pictures_left_out), (1, 2));
    let sources = values(&page, "src");
    assert!(sources.len() == 1 && sources[0].starts_with("report-files/"), "{sources:?}");
    assert_eq!(fs::read(run.path().join(sources[0])).unwrap(), fs::read(run.path().join("frames/a_1.jpg")).unwrap());
    for told in ["width=\"8\"", "height=\"6\"", "loading=\"lazy\""] {
        assert!(page.contains(told), "{told}");
    }
    // Without pictures the folder goes.
    fs::remove_dir_all(run.path().join(file::FRAMES)).unwrap();
    page_of(run.path(), 100);
    assert!(!run.path().join("report-files").exists());
}

#[test]
fn a_single_file_contains_its_pictures() {
    let run = run_of(&WalkRecord { has_pictures: true, ..walk("a") }, &good());
    add_picture(run.path());
    let out = run.path().join("one.html");
    write_report_as(run.path(), &out, &ReportOptions { is_single_file: true, ..options(100) }).unwrap();
    let page = fs::read_to_string(out).unwrap();
    let sources = values(&page, "src");
    assert!(sources.len() == 1 && sources[0].starts_with("data:image/jpeg;base64,"), "{sources:?}");
    assert!(!run.path().join("one-files").exists() && page.contains("img-src data:;"));
}

#[test]
fn page_shows_only_the_first_items_and_reports_it() {
    let run = run_of(&walk("a"), &good());
    let (page, written) = page_of(run.path(), 1);
    assert_eq!((written.items, written.left_out), (1, 1));
    assert_eq!(page.matches("<article ").count(), 1);
    assert!(page.contains("shows 1 of 2 paths") && page.contains("left out: 1 path."), "{page}");
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
    let run = run_of(&wild, &good());
    let (page, _) = page_of(run.path(), 100);
    assert!(page.contains("The positions of this path cannot be drawn as a map."));
    assert!(page.contains("Pass the mirror and turn right. Stop at the lamp."));
    // As after somebody changed the text by hand.
    for (span, frame) in [([usize::MAX, 0], 0), ([0, 4], usize::MAX), ([0, 999], 0)] {
        let mut bad = good();
        bad.mentions = vec![TextMention { span, kind: MentionKind::Room, frame }];
        bad.findings = vec![CheckFinding { span: Some(span), ..finding(CheckKind::Turns, Verdict::Fail, "wrong") }];
        let run = run_of(&wild, &bad);
        assert!(page_of(run.path(), 100).0.contains(" the mirror and turn right. Stop at the lamp."));
    }
}

#[test]
fn a_text_that_fails_when_it_is_checked_again_comes_first_with_the_reason() {
    let run = long_run(4, &[3], &[]);
    let checked = CheckedText {
        path: "item-2".into(),
        name: "a".into(),
        text: String::new(),
        verdict: Verdict::Fail,
        world: "closed",
        findings: vec![CheckFinding {
            span: Some([9, 15]),
            ..finding(CheckKind::Landmarks, Verdict::Fail, "no frame of the path shows \"mirror\"")
        }],
        route: None,
        turn_gain: None,
        ambiguity: None,
        parts: Vec::new(),
        coverage_of_walk: Vec::new(),
        doubted: None,
        style: None,
    };
    let again = CheckedAgain {
        texts: BTreeMap::from([(3, checked)]),
        checked_against: vec!["labels".into()],
        changed: BTreeSet::new(),
    };
    let out = run.path().join(file::REPORT);
    let written = write_report_as(run.path(), &out, &ReportOptions { again, ..options(100) }).unwrap();
    assert_eq!(written.wrong, 1);
    assert!(written.to_string().ends_with("; 1 text of the dataset fails a check"), "{written}");
    let page = fs::read_to_string(out).unwrap();
    let row = page.split("<li class=\"row ").nth(1).unwrap();
    for told in [
        "wrong\" data-kinds=\"wrong look\"",
        "✗ fails a check now",
        "item-2",
        "no frame of the path shows &quot;mirror&quot;",
    ] {
        assert!(row.contains(told), "{told}: {row}");
    }
    assert!(row.contains("<span class=\"flaw\">mirror</span>"), "{row}");
    assert!(page.contains("texts checked again against labels") && page.contains("It passed when it was written"));
}

#[test]
fn a_run_that_is_not_finished_says_so() {
    let run = long_run(4, &[], &[]);
    let asked = AskedSettings { walks: Walks { paths: Some(9), ..Walks::default() }, ..AskedSettings::default() };
    let config = |asked: AskedSettings| toml::to_string(&asked.resolve().unwrap()).unwrap();
    fs::write(run.path().join(file::CONFIG), config(asked)).unwrap();
    let (page, _) = page_of(run.path(), 100);
    assert!(page.contains("<title>Wayword: 4 of 9 paths so far, house</title>"), "{page}");
    assert!(page.contains("<h1>Wayword report: 4 of 9 paths so far") && page.contains("The run is not finished."));
    let asked = AskedSettings { walks: Walks { paths: Some(4), ..Walks::default() }, ..AskedSettings::default() };
    fs::write(run.path().join(file::CONFIG), config(asked)).unwrap();
    let (page, _) = page_of(run.path(), 100);
    assert!(page.contains("<title>Wayword: 4 paths, house</title>") && !page.contains("so far"));
}

#[test]
fn a_folder_that_is_no_run_is_refused_and_the_old_page_stays() {
    let run = run_of(&walk("a"), &good());
    let before = page_of(run.path(), 100);
    fs::write(run.path().join(file::WALKS), "nonsense\n").unwrap();
    let out = run.path().join(file::REPORT);
    assert!(write_report(run.path(), &out, 100).unwrap_err().to_string().contains("walks.jsonl: line 1"));
    assert_eq!(without_script(&fs::read_to_string(&out).unwrap()), before.0);
    assert!(write_report(&run.path().join("nothing"), &out, 100).is_err());
}

/// A run of `items` items that pass, but those with these numbers are rejected or unverified.
fn long_run(items: usize, rejected: &[usize], unverified: &[usize]) -> tempfile::TempDir {
    let run = run_of(&walk("a"), &good());
    let ids: Vec<String> = (0..items).map(|number| format!("item-{number}")).collect();
    let (mut walks, mut accepted, mut refused) = (String::new(), String::new(), String::new());
    for (number, id) in ids.iter().enumerate() {
        let mut walk = walk(id);
        walk.path.scene = SceneId::new(format!("scene-{}", number % 3)).unwrap();
        walks.push_str(&line(&walk));
        let mut text = good();
        text.text = format!("{} It is number {number}.", text.text);
        if rejected.contains(&number) {
            let reason = "turns: the path turns right there".to_owned();
            refused.push_str(&line(&RejectedText {
                item: id.clone(),
                style: "r2r".into(),
                reason,
                last: Some(text),
                number: 0,
                drafts: Vec::new(),
                cost: None,
            }));
            continue;
        }
        if unverified.contains(&number) {
            text.verdict = Verdict::Unverified;
        }
        accepted.push_str(&line(&InstructionRecord::new("house", walk.path, text)));
    }
    fs::write(run.path().join(file::WALKS), walks).unwrap();
    fs::write(run.path().join(file::INSTRUCTIONS), accepted).unwrap();
    fs::write(run.path().join(file::REJECTED), refused).unwrap();
    run
}

/// The pages of a report by their names, and the overview's name.
fn pages_of(run: &Path, most_items: usize, per_page: usize) -> (BTreeMap<String, String>, WrittenReport) {
    let written = write_paged(run, &run.join(file::REPORT), &options(most_items), per_page).unwrap();
    let name = |page: &String| Path::new(page).file_name().unwrap().to_str().unwrap().to_owned();
    let all = std::iter::once(&written.page).chain(&written.pages);
    (all.map(|page| (name(page), without_script(&fs::read_to_string(page).unwrap()))).collect(), written)
}

/// The text after each opening, up to the end of the line.
fn after<'a>(page: &'a str, opening: &str) -> Vec<&'a str> {
    page.split(opening).skip(1).filter_map(|rest| rest.lines().next()).collect()
}

#[test]
fn rejected_and_unverified_texts_come_first_however_late_they_are_in_the_run() {
    let run = long_run(30, &[28], &[17, 29]);
    let (page, written) = page_of(run.path(), 5);
    assert_eq!((written.items, written.left_out), (5, 25));
    let titles: Vec<&str> = page.split("<article ").skip(1).map(|item| after(item, "</a> <bdi>")[0]).collect();
    let expected = ["item-28", "item-17", "item-29", "item-0", "item-1"].map(|id| format!("{id}</bdi></h2>"));
    assert_eq!(titles, expected);
}

#[test]
fn the_list_shows_text_scene_and_verdict_of_every_item_and_can_be_filtered() {
    let run = long_run(6, &[4], &[3]);
    let (page, _) = page_of(run.path(), 100);
    let rows: Vec<&str> = page.split("<li class=\"row ").skip(1).collect();
    let states: Vec<&str> = rows.iter().map(|row| row.split([' ', '"']).next().unwrap()).collect();
    assert_eq!(states, ["rejected", "unverified", "passed", "passed", "passed", "passed"]);
    for (row, told) in rows.iter().zip([
        ["✗ rejected", "href=\"#w1\"", "scene-1</bdi>", "number 4.", "turns: the path turns right there"],
        ["? unverified", "href=\"#w2\"", "scene-0</bdi>", "number 3.", "r2r"],
        ["✓ passed", "href=\"#w3\"", "scene-0</bdi>", "number 0.", "r2r"],
    ]) {
        assert!(told.iter().all(|told| row.contains(told)), "{row}");
    }
    // The script hides the rows that have not what the reader asks for.
    for told in [
        "data-show=\"rejected\" class=\"rejected\"><b>1</b> rejected",
        "data-show=\"look\" class=\"look\"><b>2</b> need a look",
        "<option value=\"2\">scene-2</option>",
        "data-kinds=\"rejected look\" data-scene=\"1\" data-place=\"4\"",
    ] {
        assert!(page.contains(told), "{told}");
    }
    assert!(!page.contains("by-style"), "one style is no choice");
}

#[test]
fn list_shows_failed_items_with_their_reasons() {
    let run = long_run(2, &[], &[]);
    let lines = [
        "{\"item\":\"old\",\"style\":\"\",\"reason\":\"the model gave nothing\"}\n",
        "{\"item\":\"new\",\"failure\":\"lost\",\"reason\":\"the simulator died\",\"more\":1}\n",
    ];
    fs::write(run.path().join(file::ERRORS), lines.concat()).unwrap();
    let (page, _) = page_of(run.path(), 100);
    let rows: Vec<&str> = page.split("<li class=\"row ").skip(1).collect();
    assert_eq!(rows.len(), 4);
    assert!(rows[0].starts_with("failed") && rows[0].contains("the model gave nothing"), "{}", rows[0]);
    assert!(rows[1].contains("new") && rows[1].contains("lost: the simulator died"), "{}", rows[1]);
    assert!(page.contains("<b>2</b> failed"));
}

#[test]
fn many_walks_are_split_into_pages_whose_links_all_lead_somewhere() {
    let run = long_run(7, &[6], &[]);
    let (pages, written) = pages_of(run.path(), 100, 3);
    assert_eq!(pages.keys().collect::<Vec<_>>(), ["report-1.html", "report-2.html", "report-3.html", "report.html"]);
    assert_eq!((written.items, written.pages.len()), (7, 3));
    let walks = |name: &str| pages[name].matches("<article ").count();
    assert_eq!(["report.html", "report-1.html", "report-2.html", "report-3.html"].map(walks), [0, 3, 3, 1]);
    assert!(pages["report-1.html"].contains("item-6"), "the rejected one is on the first page");
    assert!(pages["report.html"].contains("href=\"report-3.html#w7\""));
    for (name, page) in &pages {
        for link in values(page, "href") {
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let target = &pages[if file.is_empty() { name } else { file }];
            assert!(place.is_empty() || values(target, "id").contains(&place), "{name}: {link} leads nowhere");
        }
        let places = values(page, "id");
        assert_eq!(places.iter().collect::<BTreeSet<_>>().len(), places.len(), "{name}: two places of one name");
    }
    // A shorter report removes the longer one's pages, and leaves no temporary files.
    let (pages, _) = pages_of(run.path(), 2, 3);
    assert_eq!(pages.len(), 1);
    let left = fs::read_dir(run.path()).unwrap().filter_map(|entry| entry.unwrap().file_name().into_string().ok());
    let left: Vec<String> = left.filter(|name| name.contains("report")).collect();
    assert_eq!(left, ["report.html"]);
}

#[test]
fn pages_of_another_run_are_neither_replaced_nor_removed() {
    let (one, other) = (long_run(7, &[], &[]), long_run(7, &[], &[]));
    let out = one.path().join("page.html");
    let first = one.path().join("page-1.html");
    write_paged(one.path(), &out, &options(100), 3).unwrap();
    let before = [&out, &first].map(|file| fs::read(file).unwrap());
    let refused = write_paged(other.path(), &out, &options(100), 3).unwrap_err().to_string();
    assert!(refused.contains("page-1.html") && refused.contains("--out"), "{refused}");
    assert_eq!([&out, &first].map(|file| fs::read(file).unwrap()), before);
    // A report of one page needs no numbered pages, and removes none.
    write_paged(other.path(), &out, &options(2), 3).unwrap();
    assert_eq!(fs::read(&first).unwrap(), before[1]);
    // Pages of the same run are replaced.
    write_paged(one.path(), &out, &options(100), 3).unwrap();
}

#[test]
fn frames_are_counted_from_0_as_on_the_terminal() {
    let run = run_of(&walk("a"), &good());
    let (page, _) = page_of(run.path(), 100);
    let (_, page) = page.split_once("<article id=\"w2\"").unwrap();
    assert_eq!(after(page, "<li class=\"frame\" id=\"").len(), 3);
    for told in ["id=\"w2-f0\"", "class=\"badge\" href=\"#w2-f0\"", "aria-label=\"Frame 0\"", "from frame 0 to frame 2"]
    {
        assert!(page.contains(told), "{told}");
    }
    assert!(!page.contains("w2-f3") && page.contains("title=\"landmark, frame 1\""));
}

#[test]
fn print_is_bounded() {
    let run = long_run(120, &[], &[]);
    let (pages, _) = pages_of(run.path(), 1000, 50);
    let overview = &pages["report.html"];
    assert!(overview.contains(".row:nth-child(n + 101) { display: none; }"), "the sheet has the number");
    assert!(overview.contains("The first 100 of 120 texts are printed."));
    assert!(pages.iter().all(|(_, page)| page.matches("<article ").count() <= 50));
}
