use super::*;
use crate::{
    guide::GuideStepKind,
    made_buildings::{add_thing, bare_step, make_corridor, make_guide, make_mention, random_weights},
};

/// A corridor with a sofa, a piano and a lamp along it.
fn furnished() -> KnownBuilding {
    let mut building = make_corridor(&["hallway", "hallway", "kitchen", "kitchen"]);
    add_thing(&mut building, "sofa", [1.0, 0.0, 1.0], &[0]);
    add_thing(&mut building, "piano", [1.0, 3.0, 1.0], &[1]);
    add_thing(&mut building, "lamp", [1.0, 6.0, 1.0], &[3]);
    building
}

/// A guide of one place a step, given by the relation and the name; bytes 10 to 14 of each step of 20 bytes name it.
fn guide_of(places: &[(StepRelation, &str)]) -> Guide {
    let step = |(at, (relation, name)): (usize, &(StepRelation, &str))| {
        let mut told = bare_step(GuideStepKind::Go);
        told.mentions = vec![make_mention(*relation, false, name)];
        told.mentions[0].span = Some([20 * at + 10, 20 * at + 14]);
        told
    };
    make_guide(places.iter().enumerate().map(step).collect())
}

#[test]
fn is_met_leaves_out_relations_that_only_identify() {
    use StepRelation::{Before, Between, Near, Of, Plain, With};
    for relation in StepRelation::ALL {
        assert_eq!(is_met(relation), ![Before, Between, Near, Of, Plain, With].contains(&relation), "{relation:?}");
    }
}

#[test]
fn met_places_are_those_that_the_building_has_and_the_walker_comes_to() {
    let building = furnished();
    let guide = guide_of(&[
        (StepRelation::Past, "sofa"),
        (StepRelation::With, "piano"),
        (StepRelation::To, "fridge"),
        (StepRelation::At, "lamp"),
    ]);
    let spans =
        |guide: &Guide| met_places(guide, &building).iter().map(|at| (at.step, at.place, at.span)).collect::<Vec<_>>();
    assert_eq!(spans(&guide), [(0, 0, [10, 14]), (3, 0, [70, 74])]);
    let mut unnamed = guide;
    unnamed.steps[0].mentions[0].span = None;
    assert_eq!(spans(&unnamed), [(3, 0, [70, 74])]);
    assert_eq!(spans(&guide_of(&[(StepRelation::Past, "sofa"); 20])).len(), 14);
}

#[test]
fn best_swap_is_the_best_of_all_pairs() {
    let building = furnished();
    let names = ["sofa", "piano", "lamp"];
    let guide = guide_of(&names.map(|name| (StepRelation::Past, name)));
    let mut winners = std::collections::BTreeSet::new();
    for seed in 0..12 {
        let weights = random_weights(seed);
        let known = OneWalk::new(&building, &[0, 1, 2, 3], 0.0, &weights);
        let gain = |[a, b]: [usize; 2]| {
            let mut order = names;
            order.swap(a, b);
            known.score(&guide_of(&order.map(|name| (StepRelation::Past, name)))) - known.score(&guide)
        };
        let best = [[0, 1], [0, 2], [1, 2]].into_iter().max_by(|a, b| gain(*a).total_cmp(&gain(*b))).unwrap();
        let swap = best_swap(&guide, &building, &[0, 1, 2, 3], 0.0, &weights).unwrap();
        assert_eq!(swap.names, best.map(|at| names[at]));
        assert_eq!(swap.spans, best.map(|at| [20 * at + 10, 20 * at + 14]));
        assert!((swap.gain - gain(best)).abs() < 1e-9);
        winners.insert(best);
    }
    assert!(winners.len() > 1, "different weights have different winners");
}

#[test]
fn best_swap_needs_two_places_of_different_steps_and_names() {
    let building = furnished();
    let swap = |guide: &Guide| best_swap(guide, &building, &[0, 1, 2, 3], 0.0, &random_weights(3));
    assert_eq!(swap(&guide_of(&[(StepRelation::Past, "sofa"), (StepRelation::To, "sofa")])), None);
    assert_eq!(swap(&guide_of(&[(StepRelation::Past, "sofa"), (StepRelation::To, "fridge")])), None);
    let mut one = guide_of(&[(StepRelation::Past, "sofa"), (StepRelation::To, "lamp")]);
    assert!(swap(&one).is_some());
    let moved = one.steps.remove(1).mentions;
    one.steps[0].mentions.extend(moved);
    assert_eq!(swap(&one), None);
}
