//! Corrupts good instructions of runs and counts how many of the corruptions the checks catch.

use crate::corrupt::{Corruption, corrupt};
use rand::seq::IndexedRandom;
use rayon::prelude::*;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_checks::{Evidence, Subject, check};
use wayword_core::{Platform, SceneId, Style, Verdict, rng};
use wayword_formats::jsonl::{self, Record};
use wayword_language::lexicon::thing;
use wayword_run::{
    error::Error,
    output::Output,
    pipeline::panoramas,
    platforms::{self, Remembering},
    run_folder::{file, settings_of},
    styles,
};

/// The records of a run that passed, with everything that checking them again needs.
struct Run {
    styles: Vec<Style>,
    records: Vec<Record>,
    /// The evidence from labels, by the path's id.
    evidence: BTreeMap<String, Evidence>,
    /// The names of the things along the paths of each scene.
    names: BTreeMap<SceneId, BTreeSet<String>>,
}

pub fn measure(folders: &[PathBuf], count: usize, seed: u64, show: usize, output: &Output) -> Result<(), Error> {
    let runs = folders.iter().map(|folder| open(folder, output)).collect::<Result<Vec<_>, _>>()?;
    let all: Vec<(&Run, &Record)> =
        runs.iter().flat_map(|run| run.records.iter().map(move |record| (run, record))).collect();
    let (counts, missed) = counted(&all, count, seed);
    for line in missed.iter().take(show) {
        output.say(line);
    }
    output.data(&(), table(&counts));
    Ok(())
}

/// For each kind of corruption: how many the checks caught, and how many there were.
type Counts = BTreeMap<Corruption, (usize, usize)>;

