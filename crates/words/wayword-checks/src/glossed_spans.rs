//! Byte ranges of a text that was read through English words.

use crate::TextFindings;
use wayword_core::InstructionPart;
use wayword_language::languages::ReadableText;

/// Turns the byte ranges of parts of the English words into those of the text. Where words change places between two parts, the second
/// begins where the first ends.
pub fn put_parts_into_text(parts: &mut [InstructionPart], words: &ReadableText<'_>) {
    if !words.is_glossed() {
        return;
    }
    let mut end = 0;
    for part in parts {
        let [from, to] = words.source_span(part.span);
        part.span = [from.max(end), to.max(end)];
        end = part.span[1];
    }
}

impl TextFindings {
    /// Turns the byte ranges of the English words of a text into those of the text itself.
    pub fn put_into_text(&mut self, words: &ReadableText<'_>) {
        if !words.is_glossed() {
            return;
        }
        let spans = self.findings.iter_mut().filter_map(|finding| finding.span.as_mut());
        let spans = spans.chain(self.mentions.iter_mut().map(|mention| &mut mention.span));
        spans.for_each(|span| *span = words.source_span(*span));
        put_parts_into_text(&mut self.parts, words);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_gloss_become_parts_of_the_text() {
        let text = "走到沙发旁边，左转，上楼梯。";
        let words = ReadableText::new(text, None);
        let part = |said: &str| {
            let from = words.english().find(said).unwrap();
            InstructionPart { span: [from, from + said.len()], frames: [0, 1], confidence: None }
        };
        let mut parts = vec![part("walk to the sofa"), part("turn left"), part("go upstairs")];
        put_parts_into_text(&mut parts, &words);
        let shown: Vec<&str> = parts.iter().map(|part| &text[part.span[0]..part.span[1]]).collect();
        assert_eq!(shown, ["走到沙发旁边", "左转", "上楼梯"]);
    }
}
