//! How people word a place and a task: constructions of our own, each with the share of texts that use it.
//!
//! The constructions and their built-in shares are in `builtin/place.toml`. For every other style the shares are
//! measured on its references and smoothed with the built-in ones, which decide if the references show too little.

use super::parse_wording;
use crate::weighted_draw::draw_weighted;
use rand_chacha::ChaCha8Rng;
use std::{collections::BTreeMap, sync::LazyLock};
use wayword_core::WordingPolicy;
use wayword_language::lexicon::{ThingClass, affords_task, find_thing, kinds_of};

/// A table of constructions with their shares, or with counts: "go to" has 70, "go into" 2.4.
pub type WordingShares = BTreeMap<String, f64>;

/// Counts of constructions, by table.
#[derive(Default)]
pub(super) struct WordingCounts(pub(super) BTreeMap<String, WordingShares>);

impl WordingCounts {
    /// Counts a construction of a table once.
    pub(super) fn add(&mut self, table: &str, key: &str) {
        *self.0.entry(table.to_owned()).or_default().entry(key.to_owned()).or_default() += 1.0;
    }
}

/// The built-in shares.
static BUILT_IN: LazyLock<PlaceWording> = LazyLock::new(|| PlaceWording { tables: parse_wording() });

/// How a style words a place and a task.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct PlaceWording {
    /// The tables of `builtin/place.toml` by name, with the style's shares.
    pub(super) tables: BTreeMap<String, WordingShares>,
}

/// The built-in shares count as much as this many reference texts.
const PRIOR_TEXTS: f64 = 12.0;

