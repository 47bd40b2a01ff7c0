use super::super::StudyOutlook;
use super::fixtures::{add_item, add_route, empty, small};
use crate::{ConditionKind, StudyData, StudyTask};

fn of(data: &StudyData) -> StudyOutlook {
    StudyOutlook::new(&data.plan, &data.settings, &data.items)
}

/// 30 people with one item each in each of two groups detect about 35 points.
#[test]
fn thirty_people_in_each_group_detect_about_35_points() {
    let mut data = empty(StudyTask::Rate, &[("ours", ConditionKind::Run), ("theirs", ConditionKind::Run)]);
    for _ in 0..30 {
        let route = add_route(&mut data);
        add_item(&mut data, route, &[0]);
        add_item(&mut data, route, &[1]);
    }
    (data.plan.per_item, data.plan.per_participant) = (1, 1);
    let outlook = of(&data);
    assert_eq!([outlook.items, outlook.routes, outlook.answers, outlook.participants], [60, 30, 60, 60]);
    let alike = &outlook.detectable[0];
    assert_eq!(alike.answers, Some(30.0));
    assert!((alike.difference.unwrap() - 0.35).abs() < 0.015, "{alike:?}");
    insta::assert_snapshot!(outlook);
}

#[test]
fn detectable_difference_shrinks_with_answers_and_grows_with_spread_only_between_groups() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let mut data = small(mode);
        let few = of(&data);
        data.plan.per_item *= 4;
        let many = of(&data);
        for (few, many) in few.detectable.iter().zip(&many.detectable) {
            let Some(few) = few.difference else { continue };
            assert!(many.difference.is_some_and(|many| many <= few + 1e-9), "{mode:?} {few} {many:?}");
        }
        assert_eq!(few.answers, 36);
        assert_eq!(few.participants, 6);
        let json = serde_json::to_value(&few).unwrap();
        assert_eq!(json["detectable"].as_array().unwrap().len(), 3);
    }
}

#[test]
fn outlook_of_an_empty_plan_prints_no_invalid_numbers() {
    let text = of(&empty(StudyTask::Follow, &[("ours", ConditionKind::Run)])).to_string();
    assert!(!text.contains("NaN") && text.contains("participants  0"), "{text}");
}
