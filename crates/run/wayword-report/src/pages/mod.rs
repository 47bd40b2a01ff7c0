//! Draws a run as HTML pages: a list of all texts, and map, frames, dialogue, captions, instructions and checks of each path.
//!
//! A page is made item by item, so that memory does not limit its size, and the same run gives the same bytes. The pictures
//! lie in a folder beside the page, or within it. Everything from files or models is untrusted: the templates escape it, and
//! the pages' content security policy forbids remote addresses and all scripts but `report.js`, by its hash.

#[cfg(feature = "experiments")]
pub mod comparison;
pub mod curate;
pub(crate) mod data_uri;
pub mod doubts;
mod frames;
mod item_order;
mod item_record;
mod item_view;
mod link_targets;
pub(crate) mod map;
mod page;
pub(crate) mod palette;
mod picture_folder;
mod pictures;
mod provenance_words;
mod records;
#[cfg(feature = "experiments")]
pub mod replay;
mod report_files;
#[cfg(feature = "experiments")]
pub mod robustness;
mod rows;
pub(crate) mod sheet;
mod spans;
mod suspicion;
mod texts;

use item_view::ItemView;
use link_targets::item_anchor;
use minijinja::{AutoEscape, Environment, Output, State, UndefinedBehavior, Value, context, escape_formatter};
use page::ReportPageView;
use picture_folder::ReportPictures;
use pictures::PagePictures;
use records::ReportRecords;
use report_files::{ReportFiles, WALKS_PER_PAGE};
use rows::TextList;
use serde::Serialize;
use sha2::{Digest, Sha256};
use std::{borrow::Cow, fmt, io::Write, ops::Range, path::Path};
use wayword_formats::OutputFile;
use wayword_run::{check::CheckedAgain, count::count_phrase, error::CommandError, output::show_unseen};

/// Result of a report: its files, and how much of the run they show.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WrittenReport {
    /// The page, or the overview where there are several.
    pub page: String,
    /// Pages of paths, in their order.
    pub pages: Vec<String>,
    /// Items that are shown.
    pub items: usize,
    /// Items of the run that are not shown.
    pub left_out: usize,
    /// Pictures that are shown.
    pub pictures: usize,
    /// Pictures of these items that are not shown: missing, not a JPEG, too large, or the page was full.
    pub pictures_left_out: usize,
    /// Texts of the dataset that fail a check.
    pub wrong: usize,
}

/// How a report is written.
#[derive(Debug)]
pub struct ReportOptions {
    /// Most items that are shown; those with the most suspicious texts come first.
    pub most_items: usize,
    /// Whether the report is one file, with its pictures inside.
    pub is_single_file: bool,
    /// The texts as they were checked again; empty if they were not.
    pub again: CheckedAgain,
}

impl fmt::Display for WrittenReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.page)?;
        if let (Some(first), Some(last)) = (self.pages.first(), self.pages.last()) {
            write!(f, " and {} beside it, {first} to {last}", count_phrase(self.pages.len(), "page"))?;
        }
        write!(f, ": {}, {}", count_phrase(self.items, "item"), count_phrase(self.pictures, "picture"))?;
        if self.left_out > 0 {
            write!(f, "; {} left out (--items N shows more)", count_phrase(self.left_out, "item"))?;
        }
        if self.pictures_left_out > 0 {
            write!(f, "; {} left out", count_phrase(self.pictures_left_out, "picture"))?;
        }
        if self.wrong > 0 {
            write!(
                f,
                "; {} of the dataset {} a check",
                count_phrase(self.wrong, "text"),
                if self.wrong == 1 { "fails" } else { "fail" }
            )?;
        }
        Ok(())
    }
}

/// Writes the report of a run with the verdicts of the run, as [`write_report_as`] does.
///
/// # Errors
/// As [`write_report_as`].
pub fn write_report(run: &Path, out: &Path, most_items: usize) -> Result<WrittenReport, CommandError> {
    let options = ReportOptions { most_items, is_single_file: false, again: CheckedAgain::default() };
    write_report_as(run, out, &options)
}

/// Writes the report of a run. The new files replace old ones only when all of them are complete.
///
/// # Errors
/// When `run` is not a run folder, a line of it is not of its kind, another report's file is where a page of paths
/// belongs, or a page or a picture cannot be written.
pub fn write_report_as(run: &Path, out: &Path, options: &ReportOptions) -> Result<WrittenReport, CommandError> {
    let per_page = if options.is_single_file { usize::MAX } else { WALKS_PER_PAGE };
    write_paged(run, out, options, per_page)
}

