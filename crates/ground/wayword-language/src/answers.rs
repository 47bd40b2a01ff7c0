//! The vocabulary of answers: closed lists that steer how they are read.

crate::data::lists! {
    "words/answers.txt";
    words: AUXILIARIES, SHORT, PERCEIVING, MEANWHILE, NO_DENIAL, NO_OBJECT, STOPPERS, ENDS, AFTER_NOUN, SIGNS, NEW_NOUN, BRINGS_IN, NO_OBJECTS, NUMBERS, TELLS_NOTHING, OTHERS, LEADS, FILLERS, ANYTHING, PREPOSITIONS, BEFORE_SIDE, SIDE_PARTS, WHOLES, IS_NOT;
    phrases: DOUBTS, YES, YES_ALONE, NO, MAYBE;
}
