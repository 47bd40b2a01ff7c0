//! Tests of the page and the counts of doubts.

use super::*;
use wayword_core::{DoubtAlternative, Verdict};

fn doubt(span: [usize; 2], grade: DoubtGrade, alternatives: &[Option<&str>]) -> TextDoubt {
    let alternative = |words: &Option<&str>| DoubtAlternative { words: words.map(str::to_owned), gain: None };
    let alternatives = alternatives.iter().map(alternative).collect();
    TextDoubt {
        span,
        grade,
        cause: DoubtCause::Change,
        reason: "the path may <b>not</b> turn here".into(),
        alternatives,
    }
}

fn highlights(text: &str, doubts: Vec<TextDoubt>) -> DoubtHighlights {
    let text = DoubtedText {
        path: "7_<img src=x>".into(),
        name: "7_<img src=x>".into(),
        style: Some("r2r".into()),
        text: text.into(),
        verdict: Verdict::Unverified,
        world: "open",
        unfollowed: None,
        doubts,
    };
    DoubtHighlights::from_report(CheckReport { doubted: vec![text], ..CheckReport::default() }, None)
}

/// The page of a few texts.
fn highlights_html(highlights: &DoubtHighlights) -> Result<String, CommandError> {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("doubts.html");
    write_page(&out, highlights)?;
    Ok(std::fs::read_to_string(out).unwrap().replace(&format!("<script>{}</script>", super::super::SCRIPT), ""))
}

#[test]
fn the_most_doubtful_texts_come_first_and_all_are_on_pages() {
    let text = |name: &str, doubts: Vec<TextDoubt>| {
        let mut texts = highlights(TEXT, doubts).texts;
        texts[0].name = name.into();
        texts.remove(0)
    };
    let doubted = vec![
        text("clean", Vec::new()),
        text("unsure", vec![doubt([12, 16], DoubtGrade::Uncertain, &[])]),
        text("wrong", vec![doubt([0, 9], DoubtGrade::Likely, &[Some("Turn right")])]),
    ];
    let all = DoubtHighlights::from_report(CheckReport { doubted, ..CheckReport::default() }, None);
    let order = |page: &str| {
        let mut places: Vec<(usize, &str)> = ["clean", "unsure", "wrong"]
            .into_iter()
            .filter_map(|id| Some((page.find(&format!("<bdi>{id}</bdi>"))?, id)))
            .collect();
        places.sort_unstable();
        places.into_iter().map(|(_, id)| id).collect::<Vec<_>>()
    };
    assert_eq!(order(&highlights_html(&all).unwrap()), ["wrong", "unsure", "clean"]);
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("doubts.html");
    write_paged(&out, &all, 2).unwrap();
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let (list, first, second) = (read("doubts.html"), read("doubts-1.html"), read("doubts-2.html"));
    assert_eq!(order(&list), ["wrong", "unsure", "clean"]);
    assert_eq!((order(&first), order(&second)), (vec!["wrong", "unsure"], vec!["clean"]));
    assert!(list.contains("href=\"doubts-2.html#w3\"") && second.contains("<article id=\"w3\""));
    // With fewer texts the numbered pages go.
    write_paged(&out, &all, 500).unwrap();
    assert!(!folder.path().join("doubts-1.html").exists() && !folder.path().join("doubts-2.html").exists());
}

const TEXT: &str = "Turn left & walk past the \u{201c}Türe\u{201d}.";

#[test]
fn words_are_marked_with_their_alternatives_below() {
    let doubts = vec![
        doubt([0, 9], DoubtGrade::Likely, &[Some("Turn right"), None]),
        doubt([12, 16], DoubtGrade::Uncertain, &[Some("<script>alert(1)</script>")]),
    ];
    let page = highlights_html(&highlights(TEXT, doubts)).unwrap();
    assert!(page.contains("<mark class=\"likely\" id=\"w1-1\">Turn left</mark>"), "{page}");
    assert!(page.contains("aria-label=\"doubt 1, likely wrong\""), "{page}");
    assert!(page.contains("<q><bdi>Turn right</bdi></q>") && page.contains("leave it out"), "{page}");
}

#[test]
fn html_escapes_texts_from_files() {
    let doubts = vec![doubt([12, 16], DoubtGrade::Uncertain, &[Some("<script>alert(1)</script>")])];
    let page = highlights_html(&highlights(TEXT, doubts)).unwrap();
    for raw in ["<script", "<img", "may <b>", "left & "] {
        assert!(!page.contains(raw), "{raw}");
    }
    assert!(page.contains("left &amp; "));
}

#[test]
fn texts_words_and_doubts_are_counted() {
    let doubts = vec![doubt([0, 9], DoubtGrade::Likely, &[]), doubt([24, 32], DoubtGrade::Uncertain, &[])];
    let DoubtHighlights { summary, .. } = highlights(TEXT, doubts);
    assert_eq!((summary.texts, summary.doubted, summary.unfollowed, summary.words), (1, 1, 0, 7));
    assert_eq!((summary.words_of_grade(DoubtGrade::Likely), summary.words_of_grade(DoubtGrade::Uncertain)), (2, 2));
    assert_eq!(summary.causes["change"], DoubtTally { texts: 1, doubts: 2, words: 4 });
}

#[test]
fn only_texts_of_the_style_are_taken() {
    let report = |style: &str| {
        let DoubtHighlights { texts, .. } = highlights(TEXT, Vec::new());
        DoubtHighlights::from_report(CheckReport { doubted: texts, ..CheckReport::default() }, Some(style))
    };
    assert_eq!((report("r2r").texts.len(), report("reverie").texts.len()), (1, 0));
}
