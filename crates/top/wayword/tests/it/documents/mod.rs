//! The commands of README.md, docs/*.md and `--help`. The real command line reads each of them, and the test runs each
//! that needs only this program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use clap::{CommandFactory, Parser};
use std::{collections::BTreeSet, path::Path};
use wayword::cli::WaywordCli;
use wayword_testkit::documents::{self, DocumentedCommand};

/// Commands that a test cannot run: a word by which to recognise them, and what they need. The test runs all others.
const NEEDS: [(&str, &str); 13] = [
    ("data/scene_datasets", "HM3D"),
    ("--data SCENES", "scans, and viewpoint graphs for them"),
    ("--platform matterport", "Matterport3D's files"),
    ("runs/val_seen", "a run over Matterport3D's files"),
    ("runs/table", "a comparison over Matterport3D's files"),
    ("--platform tdw", "ThreeDWorld's simulator"),
    ("--platform virtualhome", "VirtualHome's simulator"),
    ("--platform process", "Python and a simulator"),
    ("--platform recording", "a recording of the reader's own"),
    ("ollama/", "Ollama, with the model"),
    ("openai/", "a key of OpenAI's"),
    ("hf/", "weights from the hub"),
    ("wayword_db", "PostgreSQL"),
];

/// Subcommands that a test cannot run with any arguments, and what they need.
const COMMANDS_NEED: [(&str, &str); 4] = [
    ("ledger", "a ledger, which calls of models make"),
    ("runs", "workers that have made the whole run"),
    ("similarity", "the weights of a sentence encoder"),
    ("study", "runs, and people"),
];

/// The largest values that the test runs a command with, because a document's larger ones would take too long.
const AT_MOST: [(&str, u32); 3] = [("--paths", 1), ("--views", 5), ("--smooth", 1)];

/// The exit codes that a documented command may end with: done, or done with loss.
const GOOD: [Option<i32>; 2] = [Some(0), Some(3)];

fn documented() -> Vec<DocumentedCommand> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").canonicalize().unwrap();
    let mut commands = documents::documented_commands(&repository).unwrap();
    commands.retain(|command| command.program == "wayword");
    assert!(commands.len() > 20, "{} commands", commands.len());
    commands
}

/// The reason why a test cannot run a command; `None` for a command that the test runs.
fn needs(command: &DocumentedCommand) -> Option<&'static (&'static str, &'static str)> {
    let line = format!("{} ", command.args.join(" "));
    NEEDS.iter().find(|(word, _)| line.contains(word)).or_else(|| {
        // Only the subcommand counts, because `--ledger FILE` is a flag of many commands.
        let known = WaywordCli::command();
        let subcommand = command.args.iter().find(|word| known.find_subcommand(word).is_some())?;
        COMMANDS_NEED.iter().find(|(name, _)| name == subcommand)
    })
}

/// Whether this is only a command's name within the text, as in "`wayword ledger export` writes", and not a command to
/// type.
fn is_a_name(command: &DocumentedCommand) -> bool {
    let mut known = WaywordCli::command();
    for word in &command.args {
        let Some(inner) = known.find_subcommand(word) else { return false };
        known = inner.clone();
    }
    command.is_within_text && known.try_get_matches_from([""]).is_err()
}

fn unreadable<'a>(words: impl IntoIterator<Item = &'a str>) -> Option<String> {
    use clap::error::ErrorKind::{DisplayHelp, DisplayVersion};
    let error = WaywordCli::try_parse_from(words).err()?;
    (!matches!(error.kind(), DisplayHelp | DisplayVersion)).then(|| error.to_string())
}

#[test]
fn every_command_of_the_documents_is_read_by_the_command_line() {
    for command in documented() {
        if is_a_name(&command) {
            continue;
        }
        let words = ["wayword"].into_iter().chain(command.args.iter().map(String::as_str));
        let problem = unreadable(words);
        assert_eq!(problem, None, "{}: {:?}", command.place, command.args);
    }
}

