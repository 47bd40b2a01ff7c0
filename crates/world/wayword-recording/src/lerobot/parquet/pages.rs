//! The pages of a column, unfolded within a bound.
//!
//! The crate takes as much memory for a page as its header announces, up to 2 GiB, and unfolds gzip to any length. So it is told
//! that pages are not compressed, and they are unfolded here before it decodes them. That also needs no Zstandard in C.

use parquet::{
    basic::{CompressionCodec, Encoding},
    column::page::{Page, PageMetadata, PageReader},
    errors::ParquetError,
    file::{metadata::ColumnChunkMetaData, serialized_reader::SerializedPageReader},
};
use ruzstd::StreamingDecoder;
use std::{
    fs::File,
    io::Read,
    ops::Range,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
};

/// Pages may unfold to this much, bytes: writers close them at 1 MiB.
const USUAL_BYTES: usize = 8 << 20;
/// And larger ones to this many times of what they are compressed.
const MAX_RATIO: usize = 256;
/// Values that the pages of a few rows may announce in any file, and for each of its bytes. A page whose values are all the same
/// takes a few bytes for any number of them, but there are other columns whose values are not.
const USUAL_VALUES: u64 = 16 << 20;
const MAX_VALUES_PER_BYTE: u64 = 64;

/// Where a column lies in its file; `None` where that cannot be.
pub(super) fn place(chunk: &ColumnChunkMetaData) -> Option<Range<u64>> {
    let start = u64::try_from(dictionary_at(chunk).unwrap_or(chunk.data_page_offset())).ok()?;
    Some(start..start.checked_add(u64::try_from(chunk.compressed_size()).ok()?)?)
}

/// Some writers say 0 where there is no dictionary.
fn dictionary_at(chunk: &ColumnChunkMetaData) -> Option<i64> {
    chunk.dictionary_page_offset().filter(|at| (1..chunk.data_page_offset()).contains(at))
}

/// The pages of a column, in a group of rows.
pub(super) struct Pages {
    stored: SerializedPageReader<File>,
    codec: CompressionCodec,
    /// Values of the pages that were read since this was last 0.
    announced: Arc<AtomicU64>,
    max_announced: u64,
}

impl Pages {
    /// The pages of a column whose place lies within the file. What they announce is added to `announced`.
    pub(super) fn new(
        file: File,
        chunk: &ColumnChunkMetaData,
        announced: Arc<AtomicU64>,
    ) -> Result<Self, ParquetError> {
        let codec = chunk.compression_codec();
        let max_announced = file.metadata()?.len().saturating_mul(MAX_VALUES_PER_BYTE).max(USUAL_VALUES);
        let as_stored = chunk.clone().into_builder().set_compression_codec(CompressionCodec::UNCOMPRESSED);
        let as_stored = as_stored.set_dictionary_page_offset(dictionary_at(chunk)).build()?;
        let stored = SerializedPageReader::new(Arc::new(file), &as_stored, 0, None)?;
        Ok(Self { stored, codec, announced, max_announced })
    }

    /// A page that was read, unfolded; what it announces is held against its length and the file's.
    fn whole(&self, mut page: Page) -> Result<Page, String> {
        let (buf, front) = match &mut page {
            Page::DictionaryPage { buf, .. } | Page::DataPage { buf, .. } => (buf, Some(0)),
            // Levels of the second version are not compressed.
            Page::DataPageV2 { buf, rep_levels_byte_len, def_levels_byte_len, is_compressed, .. } => {
                let levels = u64::from(*rep_levels_byte_len) + u64::from(*def_levels_byte_len);
                let levels = usize::try_from(levels).ok().filter(|levels| *levels <= buf.len());
                let levels = levels.ok_or("levels are longer than their page")?;
                (buf, is_compressed.then_some(levels))
            }
        };
        if let Some(front) = front.filter(|_| self.codec != CompressionCodec::UNCOMPRESSED) {
            let (front, folded) = buf.split_at(front);
            *buf = unfolded(self.codec, front, folded)?.into();
        }
        self.check(&page)?;
        Ok(page)
    }

    fn check(&self, page: &Page) -> Result<(), String> {
        let (values, bytes) = (u64::from(page.num_values()), page.buffer().len());
        if page.is_dictionary_page() {
            // An entry takes at least four bytes in all kinds of columns that are read here.
            let fits = values <= bytes as u64 / 4;
            return if fits { Ok(()) } else { Err(format!("a dictionary of {values} entries in {bytes} bytes")) };
        }
        // Those of texts that tell how a text differs from the last are not among them: they take memory for any number of texts.
        match page.encoding() {
            Encoding::PLAIN | Encoding::PLAIN_DICTIONARY | Encoding::RLE_DICTIONARY => {}
            Encoding::DELTA_BINARY_PACKED | Encoding::BYTE_STREAM_SPLIT => {}
            other => return Err(format!("values are encoded as {other}, which is not read here")),
        }
        let announced = self.announced.fetch_add(values, Relaxed).saturating_add(values);
        if announced > self.max_announced {
            return Err(format!("its pages announce {announced} values for a few rows"));
        }
        Ok(())
    }
}

impl Iterator for Pages {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for Pages {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        while let Some(page) = self.stored.get_next_page()? {
            // To the crate a page without values is the end.
            if page.is_dictionary_page() || page.num_values() > 0 {
                return self.whole(page).map(Some).map_err(ParquetError::General);
            }
        }
        Ok(None)
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        let next = self.stored.peek_next_page()?;
        // Rows are passed over in columns alone that do not repeat. There a page has as many rows as values, whatever it says.
        Ok(next.map(|page| PageMetadata { num_rows: page.num_rows.and(page.num_levels), ..page }))
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        self.stored.skip_next_page()
    }
}

/// What was compressed, behind the bytes at the front of a page that were not.
fn unfolded(codec: CompressionCodec, front: &[u8], folded: &[u8]) -> Result<Vec<u8>, String> {
    let most = USUAL_BYTES.max(folded.len().saturating_mul(MAX_RATIO));
    let too_long = || format!("a page of {} bytes unfolds to more than {most}", front.len() + folded.len());
    let filled = |from: &mut dyn Read| {
        let mut unfolded = front.to_vec();
        from.take(most as u64 + 1).read_to_end(&mut unfolded).map_err(|error| error.to_string())?;
        if unfolded.len() - front.len() > most { Err(too_long()) } else { Ok(unfolded) }
    };
    match codec {
        // Where all values are missing, there is nothing that was compressed.
        _ if folded.is_empty() => Ok(front.to_vec()),
        CompressionCodec::SNAPPY => {
            let length = snap::raw::decompress_len(folded).map_err(|error| error.to_string())?;
            if length > most {
                return Err(too_long());
            }
            let mut unfolded = vec![0; front.len() + length];
            unfolded[..front.len()].copy_from_slice(front);
            let read = snap::raw::Decoder::new().decompress(folded, &mut unfolded[front.len()..]);
            read.map(|_| unfolded).map_err(|error| error.to_string())
        }
        CompressionCodec::GZIP => filled(&mut flate2::read::MultiGzDecoder::new(folded)),
        CompressionCodec::ZSTD => filled(&mut StreamingDecoder::new(folded).map_err(|error| error.to_string())?),
        other => Err(format!("is compressed with {other}, which is not read here")),
    }
}
