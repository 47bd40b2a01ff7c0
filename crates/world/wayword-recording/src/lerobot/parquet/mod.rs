//! Parquet files, as far as datasets of LeRobot need them: whole numbers, fractions and bytes, and lists of fractions.
//!
//! Pages of both versions are read, values as they are or as numbers of a dictionary, compressed with Snappy, gzip, Zstandard or not
//! at all: what pyarrow, and so the library of LeRobot, writes. The crate `parquet` reads more, but three announcements of a broken file make
//! it reserve memory without a bound or recurse without one, which ends the process (the number of a column's children, the entries
//! of a dictionary, and the statistics of a page); here nothing is reserved that is not there.

mod cells;
mod footer;
mod hybrid;
mod page;
mod thrift;
mod unfold;

use cells::Cells;
use footer::{Footer, Leaf, Physical};
use std::{
    fs::File,
    io::{Read, Seek, SeekFrom},
    ops::Range,
    path::{Path, PathBuf},
};
use wayword_core::PlatformError;
use wayword_world::files;

const MAGIC: &[u8; 4] = b"PAR1";
const MAX_FOOTER_BYTES: u64 = 64 << 20;
const HINT: &str = "fetch the file again; if it is whole, write it again with pyarrow and Snappy, as LeRobot does";

/// Who is handed the bytes of a row, if it has some.
pub(super) type TakeBytes<'a> = dyn FnMut(u64, Option<&[u8]>) -> Result<(), PlatformError> + 'a;

/// A Parquet file: rows with named columns.
#[derive(Debug)]
pub(super) struct Table {
    path: PathBuf,
    footer: Footer,
}

