//! What models say around a text that they were asked for: closed word lists by which it is recognised.

crate::data::lists! {
    "words/chatter.txt";
    words: ANNOUNCED, BARE_REFUSAL;
    phrases: AGREEING, ANNOUNCING, PARTING, REFUSING, UNHELPING;
}