/// Makes the same number of corruptions of each kind and checks them. Also returns a line for each one that the checks missed.
fn counted(all: &[(&Run, &Record)], count: usize, seed: u64) -> (Counts, Vec<String>) {
    let mut rng = rng(seed, &["corruptions"]);
    let mut counts = Counts::new();
    let mut missed = Vec::new();
    for kind in Corruption::ALL {
        let mut tries = 0;
        while counts.entry(kind).or_default().1 < count / Corruption::ALL.len() && tries < 100 * count {
            tries += 1;
            let Some((run, record)) = all.choose(&mut rng) else { break };
            let Some((evidence, style, others)) = run.needed_for(record) else { continue };
            let Some(text) = corrupt(kind, record, evidence, others, style, &mut rng) else { continue };
            let verdict = check(&text, Subject::closed(evidence, style, record.path.target.as_ref())).verdict();
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

fn table(counts: &Counts) -> String {
    let line = |name: &str, (caught, total): (usize, usize)| {
        format!("{name:<39} {caught:>5} of {total:>5}  {:>5.1} %", 100.0 * caught as f64 / total.max(1) as f64)
    };
    let sum = counts.values().fold((0, 0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
    let kinds = counts.iter().map(|(kind, count)| line(kind.name(), *count));
    kinds.chain([line("all", sum)]).collect::<Vec<_>>().join("\n")
}

fn open(folder: &Path, output: &Output) -> Result<Run, Error> {
    let settings = settings_of(folder)?;
    let platform = platforms::open(&settings)?;
    let styles = styles::find(&settings.style)?.into_iter().map(|measured| measured.style).collect();
    let mut records = jsonl::read(&folder.join(file::INSTRUCTIONS))?;
    records.retain(|record| record.instruction.verdict == Verdict::Pass);
    let mut paths: Vec<_> = records.iter().map(|record| &record.path).collect();
    paths.dedup_by_key(|path| &path.id);
    let bar = output.progress(paths.len(), "paths");
    let seen: Vec<(String, SceneId, Evidence)> = paths
        .par_iter()
        .filter_map(|path| {
            bar.inc(1);
            let evidence = labels(platform.as_ref(), path).transpose()?;
            Some(evidence.map(|evidence| (path.id.clone(), path.scene.clone(), evidence)))
        })
        .collect::<Result<_, _>>()?;
    bar.finish_and_clear();
    let mut names: BTreeMap<SceneId, BTreeSet<String>> = BTreeMap::new();
    for (_, scene, evidence) in &seen {
        let things = evidence.frames.iter().flat_map(|frame| &frame.things).map(|thing| thing.name.clone());
        names.entry(scene.clone()).or_default().extend(things.filter(|name| thing(name).is_some()));
    }
    let evidence = seen.into_iter().map(|(id, _, evidence)| (id, evidence)).collect();
    Ok(Run { styles, records, evidence, names })
}

fn labels(platform: &dyn Platform, path: &wayword_core::Path) -> Result<Option<Evidence>, Error> {
    let world = Remembering::new(platform);
    Ok(Evidence::from_labels(path, &panoramas(&world, path)?))
}

impl Run {
    fn needed_for(&self, record: &Record) -> Option<(&Evidence, &Style, &BTreeSet<String>)> {
        let style = self.styles.iter().find(|style| style.name == record.instruction.style)?;
        Some((self.evidence.get(&record.path.id)?, style, self.names.get(&record.path.scene)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made_up::{instruction, path, record};
    use MentionKind::{Landmark, Room as InRoom, Turn};
    use wayword_checks::{FrameEvidence, SeenThing, Source};
    use wayword_core::MentionKind;

    const TEXT: &str = "Walk past the sofa. Turn left at the lamp. Stop in the kitchen.";

    fn good() -> Record {
        let mentions = [("sofa", Landmark), ("left", Turn), ("lamp", Landmark), ("kitchen", InRoom)];
        record("p", instruction("mine", TEXT, &mentions))
    }

    /// A run of that one record, with the evidence about its path.
    fn run(evidence: Evidence) -> Run {
        let references = vec!["Head through the archway and wait near the tall window.".to_owned()];
        let style = Style { name: "mine".into(), references, ..Style::default() };
        let names = ["sofa", "lamp", "table"].map(str::to_owned).into();
        Run {
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
        Evidence { frames, source: Source::Labels, ..Evidence::of_path_alone(&path("p")) }
    }

    fn counts_of(evidence: Evidence) -> Counts {
        let run = run(evidence);
        let all: Vec<(&Run, &Record)> = run.records.iter().map(|record| (&run, record)).collect();
        counted(&all, 40, 0).0
    }

    /// Each corruption of this text contradicts the evidence about the path, so the checks must catch each. The text has no task,
    /// so there is no object of a task to exchange.
    #[test]
    fn with_full_evidence_every_corruption_is_caught() {
        let counts = counts_of(known());
        for kind in Corruption::ALL {
            let expected = if kind == Corruption::TaskElsewhere { (0, 0) } else { (4, 4) };
            assert_eq!(counts[&kind], expected, "{}", kind.name());
        }
    }

    /// Without known objects and rooms, absent ones cannot be caught, and no order, side or room can be made wrong. Turns, stairs and
    /// storeys follow from the path, and a copied reference from the text.
    #[test]
    fn with_the_path_alone_wrong_objects_and_rooms_are_not_caught() {
        let counts = counts_of(Evidence::of_path_alone(&path("p")));
        let expected = [
            (Corruption::TurnFlipped, (4, 4)),
            (Corruption::LandmarkAbsent, (0, 4)),
            (Corruption::OrderSwapped, (0, 0)),
            (Corruption::ReferenceCopied, (4, 4)),
            (Corruption::TaskElsewhere, (0, 0)),
            (Corruption::StairsAdded, (4, 4)),
            (Corruption::FloorWrong, (4, 4)),
            (Corruption::RoomWrong, (0, 0)),
            (Corruption::SideWrong, (0, 0)),
            (Corruption::TaskUnasked, (0, 4)),
        ];
        assert_eq!(counts, BTreeMap::from(expected));
    }

    #[test]
    fn missed_corruptions_are_listed_with_their_original_text() {
        let run = run(Evidence::of_path_alone(&path("p")));
        let missed = counted(&[(&run, &run.records[0])], 40, 0).1;
        assert_eq!(missed.len(), 8);
        assert!(
            missed.iter().all(|line| line.ends_with(&format!("\n    was: {TEXT}")) && !line.starts_with(TEXT)),
            "{missed:?}"
        );
    }

    #[test]
    fn the_table_has_shares_of_each_kind_and_of_all() {
        let counts = BTreeMap::from([
            (Corruption::TurnFlipped, (3, 4)),
            (Corruption::RoomWrong, (1, 1)),
            (Corruption::FloorWrong, (0, 0)),
        ]);
        let table = table(&counts);
        let shares: Vec<&str> = table.lines().map(|line| line[40..].trim()).collect();
        assert_eq!(
            shares,
            ["3 of     4   75.0 %", "0 of     0    0.0 %", "1 of     1  100.0 %", "4 of     5   80.0 %"]
        );
    }
}
