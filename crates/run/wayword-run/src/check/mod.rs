//! `wayword check`: checks the instructions of a file against labels, a detector's finds, or the captions of a run, and reports
//! a verdict for each.

pub mod args;
mod detecting;
mod held;
mod of_run;
mod report;
mod walks;
mod worlds;

use crate::{
    calibration,
    check::args::{AskedWorld, Check as Args},
    doubts::doubts,
    error::{Error, Exit},
    follow::{Followed, KnownScenes, Told, rejection},
    interrupt,
    looking_for::Lookout,
    output::Output,
    pipeline::panoramas,
    platforms::{self, Remembering},
    settings::{Asked, Settings, Sources},
};
use held::Held;
use rayon::prelude::*;
use report::Shown;
use std::{collections::BTreeMap, path::Path as FilePath};
use walks::{Text, Walk, walks};
use wayword_checks::{Evidence, Reach, Subject, Surroundings, Testimony, Turns, World, check, lift, open::Calibration};
#[cfg(feature = "study")]
use wayword_core::{Doubt, Path};
use wayword_core::{Finding, Platform};
use worlds::world_of;

pub use report::{AmbiguousText, CheckReport, CheckedText, Counts, DoubtedText};

pub fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let report = checked(args, output)?;
    output.data(&report, Shown { report: &report, most: args.show });
    Ok(if report.failed == 0 { Exit::Done } else { Exit::WithLoss })
}

/// Checks a file as the flags of `wayword check` ask, without printing the result.
///
/// # Errors
/// As [`check_file`]; also when the flags do not fit together.
pub fn checked(args: &Args, output: &Output) -> Result<CheckReport, Error> {
    let how = How {
        style: args.style.as_deref(),
        world: args.world,
        without_witnesses: args.no_witnesses,
        without_route: args.no_route,
        reject_ambiguous: args.reject_ambiguous,
        calibration: args.calibration.as_deref(),
        doubts: args.doubts,
        captions: None,
    };
    if let Some(run) = &args.run {
        return of_run::check_file(&args.file, run, how);
    }
    let settings = Asked::from(args.platform.clone()).resolve()?;
    let lookout = detecting::lookout(&args.detecting, output)?;
    let sources = args.detecting.evidence.unwrap_or(Sources::usual(true));
    check_by(&args.file, &settings, how, (lookout.as_ref(), sources), output)
}

/// How the texts of a file are checked.
#[derive(Debug, Clone, Copy, Default)]
pub struct How<'a> {
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
    /// A run with captions that are the evidence where the platform has no labels.
    pub captions: Option<&'a FilePath>,
}

/// Checks every instruction of a file.
///
/// # Errors
/// When the file, the platform's data, the style or the calibration cannot be read. A path that does not fit the data is an
/// error too, because its texts could not be checked.
pub fn check_file(file: &FilePath, settings: &Settings, how: How<'_>, output: &Output) -> Result<CheckReport, Error> {
    check_by(file, settings, how, (None, Sources::default()), output)
}

fn check_by(
    file: &FilePath,
    settings: &Settings,
    how: How<'_>,
    (lookout, sources): (Option<&Lookout>, Sources),
    output: &Output,
) -> Result<CheckReport, Error> {
    let platform = platforms::open(settings)?;
    let calibration = how.calibration.map(|file| calibration::read(file, platform.name())).transpose()?;
    let held = Held::to(how.style)?;
    let walks = walks(file, platform.as_ref())?;
    let checking = Checking {
        platform: platform.as_ref(),
        held: &held,
        how,
        lookout,
        sources,
        calibration: calibration.as_ref(),
        captions: how.captions.map(of_run::captions).transpose()?.unwrap_or_default(),
        scenes: KnownScenes::new(),
    };
    checking.report(&walks, output)
}

/// The words to doubt in texts about paths, in the order of the texts, which are checked in an open world.
///
/// # Errors
/// When the platform cannot give the views along a path.
#[cfg(feature = "study")]
pub fn doubts_of(
    texts: Vec<(Path, String)>,
    platform: &dyn Platform,
    output: &Output,
) -> Result<Vec<Vec<Doubt>>, Error> {
    let how = How { doubts: true, ..How::default() };
    let checking = Checking {
        platform,
        held: &Held::to(None)?,
        how,
        lookout: None,
        sources: Sources::default(),
        calibration: None,
        captions: BTreeMap::new(),
        scenes: KnownScenes::new(),
    };
    let report = checking.report(&walks::gathered(texts), output)?;
    Ok(report.doubted.into_iter().map(|text| text.doubts).collect())
}

/// The source of evidence for the texts of a path, and each text with its place in the file and its findings.
type CheckedWalk = (&'static str, Vec<(usize, CheckedText, Vec<Finding>)>);

/// Everything that the checks of all paths share.
struct Checking<'a> {
    platform: &'a dyn Platform,
    held: &'a Held,
    how: How<'a>,
    /// The detector that looks for things that texts name.
    lookout: Option<&'a Lookout>,
    /// Whether labels count, and the detector.
    sources: Sources,
    calibration: Option<&'a Calibration>,
    /// The captions of a run as evidence, by the ids of its paths.
    captions: BTreeMap<String, Evidence>,
    scenes: KnownScenes,
}

