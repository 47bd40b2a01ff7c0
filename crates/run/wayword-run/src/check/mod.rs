//! `wayword check`: checks the instructions of a file against labels, a detector's finds, or the captions of a run, and reports
//! a verdict for each.

mod again;
pub mod args;
pub(crate) mod detecting;
pub(crate) mod path_texts;
mod report;
mod run_texts;
mod styles;
mod worlds;

use crate::{
    calibration,
    check::args::{AskedWorld, CheckArgs as Args},
    doubts::{TextDoubts, find_doubts},
    error::{CommandError, Exit},
    follow::{FollowedPath, FollowerFindings, KnownScenes, ambiguity_rejection, read_followable},
    interrupt,
    lookout::DetectorLookout,
    output::CommandOutput,
    pipeline::path_panoramas,
    platforms::{self, RememberingPlatform},
    settings::{AskedSettings, EvidenceSources, RunSettings},
    text_language::warn_of_foreign,
};
use path_texts::{FileText, PathTexts, read_path_texts};
use rayon::prelude::*;
use report::CheckReportText;
use run_texts::RunCaptions;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
};
use styles::CheckStyles;
use wayword_checks::{
    CheckSubject, CheckWorld, Evidence, EvidenceSource, PathSurroundings, Testimony, TurnJudge, WalkMemory, WorldReach,
    check_own_text, check_text, cover_walk, lift_confirmed, memory::WalkBend, open::Calibration,
};
use wayword_core::{CheckFinding, Platform};
#[cfg(feature = "study")]
use wayword_core::{Path, TextDoubt};
use wayword_language::languages::ReadableText;
use worlds::choose_world;

pub use again::{CheckedAgain, SecondCheck, check_run_again, find_changed_texts};
pub use report::{AmbiguousText, CheckReport, CheckedText, DoubtedText, VerdictCounts};

/// Runs `wayword check`, and prints the report.
///
/// # Errors
/// As [`check_texts`].
pub fn run_check(args: &Args, output: &CommandOutput) -> Result<Exit, CommandError> {
    let report = check_texts(args, output)?;
    output.print_result(&report, CheckReportText { report: &report, shown: args.show });
    Ok(if report.failed == 0 { Exit::Done } else { Exit::WithLoss })
}

/// Checks a file as the flags of `wayword check` ask, without printing the result.
///
/// # Errors
/// As [`check_file`]; also when the flags do not fit together.
pub fn check_texts(args: &Args, output: &CommandOutput) -> Result<CheckReport, CommandError> {
    let how = CheckOptions {
        style: args.style.as_deref(),
        world: args.world,
        without_witnesses: args.no_witnesses,
        without_route: args.no_route,
        reject_ambiguous: args.reject_ambiguous,
        calibration: args.calibration.as_deref(),
        doubts: args.doubts,
        maybe_changed: None,
        captions: None,
    };
    if let Some(run) = &args.run {
        return run_texts::check_file(&args.file, run, how, output);
    }
    let settings = AskedSettings::from(args.platform.clone()).resolve()?;
    let sources = detecting::chosen_sources(&args.detecting)?;
    let lookout = detecting::open_lookout(&args.detecting, output)?;
    check_with_lookout(&args.file, &settings, how, (lookout.as_ref(), sources), output)
}

/// How the texts of a file are checked.
#[derive(Debug, Clone, Copy, Default)]
pub struct CheckOptions<'a> {
    /// The style that every text has to keep to.
    pub style: Option<&'a str>,
    /// Whether texts are checked in an open or a closed world.
    pub world: AskedWorld,
    /// Whether other people's texts about a path are not used as witnesses for a claim that fails.
    pub without_witnesses: bool,
    /// Whether texts are not followed.
    pub without_route: bool,
    /// Whether a text that may mean several places or objects fails.
    pub reject_ambiguous: bool,
    /// A calibration file, from the user's own data.
    pub calibration: Option<&'a FilePath>,
    /// Whether to report the words that a reader should doubt.
    pub doubts: bool,
    /// The places of a run's texts that somebody may have changed. In these the follower looks for words to doubt in a closed world,
    /// too. In the others the checks have decided about each word.
    pub maybe_changed: Option<&'a BTreeSet<usize>>,
    /// A run with captions that are evidence: beside the labels of the platform, or alone where it has none.
    pub captions: Option<&'a FilePath>,
}

