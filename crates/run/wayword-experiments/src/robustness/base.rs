//! Reads the run that is tested for robustness: its settings, paths, styles and texts.

use std::{
    collections::BTreeMap,
    path::{Path as FilePath, PathBuf},
};
use wayword_core::Path;
use wayword_formats::jsonl;
use wayword_report::pages::robustness::results::RepeatedTexts;
use wayword_run::{
    error::CommandError,
    run_folder::{WalkRecord, expect_run, file, lines, read_run_settings},
    settings::{RunSettings, TargetMode},
    styles::{self, MeasuredStyle},
};

/// Refuses a run with texts in another language, since the texts of two worlds are compared by their English words.
fn refuse_other_languages(folder: &FilePath, styles: &[MeasuredStyle]) -> Result<(), CommandError> {
    let other = styles.iter().find(|style| !matches!(style.style.language.as_str(), "" | "en"));
    other.map_or(Ok(()), |style| {
        let MeasuredStyle { style, .. } = style;
        let problem = format!(
            "{}: style {} is written in the language {:?}, and robustness compares English texts",
            folder.display(),
            style.name,
            style.language
        );
        Err(CommandError::usage(problem, "test a run of the same paths with --language en"))
    })
}

/// A run: its settings, paths, styles and texts.
pub(super) struct BaseRun {
    pub(super) folder: PathBuf,
    /// Its settings, with one text for each path and style.
    pub(super) settings: RunSettings,
    pub(super) paths: Vec<Path>,
    pub(super) styles: Vec<MeasuredStyle>,
    /// Its first texts, by path and style.
    texts: BTreeMap<(String, String), String>,
}

impl BaseRun {
    /// Reads a run folder.
    ///
    /// # Errors
    /// When it cannot be read, a style is not known, or no path is left.
    pub(super) fn read_run(folder: &FilePath, limit: Option<u32>) -> Result<Self, CommandError> {
        expect_run(folder)?;
        let settings = RunSettings { per_path: 1, ..read_run_settings(folder)? };
        let styles = styles::find_run_styles(&settings)?;
        refuse_other_languages(folder, &styles)?;
        let max_paths = limit.map_or(usize::MAX, |limit| limit as usize);
        let mut paths: Vec<Path> = Vec::new();
        lines::each_line(&folder.join(file::WALKS), |line| {
            if paths.len() < max_paths {
                let WalkRecord { mut path, .. } = line.parse()?;
                // The words that distinguish the target from other things depend on the world, so every world finds them anew.
                if let Some(target) = &mut path.target {
                    target.told_by.clear();
                    target.descriptions.clear();
                }
                path.target = path.target.filter(|_| settings.target == TargetMode::Given);
                paths.push(path);
            }
            Ok(())
        })?;
        if paths.is_empty() {
            let problem = format!("{}: the run has no path yet", folder.display());
            return Err(CommandError::usage(problem, "finish it with the same `wayword generate` command"));
        }
        let mut texts = BTreeMap::new();
        for record in jsonl::read_records(&folder.join(file::INSTRUCTIONS))? {
            let key = (record.path.id.clone(), record.instruction.style.clone());
            texts.entry(key).or_insert(record.instruction.text);
        }
        Ok(Self { folder: folder.to_owned(), settings, paths, styles, texts })
    }

    /// Counts how many of these texts, given with path and style, are equal to the run's own.
    pub(super) fn count_equal_texts<'t>(
        &self,
        texts: impl Iterator<Item = (&'t str, &'t str, Option<&'t str>)>,
    ) -> RepeatedTexts {
        let mut repeated = RepeatedTexts::default();
        for (path, style, text) in texts {
            let before = self.texts.get(&(path.to_owned(), style.to_owned())).map(String::as_str);
            repeated.of += 1;
            repeated.equal += usize::from(before == text);
        }
        repeated
    }
}
