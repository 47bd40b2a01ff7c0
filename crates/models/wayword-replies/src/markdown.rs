//! Takes the formatting of documents off a text: lists, headings, quotes, emphasis, links, entities.

/// The lines of a text as one line: list items and quotes become sentences, headings before a text are left out.
pub(crate) fn join_lines(text: &str) -> String {
    let text = text.replace("\\n", "\n").replace("\r", "\n");
    let text = without_line_breaks_of_pages(&text);
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| line.contains(char::is_alphanumeric)).collect();
    let mut sentences: Vec<String> = Vec::new();
    let headings = lines.iter().take_while(|line| line.starts_with('#')).count();
    let begin = if headings < lines.len() { headings } else { 0 };
    for line in &lines[begin..] {
        let (content, is_item) = list_item(line.trim_start_matches(['>', ' ', '#']));
        let content = content.trim();
        let ends = content.ends_with(['.', '!', '?', ',', ':', ';', '"', '”', '*', '_']);
        sentences.push(if is_item && !ends { format!("{content}.") } else { content.to_owned() });
    }
    sentences.join(" ").split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A text with line breaks in place of `<br>`.
fn without_line_breaks_of_pages(text: &str) -> String {
    ["<br>", "<br/>", "<br />", "<BR>"].iter().fold(text.to_owned(), |text, mark| text.replace(mark, "\n"))
}

/// A line without the sign or number of a list before it, and whether there was one.
fn list_item(line: &str) -> (&str, bool) {
    let line = line.trim_start();
    if let Some(rest) = line.strip_prefix(['-', '•', '*', '–', '·', '+']).filter(|rest| rest.starts_with([' ', '\t']))
    {
        return (rest, true);
    }
    let numbered = line.get(..5).filter(|begin| begin.eq_ignore_ascii_case("step ")).map_or(line, |_| &line[5..]);
    let digits = numbered.len() - numbered.trim_start_matches(|c: char| c.is_ascii_digit()).len();
    let rest = numbered[digits..].strip_prefix(['.', ')', ':']);
    match rest.filter(|rest| (1..=2).contains(&digits) && rest.starts_with(' ')) {
        Some(rest) => (rest, true),
        None => (line, false),
    }
}

/// Entities of pages, and what they stand for.
const ENTITIES: [(&str, &str); 10] = [
    ("&amp;", "&"),
    ("&quot;", "\""),
    ("&#39;", "'"),
    ("&apos;", "'"),
    ("&rsquo;", "'"),
    ("&nbsp;", " "),
    ("&#46;", "."),
    ("&lt;", "<"),
    ("&gt;", ">"),
    ("&mdash;", "—"),
];

/// A line without emphasis, code marks, links, entities, remarks in brackets, and pictures before and behind it.
pub(crate) fn without_inline_marks(line: &str) -> String {
    let line = ENTITIES.iter().fold(line.to_owned(), |line, (entity, sign)| line.replace(entity, sign));
    let line = without_links(&line).replace('`', "");
    let line = without_emphasis(&line);
    let belongs = |c: char| c.is_alphanumeric() || "\"“'‘(«„.!?。！？)”’»<>[]{}|\\#*".contains(c);
    without_remark(line.trim_matches(|c: char| !belongs(c))).to_owned()
}

/// A text without the count of its words in square brackets behind it.
fn without_remark(text: &str) -> &str {
    let remark = text.rfind('[').filter(|_| text.ends_with(']'));
    let counts = |remark: &str| remark.contains(|c: char| c.is_ascii_digit()) && remark.to_lowercase().contains("word");
    remark.filter(|at| counts(&text[*at..])).map_or(text, |at| text[..at].trim_end())
}

/// Links in a text, `[words](address)`, as their words alone.
fn without_links(text: &str) -> String {
    let (mut kept, mut rest) = (String::new(), text);
    while let Some(open) = rest.find('[') {
        let link = rest[open..].find("](").map(|middle| open + middle);
        let end = link.and_then(|middle| Some((middle, middle + rest[middle..].find(')')?)));
        let Some((middle, end)) = end.filter(|(middle, _)| !rest[open + 1..*middle].contains(['[', ']'])) else {
            break;
        };
        kept.push_str(&rest[..open]);
        kept.push_str(&rest[open + 1..middle]);
        rest = &rest[end + 1..];
    }
    kept + rest
}

/// A text without the stars and underscores of emphasis: those at the beginning or the end of a word.
fn without_emphasis(text: &str) -> String {
    let is_mark = |c: char| c == '*' || c == '_' || c == '~' || c == '$';
    let bare = |word: &str| {
        let inner = word.trim_matches(is_mark);
        // A mark may stand before the full stop: "the *table*."
        let end = inner.trim_end_matches(['.', ',', '!', '?', ';', ':']);
        format!("{}{}", end.trim_end_matches(is_mark), &inner[end.len()..])
    };
    text.split(' ').map(bare).collect::<Vec<_>>().join(" ").trim().to_owned()
}
