use super::*;
use crate::ResamplingOptions;

const DRAWING: ResamplingOptions = ResamplingOptions { resamples: 200, level: 0.95, seed: 3 };

fn texts(said: &[&str]) -> Vec<NumberedText> {
    let mut vocabulary = CaptionVocabulary::default();
    said.iter().map(|text| vocabulary.number_text(&ptb_tokens(text))).collect()
}

#[test]
fn white_space_is_collapsed() {
    assert_eq!(collapse_white_space(" a\n\tb\u{a0}\u{1f}c "), "a b c");
}

#[test]
fn a_text_that_is_a_reference_has_the_highest_scores() {
    let texts = texts(&["go up the long stairs", "walk past every open door", "wait by the tall green plant"]);
    let rows: Vec<CaptionRow<'_>> = texts.iter().map(|text| CaptionRow { text, references: vec![text] }).collect();
    for score in score_rows(&rows) {
        assert!((score.counts.bleu_scores()[3] - 1.0).abs() < 1e-6, "{score:?}");
        assert!((score.rouge_l - 1.0).abs() < 1e-12 && (score.cider_d - 10.0).abs() < 1e-9, "{score:?}");
    }
}

#[test]
fn texts_without_tokens_have_scores_too() {
    let texts = texts(&["", "go up", "?"]);
    let rows = [
        CaptionRow { text: &texts[0], references: vec![&texts[1]] },
        CaptionRow { text: &texts[1], references: vec![&texts[2], &texts[0]] },
        CaptionRow { text: &texts[0], references: vec![&texts[2]] },
    ];
    let found = score_rows(&rows);
    assert!(found.iter().all(|score| score.counts.bleu_scores().iter().all(|bleu| bleu.is_finite())));
    // The reference takes two empty lines for the same word.
    assert_eq!([found[0].rouge_l, found[1].rouge_l, found[2].rouge_l], [0.0, 0.0, 1.0]);
    assert!(score_rows(&[]).is_empty());
}

fn described<'a>(ids: &'a [String], texts: &'a [Vec<NumberedText>]) -> Vec<CaptionItem<'a>> {
    let item = |(id, texts): (&'a String, &'a Vec<NumberedText>)| CaptionItem {
        id,
        cluster: id,
        text: &texts[0],
        references: texts[1..].iter().collect(),
    };
    ids.iter().zip(texts).map(item).collect()
}

#[test]
fn anchors_are_over_the_same_references() {
    let ids: Vec<String> = (0..20).map(|n| format!("item {n}")).collect();
    let mut vocabulary = CaptionVocabulary::default();
    let mut text = |said: String| vocabulary.number_text(&ptb_tokens(&said));
    let mut of = |n: usize| {
        // The judged text equals the second person's; the first person's text is half of it.
        let said = format!("walk{n} past door{n} up stairs{n} to sofa{n} then");
        vec![text(said.clone()), text(format!("walk{n} past door{n} and stop there")), text(said)]
    };
    let texts: Vec<Vec<NumberedText>> = (0..20).map(&mut of).collect();
    let found = anchored_caption_figures(&CaptionRowSets::from_items(&described(&ids, &texts), DRAWING.seed), &DRAWING);
    let [rest, person, other] = [&found.rest, &found.person, &found.other_path].map(|of| of.as_ref().unwrap());
    let [rest_cider, person_cider, other_cider] =
        [&rest, &person, &other].map(|figures| figures.cider_d.as_ref().unwrap().mean);
    assert!(rest_cider > 9.9 && person_cider < rest_cider);
    assert!(other_cider < person_cider && other.bleu[0].mean < person.bleu[0].mean);
    assert!(person.bleu[3].low <= person.bleu[3].mean && person.bleu[3].mean <= person.bleu[3].high);
    assert_eq!((person.rouge_l.values, person.rouge_l.clusters, found.single), (20, 20, 0));
    assert_eq!(
        found,
        anchored_caption_figures(&CaptionRowSets::from_items(&described(&ids, &texts), DRAWING.seed), &DRAWING)
    );
}

#[test]
fn anchored_is_none_without_texts_or_other_paths() {
    let ids = ["a".to_owned()];
    let alone = vec![texts(&["go up", "go down"])];
    let found = anchored_caption_figures(&CaptionRowSets::from_items(&described(&ids, &alone), DRAWING.seed), &DRAWING);
    assert!(found.all.is_some() && found.rest.is_none() && found.person.is_none() && found.other_path.is_none());
    assert_eq!(found.single, 1);
    let several = vec![texts(&["go up", "go down", "go on"])];
    assert!(
        anchored_caption_figures(&CaptionRowSets::from_items(&described(&ids, &several), DRAWING.seed), &DRAWING)
            .other_path
            .is_none()
    );
    assert!(anchored_caption_figures(&CaptionRowSets::from_items(&[], DRAWING.seed), &DRAWING).all.is_none());
}
