//! GGUF files: small instruct models. This program does not run them. Its error shows how to start a server with the file, and
//! the name of the model then.
//!
//! Why not: candle, the library that runs models in process, reads the format, but the rest (positions, tokenizers,
//! templates, sampling) took over a thousand lines, and was slower than llama.cpp with the same file.

use crate::{error::CommandError, settings::is_in_process};
use std::{borrow::Cow, path::Path};

/// Longest tag that Ollama takes, characters. No Ollama command is shown for a longer file name, and aliases are cut to
/// this.
const MAX_TAG_CHARS: usize = 80;

/// The error for a model in process that is named by a GGUF file; `None` for any other name.
pub(super) fn refuse_gguf(name: &str) -> Option<CommandError> {
    let rest = name.strip_prefix("hf/").filter(|_| is_in_process(name))?;
    Path::new(rest).extension().filter(|ending| ending.eq_ignore_ascii_case("gguf"))?;
    let is_path = rest.starts_with(['/', '.']);
    let servers = match rest.split_once(':').filter(|_| !is_path) {
        Some((repo, file)) => hub_file_commands(repo.split_once('@').map_or(repo, |(repo, _)| repo), file),
        None => local_file_commands(rest),
    };
    let problem = format!("{name:?} is a GGUF file, and this program runs no GGUF files in process");
    Some(CommandError::usage(
        problem,
        format!("start it in one of these servers, and pass the model name given for it:{servers}"),
    ))
}

/// The commands for a file of a repository on Hugging Face, which both servers fetch by themselves.
fn hub_file_commands(repo: &str, file: &str) -> String {
    let alias = model_alias(file);
    let mut servers = String::new();
    // Ollama takes no tag that has to be escaped, or that names a file in a folder.
    if file.len() <= MAX_TAG_CHARS && file.chars().all(is_plain) {
        servers =
            server_line("Ollama", &format!("ollama run hf.co/{repo}:{file}"), &format!("ollama/hf.co/{repo}:{file}"));
    }
    let start_command = format!("llama-server -hf {repo} -hff {} --alias {alias}", quote_for_shell(file));
    servers + &server_line("llama.cpp", &start_command, &format!("llamacpp/{alias}"))
}

/// The commands for a file on this machine.
fn local_file_commands(path: &str) -> String {
    let (alias, path) = (model_alias(path), quote_for_shell(path));
    let create_command = format!("echo FROM {path} > {alias}.Modelfile && ollama create {alias} -f {alias}.Modelfile");
    let start_command = format!("llama-server -m {path} --alias {alias}");
    server_line("Ollama", &create_command, &format!("ollama/{alias}"))
        + &server_line("llama.cpp", &start_command, &format!("llamacpp/{alias}"))
}

/// A line of the hint: the command that starts the model in a server, and the name of the model then.
fn server_line(server: &str, command: &str, name: &str) -> String {
    format!("\n  {server}: `{command}`, then name the model {name}")
}

/// The name of a model, made from its file's name.
fn model_alias(file: &str) -> String {
    let stem = Path::new(file).file_stem().unwrap_or_default().to_string_lossy();
    stem.chars().map(|c| if is_plain(c) { c } else { '-' }).take(MAX_TAG_CHARS).collect()
}

fn is_plain(c: char) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.')
}

/// Quoted so that a shell takes it for one word.
fn quote_for_shell(word: &str) -> Cow<'_, str> {
    if word.chars().all(|c| is_plain(c) || c == '/') {
        return Cow::Borrowed(word);
    }
    Cow::Owned(format!("'{}'", word.replace('\'', r"'\''")))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The hint's lines for a name.
    fn told(name: &str) -> Vec<String> {
        let error = refuse_gguf(name).unwrap().to_string();
        let (problem, hint) = error.split_once("\nhint: ").unwrap();
        assert!(problem.contains(name), "{problem}");
        hint.lines().skip(1).map(|line| line.trim().to_owned()).collect()
    }

    #[test]
    fn a_file_of_the_hub_is_fetched_by_either_server() {
        for name in
            ["hf/Qwen/Qwen3-1.7B-GGUF:Qwen3-1.7B-Q8_0.gguf", "hf/Qwen/Qwen3-1.7B-GGUF@main:Qwen3-1.7B-Q8_0.gguf"]
        {
            assert_eq!(
                told(name),
                [
                    "Ollama: `ollama run hf.co/Qwen/Qwen3-1.7B-GGUF:Qwen3-1.7B-Q8_0.gguf`, then name the model \
                     ollama/hf.co/Qwen/Qwen3-1.7B-GGUF:Qwen3-1.7B-Q8_0.gguf",
                    "llama.cpp: `llama-server -hf Qwen/Qwen3-1.7B-GGUF -hff Qwen3-1.7B-Q8_0.gguf --alias Qwen3-1.7B-Q8_0`, \
                     then name the model llamacpp/Qwen3-1.7B-Q8_0",
                ]
            );
        }
    }

    #[test]
    fn a_file_that_no_ollama_tag_can_name_is_left_to_llama_cpp() {
        assert_eq!(
            told("hf/org/name:q4/it's(x).gguf"),
            [
                r"llama.cpp: `llama-server -hf org/name -hff 'q4/it'\''s(x).gguf' --alias it-s-x-`, then name the model llamacpp/it-s-x-"
            ]
        );
    }

    #[test]
    fn a_file_on_this_machine_is_named_by_its_path() {
        assert_eq!(
            told("hf/./my models/a:b.gguf"),
            [
                "Ollama: `echo FROM './my models/a:b.gguf' > a-b.Modelfile && ollama create a-b -f a-b.Modelfile`, then name the model \
                 ollama/a-b",
                "llama.cpp: `llama-server -m './my models/a:b.gguf' --alias a-b`, then name the model llamacpp/a-b",
            ]
        );
        assert!(told("hf//models/x.GGUF")[1].contains("-m /models/x.GGUF --alias x`"));
    }
}
