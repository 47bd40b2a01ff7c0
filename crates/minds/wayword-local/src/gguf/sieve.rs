//! A reply as it comes: bytes to letters, without thoughts, and not beyond a word that ends it.

/// Ends of a turn that a model may spell out instead of saying the token.
const STOPS: &[&str] =
    &["<|im_end|>", "<|im_start|>", "<|eot_id|>", "<|start_header_id|>", "<|end_of_text|>", "<|endoftext|>", "</s>"];
const THINK: &str = "<think>";
const THOUGHT: &str = "</think>";

/// Takes bytes, gives pieces of text.
pub(super) struct Sieve<'a> {
    on_piece: &'a mut dyn FnMut(&str),
    /// The begin of a letter.
    bytes: Vec<u8>,
    /// Letters that may be the begin of a mark, or spaces that may be the last.
    held: String,
    text: String,
    place: Place,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Nothing was said; a thought may come.
    Begin,
    Thought,
    Words,
}

impl<'a> Sieve<'a> {
    /// Of a reply that begins within a thought, where the prompt ends with one.
    pub(super) fn new(thinking: bool, on_piece: &'a mut dyn FnMut(&str)) -> Self {
        let place = if thinking { Place::Thought } else { Place::Begin };
        Self { on_piece, bytes: Vec::new(), held: String::new(), text: String::new(), place }
    }

    /// Takes bytes; whether the reply goes on.
    pub(super) fn take(&mut self, bytes: &[u8]) -> bool {
        self.bytes.extend_from_slice(bytes);
        self.read_letters();
        loop {
            let goes_on = match self.place {
                Place::Begin => self.begin(),
                Place::Thought => self.think(),
                Place::Words => return self.speak(),
            };
            if !goes_on {
                return true;
            }
        }
    }

    /// The reply: what was given in pieces.
    pub(super) fn end(mut self) -> String {
        let rest = String::from_utf8_lossy(&std::mem::take(&mut self.bytes)).into_owned();
        self.held.push_str(&rest);
        if self.place != Place::Thought {
            let words = self.held.trim_end().len();
            self.say(words);
        }
        self.text
    }

    /// Moves whole letters over; bytes that are none become replacement characters.
    fn read_letters(&mut self) {
        loop {
            let (whole, broken) = match std::str::from_utf8(&self.bytes) {
                Ok(letters) => (letters.len(), None),
                Err(error) => (error.valid_up_to(), error.error_len()),
            };
            let letters: Vec<u8> = self.bytes.drain(..whole).collect();
            self.held.push_str(&String::from_utf8_lossy(&letters));
            let Some(broken) = broken else { return };
            self.bytes.drain(..broken);
            self.held.push(char::REPLACEMENT_CHARACTER);
        }
    }

    /// Leaves spaces out; whether it is known what comes.
    fn begin(&mut self) -> bool {
        let spaces = self.held.len() - self.held.trim_start().len();
        self.held.drain(..spaces);
        if self.held.starts_with(THINK) {
            self.held.drain(..THINK.len());
            self.place = Place::Thought;
        } else if !THINK.starts_with(&self.held) {
            self.place = Place::Words;
        }
        self.place != Place::Begin
    }

    /// Leaves a thought out; whether it is over.
    fn think(&mut self) -> bool {
        let over = self.held.find(THOUGHT);
        let forget = match over {
            Some(at) => at + THOUGHT.len(),
            None => self.held.len() - begun(&self.held, &[THOUGHT]),
        };
        self.held.drain(..forget);
        if over.is_some() {
            self.place = Place::Begin;
        }
        over.is_some()
    }

    /// Gives what can be no part of a mark; whether the reply goes on.
    fn speak(&mut self) -> bool {
        let stop = STOPS.iter().filter_map(|stop| self.held.find(stop)).min();
        let words = stop.unwrap_or(self.held.len() - begun(&self.held, STOPS));
        self.say(self.held[..words].trim_end().len());
        if stop.is_some() {
            self.held.clear();
        }
        stop.is_none()
    }

    fn say(&mut self, length: usize) {
        let piece: String = self.held.drain(..length).collect();
        if !piece.is_empty() {
            self.text.push_str(&piece);
            (self.on_piece)(&piece);
        }
    }
}

/// How many bytes at a text's end may be the begin of a mark.
fn begun(text: &str, marks: &[&str]) -> usize {
    let begun = |mark: &&str| (1..mark.len()).rev().find(|&length| text.ends_with(&mark[..length]));
    marks.iter().filter_map(begun).max().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The reply of some bytes in pieces of a size, the pieces, and whether a mark ended it.
    fn sieved(bytes: &[u8], size: usize, thinking: bool) -> (String, Vec<String>, bool) {
        let mut pieces = Vec::new();
        let mut on_piece = |piece: &str| pieces.push(piece.to_owned());
        let mut sieve = Sieve::new(thinking, &mut on_piece);
        let goes_on = bytes.chunks(size).all(|bytes| sieve.take(bytes));
        let text = sieve.end();
        (text, pieces, !goes_on)
    }

    #[test]
    fn thoughts_marks_and_spaces_around_are_not_said_however_they_are_cut() {
        let cases = [
            (" Turn left.\n", "Turn left.", false),
            ("<think>\nHm, <b>\n</think>\n\nGo  on \n", "Go  on", false),
            ("<think></think><think>a</think>b", "b", false),
            ("<think>never ended", "", false),
            ("<thin", "<thin", false),
            ("a < b <|im_", "a < b <|im_", false),
            ("Stop. <|im_end|>\nuser", "Stop.", true),
            ("a <think>b</think>", "a <think>b</think>", false),
            ("Über\u{1f600} all", "Über\u{1f600} all", false),
            ("<<|eot_id|>", "<", true),
        ];
        for (said, expected, stopped) in cases {
            for size in 1..=said.len() {
                let (text, pieces, by_mark) = sieved(said.as_bytes(), size, false);
                assert_eq!((&text[..], by_mark), (expected, stopped), "{said:?} by {size}");
                assert_eq!(pieces.concat(), text);
            }
        }
        assert_eq!(sieved(b"so</think> b", 2, true).0, "b");
    }

    proptest! {
        #[test]
        fn bytes_that_are_no_letters_are_replaced_as_a_whole_text_s_are(bytes: Vec<u8>, size in 1..5_usize) {
            let bytes = [b"a".as_slice(), &bytes, b"z"].concat();
            let whole = String::from_utf8_lossy(&bytes).into_owned();
            let (text, pieces, stopped) = sieved(&bytes, size, false);
            prop_assert!(stopped || text == whole, "{text:?} is not {whole:?}");
            prop_assert_eq!(pieces.concat(), text);
        }
    }
}
