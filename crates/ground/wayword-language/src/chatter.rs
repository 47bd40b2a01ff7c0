//! Word lists that recognise chatter: the words that models put around a text that they were asked for ("Sure, here is
//! the instruction:").

crate::data::lists! {
    "words/chatter.txt";
    words: ANNOUNCED, BARE_REFUSAL;
    phrases: AGREEING, ANNOUNCING, PARTING, REFUSING, UNHELPING;
}
