//! The detector of a run, with its measured figures (recall and false alarms) and the names that it looks for in every view.

use crate::{calls::Calls, error::Error, own_format, settings::Settings, styles::Measured, text_file};
use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};
use wayword_checks::detected::DetectorFigures;
use wayword_core::Detector;
use wayword_synthesis::detection::{Seeker, listed, usual};

/// A detector that looks for things along paths.
pub struct Lookout {
    detector: Arc<dyn Detector>,
    figures: DetectorFigures,
    nouns: Vec<String>,
    /// Views that it has looked at.
    views: AtomicUsize,
}

/// Rough number of names that the captions of a path add to the detector's own: a walk through a home names about this many
/// things.
const NAMED: usize = 15;

/// Names that a detector looks for in every view, whatever captions name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Proposals<'a> {
    /// No names.
    Off,
    /// The names of a file.
    File(&'a Path),
}

/// The value of `--proposals` that leaves them out.
pub(crate) const NO_PROPOSALS: &str = "off";

/// The choice of the settings; `None` for the built-in names.
pub(crate) fn proposals(settings: &Settings) -> Option<Proposals<'_>> {
    let asked = settings.proposals.as_deref()?;
    Some(if asked == Path::new(NO_PROPOSALS) { Proposals::Off } else { Proposals::File(asked) })
}

impl Lookout {
    /// A detector with its measured figures and the names that it looks for in every view.
    #[must_use]
    pub fn new(detector: Arc<dyn Detector>, figures: DetectorFigures, nouns: Vec<String>) -> Self {
        Self { detector, figures, nouns, views: AtomicUsize::new(0) }
    }

    /// The detector of the settings; `None` where they name none.
    ///
    /// # Errors
    /// When it cannot be loaded, or a file that the settings name cannot be used.
    pub fn of(settings: &Settings, calls: Option<&Calls>, styles: &[Measured]) -> Result<Option<Self>, Error> {
        let (Some(name), Some(calls)) = (&settings.roles.detector, calls) else { return Ok(None) };
        let nouns = nouns(settings, styles)?;
        let detector = calls.detector(name)?;
        let figures = figures(settings.detector_figures.as_deref(), detector.as_ref())?;
        Ok(Some(Self::new(detector, figures, nouns)))
    }

    /// The form in which `wayword-synthesis` takes the detector.
    #[must_use]
    pub fn seeker(&self) -> Seeker<'_> {
        Seeker { detector: self.detector.as_ref(), figures: &self.figures, nouns: &self.nouns }
    }

    /// Adds to the number of views that it has looked at.
    pub(crate) fn has_looked_at(&self, views: usize) {
        self.views.fetch_add(views, Ordering::Relaxed);
    }

    /// How many views it has looked at.
    #[must_use]
    pub fn views(&self) -> usize {
        self.views.load(Ordering::Relaxed)
    }

    /// Roughly how many calls a view takes: one if all names go into one prompt, else one for each name.
    pub(crate) fn calls_per_view(&self) -> u64 {
        if self.detector.scoring().phrases_meet { 1 } else { (self.nouns.len() + NAMED) as u64 }
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
pub(crate) fn check(settings: &Settings, styles: &[Measured]) -> Result<(), Error> {
    let Some(name) = &settings.roles.detector else { return Ok(()) };
    nouns(settings, styles)?;
    measured(settings.detector_figures.as_deref(), name).map(drop)
}

/// The names that the detector of the settings looks for by itself.
///
/// # Errors
/// When the file has none.
pub(crate) fn nouns(settings: &Settings, styles: &[Measured]) -> Result<Vec<String>, Error> {
    match proposals(settings) {
        Some(Proposals::Off) => Ok(Vec::new()),
        Some(Proposals::File(file)) => listed(&text_file::read(file, "read the proposals")?).ok_or_else(|| {
            let problem = format!("--proposals {}: it names nothing, or over 300 things", file.display());
            Error::usage(problem, "give a file with a name on each line, or off")
        }),
        None => Ok(usual(styles.iter().map(|measured| &measured.style))),
    }
}

/// The measured figures of a detector, or assumed ones if there is no file.
fn figures(file: Option<&Path>, detector: &dyn Detector) -> Result<DetectorFigures, Error> {
    let (name, found_from) = (detector.name(), detector.scoring().found_from);
    Ok(measured(file, name)?.unwrap_or_else(|| DetectorFigures::assumed(name, found_from)))
}

/// Reads the figures of the detector of that name.
fn measured(file: Option<&Path>, name: &str) -> Result<Option<DetectorFigures>, Error> {
    let Some(file) = file else { return Ok(None) };
    let hint = format!("make it with: wayword perceive --detector {name} --platform PLATFORM --figures FILE");
    let text = text_file::read(file, "read the detector's figures")?;
    let figures: DetectorFigures = own_format::read(&text).map_err(|unread| {
        Error::usage(format!("{} has no figures of a detector: {unread}", file.display()), unread.hint(&hint))
    })?;
    if figures.detector != name {
        let problem = format!("{} was measured with {}, and not with {name}", file.display(), figures.detector);
        return Err(Error::usage(problem, hint));
    }
    Ok(Some(figures))
}
