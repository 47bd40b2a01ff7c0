//! Word lists by which each word gets its role.

crate::data::lists! {
    "words/roles.txt";
    words: STOP_WORDS, MOTION, TASKS, RELATIONS, CONNECTIVES, MANNER, GENERAL;
    phrases:;
}