/// Checks every instruction of a file.
///
/// # Errors
/// When the file, the platform's data, the style or the calibration cannot be read. A path that does not fit the data is an
/// error too, because its texts could not be checked.
pub fn check_file(
    file: &FilePath,
    settings: &RunSettings,
    how: CheckOptions<'_>,
    output: &CommandOutput,
) -> Result<CheckReport, CommandError> {
    check_with_lookout(file, settings, how, (None, EvidenceSources::default()), output)
}

fn check_with_lookout(
    file: &FilePath,
    settings: &RunSettings,
    how: CheckOptions<'_>,
    (lookout, sources): (Option<&DetectorLookout>, EvidenceSources),
    output: &CommandOutput,
) -> Result<CheckReport, CommandError> {
    let platform = platforms::open_platform(settings)?;
    let calibration = how.calibration.map(|file| calibration::read_calibration(file, platform.name())).transpose()?;
    let check_styles = CheckStyles::for_style(how.style)?;
    let walks = read_path_texts(file, platform.as_ref())?;
    let checking = TextChecker {
        lookout,
        sources,
        calibration: calibration.as_ref(),
        captions: how.captions.map(run_texts::read_captions).transpose()?.unwrap_or_default(),
        ..TextChecker::new(platform.as_ref(), &check_styles, how)
    };
    checking.check_walks(&walks, output)
}

/// The words to doubt in texts about paths, in the order of the texts, which are checked in an open world.
///
/// # Errors
/// When the platform cannot give the views along a path.
#[cfg(feature = "study")]
pub fn find_text_doubts(
    texts: Vec<(Path, String)>,
    platform: &dyn Platform,
    output: &CommandOutput,
) -> Result<Vec<Vec<TextDoubt>>, CommandError> {
    let how = CheckOptions { doubts: true, ..CheckOptions::default() };
    let check_styles = CheckStyles::for_style(None)?;
    let checking = TextChecker::new(platform, &check_styles, how);
    let report = checking.check_walks(&path_texts::gather_by_path(texts), output)?;
    Ok(report.doubted.into_iter().map(|text| text.doubts).collect())
}

/// A text that was checked, with its place in the file and all its findings.
type CheckedPlace = (usize, CheckedText, Vec<CheckFinding>);

/// The source of evidence for the texts of a path, and the texts.
type CheckedWalk = (&'static str, Vec<CheckedPlace>);

/// Everything that the checks of all paths share.
struct TextChecker<'a> {
    platform: &'a dyn Platform,
    /// The styles that the texts have to keep to.
    styles: &'a CheckStyles,
    how: CheckOptions<'a>,
    /// The detector that looks for things that texts name.
    lookout: Option<&'a DetectorLookout>,
    /// Which sources of evidence count.
    sources: EvidenceSources,
    calibration: Option<&'a Calibration>,
    /// The captions of a run as evidence, by the ids of its paths.
    captions: BTreeMap<String, RunCaptions>,
    /// The scenes that were surveyed so far.
    scenes: KnownScenes,
    /// Whether the paths are those of the run that wrote the texts. Then the texts are in a closed world, and their tasks are about the
    /// targets of the paths.
    is_own_run: bool,
}

/// Why no words of a text are doubted that is read through English words: other words for them would be English ones.
const DOUBTS_IN_ENGLISH: &str = "words to doubt are found in English texts alone";

