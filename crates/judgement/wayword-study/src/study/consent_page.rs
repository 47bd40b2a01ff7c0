//! What the consent page has besides its paragraphs: the approval of an ethics committee, and links.

use serde::{Deserialize, Serialize};

/// A link on the consent page, a table `[[links]]` of `study.toml`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConsentLink {
    /// What participants read.
    pub text: String,
    /// Where it leads: https, http or mailto.
    pub url: String,
}

/// Most paragraphs of the consent page.
const MAX_PARAGRAPHS: usize = 50;
/// Longest paragraph, agreement, contact or other text of the consent page, characters.
const MAX_PARAGRAPH_CHARS: usize = 5000;
/// Most links.
const MAX_LINKS: usize = 20;
/// Longest address of a link, bytes.
const MAX_URL_BYTES: usize = 2000;

impl ConsentLink {
    fn check(&self) -> Result<(), String> {
        let problem = |problem: &str| Err(format!("links, {:?}: {problem}", self.text));
        if self.text.trim().is_empty() || self.text.chars().count() > MAX_PARAGRAPH_CHARS {
            return problem("give a `text` that participants read");
        }
        let has_scheme = ["https://", "http://", "mailto:"].iter().any(|scheme| self.url.starts_with(scheme));
        // A space or a control may hide another scheme from a reader of study.toml.
        let is_plain = self.url.bytes().all(|byte| byte.is_ascii_graphic()) && self.url.len() <= MAX_URL_BYTES;
        if !has_scheme || !is_plain {
            return problem("the `url` has to begin with https://, http:// or mailto:, without spaces");
        }
        Ok(())
    }
}

/// Checks the texts and links of the consent page.
///
/// # Errors
/// The first problem, as a sentence about a field.
pub(super) fn check_consent_page(
    paragraphs: &[String],
    others: &[(&str, &str)],
    links: &[ConsentLink],
) -> Result<(), String> {
    if paragraphs.len() > MAX_PARAGRAPHS {
        return Err(format!("about: {} paragraphs, and at most {MAX_PARAGRAPHS} are shown", paragraphs.len()));
    }
    let is_long = |text: &str| text.chars().count() > MAX_PARAGRAPH_CHARS;
    if let Some(at) = paragraphs.iter().position(|text| is_long(text)) {
        return Err(format!("about: paragraph {} has more than {MAX_PARAGRAPH_CHARS} characters", at + 1));
    }
    if let Some((field, _)) = others.iter().find(|(_, text)| is_long(text)) {
        return Err(format!("{field}: more than {MAX_PARAGRAPH_CHARS} characters"));
    }
    if links.len() > MAX_LINKS {
        return Err(format!("links: {}, and at most {MAX_LINKS} are shown", links.len()));
    }
    links.iter().try_for_each(ConsentLink::check)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_links_to_pages_and_mail_are_shown() {
        let check = |url: &str| check_consent_page(&[], &[], &[ConsentLink { text: "more".into(), url: url.into() }]);
        for good in ["https://example.org/a?b#c", "http://example.org", "mailto:a@example.org"] {
            check(good).unwrap();
        }
        for bad in [
            "javascript:alert(1)",
            "data:text/html,x",
            " https://a",
            "https://a b",
            "HTTPS:/a",
            "//a",
            "",
            "https://a\u{0}",
        ] {
            assert!(check(bad).unwrap_err().contains("url"), "{bad:?}");
        }
    }

    #[test]
    fn long_texts_are_refused_with_their_field() {
        let long = "a".repeat(5001);
        assert!(check_consent_page(&[String::new(), long.clone()], &[], &[]).unwrap_err().contains("paragraph 2"));
        assert!(check_consent_page(&[], &[("ethics", &long)], &[]).unwrap_err().starts_with("ethics"));
        assert!(check_consent_page(&vec![String::new(); 51], &[], &[]).unwrap_err().contains("51"));
    }
}
