use super::*;
use correlate::table_lines;
use figures::CriticFigures as Figures;
use serde_json::{Value, json};
use std::{fs, sync::Arc};
use wayword_core::{
    DVec3, Frame, Heading, Image, ModelError, PathMotion, PhraseGrounder, Pose, SceneId, View, ViewGaze,
};
use wayword_experiments::by_pictures::{CosineGrounder, PathPictures};
use wayword_run::pictures;

fn flags(folder: &Path) -> CriticsArgs {
    CriticsArgs {
        folder: folder.to_owned(),
        references: None,
        pictured: PictureCriticArgs::default(),
        finished: false,
        resamples: 50,
        seed: 0,
        json: false,
    }
}

fn quiet() -> CommandOutput {
    CommandOutput::new(false, true)
}

fn told(item: &str, scene: &str, text: &str) -> OutcomeText {
    OutcomeText {
        item: Some(item.to_owned()),
        path: format!("{scene}/{item}"),
        scene: scene.to_owned(),
        text: text.to_owned(),
    }
}

#[test]
fn correlate_separates_a_critic_of_success_from_an_independent_one() {
    let texts: Vec<OutcomeText> = (0..80).map(|at| told(&at.to_string(), &(at % 8).to_string(), "")).collect();
    // Every scene has as many texts of each kind.
    let success = |at: usize| f64::from(u8::from(at / 8 % 2 == 1));
    let outcomes = TextOutcomes {
        who: "reader".to_owned(),
        outcome: "success".to_owned(),
        text_means: (0..80).map(|at| (at, success(at))).collect(),
        answers: 80,
    };
    let found = |figure: &dyn Fn(usize) -> Option<f64>| {
        let critic = Figures { name: "any", figures: (0..80).map(figure).collect() };
        correlate_critic(&texts, &outcomes, &critic, &flags(Path::new("")))
    };
    let good = found(&|at| Some(success(at) + at as f64 / 1e6));
    assert!(good.spearman.unwrap()[0] > 0.8 && good.tau_b.unwrap()[1] > 0.6, "{good:?}");
    assert_eq!((good.texts, good.scenes), (80, 8));
    assert!(found(&|at| Some(f64::from(u8::from(at / 16 % 2 == 1)))).spearman.unwrap()[0].abs() < 1e-9);
    let constant = found(&|_| Some(0.5));
    assert_eq!(constant.tau_b, None);
    assert!(table_lines(&[constant])[1].contains("it never varies"));
    // A text that a critic cannot judge is in none of its figures.
    assert_eq!(found(&|at| (at % 8 != 0).then_some(at as f64)).texts, 70);
}

#[test]
fn references_are_other_peoples_texts_alone() {
    let texts = [told("1", "s", "Turn left at the sofa."), told("2", "s", "Turn left at the sofa.")];
    let said = ["Turn left at the sofa.".to_owned(), "Wait here.".to_owned()];
    let people = PeopleTexts { items: BTreeMap::from([("1".to_owned(), said.to_vec())]), ..PeopleTexts::default() };
    let [bleu, rouge, _] = figures::score_by_people(&texts, &people);
    assert!(rouge.figures[0].unwrap() < 0.5, "{rouge:?}");
    assert_eq!((bleu.figures[1], rouge.figures[1]), (None, None));
}

#[test]
fn agents_of_a_comparison_are_read_with_their_texts() {
    let folder = tempfile::tempdir().unwrap();
    let (mut followed, mut walks) = (String::new(), String::new());
    for at in 0..12 {
        let (item, scene) = (at.to_string(), format!("s{}", at % 3));
        // Longer texts arrive.
        let text = ["Go on.", "Go on past the sofa to the door and wait there."][at / 3 % 2];
        for agent in ["clip-nav", "reader"] {
            let walk = json!({ "agent": agent, "set": "ours", "item": item, "text_index": 0, "text": text });
            let came = json!({
                "agent": agent, "set": "ours", "scene": scene, "path": format!("{scene}/{item}"), "item": item,
                "text_index": 0, "success": at / 3 % 2,
            });
            walks += &format!("{walk}\n");
            followed += &format!("{came}\n");
        }
    }
    fs::write(folder.path().join("followed.jsonl"), followed).unwrap();
    fs::write(folder.path().join("walks.jsonl"), walks).unwrap();
    let found = find_correlations(&flags(folder.path()), &quiet()).unwrap();
    assert_eq!(
        found.iter().map(|one| (&*one.who, one.critic)).collect::<Vec<_>>(),
        [("clip-nav", "words"), ("reader", "words")]
    );
    assert!(found.iter().all(|one| one.texts == 12 && one.tau_b.unwrap()[0] > 0.999), "{found:?}");
}

