//! A report as files: one page, or an overview with the walks on numbered pages beside it.

use crate::error::Error;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde::Serialize;
use std::{
    fs::{self, File},
    io::Read,
    ops::Range,
    path::{Path, PathBuf},
};

/// Walks of a page: with five pictures each, some ten megabytes, and some thirty sheets of paper.
pub(super) const WALKS_PER_PAGE: usize = 50;

/// What a name may hold in an address as it is.
const IN_ADDRESS: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// By this a page that this program wrote is known, within so many bytes of its beginning.
const MARK: &str = "<meta name=\"generator\" content=\"Wayword\">";
const MARK_WITHIN: u64 = 1024;

/// The files of a report.
pub(super) struct Book<'a> {
    out: &'a Path,
    walks: usize,
    per_page: usize,
}

/// The pages of walks, for a page that names them.
#[derive(Debug, Serialize)]
pub(super) struct Pager {
    /// Where the overview is.
    overview: String,
    pages: Vec<Leaf>,
}

/// A page of walks.
#[derive(Debug, Serialize)]
struct Leaf {
    href: String,
    /// The numbers of its walks, from 1.
    first: usize,
    last: usize,
    is_here: bool,
}

impl<'a> Book<'a> {
    /// The files for so many walks.
    pub(super) fn new(out: &'a Path, walks: usize, per_page: usize) -> Self {
        Self { out, walks, per_page }
    }

    /// How many pages of walks there are beside the overview; none where it holds them itself.
    pub(super) fn pages(&self) -> usize {
        if self.walks <= self.per_page { 0 } else { self.walks.div_ceil(self.per_page) }
    }

    /// The walks (from 0) of a page (from 1).
    pub(super) fn walks(&self, page: usize) -> Range<usize> {
        let first = (page - 1) * self.per_page;
        first..(first + self.per_page).min(self.walks)
    }

    /// The file of a page (from 1).
    pub(super) fn file(&self, page: usize) -> PathBuf {
        let mut name = self.out.file_stem().unwrap_or_default().to_owned();
        name.push(format!("-{page}"));
        if let Some(end) = self.out.extension() {
            name.push(".");
            name.push(end);
        }
        self.out.with_file_name(name)
    }

    /// The address of a walk (from 0), from any page.
    pub(super) fn address(&self, walk: usize, anchor: &str) -> String {
        let file = if self.pages() == 0 { String::new() } else { address(&self.file(walk / self.per_page + 1)) };
        format!("{file}#{anchor}")
    }

    /// The pages, as page `here` (from 1; none on the overview) names them; none where there is one file.
    pub(super) fn pager(&self, here: Option<usize>) -> Option<Pager> {
        let leaf = |page: usize| {
            let walks = self.walks(page);
            Leaf {
                href: address(&self.file(page)),
                first: walks.start + 1,
                last: walks.end,
                is_here: here == Some(page),
            }
        };
        let pages: Vec<Leaf> = (1..=self.pages()).map(leaf).collect();
        (!pages.is_empty()).then(|| Pager { overview: address(self.out), pages })
    }

    /// Removes the pages that a longer report left in this place.
    ///
    /// # Errors
    /// When one cannot be removed.
    pub(super) fn remove_older_pages(&self) -> Result<(), Error> {
        for file in (self.pages() + 1..).map(|page| self.file(page)).take_while(|file| is_ours(file)) {
            fs::remove_file(&file).map_err(Error::io(&file, "remove the older page"))?;
        }
        Ok(())
    }
}

/// A file in the same folder, as a link names it.
fn address(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    utf8_percent_encode(&name, IN_ADDRESS).to_string()
}

fn is_ours(file: &Path) -> bool {
    let mut beginning = Vec::new();
    let read = File::open(file).and_then(|file| file.take(MARK_WITHIN).read_to_end(&mut beginning));
    read.is_ok() && String::from_utf8_lossy(&beginning).contains(MARK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_walks_are_one_file_and_many_are_pages_beside_it() {
        let out = Path::new("runs/my report.html");
        let one = Book::new(out, 50, 50);
        assert_eq!((one.pages(), one.address(49, "w50")), (0, "#w50".to_owned()));
        assert!(one.pager(None).is_none());
        let many = Book::new(out, 101, 50);
        assert_eq!((many.pages(), many.walks(3)), (3, 100..101));
        assert_eq!(many.file(2), Path::new("runs/my report-2.html"));
        assert_eq!(many.address(50, "w51"), "my%20report-2.html#w51");
        let pager = many.pager(Some(3)).unwrap();
        assert_eq!(pager.overview, "my%20report.html");
        let told: Vec<_> = pager.pages.iter().map(|leaf| (leaf.first, leaf.last, leaf.is_here)).collect();
        assert_eq!(told, [(1, 50, false), (51, 100, false), (101, 101, true)]);
    }

    #[test]
    fn only_pages_of_our_own_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("report.html");
        let book = Book::new(&out, 120, 50);
        for page in 1..=5 {
            fs::write(book.file(page), format!("<!doctype html>{MARK}")).unwrap();
        }
        fs::write(book.file(6), "mine").unwrap();
        book.remove_older_pages().unwrap();
        let left: Vec<bool> = (1..=6).map(|page| book.file(page).exists()).collect();
        assert_eq!(left, [true, true, true, false, false, true]);
    }
}
