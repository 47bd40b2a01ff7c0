use super::*;
use crate::{
    guide::{GuideStep, GuideStepKind},
    made_buildings::{bare_step, make_corridor, make_guide, make_mention, random_weights},
};
use wayword_language::reading::steps::StepRelation;

fn kinds(guide: &Guide) -> Vec<(StepChangeKind, usize)> {
    single_changes(guide).into_iter().map(|(kind, step, _)| (kind, step)).collect()
}

fn changed(change: impl FnOnce(&mut GuideStep)) -> GuideStep {
    let mut step = bare_step(GuideStepKind::Go);
    change(&mut step);
    step
}

#[test]
fn other_side_exchanges_left_and_right_only() {
    let sides = [Side::Left, Side::Right, Side::Ahead, Side::Behind];
    assert_eq!(sides.map(other_side), [Side::Right, Side::Left, Side::Ahead, Side::Behind]);
}

#[test]
fn single_changes_turn_a_turn_to_the_other_side_or_leave_it_out() {
    let guide = make_guide(vec![
        changed(|told| told.step.turn = Some(Side::Left)),
        changed(|told| told.step.turn = Some(Side::Behind)),
    ]);
    use StepChangeKind::{NoStep, NoTurn, Turn};
    assert_eq!(kinds(&guide), [(Turn, 0), (NoTurn, 0), (NoStep, 0), (NoTurn, 1), (NoStep, 1)]);
    let changes = single_changes(&guide);
    assert_eq!(changes[0].2.steps[0].step.turn, Some(Side::Right));
    assert_eq!((changes[1].2.steps[0].step.turn, changes[1].2.steps[0].kind), (None, GuideStepKind::Other));
    assert_eq!((changes[2].2.len(), changes[2].2.steps[0].step.turn), (1, Some(Side::Behind)));
    assert_eq!((changes[4].2.len(), changes[4].2.steps[0].step.turn), (1, Some(Side::Left)));
    let flipped = flip_turns(&guide);
    assert_eq!((flipped.len(), flipped[0].steps[0].step.turn), (1, Some(Side::Right)));
    assert_eq!(guide.steps[0].step.turn, Some(Side::Left), "the guide itself stays");
}

#[test]
fn single_changes_move_places_to_the_other_side_where_the_step_has_no_turn() {
    let on_side = |told: &mut GuideStep| told.step.side = Some((StepRelation::To, Side::Left));
    let place = |told: &mut GuideStep| {
        told.mentions = vec![make_mention(StepRelation::To, false, "sofa")];
        told.mentions[0].side = Some(Side::Right);
    };
    assert_eq!(kinds(&make_guide(vec![changed(on_side)])), [(StepChangeKind::Side, 0)]);
    let guide = make_guide(vec![changed(place)]);
    assert_eq!(kinds(&guide), [(StepChangeKind::Side, 0)]);
    assert_eq!(single_changes(&guide)[0].2.steps[0].mentions[0].side, Some(Side::Left));
    let plain = changed(|told| told.mentions = vec![make_mention(StepRelation::To, false, "sofa")]);
    assert_eq!(kinds(&make_guide(vec![plain])), []);
    let turning = changed(|told| {
        on_side(told);
        told.step.turn = Some(Side::Behind);
    });
    assert_eq!(kinds(&make_guide(vec![turning])), [(StepChangeKind::NoTurn, 0)]);
}

#[test]
fn single_changes_reverse_a_climb() {
    for (climb, opposite) in [(ClimbDirection::Up, ClimbDirection::Down), (ClimbDirection::Down, ClimbDirection::Up)] {
        let guide = make_guide(vec![changed(|told| told.step.climb = Some(climb))]);
        assert_eq!(kinds(&guide), [(StepChangeKind::Climb, 0)]);
        assert_eq!(single_changes(&guide)[0].2.steps[0].step.climb, Some(opposite));
    }
}

#[test]
fn rank_changes_gives_the_difference_of_scores_the_highest_first() {
    let building = make_corridor(&["hallway", "hallway", "kitchen", "kitchen"]);
    let text = "Walk past the sofa and turn left. Go up the stairs on the right. Walk into the kitchen and stop.";
    let guide = Guide::read_text(text);
    for seed in 0..6 {
        let weights = random_weights(seed);
        let known = OneWalk::new(&building, &[0, 1, 2, 3], 0.2, &weights);
        let changes = rank_changes(&guide, &building, &[0, 1, 2, 3], 0.2, &weights);
        let variants = single_changes(&guide);
        assert_eq!(changes.len(), variants.len());
        for (kind, step, variant) in variants {
            let change = changes.iter().find(|change| (change.kind, change.step) == (kind, step)).unwrap();
            assert!((change.gain - (known.score(&variant) - known.score(&guide))).abs() < 1e-9);
            let told = &guide.steps[step].step;
            let is_turn = matches!(kind, StepChangeKind::Turn | StepChangeKind::NoTurn);
            assert_eq!(change.span, if is_turn { told.turn_span.unwrap() } else { told.span });
        }
        assert!(changes.windows(2).all(|pair| pair[0].gain >= pair[1].gain));
    }
}

#[test]
fn rank_changes_orders_equal_gains_by_step_and_takes_no_gain_for_an_impossible_walk() {
    let building = make_corridor(&["hallway"; 30]);
    let walk: Vec<usize> = (0..30).collect();
    let guide = Guide::read_text("Turn left. Turn right.");
    let changes = rank_changes(&guide, &building, &walk, 0.0, &random_weights(1));
    assert_eq!(changes.len(), 6);
    assert!(changes.iter().all(|change| change.gain == 0.0));
    assert_eq!(changes.iter().map(|change| change.step).collect::<Vec<_>>(), [0, 0, 0, 1, 1, 1]);
}
