use super::super::{PlanQuestion, StudyOutlook};
use super::fixtures::small;
use crate::{EndQuestion, EndQuestionKind, ExclusionRules, PageTexts, Study, StudyTask};

#[test]
fn the_sheet_says_what_the_program_will_do() {
    let mut data = small(StudyTask::Rate);
    data.settings.exclusions =
        ExclusionRules { min_seconds_per_item: 5.0, min_share_of_film: 0.8, ..ExclusionRules::default() };
    data.settings.ethics = "Board *7*, 12/2026".to_owned();
    data.settings.end = vec![EndQuestion {
        name: "age".to_owned(),
        text: "How old are you?".to_owned(),
        kind: EndQuestionKind::Choice,
        answers: vec!["under 30".to_owned(), "30 or more".to_owned()],
        optional: true,
        max_chars: 0,
    }];
    let outlook = StudyOutlook::new(&data.plan, &data.settings, &data.items, &PlanQuestion::default());
    let folder = tempfile::tempdir().unwrap();
    let study = Study {
        folder: folder.path().to_owned(),
        plan: data.plan,
        settings: data.settings,
        texts: PageTexts::default(),
        items: data.items,
        routes: data.routes,
        scenes: data.scenes,
    };
    let file = folder.path().join("sheet.md");
    study.write_preregistration(&outlook, &file).unwrap();
    let sheet = std::fs::read_to_string(&file).unwrap();
    for said in [
        "`accurate_high` of humans is higher",
        "| wrong | other-path (control) |",
        "`too_fast` leaves out an answer: answered in less than 5 seconds",
        "less than 80 % of the pictures",
        "`everybody`, `finished` and `kept`",
        "Board \\*7\\*",
        "`age`: How old are you? (under 30; 30 or more)",
        "Power for 20 points",
        "fails 2 or more of 2 checks",
    ] {
        assert!(sheet.contains(said), "{said}: {sheet}");
    }
    assert!(!sheet.contains("NaN"));
    assert!(study.write_preregistration(&outlook, &file).is_err(), "an existing file is kept");
}
