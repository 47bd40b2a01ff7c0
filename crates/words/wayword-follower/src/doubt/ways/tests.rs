use super::*;
use crate::made_buildings::make_mention;

#[test]
fn is_possible_way_allows_every_relation_to_a_room_and_few_to_a_thing_or_stairs() {
    let mention = |is_room, name| make_mention(StepRelation::To, is_room, name);
    for relation in [StepRelation::To, StepRelation::Past] {
        assert!(is_possible_way(&mention(false, "sofa"), relation));
    }
    for relation in [StepRelation::Into, StepRelation::OutOf, StepRelation::Through, StepRelation::Along] {
        assert!(is_possible_way(&mention(true, "kitchen"), relation));
        assert!(
            !is_possible_way(&mention(false, "sofa"), relation) && !is_possible_way(&mention(true, "stairs"), relation)
        );
    }
}
