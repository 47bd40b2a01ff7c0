//! Abbreviations: words that keep the full stop after them. The lists were made by giving the reference tokenizer every word of up to
//! four letters, and a list of longer ones.

/// Abbreviations in small or capital letters, as `dr.` and `Dr.`.
const ABBREVIATIONS_IN_ANY_CASE: &str = "\
al cf co ct dr ft ga jr ky lt md mo mr ms mt ph rd rt sq sr st va vs vt wm \
adj adm adv ala apr aug ave bhd cie col cos cpl dak dec det drs ens esq est etc ext feb fla fri gen gov hon inc ind \
jan jos jul jun kan ltd maj mar mme mon mrs neb nev nov oct pfc plc pvt rep rev sen sep seq sfc sgt spc ste \
sys tel thu tue wed wis wyo \
alex ariz assn asst atty bldg blvd brig bros capt cmdr colo conn corp dept elec govs insp intl invt kans mich minn \
mlle mont msgr natl okla penn pres prof reps sens sept supt tenn tues univ wisc \
assoc attys calif comdr lieut messrs profs supts thurs treas";

/// Abbreviations only with a capital, because the words also mean something else, as `Miss.` and `miss.`
const CAPITALISED_ABBREVIATIONS: &str = "Az La Pa Ark Del Ill Ore Tex Mass Miss Wash";

/// Abbreviations unless all letters are capitals.
const NOT_IN_CAPITALS: &str = "mfg mtg pte pty ppte ppty ptes ptys";

/// Abbreviations that often end a sentence. They keep the full stop even if a letter follows it directly.
const SENTENCE_ENDING_ABBREVIATIONS: &str = "\
al co ct ga jr ky md mo rd rt sq sr va vt ala apr aug bhd cos dak dec esq est etc ext feb fla fri inc ind jan jul jun \
kan ltd mar mon neb nev nov oct plc sep seq sys tel thu tue wed wis wyo ariz assn bldg blvd bros colo conn corp intl \
kans mich minn mont okla penn sept tenn tues univ wisc calif thurs az la pa ark del ill ore tex mass miss wash \
pte pty ppte ppty ptes ptys";

/// Abbreviations only before a number, in small or capital letters, as in `No. 5`.
const BEFORE_A_NUMBER: &str = "ca no op pp art fig nos figs prop";

fn list_contains(list: &str, word: &str) -> bool {
    list.split(' ').any(|entry| entry.eq_ignore_ascii_case(word))
}

/// Whether a word is an abbreviation that keeps its full stop in every place.
pub(super) fn is_abbreviation(word: &str) -> bool {
    let is_capitalised = word.starts_with(|c: char| c.is_ascii_uppercase());
    let is_in_capitals = !word.contains(|c: char| c.is_ascii_lowercase());
    list_contains(ABBREVIATIONS_IN_ANY_CASE, word)
        || is_capitalised && list_contains(CAPITALISED_ABBREVIATIONS, word)
        || !is_in_capitals && list_contains(NOT_IN_CAPITALS, word)
}

/// Whether a word is an abbreviation that keeps its full stop even if a letter follows directly, as in `etc.a`.
pub(super) fn often_ends_sentence(word: &str) -> bool {
    is_abbreviation(word) && list_contains(SENTENCE_ENDING_ABBREVIATIONS, word)
}

/// Whether a word is an abbreviation that keeps its full stop before a number.
pub(super) fn is_abbreviation_before_number(word: &str) -> bool {
    list_contains(BEFORE_A_NUMBER, word)
}
