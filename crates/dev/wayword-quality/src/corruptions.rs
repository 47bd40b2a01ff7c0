//! Corrupts good instructions of runs and counts how many of the corruptions the checks catch.

use crate::corrupt::{InstructionCorruption, corrupt_instruction};
use rand::seq::IndexedRandom;
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_checks::{CheckSubject, Evidence, check_text};
use wayword_core::{InstructionStyle, Platform, SceneId, Verdict, seeded_rng};
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_language::lexicon::find_thing;
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    pipeline::path_panoramas,
    platforms::{self, RememberingPlatform},
    run_folder::{file, read_run_settings},
    styles,
};

/// The records of a run that passed, with everything that checking them again needs.
struct LabelledRun {
    /// The styles of the run.
    styles: Vec<InstructionStyle>,
    /// The records that passed.
    records: Vec<InstructionRecord>,
    /// The evidence from labels, by the path's id.
    evidence: BTreeMap<String, Evidence>,
    /// The names of the things along the paths of each scene.
    names: BTreeMap<SceneId, BTreeSet<String>>,
}

/// Corrupts good instructions of runs `count` times, and prints how many corruptions of each kind the checks catch.
///
/// # Errors
/// When a run or its platform cannot be read.
pub fn measure_corruptions(
    folders: &[PathBuf],
    count: usize,
    seed: u64,
    show: usize,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let runs = folders.iter().map(|folder| open_run(folder, output)).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<(&LabelledRun, &InstructionRecord)> =
        runs.iter().flat_map(|run| run.records.iter().map(move |record| (run, record))).collect();
    let (counts, missed) = count_caught(&all, count, seed);
    for line in missed.iter().take(show) {
        output.say(line);
    }
    output.print_result(&(), catch_table(&counts));
    Ok(())
}

/// For each kind of corruption: how many the checks caught, and how many there were.
type CatchCounts = BTreeMap<InstructionCorruption, (usize, usize)>;

/// Makes the same number of corruptions of each kind and checks them. Also returns a line for each one that the checks missed.
fn count_caught(all: &[(&LabelledRun, &InstructionRecord)], count: usize, seed: u64) -> (CatchCounts, Vec<String>) {
    let mut rng = seeded_rng(seed, &["corruptions"]);
    let mut counts = CatchCounts::new();
    let mut missed = Vec::new();
    for kind in InstructionCorruption::ALL {
        // Some kinds are not possible in most texts, so the search for one ends after 100 tries for each corruption.
        let mut tries = 0;
        while counts.entry(kind).or_default().1 < count / InstructionCorruption::ALL.len() && tries < 100 * count {
            tries += 1;
            let Some((run, record)) = all.choose(&mut rng) else { break };
            let Some((evidence, style, others)) = run.inputs_for(record) else { continue };
            let Some(text) = corrupt_instruction(kind, record, evidence, others, style, &mut rng) else { continue };
            let verdict =
                check_text(&text, CheckSubject::closed_world(evidence, style, record.path.target.as_ref())).verdict();
            let (caught, total) = counts.entry(kind).or_default();
            *total += 1;
            *caught += usize::from(verdict == Verdict::Fail);
            if verdict != Verdict::Fail {
                let was = &record.instruction.text;
                missed.push(format!("{} [{}] {verdict:?}: {text}\n    was: {was}", kind.name(), record.path.id));
            }
        }
    }
    (counts, missed)
}

fn catch_table(counts: &CatchCounts) -> String {
    let line = |name: &str, (caught, total): (usize, usize)| {
        format!("{name:<39} {caught:>5} of {total:>5}  {:>5.1} %", 100.0 * caught as f64 / total.max(1) as f64)
    };
    let sum = counts.values().fold((0, 0), |sum, count| (sum.0 + count.0, sum.1 + count.1));
    let kinds = counts.iter().map(|(kind, count)| line(kind.name(), *count));
    kinds.chain([line("all", sum)]).collect::<Vec<_>>().join("\n")
}

