//! Makes one item: looks along its path, describes the views, writes a text in each style, checks it, and repairs or rejects it.

use crate::{
    advice::writing_advice,
    error::CommandError,
    follow::{FollowedPath, FollowerFindings, KnownScenes, WITHOUT_LABELS, ambiguity_rejection},
    item::RunItem,
    lookout::DetectorLookout,
    parallel::make_in_parallel,
    pictures::{self, FrameJpeg},
    platforms::RememberingPlatform,
    run_folder::{ItemCalls, TextCost, WorldData},
    settings::{EvidenceSources, RunSettings, TargetMode},
    styles::MeasuredStyle,
    team::RoleTeam,
};
use std::collections::BTreeMap;
use wayword_checks::{Evidence, EvidenceSource, TextFindings, WalkMemory, parts_from_mentions, put_parts_into_text};
use wayword_core::{
    Caption, Frame, Instruction, InstructionPart, ModelError, Path, Platform, PlatformError, SceneId, TextAmbiguity,
    View, ViewGaze,
};
use wayword_language::languages::ReadableText;
use wayword_ledger::{CallAccount, CallContext};
use wayword_synthesis::{
    detection::{detector_evidence, seek_along_path},
    observe::{PlannedView, caption_view, gazes_around, observe_path_with},
    offline::{approach_frames, describe_target, list_around_frame},
    repair::{
        CandidateResult, CandidateWriting, InstructionOrder, TextFollower, WriteTogether, WritingOutcome,
        write_and_repair,
    },
    walk::ObservedWalk,
    writer::FramePicture,
};

/// The result of an item.
#[derive(Debug)]
pub struct MadeItem {
    /// The path and what was seen along it.
    pub walk: ObservedWalk,
    /// The outcomes of its texts, style by style in the order of the run's styles. Each style has as many as
    /// `--per-path` asks for.
    pub outcomes: Vec<WritingOutcome>,
    /// What each of these texts cost, in the same order; `None` where no model took part.
    pub costs: Vec<Option<TextCost>>,
    /// The picture ahead of each frame, if the platform has pictures.
    pub pictures: Vec<FrameJpeg>,
    /// The answers of models that it used.
    pub used: Option<ItemCalls>,
}

/// The platform of a run, with the recorded hashes of its files.
#[derive(Clone, Copy)]
pub struct RunPlatform<'a> {
    /// The platform.
    pub platform: &'a dyn Platform,
    /// The hashes that the files of its scenes must have; `None` outside a run folder.
    pub data: Option<&'a WorldData>,
    /// The surveyed scenes around its paths.
    pub scenes: &'a KnownScenes,
}

/// The texts to write for an item.
#[derive(Clone, Copy)]
pub struct ItemTextOrder<'a> {
    /// Their styles.
    pub styles: &'a [MeasuredStyle],
    /// For styles in this map, the number of the one candidate to write; all candidates are written for the others.
    pub only: &'a BTreeMap<String, u32>,
}

/// The texts of an item, before they are written into the run folder.
#[derive(Debug)]
pub struct WrittenItem {
    /// The path and what was seen along it.
    pub walk: ObservedWalk,
    /// The outcomes of its texts, style by style in the order of the run's styles. Each style has as many as
    /// `--per-path` asks for.
    pub outcomes: Vec<WritingOutcome>,
    /// What each of these texts cost.
    costs: Vec<Option<TextCost>>,
    /// The view ahead of each frame.
    ahead: Vec<View>,
}

/// Makes an item: its texts, and the pictures along its path. See [`write_item()`].
///
/// # Errors
/// As for [`write_item()`].
pub fn make_item(
    item: &RunItem,
    settings: &RunSettings,
    world: RunPlatform<'_>,
    team: &RoleTeam,
    styles: &[MeasuredStyle],
    threads: usize,
) -> Result<MadeItem, CommandError> {
    let order = ItemTextOrder { styles, only: &BTreeMap::new() };
    let account = CallAccount::default();
    let written = CallContext::with_account(&account, || write_item(item, settings, world, team, order, threads));
    let WrittenItem { walk, outcomes, costs, ahead } = written?;
    let used = ItemCalls::of_account(&account);
    Ok(MadeItem { walk, outcomes, costs, pictures: pictures::encode_pictures(&ahead)?, used })
}

