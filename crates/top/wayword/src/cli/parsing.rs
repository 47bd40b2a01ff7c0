//! Reads the command line, and explains its errors further than clap does.

use super::WaywordCli;
use clap::{
    CommandFactory, Error, Parser,
    error::{ContextKind, ContextValue, ErrorKind},
};
use std::{
    ffi::{OsStr, OsString},
    num::IntErrorKind,
};

/// Most commands that are named as those that have a flag.
const MAX_NAMED_COMMANDS: usize = 4;

/// Reads the command line; `arguments` begins with the name of the program.
///
/// # Errors
/// When it is wrong, or asks for the help or the version.
pub fn parse_arguments(arguments: Vec<OsString>) -> Result<WaywordCli, Error> {
    let named = arguments.get(1).cloned();
    WaywordCli::try_parse_from(arguments).map_err(|error| {
        let more = match error.kind() {
            ErrorKind::ValueValidation => wanted_number(&error),
            ErrorKind::UnknownArgument => {
                commands_with_flag(&error).or_else(|| flag_for_folder(&error, named.as_deref()))
            }
            _ => None,
        };
        match more {
            Some(more) => with_words(&error, &more),
            None => error,
        }
    })
}

/// What a value that is no number of the kind wanted has to be.
fn wanted_number(error: &Error) -> Option<String> {
    let source = std::error::Error::source(error)?;
    if source.is::<std::num::ParseFloatError>() {
        return Some("give a number in digits, as in 2.5".to_owned());
    }
    if let Some(number) = source.downcast_ref::<std::num::ParseIntError>() {
        return Some(match number.kind() {
            IntErrorKind::PosOverflow | IntErrorKind::NegOverflow => "the number is too large".to_owned(),
            _ => "give a whole number in digits, as in 1000".to_owned(),
        });
    }
    // Clap's words about a range end in Rust's own notation.
    let words = source.to_string();
    let (least, most) = words.split_once(" is not in ")?.1.split_once("..=")?;
    let is_open = most.parse::<u32>().is_ok_and(|most| most == u32::MAX);
    Some(match is_open {
        true => format!("give a whole number, {least} or more"),
        false => format!("give a whole number from {least} to {most}"),
    })
}

/// The flag `--run`, where a folder or a file stands alone and the command takes it by that flag.
fn flag_for_folder(error: &Error, command: Option<&OsStr>) -> Option<String> {
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else { return None };
    let root = WaywordCli::command();
    let command = root.find_subcommand(command?)?;
    let takes_run = command.get_arguments().any(|arg| arg.get_long() == Some("run"));
    (takes_run && std::path::Path::new(typed).exists()).then(|| format!("give it as --run {typed}"))
}

/// The commands that have a flag which the command at hand lacks.
fn commands_with_flag(error: &Error) -> Option<String> {
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else { return None };
    let flag = typed.strip_prefix("--")?.split('=').next()?;
    let mut having = Vec::new();
    let mut left = vec![(String::new(), WaywordCli::command())];
    while let Some((words, command)) = left.pop() {
        let inner = |inner: &clap::Command| (format!("{words} {}", inner.get_name()), inner.clone());
        left.extend(command.get_subcommands().map(inner));
        let has_flag = |arg: &clap::Arg| arg.get_long() == Some(flag) && !arg.is_hide_set();
        if command.get_arguments().any(has_flag) {
            having.push(format!("`wayword{words}`"));
        }
    }
    having.sort();
    let more = having.len().checked_sub(MAX_NAMED_COMMANDS).filter(|more| *more > 0);
    having.truncate(MAX_NAMED_COMMANDS);
    let more = more.map_or_else(String::new, |more| format!(" and {more} more"));
    (!having.is_empty()).then(|| format!("--{flag} is a flag of {}{more}, and not of this command", having.join(", ")))
}

/// The error with more words behind its first line.
fn with_words(error: &Error, more: &str) -> Error {
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    let (first, rest) = text.split_once('\n').unwrap_or((text, ""));
    // Clap takes an unknown flag for a value that begins with hyphens.
    let rest: String = rest.split_inclusive('\n').filter(|line| !line.contains("tip: to pass '")).collect();
    // Rust's words about a number add nothing.
    let first = match std::error::Error::source(error) {
        Some(source) => first.strip_suffix(&format!(": {source}")).unwrap_or(first),
        None => first,
    };
    Error::raw(error.kind(), format!("{first}: {more}\n{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(line: &str) -> String {
        let words = line.split(' ').map(OsString::from).collect();
        parse_arguments(words).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn value_that_is_no_number_is_told_what_to_give() {
        let whole = "for '--paths <N>': give a whole number in digits, as in 1000\n";
        for bad in ["1e3", "1,000", "ten", "3.0", "-4"] {
            let told = told(&format!("wayword generate --out r --paths {bad}"));
            assert!(told.contains(&format!("invalid value '{bad}' {whole}")), "{told}");
        }
        assert!(told("wayword generate --out r --paths 99999999999999999999999").contains("the number is too large"));
        assert!(told("wayword generate --out r --max-usd 2,50").contains("give a number in digits, as in 2.5\n"));
        assert!(
            told("wayword evaluate s --episodes e --limit 0")
                .contains("'--limit <N>': give a whole number, 1 or more\n")
        );
        let resamples = told("wayword evaluate s --episodes e --resamples 5");
        assert!(resamples.contains(": give a whole number from 100 to 100000\n"), "{resamples}");
        assert_eq!(told("wayword generate --out r --paths 3"), "");
    }

    #[test]
    fn flag_of_another_command_is_told_with_the_commands_that_have_it() {
        let told = told("wayword check file.json --hops 3..4");
        assert!(told.contains("'--hops' found: --hops is a flag of `wayword generate`, "), "{told}");
        assert!(told.ends_with("For more information, try '--help'.\n"), "{told}");
    }

    #[test]
    fn folder_without_its_flag_is_told_the_flag() {
        assert!(told("wayword report src").contains("'src' found: give it as --run src\n"));
        assert!(!told("wayword report nowhere").contains("--run nowhere"));
    }

    #[test]
    fn a_flag_that_no_command_has_gets_the_suggestion_alone() {
        let told = told("wayword generate --platfrm house");
        assert!(told.contains("a similar argument exists: '--platform'") && !told.contains("is a flag of"), "{told}");
    }
}
