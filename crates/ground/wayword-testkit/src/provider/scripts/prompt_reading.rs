//! Extracts from prompts what the scripts need: questions with answers, names of things, rooms.

/// The questions and answers of a transcript.
pub(super) fn read_exchanges(prompt: &str) -> Vec<(&str, &str)> {
    let mut exchanges: Vec<(&str, &str)> = Vec::new();
    for line in prompt.lines() {
        if let Some(question) = line.strip_prefix("Question: ") {
            exchanges.push((question, ""));
        } else if let (Some(answer), Some(last)) = (line.strip_prefix("Answer: "), exchanges.last_mut()) {
            last.1 = answer;
        }
    }
    exchanges
}

/// The things that a text names after "a" or "an", each once.
pub(super) fn named_things(text: &str) -> Vec<String> {
    const NAME_END_WORDS: [&str; 16] = [
        "on", "in", "and", "with", "to", "of", "at", "by", "it", "next", "beside", "near", "under", "above", "is",
        "there",
    ];
    let words: Vec<&str> = text.split_whitespace().collect();
    let mut things: Vec<String> = Vec::new();
    let mut at = 0;
    while at < words.len() {
        let is_article = matches!(words[at].to_lowercase().as_str(), "a" | "an");
        at += 1;
        if !is_article {
            continue;
        }
        let mut name: Vec<&str> = Vec::new();
        while at < words.len() && !NAME_END_WORDS.contains(&words[at]) && name.len() < 4 {
            let is_last_word = words[at].ends_with([',', '.']);
            name.push(words[at].trim_end_matches([',', '.']));
            at += 1;
            if is_last_word {
                break;
            }
        }
        let name = name.join(" ");
        if !name.is_empty() && !things.contains(&name) {
            things.push(name);
        }
    }
    things
}

/// Whether an answer begins with "no".
pub(super) fn is_denial(answer: &str) -> bool {
    answer.to_lowercase().starts_with("no")
}

/// The room that a transcript names.
pub(super) fn named_room<'a>(exchanges: &[(&str, &'a str)]) -> Option<&'a str> {
    let (_, answer) =
        exchanges.iter().find(|(question, answer)| question.contains("room") && answer.starts_with("This is a "))?;
    Some(answer.trim_start_matches("This is a ").trim_end_matches('.'))
}

/// A name with its article.
pub(super) fn with_article(name: &str) -> String {
    if name.starts_with(['a', 'e', 'i', 'o', 'u']) { format!("an {name}") } else { format!("a {name}") }
}

/// Joins items as in "a, b and c".
pub(super) fn join_with_and(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [only] => only.clone(),
        [before @ .., last] => format!("{} and {last}", before.join(", ")),
    }
}

/// Summarises the views of a panorama in one sentence that names its first four things.
pub(super) fn condense_panorama(prompt: &str) -> String {
    let sightings =
        prompt.split("It sees:").nth(1).and_then(|rest| rest.split("Describe the place").next()).unwrap_or_default();
    let items: Vec<String> = named_things(sightings).iter().take(4).map(|name| with_article(name)).collect();
    if items.is_empty() { "A place.".to_owned() } else { format!("A place with {}.", join_with_and(&items)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_where_their_places_begin() {
        let text = "I can see a coffee table on the left, an oven in the middle and a lamp.";
        assert_eq!(named_things(text), ["coffee table", "oven", "lamp"]);
        assert_eq!(named_things("A bedroom with a bed and two lamps."), ["bedroom", "bed"]);
    }
}