/// Reads a run, with evidence from labels for the paths of all records that passed.
fn open_run(folder: &Path, output: &CommandOutput) -> Result<LabelledRun, CommandError> {
    let settings = read_run_settings(folder)?;
    let platform = platforms::open_platform(&settings)?;
    let styles = styles::find_run_styles(&settings)?.into_iter().map(|measured| measured.style).collect();
    let mut records = jsonl::read_records(&folder.join(file::INSTRUCTIONS))?;
    records.retain(|record| record.instruction.verdict == Verdict::Pass);
    let mut paths: Vec<_> = records.iter().map(|record| &record.path).collect();
    paths.dedup_by_key(|path| &path.id);
    let bar = output.progress_bar(paths.len(), "paths");
    let seen: Vec<(String, SceneId, Evidence)> = paths
        .par_iter()
        .filter_map(|path| {
            bar.inc(1);
            let evidence = label_evidence(platform.as_ref(), path).transpose()?;
            Some(evidence.map(|evidence| (path.id.clone(), path.scene.clone(), evidence)))
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let mut names: BTreeMap<SceneId, BTreeSet<String>> = BTreeMap::new();
    for (_, scene, evidence) in &seen {
        let things = evidence.frames.iter().flat_map(|frame| &frame.things).map(|thing| thing.name.clone());
        names.entry(scene.clone()).or_default().extend(things.filter(|name| find_thing(name).is_some()));
    }
    let evidence = seen.into_iter().map(|(id, _, evidence)| (id, evidence)).collect();
    Ok(LabelledRun { styles, records, evidence, names })
}

fn label_evidence(platform: &dyn Platform, path: &wayword_core::Path) -> Result<Option<Evidence>, CommandError> {
    let world = RememberingPlatform::new(platform);
    Ok(Evidence::from_labels(path, &path_panoramas(&world, path)?))
}

impl LabelledRun {
    /// The evidence and the style of a record, and the names of the things in its scene.
    fn inputs_for(&self, record: &InstructionRecord) -> Option<(&Evidence, &InstructionStyle, &BTreeSet<String>)> {
        let style = self.styles.iter().find(|style| style.name == record.instruction.style)?;
        Some((self.evidence.get(&record.path.id)?, style, self.names.get(&record.path.scene)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::{test_instruction, test_path, test_record};
    use MentionKind::{Landmark, Room as InRoom, Turn};
    use wayword_checks::{EvidenceSource, FrameEvidence, SeenThing};
    use wayword_core::MentionKind;

    const TEXT: &str = "Walk past the sofa. Turn left at the lamp. Stop in the kitchen.";

    fn good() -> InstructionRecord {
        let mentions = [("sofa", Landmark), ("left", Turn), ("lamp", Landmark), ("kitchen", InRoom)];
        test_record("p", test_instruction("mine", TEXT, &mentions))
    }

    /// A run of that one record, with the evidence about its path.
    fn run(evidence: Evidence) -> LabelledRun {
        let references = vec!["Head through the archway and wait near the tall window.".to_owned()];
        let style = InstructionStyle { name: "mine".into(), references, ..InstructionStyle::default() };
        let names = ["sofa", "lamp", "table"].map(str::to_owned).into();
        LabelledRun {
            styles: vec![style],
            records: vec![good()],
            evidence: BTreeMap::from([("p".to_owned(), evidence)]),
            names: BTreeMap::from([(SceneId::new("flat").unwrap(), names)]),
        }
    }

    /// The sofa is on the left of the first frame, the lamp at the second, and the last frame is in the kitchen. There are no
    /// other things.
    fn known() -> Evidence {
        let frame = |room: &str, seen: Option<(&str, f64)>| FrameEvidence {
            rooms: vec![room.to_owned()],
            things: seen
                .into_iter()
                .map(|(name, turn_deg)| SeenThing {
                    name: name.to_owned(),
                    turn_rad: Some(f64::to_radians(turn_deg)),
                    ..SeenThing::default()
                })
                .collect(),
            knows_things: true,
            level: Some(1),
            ..FrameEvidence::default()
        };
        let frames = vec![
            frame("hallway", Some(("sofa", -60.0))),
            frame("hallway", Some(("lamp", -10.0))),
            frame("kitchen", None),
        ];
        Evidence { frames, source: EvidenceSource::Labels, ..Evidence::for_path_alone(&test_path("p")) }
    }

    fn counts_of(evidence: Evidence) -> CatchCounts {
        let run = run(evidence);
        let all: Vec<(&LabelledRun, &InstructionRecord)> = run.records.iter().map(|record| (&run, record)).collect();
        count_caught(&all, 40, 0).0
    }

    /// Each corruption of this text contradicts the evidence about the path, so the checks must catch each. The text has no task,
    /// so there is no object of a task to exchange.
    #[test]
    fn with_full_evidence_every_corruption_is_caught() {
        let counts = counts_of(known());
        for kind in InstructionCorruption::ALL {
            let expected = if kind == InstructionCorruption::TaskElsewhere { (0, 0) } else { (4, 4) };
            assert_eq!(counts[&kind], expected, "{}", kind.name());
        }
    }

    /// Without known objects and rooms, absent ones cannot be caught, and no order, side or room can be made wrong. Turns, stairs and
    /// storeys follow from the path, and a copied reference from the text.
    #[test]
    fn with_the_path_alone_wrong_objects_and_rooms_are_not_caught() {
        let counts = counts_of(Evidence::for_path_alone(&test_path("p")));
        let expected = [
            (InstructionCorruption::TurnFlipped, (4, 4)),
            (InstructionCorruption::LandmarkAbsent, (0, 4)),
            (InstructionCorruption::OrderSwapped, (0, 0)),
            (InstructionCorruption::ReferenceCopied, (4, 4)),
            (InstructionCorruption::TaskElsewhere, (0, 0)),
            (InstructionCorruption::StairsAdded, (4, 4)),
            (InstructionCorruption::FloorWrong, (4, 4)),
            (InstructionCorruption::RoomWrong, (0, 0)),
            (InstructionCorruption::SideWrong, (0, 0)),
            (InstructionCorruption::TaskUnasked, (0, 4)),
        ];
        assert_eq!(counts, BTreeMap::from(expected));
    }

    #[test]
    fn missed_corruptions_are_listed_with_their_original_text() {
        let run = run(Evidence::for_path_alone(&test_path("p")));
        let missed = count_caught(&[(&run, &run.records[0])], 40, 0).1;
        assert_eq!(missed.len(), 8);
        assert!(
            missed.iter().all(|line| line.ends_with(&format!("\n    was: {TEXT}")) && !line.starts_with(TEXT)),
            "{missed:?}"
        );
    }

    #[test]
    fn the_table_has_shares_of_each_kind_and_of_all() {
        let counts = BTreeMap::from([
            (InstructionCorruption::TurnFlipped, (3, 4)),
            (InstructionCorruption::RoomWrong, (1, 1)),
            (InstructionCorruption::FloorWrong, (0, 0)),
        ]);
        let table = catch_table(&counts);
        let shares: Vec<&str> = table.lines().map(|line| line[40..].trim()).collect();
        assert_eq!(
            shares,
            ["3 of     4   75.0 %", "0 of     0    0.0 %", "1 of     1  100.0 %", "4 of     5   80.0 %"]
        );
    }
}