impl<'a> TextChecker<'a> {
    /// Checks texts against the labels of a platform.
    fn new(platform: &'a dyn Platform, styles: &'a CheckStyles, how: CheckOptions<'a>) -> Self {
        Self {
            platform,
            styles,
            how,
            lookout: None,
            sources: EvidenceSources::default(),
            calibration: None,
            captions: BTreeMap::new(),
            scenes: KnownScenes::new(),
            is_own_run: false,
        }
    }

    /// Checks the texts of all walks, and adds them to a report in the order of the file.
    fn check_walks(&self, walks: &[PathTexts], output: &CommandOutput) -> Result<CheckReport, CommandError> {
        let calibration = self.how.calibration.map(|file| file.display().to_string());
        let mut report = CheckReport { calibration, ..CheckReport::default() };
        warn_of_foreign("", walks.iter().flat_map(|walk| &walk.texts).map(|text| text.words.as_str()), output);
        for text in walks.iter().flat_map(|walk| &walk.texts) {
            self.styles.count_text(text, &mut report);
        }
        report.add_texts(self.check_each(walks, output)?);
        Ok(report)
    }

    /// Checks the texts of all walks in parallel.
    fn check_each(&self, walks: &[PathTexts], output: &CommandOutput) -> Result<Vec<CheckedWalk>, CommandError> {
        let bar = output.progress_bar(walks.len(), "paths");
        let checked = walks
            .par_iter()
            .map(|walk| {
                interrupt::check_interrupt()?;
                let checked = self.check_walk(walk);
                bar.inc(1);
                checked
            })
            .collect();
        bar.finish_and_clear();
        checked
    }

