//! Checks texts that were edited after `wayword export` against the evidence of their own run.

use super::{
    CheckOptions, CheckedWalk, TextChecker,
    path_texts::{FileText, PathTexts},
    report::{CheckReport, CheckedText},
    styles::CheckStyles,
};
use crate::{
    check::args::AskedWorld,
    error::CommandError,
    follow::{FollowerFindings, WITHOUT_LABELS},
    output::CommandOutput,
    platforms,
    run_folder::{WalkRecord, expect_run, file, lines, number_of_text, read_run_settings},
    settings::RunSettings,
};
use serde::Deserialize;
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_checks::{CheckSubject, Evidence, WalkMemory, WorldReach, check_own_text};
use wayword_core::{ObjectId, Path, SceneId, ViewpointId};
use wayword_formats::{DatasetFormat, jsonl, submission::instr_id};
use wayword_synthesis::walk::ObservedWalk;

/// A walk of a run, with the texts about it.
pub(super) type WalkTexts = (ObservedWalk, Vec<FileText>);

/// A text, and how its path is found in the run.
pub(super) struct RunText {
    pub(super) text: FileText,
    pub(super) path: RunPathKey,
}

/// How a text in a file refers to a path of the run.
pub(super) enum RunPathKey {
    /// The id of the path.
    Id(String),
    /// The fields of a dataset. `names` are the ids of the episode and of its path; they count only if the dataset has
    /// no viewpoints.
    Way { scene: SceneId, viewpoints: Vec<ViewpointId>, object: Option<ObjectId>, names: [String; 2] },
}

/// Checks every text of a file against the evidence of the run that wrote it: the labels of its platform, or its captions. Where the
/// platform cannot be opened any more, the captions are all that is left.
///
/// # Errors
/// When the file or the run cannot be read, or a text is about a path that the run does not have.
pub(super) fn check_file(
    texts: &FilePath,
    run: &FilePath,
    how: CheckOptions<'_>,
    output: &CommandOutput,
) -> Result<CheckReport, CommandError> {
    expect_run(run)?;
    let settings = read_run_settings(run)?;
    let styles = CheckStyles::for_run(how.style, &settings)?;
    let (walks, unmatched) = match_walks(read_texts(texts)?, run)?;
    if let Some(unmatched) = unmatched.first() {
        let problem = format!("{}: the run {} has no path {}", texts.display(), run.display(), unmatched.text.path);
        return Err(CommandError::usage(problem, "give the run that the texts were exported from"));
    }
    let mut report = CheckReport::default();
    walks.iter().flat_map(|(_, texts)| texts).for_each(|text| styles.count_text(text, &mut report));
    report.add_texts(check_texts_of_run(run, walks, (&settings, &styles), how, output)?);
    Ok(report)
}

/// Checks texts about walks of a run against the run's evidence.
pub(super) fn check_texts_of_run(
    run: &FilePath,
    walks: Vec<WalkTexts>,
    (settings, styles): (&RunSettings, &CheckStyles),
    how: CheckOptions<'_>,
    output: &CommandOutput,
) -> Result<Vec<CheckedWalk>, CommandError> {
    let source = checked_against(run)?;
    // A simulator may be in another state by now, and a command of the user's is not run for a check.
    let is_program = platforms::is_live(&settings.platform) || settings.platform == "process";
    if source.as_deref().is_some_and(|source| source.starts_with("labels")) && !is_program {
        match platforms::open_platform(settings) {
            Ok(platform) => {
                let seen = |(walk, _): &WalkTexts| Some((walk.path.id.clone(), RunCaptions::of_walk(walk)?));
                let captions = match source.as_deref() {
                    Some("labels") => BTreeMap::new(),
                    _ => walks.iter().filter_map(seen).collect(),
                };
                let walks: Vec<PathTexts> =
                    walks.into_iter().map(|(walk, texts)| PathTexts { path: walk.path, texts }).collect();
                let checking =
                    TextChecker { is_own_run: true, captions, ..TextChecker::new(platform.as_ref(), styles, how) };
                return checking.check_each(&walks, output);
            }
            Err(error) => output
                .say(format!("the platform of the run cannot be opened, so its captions are the evidence: {error}")),
        }
    }
    // The finds of a detector are part of the captions.
    let captions_were_evidence = matches!(source.as_deref(), Some("captions" | "detector"));
    Ok(check_by_captions(&walks, styles, how, captions_were_evidence))
}

/// The walks of a run that texts are about, each with its texts; and the texts whose path the run does not have.
pub(super) fn match_walks(texts: Vec<RunText>, run: &FilePath) -> Result<(Vec<WalkTexts>, Vec<RunText>), CommandError> {
    let mut wanted: Vec<Option<RunText>> = texts.into_iter().map(Some).collect();
    let mut walks = Vec::new();
    lines::each_line(&run.join(file::WALKS), |line| {
        let record: WalkRecord = line.parse()?;
        let of_path = |slot: &mut Option<RunText>| slot.take_if(|wanted| wanted.path.matches_path(&record.path));
        let path_texts: Vec<FileText> = wanted.iter_mut().filter_map(of_path).map(|wanted| wanted.text).collect();
        if !path_texts.is_empty() {
            walks.push((ObservedWalk::new(record.path, record.observations), path_texts));
        }
        Ok(())
    })?;
    Ok((walks, wanted.into_iter().flatten().collect()))
}

