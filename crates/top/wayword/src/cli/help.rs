//! How `--help` and `-h` list the flags of all commands: under which heading, in which order, and how briefly.

use clap::{Arg, Command};

/// A heading of the help, and the flags under it, the most used first.
struct HelpHeading {
    /// Its words.
    title: &'static str,
    /// Whether `-h`, which fits on two screens, lists it too.
    is_brief: bool,
    /// The long names of its flags.
    flags: &'static [&'static str],
}

/// The headings in their order. A flag that none has is under clap's own heading, Options, which comes first.
const HEADINGS: [HelpHeading; 11] = [
    heading("Where", true, &["platform", "data", "scan", "connectivity", "at", "island"]),
    heading("Paths", true, &["episodes", "item", "paths", "hops", "metres", "limit"]),
    heading("Texts", true, &["instructions", "texts", "style", "language", "per-path", "target"]),
    heading(
        "Views",
        true,
        &["frames", "views", "perception", "questions", "picture-px", "no-pictures", "prompts", "pictures", "clip"],
    ),
    heading(
        "Models",
        true,
        &[
            "llm",
            "see",
            "ask",
            "summarise",
            "write",
            "write-sees",
            "finish",
            "base-url",
            "key-env",
            "split",
            "grounder",
        ],
    ),
    heading("Detector", true, &["detector", "detector-figures", "proposals", "figures"]),
    heading(
        "Checks and repair",
        true,
        &[
            "world",
            "evidence",
            "repairs",
            "refine",
            "candidates",
            "reject-ambiguous",
            "no-witnesses",
            "no-route",
            "doubts",
            "calibration",
        ],
    ),
    heading("Cost and the ledger", true, &["max-usd", "max-calls", "ledger"]),
    heading(
        "Calls to models",
        false,
        &["record", "replay", "prices", "concurrency", "requests-per-minute", "tokens-per-minute", "timeout-s"],
    ),
    heading("Models inside this program", false, &["device", "memory-gib", "precision", "trust"]),
    heading("Many workers", false, &["shard", "queue", "password-env", "plan", "chunk", "spans"]),
];

