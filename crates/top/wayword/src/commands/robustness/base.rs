//! The run whose texts are written again.

use crate::{
    error::Error,
    run::{WalkRecord, file, lines, settings_of},
    settings::{Settings, TargetMode},
    styles::{self, Measured},
};
use serde::{Deserialize, Serialize};
use std::{
    collections::BTreeMap,
    path::{Path as FilePath, PathBuf},
};
use wayword_core::Path;
use wayword_formats::jsonl;

/// A run: its settings, paths, styles and texts.
pub(super) struct Base {
    pub(super) folder: PathBuf,
    /// Its settings, with one text for each path and style.
    pub(super) settings: Settings,
    pub(super) paths: Vec<Path>,
    pub(super) styles: Vec<Measured>,
    /// Its first texts, by path and style.
    texts: BTreeMap<(String, String), String>,
}

/// How many of the texts that were written again are those of the run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Again {
    pub(crate) equal: usize,
    pub(crate) of: usize,
}

impl Base {
    /// Reads a run folder.
    ///
    /// # Errors
    /// When it cannot be read, a style is not known, or no path is left.
    pub(super) fn read(folder: &FilePath, limit: Option<u32>) -> Result<Self, Error> {
        let settings = Settings { per_path: 1, ..settings_of(folder)? };
        let styles = styles::find(&settings.style)?;
        let most = limit.map_or(usize::MAX, |limit| limit as usize);
        let mut paths: Vec<Path> = Vec::new();
        lines::each(&folder.join(file::WALKS), |line| {
            if paths.len() < most {
                let WalkRecord { mut path, .. } = line.parse()?;
                // How the target is told from other things is found again in every world.
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
            return Err(Error::usage(problem, "finish it with the same `wayword generate` command"));
        }
        let mut texts = BTreeMap::new();
        for record in jsonl::read(&folder.join(file::INSTRUCTIONS))? {
            let key = (record.path.id.clone(), record.instruction.style.clone());
            texts.entry(key).or_insert(record.instruction.text);
        }
        Ok(Self { folder: folder.to_owned(), settings, paths, styles, texts })
    }

    /// How many of these texts, by path and style, are those of the run.
    pub(super) fn again<'t>(&self, texts: impl Iterator<Item = (&'t str, &'t str, Option<&'t str>)>) -> Again {
        let mut again = Again::default();
        for (path, style, text) in texts {
            let before = self.texts.get(&(path.to_owned(), style.to_owned())).map(String::as_str);
            again.of += 1;
            again.equal += usize::from(before == text);
        }
        again
    }
}