impl Table {
    /// Opens a file and reads what it says about itself.
    ///
    /// # Errors
    /// When it is no Parquet file.
    pub(super) fn open(path: &Path) -> Result<Self, PlatformError> {
        let footer = File::open(path).map_err(|error| error.to_string()).and_then(|file| read_footer(&file));
        Ok(Self { path: path.to_owned(), footer: footer.map_err(|reason| files::wrong(path, reason, HINT))? })
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> u64 {
        self.footer.groups.iter().map(|group| group.rows).sum()
    }

    /// Whether there is a column of this name.
    pub(super) fn has(&self, name: &str) -> bool {
        self.footer.leaves.iter().any(|leaf| leaf.path.first().is_some_and(|first| first == name))
    }

    /// Hands out a column of numbers, row by row.
    ///
    /// # Errors
    /// When there is no such column, a number is missing, the file is broken, or `take` refuses a number.
    pub(super) fn numbers(
        &self,
        name: &str,
        rows: Range<u64>,
        take: &mut dyn FnMut(u64, f64) -> Result<(), String>,
    ) -> Result<(), PlatformError> {
        let leaf = self.leaf(name, |leaf| leaf.path.len() == 1 && leaf.max_repetition == 0)?;
        let physical = self.footer.leaves[leaf].physical;
        self.each(leaf, rows, |cells, group, rows| {
            cells.skip(rows.start - group.start)?;
            for row in rows {
                let cell = cells.next()?.ok_or_else(|| format!("ends before row {row}"))?;
                take(row, number(physical, cell.value).ok_or_else(|| format!("row {row} holds no number"))?)?;
            }
            Ok(())
        })
    }

    /// Some elements of a column of lists of `width` numbers: `kept` of each row, one row after another.
    ///
    /// # Errors
    /// When there is no such column, a list has another length, or the file is broken.
    pub(super) fn lists(
        &self,
        name: &str,
        rows: Range<u64>,
        width: usize,
        kept: &[usize],
    ) -> Result<Vec<f64>, PlatformError> {
        let leaf = self.leaf(name, |leaf| leaf.max_repetition == 1)?;
        let physical = self.footer.leaves[leaf].physical;
        let mut numbers = Vec::new();
        self.each(leaf, rows, |cells, group, rows| {
            let uneven = |row: u64| format!("row {row} is no list of {width} numbers");
            let mut list = Vec::with_capacity(width);
            // One before the first; where a row ends is known when the next begins.
            let mut begun = group.start;
            while begun < rows.end || list.len() < width {
                let Some(cell) = cells.next()? else {
                    return Err(format!("ends within row {}", begun.saturating_sub(1)));
                };
                if cell.begins_row {
                    if begun > group.start && list.len() != width {
                        return Err(uneven(begun - 1));
                    }
                    list.clear();
                    begun += 1;
                }
                let row = begun.saturating_sub(1);
                if begun == group.start || list.len() == width {
                    return Err(uneven(row));
                }
                list.push(number(physical, cell.value).ok_or_else(|| format!("row {row} holds no number"))?);
                if list.len() == width && rows.contains(&row) {
                    numbers.extend(kept.iter().filter_map(|at| list.get(*at)));
                }
            }
            Ok(())
        })?;
        Ok(numbers)
    }

    /// Hands out the bytes of some rows, which ascend: those of a column of bytes, or of its part `bytes`, as pictures are kept.
    /// `None` where a row holds none.
    ///
    /// # Errors
    /// When there is no such column, the file is broken, or `take` fails.
    pub(super) fn bytes(&self, name: &str, wanted: &[u64], take: &mut TakeBytes<'_>) -> Result<(), PlatformError> {
        let flat = |leaf: &Leaf| leaf.max_repetition == 0 && leaf.physical == Physical::Bytes;
        let leaf = self.leaf(name, |leaf| flat(leaf) && leaf.path.get(1).is_none_or(|part| part == "bytes"))?;
        let mut wanted = wanted.iter().copied().peekable();
        let mut refused = None;
        let read = self.each(leaf, 0..self.rows(), |cells, _, rows| {
            let mut at = rows.start;
            while let Some(row) = wanted.next_if(|row| rows.contains(row)) {
                cells.skip(row.saturating_sub(at))?;
                let cell = cells.next()?.ok_or_else(|| format!("ends before row {row}"))?;
                if let Err(error) = take(row, cell.value) {
                    refused = Some(error);
                    return Err(String::new());
                }
                at = row + 1;
            }
            Ok(())
        });
        refused.map_or(read, Err)
    }

    /// The only column of a name that fits.
    fn leaf(&self, name: &str, fits: impl Fn(&Leaf) -> bool) -> Result<usize, PlatformError> {
        let named = |leaf: &Leaf| leaf.path.first().is_some_and(|first| first == name);
        let leaves = self.footer.leaves.iter().enumerate();
        let mut found = leaves.filter(|(_, leaf)| named(leaf) && fits(leaf)).map(|(at, _)| at);
        match (found.next(), found.next()) {
            (Some(leaf), None) => Ok(leaf),
            _ if self.has(name) => {
                Err(files::wrong(&self.path, format!("column {name:?} is of another kind than expected"), HINT))
            }
            _ => Err(files::wrong(&self.path, format!("has no column {name:?}"), HINT)),
        }
    }

    /// Reads a column group by group. `read` is told which rows of the file its values are, and which of these are wanted.
    fn each(
        &self,
        leaf: usize,
        wanted: Range<u64>,
        mut read: impl FnMut(&mut Cells<'_>, Range<u64>, Range<u64>) -> Result<(), String>,
    ) -> Result<(), PlatformError> {
        let about = &self.footer.leaves[leaf];
        let wrong =
            |reason: String| files::wrong(&self.path, format!("column {:?}: {reason}", about.path.join(".")), HINT);
        let file = File::open(&self.path).map_err(|error| wrong(error.to_string()))?;
        let mut first = 0;
        for group in &self.footer.groups {
            let rows = first..first + group.rows;
            first = rows.end;
            let within = wanted.start.max(rows.start)..wanted.end.min(rows.end);
            if !within.is_empty() {
                read(&mut Cells::new(&file, about, group.chunks[leaf]), rows, within).map_err(wrong)?;
            }
        }
        Ok(())
    }
}

fn read_footer(mut file: &File) -> Result<Footer, String> {
    let wrong = |error: std::io::Error| error.to_string();
    let length = file.metadata().map_err(wrong)?.len();
    let end = length.checked_sub(8).ok_or("is too short for a Parquet file")?;
    file.seek(SeekFrom::Start(end)).map_err(wrong)?;
    let mut tail = [0; 8];
    file.read_exact(&mut tail).map_err(wrong)?;
    let [a, b, c, d, magic @ ..] = tail;
    if magic != *MAGIC {
        return Err(format!("byte {}: is no Parquet file, or only a part of one: it does not end in PAR1", end + 4));
    }
    let size = u64::from(u32::from_le_bytes([a, b, c, d]));
    let start = end.checked_sub(size).filter(|_| size <= MAX_FOOTER_BYTES);
    let start = start.ok_or_else(|| format!("byte {end}: a footer of {size} bytes in a file of {length}"))?;
    file.seek(SeekFrom::Start(start)).map_err(wrong)?;
    let mut bytes = Vec::new();
    file.take(size).read_to_end(&mut bytes).map_err(wrong)?;
    Footer::read(&bytes, length).map_err(|reason| format!("footer at byte {start}: {reason}"))
}

/// A stored number; `None` where there is none, or it is no number.
fn number(physical: Physical, value: Option<&[u8]>) -> Option<f64> {
    let value = value?;
    Some(match physical {
        Physical::Int32 => f64::from(i32::from_le_bytes(value.try_into().ok()?)),
        Physical::Int64 => i64::from_le_bytes(value.try_into().ok()?) as f64,
        Physical::Float => f64::from(f32::from_le_bytes(value.try_into().ok()?)),
        Physical::Double => f64::from_le_bytes(value.try_into().ok()?),
        Physical::Bytes | Physical::Other => return None,
    })
}

#[cfg(test)]
mod tests;
