//! Masks passwords, keys and tokens that stand in addresses, before a text is shown or kept.

use std::{borrow::Cow, ops::Range};

/// What stands in the place of a secret.
const MASK: &str = "***";
/// Ends of names of parameters of an address whose values are secret, in lower case and without `-`, `_` and `.`.
const SECRET_PARAMETERS: [&str; 12] = [
    "key",
    "token",
    "secret",
    "password",
    "passwd",
    "pass",
    "pwd",
    "signature",
    "credential",
    "credentials",
    "auth",
    "sig",
];
/// The same for `name=value` outside an address, as in the settings of a database. They are fewer, because such a text need not be
/// an address.
const SECRET_SETTINGS: [&str; 5] = ["password", "passwd", "apikey", "accesstoken", "secretaccesskey"];

/// A text in which `***` stands for each secret of an address: a user with a password (`https://me:secret@host`), a user of a web
/// address alone, which may be a token, and the values of parameters such as `?api_key=`.
#[must_use]
pub fn mask_credentials(text: &str) -> Cow<'_, str> {
    let mut secrets: Vec<Range<usize>> = text
        .match_indices("://")
        .filter_map(|(at, _)| user_span(text, at))
        .chain(text.match_indices('=').filter_map(|(at, _)| value_span(text, at)))
        .collect();
    if secrets.is_empty() {
        return Cow::Borrowed(text);
    }
    secrets.sort_by_key(|secret| secret.start);
    let (mut masked, mut done) = (String::with_capacity(text.len()), 0);
    for Range { start, end } in secrets {
        if start >= done {
            masked.push_str(text.get(done..start).unwrap_or_default());
            masked.push_str(MASK);
        }
        done = done.max(end);
    }
    masked.push_str(text.get(done..).unwrap_or_default());
    Cow::Owned(masked)
}

/// Where the user with the password stands in the address whose `://` is at `at`.
fn user_span(text: &str, at: usize) -> Option<Range<usize>> {
    let (before, after) = (text.get(..at)?, text.get(at + 3..)?);
    let address = after.split(|c: char| c.is_whitespace() || matches!(c, '"' | '<' | '>' | '`')).next()?;
    let authority = address.split(['/', '?', '#']).next()?;
    let user_end = match authority.rfind('@') {
        Some(end) => end,
        // A password may hold a slash that was not escaped. What follows the colon is no port then.
        None => {
            let (_, port) = authority.split_once(':').filter(|_| !authority.starts_with('['))?;
            address.rfind('@').filter(|_| !port.chars().all(|c| c.is_ascii_digit()))?
        }
    };
    let is_web = ["http", "https"].iter().any(|scheme| {
        before
            .len()
            .checked_sub(scheme.len())
            .and_then(|start| before.get(start..))
            .is_some_and(|end| end.eq_ignore_ascii_case(scheme))
    });
    let is_secret = address.get(..user_end)?.contains(':') || is_web;
    (is_secret && user_end > 0).then_some(at + 3..at + 3 + user_end)
}

/// Where the value after the `=` at `at` stands, if its name is that of a secret.
fn value_span(text: &str, at: usize) -> Option<Range<usize>> {
    let before = text.get(..at)?;
    let in_name = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let name_start = before.char_indices().rev().take_while(|(_, c)| in_name(*c)).last()?.0;
    let is_parameter = before.get(..name_start)?.ends_with(['?', '&', ';', '#']);
    let name: String = before.get(name_start..)?.chars().filter(|c| c.is_alphanumeric()).collect();
    let name = name.to_lowercase();
    let names = if is_parameter { &SECRET_PARAMETERS[..] } else { &SECRET_SETTINGS[..] };
    if !names.iter().any(|secret| name.ends_with(secret)) {
        return None;
    }
    let value = text.get(at + 1..)?;
    let ends = |c: char| c.is_whitespace() || matches!(c, '&' | '"' | '<' | '>' | '`' | '#');
    let length = match value.strip_prefix('\'').and_then(|quoted| quoted.find('\'')) {
        Some(closing) => closing + 2,
        None => value.find(ends).unwrap_or(value.len()),
    };
    (length > 0).then_some(at + 1..at + 1 + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mask_credentials_masks_users_with_passwords_and_secret_parameters() {
        for (text, masked) in [
            ("https://me:geheim@host/v1: refused", "https://***@host/v1: refused"),
            ("https://ghp_geheim@host/x", "https://***@host/x"),
            ("postgres://me:geheim@host:5432/db?sslmode=require", "postgres://***@host:5432/db?sslmode=require"),
            ("http://me:ge/he?im@host/x", "http://***@host/x"),
            ("http://me:ge@heim@host/x", "http://***@host/x"),
            ("\"HTTPS://me:geheim@host\" and s3://k:geheim@b", "\"HTTPS://***@host\" and s3://***@b"),
            ("https://h/x?api_key=geheim&n=1", "https://h/x?api_key=***&n=1"),
            ("https://h/x?n=1&X-Amz-Signature=geheim\n", "https://h/x?n=1&X-Amz-Signature=***\n"),
            ("h/x?token=geheim, ?key=geheim", "h/x?token=*** ?key=***"),
            ("host=h password='ge heim' dbname=d", "host=h password=*** dbname=d"),
            ("{\"url\":\"http://h?key=geheim\"}", "{\"url\":\"http://h?key=***\"}"),
        ] {
            assert_eq!(mask_credentials(text), masked, "{text}");
        }
    }

    #[test]
    fn mask_credentials_leaves_everything_else() {
        for text in [
            "http://127.0.0.1:8080/a@b",
            "http://[::1]:80/a@b",
            "postgresql://me@host/db",
            "az://container@account/prefix",
            "give --password-env NAME",
            "https://h/x?seed=3&keyframe=2",
            "key = 3, token=4",
            "://",
            "=",
            "a\u{e9}=b",
        ] {
            assert!(matches!(mask_credentials(text), Cow::Borrowed(_)), "{text}");
        }
    }
}