    /// Checks all texts of a path: collects the evidence once, follows each text, and checks it in its world.
    fn check_walk(&self, walk: &PathTexts) -> Result<CheckedWalk, CommandError> {
        let Self { platform, how, lookout, sources, .. } = *self;
        let world = RememberingPlatform::new(platform);
        let views = path_panoramas(&world, &walk.path)?;
        let mut labels = if sources.labels { Evidence::from_labels(&walk.path, &views) } else { None };
        let captions = self.captions.get(&walk.path.id);
        if let (Some(labels), Some(seen)) = (&mut labels, captions.filter(|captions| captions.is_by_model)) {
            labels.add_witnesses(&seen.evidence);
        }
        let detected = match lookout.filter(|_| labels.is_none() && sources.detector) {
            Some(lookout) => detecting::detector_evidence(lookout, &world, walk)?,
            None => None,
        };
        let captions = || captions.map(|captions| captions.evidence.clone());
        let known = labels.or(detected).or_else(captions);
        let mut evidence = known.unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
        let source = evidence.source;
        let text_world = |text: &FileText| match (how.world, self.is_own_run) {
            (AskedWorld::Auto, true) if source == EvidenceSource::Labels => CheckWorld::Closed,
            (asked, _) => choose_world(text, asked, platform.name(), source),
        };
        let memory = WalkMemory::from_path(&evidence, &walk.path);
        let some_are_open = walk.texts.iter().any(|text| text_world(text) == CheckWorld::Open);
        let scene = Some(self.scenes.get_or_survey(platform, &walk.path.scene)?);
        evidence.beyond = scene.as_ref().map(|scene| scene.inventory.beyond_end(&walk.path)).unwrap_or_default();
        let surroundings = scene.as_ref().and_then(|scene| PathSurroundings::around_path(&scene.inventory, &walk.path));
        let reach = WorldReach { surroundings: surroundings.as_ref(), calibration: self.calibration };
        let followed =
            (!how.without_route).then(|| FollowedPath::new(platform, scene.as_deref(), &walk.path, &evidence));
        let uses_witnesses = some_are_open && !how.without_witnesses && walk.texts.len() > 1;
        // A text of a Wayword record is no witness: one writer wrote all texts of its run, with the same mistakes in
        // each.
        let texts: Vec<(&FileText, ReadableText<'_>)> =
            walk.texts.iter().map(|text| (text, ReadableText::new(&text.words, text.tag.as_deref()))).collect();
        let testimony = |(text, readable): &(&FileText, ReadableText<'_>)| {
            (uses_witnesses && text.origin.is_none()).then(|| Testimony::from_text(readable.english(), &evidence))
        };
        let testimonies: Vec<Option<Testimony>> = texts.iter().map(testimony).collect();
        let checked = texts.iter().zip(&testimonies).map(|((text, readable), own_testimony)| {
            let check_style = self.styles.style_or_any(text);
            let (words, tag) = (readable.english(), readable.english_tag(text.tag.as_deref()));
            let read = followed.as_ref().map(|followed| {
                let followed = followed.as_ref().map_err(|why| *why);
                followed.and_then(|followed| Ok((followed, read_followable(words, tag)?)))
            });
            let follower = read.as_ref().map(|read| match read {
                Ok((followed, (guide, _))) => followed.follow_guide(guide),
                Err(why) => FollowerFindings::not_followed(why),
            });
            // People name a target as they like, so any object of the final viewpoint is accepted.
            let target = walk.path.target.as_ref().filter(|_| self.is_own_run);
            let subject = match text_world(text) {
                CheckWorld::Closed => CheckSubject {
                    memory: Some(&memory),
                    ..CheckSubject::closed_world(&evidence, &check_style.style, target)
                },
                CheckWorld::Open => CheckSubject::open_world(&evidence, &check_style.style, reach),
            };
            let turns =
                follower.as_ref().map_or(TurnJudge::NotJudged("the text is not followed"), |follower| follower.turns);
            let own_tokens = readable.own_tokens();
            let own_tokens = own_tokens.as_deref();
            let subject = CheckSubject { tag, turns, own_tokens, ..subject.with_copies(&check_style.copies) };
            // The texts of a run are checked as they were when it wrote them.
            let mut checked = if self.is_own_run { check_own_text(words, subject) } else { check_text(words, subject) };
            self.styles.leave_out_unasked(text, &mut checked);
            if let Some(follower) = &follower {
                follower.add_to(&mut checked);
            }
            if let Some(own) = own_testimony.as_ref().filter(|_| checked.world == CheckWorld::Open) {
                let others: Vec<&Testimony> = testimonies.iter().flatten().collect();
                lift_confirmed(&mut checked, own, &others);
            }
            let ambiguity = follower.as_ref().map(|follower| follower.text_ambiguity(words, &evidence));
            if let Some(language) = readable.experimental_language() {
                checked.doubt_language(language);
            }
            checked.add_findings(ambiguity.as_ref().filter(|_| how.reject_ambiguous).and_then(ambiguity_rejection));
            checked.add_findings(text.missing_object_finding(&walk.path.scene));
            let mut shown = CheckedText::from_text(text, &checked);
            // A text that is not understood leaves nothing out.
            if let Some(Ok((followed, (_, reading)))) = &read {
                if shown.parts.is_empty() {
                    shown.parts = followed.align_reading(words, reading, (&evidence, &memory));
                }
                let is_open = |bend: &WalkBend| (bend.first..=bend.last).any(|frame| followed.has_other_way(frame));
                shown.coverage_of_walk = cover_walk(reading, &shown.parts, &memory, is_open);
            }
            if how.doubts && readable.is_glossed() {
                shown.doubted = Some(TextDoubts { doubts: Vec::new(), unfollowed: Some(DOUBTS_IN_ENGLISH) });
            } else if how.doubts {
                let is_changed = how.maybe_changed.is_some_and(|changed| changed.contains(&text.at));
                let tries_changes = is_changed || checked.world == CheckWorld::Open;
                let found = find_doubts(followed.as_ref(), (words, tag), (&checked, tries_changes), ambiguity.as_ref());
                shown.doubted = Some(found);
            }
            shown.put_into_text(readable);
            shown.ambiguity = ambiguity;
            if let Some(follower) = follower {
                (shown.route, shown.turn_gain) = (follower.route, follower.turn_gain);
            }
            (text.at, shown, checked.findings)
        });
        Ok((evidence.source_name(), checked.collect()))
    }
}
