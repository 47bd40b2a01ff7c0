use super::*;
use crate::{
    made_buildings::{add_thing, bare_step, make_corridor, make_guide, make_mention},
    nearness::UNKNOWN_CLASS,
};
use wayword_core::ClimbDirection;
use wayword_language::reading::steps::StepMention;

#[test]
fn for_step_takes_the_most_important_content() {
    use GuideStepKind::{Climb, Condition, Cross, Go, Other, SlightTurn, Stop, Straight, Turn, TurnAround};
    let kind = |change: &dyn Fn(&mut InstructionStep)| {
        let mut told = bare_step(GuideStepKind::Task).step;
        change(&mut told);
        GuideStepKind::for_step(&told)
    };
    let place = |relation| vec![StepMention { event: 0, relation }];
    assert_eq!(kind(&|_| {}), Other);
    for relation in StepRelation::ALL {
        let crosses = [StepRelation::OutOf, StepRelation::Into, StepRelation::Through].contains(&relation);
        assert_eq!(kind(&|told| told.places = place(relation)), if crosses { Cross } else { Go });
    }
    // Each of these comes before the last ones.
    type Change<'a> = &'a dyn Fn(&mut InstructionStep);
    let changes: [(Change<'_>, GuideStepKind); 7] = [
        (&|told| told.places = place(StepRelation::Into), Cross),
        (&|told| told.is_straight = true, Straight),
        (&|told| told.is_condition = true, Condition),
        (&|told| told.stops = true, Stop),
        (&|told| told.climb = Some(ClimbDirection::Up), Climb),
        (&|told| told.turn = Some(Side::Behind), TurnAround),
        (&|told| told.turn = Some(Side::Left), Turn),
    ];
    for (at, (_, expected)) in changes.iter().enumerate() {
        let all = |told: &mut InstructionStep| changes[..=at].iter().for_each(|(change, _)| change(told));
        assert_eq!(kind(&all), *expected);
        assert_eq!(kind(changes[at].0), *expected);
    }
    for side in [Side::Left, Side::Right] {
        let slight = |told: &mut InstructionStep| {
            told.turn = Some(side);
            told.is_slight = true;
        };
        assert_eq!(kind(&slight), SlightTurn);
        assert_eq!(kind(&|told| told.turn = Some(side)), Turn);
    }
}

#[test]
fn describes_way_needs_more_than_a_place_to_go_to() {
    type Change<'a> = &'a dyn Fn(&mut GuideStep);
    let tells = |change: Change<'_>| {
        let mut told = bare_step(GuideStepKind::Other);
        change(&mut told);
        told.describes_way()
    };
    assert!(!tells(&|_| {}));
    let changes: [Change<'_>; 5] = [
        &|told| told.step.turn = Some(Side::Left),
        &|told| told.step.climb = Some(ClimbDirection::Up),
        &|told| told.step.stops = true,
        &|told| told.step.is_straight = true,
        &|told| told.step.is_condition = true,
    ];
    assert!(changes.into_iter().all(tells));
    for relation in StepRelation::ALL {
        use StepRelation::{Along, OutOf, Past, Through};
        let is_way = [OutOf, Through, Past, Along].contains(&relation);
        assert_eq!(tells(&|told| told.mentions = vec![make_mention(relation, true, "attic")]), is_way);
    }
}

#[test]
fn read_text_marks_a_text_that_describes_no_way() {
    let goal = Guide::read_text("Go to the attic and dust the globe.");
    assert!(goal.is_goal);
    assert_eq!(goal.steps.iter().map(|told| told.kind).collect::<Vec<_>>(), [GuideStepKind::Goal, GuideStepKind::Task]);
    let way = Guide::read_text("Go to the attic, turn left and dust the globe.");
    assert!(!way.is_goal && way.steps.iter().all(|told| told.kind != GuideStepKind::Task));
    assert!(!Guide::read_text("").is_goal);
}

#[test]
fn read_text_finds_the_mentions_of_each_step() {
    let text = "Walk past the wooden table on your left. Turn right and go into the kitchen.";
    let guide = Guide::read_text(text);
    let mentions: Vec<_> = guide
        .steps
        .iter()
        .flat_map(|told| &told.mentions)
        .map(|at| (&text[at.span.unwrap()[0]..at.span.unwrap()[1]], at.relation, at.side))
        .collect();
    assert_eq!(mentions[0], ("table", StepRelation::Past, Some(Side::Left)));
    assert_eq!(mentions.last(), Some(&("kitchen", StepRelation::Into, None)));
    assert_eq!(
        guide.steps.last().unwrap().mentions[0].meanings,
        [PlaceQuery { is_room: true, name: "kitchen".into() }]
    );
    assert!(guide.names_room("kitchen") && guide.names_room("dining room") && !guide.names_room("garage"));
    assert_eq!(guide.count_turns(), 1);
    assert_eq!(Guide::read_text("Turn left, turn right, then turn around.").count_turns(), 3);
}

