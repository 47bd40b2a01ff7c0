//! `wayword align`: finds for each part of a text the frames of its path that it describes.

use crate::{
    check::path_texts::{FileText, PathTexts, read_path_texts},
    error::{CommandError, Exit},
    follow::{FollowedPath, KnownScenes},
    interrupt,
    output::CommandOutput,
    pipeline::path_panoramas,
    platforms::{self, RememberingPlatform},
    settings::{AskedPlatform, AskedSettings},
    text_language::warn_of_foreign,
};
use clap::Args;
use rayon::prelude::*;
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_checks::{Evidence, WalkMemory, put_parts_into_text};
use wayword_core::{InstructionPart, Platform};
use wayword_language::languages::ReadableText;

/// `wayword align`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword align R2R_val_seen.json --platform matterport --data DATA
  wayword align runs/houses/instructions.jsonl --platform house --json

A part is one or a few steps of the text, such as \"go past the sofa\". Its frames are those of the path in the file, numbered from 0,
and the next part begins where it ends. The confidence is the probability that it takes exactly these frames. On viewpoint graphs it
was fitted to people's texts (docs/RESULTS.md); where frames lie close together and labels are known, the division counts in which the
fewest claims of the text are false, and nothing is fitted.")]
pub struct AlignArgs {
    /// File of instructions: R2R, REVERIE, RxR, VLN-CE or Wayword.
    pub file: PathBuf,
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
}

/// The result of `wayword align`, which `--json` prints.
#[derive(Debug, Serialize)]
pub struct AlignReport {
    /// Texts with an alignment.
    pub aligned: usize,
    /// Every text, in the order of the file.
    pub texts: Vec<AlignedText>,
}

/// A text with its parts.
#[derive(Debug, Serialize)]
pub struct AlignedText {
    /// The id of its path.
    pub path: String,
    /// Its words.
    pub text: String,
    /// Its parts in order; none if it could not be aligned.
    pub parts: Vec<InstructionPart>,
    /// Why it could not be aligned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unaligned: Option<&'static str>,
}

/// Runs `wayword align`, and prints the parts.
///
/// # Errors
/// When the file or the platform's data cannot be read, or a path does not fit the data.
pub fn run_align(args: &AlignArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let report = align_file(args, output)?;
    output.print_result(&report, AlignReportText(&report));
    Ok(Exit::Done)
}

/// Aligns every text of a file with its path.
///
/// # Errors
/// As [`run_align`].
pub fn align_file(args: &AlignArgs, output: &CommandOutput) -> Result<AlignReport, CommandError> {
    let settings = AskedSettings::from(args.platform.clone()).resolve()?;
    let platform = platforms::open_platform(&settings)?;
    let walks = read_path_texts(&args.file, platform.as_ref())?;
    warn_of_foreign("", walks.iter().flat_map(|walk| &walk.texts).map(|text| text.words.as_str()), output);
    let scenes = KnownScenes::new();
    let bar = output.progress_bar(walks.len(), "paths");
    let align = |walk: &PathTexts| {
        interrupt::check_interrupt()?;
        let texts = align_walk(walk, platform.as_ref(), &scenes)?;
        bar.inc(1);
        Ok(texts)
    };
    let aligned = walks.par_iter().map(align).collect::<Result<Vec<_>, CommandError>>()?;
    bar.finish_and_clear();
    let mut texts: Vec<(usize, AlignedText)> = aligned.into_iter().flatten().collect();
    texts.sort_by_key(|(at, _)| *at);
    let texts: Vec<AlignedText> = texts.into_iter().map(|(_, text)| text).collect();
    Ok(AlignReport { aligned: texts.iter().filter(|text| text.unaligned.is_none()).count(), texts })
}

/// Aligns the texts of one path, each with its place in the file.
fn align_walk(
    walk: &PathTexts,
    platform: &dyn Platform,
    scenes: &KnownScenes,
) -> Result<Vec<(usize, AlignedText)>, CommandError> {
    let views = path_panoramas(&RememberingPlatform::new(platform), &walk.path)?;
    let evidence = Evidence::from_labels(&walk.path, &views).unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
    // Only a path along the viewpoints of a graph needs the survey of its scene.
    let is_on_graph = walk.path.frames.iter().all(|frame| frame.viewpoint.is_some());
    let scene = is_on_graph.then(|| scenes.get_or_survey(platform, &walk.path.scene)).transpose()?;
    let followed = FollowedPath::new(platform, scene.as_deref(), &walk.path, &evidence);
    let memory = WalkMemory::from_path(&evidence, &walk.path);
    let align = |text: &FileText| {
        let known = (&evidence, &memory);
        let words = ReadableText::new(&text.words, text.tag.as_deref());
        let align = |followed: &FollowedPath<'_>| {
            let mut parts = followed.align_text(words.english(), words.english_tag(text.tag.as_deref()), known)?;
            put_parts_into_text(&mut parts, &words);
            Ok(parts)
        };
        (text.at, AlignedText::new(text, followed.as_ref().map_err(|why| *why).and_then(align)))
    };
    Ok(walk.texts.iter().map(align).collect())
}

impl AlignedText {
    fn new(text: &FileText, aligned: Result<Vec<InstructionPart>, &'static str>) -> Self {
        let (parts, unaligned) = match aligned {
            Ok(parts) => (parts, None),
            Err(why) => (Vec::new(), Some(why)),
        };
        Self { path: text.path.clone(), text: text.words.clone(), parts, unaligned }
    }
}

/// The report for a terminal: each text with a line for each part.
struct AlignReportText<'a>(&'a AlignReport);

impl fmt::Display for AlignReportText<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for text in &self.0.texts {
            writeln!(out, "{}", text.path)?;
            if let Some(why) = text.unaligned {
                writeln!(out, "  not aligned: {why}: {:?}", text.text)?;
            }
            for InstructionPart { span: [from, to], frames, confidence } in &text.parts {
                let words = text.text.get(*from..*to).unwrap_or_default();
                let [first, last] = frames;
                let percent = confidence.map_or_else(String::new, |share| format!(" ({:>3.0} %)", 100.0 * share));
                writeln!(out, "  frames {first:>2} to {last:>2}{percent}  {words}")?;
            }
        }
        write!(out, "{} of {} texts aligned", self.0.aligned, self.0.texts.len())
    }
}