fn write_paged(
    run: &Path,
    out: &Path,
    options: &ReportOptions,
    per_page: usize,
) -> Result<WrittenReport, CommandError> {
    let records = ReportRecords::read_run(run, options.most_items, &options.again)?;
    let files = ReportFiles::new(out, run, records.items.len(), per_page);
    files.expect_place_for_pages()?;
    files.refuse_to_replace_others()?;
    let folder = (!options.is_single_file).then(|| ReportPictures::beside_page(out)).transpose()?;
    let mut written = WrittenReport {
        page: out.display().to_string(),
        pages: (1..=files.page_count()).map(|page| files.page_file(page).display().to_string()).collect(),
        items: records.items.len(),
        left_out: records.left_out,
        pictures: 0,
        pictures_left_out: 0,
        wrong: records.counts.values().map(|counts| counts.wrong).sum(),
    };
    let templates = load_templates().map_err(template_error)?;
    let source =
        ReportPageSource { records: &records, book: &files, templates: &templates, run, folder: folder.as_ref() };
    let mut unfinished = Vec::new();
    for page in (1..=files.page_count()).map(Some).chain([None]) {
        let file = page.map_or_else(|| out.to_owned(), |page| files.page_file(page));
        let (made, pictures) = begin_page(&file, |take| source.draw_page(page, take))?;
        unfinished.push((made, file));
        written.pictures += pictures.shown;
        written.pictures_left_out += pictures.left_out;
    }
    for (page, file) in unfinished {
        page.finish().map_err(CommandError::io(file, "write"))?;
    }
    files.remove_older_pages()?;
    folder.map_or(Ok(()), |folder| folder.remove_unused())?;
    Ok(written)
}

/// Receives a page part by part, and writes or stores it.
type PageSink<'a> = dyn FnMut(&str) -> Result<(), CommandError> + 'a;