#[test]
fn every_example_of_the_help_is_read_by_the_command_line() {
    let mut left = vec![WaywordCli::command()];
    let mut examples = 0;
    while let Some(command) = left.pop() {
        left.extend(command.get_subcommands().cloned());
        let help = command.get_after_long_help().map(ToString::to_string).unwrap_or_default();
        let fenced = format!("```sh\n{}\n```\n", typed(&help));
        for example in documents::commands_in_markdown(command.get_name(), &fenced) {
            let words = ["wayword"].into_iter().chain(example.args.iter().map(String::as_str));
            assert_eq!(unreadable(words), None, "help of {}: {:?}", command.get_name(), example.args);
            examples += 1;
        }
    }
    assert!(examples > 30, "{examples} examples");
}

/// The lines of a help text that a user types: those that begin with the program, and their continuations. Several
/// blanks separate a remark.
fn typed(help: &str) -> String {
    let mut lines = Vec::new();
    let mut goes_on = false;
    for line in help.lines() {
        if goes_on || line.starts_with("  wayword ") {
            let command = line.trim().split("      ").next().unwrap_or_default();
            goes_on = command.ends_with('\\');
            lines.push(command);
        }
    }
    lines.join("\n")
}

#[test]
fn every_need_that_is_listed_is_some_command_s() {
    let used: BTreeSet<&str> = documented().iter().filter_map(needs).map(|(word, _)| *word).collect();
    let idle: Vec<_> = NEEDS.iter().chain(&COMMANDS_NEED).filter(|(word, _)| !used.contains(word)).collect();
    assert!(idle.is_empty(), "no command needs {idle:?}: take it out of NEEDS or COMMANDS_NEED");
}

#[test]
fn command_with_its_own_ledger_can_be_tested() {
    let needs_of = |line: &str| {
        let fenced = format!("```sh\n{line}\n```\n");
        documents::commands_in_markdown("a test", &fenced).iter().any(|command| needs(command).is_some())
    };
    assert!(needs_of("wayword ledger show --limit 5"));
    assert!(!needs_of("wayword generate --paths 1 --ledger calls.db --out runs/a"));
}

/// In one folder and in the order of the documents, because later commands use the results of earlier ones.
#[test]
fn documented_commands_run_as_the_documents_describe() {
    let folder = tempfile::tempdir().unwrap();
    let mut ran: BTreeSet<Vec<String>> = BTreeSet::new();
    for command in documented() {
        let args = quicker(&command.args);
        let is_film = args.iter().any(|arg| arg.ends_with(".mp4"));
        let is_table =
            args.windows(2).any(|pair| pair[0] == "--format" && ["parquet", "hf"].contains(&pair[1].as_str()));
        if is_a_name(&command)
            || needs(&command).is_some()
            || (is_film && !cfg!(feature = "video"))
            || (is_table && !cfg!(feature = "parquet"))
            || !ran.insert(args.clone())
        {
            continue;
        }
        let mut process = crate::common::command(&args);
        process.current_dir(folder.path()).envs(command.variables.clone());
        process.env("XDG_DATA_HOME", folder.path().join("data")).env("WAYWORD_OFFLINE", "1");
        let ended = crate::common::run(&mut process);
        assert!(
            GOOD.contains(&ended.code),
            "{}: {args:?}: correct it, or say in NEEDS what it needs: {ended:?}",
            command.place
        );
    }
    assert!(ran.len() > 5, "{ran:?}");
}

/// The command with smaller numbers.
fn quicker(args: &[String]) -> Vec<String> {
    let mut quicker = args.to_vec();
    for at in 1..quicker.len() {
        let most = AT_MOST.iter().find(|(flag, _)| *flag == quicker[at - 1]).map(|(_, most)| *most);
        if let Some(most) = most.filter(|most| quicker[at].parse::<u32>().is_ok_and(|asked| asked > *most)) {
            quicker[at] = most.to_string();
        }
    }
    quicker
}
