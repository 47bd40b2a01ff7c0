//! The picture and the texts at the top of README.md are what its commands make.

use crate::common::{command, run};
use std::{fs, path::Path};

/// The commands of the README's top, as they stand there.
const COMMANDS: [&str; 2] = [
    "wayword demo --seed 12",
    "wayword view path --episodes wayword-demo/instructions.jsonl --width 400 --out walk.jpg",
];

#[test]
fn readme_begins_with_what_its_commands_make() {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..");
    let readme = fs::read_to_string(repository.join("README.md")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for line in COMMANDS {
        assert!(readme.contains(line), "README.md lacks {line}");
        let args: Vec<&str> = line.split(' ').skip(1).collect();
        let ended = run(command(&args).current_dir(folder.path()));
        assert_eq!(ended.code, Some(0), "{ended:?}");
    }
    for record in wayword_formats::jsonl::read_records(&folder.path().join("wayword-demo/instructions.jsonl")).unwrap()
    {
        let shown = format!("> **{} style:** {}", record.instruction.style, record.instruction.text);
        assert!(unwrapped(&readme).contains(&shown), "README.md has to show: {shown}");
    }
    let (shown, made) = (repository.join("docs/walk.jpg"), folder.path().join("walk.jpg"));
    assert_eq!(fs::read(shown).unwrap(), fs::read(made).unwrap(), "make docs/walk.jpg anew by the README's commands");
}

/// A document whose quoted lines are joined.
fn unwrapped(document: &str) -> String {
    document
        .lines()
        .map(|line| {
            line.strip_prefix("> ")
                .filter(|rest| !rest.starts_with("**"))
                .map_or_else(|| format!("\n{line}"), |rest| format!(" {rest}"))
        })
        .collect()
}
