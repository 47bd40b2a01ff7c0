//! The commands of README.md, docs/*.md and `--help`. The real command line reads each of them, and the test runs each
//! that needs only this program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "how long each command took")]

#[cfg(feature = "full")]
mod reader_folder;
mod readme_example;

use clap::{CommandFactory, Parser};
use std::{collections::BTreeSet, path::Path};
use wayword::cli::WaywordCli;
use wayword_testkit::documents::{self, DocumentedCommand};

#[cfg(feature = "full")]
use reader_folder::{ReaderFolder, RunExtent};

/// Commands that a test cannot run: a word by which to recognise them, and what they need. The test runs all others.
const NEEDS: [(&str, &str); 12] = [
    ("--platform tdw", "ThreeDWorld's simulator"),
    ("--platform virtualhome", "VirtualHome's simulator"),
    ("--platform process", "Python and a simulator"),
    ("hf/", "weights from the hub"),
    ("wayword_db", "PostgreSQL"),
    ("s3://", "a bucket"),
    ("similarity runs/val_seen#reverie", "the weights of a sentence encoder"),
    ("--decisions decisions.jsonl", "what a curator saved"),
    ("DATASET", "a LeRobot dataset of the reader's own"),
    ("--data NAME", "a recording of the reader's own"),
    ("DATA/zh/", "XL-R2R's texts"),
    ("runs/written", "the run by XL-R2R's texts"),
];

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
    NEEDS.iter().find(|(word, _)| line.contains(word))
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
    let idle: Vec<_> = NEEDS.iter().filter(|(word, _)| !used.contains(word)).collect();
    assert!(idle.is_empty(), "no command needs {idle:?}: take it out of NEEDS");
}

#[cfg(feature = "full")]
#[test]
fn documented_commands_run_as_the_documents_describe() {
    let ran = run_documents(RunExtent::Quick);
    assert!(ran > 60, "{ran}");
}

/// `ci/documents` runs this one.
#[cfg(feature = "full")]
#[test]
#[ignore = "takes half an hour; `ci/documents` runs it"]
fn documented_commands_run_with_the_numbers_of_the_documents() {
    let ran = run_documents(RunExtent::Whole);
    assert!(ran > 80, "{ran}");
}

/// The README's commands in one folder, then those of each document in a copy of it: in the order in which they stand,
/// because later commands use the results of earlier ones. Returns how many ran.
#[cfg(feature = "full")]
fn run_documents(extent: RunExtent) -> usize {
    let commands = documented();
    let (readme, others): (Vec<_>, Vec<_>) = commands.iter().partition(|command| document(command) == "README.md");
    let reader = ReaderFolder::new(extent);
    let mut ran = run_all(&reader, &readme);
    for page in others.chunk_by(|a, b| document(a) == document(b)) {
        ran.extend(run_all(&reader.copy(), page));
    }
    println!("{} of {} documented commands ran", ran.len(), commands.len());
    let faults: Vec<&String> = ran.iter().filter_map(|fault| fault.as_ref()).collect();
    assert!(faults.is_empty(), "correct these, or say in NEEDS what they need: {faults:#?}");
    ran.len()
}

/// The document of a command.
fn document(command: &DocumentedCommand) -> &str {
    command.place.split(':').next().unwrap_or_default()
}

/// Runs the commands that the test can run. For each: how it ended, where that is not as it should.
#[cfg(feature = "full")]
fn run_all(reader: &ReaderFolder, commands: &[&DocumentedCommand]) -> Vec<Option<String>> {
    let (mut ran, mut faults) = (BTreeSet::new(), Vec::new());
    for command in commands {
        if is_a_name(command)
            || needs(command).is_some()
            || reader.is_a_form(command)
            || reader.is_too_slow(command)
            || !ran.insert(&command.args)
        {
            continue;
        }
        let started = std::time::Instant::now();
        let ended = reader.run(command);
        eprintln!("{:>5.1} s  {} {}", started.elapsed().as_secs_f64(), command.place, command.args.join(" "));
        let fault = || format!("{}: {:?}: {ended:?}", command.place, command.args);
        faults.push((!GOOD.contains(&ended.code)).then(fault));
    }
    faults
}
