//! Extracts the commands that our documents ask readers to type. It reads Markdown: fenced blocks of shell, and code spans
//! within paragraphs. A test runs the commands through the real command-line parser, so that no document shows a command
//! that does not exist.

mod shell;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// A command of one of this repository's programs, in a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DocumentedCommand {
    /// The document, relative to the repository's root, and the line on which the command begins, from 1.
    pub place: String,
    /// The program: `wayword`, `wayword-measure` or `wayword-trials`, however the document starts it.
    pub program: String,
    /// Variables that are set for this command only.
    pub variables: Vec<(String, String)>,
    /// Its arguments.
    pub args: Vec<String>,
    /// Whether it is a code span within a paragraph. There `wayword check` may be a name instead of a command to type.
    pub is_within_text: bool,
}

/// Programs of this repository that documents describe.
const DOCUMENTED_PROGRAMS: [&str; 3] = ["wayword", "wayword-measure", "wayword-trials"];
/// The names of fenced blocks of shell. Blocks without a name are shell as well.
const SHELL_FENCE_NAMES: [&str; 5] = ["", "sh", "bash", "console", "shell"];

/// The commands of `README.md` and of `docs/*.md`, the README's first, then document by document.
///
/// # Errors
/// When a document cannot be read.
pub fn documented_commands(repository: &Path) -> io::Result<Vec<DocumentedCommand>> {
    let docs =
        fs::read_dir(repository.join("docs"))?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<PathBuf>>>()?;
    let mut documents: Vec<PathBuf> =
        docs.into_iter().filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    documents.sort();
    documents.insert(0, repository.join("README.md"));
    let mut commands = Vec::new();
    for document in documents {
        let name = document.strip_prefix(repository).unwrap_or(&document).display().to_string();
        commands.extend(commands_in_markdown(&name, &fs::read_to_string(&document)?));
    }
    Ok(commands)
}

/// The commands of one document, in its order. `name` is the document's name in their places.
#[must_use]
pub fn commands_in_markdown(name: &str, markdown: &str) -> Vec<DocumentedCommand> {
    let mut found = Vec::new();
    for MarkdownSnippet { line, text, is_within_text } in find_snippets(markdown) {
        for command in shell::parse_script(&text) {
            if let Some((program, args)) = started_program(&command.words) {
                let place = format!("{name}:{}", line + command.line);
                found.push(DocumentedCommand { place, program, variables: command.variables, args, is_within_text });
            }
        }
    }
    found
}

/// Which of [`DOCUMENTED_PROGRAMS`] a command starts, directly or as `cargo run -p PROGRAM -- ...`, and the program's arguments.
fn started_program(words: &[String]) -> Option<(String, Vec<String>)> {
    let (first, rest) = words.split_first()?;
    if DOCUMENTED_PROGRAMS.contains(&first.as_str()) {
        return Some((first.clone(), rest.to_vec()));
    }
    let is_cargo_run =
        first == "cargo" && rest.first().is_some_and(|word| word == "run") && !rest.contains(&"--example".to_owned());
    let split = rest.iter().position(|word| word == "--").filter(|_| is_cargo_run)?;
    let (cargo, args) = rest.split_at(split);
    let package = cargo.iter().position(|word| word == "-p").and_then(|at| cargo.get(at + 1));
    Some((package.map_or("wayword", String::as_str).to_owned(), args[1..].to_vec()))
}

/// A part of a document that may contain shell commands: the body of a fenced block, or one code span.
struct MarkdownSnippet {
    /// Line on which it begins, from 1.
    line: usize,
    /// The commands as they are written.
    text: String,
    /// Whether it is a code span within a paragraph.
    is_within_text: bool,
}

/// The fenced blocks of shell and the code spans of a document, in order.
fn find_snippets(markdown: &str) -> Vec<MarkdownSnippet> {
    let mut snippets = Vec::new();
    let mut fence: Option<(&str, MarkdownSnippet)> = None;
    let mut paragraph = MarkdownSnippet { line: 1, text: String::new(), is_within_text: true };
    for (number, line) in (1..).zip(markdown.lines()) {
        let marks = line.trim_start();
        match &mut fence {
            Some((_, block)) if marks.starts_with("```") => {
                block.text.push('\n');
                snippets
                    .extend(fence.take().filter(|(name, _)| SHELL_FENCE_NAMES.contains(name)).map(|(_, block)| block));
            }
            Some((name, block)) => {
                // In a console transcript, lines after `$ ` are commands. The other lines are output and become comments.
                let typed = if *name == "console" { marks.strip_prefix("$ ").unwrap_or("#") } else { marks };
                block.text.push_str(typed);
                block.text.push('\n');
            }
            None if marks.starts_with("```") || marks.is_empty() => {
                let next = MarkdownSnippet { line: number + 1, text: String::new(), is_within_text: true };
                snippets.extend(code_spans(&std::mem::replace(&mut paragraph, next)));
                let block = MarkdownSnippet { line: number + 1, text: String::new(), is_within_text: false };
                fence = marks.strip_prefix("```").map(|name| (name.trim(), block));
            }
            None => {
                paragraph.text.push_str(line);
                paragraph.text.push('\n');
            }
        }
    }
    snippets.extend(code_spans(&paragraph));
    snippets
}

/// The code spans within a paragraph. A span may continue in the next line.
fn code_spans(paragraph: &MarkdownSnippet) -> Vec<MarkdownSnippet> {
    let mut line = paragraph.line;
    let mut found = Vec::new();
    for (number, text) in paragraph.text.split('`').enumerate() {
        if number % 2 == 1 {
            found.push(MarkdownSnippet {
                line,
                text: text.replace('\n', " ").replace("\\|", "|"),
                is_within_text: true,
            });
        }
        line += text.matches('\n').count();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCUMENT: &str = "\
# A document

Type `wayword check FILE`, or `wayword
evaluate SUBMISSION` behind it.

```sh
# how to begin
cargo run --release --features full -- generate --paths 3 \\
    --out 'my runs'
OFFLINE=1 wayword demo && ls
cargo run -p wayword-live --example stand_in -- tdw
```

| what | command |
|---|---|
| skeletons | `cargo run --release -p wayword-measure -- variety runs/a` |

```toml
command = \"wayword demo\"
```

```console
$ wayword doctor
wayword is well
```
";

    #[test]
    fn commands_in_markdown_reads_shell_fences_tables_and_wrapped_text() {
        let found: Vec<String> = commands_in_markdown("A.md", DOCUMENT)
            .into_iter()
            .map(|found| format!("{} {} {:?} {}", found.place, found.program, found.args, found.is_within_text))
            .collect();
        assert_eq!(
            found,
            [
                "A.md:3 wayword [\"check\", \"FILE\"] true",
                "A.md:3 wayword [\"evaluate\", \"SUBMISSION\"] true",
                "A.md:8 wayword [\"generate\", \"--paths\", \"3\", \"--out\", \"my runs\"] false",
                "A.md:10 wayword [\"demo\"] false",
                "A.md:16 wayword-measure [\"variety\", \"runs/a\"] true",
                "A.md:23 wayword [\"doctor\"] false",
            ]
        );
    }

    #[test]
    fn commands_in_markdown_keeps_the_variables_of_a_command() {
        let found = commands_in_markdown("A.md", DOCUMENT);
        assert_eq!(found[3].variables, [("OFFLINE".into(), "1".into())]);
    }
}
