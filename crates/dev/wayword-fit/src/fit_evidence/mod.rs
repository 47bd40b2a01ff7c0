//! Fits the weights that ship with the checks of an open world: if no label confirms a claim of a text, how much does that count
//! against the claim?
//!
//! True claims are those of people's texts. Wrong claims replace their rooms and objects by those of other texts and labels. Ten buildings
//! are left out of the fit, and the results on them are printed.

mod fold;
mod homes;

use crate::matterport::open_matterport;
use fold::{CASE_GROUPS, building_numbers, claims_for_case, failing_miss, fit_tables};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_checks::open::{ClaimCase, SilenceWeights, WeightTable};
use wayword_core::SceneId;
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    people::{ClaimSample, LabelNames, PeopleWalk, left_out, read_people_walks, sample_claims},
    written_files::write_file,
};

/// Rooms in groups of like evidence. Rooms of one group share weights.
const ROOM_GROUPS: [(&str, &[&str]); 7] = [
    ("bath", &["bathroom", "toilet", "spa"]),
    ("fixture", &["bedroom", "kitchen", "laundry room", "garage", "gym"]),
    (
        "sitting",
        &["living room", "family room", "lounge", "tv room", "game room", "dining room", "dining booth", "bar"],
    ),
    ("work", &["office", "library", "meeting room", "classroom", "chapel"]),
    ("storing", &["closet", "utility room"]),
    ("way", &["hallway", "entryway", "stairs"]),
    ("open air", &["porch", "balcony", "outdoor area"]),
];

/// Fits the weights, prints how they do on the buildings that were left out, and writes the file.
///
/// # Errors
/// When the data or the texts cannot be read, or the file cannot be written.
pub fn fit_evidence_weights(
    data: &Path,
    episodes: &Path,
    out: Option<&Path>,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let platform = open_matterport(data)?;
    let (walks, mut surveys) = read_people_walks(platform.as_ref(), episodes)?;
    let scenes: BTreeSet<SceneId> = walks.iter().map(|walk| walk.path.scene.clone()).collect();
    let out_scenes = left_out(&scenes);
    let (apart, fitted): (Vec<&PeopleWalk>, Vec<&PeopleWalk>) =
        walks.iter().partition(|walk| out_scenes.contains(&walk.path.scene));
    let all_labels = LabelNames::from_surveys(surveys.iter());
    surveys.retain(|scene, _| !out_scenes.contains(scene));
    let labels = LabelNames::from_surveys(surveys.iter());
    let mut weights = SilenceWeights {
        room_groups: room_groups(),
        homes: homes::find_homes(surveys.values()),
        cases: BTreeMap::new(),
    };
    let samples = sample_claims(&fitted, &labels, &weights, 0);
    let numbers = building_numbers(fitted.iter().map(|walk| walk.path.scene.as_str()));
    for group in &CASE_GROUPS {
        let tables = fit_tables(&samples, group, &|walk| numbers[walk], count_texts(&fitted));
        weights.cases.extend(tables.into_iter().map(|(case, table)| (case.name().to_owned(), table)));
    }
    let apart_samples = sample_claims(&apart, &all_labels, &weights, 1);
    let names = out_scenes.iter().map(SceneId::as_str).collect::<Vec<_>>().join(" ");
    output.say(format!("left out: {names}"));
    output.print_result(
        &(),
        report_fit(&[("fitted", &fitted, &samples), ("left out", &apart, &apart_samples)], &weights),
    );
    if let Some(out) = out {
        write_file(out, weights_file_text(&weights, episodes))?;
    }
    Ok(())
}

/// [`ROOM_GROUPS`] in the form of the weights file.
fn room_groups() -> BTreeMap<String, BTreeSet<String>> {
    let group =
        |(name, rooms): (&str, &[&str])| (name.to_owned(), rooms.iter().map(|room| (*room).to_owned()).collect());
    ROOM_GROUPS.map(group).into()
}