#[test]
fn read_text_implies_that_a_way_outside_leads_outdoors() {
    let guide = Guide::read_text("Turn left and go outside.");
    let mention = guide.steps.iter().flat_map(|told| &told.mentions).find(|mention| mention.span.is_none()).unwrap();
    assert_eq!((mention.relation, mention.side, mention.tells_turn), (StepRelation::Into, None, false));
    assert_eq!(mention.meanings, [PlaceQuery { is_room: true, name: "outdoor area".into() }]);
    assert!(guide.names_room("outdoor area"));
    assert!(!Guide::read_text("Turn left.").names_room("outdoor area"));
}

#[test]
fn named_places_number_the_mentions_within_their_steps() {
    let mut steps = vec![bare_step(GuideStepKind::Go); 3];
    steps[0].mentions = vec![make_mention(StepRelation::To, true, "attic"); 2];
    steps[2].mentions = vec![make_mention(StepRelation::To, true, "attic")];
    assert_eq!(make_guide(steps).named_places().collect::<Vec<_>>(), [(0, 0), (0, 1), (2, 0)]);
}

#[test]
fn leave_out_turn_leaves_the_rest_of_the_step() {
    let mut guide = Guide::read_text("Turn left into the kitchen.");
    assert_eq!(guide.steps[0].kind, GuideStepKind::Turn);
    guide.steps[0].leave_out_turn();
    assert_eq!((guide.steps[0].step.turn, guide.steps[0].kind), (None, GuideStepKind::Cross));
    assert_eq!(guide.steps[0].mentions.len(), 1);
}

#[test]
fn change_relation_changes_one_place_and_the_kind_of_the_step() {
    let mut guide = Guide::read_text("Walk past the sofa.");
    let told = &mut guide.steps[0];
    assert_eq!(told.kind, GuideStepKind::Go);
    told.change_relation(0, StepRelation::Into);
    assert_eq!((told.mentions[0].relation, told.step.places[0].relation), (StepRelation::Into, StepRelation::Into));
    assert_eq!(told.kind, GuideStepKind::Cross);
    told.change_relation(1, StepRelation::Past);
    assert_eq!(told.mentions[0].relation, StepRelation::Into);
}

#[test]
fn change_sides_changes_the_step_and_its_places() {
    let mut told = bare_step(GuideStepKind::Go);
    told.step.side = Some((StepRelation::To, Side::Left));
    told.mentions = vec![make_mention(StepRelation::To, false, "sofa"); 2];
    told.mentions[1].side = Some(Side::Left);
    told.change_sides(|_| Side::Right);
    assert_eq!(told.step.side, Some((StepRelation::To, Side::Right)));
    assert_eq!([told.mentions[0].side, told.mentions[1].side], [None, Some(Side::Right)]);
}

#[test]
fn name_meanings_include_the_last_word_of_a_thing() {
    let meanings = |name, is_room, is_thing| {
        let meanings = name_meanings(name, is_room, is_thing).into_iter();
        meanings.map(|what| (what.is_room, what.name)).collect::<Vec<_>>()
    };
    let named = |is_room, name: &str| (is_room, name.to_owned());
    assert_eq!(meanings("wooden table", false, true), [named(false, "wooden table"), named(false, "table")]);
    assert_eq!(meanings("living room", true, false), [named(true, "living room")]);
    assert_eq!(meanings("bar", true, true), [named(true, "bar"), named(false, "bar")]);
    assert_eq!(meanings("sofa", false, true), [named(false, "sofa")]);
}

/// Three steps: a turn at bytes 2 to 4 of a step from 0 to 10, a place at 14 to 16 of one from 12 to 20, and nothing.
fn three_steps() -> Guide {
    let mut steps = vec![bare_step(GuideStepKind::Go); 3];
    steps[0].step.span = [0, 10];
    steps[0].step.turn = Some(Side::Left);
    steps[0].step.turn_span = Some([2, 4]);
    steps[1].step.span = [12, 20];
    steps[1].mentions = vec![make_mention(StepRelation::To, false, "sofa")];
    steps[1].mentions[0].span = Some([14, 16]);
    steps[2].step.span = [22, 30];
    make_guide(steps)
}

