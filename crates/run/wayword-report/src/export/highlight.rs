//! `wayword export --highlight`: checks texts, and writes a page and a JSON file in which the doubtful words are marked.

use super::replace_file;
use crate::{
    export::args::ExportArgs,
    pages::doubts::{DoubtHighlights, write_json, write_page},
};
use serde::Serialize;
use std::{
    collections::BTreeSet,
    fmt,
    path::{Path, PathBuf},
};
use wayword_core::DoubtGrade;
use wayword_formats::OutputPlace;
use wayword_run::{
    check::{CheckOptions, check_file},
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    run_folder::{file, files_of_run, read_run_settings},
    settings::{AskedPlatform, AskedSettings},
    written_files::{find_output_place, refuse_over_input},
};

/// The written files, with how much in them is doubted. Printed at the end.
#[derive(Debug, Serialize)]
struct WrittenHighlights {
    page: PathBuf,
    file: PathBuf,
    #[serde(flatten)]
    highlights: DoubtCounts,
}

/// How much is doubted.
#[derive(Debug, Serialize)]
struct DoubtCounts {
    texts: usize,
    /// Texts with a doubt.
    doubted: usize,
    /// Texts that could not be followed, so no alternatives are known.
    unfollowed: usize,
    words: usize,
    /// Words that are likely wrong, and words that are uncertain.
    likely: usize,
    uncertain: usize,
}

impl fmt::Display for WrittenHighlights {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DoubtCounts { texts, doubted, unfollowed, words, likely, uncertain } = &self.highlights;
        writeln!(f, "{}: {doubted} with words to doubt", count_phrase(*texts, "text"))?;
        writeln!(
            f,
            "{}: {likely} {}, {uncertain} {}",
            count_phrase(*words, "word"),
            DoubtGrade::Likely.reader_label(),
            DoubtGrade::Uncertain.reader_label()
        )?;
        if *unfollowed > 0 {
            writeln!(f, "not followed: {}", count_phrase(*unfollowed, "text"))?;
        }
        write!(f, "written to {} and {}", self.page.display(), self.file.display())
    }
}

pub(super) fn write_highlights(args: &ExportArgs, name: &Path, output: &CommandOutput) -> Result<Exit, CommandError> {
    refuse_no_file(name)?;
    let [page, file] = ["html", "json"].map(|end| file_with_ending(name, end));
    for written in [&page, &file] {
        let read = args.texts.iter().cloned().chain(args.run.iter().flat_map(|run| files_of_run(run)));
        refuse_over_input("--highlight", written, read)?;
    }
    let highlights = find_highlights(args, output)?;
    replace_file(&file, output, || write_json(&file, &highlights))?;
    replace_file(&page, output, || write_page(&page, &highlights))?;
    let summary = &highlights.summary;
    let counts = DoubtCounts {
        texts: summary.texts,
        doubted: summary.doubted,
        unfollowed: summary.unfollowed,
        words: summary.words,
        likely: summary.words_of_grade(DoubtGrade::Likely),
        uncertain: summary.words_of_grade(DoubtGrade::Uncertain),
    };
    let written = WrittenHighlights { page, file, highlights: counts };
    output.print_result(&written, &written);
    Ok(Exit::Done)
}

/// Refuses standard output, a pipe and a device, because two files are written.
fn refuse_no_file(name: &Path) -> Result<(), CommandError> {
    let is_folder = name.is_dir() && name.as_os_str() != "-";
    if is_folder || matches!(find_output_place(name)?, OutputPlace::File(_)) {
        return Ok(());
    }
    let problem =
        format!("--highlight {}: a page and a file of JSON are written, and this takes only one", name.display());
    Err(CommandError::usage(problem, "give the name that both files have before their endings"))
}

/// The file with this name and ending. The user may have typed one of the two endings already; it is replaced.
fn file_with_ending(name: &Path, end: &str) -> PathBuf {
    let is_page = name.extension().is_some_and(|end| end == "html" || end == "json");
    let stem = if is_page { name.file_stem() } else { name.file_name() };
    let mut file = stem.unwrap_or_default().to_owned();
    file.push(".");
    file.push(end);
    name.with_file_name(file)
}

/// Checks the chosen texts, of a run or of a file, and returns their doubts.
fn find_highlights(args: &ExportArgs, output: &CommandOutput) -> Result<DoubtHighlights, CommandError> {
    refuse_dataset_flags(args)?;
    let options = CheckOptions { world: args.world, doubts: true, ..CheckOptions::default() };
    let report = match (&args.texts, &args.run[..]) {
        (Some(texts), []) => {
            let settings = AskedSettings::from(args.platform.clone()).resolve()?;
            check_file(texts, &settings, options, output)?
        }
        (None, [run]) => {
            refuse_platform_flags(args)?;
            let options = CheckOptions { captions: Some(run), ..options };
            check_file(&run.join(file::INSTRUCTIONS), &read_run_settings(run)?, options, output)?
        }
        _ => {
            let problem = "--highlight takes the texts of one run, or of one file";
            return Err(CommandError::usage(problem, "give either --run RUN or --texts FILE, once"));
        }
    };
    let styles: BTreeSet<String> = report.doubted.iter().filter_map(|text| text.style.clone()).collect();
    let highlights = DoubtHighlights::from_report(report, args.style.as_deref());
    if highlights.texts.is_empty() {
        let styles = styles.into_iter().collect::<Vec<_>>().join(", ");
        let hint = if styles.is_empty() { "give a file with texts".to_owned() } else { format!("there are: {styles}") };
        let style_words = args.style.as_ref().map_or_else(String::new, |style| format!(" of style {style}"));
        return Err(CommandError::usage(format!("there is no text{style_words}"), hint));
    }
    Ok(highlights)
}

fn refuse_dataset_flags(args: &ExportArgs) -> Result<(), CommandError> {
    if args.format.is_some() || args.out.is_some() || args.val_share.is_some() {
        let problem = "--highlight writes no dataset, so --format, --out and --val-share say nothing";
        return Err(CommandError::usage(problem, "leave them out, or export the dataset by itself"));
    }
    Ok(())
}

fn refuse_platform_flags(args: &ExportArgs) -> Result<(), CommandError> {
    if args.platform == AskedPlatform::default() {
        return Ok(());
    }
    let problem = "a run knows its platform and data";
    Err(CommandError::usage(problem, "leave out --platform, --data, --at and --island, or give --texts FILE"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_with_ending_replaces_an_ending_that_the_user_typed() {
        let names =
            |name: &str| ["html", "json"].map(|end| file_with_ending(Path::new(name), end).display().to_string());
        assert_eq!(names("a/doubts"), ["a/doubts.html", "a/doubts.json"]);
        assert_eq!(names("a/doubts.html"), ["a/doubts.html", "a/doubts.json"]);
        assert_eq!(names("v1.2"), ["v1.2.html", "v1.2.json"]);
    }
}