impl Checking<'_> {
    /// Checks the texts of all walks in parallel, and adds them to a report in the order of the file.
    fn report(&self, walks: &[Walk], output: &Output) -> Result<CheckReport, Error> {
        let bar = output.progress(walks.len(), "paths");
        let checked: Vec<_> = walks
            .par_iter()
            .map(|walk| {
                interrupt::check()?;
                let checked = self.check(walk);
                bar.inc(1);
                checked
            })
            .collect::<Result<_, _>>()?;
        bar.finish_and_clear();
        let calibration = self.how.calibration.map(|file| file.display().to_string());
        let mut report = CheckReport { calibration, ..CheckReport::default() };
        let mut texts = Vec::new();
        for (source, of_walk) in checked {
            if !report.checked_against.iter().any(|other| other == source) {
                report.checked_against.push(source.to_owned());
            }
            texts.extend(of_walk);
        }
        for text in walks.iter().flat_map(|walk| &walk.texts) {
            self.held.count(text, &mut report);
        }
        // Back into the order of the file: the texts of one path were checked together.
        texts.sort_by_key(|(at, _, _)| *at);
        for (_, text, findings) in texts {
            report.add(text, &findings);
        }
        Ok(report)
    }

    fn check(&self, walk: &Walk) -> Result<CheckedWalk, Error> {
        let Self { platform, how, lookout, sources, .. } = *self;
        let world = Remembering::new(platform);
        let views = panoramas(&world, &walk.path)?;
        let labels = if sources.labels { Evidence::from_labels(&walk.path, &views) } else { None };
        let detected = match lookout.filter(|_| labels.is_none() && sources.detector) {
            Some(lookout) => detecting::evidence(lookout, &world, walk)?,
            None => None,
        };
        let captions = || self.captions.get(&walk.path.id).cloned();
        let known = labels.or(detected).or_else(captions);
        let mut evidence = known.unwrap_or_else(|| Evidence::of_path_alone(&walk.path));
        let source = evidence.source;
        let world_of = |text: &Text| world_of(text, how.world, platform.name(), source);
        let some_are_open = walk.texts.iter().any(|text| world_of(text) == World::Open);
        let scene = Some(self.scenes.get(platform, &walk.path.scene)?);
        evidence.beyond = scene.as_ref().map(|scene| scene.listed.beyond(&walk.path)).unwrap_or_default();
        let around = scene.as_ref().and_then(|scene| Surroundings::of(&scene.listed, &walk.path));
        let reach = Reach { surroundings: around.as_ref(), calibration: self.calibration };
        let followed = (!how.without_route).then(|| Followed::new(scene.as_deref(), &walk.path, &evidence));
        let hears = some_are_open && !how.without_witnesses && walk.texts.len() > 1;
        // Records of this format have one writer, who makes the same mistakes in all texts.
        let testimony = |text: &Text| (hears && text.made.is_none()).then(|| Testimony::of(&text.words, &evidence));
        let testimonies: Vec<Option<Testimony>> = walk.texts.iter().map(testimony).collect();
        let checked = walk.texts.iter().zip(&testimonies).map(|(text, own)| {
            let known = self.held.style_of(text);
            let told = followed.as_ref().map(|followed| match followed {
                Ok(followed) => followed.follow(&text.words, text.tag.as_deref()),
                Err(why) => Told::unknown(why),
            });
            // People name a target as they like, so any object of the final viewpoint is accepted.
            let subject = match world_of(text) {
                World::Closed => Subject::closed(&evidence, &known.style, None),
                World::Open => Subject::open(&evidence, &known.style, reach),
            };
            let turns = told.as_ref().map_or(Turns::NotJudged("the text is not followed"), |told| told.turns);
            let subject = Subject { tag: text.tag.as_deref(), turns, ..subject.with_copies(&known.copies) };
            let mut checked = check(&text.words, subject);
            if let Some(told) = &told {
                told.add_to(&mut checked);
            }
            if let Some(own) = own.as_ref().filter(|_| checked.world == World::Open) {
                let others: Vec<&Testimony> = testimonies.iter().flatten().collect();
                lift(&mut checked, own, &others);
            }
            let ambiguity = told.as_ref().map(|told| told.ambiguity(&text.words, &evidence));
            checked.add(ambiguity.as_ref().filter(|_| how.reject_ambiguous).and_then(rejection));
            let mut shown = CheckedText::of(text, &checked);
            if how.doubts {
                let words = (text.words.as_str(), text.tag.as_deref());
                shown.doubted = Some(doubts(followed.as_ref(), words, &checked, ambiguity.as_ref()));
            }
            shown.ambiguity = ambiguity;
            if let Some(told) = told {
                (shown.route, shown.turn_gain) = (told.route, told.turn_gain);
            }
            (text.at, shown, checked.findings)
        });
        Ok((evidence.source.name(), checked.collect()))
    }
}
