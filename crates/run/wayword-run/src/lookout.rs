//! The detector of a run, with its measured figures (recall and false alarms) and the names that it looks for in every view.

use crate::{
    calls::ModelCalls, error::CommandError, own_format, settings::RunSettings, styles::MeasuredStyle, text_file,
};
use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};
use wayword_checks::detection::DetectorFigures;
use wayword_core::ObjectDetector;
use wayword_synthesis::detection::{CaptionDetector, parse_noun_list, usual_nouns};

/// A detector that looks for things along paths.
pub struct DetectorLookout {
    detector: Arc<dyn ObjectDetector>,
    figures: DetectorFigures,
    /// The names that it looks for in every view.
    nouns: Vec<String>,
    /// Views that it has looked at.
    views: AtomicUsize,
}

/// Rough number of names that the captions of a path add to the detector's own: a walk through a home names about this many
/// things.
const CAPTION_NAMES_PER_PATH: usize = 15;

/// Names that a detector looks for in every view, whatever captions name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DetectorProposals<'a> {
    /// No names.
    Off,
    /// The names of a file.
    File(&'a Path),
}

/// The value of `--proposals` that leaves them out.
pub(crate) const NO_PROPOSALS: &str = "off";

/// The choice of the settings; `None` for the built-in names.
pub(crate) fn asked_proposals(settings: &RunSettings) -> Option<DetectorProposals<'_>> {
    let asked = settings.proposals.as_deref()?;
    Some(if asked == Path::new(NO_PROPOSALS) { DetectorProposals::Off } else { DetectorProposals::File(asked) })
}

impl DetectorLookout {
    /// A detector with its measured figures and the names that it looks for in every view.
    #[must_use]
    pub fn new(detector: Arc<dyn ObjectDetector>, figures: DetectorFigures, nouns: Vec<String>) -> Self {
        Self { detector, figures, nouns, views: AtomicUsize::new(0) }
    }

    /// The detector of the settings; `None` where they name none.
    ///
    /// # Errors
    /// When it cannot be loaded, or a file that the settings name cannot be used.
    pub fn from_settings(
        settings: &RunSettings,
        calls: Option<&ModelCalls>,
        styles: &[MeasuredStyle],
    ) -> Result<Option<Self>, CommandError> {
        let (Some(name), Some(calls)) = (&settings.roles.detector, calls) else { return Ok(None) };
        let nouns = proposed_names(settings, styles)?;
        let detector = calls.open_detector(name)?;
        let figures = figures_or_assumed(settings.detector_figures.as_deref(), detector.as_ref())?;
        Ok(Some(Self::new(detector, figures, nouns)))
    }

    /// The form in which `wayword-synthesis` takes the detector.
    #[must_use]
    pub fn to_seeker(&self) -> CaptionDetector<'_> {
        CaptionDetector { detector: self.detector.as_ref(), figures: &self.figures, nouns: &self.nouns }
    }

    /// Adds to the number of views that it has looked at.
    pub(crate) fn add_views(&self, views: usize) {
        self.views.fetch_add(views, Ordering::Relaxed);
    }

    /// How many views it has looked at.
    #[must_use]
    pub fn view_count(&self) -> usize {
        self.views.load(Ordering::Relaxed)
    }

    /// Roughly how many calls a view takes: one if all names go into one prompt, else one for each name.
    pub(crate) fn calls_per_view(&self) -> u64 {
        if self.detector.scoring().phrases_interact { 1 } else { (self.nouns.len() + CAPTION_NAMES_PER_PATH) as u64 }
    }

    /// The detector's name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.detector.name()
    }
}

/// Refuses files for the detector of the settings that cannot be used, before a folder is made.
///
/// # Errors
/// When a file cannot be read, has no names, or was made for another detector.
pub(crate) fn check_detector_files(settings: &RunSettings, styles: &[MeasuredStyle]) -> Result<(), CommandError> {
    let Some(name) = &settings.roles.detector else { return Ok(()) };
    proposed_names(settings, styles)?;
    read_figures(settings.detector_figures.as_deref(), name).map(drop)
}

/// The names that the detector of the settings looks for by itself.
///
/// # Errors
/// When the file has none.
pub(crate) fn proposed_names(settings: &RunSettings, styles: &[MeasuredStyle]) -> Result<Vec<String>, CommandError> {
    match asked_proposals(settings) {
        Some(DetectorProposals::Off) => Ok(Vec::new()),
        Some(DetectorProposals::File(file)) => parse_noun_list(&text_file::read_text_file(file, "read the proposals")?)
            .ok_or_else(|| {
                let problem = format!("--proposals {}: it names nothing, or over 300 things", file.display());
                CommandError::usage(problem, "give a file with a name on each line, or off")
            }),
        None => Ok(usual_nouns(styles.iter().map(|measured| &measured.style))),
    }
}

/// The measured figures of a detector, or assumed ones if there is no file.
fn figures_or_assumed(file: Option<&Path>, detector: &dyn ObjectDetector) -> Result<DetectorFigures, CommandError> {
    let (name, found_from) = (detector.name(), detector.scoring().find_threshold);
    Ok(read_figures(file, name)?.unwrap_or_else(|| DetectorFigures::for_unmeasured(name, found_from)))
}

/// Reads the figures of the detector of that name.
fn read_figures(file: Option<&Path>, name: &str) -> Result<Option<DetectorFigures>, CommandError> {
    let Some(file) = file else { return Ok(None) };
    let hint = format!("make it with: wayword perceive --detector {name} --platform PLATFORM --figures FILE");
    let text = text_file::read_text_file(file, "read the detector's figures")?;
    let figures: DetectorFigures = own_format::parse_document(&text).map_err(|unread| {
        CommandError::usage(format!("{} has no figures of a detector: {unread}", file.display()), unread.hint_or(&hint))
    })?;
    if figures.detector != name {
        let problem = format!("{} was measured with {}, and not with {name}", file.display(), figures.detector);
        return Err(CommandError::usage(problem, hint));
    }
    Ok(Some(figures))
}
