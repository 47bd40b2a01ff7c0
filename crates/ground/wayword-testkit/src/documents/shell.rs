//! A small parser for the shell syntax that our documents use: words, quotes, continued lines, lists and pipes, redirections,
//! and variables before a command.

/// One simple command in the sense of a shell: a program with its arguments, between `;`, `|`, `&&` and line ends.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ShellCommand {
    /// Line of the text, from 0, on which it begins.
    pub(super) line: usize,
    /// Variables that are set for this command only.
    pub(super) variables: Vec<(String, String)>,
    /// The program and its arguments, without quotes and redirections.
    pub(super) words: Vec<String>,
}

/// The simple commands of a script, in order. Variables (`$NAME`) stay as they are written.
pub(super) fn parse_script(script: &str) -> Vec<ShellCommand> {
    let mut reader = ShellScriptReader::default();
    let mut chars = script.chars().peekable();
    while let Some(c) = chars.next() {
        match (reader.quote, c) {
            (None, '\\') => match chars.next() {
                Some('\n') => reader.line += 1,
                Some(other) => reader.add_char(other),
                None => {}
            },
            (Some('"'), '\\') if matches!(chars.peek(), Some('"' | '\\' | '$')) => {
                reader.add_char(chars.next().unwrap_or('\\'));
            }
            (None, '\'' | '"') => {
                reader.quote = Some(c);
                reader.word.get_or_insert_default();
            }
            (Some(open), c) if open == c => reader.quote = None,
            (None, '#') if reader.word.is_none() => while chars.next_if(|c| *c != '\n').is_some() {},
            (None, '>' | '<') => {
                reader.start_redirection();
                // `2>&1` is one redirection: its `&` does not end a command.
                chars.next_if_eq(&'&');
            }
            (None, '\n' | ';' | '|' | '&') => {
                reader.end_command();
                reader.line += usize::from(c == '\n');
            }
            (None, c) if c.is_whitespace() => reader.end_word(),
            (_, c) => {
                reader.line += usize::from(c == '\n');
                reader.add_char(c);
            }
        }
    }
    reader.end_command();
    reader.done
}

/// The state of the parser between two characters.
#[derive(Default)]
struct ShellScriptReader {
    /// The current line, from 0.
    line: usize,
    /// The quotation mark that is open.
    quote: Option<char>,
    /// The word so far; `None` between words.
    word: Option<String>,
    /// Whether the next word is a file that is read or written, and not an argument.
    is_redirected: bool,
    /// The words of the current command.
    command_words: Vec<String>,
    /// The line on which the current command began.
    begun: Option<usize>,
    /// The commands that have ended.
    done: Vec<ShellCommand>,
}

impl ShellScriptReader {
    /// Adds a character to the current word.
    fn add_char(&mut self, c: char) {
        self.begun.get_or_insert(self.line);
        self.word.get_or_insert_default().push(c);
    }

    /// Begins a redirection, as `2>` or `>`. The number of a stream before it is not an argument, so it is dropped.
    fn start_redirection(&mut self) {
        if self.word.as_ref().is_some_and(|word| word.chars().all(|c| c.is_ascii_digit())) {
            self.word = None;
        }
        self.end_word();
        self.is_redirected = true;
    }

    /// Ends the current word, if there is one. The file of a redirection is dropped.
    fn end_word(&mut self) {
        if let Some(word) = self.word.take()
            && !std::mem::take(&mut self.is_redirected)
        {
            self.command_words.push(word);
        }
    }

    /// Ends the current command, if it has words besides variables.
    fn end_command(&mut self) {
        self.end_word();
        self.is_redirected = false;
        let line = self.begun.take().unwrap_or(self.line);
        let mut words = std::mem::take(&mut self.command_words);
        let variable_count = words.iter().take_while(|word| parse_assignment(word).is_some()).count();
        let variables = words.drain(..variable_count).filter_map(|word| parse_assignment(&word)).collect();
        if !words.is_empty() {
            self.done.push(ShellCommand { line, variables, words });
        }
    }
}

/// The name and the value of an assignment, `NAME=value`.
fn parse_assignment(word: &str) -> Option<(String, String)> {
    let (name, value) = word.split_once('=')?;
    let is_name = !name.is_empty() && name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    is_name.then(|| (name.to_owned(), value.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(script: &str) -> Vec<Vec<String>> {
        parse_script(script).into_iter().map(|command| command.words).collect()
    }

    #[test]
    fn words_are_split_as_a_shell_splits_them() {
        assert_eq!(words("a 'b c' \"d \\\" e\" f\\ g h#i # j"), [["a", "b c", "d \" e", "f g", "h#i"]]);
        assert_eq!(words("a --x '' b"), [["a", "--x", "", "b"]]);
    }

    #[test]
    fn a_line_goes_on_behind_a_backslash_and_ends_a_command_without() {
        let found = parse_script("# a comment\nfirst --one \\\n    --two\nsecond\n");
        assert_eq!(found.iter().map(|one| one.words.join(" ")).collect::<Vec<_>>(), ["first --one --two", "second"]);
        assert_eq!(found.iter().map(|one| one.line).collect::<Vec<_>>(), [1, 3]);
    }

    #[test]
    fn pipes_and_lists_hold_several_commands_and_redirections_are_no_arguments() {
        assert_eq!(
            words("a x | b > out.txt && c 2>&1; d < in >> log"),
            [vec!["a", "x"], vec!["b"], vec!["c"], vec!["d"]]
        );
    }

    #[test]
    fn commands_separate_variables_from_words() {
        let found = parse_script("OFFLINE=1 NAME='x y' run --at=2");
        assert_eq!(found[0].variables, [("OFFLINE".into(), "1".into()), ("NAME".into(), "x y".into())]);
        assert_eq!(found[0].words, ["run", "--at=2"]);
        assert_eq!(
            parse_script("export KEY=..."),
            [ShellCommand { line: 0, variables: vec![], words: vec!["export".into(), "KEY=...".into()] }]
        );
    }
}
