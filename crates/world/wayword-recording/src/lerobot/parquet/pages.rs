//! The pages of a column, decompressed to a limited size.
//!
//! The crate `parquet` has a reader of pages as well, but it takes as much memory as a page's header announces, up to 2 GiB, and
//! decompresses gzip to any length. Five bytes of a broken header can keep it busy for minutes if they announce a long
//! list in a field that it skips. So headers are read and pages are decompressed here, before the crate decodes them.

use super::thrift::{self, ThriftReader};
use parquet::{
    basic::{CompressionCodec, Encoding},
    column::page::{Page, PageMetadata, PageReader},
    errors::ParquetError,
    file::metadata::ColumnChunkMetaData,
};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    ops::Range,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
};

/// Bytes that are read for a page's header: the first number is enough for nearly all, the second for one with long
/// statistics.
const HEADER_BYTES: [u64; 2] = [1 << 9, 1 << 20];
/// Any page may decompress to this many bytes: writers close pages at 1 MiB.
const USUAL_BYTES: usize = 8 << 20;
/// A larger page may decompress to this many times its compressed size.
const MAX_COMPRESSION_RATIO: usize = 256;
/// Limits for the values that the pages of a few rows may announce: in any file, per byte of the file, and in all. A
/// page of equal values takes a few bytes for any number of them, but a file also has columns with different values.
/// Each value takes up to 12 bytes of memory.
const USUAL_VALUES: u64 = 16 << 20;
const MAX_VALUES_PER_BYTE: u64 = 64;
const MAX_VALUES: u64 = 64 << 20;

/// The byte range of a column in its file; `None` if the numbers are impossible.
pub(super) fn column_place(chunk: &ColumnChunkMetaData) -> Option<Range<u64>> {
    let data = chunk.data_page_offset();
    // Some writers write 0 where there is no dictionary.
    let start = chunk.dictionary_page_offset().filter(|at| (1..data).contains(at)).unwrap_or(data);
    let start = u64::try_from(start).ok()?;
    Some(start..start.checked_add(u64::try_from(chunk.compressed_size()).ok()?)?)
}

/// The header of a page.
struct PageHeader {
    /// 0 is a page of values in the layout of version 1, 3 one of version 2; 2 is a dictionary.
    kind: i64,
    /// Length of the page in the file, bytes.
    stored: u64,
    /// Fields 1 to 6 of this kind of header in `parquet.thrift`.
    numbers: [i64; 6],
    /// Whether the values of a page in the layout of version 2 are compressed; true for other pages.
    has_compressed_values: bool,
}

impl PageHeader {
    /// Reads a header; also returns its length.
    fn read(bytes: &[u8]) -> Result<(Self, u64), String> {
        let mut thrift = ThriftReader::new(bytes);
        let mut header = Self { kind: -1, stored: 0, numbers: [-1; 6], has_compressed_values: true };
        let mut number = 0;
        while let Some(kind) = thrift.next_field(&mut number)? {
            // Fields of `PageHeader`: its kind, its compressed size, and three that hold the numbers of one kind each.
            match (number, kind) {
                (1, thrift::KIND_I32) => header.kind = thrift.read_number()?,
                (3, thrift::KIND_I32) => {
                    header.stored = u64::try_from(thrift.read_number()?).map_err(|_| "a page has no valid length")?;
                }
                (5 | 7 | 8, thrift::KIND_STRUCT) => header.read_numbers(&mut thrift)?,
                _ => thrift.skip_value(kind)?,
            }
        }
        Ok((header, (bytes.len() - thrift.remaining_bytes().len()) as u64))
    }

    /// Reads the header's part that only pages of its kind have.
    fn read_numbers(&mut self, thrift: &mut ThriftReader<'_>) -> Result<(), String> {
        let mut number = 0;
        while let Some(kind) = thrift.next_field(&mut number)? {
            match (number, kind) {
                (1..=6, thrift::KIND_I32) => {
                    let value = thrift.read_number()?;
                    if let Some((place, _)) = self.numbers.iter_mut().zip(1_i16..).find(|(_, field)| *field == number) {
                        *place = value;
                    }
                }
                (7, thrift::KIND_TRUE | thrift::KIND_FALSE) => self.has_compressed_values = kind == thrift::KIND_TRUE,
                _ => thrift.skip_value(kind)?,
            }
        }
        Ok(())
    }

    /// Field `field` of this kind of header, counted from 1; -1 where the header does not have it.
    fn number_at(&self, field: usize) -> i64 {
        field.checked_sub(1).and_then(|at| self.numbers.get(at)).copied().unwrap_or(-1)
    }

