//! Word lists by which the checks decide how a motion is meant.

crate::data::lists! {
    "languages/en/motions.txt";
    words: MOMENT, DESCRIBING, TAKING_UP, MOTION_VERBS;
    phrases:;
}