/// Writes a page; it replaces an old one only when it is complete.
fn replace_page<T>(
    out: &Path,
    render: impl FnOnce(&mut PageSink<'_>) -> Result<T, CommandError>,
) -> Result<T, CommandError> {
    let (page, result) = begin_page(out, render)?;
    page.finish().map_err(CommandError::io(out, "write"))?;
    Ok(result)
}

/// Draws a page that gets its name later.
fn begin_page<T>(
    out: &Path,
    render: impl FnOnce(&mut PageSink<'_>) -> Result<T, CommandError>,
) -> Result<(OutputFile, T), CommandError> {
    let failed = || CommandError::io(out, "write");
    let mut page = OutputFile::begin(out).map_err(failed())?;
    let result = render(&mut |part| page.write_all(part.as_bytes()).map_err(failed()))?;
    Ok((page, result))
}

/// Everything from which the pages of a report are drawn.
struct ReportPageSource<'a> {
    records: &'a ReportRecords<'a>,
    /// The files of the report, with the links between them.
    book: &'a ReportFiles<'a>,
    templates: &'a Environment<'static>,
    run: &'a Path,
    /// Where the pictures go; `None` if the pages contain them.
    folder: Option<&'a ReportPictures>,
}

impl<'a> ReportPageSource<'a> {
    /// Draws a page of paths (from 1), or the overview for `None`, and hands it to `take` part by part.
    fn draw_page(&self, page: Option<usize>, take: &mut PageSink<'_>) -> Result<PagePictures<'a>, CommandError> {
        let Self { records, book, .. } = self;
        let pager = book.pager_for_page(page);
        let walks: Range<usize> = match page {
            Some(page) => book.walks_on_page(page),
            None if pager.is_none() => 0..records.items.len(),
            None => 0..0,
        };
        let all = records.items.len() + records.left_out;
        let (first, last, shown) = (walks.start + 1, walks.end, records.items.len());
        let has_files = self.folder.is_some();
        let around =
            context! { pager, first, last, shown, has_files, walks => all, platform => records.settings.platform };
        let mut pictures = PagePictures::from_run(self.run, self.folder);
        match page {
            Some(_) => {
                let view = context! { page_of => book.page_of(), ..around.clone() };
                self.draw_part("leaf.html", view, take)?;
            }
            None => {
                let href = |walk: usize| book.walk_address(walk, &item_anchor(walk + 1));
                let rows = TextList::from_records(records, href, &mut pictures);
                let view = context! { ..Value::from_serialize(ReportPageView::new(records)), ..Value::from_serialize(rows), ..around.clone() };
                self.draw_part("head.html", view, take)?;
            }
        }
        for (at, record) in walks.clone().zip(&records.items[walks]) {
            let view = Value::from_serialize(ItemView::new(at + 1, record, records.again, &mut pictures));
            pictures.expect_written()?;
            self.draw_part("item.html", view, take)?;
        }
        pictures.expect_written()?;
        self.draw_part("pager.html", context! { pager_name => "Pages, again", ..around }, take)?;
        self.draw_part("script.html", context! {}, take)?;
        Ok(pictures)
    }

    fn draw_part(&self, name: &str, view: Value, take: &mut PageSink<'_>) -> Result<(), CommandError> {
        let part = self.templates.get_template(name).and_then(|template| template.render(view));
        take(&part.map_err(template_error)?)
    }
}

/// The only script of the pages. Their content security policy has its hash, so that no other one runs.
const SCRIPT: &str = include_str!("report.js");

fn load_templates() -> Result<Environment<'static>, minijinja::Error> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.set_auto_escape_callback(|name| if name.ends_with(".css") { AutoEscape::None } else { AutoEscape::Html });
    templates.set_formatter(write_shown);
    templates.set_trim_blocks(true);
    templates.set_lstrip_blocks(true);
    templates.set_keep_trailing_newline(true);
    templates.add_function("count", |number: u64, of: &str| count_phrase(number, of));
    templates.add_template("style.css", include_str!("style.css"))?;
    templates.add_template("signs.html", include_str!("signs.html"))?;
    templates.add_template("open.html", include_str!("open.html"))?;
    templates.add_template("head.html", include_str!("head.html"))?;
    templates.add_template("rows.html", include_str!("rows.html"))?;
    templates.add_global("script", SCRIPT);
    templates.add_global("script_hash", script_hash(SCRIPT));
    templates.add_template("script.html", include_str!("script.html"))?;
    templates.add_template("list_controls.html", include_str!("list_controls.html"))?;
    templates.add_template("item.css", include_str!("item.css"))?;
    templates.add_template("rows.css", include_str!("rows.css"))?;
    templates.add_template("leaf.html", include_str!("leaf.html"))?;
    templates.add_template("pager.html", include_str!("pager.html"))?;
    templates.add_template("map.html", include_str!("map.html"))?;
    templates.add_template("text.html", include_str!("text.html"))?;
    templates.add_template("item.html", include_str!("item.html"))?;
    templates.add_template("comparison.css", include_str!("comparison/style.css"))?;
    templates.add_template("comparison.html", include_str!("comparison/page.html"))?;
    templates.add_template("table.html", include_str!("comparison/table.html"))?;
    templates.add_template("forest.html", include_str!("comparison/forest.html"))?;
    templates.add_template("robustness.css", include_str!("robustness/style.css"))?;
    templates.add_template("robustness.html", include_str!("robustness/page.html"))?;
    templates.add_template("foot.html", include_str!("foot.html"))?;
    templates.add_template("doubts.css", include_str!("doubts/style.css"))?;
    templates.add_template("doubts.html", include_str!("doubts/page.html"))?;
    templates.add_template("doubts_leaf.html", include_str!("doubts/leaf.html"))?;
    templates.add_template("doubted_text.html", include_str!("doubts/text.html"))?;
    templates.add_template("curate.css", include_str!("curate/style.css"))?;
    templates.add_template("curate.html", include_str!("curate/page.html"))?;
    templates.add_template("annotations.html", include_str!("curate/annotations.html"))?;
    templates.add_template("curated_pair.html", include_str!("curate/pair.html"))?;
    templates.add_template("replay.html", include_str!("replay/replay.html"))?;
    Ok(templates)
}

/// The hash of a script as a content security policy has it.
fn script_hash(script: &str) -> String {
    format!("sha256-{}", data_uri::encode_base64(&Sha256::digest(script)))
}

/// Writes a value into a page, as minijinja does, with its unseen characters shown.
fn write_shown(out: &mut Output<'_>, state: &State<'_, '_>, value: &Value) -> Result<(), minijinja::Error> {
    match value.as_str().filter(|_| !value.is_safe()).map(show_unseen) {
        Some(Cow::Owned(shown)) => escape_formatter(out, state, &Value::from(shown)),
        _ => escape_formatter(out, state, value),
    }
}

// A closure's argument cannot be a reference where `map_err` gives the value away.
#[allow(clippy::needless_pass_by_value)]
fn template_error(error: minijinja::Error) -> CommandError {
    CommandError::usage(format!("the page cannot be drawn: {error:#}"), "report this as a bug")
}

#[cfg(test)]
mod tests;
