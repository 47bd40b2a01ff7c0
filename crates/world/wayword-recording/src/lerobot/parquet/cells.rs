//! The values of a column, one after another, a page in memory at a time.

use super::{
    footer::{Chunk, Leaf},
    page::{Cell, Dictionary, Header, Kind, Page},
};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
};

/// How much is read for a page's header: first what is enough for nearly all, then what is enough for one with long statistics.
const HEADER_BYTES: [u64; 2] = [1 << 9, 1 << 20];

/// The values of a column, in a group of rows.
pub(super) struct Cells<'a> {
    file: &'a File,
    leaf: &'a Leaf,
    chunk: Chunk,
    dictionary: Option<Dictionary>,
    page: Option<Page>,
}

impl<'a> Cells<'a> {
    pub(super) fn new(file: &'a File, leaf: &'a Leaf, chunk: Chunk) -> Self {
        Self { file, leaf, chunk, dictionary: None, page: None }
    }

    /// The next value; `None` after the last.
    ///
    /// # Errors
    /// With the byte of the file.
    pub(super) fn next(&mut self) -> Result<Option<Cell<'_>>, String> {
        while self.page.as_ref().is_none_or(|page| page.left == 0) {
            let Some(header) = self.header()? else { return Ok(None) };
            self.turn(&header)?;
        }
        let page = self.page.as_mut().map(|page| page.next(self.dictionary.as_ref()));
        page.transpose().map_err(|reason| format!("before byte {}: {reason}", self.chunk.start))
    }

    /// Passes over the values of some rows, of a column that does not repeat; pages of which nothing is wanted are not unfolded.
    ///
    /// # Errors
    /// With the byte of the file.
    pub(super) fn skip(&mut self, mut rows: u64) -> Result<(), String> {
        while rows > 0 {
            if self.page.as_ref().is_some_and(|page| page.left > 0) {
                self.next()?;
                rows -= 1;
                continue;
            }
            let Some(header) = self.header()? else { return Ok(()) };
            if matches!(header.kind, Kind::Values | Kind::Values2) && header.values <= rows {
                self.chunk.start += header.compressed;
                rows -= header.values;
            } else {
                self.turn(&header)?;
            }
        }
        Ok(())
    }

    /// The next page's header, and past it; `None` after the last page.
    fn header(&mut self) -> Result<Option<Header>, String> {
        let Chunk { start, end, .. } = self.chunk;
        if start >= end {
            return Ok(None);
        }
        let wrong = |reason: String| format!("byte {start}: no header of a page: {reason}");
        let mut tries = HEADER_BYTES.iter().map(|most| self.bytes((end - start).min(*most)));
        let (header, length) = loop {
            let bytes = tries.next().ok_or_else(|| wrong("it is too long".to_owned()))??;
            match Header::read(&bytes) {
                Ok((header, length)) => break (header, length as u64),
                Err(reason) if bytes.len() as u64 == (end - start).min(HEADER_BYTES[1]) => return Err(wrong(reason)),
                Err(_) => {}
            }
        };
        if header.compressed > end - start - length {
            return Err(wrong(format!(
                "a page of {} bytes where {} are left",
                header.compressed,
                end - start - length
            )));
        }
        self.chunk.start += length;
        Ok(Some(header))
    }

    /// Reads the page whose header has been read.
    fn turn(&mut self, header: &Header) -> Result<(), String> {
        let wrong = |reason: String| format!("page at byte {}: {reason}", self.chunk.start);
        let bytes = || self.bytes(header.compressed);
        match header.kind {
            Kind::Other => {}
            Kind::Dictionary => {
                self.dictionary = Some(Dictionary::new(header, self.chunk.codec, self.leaf, bytes()?).map_err(wrong)?);
            }
            Kind::Values | Kind::Values2 => {
                self.page = Some(Page::new(header, self.chunk.codec, self.leaf, bytes()?).map_err(wrong)?);
            }
        }
        self.chunk.start += header.compressed;
        Ok(())
    }

    /// Some bytes from where the column has been read to; they lie within the file.
    fn bytes(&self, count: u64) -> Result<Vec<u8>, String> {
        let at = self.chunk.start;
        let wrong = |error: std::io::Error| format!("byte {at}: {error}");
        let mut file = self.file;
        file.seek(SeekFrom::Start(at)).map_err(wrong)?;
        let mut bytes = Vec::new();
        file.take(count).read_to_end(&mut bytes).map_err(wrong)?;
        if bytes.len() as u64 != count {
            return Err(format!("byte {at}: the file ends early"));
        }
        Ok(bytes)
    }
}