#[test]
fn append_steps_moves_the_bytes_of_the_piece_alone() {
    let mut guide = three_steps();
    let mut piece = three_steps();
    piece.steps[1].mentions.push(make_mention(StepRelation::Into, true, "outdoor area"));
    guide.append_steps(piece, 40);
    let spans: Vec<_> = guide.steps.iter().map(|told| told.step.span).collect();
    assert_eq!(spans, [[0, 10], [12, 20], [22, 30], [40, 50], [52, 60], [62, 70]]);
    let turn_spans: Vec<_> = guide.steps.iter().map(|told| told.step.turn_span).collect();
    assert_eq!(turn_spans, [Some([2, 4]), None, None, Some([42, 44]), None, None]);
    let named: Vec<_> = guide.steps.iter().flat_map(|told| &told.mentions).map(|mention| mention.span).collect();
    assert_eq!(named, [Some([14, 16]), Some([54, 56]), None]);
    assert!(!guide.names_room("kitchen"));
    guide.append_steps(Guide::read_text("Walk into the kitchen."), 80);
    assert!(guide.names_room("kitchen"));
}

#[test]
fn into_way_takes_each_step_by_its_own_content() {
    let goal = Guide::read_text("Go to the attic and dust the globe.");
    let way = goal.clone().into_way();
    assert!(goal.is_goal && !way.is_goal);
    assert_eq!(way.len(), goal.len());
    assert!(way.steps.iter().all(|told| told.kind == GuideStepKind::for_step(&told.step)));
}

#[test]
fn has_step_without_needs_something_to_lose_and_a_step_that_stays() {
    let guide = three_steps();
    for (span, stands) in [
        ([2, 4], true),
        ([1, 5], true),
        ([3, 4], false),
        ([2, 3], false),
        ([14, 16], true),
        ([15, 16], false),
        ([14, 15], false),
        ([22, 30], true),
        ([23, 30], false),
        ([22, 29], false),
        ([0, 20], true),
        ([10, 12], false),
        ([0, 30], false),
        // Of the third step, only a part is left, but it never had a turn or a place.
        ([2, 23], false),
        ([2, 22], true),
    ] {
        assert_eq!(guide.has_step_without(span), stands, "{span:?}");
    }
}

#[test]
fn has_step_without_keeps_a_step_that_has_another_turn_or_place() {
    let mut guide = three_steps();
    guide.steps.truncate(1);
    assert!(!guide.has_step_without([2, 4]), "nothing is left of the only step");
    guide.steps[0].mentions = vec![make_mention(StepRelation::To, false, "sofa")];
    guide.steps[0].mentions[0].span = Some([6, 8]);
    assert!(guide.has_step_without([2, 4]) && guide.has_step_without([6, 8]));
    assert!(!guide.has_step_without([2, 8]));
    guide.steps[0].step.turn_span = None;
    guide.steps[0].step.turn = None;
    assert!(!guide.has_step_without([6, 8]));
    assert!(!Guide::read_text("").has_step_without([0, 9]));
}

#[test]
fn guide_trial_takes_the_first_meaning_that_the_building_has() {
    let mut building = make_corridor(&["bar", "attic", ""]);
    add_thing(&mut building, "table", [0.0, 0.0, 1.0], &[0]);
    let mut told = bare_step(GuideStepKind::Go);
    let meanings = |is_room, is_thing, name| {
        let mut mention = make_mention(StepRelation::To, is_room, name);
        mention.meanings = name_meanings(name, is_room, is_thing);
        mention
    };
    told.mentions = vec![
        meanings(true, true, "bar"),
        meanings(false, true, "wooden table"),
        meanings(false, true, "piano"),
        meanings(true, true, "garage"),
    ];
    told.mentions.push(make_mention(StepRelation::To, true, "sofa"));
    told.mentions[4].meanings.clear();
    let guide = make_guide(vec![told]);
    let places = |trial: &GuideTrial<'_>| {
        let of_place =
            |place: &LocatedMention<'_>| (place.mention.meanings[0].name.clone(), place.is_room, place.near.exists);
        trial.located[0].iter().map(of_place).collect::<Vec<_>>()
    };
    let trial = GuideTrial::new(&guide, &building);
    assert_eq!(places(&trial), [("bar".to_owned(), true, true), ("wooden table".to_owned(), false, true)]);
    building.viewpoints[2].is_known = false;
    building.forget_nearness();
    let trial = GuideTrial::new_partial(&guide, &building);
    assert_eq!(
        places(&trial),
        [
            ("bar".to_owned(), true, true),
            ("wooden table".to_owned(), false, true),
            ("piano".to_owned(), false, false),
            ("garage".to_owned(), true, false)
        ]
    );
    assert_eq!(trial.located[0][2].near.class[2], UNKNOWN_CLASS);
}

#[test]
fn guide_trial_notes_at_which_viewpoints_the_text_names_the_room() {
    let building = make_corridor(&["kitchen", "garage", ""]);
    let guide = Guide::read_text("Walk through the kitchen.");
    assert_eq!(GuideTrial::new(&guide, &building).is_room_named, [Some(true), Some(false), None]);
}
