//! Checks texts that were edited after `wayword export` against the captions of their own run, which needs no platform.

use super::{
    How,
    held::Held,
    report::{CheckReport, CheckedText},
    walks::{Named, Text},
};
use crate::{
    check::args::AskedWorld,
    error::Error,
    run_folder::{WalkRecord, file, lines, settings_of},
};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_checks::{Evidence, Reach, Subject, Turns, check_own};
use wayword_core::{Finding, ObjectId, Path, SceneId, ViewpointId};
use wayword_formats::{Format, jsonl};
use wayword_synthesis::walk::Walk;

/// A text, and how its path is found in the run.
struct Wanted {
    text: Text,
    path: Wants,
}

/// How a text in a file refers to a path of the run.
enum Wants {
    /// Its name.
    Id(String),
    /// The fields of a dataset. The names count only if the dataset has no viewpoints.
    Way { scene: SceneId, viewpoints: Vec<ViewpointId>, object: Option<ObjectId>, names: [String; 2] },
}

/// Checks every text of a file against the captions of a run.
///
/// # Errors
/// When the file or the run cannot be read, or a text is about a path that the run does not have.
pub(super) fn check_file(texts: &FilePath, run: &FilePath, how: How<'_>) -> Result<CheckReport, Error> {
    let held = Held::of_run(how.style, &settings_of(run)?)?;
    // The finds of a detector are part of the captions.
    let captions_were_evidence = matches!(checked_against(run)?.as_deref(), Some("captions" | "detector"));
    let mut wanted: Vec<Option<Wanted>> = wanted(texts)?.into_iter().map(Some).collect();
    let mut found: Vec<(usize, CheckedText, Vec<Finding>)> = Vec::new();
    let mut report = CheckReport::default();
    lines::each(&run.join(file::WALKS), |line| {
        let record: WalkRecord = line.parse()?;
        let mut mine = Vec::new();
        for slot in &mut wanted {
            mine.extend(slot.take_if(|wanted| wanted.path.is(&record.path)));
        }
        if mine.is_empty() {
            return Ok(());
        }
        let walk = Walk::new(record.path, record.observations);
        let evidence = walk.evidence().unwrap_or_else(|| Evidence::of_path_alone(&walk.path));
        let source = evidence.source.name();
        if !report.checked_against.iter().any(|other| other == source) {
            report.checked_against.push(source.to_owned());
        }
        for Wanted { text, .. } in mine {
            held.count(&text, &mut report);
            let known = held.style_of(&text);
            let target = walk.path.target.as_ref();
            // If labels were the evidence, the captions show less than the texts were written from, so the world is open.
            let is_closed = match how.world {
                AskedWorld::Closed => true,
                AskedWorld::Open => false,
                AskedWorld::Auto => captions_were_evidence,
            };
            let subject = if is_closed {
                Subject::closed(&evidence, &known.style, target)
            } else {
                Subject::open(&evidence, &known.style, Reach::default())
            };
            let turns = Turns::NotJudged("without the platform the text is not followed");
            let subject = Subject { tag: text.tag.as_deref(), turns, ..subject.with_copies(&known.copies) };
            let checked = check_own(&text.words, subject);
            found.push((text.at, CheckedText::of(&text, &checked), checked.findings));
        }
        Ok(())
    })?;
    if let Some(lost) = wanted.iter().flatten().next() {
        let problem = format!("{}: the run {} has no path {}", texts.display(), run.display(), lost.text.path);
        return Err(Error::usage(problem, "give the run that the texts were exported from"));
    }
    found.sort_by_key(|(at, _, _)| *at);
    found.into_iter().for_each(|(_, text, findings)| report.add(text, &findings));
    Ok(report)
}

/// The captions of a run as evidence, by the ids of its paths.
///
/// # Errors
/// When the run cannot be read.
pub(super) fn captions(run: &FilePath) -> Result<BTreeMap<String, Evidence>, Error> {
    let mut captions = BTreeMap::new();
    lines::each(&run.join(file::WALKS), |line| {
        let record: WalkRecord = line.parse()?;
        let walk = Walk::new(record.path, record.observations);
        captions.extend(walk.evidence().map(|evidence| (walk.path.id.clone(), evidence)));
        Ok(())
    })?;
    Ok(captions)
}

impl Wants {
    fn is(&self, path: &Path) -> bool {
        match self {
            Self::Id(id) => path.id == *id,
            Self::Way { scene, viewpoints, object, names } => {
                let along: Option<Vec<&ViewpointId>> =
                    path.frames.iter().map(|frame| frame.viewpoint.as_ref()).collect();
                let is_same_way = match along {
                    Some(along) if !viewpoints.is_empty() => along.into_iter().eq(viewpoints.iter()),
                    _ => names.contains(&path.id),
                };
                let target = path.target.as_ref().map(|target| &target.object);
                path.scene == *scene
                    && is_same_way
                    && object.as_ref().is_none_or(|object| target.is_none_or(|target| target == object))
            }
        }
    }
}

/// The texts of a file.
fn wanted(file: &FilePath) -> Result<Vec<Wanted>, Error> {
    let mut all = Vec::new();
    if wayword_formats::detect(file)? == Format::Wayword {
        for (at, jsonl::Record { path, instruction, platform, .. }) in jsonl::read(file)?.into_iter().enumerate() {
            let style = Named { name: instruction.style, hash: instruction.provenance.style_hash.clone() };
            let (words, made) = (instruction.text, Some((platform, instruction.provenance)));
            let text = Text { at, path: path.id.clone(), words, tag: None, style: Some(style), made };
            all.push(Wanted { text, path: Wants::Id(path.id) });
        }
        return Ok(all);
    }
    for episode in wayword_formats::read(file)? {
        for (at, words) in episode.instructions.iter().enumerate() {
            let tag = episode.language(at).map(str::to_owned);
            let text =
                Text { at: all.len(), path: episode.id.clone(), words: words.clone(), tag, style: None, made: None };
            let path = Wants::Way {
                scene: episode.scene.clone(),
                viewpoints: episode.viewpoints.clone(),
                object: episode.target_object.clone(),
                names: [episode.id.clone(), episode.path_id.clone()],
            };
            all.push(Wanted { text, path });
        }
    }
    Ok(all)
}

/// The evidence that the first text of a run was checked against.
fn checked_against(run: &FilePath) -> Result<Option<String>, Error> {
    #[derive(Deserialize)]
    struct Line {
        provenance: Checked,
    }
    #[derive(Deserialize)]
    struct Checked {
        checked_against: String,
    }
    let mut first = None;
    lines::each(&run.join(file::INSTRUCTIONS), |line| {
        if first.is_none() {
            let Line { provenance } = line.parse()?;
            first = Some(provenance.checked_against);
        }
        Ok(())
    })?;
    Ok(first)
}
