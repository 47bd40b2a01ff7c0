//! Word lists that recognise chatter: the words that models put around a text that they were asked for ("Sure, here is
//! the instruction:").
//!
//! - `ANNOUNCED`: what a model calls the text ("instruction", "summary").
//! - `AGREEING`: beginnings that only agree to the request ("sure").
//! - `ANNOUNCING`: beginnings of a sentence that announces the text ("here is").
//! - `PARTING`: beginnings of a sentence after the text ("let me know").
//! - `REFUSING`: beginnings of a reply that may be a refusal ("I'm sorry").
//! - `UNHELPING`: what a refusal will not do ("help with"). A reply without any of these may be a text.
//! - `BARE_REFUSAL`: words of a reply that is nothing but a refusal ("I'm sorry, but I can't").

crate::data::lists! {
    "languages/en/chatter.txt";
    words: ANNOUNCED, BARE_REFUSAL;
    phrases: AGREEING, ANNOUNCING, PARTING, REFUSING, UNHELPING;
}

/// The same in Chinese, by the beginnings of sentences: it writes no blanks between words.
pub mod zh {
    crate::data::lists! {
        "languages/zh/chatter.txt";
        words: AGREEING, ANNOUNCED, REFUSING;
        phrases:;
    }
}