/// The results of a study as `study results` writes them: for each of 12 routes in 3 scenes a text of a run, and one of another
/// path, answered by two people each. Long texts of the run lead to the goal.
fn results(mode: &str, measures: &[&str]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let scales: Vec<Value> = measures.iter().map(|name| json!({ "name": name })).collect();
    let (scales, walks) = if mode == "follow" { (&scales[3..], &measures[..3]) } else { (&scales[..], &[][..]) };
    assert!(walks.len() + scales.len() == measures.len());
    let about = json!({ "format": "wayword-study-results/1", "mode": mode, "scales": scales, "more": {} });
    fs::write(folder.path().join("results.json"), about.to_string()).unwrap();
    let mut items = "item,route,scene,text_number,condition,kind,text\r\n".to_owned();
    let mut answers = format!("participant,item,in_everybody,in_finished,condition,{}\r\n", measures.join(","));
    for route in 0..12 {
        let scene = format!("s{}", route % 3);
        let is_long = route / 3 % 2 == 1;
        // It begins like a formula, so it has an apostrophe in front; there is a comma and a mark in it.
        let run = if is_long { "\"'- Go on, past the \"\"big\"\" sofa to the door.\"" } else { "Go on." };
        for (of, (condition, kind, text)) in
            [("ours", "run", run), ("other-path", "other-path", "Up the stairs to the bed, and wait beside the lamp.")]
                .into_iter()
                .enumerate()
        {
            let item = 2 * route + of;
            items += &format!("{item},{scene}/{route},{scene},1,{condition},{kind},\"{}\"\r\n", text.trim_matches('"'));
            let value = i32::from(is_long && of == 0);
            // The second person failed the checks and gave the opposite; a third was screened out.
            for (person, value, everybody, finished) in [(1, value, 1, 1), (2, 1 - value, 1, 0), (3, 9, 0, 0)] {
                let values: Vec<String> = measures.iter().map(|_| value.to_string()).collect();
                answers += &format!("p{person},{item},{everybody},{finished},{condition},{}\r\n", values.join(","));
            }
        }
    }
    fs::write(folder.path().join("items.csv"), items).unwrap();
    fs::write(folder.path().join("answers.csv"), answers).unwrap();
    folder
}

const FOLLOW: [&str; 6] = ["success", "spl", "ndtw", "easy", "confident", "demanding"];
const RATE: [&str; 4] = ["similar", "accurate", "ghosts", "reachable"];

#[test]
fn people_who_follow_are_correlated_with_and_without_texts_of_other_paths() {
    let folder = results("follow", &FOLLOW);
    let mut flags = CriticsArgs { finished: true, ..flags(folder.path()) };
    let found = |flags: &CriticsArgs| find_correlations(flags, &quiet()).unwrap();
    let all = found(&flags);
    assert_eq!(all.len(), 2 * FOLLOW.len(), "one critic, and two groups for each measure");
    let of = |all: &[CriticCorrelation], who: &str| {
        all.iter().find(|one| one.who == who && one.outcome == "success").cloned().unwrap()
    };
    let (with, without) = (of(&all, "people"), of(&all, "people, own path"));
    assert_eq!((with.texts, with.answers, with.scenes), (24, 24, 3));
    assert_eq!((without.texts, without.answers), (12, 12));
    // Among the texts of their own paths the long ones lead to the goal; the wrong ones are long, too.
    assert!(without.tau_b.unwrap()[0] > 0.999 && with.tau_b.unwrap()[0] < 0.5, "{with:?} {without:?}");
    // With the second person, every text has half.
    flags.finished = false;
    let everybody = found(&flags);
    assert_eq!((of(&everybody, "people").answers, of(&everybody, "people").tau_b), (48, None));
}

#[test]
fn people_who_rate_are_correlated_by_each_question() {
    let folder = results("rate", &RATE);
    let people: Vec<Value> = (0..12)
        .map(|route| {
            json!({
                "scan": format!("s{}", route % 3), "path_id": route, "path": ["a", "b"], "heading": 0.0, "distance": 1.0,
                "instructions": ["- Go on, past the \"big\" sofa to the door.", "Go on past the big sofa to that door."],
            })
        })
        .collect();
    let file = folder.path().join("R2R.json");
    fs::write(&file, Value::from(people).to_string()).unwrap();
    let flags = CriticsArgs { references: Some(file.clone()), finished: true, ..flags(folder.path()) };
    let found = find_correlations(&flags, &quiet()).unwrap();
    let outcomes: Vec<&str> = found.iter().step_by(8).map(|one| &*one.outcome).collect();
    assert_eq!(outcomes, RATE);
    let critics: Vec<&str> = found.iter().take(4).map(|one| one.critic).collect();
    assert_eq!(critics, ["words", "BLEU-4", "ROUGE-L", "CIDEr-D"]);
    let rouge = found.iter().find(|one| one.critic == "ROUGE-L" && one.outcome == "accurate").unwrap();
    assert!(rouge.texts == 24 && rouge.spearman.unwrap()[0] > 0.7, "{rouge:?}");
    let elsewhere = fs::read_to_string(&file).unwrap().replace(":\"s", ":\"t");
    fs::write(&file, elsewhere).unwrap();
    let refused = super::find_correlations(&flags, &quiet()).unwrap_err().to_string();
    assert!(refused.contains("R2R.json") && refused.contains("hint:"), "{refused}");
}

