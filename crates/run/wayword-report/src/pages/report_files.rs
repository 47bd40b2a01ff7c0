//! The files of a report: one page, or an overview and numbered pages with the paths (`report.html`, `report-1.html`, ...). Also
//! protects other files: a page carries a mark with the names of its report and run, and only pages with this mark are replaced.

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::Serialize;
use std::{
    fs::{self, File},
    io::Read,
    ops::Range,
    path::{Path, PathBuf},
};
use wayword_formats::OutputPlace;
use wayword_run::{error::CommandError, written_files::find_output_place};

/// Paths on a page: without pictures, they make one or two megabytes, so that a phone can open it.
pub(super) const WALKS_PER_PAGE: usize = 25;

/// Characters that are escaped in an address: all but letters, digits and `-._~`.
const ESCAPED_IN_ADDRESS: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// How many bytes from the beginning of a page are searched for its mark. The mark ends within them, however long its names are.
const MARK_SEARCH_BYTES: u64 = 4096;

/// The files of a report.
pub(super) struct ReportFiles<'a> {
    out: &'a Path,
    /// Which report a page of paths belongs to: the names of the overview and of the run folder, escaped as in
    /// addresses.
    page_of: String,
    walks: usize,
    per_page: usize,
}

/// The links from one page to the others.
#[derive(Debug, Serialize)]
pub(super) struct Pager {
    /// The address of the overview.
    overview: String,
    pages: Vec<PageLink>,
    /// The addresses of the pages before and after this one.
    previous: Option<String>,
    next: Option<String>,
}

/// A link to a page of paths.
#[derive(Debug, Serialize)]
struct PageLink {
    href: String,
    /// The numbers of its paths, from 1.
    first: usize,
    last: usize,
    is_here: bool,
}

impl<'a> ReportFiles<'a> {
    /// The files for `walks` paths of a run.
    pub(super) fn new(out: &'a Path, run: &Path, walks: usize, per_page: usize) -> Self {
        // "." has a name, too. The folders around it stay private, because pages are passed on.
        let run = fs::canonicalize(run).unwrap_or_else(|_| run.to_owned());
        Self { out, page_of: format!("{} {}", file_address(out), file_address(&run)), walks, per_page }
    }

    /// The mark of a page of paths, so that no other report's page is taken for it.
    pub(super) fn page_of(&self) -> &str {
        &self.page_of
    }

    /// Number of pages of paths; 0 if the overview contains the paths itself.
    pub(super) fn page_count(&self) -> usize {
        if self.walks <= self.per_page { 0 } else { self.walks.div_ceil(self.per_page) }
    }

    /// The paths (from 0) of a page (from 1).
    pub(super) fn walks_on_page(&self, page: usize) -> Range<usize> {
        let first = (page - 1) * self.per_page;
        first..(first + self.per_page).min(self.walks)
    }

    /// The file of a page (from 1).
    pub(super) fn page_file(&self, page: usize) -> PathBuf {
        let mut name = self.out.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{page}"));
        if let Some(end) = self.out.extension() {
            name.push(".");
            name.push(end);
        }
        self.out.with_file_name(name)
    }

    /// The address of a path (from 0), from any page.
    pub(super) fn walk_address(&self, walk: usize, anchor: &str) -> String {
        let file = if self.page_count() == 0 {
            String::new()
        } else {
            file_address(&self.page_file(walk / self.per_page + 1))
        };
        format!("{file}#{anchor}")
    }

    /// The links on page `here` (from 1; `None` for the overview); `None` if the report is one file.
    pub(super) fn pager_for_page(&self, here: Option<usize>) -> Option<Pager> {
        let leaf = |page: usize| {
            let walks = self.walks_on_page(page);
            PageLink {
                href: file_address(&self.page_file(page)),
                first: walks.start + 1,
                last: walks.end,
                is_here: here == Some(page),
            }
        };
        let pages: Vec<PageLink> = (1..=self.page_count()).map(leaf).collect();
        let address =
            |page: usize| (1..=self.page_count()).contains(&page).then(|| file_address(&self.page_file(page)));
        let previous = here.and_then(|here| address(here - 1));
        let next = address(here.map_or(1, |here| here + 1));
        (!pages.is_empty()).then(|| Pager { overview: file_address(self.out), pages, previous, next })
    }

