//! Relations between verdicts: mirrors, synonyms and additions.

use crate::{findings, flat, verdict};
use wayword_checks::Evidence;
use wayword_core::{CheckFinding, CheckKind, Verdict};

const TEXTS: [&str; 10] = [
    "Walk past the sofa and turn right into the bedroom.",
    "Walk past the sofa and turn left into the bedroom.",
    "Turn right. Turn right.",
    "Walk past the sofa on your right.",
    "Walk past the sofa on your left.",
    "Walk past the lamp. Walk past the sofa.",
    "Turn around at the lamp.",
    "Walk past the piano and turn right.",
    "Turn right at the lamp and stop by the bed.",
    "Turn right at the plant and stop by the bed.",
];

/// The same path in a mirror: all turns and directions change sides.
fn mirrored(mut path: Evidence) -> Evidence {
    path.moves.iter_mut().for_each(|step| step.turn_rad = -step.turn_rad);
    for thing in path.frames.iter_mut().flat_map(|frame| &mut frame.things) {
        thing.turn_rad = thing.turn_rad.map(|rad| -rad);
    }
    path
}

fn mirrored_words(text: &str) -> String {
    text.replace("left", "\u{1}").replace("right", "left").replace('\u{1}', "right")
}

fn verdicts(found: &[CheckFinding]) -> Vec<(CheckKind, Verdict)> {
    found.iter().map(|finding| (finding.check, finding.verdict)).collect()
}

#[test]
fn a_mirrored_path_gives_mirrored_words_the_same_verdicts() {
    for text in TEXTS {
        let there = findings(text, &flat());
        let back = findings(&mirrored_words(text), &mirrored(flat()));
        assert_eq!(verdicts(&there), verdicts(&back), "{text}");
    }
    assert_eq!(verdict(TEXTS[0], &mirrored(flat())), Verdict::Fail, "a mirror is not the same path");
}

#[test]
fn synonyms_of_the_lexicon_get_the_same_verdicts() {
    for text in TEXTS {
        for (word, other) in [("sofa", "couch"), ("lamp", "desk lamp"), ("bedroom", "master bedroom"), ("past", "by")] {
            let changed = text.replace(word, other);
            let (before, after) = (findings(text, &flat()), findings(&changed, &flat()));
            assert_eq!(verdicts(&before), verdicts(&after), "{changed}");
        }
    }
}

#[test]
fn a_sentence_about_something_else_changes_no_other_finding() {
    for text in TEXTS {
        let before = findings(text, &flat());
        let after = findings(&format!("{text} The ceiling is high."), &flat());
        let of = |found: &[CheckFinding]| {
            let of_way = [CheckKind::Landmarks, CheckKind::Order, CheckKind::Turns, CheckKind::Floors];
            found.iter().filter(|finding| of_way.contains(&finding.check)).cloned().collect::<Vec<_>>()
        };
        assert_eq!(of(&before), of(&after), "{text}");
    }
}

#[test]
fn more_evidence_of_other_things_changes_no_passing_text() {
    for text in TEXTS {
        let mut more = flat();
        for frame in &mut more.frames {
            frame.things.push(wayword_checks::SeenThing { name: "chandelier".into(), ..Default::default() });
        }
        assert_eq!(verdicts(&findings(text, &flat())), verdicts(&findings(text, &more)), "{text}");
    }
}

#[test]
fn capitals_and_spaces_change_no_verdict() {
    for text in TEXTS {
        let shouted = text.to_uppercase();
        let spaced = text.replace(' ', "  ");
        let wanted = verdicts(&findings(text, &flat()));
        assert_eq!(verdicts(&findings(&shouted, &flat())), wanted, "{shouted}");
        assert_eq!(verdicts(&findings(&spaced, &flat())), wanted, "{spaced}");
    }
}
