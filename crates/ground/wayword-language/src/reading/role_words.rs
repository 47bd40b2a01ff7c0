//! Word lists by which each word gets its role.

crate::data::lists! {
    "languages/en/roles.txt";
    words: STOP_WORDS, MOTION, TASKS, RELATIONS, CONNECTIVES, MANNER, GENERAL;
    phrases:;
}
