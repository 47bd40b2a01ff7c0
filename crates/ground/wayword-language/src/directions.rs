//! Word lists by which an instruction is cut into parts and its directions are swapped.

crate::data::lists! {
    "languages/en/directions.txt";
    words: JOINING, TELLING, AFTER_VERB, AFTER_ROOM, GOING_ON, BEFORE_SIDE, AFTER_SIDE, BEFORE_STAIRS, GOING;
    phrases:;
}
