//! How a text came about, what it cost and what it may mean, in words.

use wayword_core::{ChosenBy, Instruction, RefinedRound, TextProvenance, TextSelection};
use wayword_run::{count::count_phrase, run_folder::TextCost};

/// The possible meanings of an instruction, if there are several, and the thing by which its own end differs from the others.
pub(super) fn describe_ambiguity(instruction: &Instruction) -> Option<String> {
    let ambiguity = instruction.ambiguity.as_ref()?;
    let meanings = ambiguity.to_sentence()?;
    Some(match &ambiguity.told_apart_by {
        Some(by) => format!("{meanings}; only at its own end there is: {by}"),
        None => meanings,
    })
}

/// What a text cost, in words.
pub(super) fn cost_words(cost: &TextCost) -> String {
    let TextCost { cost_usd, calls, tokens_in, tokens_out, drafts } = cost;
    let usd = cost_usd.map_or_else(|| "price not known".to_owned(), |usd| format!("${usd:.4}"));
    let (calls, drafts) = (count_phrase(*calls, "call"), count_phrase(*drafts, "text"));
    format!("cost of this text: {usd}, {calls}, {drafts} written, {tokens_in} tokens in, {tokens_out} out")
}

/// What a round of writing again gained.
pub(super) fn describe_round(round: &RefinedRound) -> String {
    let percent = |share: f64| format!("{:.0} %", 100.0 * share);
    let before = percent(round.before);
    match (round.after, round.kept) {
        (Some(after), true) => {
            format!("a follower arrived with {before}, by the text written again with {}", percent(after))
        }
        (Some(after), false) => {
            format!("a follower arrives with {before}; the text written again had {} and was not kept", percent(after))
        }
        (None, _) => format!("a follower arrives with {before}; the text written again failed its checks"),
    }
}

pub(super) fn describe_provenance(provenance: &TextProvenance) -> String {
    let TextProvenance { wayword, asker, answerer, summariser, writer, checked_against, seed, style_hash, .. } =
        provenance;
    let repairs = match provenance.repairs {
        0 => "at the first attempt".to_owned(),
        1 => "after 1 repair".to_owned(),
        more => format!("after {more} repairs"),
    };
    let after = provenance.finished_for.as_ref().map_or_else(String::new, |first| format!(" after {first} had failed"));
    let chosen = provenance.chosen.as_ref().map_or_else(String::new, describe_choice);
    let prompts = provenance.prompts_hash.as_ref().map_or_else(String::new, |hash| format!(", prompts {hash}"));
    format!(
        "Wayword {wayword}: {asker} asked, {answerer} answered, {summariser} summarised, {writer} wrote{after}, {repairs}{chosen}; \
         checked against {checked_against}; seed {seed}, style {style_hash}{prompts}"
    )
}

fn describe_choice(chosen: &TextSelection) -> String {
    let by = match chosen.by {
        ChosenBy::Follower => "by the follower",
        ChosenBy::Checks => "by the checks alone",
    };
    format!(", chosen among {} texts ({} passed) {by}", chosen.among, chosen.passed)
}
