//! Word lists for reading a model's questions and answers: which words mean yes or no, doubt, several things, and so
//! on.

crate::data::lists! {
    "languages/en/answers.txt";
    words: AUXILIARIES, SHORT, PERCEIVING, MEANWHILE, NO_DENIAL, NO_OBJECT, STOPPERS, ENDS, AFTER_NOUN, SIGNS, NEW_NOUN, BRINGS_IN, NO_OBJECTS, NUMBERS, TELLS_NOTHING, OTHERS, LEADS, FILLERS, ANYTHING, PREPOSITIONS, BEFORE_SIDE, SIDE_PARTS, WHOLES, IS_NOT, MORE_COLOURS, TELLING, FREE_SPEECH, ASKING, EMPTY, MATERIALS, PATTERNS, QUALITIES, BUNCHES, GUESSING;
    phrases: DOUBTS, YES, YES_ALONE, NO, MAYBE;
}