    /// Field `field` of this kind of header, which is a count or a length.
    fn count_at(&self, field: usize) -> Result<u32, String> {
        let number = self.number_at(field);
        u32::try_from(number).map_err(|_| format!("a page has the invalid count {number}"))
    }

    /// Field `field` of this kind of header, which is the encoding of values. Delta encodings of texts are refused, because
    /// the crate reserves memory for any number of texts that a page announces.
    fn encoding_at(&self, field: usize) -> Result<Encoding, String> {
        match self.number_at(field) {
            0 => Ok(Encoding::PLAIN),
            2 => Ok(Encoding::PLAIN_DICTIONARY),
            5 => Ok(Encoding::DELTA_BINARY_PACKED),
            8 => Ok(Encoding::RLE_DICTIONARY),
            9 => Ok(Encoding::BYTE_STREAM_SPLIT),
            other => Err(format!("values have encoding {other} of parquet.thrift, which cannot be read")),
        }
    }
}

/// The pages of a column in a row group.
pub(super) struct ColumnPages {
    file: File,
    /// The bytes of the column that have not been read.
    place: Range<u64>,
    /// The header of the next page, if it has already been read.
    header: Option<PageHeader>,
    codec: CompressionCodec,
    /// Number of values of the pages that were read since the counter was last 0.
    announced: Arc<AtomicU64>,
    /// The limit for `announced`; more is an error.
    max_announced: u64,
}

impl ColumnPages {
    /// The pages of a column. The numbers of values that they announce are added to `announced`.
    ///
    /// # Errors
    /// When the column has no valid place, or the file cannot be read.
    pub(super) fn new(file: File, chunk: &ColumnChunkMetaData, announced: Arc<AtomicU64>) -> Result<Self, String> {
        let place = column_place(chunk).ok_or("has no valid place in the file")?;
        let length = file.metadata().map_err(|error| error.to_string())?.len();
        let max_announced = length.saturating_mul(MAX_VALUES_PER_BYTE).clamp(USUAL_VALUES, MAX_VALUES);
        Ok(Self { file, place, header: None, codec: chunk.compression_codec(), announced, max_announced })
    }

    /// Reads the next page's header and moves past it; `None` after the last page.
    fn next_header(&mut self) -> Result<Option<PageHeader>, String> {
        if let Some(header) = self.header.take() {
            return Ok(Some(header));
        }
        while !self.place.is_empty() {
            let wrong = |reason: String| format!("byte {}: not a page header: {reason}", self.place.start);
            let left_bytes = self.place.end - self.place.start;
            let [usual_bytes, most_bytes] = HEADER_BYTES;
            let short = PageHeader::read(&self.peek_bytes(left_bytes.min(usual_bytes))?);
            let read = short.or_else(|_| PageHeader::read(&self.peek_bytes(left_bytes.min(most_bytes))?));
            let (header, length) = read.map_err(wrong)?;
            if header.stored > left_bytes - length {
                return Err(wrong(format!(
                    "a page of {} bytes, but the column has only {} left",
                    header.stored,
                    left_bytes - length
                )));
            }
            self.place.start += length;
            // The crate takes a page without values as the end, so it is skipped. Pages of other kinds hold no values.
            if header.kind == 2 || (matches!(header.kind, 0 | 3) && header.number_at(1) != 0) {
                return Ok(Some(header));
            }
            self.place.start += header.stored;
        }
        Ok(None)
    }

    /// The next bytes of the column.
    fn peek_bytes(&self, count: u64) -> Result<Vec<u8>, String> {
        let wrong = |error: std::io::Error| format!("byte {}: {error}", self.place.start);
        let mut file = &self.file;
        file.seek(SeekFrom::Start(self.place.start)).map_err(wrong)?;
        let mut bytes = Vec::new();
        file.take(count).read_to_end(&mut bytes).map_err(wrong)?;
        if bytes.len() as u64 != count {
            return Err(format!("byte {}: the file ends early", self.place.start));
        }
        Ok(bytes)
    }