#[test]
fn folders_without_outcomes_are_refused_with_advice() {
    let empty = tempfile::tempdir().unwrap();
    let refused = |folder: &Path| find_correlations(&flags(folder), &quiet()).unwrap_err().to_string();
    assert!(refused(empty.path()).contains("wayword compare"));
    for name in ["plan.json", "items.jsonl"] {
        fs::write(empty.path().join(name), "{}").unwrap();
    }
    assert!(refused(empty.path()).contains("wayword study results STUDY"));
    assert!(refused(results("pair", &[]).path()).contains("chose between two texts"));
    let other = results("rate", &RATE);
    let change = |name: &str, from: &str, to: &str| {
        let file = other.path().join(name);
        let text = fs::read_to_string(&file).unwrap();
        assert!(text.contains(from));
        fs::write(&file, text.replace(from, to)).unwrap();
        let told = refused(other.path());
        fs::write(&file, text).unwrap();
        told
    };
    assert!(change("results.json", "results/1", "results/2").contains("results/2"));
    assert!(change("answers.csv", "in_everybody", "in_nobody").contains("it has no column in_everybody"));
    assert!(change("answers.csv", ",1,1,ours,0", ",1,1,ours,none").contains("row 2: similar: \"none\" is no number"));
    let head = format!("participant,item,in_everybody,in_finished,condition,{}\r\n", RATE.join(","));
    fs::write(other.path().join("answers.csv"), head).unwrap();
    assert!(refused(other.path()).contains("no answer that counts"));
}

/// A picture model that gives a picture's redness to texts about red.
struct Red;

impl PhraseGrounder for Red {
    fn name(&self) -> &str {
        "red"
    }

    fn score_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<f32>, ModelError>> {
        let red = |view: &&View| f32::from(view.image.as_ref().unwrap().rgb_bytes()[0]) / 255.0;
        let of = |view: &&View| {
            let red = red(view);
            Ok(phrases.iter().map(|phrase| if phrase.contains("red") { red } else { -0.5 }).collect())
        };
        views.iter().map(of).collect()
    }
}

impl CosineGrounder for Red {
    fn reads_whole_phrase(&self, _: &str) -> Result<bool, ModelError> {
        Ok(true)
    }
}

#[test]
fn score_by_pictures_finds_the_pictures_of_a_run_by_item_or_path() {
    let run = tempfile::tempdir().unwrap();
    let frame = Frame { pose: Pose::looking_level(DVec3::ZERO, Heading::NORTH), viewpoint: None, level: None };
    let path = wayword_core::Path {
        id: "7_3".to_owned(),
        scene: SceneId::new("s").unwrap(),
        frames: vec![frame.clone(), frame.clone()],
        motion: PathMotion::Known,
        target: None,
    };
    let flat = |red| {
        let image = Image::new(16, 16, [red, 0, 0].repeat(256)).unwrap();
        View::new(frame.pose, ViewGaze::quarter_view(Heading::NORTH).horizontal_fov_rad, Some(Arc::new(image)), None)
    };
    let encoded = pictures::encode_pictures(&[flat(51), flat(102)]).unwrap();
    pictures::write_pictures(&run.path().join("frames"), &path.id, &encoded).unwrap();
    let walk = json!({ "path": path, "has_pictures": true });
    fs::write(run.path().join("walks.jsonl"), format!("{walk}\n")).unwrap();
    let written = json!({ "path": { "id": "7_3", "scene": "s" }, "path_id": "7" });
    fs::write(run.path().join("instructions.jsonl"), format!("{written}\n")).unwrap();

    let critic = PictureCritic::new(Box::new(Red), PathPictures::from_run(run.path()).unwrap());
    let text = "Pass the red door. Stop.";
    let of_path = OutcomeText { item: None, path: "s/7".to_owned(), ..told("", "s", text) };
    let texts = [told("7_3", "s", text), of_path, told("8", "s", text)];
    let [parts, whole] = figures::score_by_pictures(&texts, &critic, &quiet()).unwrap();
    let near = |figure: Option<f64>, expected: f64| (figure.unwrap() - expected).abs() < 0.02;
    // Of two sentences one is seen, best in the second picture: 102 of 255 is 0.4.
    assert!(near(parts.figures[0], 2.5 * 0.4 / 2.0) && near(whole.figures[0], 2.5 * 0.3), "{parts:?} {whole:?}");
    assert_eq!(parts.figures[0], parts.figures[1]);
    assert_eq!(parts.figures[2], None);
    let none = figures::score_by_pictures(&texts[2..], &critic, &quiet()).unwrap_err().to_string();
    assert!(none.contains("no picture of any path"), "{none}");
}

#[test]
fn missing_pictures_and_missing_models_are_reported() {
    let folder = results("rate", &RATE);
    let mut flags = flags(folder.path());
    flags.pictured.clip = Some("hf/org/clip".to_owned());
    let refused = |flags: &CriticsArgs| find_correlations(flags, &quiet()).unwrap_err().to_string();
    assert!(refused(&flags).contains("--pictures"));
    flags.pictured.pictures = Some(folder.path().to_owned());
    assert!(refused(&flags).contains("there is no run in it"));
}