impl PlaceWording {
    /// The built-in shares.
    #[must_use]
    pub fn built_in() -> &'static Self {
        &BUILT_IN
    }

    /// Shares from counts in `texts` references, smoothed by the built-in shares. Tables of verbs and names have counts
    /// instead.
    pub(super) fn from_counts(counts: BTreeMap<String, WordingShares>, texts: f64) -> Self {
        let mut tables = BUILT_IN.tables.clone();
        tables.entry("choice".to_owned()).or_default().remove("idle");
        for (name, shares) in &mut tables {
            let Some(counted) = counts.get(name) else { continue };
            if name == "share" {
                // Each entry of this table is a share of all references.
                for (key, share) in shares.iter_mut() {
                    let seen = counted.get(key).copied().unwrap_or_default();
                    *share = (seen + PRIOR_TEXTS * *share) / (texts + PRIOR_TEXTS);
                }
                continue;
            }
            let all: f64 = counted.values().sum();
            let built_in: f64 = shares.values().sum::<f64>().max(1e-9);
            for (key, share) in shares.iter_mut() {
                let seen = counted.get(key).copied().unwrap_or_default();
                *share = (seen + PRIOR_TEXTS * *share / built_in) / (all + PRIOR_TEXTS);
            }
        }
        for (name, counted) in counts {
            if name.starts_with(VERB_TABLE_PREFIX) || name.starts_with(NAME_TABLE_PREFIX) {
                let known = tables.entry(name).or_default();
                let all: f64 = known.values().sum::<f64>().max(1.0);
                known.values_mut().for_each(|share| *share *= PRIOR_TEXTS / all);
                counted.into_iter().for_each(|(key, count)| *known.entry(key).or_default() += count);
            }
        }
        Self { tables }
    }

    /// The share of texts that have a property, from 0 to 1.
    #[must_use]
    pub fn share_of_texts(&self, name: &str) -> f64 {
        let share = self.tables.get("share").and_then(|shares| shares.get(name)).copied();
        share.unwrap_or_default().clamp(0.0, 1.0)
    }

    /// Applies the choices of a style, which override those of the built-in wording.
    pub(super) fn apply_choice(&mut self, choice: WordingPolicy) {
        let table = self.tables.entry("choice".to_owned()).or_default();
        for (name, chosen) in [("sure", choice.sure), ("sharp", choice.sharp)] {
            table.extend(chosen.map(|value| (name.to_owned(), value)));
        }
    }

    /// A number of the table of choices; 1 where it has none of that name.
    fn choice(&self, name: &str) -> f64 {
        self.table("choice").get(name).copied().unwrap_or(1.0)
    }

    /// The exponent of shares in [`Self::draw_sharply`]. Over 1, frequent constructions are drawn even more often than
    /// people use them.
    #[must_use]
    pub fn sharp_power(&self) -> f64 {
        self.choice("sharp").clamp(0.0, MAX_SHARP_POWER)
    }

    /// The share of texts in which the target has to be singled out, if that is possible. The other texts mention as
    /// much as people do.
    #[must_use]
    pub fn sure_share(&self) -> f64 {
        self.choice("sure").clamp(0.0, 1.0)
    }

    /// How often a property that need not be told is told, relative to people.
    #[must_use]
    pub fn idle_factor(&self) -> f64 {
        self.choice("idle").clamp(0.0, 1.0)
    }

    /// The constructions of a table with their shares.
    #[must_use]
    pub fn table(&self, name: &str) -> &WordingShares {
        static NO_SHARES: WordingShares = WordingShares::new();
        self.tables.get(name).unwrap_or(&NO_SHARES)
    }

    /// Draws a construction of a table with [`Self::sharp_power`] of its share as weight, among those that `is_allowed`
    /// accepts.
    pub fn draw_sharply<'a>(
        &'a self,
        name: &str,
        rng: &mut ChaCha8Rng,
        is_allowed: impl Fn(&str) -> bool,
    ) -> Option<&'a str> {
        let options = self.table(name).iter().filter(|(key, _)| is_allowed(key));
        draw_by_share(options.map(|(key, share)| (key.as_str(), share.powf(self.sharp_power()))), rng)
    }

    /// Draws a construction of a table with its share as weight, among those that `is_allowed` accepts.
    pub fn draw<'a>(&'a self, name: &str, rng: &mut ChaCha8Rng, is_allowed: impl Fn(&str) -> bool) -> Option<&'a str> {
        let options = self.table(name).iter().filter(|(key, _)| is_allowed(key));
        draw_by_share(options.map(|(key, share)| (key.as_str(), *share)), rng)
    }

    /// Draws a verb for a thing, with `{o}` in place of the thing. `sharp` over 1 prefers frequent verbs.
    pub fn draw_verb(&self, name: &str, sharp: f64, rng: &mut ChaCha8Rng) -> &str {
        let own = self.verbs_of(name);
        draw_by_share(own.into_iter().map(|(key, count)| (key, count.powf(sharp))), rng).unwrap_or("look at {o}")
    }

    /// The verbs for a thing with their counts: those for its own kind, and, if these are few, also those for its more
    /// general kinds and its class that one can do with it.
    fn verbs_of(&self, name: &str) -> Vec<(&str, f64)> {
        let mut found: BTreeMap<&str, f64> = BTreeMap::new();
        let mut tasks = 0.0;
        let class = find_thing(name).map_or(ThingClass::Unknown, |thing| thing.class);
        let tables = kinds_of(name).into_iter().map(|kind| verbs_of_kind(&kind)).chain([verbs_of_class(class)]);
        for table in tables {
            let shares = self.table(&table);
            let all: f64 = shares.values().sum();
            // More general tables only fill up to a sufficient number.
            let weight = if tasks >= ENOUGH_TASKS { break } else { (ENOUGH_TASKS - tasks) / all.max(ENOUGH_TASKS) };
            let weight = if tasks == 0.0 { 1.0 } else { weight };
            for (key, count) in shares.iter().filter(|(key, _)| affords_task(key, name)) {
                *found.entry(key).or_default() += count * weight;
            }
            tasks += all * weight;
        }
        // "Wipe down the stairs" reads as a climb.
        let climbs = |verb: &str| verb.split(' ').any(|word| matches!(word, "up" | "down"));
        found.retain(|verb, _| class != ThingClass::Stairs || !climbs(verb));
        found.into_iter().collect()
    }

    /// Draws the word for a room or a thing, by how often people use it.
    pub fn draw_name<'a>(&'a self, name: &'a str, rng: &mut ChaCha8Rng) -> &'a str {
        draw_by_share(
            self.table(&format!("{NAME_TABLE_PREFIX}{name}")).iter().map(|(key, share)| (key.as_str(), *share)),
            rng,
        )
        .unwrap_or(name)
    }
}

/// The greatest exponent that a style may choose.
pub(super) const MAX_SHARP_POWER: f64 = 10.0;
/// The prefix of the tables of verbs, before the name of a kind or a class.
pub(super) const VERB_TABLE_PREFIX: &str = "do ";
/// The prefix of the tables of words for rooms and things.
pub(super) const NAME_TABLE_PREFIX: &str = "call ";
/// This many tasks on one kind of thing suffice to know what people do with it.
const ENOUGH_TASKS: f64 = 30.0;

/// The table of verbs of a kind of thing.
pub(super) fn verbs_of_kind(kind: &str) -> String {
    format!("{VERB_TABLE_PREFIX}{kind}")
}

/// The table of verbs of a class.
pub(super) fn verbs_of_class(class: ThingClass) -> String {
    format!("{VERB_TABLE_PREFIX}class {class:?}").to_lowercase()
}

/// Draws one of the options with its share as weight; `None` if no option has a share over 0.
fn draw_by_share<'a>(options: impl Iterator<Item = (&'a str, f64)>, rng: &mut ChaCha8Rng) -> Option<&'a str> {
    let options: Vec<(&str, f64)> = options.filter(|(_, share)| *share > 0.0).collect();
    let shares: Vec<f64> = options.iter().map(|(_, share)| *share).collect();
    draw_weighted(&shares, rng).map(|at| options[at].0)
}