/// Checks texts against the captions of their walks.
fn check_by_captions(
    walks: &[WalkTexts],
    styles: &CheckStyles,
    how: CheckOptions<'_>,
    captions_were_evidence: bool,
) -> Vec<CheckedWalk> {
    let check_walk = |(walk, texts): &WalkTexts| {
        let evidence = walk.evidence().unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
        let memory = WalkMemory::from_path(&evidence, &walk.path);
        let follower = FollowerFindings::not_followed(WITHOUT_LABELS);
        let check_text = |text: &FileText| {
            let check_style = styles.style_or_any(text);
            let target = walk.path.target.as_ref();
            // If labels were the evidence, the captions show less than the texts were written from, so the world is open.
            let is_closed = match how.world {
                AskedWorld::Closed => true,
                AskedWorld::Open => false,
                AskedWorld::Auto => captions_were_evidence,
            };
            let subject = if is_closed {
                CheckSubject::closed_world(&evidence, &check_style.style, target).with_memory(&memory)
            } else {
                CheckSubject::open_world(&evidence, &check_style.style, WorldReach::default())
            };
            let subject = subject.with_copies(&check_style.copies);
            let subject = CheckSubject { tag: text.tag.as_deref(), turns: follower.turns, ..subject };
            let mut checked = check_own_text(&text.words, subject);
            styles.leave_out_unasked(text, &mut checked);
            if !how.without_route {
                follower.add_to(&mut checked);
            }
            (text.at, CheckedText::from_text(text, &checked), checked.findings)
        };
        (evidence.source_name(), texts.iter().map(check_text).collect())
    };
    walks.iter().map(check_walk).collect()
}

/// The captions of a walk as evidence.
pub(super) struct RunCaptions {
    pub(super) evidence: Evidence,
    /// Whether a model saw, and they are not made of labels.
    pub(super) is_by_model: bool,
}

impl RunCaptions {
    /// `None` where the captions name nothing.
    fn of_walk(walk: &ObservedWalk) -> Option<Self> {
        let witnessed = walk.witnessed();
        let is_by_model = witnessed.is_some();
        Some(Self { evidence: witnessed.or_else(|| walk.evidence())?, is_by_model })
    }
}

/// The captions of a run as evidence, by the ids of its paths.
///
/// # Errors
/// When the run cannot be read.
pub(super) fn read_captions(run: &FilePath) -> Result<BTreeMap<String, RunCaptions>, CommandError> {
    let mut captions = BTreeMap::new();
    lines::each_line(&run.join(file::WALKS), |line| {
        let record: WalkRecord = line.parse()?;
        let walk = ObservedWalk::new(record.path, record.observations);
        captions.extend(RunCaptions::of_walk(&walk).map(|seen| (walk.path.id.clone(), seen)));
        Ok(())
    })?;
    Ok(captions)
}

impl RunPathKey {
    fn matches_path(&self, path: &Path) -> bool {
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
fn read_texts(file: &FilePath) -> Result<Vec<RunText>, CommandError> {
    let mut all = Vec::new();
    if wayword_formats::detect_format(file)? == DatasetFormat::Wayword {
        for (at, record) in jsonl::read_records(file)?.into_iter().enumerate() {
            let number = number_of_text(&record);
            let jsonl::InstructionRecord { path, instruction, platform, .. } = record;
            let origin = (platform, instruction.provenance);
            let text = FileText::from_record(&path.id, instruction.style, number, instruction.text, origin);
            all.push(RunText { text: FileText { at, ..text }, path: RunPathKey::Id(path.id) });
        }
        return Ok(all);
    }
    for episode in wayword_formats::read_any_format(file)? {
        for (at, words) in episode.instructions.iter().enumerate() {
            let tag = episode.language_of(at).map(str::to_owned);
            let text = FileText::from_dataset(&episode.id, instr_id(&episode, at), words.clone(), tag);
            let path = RunPathKey::Way {
                scene: episode.scene.clone(),
                viewpoints: episode.viewpoints.clone(),
                object: episode.target_object.clone(),
                names: [episode.id.clone(), episode.path_id.clone()],
            };
            all.push(RunText { text: FileText { at: all.len(), ..text }, path });
        }
    }
    Ok(all)
}

/// The evidence that the first text of a run was checked against.
fn checked_against(run: &FilePath) -> Result<Option<String>, CommandError> {
    #[derive(Deserialize)]
    struct FirstInstructionLine {
        provenance: FirstInstructionProvenance,
    }
    #[derive(Deserialize)]
    struct FirstInstructionProvenance {
        checked_against: String,
    }
    let mut first = None;
    lines::each_line(&run.join(file::INSTRUCTIONS), |line| {
        if first.is_none() {
            let FirstInstructionLine { provenance } = line.parse()?;
            first = Some(provenance.checked_against);
        }
        Ok(())
    })?;
    Ok(first)
}
