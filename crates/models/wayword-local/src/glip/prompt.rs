//! Puts phrases into prompts: joined by dots, as many as fit into one prompt. Example: `sink. wooden door`.

use crate::{LocalError, tokenizer::TextTokenizer};

/// The most tokens of a prompt. Phrases that do not fit go into the next prompt.
pub(super) const MAX_PROMPT_TOKENS: usize = 256;

/// A prompt of one or more phrases.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct GlipPrompt {
    /// The token ids of the text.
    pub(super) ids: Vec<u32>,
    /// The number of each phrase, and the positions of its tokens. A phrase without tokens is in no prompt.
    pub(super) phrases: Vec<(usize, Vec<usize>)>,
}

/// Cleans a phrase as the original does: underscores become spaces, and words in brackets are left out.
fn clean_phrase(phrase: &str) -> String {
    let mut depth = 0_usize;
    let kept = phrase.chars().filter(|&c| {
        match c {
            '(' => depth += 1,
            ')' if depth > 0 => {
                depth -= 1;
                return false;
            }
            _ => {}
        }
        depth == 0
    });
    let kept: String = kept.map(|c| if c == '_' { ' ' } else { c }).collect();
    kept.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The prompts of phrases, in their order, with at most `max_tokens` tokens each: a prompt ends where the next phrase
/// would not fit.
///
/// # Errors
/// When a phrase alone is too long for a prompt.
pub(super) fn build_prompts(
    tokenizer: &TextTokenizer,
    phrases: &[&str],
    max_tokens: usize,
) -> Result<Vec<GlipPrompt>, LocalError> {
    let cleaned: Vec<String> = phrases.iter().map(|phrase| clean_phrase(phrase)).collect();
    let mut prompts: Vec<GlipPrompt> = Vec::new();
    let mut begin = 0;
    while begin < cleaned.len() {
        let mut end = begin + 1;
        let mut prompt = join_phrases(tokenizer, &cleaned, begin, end)?;
        if prompt.ids.len() > max_tokens {
            let problem = format!("the phrase {:?} has more than the {max_tokens} tokens of a prompt", phrases[begin]);
            return Err(LocalError::Compute { model: "GLIP".to_owned(), problem });
        }
        // The end is searched by bisection, because each try cuts the whole text into tokens.
        let mut step = cleaned.len() - end;
        while step > 0 {
            let next = join_phrases(tokenizer, &cleaned, begin, (end + step).min(cleaned.len()))?;
            if next.ids.len() <= max_tokens {
                end = (end + step).min(cleaned.len());
                prompt = next;
                step = step.min(cleaned.len() - end);
            } else {
                step /= 2;
            }
        }
        begin = end;
        if !prompt.phrases.is_empty() {
            prompts.push(prompt);
        }
    }
    Ok(prompts)
}

/// Joins the phrases from `begin` to `end` to one prompt, and finds the tokens of each.
fn join_phrases(
    tokenizer: &TextTokenizer,
    phrases: &[String],
    begin: usize,
    end: usize,
) -> Result<GlipPrompt, LocalError> {
    let text = phrases[begin..end].join(". ");
    let (ids, spans) = tokenizer.ids_and_spans(&text)?;
    let mut at = 0;
    let mut phrase_tokens = Vec::new();
    for (number, phrase) in phrases.iter().enumerate().take(end).skip(begin) {
        let to = at + phrase.len();
        let within = |(_, span): &(usize, &(usize, usize))| span.0 < to && span.1 > at;
        let tokens: Vec<usize> = spans.iter().enumerate().filter(within).map(|(token, _)| token).collect();
        if !tokens.is_empty() {
            phrase_tokens.push((number, tokens));
        }
        at = to + 2;
    }
    Ok(GlipPrompt { ids, phrases: phrase_tokens })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn tokenizer() -> TextTokenizer {
        TextTokenizer::load(&PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/glip")).unwrap()
    }

    #[test]
    fn phrases_are_cleaned_as_in_the_original() {
        for (phrase, kept) in
            [("wooden_door", "wooden door"), ("rug (small)", "rug"), (" a  lamp ", "a lamp"), ("(x)", "")]
        {
            assert_eq!(clean_phrase(phrase), kept);
        }
    }

    #[test]
    fn a_phrase_has_the_tokens_of_its_letters() {
        let made = build_prompts(&tokenizer(), &["fireplace", "", "Blue_chair"], 256).unwrap();
        // [CLS] fire ##place . . blue chair [SEP]
        assert_eq!(made.len(), 1);
        assert_eq!(made[0].ids.len(), 8);
        assert_eq!(made[0].phrases, [(0, vec![1, 2]), (2, vec![5, 6])]);
    }

    #[test]
    fn a_phrase_that_does_not_fit_goes_into_the_next_prompt() {
        // Each phrase has one token, and a dot between two.
        let phrases = ["sink", "lamp", "rug", "door", "chair"];
        for (most, sizes) in
            [(3, vec![1, 1, 1, 1, 1]), (5, vec![2, 2, 1]), (7, vec![3, 2]), (10, vec![4, 1]), (11, vec![5])]
        {
            let made = build_prompts(&tokenizer(), &phrases, most).unwrap();
            assert_eq!(made.iter().map(|prompt| prompt.phrases.len()).collect::<Vec<_>>(), sizes, "{most}");
            let numbers: Vec<usize> = made.iter().flat_map(|prompt| prompt.phrases.iter().map(|(at, _)| *at)).collect();
            assert_eq!(numbers, [0, 1, 2, 3, 4]);
            assert!(made.iter().all(|prompt| prompt.ids.len() <= most));
        }
        let error = build_prompts(&tokenizer(), &["sink", "a wooden door"], 4).unwrap_err().to_string();
        assert!(error.contains("a wooden door"), "{error}");
        assert!(build_prompts(&tokenizer(), &[], 256).unwrap().is_empty());
        assert!(build_prompts(&tokenizer(), &["", "()"], 256).unwrap().is_empty());
    }
}