    /// Reads the page after its header.
    fn read_page(&mut self, header: &PageHeader) -> Result<Page, String> {
        let stored = self.peek_bytes(header.stored)?;
        self.place.start += header.stored;
        let num_values = header.count_at(1)?;
        if header.kind == 2 {
            let buf = decompress_page(self.codec, stored, 0)?;
            // An entry takes at least four bytes in every type of column that is read here.
            if num_values as usize > buf.len() / 4 {
                return Err(format!("a dictionary of {num_values} entries in {} bytes", buf.len()));
            }
            let encoding = header.encoding_at(2)?;
            return Ok(Page::DictionaryPage { buf: buf.into(), num_values, encoding, is_sorted: false });
        }
        let values = u64::from(num_values);
        let announced = self.announced.fetch_add(values, Relaxed).saturating_add(values);
        if announced > self.max_announced {
            return Err(format!("pages announce {announced} values for a few rows"));
        }
        if header.kind == 0 {
            return Ok(Page::DataPage {
                buf: decompress_page(self.codec, stored, 0)?.into(),
                num_values,
                encoding: header.encoding_at(2)?,
                def_level_encoding: Encoding::RLE,
                rep_level_encoding: Encoding::RLE,
                statistics: None,
            });
        }
        let (def_levels_byte_len, rep_levels_byte_len) = (header.count_at(5)?, header.count_at(6)?);
        // In version 2, levels are not compressed.
        let levels = usize::try_from(u64::from(def_levels_byte_len) + u64::from(rep_levels_byte_len));
        let levels = levels.ok().filter(|levels| *levels <= stored.len()).ok_or("levels are longer than their page")?;
        Ok(Page::DataPageV2 {
            buf: if header.has_compressed_values { decompress_page(self.codec, stored, levels)? } else { stored }
                .into(),
            num_values,
            encoding: header.encoding_at(4)?,
            num_nulls: header.count_at(2)?,
            num_rows: header.count_at(3)?,
            def_levels_byte_len,
            rep_levels_byte_len,
            is_compressed: false,
            statistics: None,
        })
    }
}

impl Iterator for ColumnPages {
    type Item = Result<Page, ParquetError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.get_next_page().transpose()
    }
}

impl PageReader for ColumnPages {
    fn get_next_page(&mut self) -> Result<Option<Page>, ParquetError> {
        let header = self.next_header().map_err(ParquetError::General)?;
        let start = self.place.start;
        let page = header.map(|header| self.read_page(&header)).transpose();
        page.map_err(|reason| ParquetError::General(format!("page at byte {start}: {reason}")))
    }

    fn peek_next_page(&mut self) -> Result<Option<PageMetadata>, ParquetError> {
        self.header = self.next_header().map_err(ParquetError::General)?;
        let about = |header: &PageHeader| {
            let values = header.count_at(1)? as usize;
            // Rows are only skipped in columns that do not repeat. There a page has as many rows as values, whatever
            // its header claims.
            let num_rows = (header.kind == 3).then_some(values);
            let num_levels = (header.kind != 2).then_some(values);
            Ok(PageMetadata { num_rows, num_levels, is_dict: header.kind == 2 })
        };
        self.header.as_ref().map(about).transpose().map_err(ParquetError::General)
    }

    fn skip_next_page(&mut self) -> Result<(), ParquetError> {
        let header = self.next_header().map_err(ParquetError::General)?;
        self.place.start += header.map_or(0, |header| header.stored);
        Ok(())
    }
}

/// A page's decompressed bytes. The first `plain_length` bytes of `stored` are not compressed.
fn decompress_page(codec: CompressionCodec, stored: Vec<u8>, plain_length: usize) -> Result<Vec<u8>, String> {
    if codec == CompressionCodec::UNCOMPRESSED {
        return Ok(stored);
    }
    let (plain, compressed) = stored.split_at_checked(plain_length).ok_or("levels are longer than their page")?;
    let max_bytes = USUAL_BYTES.max(compressed.len().saturating_mul(MAX_COMPRESSION_RATIO));
    let too_long = || format!("{} bytes decompress to more than {max_bytes}", compressed.len());
    let read_limited = |from: &mut dyn Read| {
        let mut unpacked = plain.to_vec();
        from.take(max_bytes as u64 + 1).read_to_end(&mut unpacked).map_err(|error| error.to_string())?;
        if unpacked.len() - plain.len() > max_bytes { Err(too_long()) } else { Ok(unpacked) }
    };
    match codec {
        // If all values are missing, there are no compressed bytes.
        _ if compressed.is_empty() => Ok(plain.to_vec()),
        CompressionCodec::SNAPPY => {
            let length = snap::raw::decompress_len(compressed).map_err(|error| error.to_string())?;
            if length > max_bytes {
                return Err(too_long());
            }
            let mut unpacked = vec![0; plain.len() + length];
            let (levels, values) = unpacked.split_at_mut(plain.len());
            levels.copy_from_slice(plain);
            let read = snap::raw::Decoder::new().decompress(compressed, values);
            read.map(|_| unpacked).map_err(|error| error.to_string())
        }
        CompressionCodec::GZIP => read_limited(&mut flate2::read::MultiGzDecoder::new(compressed)),
        CompressionCodec::ZSTD => {
            read_limited(&mut zstd::Decoder::with_buffer(compressed).map_err(|error| error.to_string())?)
        }
        other => Err(format!("is compressed with {other}, which cannot be read")),
    }
}