const fn heading(title: &'static str, is_brief: bool, flags: &'static [&'static str]) -> HelpHeading {
    HelpHeading { title, is_brief, flags }
}

/// Fewest flags that get headings; a shorter list needs none.
const FEWEST_WITH_HEADINGS: usize = 12;

/// Flags that `-h` leaves out although it lists others of their heading: few need them.
const SELDOM_USED: [&str; 10] = [
    "calibration",
    "detector-figures",
    "evidence",
    "finish",
    "island",
    "no-route",
    "picture-px",
    "prompts",
    "proposals",
    "write-sees",
];

/// Fewest characters of a short description; a mark before them does not end it.
const SHORTEST: usize = 20;

/// Most characters of a default that a short description repeats.
const SHORT_DEFAULT: usize = 24;

/// Puts the flags of a command and of its subcommands under their headings, and shortens the help of each for `-h`.
pub(super) fn arrange_help(command: Command) -> Command {
    let command = command.mut_subcommands(arrange_help).mut_args(with_short_help);
    if command.get_arguments().count() < FEWEST_WITH_HEADINGS {
        return command;
    }
    let placed = HEADINGS.iter().flat_map(|heading| heading.flags.iter().map(move |flag| (heading, *flag)));
    placed.enumerate().fold(command, |command, (place, (heading, flag))| {
        let of_flag = |arg: &&Arg| arg.get_long() == Some(flag) && arg.get_help_heading().is_none();
        let Some(id) = command.get_arguments().find(of_flag).map(|arg| arg.get_id().to_string()) else {
            return command;
        };
        // The flag becomes the last of the command, so that headings come in the order of the table.
        let is_left_out = !heading.is_brief || SELDOM_USED.contains(&flag);
        command.mut_arg(id, |arg| arg.help_heading(heading.title).display_order(place).hide_short_help(is_left_out))
    })
}

/// The flag with its first sentence as the description of `-h`, and all of it as that of `--help`. It takes negative numbers as its value.
fn with_short_help(arg: Arg) -> Arg {
    // A negative number is then a wrong value of its flag, and no unknown flag.
    let takes_value = arg.get_long().is_some() && arg.get_action().takes_values();
    let arg = if takes_value { arg.allow_negative_numbers(true) } else { arg };
    let Some(all) = arg.get_long_help().or_else(|| arg.get_help()).map(ToString::to_string) else { return arg };
    arg.help(first_sentence(&all)).long_help(all)
}

/// The first sentence of a description, up to its first detail behind a colon or in brackets, and its default if that is short.
fn first_sentence(all: &str) -> String {
    let (said, default) = match all.rsplit_once(" [default: ") {
        Some((said, default)) => (said, Some(default.trim_end_matches(']'))),
        None => (all, None),
    };
    let ends = |at: usize, mark: &str| match mark {
        ". " => said[at + 2..].starts_with(char::is_uppercase),
        _ => at >= SHORTEST,
    };
    let marks = [". ", ": ", "; ", " ("];
    let end =
        marks.iter().filter_map(|mark| said.match_indices(mark).map(|(at, _)| at).find(|at| ends(*at, mark))).min();
    let sentence = end.map_or(said, |at| &said[..at]).trim_end_matches('.');
    match default.filter(|default| default.chars().count() <= SHORT_DEFAULT) {
        Some(default) => format!("{sentence} [default: {default}]"),
        None => sentence.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::WaywordCli;
    use clap::CommandFactory;
    use std::collections::{BTreeMap, BTreeSet};

    /// Every command with its words, without those that clap adds.
    fn all_commands() -> Vec<(String, Command)> {
        let mut left = vec![(String::new(), WaywordCli::command())];
        let mut all = Vec::new();
        while let Some((words, command)) = left.pop() {
            left.extend(
                command
                    .get_subcommands()
                    .map(|inner| (format!("{words} {}", inner.get_name()).trim().to_owned(), inner.clone())),
            );
            all.push((words, command));
        }
        all
    }

    fn command(words: &str) -> Command {
        all_commands().into_iter().find(|(name, _)| name == words).unwrap().1
    }

    /// The headings of a help text with the flags under each, in their order.
    fn listed(help: &str) -> Vec<(String, Vec<String>)> {
        let mut headings: Vec<(String, Vec<String>)> = Vec::new();
        for line in help.lines() {
            let is_heading = line.ends_with(':') && line.starts_with(char::is_uppercase);
            if is_heading {
                headings.push((line.trim_end_matches(':').to_owned(), Vec::new()));
            }
            let flag = ["      --", "  -q, --", "  -h, --"].iter().find_map(|start| line.strip_prefix(start));
            if let (Some(flag), Some((_, flags))) = (flag, headings.last_mut()) {
                flags.push(flag.split([' ', '[', '=']).next().unwrap_or_default().to_owned());
            }
        }
        headings
    }

    #[test]
    fn headings_of_generate_come_in_their_order_with_the_most_used_flags_first() {
        let help = command("generate").render_long_help().to_string();
        let found = listed(&help);
        let titles: Vec<&str> =
            found.iter().map(|(title, _)| title.as_str()).filter(|title| *title != "Examples").collect();
        let wanted: Vec<&str> = ["Options"].into_iter().chain(HEADINGS.iter().map(|heading| heading.title)).collect();
        assert_eq!(titles, wanted);
        let under = |title: &str| found.iter().find(|(name, _)| name == title).unwrap().1.clone();
        assert_eq!(under("Options")[0], "out");
        assert_eq!(under("Where"), ["platform", "data", "scan", "connectivity", "at", "island"]);
        assert_eq!(under("Paths"), ["episodes", "paths", "hops", "metres", "limit"]);
        assert_eq!(under("Many workers"), ["shard", "queue", "password-env", "plan", "chunk", "spans"]);
    }

    #[test]
    fn a_flag_stands_under_its_own_heading_or_under_options_and_under_no_other() {
        let own: BTreeMap<&str, &str> =
            HEADINGS.iter().flat_map(|heading| heading.flags.iter().map(|flag| (*flag, heading.title))).collect();
        let mut used: BTreeSet<String> = BTreeSet::new();
        for (words, command) in all_commands() {
            // The flags of `export --format steps` stand under a heading of their own, which is last.
            for arg in command
                .get_arguments()
                .filter(|arg| arg.get_help_heading() != Some("With steps and layouts for training"))
            {
                let (Some(flag), found) = (arg.get_long(), arg.get_help_heading()) else { continue };
                assert!(found.is_none() || found == own.get(flag).copied(), "{words}: --{flag} is under {found:?}");
                used.extend(found.map(|_| flag.to_owned()));
            }
        }
        let idle: Vec<_> = own.keys().filter(|flag| !used.contains(**flag)).collect();
        assert!(idle.is_empty(), "no command has these flags, or too few others: {idle:?}");
    }

    #[test]
    fn flags_of_the_steps_are_the_only_ones_under_their_heading() {
        let export = command("export");
        let steps =
            export.get_arguments().filter(|arg| arg.get_help_heading() == Some("With steps and layouts for training"));
        let steps: Vec<&str> = steps.filter_map(Arg::get_long).collect();
        assert_eq!(steps, ["steps", "forward-m", "turn-deg", "tolerance-m", "size-px", "fov-deg", "camera", "shard"]);
    }

    #[test]
    fn every_command_has_an_example() {
        for (words, command) in all_commands() {
            let help = command.get_after_long_help().map(ToString::to_string).unwrap_or_default();
            let example = help.lines().find(|line| line.starts_with("  wayword "));
            assert!(
                example.is_some_and(|line| words.is_empty() || line.contains(&format!("wayword {words}"))),
                "{words}: {example:?}"
            );
        }
    }

    #[test]
    fn short_help_fits_on_two_screens() {
        for (words, mut command) in all_commands() {
            let lines = command.render_help().to_string().lines().count();
            assert!(lines <= 80, "{words} -h: {lines} lines");
        }
    }

    #[test]
    fn short_description_is_the_first_sentence_with_a_short_default() {
        assert_eq!(first_sentence("Number of paths. [default: 10]"), "Number of paths [default: 10]");
        assert_eq!(first_sentence("Use this. It may be hf/a.b or so."), "Use this");
        assert_eq!(first_sentence("A file, e.g. a picture, of 2.5 MB"), "A file, e.g. a picture, of 2.5 MB");
        assert_eq!(first_sentence("An island. [default: the largest that has a ceiling]"), "An island");
        assert_eq!(
            first_sentence("With --episodes: where its scenes are: a, b"),
            "With --episodes: where its scenes are"
        );
        assert_eq!(
            first_sentence("Number of hops of a path (on a graph). [default: 4..7]"),
            "Number of hops of a path [default: 4..7]"
        );
    }
}