fn count_texts(walks: &[&PeopleWalk]) -> usize {
    walks.iter().map(|walk| walk.texts.len()).sum()
}

/// A table with a row for each case and part of the buildings (`parts`: name, walks, samples). A row has the share of texts with a
/// true claim that fails, then the shares of wrong claims that fail: where the thing is nowhere in the building (lacking), at
/// least 8 m away, and 3 to 8 m away.
fn report_fit(parts: &[(&str, &Vec<&PeopleWalk>, &Vec<ClaimSample>)], weights: &SilenceWeights) -> String {
    let mut lines = vec![format!(
        "{:<14} {:<9} {:>8} {:>12} {:>18} {:>18} {:>18}",
        "case", "buildings", "fails at", "texts, %", "lacking, %", "8 m off, %", "3 to 8 m off, %"
    )];
    for case in ClaimCase::ALL {
        let Some(WeightTable { fails_at, .. }) = weights.table_for(case) else { continue };
        for (name, walks, samples) in parts {
            let fails = |sample: &&&ClaimSample| {
                let ratio = failing_miss(sample, case).and_then(|missed| weights.log_ratio(missed));
                ratio.is_some_and(|ratio| ratio >= fails_at.ln())
            };
            let case_samples = claims_for_case(samples, case);
            let failing_true = case_samples.iter().filter(|sample| !sample.wrong).filter(fails);
            let failing_texts: BTreeSet<(usize, usize)> =
                failing_true.map(|sample| (sample.walk, sample.text)).collect();
            // The share of wrong claims that fail, where the nearest such thing is `least_m` to `most_m` away; with an infinite
            // `least_m`, where there is no such thing.
            let failing_share = |least_m: f64, most_m: f64| {
                let within = |sample: &&&ClaimSample| {
                    failing_miss(sample, case)
                        .is_some_and(|missed| missed.nearest_m >= least_m && missed.nearest_m < most_m)
                };
                let nowhere = |sample: &&&ClaimSample| {
                    failing_miss(sample, case).is_some_and(|missed| missed.nearest_m.is_infinite())
                };
                let wrong = case_samples.iter().filter(|sample| sample.wrong);
                let wrong: Vec<&&ClaimSample> = if least_m.is_infinite() {
                    wrong.filter(nowhere).collect()
                } else {
                    wrong.filter(within).collect()
                };
                let failing = wrong.iter().copied().filter(|sample| fails(sample)).count();
                format!("{:.1} of {}", 100.0 * failing as f64 / wrong.len().max(1) as f64, wrong.len())
            };
            lines.push(format!(
                "{:<14} {name:<9} {fails_at:>8.1} {:>12.2} {:>18} {:>18} {:>18}",
                case.name(),
                100.0 * failing_texts.len() as f64 / count_texts(walks).max(1) as f64,
                failing_share(f64::INFINITY, f64::INFINITY),
                failing_share(8.0, f64::INFINITY),
                failing_share(3.0, 8.0),
            ));
        }
    }
    lines.join("\n")
}

/// The text of the weights file that ships, with its explanation.
fn weights_file_text(weights: &SilenceWeights, episodes: &Path) -> String {
    let episodes = episodes.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let budgets = CASE_GROUPS.map(|group| format!("{} {:.2} %", group.name, 100.0 * group.budget)).join(", ");
    let head = format!(
        "# How much the silence of labels says about a claim, by class of object and group of rooms.
# Fitted by `wayword-measure fit-evidence --data DIR --episodes {episodes} --out weights.toml` on people's texts and
# Matterport3D's and REVERIE's labels, without the file's last ten buildings by name.
# The sum of a claim's weights is the logarithm of a likelihood ratio: how much likelier the evidence is if the claim is
# wrong than if it is true. A claim fails from `fails_at` on. That is where buildings left out in turn fail this share of
# people's texts: {budgets}.
# No text, and no rate by the name of an object or a building, is in here.

"
    );
    head + &toml::to_string(weights).unwrap_or_default()
}