/// Writes an item's instructions. Up to `threads` views are described at the same time, and up to as many styles written; the
/// results do not depend on this number.
///
/// # Errors
/// When its path does not fit its scene, the files of the scene have changed since the run began, a view cannot be had, or a model
/// gives no answer.
pub fn write_item(
    item: &RunItem,
    settings: &RunSettings,
    world: RunPlatform<'_>,
    team: &RoleTeam,
    ItemTextOrder { styles, only }: ItemTextOrder<'_>,
    threads: usize,
) -> Result<WrittenItem, CommandError> {
    let RunPlatform { platform, data, scenes } = world;
    let world = match settings.no_pictures {
        true => RememberingPlatform::for_labels(platform),
        false => RememberingPlatform::new(platform),
    };
    let mut path = item_path(item, settings, &world)?;
    describe_path_target(&mut path, platform, scenes)?;
    if let Some(data) = data {
        data.check_scene(platform, &path.scene)?;
    }
    let observers = team.observers();
    let talk = |views: &[PlannedView]| -> Result<Vec<Caption>, ModelError> {
        // The other views are described although one fails, so the error is always that of the first failing view in order.
        let ends = |caption: &Result<Caption, ModelError>| caption.as_ref().is_err_and(ModelError::ends_run);
        make_in_parallel(views, threads, |planned| caption_view(&planned.view, observers), ends).into_iter().collect()
    };
    let mut observations = observe_path_with(&world, &path, settings.frames, observers, &talk)?;
    if let Some(lookout) = team.lookout() {
        let view_count = CallContext::with_purpose("detect", || {
            seek_along_path(&world, &path, &mut observations, lookout.to_seeker())
        })?;
        lookout.add_views(view_count);
    }
    let walk = ObservedWalk::new(path, observations);
    let detector = team.lookout().map(DetectorLookout::name);
    let mut evidence = collect_evidence(&walk, &world, settings.evidence, detector)?;
    // With labels, the writer's memory has everything that they list around each frame; with a model, what it saw, where the evidence
    // places it.
    let lists_labels = team.sees_labels() && evidence.source == EvidenceSource::Labels;
    let evidence_memory = WalkMemory::from_path(&evidence, &walk.path);
    let captions_memory = (!lists_labels).then(|| match evidence.has_witnesses {
        true => WalkMemory::from_path(&evidence.witnessed_part(), &walk.path),
        false => walk.memory(),
    });
    let memory = captions_memory.as_ref().unwrap_or(&evidence_memory);
    let scene = match evidence.source {
        EvidenceSource::Labels => Some(scenes.get_or_survey(platform, &walk.path.scene)?),
        _ => None,
    };
    if let Some(scene) = &scene {
        evidence.beyond = scene.inventory.beyond_end(&walk.path);
    }
    let followed = FollowedPath::new(platform, scene.as_deref(), &walk.path, &evidence);
    let knows_scene = scene.is_some();
    let follower = PathFollower {
        followed,
        knows_scene,
        evidence: &evidence,
        memory: &evidence_memory,
        writers_memory: memory,
        rejects_ambiguous: settings.reject_ambiguous,
    };
    let ahead = views_ahead(&world, &walk.path)?;
    let shown =
        if settings.roles.write_sees { shown_pictures(&ahead, settings.roles.write.as_str())? } else { Vec::new() };
    let write_style = |MeasuredStyle { style, profile, hash }: &MeasuredStyle| {
        let order = InstructionOrder {
            walk: &walk,
            memory,
            evidence: &evidence,
            evidence_memory: &evidence_memory,
            style,
            profile,
            style_hash: hash,
            seed: settings.seed,
            repairs: settings.repairs,
            candidates: settings.candidates,
            only: only.get(&style.name).copied(),
            follower: (!settings.no_route).then_some(&follower),
            earlier: &[],
            pictures: &shown,
            views: if team.sees_labels() { &[] } else { &ahead },
            refinements: settings.refine,
            together: &InParallel(threads),
        };
        write_texts(team, order, settings.per_path)
    };
    let ends = |texts: &Result<Vec<CostedText>, ModelError>| texts.as_ref().is_err_and(ModelError::ends_run);
    let texts = make_in_parallel(styles, threads, write_style, ends).into_iter().collect::<Result<Vec<_>, _>>()?;
    let (mut outcomes, costs): (Vec<WritingOutcome>, Vec<Option<TextCost>>) = texts.into_iter().flatten().unzip();
    for instruction in outcomes.iter_mut().filter_map(WritingOutcome::instruction_mut) {
        if instruction.parts.is_empty() {
            instruction.parts = follower.parts(instruction, walk.path.frames.len());
        }
    }
    Ok(WrittenItem { walk, outcomes, costs, ahead })
}

/// Writes candidates at the same time, on so many threads.
struct InParallel(usize);