    /// Refuses a name that cannot take the report: one that leads to a folder, and for several pages one that is no file.
    ///
    /// # Errors
    /// When the name is such a one.
    pub(super) fn expect_place_for_pages(&self) -> Result<(), CommandError> {
        let place = find_output_place(self.out)?;
        if self.page_count() == 0 || matches!(place, OutputPlace::File(_)) {
            return Ok(());
        }
        let problem = format!(
            "--out {}: the report has {} items, and more than {} go to several files",
            self.out.display(),
            self.walks,
            self.per_page
        );
        Err(CommandError::usage(problem, format!("give the name of a file, or --items {}", self.per_page)))
    }

    /// Refuses to replace files that are not pages of this report, because they may be another run's.
    ///
    /// # Errors
    /// When one of them would be replaced.
    pub(super) fn refuse_to_replace_others(&self) -> Result<(), CommandError> {
        let is_other = |file: &PathBuf| fs::symlink_metadata(file).is_ok() && !self.is_page_of_this_report(file);
        match (1..=self.page_count()).map(|page| self.page_file(page)).find(is_other) {
            Some(file) => Err(CommandError::usage(
                format!("{}: it exists, and is not a page of this report", file.display()),
                "give another name with --out, or remove the file",
            )),
            None => Ok(()),
        }
    }

    /// Removes the pages that a longer report of the same run left in this place.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub(super) fn remove_older_pages(&self) -> Result<(), CommandError> {
        for file in (self.page_count() + 1..)
            .map(|page| self.page_file(page))
            .take_while(|file| self.is_page_of_this_report(file))
        {
            fs::remove_file(&file).map_err(CommandError::io(&file, "remove the older page"))?;
        }
        Ok(())
    }

    /// Whether a file carries the mark of this report, so that it is one of the report's pages of paths.
    fn is_page_of_this_report(&self, file: &Path) -> bool {
        let mut beginning = Vec::new();
        let read = File::open(file).and_then(|file| file.take(MARK_SEARCH_BYTES).read_to_end(&mut beginning));
        read.is_ok() && String::from_utf8_lossy(&beginning).contains(&page_mark(&self.page_of))
    }
}

/// The mark of a page of paths, as in `open.html`.
fn page_mark(page_of: &str) -> String {
    format!("<meta name=\"wayword-page-of\" content=\"{page_of}\">")
}

/// The link to a file in the same folder.
pub(super) fn file_address(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    utf8_percent_encode(&name, ESCAPED_IN_ADDRESS).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_walks_are_one_file_and_many_are_pages_beside_it() {
        let out = Path::new("runs/my report.html");
        let one = ReportFiles::new(out, Path::new("runs"), 50, 50);
        assert_eq!((one.page_count(), one.walk_address(49, "w50")), (0, "#w50".to_owned()));
        assert!(one.pager_for_page(None).is_none());
        let many = ReportFiles::new(out, Path::new("runs"), 101, 50);
        assert_eq!((many.page_count(), many.walks_on_page(3)), (3, 100..101));
        assert_eq!(many.page_file(2), Path::new("runs/my report-2.html"));
        assert_eq!(many.walk_address(50, "w51"), "my%20report-2.html#w51");
        let pager = many.pager_for_page(Some(3)).unwrap();
        assert_eq!(pager.overview, "my%20report.html");
        assert_eq!((pager.previous.as_deref(), pager.next), (Some("my%20report-2.html"), None));
        let from_overview = many.pager_for_page(None).unwrap();
        assert_eq!((from_overview.previous, from_overview.next.as_deref()), (None, Some("my%20report-1.html")));
        let told: Vec<_> = pager.pages.iter().map(|leaf| (leaf.first, leaf.last, leaf.is_here)).collect();
        assert_eq!(told, [(1, 50, false), (51, 100, false), (101, 101, true)]);
    }

    #[test]
    fn only_pages_of_our_own_are_replaced_and_removed() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("my report.html");
        let book = ReportFiles::new(&out, Path::new("runs/a"), 120, 50);
        let others = ReportFiles::new(&out, Path::new("runs/b"), 120, 50);
        let page = |book: &ReportFiles<'_>| format!("<!doctype html>{}", page_mark(book.page_of()));
        for number in 1..=5 {
            fs::write(book.page_file(number), page(&book)).unwrap();
        }
        fs::write(book.page_file(6), page(&others)).unwrap();
        book.refuse_to_replace_others().unwrap();
        book.remove_older_pages().unwrap();
        let left: Vec<bool> = (1..=6).map(|number| book.page_file(number).exists()).collect();
        assert_eq!(left, [true, true, true, false, false, true]);
        for text in ["mine".to_owned(), page(&others)] {
            fs::write(book.page_file(2), text).unwrap();
            let refused = book.refuse_to_replace_others().unwrap_err().to_string();
            assert!(refused.contains("my report-2.html") && refused.contains("--out"), "{refused}");
        }
    }
}