impl WriteTogether for InParallel {
    fn write_each(&self, numbers: &[u32], write: &CandidateWriting<'_>) -> Vec<CandidateResult> {
        let ends = |outcome: &CandidateResult| outcome.as_ref().is_err_and(ModelError::ends_run);
        make_in_parallel(numbers, self.0, |number| write(*number), ends)
    }
}

/// The outcome of a text, with what it cost.
type CostedText = (WritingOutcome, Option<TextCost>);

/// The texts of one walk in one style. Each has to differ from those before it.
fn write_texts(team: &RoleTeam, order: InstructionOrder<'_>, number: usize) -> Result<Vec<CostedText>, ModelError> {
    let (mut texts, mut earlier) = (Vec::new(), Vec::new());
    for _ in 0..number {
        let order = InstructionOrder { earlier: &earlier, ..order };
        let account = CallAccount::of_part();
        let write = || write_and_repair(team.writers(), team.observers(), order);
        let outcome = CallContext::with_account(&account, write)?;
        earlier.push(match &outcome {
            WritingOutcome::Accepted(instruction) | WritingOutcome::Rejected { last: Some(instruction), .. } => {
                instruction.text.clone()
            }
            WritingOutcome::Rejected { last: None, .. } => String::new(),
        });
        let cost = TextCost::of_outcome(&account, &outcome);
        texts.push((outcome, cost));
    }
    Ok(texts)
}

/// The most pictures that a writer is shown. From a longer path these are the first, the last, and others at equal distances
/// between them.
pub(crate) const MAX_SHOWN_PICTURES: usize = 16;

/// The pictures that a writer is shown.
///
/// # Errors
/// When there are none.
fn shown_pictures(ahead: &[View], writer: &str) -> Result<Vec<FramePicture>, ModelError> {
    let pictures = ahead.iter().enumerate().filter_map(|(frame, view)| Some((frame, view.image.clone()?)));
    let all: Vec<FramePicture> = pictures.map(|(frame, image)| FramePicture { frame, image }).collect();
    if all.is_empty() {
        return Err(ModelError::NothingToSee {
            name: writer.to_owned(),
            needs: "pictures for --write-sees",
            hint: "use a platform or data folder with pictures, or leave --write-sees out",
        });
    }
    let kept = all.len().min(MAX_SHOWN_PICTURES);
    let places = (0..kept).map(|at| at * (all.len() - 1) / (kept - 1).max(1));
    Ok(places.map(|at| all[at].clone()).collect())
}

/// Follows the texts of one path for `write_and_repair`.
struct PathFollower<'a> {
    /// The path, or the reason why it cannot be followed.
    followed: Result<FollowedPath<'a>, &'static str>,
    /// Whether the scene was surveyed. It is for texts that are checked against labels; others cannot be compared with other walks.
    knows_scene: bool,
    evidence: &'a Evidence,
    /// The memory of the walk by that evidence.
    memory: &'a WalkMemory,
    /// What the writer is told of the walk.
    writers_memory: &'a WalkMemory,
    /// Whether an ambiguous text fails (`--reject-ambiguous`).
    rejects_ambiguous: bool,
}

impl TextFollower for PathFollower<'_> {
    fn follow(&self, text: &str, checked: &mut TextFindings) -> TextAmbiguity {
        let findings = match &self.followed {
            Ok(followed) if self.knows_scene => followed.judge_route(text),
            Ok(_) => FollowerFindings::not_followed(WITHOUT_LABELS),
            Err(why) => FollowerFindings::not_followed(why),
        };
        findings.add_to(checked);
        let ambiguity = findings.text_ambiguity(text, self.evidence);
        checked.add_findings(ambiguity_rejection(&ambiguity).filter(|_| self.rejects_ambiguous));
        ambiguity
    }

    fn leads_there(&self, text: &str) -> Option<f64> {
        self.followed.as_ref().ok().filter(|_| self.knows_scene)?.leads_there(text)
    }

    fn advice(&self, instruction: &Instruction) -> Vec<String> {
        let known = self.followed.as_ref().ok().filter(|_| self.knows_scene);
        let advise =
            |followed| writing_advice(followed, instruction, (self.evidence, self.memory), self.writers_memory);
        known.map(advise).unwrap_or_default()
    }
}

impl PathFollower<'_> {
    /// The parts of a text with their frames: by its alignment with the path, or by its mentions alone where the motion is unknown. None
    /// for a text that is not understood.
    fn parts(&self, instruction: &Instruction, frames: usize) -> Vec<InstructionPart> {
        match &self.followed {
            Ok(followed) => {
                let words = ReadableText::new(&instruction.text, None);
                let aligned = followed.align_text(words.english(), None, (self.evidence, self.memory));
                let mut parts = aligned.unwrap_or_default();
                put_parts_into_text(&mut parts, &words);
                parts
            }
            Err(_) => parts_from_mentions(&instruction.text, &instruction.mentions, frames),
        }
    }
}

/// The path of an item. With `TargetMode::Free` its target is removed, because the writer chooses one.
///
/// # Errors
/// When it does not fit its scene.
pub fn item_path(
    item: &RunItem,
    settings: &RunSettings,
    world: &RememberingPlatform<'_>,
) -> Result<Path, CommandError> {
    let mut path = item.find_path(settings, world)?;
    if settings.target == TargetMode::Free {
        path.target = None;
    }
    Ok(path)
}

/// Fills in the description that distinguishes the target of a path from everything that is known of its building, and of the
/// surroundings of the path's end.
fn describe_path_target(path: &mut Path, platform: &dyn Platform, scenes: &KnownScenes) -> Result<(), CommandError> {
    let Path { scene, frames, target, .. } = path;
    let (Some(target), Some(last)) = (target, frames.last()) else { return Ok(()) };
    let known = scenes.get_or_survey(platform, scene)?;
    if known.listing.knows_frame(last) {
        describe_target(target, frames, &known.listing);
        return Ok(());
    }
    let views = look_without_pictures(platform, scene, last, &ViewGaze::around_heading(last.pose.heading))?;
    let look = |frame: &Frame| platform.look_without_picture(scene, frame, ViewGaze::quarter_view(frame.pose.heading));
    let ahead = approach_frames(frames).map(look).collect::<Result<Vec<View>, PlatformError>>()?;
    let listing = list_around_frame(known.listing.clone(), last, &views, &ahead);
    if listing.knows_frame(last) {
        describe_target(target, frames, &listing);
    }
    Ok(())
}

/// The views around each frame: ahead, right, behind, left; only ahead if the motion is unknown. Pictures may be missing.
///
/// # Errors
/// When a view cannot be had.
pub fn path_panoramas(platform: &dyn Platform, path: &Path) -> Result<Vec<Vec<View>>, PlatformError> {
    let views = |frame: &Frame| {
        let gazes = gazes_around(path, frame);
        match look_without_pictures(platform, &path.scene, frame, &gazes) {
            // A position of VLN-CE may lie between the viewpoints. It is a place of the path, and nothing is known of what it shows.
            Err(PlatformError::NotAViewpoint { .. }) => Ok(Vec::new()),
            views => views,
        }
    };
    path.frames.iter().map(views).collect()
}

/// The views from a frame, for which the platform need not make pictures.
fn look_without_pictures(
    platform: &dyn Platform,
    scene: &SceneId,
    frame: &Frame,
    gazes: &[ViewGaze],
) -> Result<Vec<View>, PlatformError> {
    gazes.iter().map(|gaze| platform.look_without_picture(scene, frame, *gaze)).collect()
}

/// The view ahead of each frame.
fn views_ahead(platform: &dyn Platform, path: &Path) -> Result<Vec<View>, PlatformError> {
    let look = |frame: &Frame| platform.look_from(&path.scene, frame, ViewGaze::quarter_view(frame.pose.heading));
    path.frames.iter().map(look).collect()
}

/// Collects the evidence that texts are checked against: labels if the settings want them and the platform has them, with what models
/// saw beside them; else captions and the finds of the detector of that name, else only the path.
fn collect_evidence(
    walk: &ObservedWalk,
    platform: &dyn Platform,
    sources: EvidenceSources,
    detector: Option<&str>,
) -> Result<Evidence, PlatformError> {
    // Collecting labels takes longer than everything else, so they are collected only if they are used.
    let mut labels = match sources.labels {
        true => Evidence::from_labels(&walk.path, &path_panoramas(platform, &walk.path)?),
        false => None,
    };
    // What a model saw counts beside the labels, which lack much.
    if let (Some(labels), Some(seen)) = (&mut labels, walk.witnessed().filter(|_| sources.captions)) {
        labels.add_witnesses(&seen);
    }
    let without_labels = || match detector.filter(|_| sources.detector && !sources.captions) {
        Some(detector) => Evidence::from_detector(&walk.path, &detector_evidence(&walk.observations, detector)),
        None => walk.evidence(),
    };
    Ok(labels.or_else(without_labels).unwrap_or_else(|| Evidence::for_path_alone(&walk.path)))
}
