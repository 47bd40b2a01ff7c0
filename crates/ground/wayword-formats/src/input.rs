//! Opens dataset files and reads them item by item. The files are untrusted: sizes and counts are bounded, and gzip is
//! unpacked under the same bounds.

use crate::{
    DatasetItem, FormatError, ItemPlace, WrongItem, bounded_tokens::BoundedTokenReader, file_kind,
    json_fault::JsonFault, limits, strict_json::StrictJson,
};
use flate2::bufread::MultiGzDecoder;
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value, de::IoRead};
use std::{
    cell::RefCell,
    collections::BTreeSet,
    fmt,
    fs::{self, File},
    io::{self, BufRead, BufReader, Cursor, Read},
    path::Path,
};
use wayword_core::FILE_START_BYTES;

/// Most bytes of a file that are read at a time.
const BUFFER_BYTES: usize = 1 << 16;
/// Most fields of a file's outer object beside the one with the list of items; a file with more is refused.
const MAX_OTHER_FIELDS: usize = 20;

/// Opens a file. It recognises gzip by the first bytes, not by the name, and skips the byte order mark that Windows
/// editors put before UTF-8.
pub(crate) fn open_input(file: &Path) -> Result<Box<dyn BufRead>, FormatError> {
    let failed = |source| FormatError::from_io(file, "open", source);
    if file == Path::new("-") && !file.exists() {
        return Err(FormatError::for_document(file, "standard input is not read", "give a file"));
    }
    // Opening a pipe waits until something writes into it, so this is checked first.
    let meta = fs::metadata(file).map_err(failed)?;
    if !meta.is_file() {
        let kind = if meta.is_dir() { "a folder" } else { "a pipe or a device" };
        let hint = match file.join("instructions.jsonl").is_file() {
            true => "give the file instructions.jsonl in it",
            false => "give a dataset file",
        };
        return Err(FormatError::for_document(file, format!("it is not a file but {kind}"), hint));
    }
    let opened = File::open(file).map_err(failed)?;
    if meta.len() > limits::MAX_FILE_BYTES {
        return Err(FormatError::for_document(file, limits::TOO_LARGE, limits::SPLIT_HINT));
    }
    let mut plain = BufReader::with_capacity(BUFFER_BYTES, opened);
    let is_gzip =
        plain.fill_buf().map_err(|source| FormatError::from_io(file, "read", source))?.starts_with(&[0x1f, 0x8b]);
    // The file may grow while it is read, and gzip may expand to a thousand times its size.
    let input: Box<dyn Read> = if is_gzip { Box::new(MultiGzDecoder::new(plain)) } else { Box::new(plain) };
    let input = BufReader::with_capacity(BUFFER_BYTES, BoundedReader { inner: input, left: limits::MAX_FILE_BYTES });
    checked_beginning(file, input)
}

/// The input without the byte order mark of UTF-8, its first three bytes where it has one. A file of another kind than
/// JSON is refused.
fn checked_beginning(file: &Path, mut input: impl BufRead + 'static) -> Result<Box<dyn BufRead>, FormatError> {
    let mut start = Vec::new();
    let read = input.by_ref().take(FILE_START_BYTES as u64).read_to_end(&mut start);
    read.map_err(|source| FormatError::from_io(file, "read", source))?;
    file_kind::refuse_other_kinds(file, &start)?;
    if start.starts_with(&[0xef, 0xbb, 0xbf]) {
        start.drain(..3);
    }
    Ok(Box::new(Cursor::new(start).chain(input)))
}

type BoundedJsonParser = serde_json::Deserializer<IoRead<BufReader<BoundedTokenReader<Box<dyn BufRead>>>>>;

/// A parser for a file that is one JSON value.
pub(crate) fn json_parser(file: &Path) -> Result<BoundedJsonParser, FormatError> {
    Ok(parser_over(open_input(file)?))
}

fn parser_over(input: Box<dyn BufRead>) -> BoundedJsonParser {
    let tokens = BoundedTokenReader::new(input);
    serde_json::Deserializer::from_reader(BufReader::with_capacity(BUFFER_BYTES, tokens))
}

/// A reader that fails, rather than ends, at a limit of bytes.
struct BoundedReader<R> {
    inner: R,
    /// Bytes that may still be read.
    left: u64,
}

impl<R: Read> Read for BoundedReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        self.left = self.left.checked_sub(count as u64).ok_or_else(|| io::Error::other(limits::TOO_LARGE))?;
        Ok(count)
    }
}

/// Reads a file of objects, one JSON list or one object per line, and passes each to `take`. A file without objects
/// counts as a list.
pub(crate) fn each_item(
    file: &Path,
    mut take: impl FnMut(DatasetItem<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    each_value(file, |place, value| take(DatasetItem::new(file, place, value)?))
}

/// As [`each_item`], for a format of lines: a file without objects counts as lines.
pub(crate) fn each_line_or_item(
    file: &Path,
    mut take: impl FnMut(DatasetItem<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let mut take = |place, value| take(DatasetItem::new(file, place, value)?);
    let (input, first) = first_byte(file)?;
    if first == Some(b'[') { each_list_value(file, input, &mut take) } else { each_line_value(file, input, take) }
}

/// Reads a file of any values, one JSON list or one object per line, and passes each to `take` with its place.
pub(crate) fn each_value(
    file: &Path,
    mut take: impl FnMut(ItemPlace, Value) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let (input, first) = first_byte(file)?;
    if first == Some(b'{') { each_line_value(file, input, take) } else { each_list_value(file, input, &mut take) }
}

/// Opens a file, and looks at its first byte that is no space.
fn first_byte(file: &Path) -> Result<(Box<dyn BufRead>, Option<u8>), FormatError> {
    let mut input = open_input(file)?;
    let start = input.fill_buf().map_err(|source| FormatError::from_io(file, "read", source))?;
    let first = start.trim_ascii_start().first().copied();
    Ok((input, first))
}

/// Passes each value of a JSON list to `take`, with its place.
fn each_list_value(file: &Path, input: Box<dyn BufRead>, take: ItemCallback<'_>) -> Result<(), FormatError> {
    let mut parser = parser_over(input);
    let items = ItemList::new(file, take);
    let read = (&items).deserialize(&mut parser).and_then(|()| parser.end());
    read.map_err(|error| items.explain_failure(&error))
}

/// Reads a file that is a JSON object with the list of items in one field. Passes each item to `take` and returns the
/// other fields.
pub(crate) fn each_item_in(
    file: &Path,
    field: &'static str,
    mut take: impl FnMut(DatasetItem<'_>) -> Result<(), FormatError>,
) -> Result<Map<String, Value>, FormatError> {
    let mut parser = json_parser(file)?;
    let mut take = |place, value| take(DatasetItem::new(file, place, value)?);
    let items = ItemList::new(file, &mut take);
    let read = ListInObject { items: &items, field }.deserialize(&mut parser);
    let read = read.and_then(|rest| parser.end().map(|()| rest));
    read.map_err(|error| items.explain_failure(&error))
}

/// Reads a file that is a JSON object with an item for each name, and passes each item to `take`, named.
pub(crate) fn each_entry(
    file: &Path,
    mut take: impl FnMut(&str, DatasetItem<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let mut parser = json_parser(file)?;
    let name = RefCell::new(String::new());
    let mut take = |place, value| {
        let name = name.borrow();
        let mut item = DatasetItem::new(file, place, value)?;
        item.set_id(&name);
        take(&name, item)
    };
    let items = ItemList::new(file, &mut take);
    let read = NamedItems { items: &items, name: &name }.deserialize(&mut parser).and_then(|()| parser.end());
    read.map_err(|error| items.explain_failure(&error))
}

/// Reads a file with one JSON object per line, and passes each to `take`. Empty lines are skipped.
pub(crate) fn each_line(
    file: &Path,
    mut take: impl FnMut(DatasetItem<'_>) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    each_line_value(file, open_input(file)?, |place, value| take(DatasetItem::new(file, place, value)?))
}

/// Passes the value of each line to `take`, with its place.
fn each_line_value(
    file: &Path,
    mut input: Box<dyn BufRead>,
    mut take: impl FnMut(ItemPlace, Value) -> Result<(), FormatError>,
) -> Result<(), FormatError> {
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        let longest = limits::MAX_LINE_BYTES as u64 + 1;
        let read = input.by_ref().take(longest).read_until(b'\n', &mut line);
        if read.map_err(|source| FormatError::from_io(file, "read", source))? == 0 {
            break;
        }
        if number > limits::MAX_ITEMS {
            let problem = format!("it has more than {} lines", limits::group_digits(limits::MAX_ITEMS));
            return Err(FormatError::for_document(file, problem, limits::SPLIT_HINT));
        }
        if line.len() > limits::MAX_LINE_BYTES {
            let problem = format!("line {number} is longer than {} MiB", limits::MAX_LINE_BYTES >> 20);
            return Err(FormatError::for_document(file, problem, "write one JSON object per line"));
        }
        if !line.trim_ascii().is_empty() {
            take(ItemPlace::Line(number), line_value(file, number, &line)?)?;
        }
    }
    Ok(())
}

/// The value of a line of JSON Lines.
fn line_value(file: &Path, number: usize, line: &[u8]) -> Result<Value, FormatError> {
    let field = RefCell::default();
    let mut parser = serde_json::Deserializer::from_slice(line);
    let value = StrictJson(&field).deserialize(&mut parser).and_then(|value| parser.end().map(|()| value));
    value.map_err(|error| {
        let mut fault = JsonFault::in_line(&error, line);
        fault.problem += &format!(" (column {})", error.column());
        broken_json(file, ItemPlace::Line(number), field.take(), fault)
    })
}

/// The error for wrong JSON in an item; `field` is empty where the mistake is not within a field.
fn broken_json(file: &Path, place: ItemPlace, field: String, fault: JsonFault) -> FormatError {
    let JsonFault { problem, hint } = fault;
    if field.is_empty() {
        return FormatError::for_document(file, format!("{place}: {problem}"), hint);
    }
    Box::new(WrongItem { file: file.to_owned(), place, id: None, field, problem, hint }).into()
}

type ItemCallback<'a> = &'a mut dyn FnMut(ItemPlace, Value) -> Result<(), FormatError>;

/// Reads a JSON list with at most one of its items in memory as JSON.
pub(crate) struct ItemList<'a> {
    file: &'a Path,
    /// The field within an item at which reading failed (`path[3]`).
    field: RefCell<String>,
    progress: RefCell<ListProgress<'a>>,
}

struct ListProgress<'a> {
    /// Receives each item.
    take: ItemCallback<'a>,
    /// Number of the items so far.
    index: usize,
    /// Whether an item is being read, so that an error of the parser is about that item.
    inside: bool,
    /// Why the last item was refused. The parser carries only its own errors.
    refused: Option<FormatError>,
}

impl<'a> ItemList<'a> {
    pub(crate) fn new(file: &'a Path, take: ItemCallback<'a>) -> Self {
        let progress = ListProgress { take, index: 0, inside: false, refused: None };
        Self { file, field: RefCell::default(), progress: progress.into() }
    }

    /// The error behind a failure of the parser: an item was refused, or the JSON is wrong.
    pub(crate) fn explain_failure(&self, error: &serde_json::Error) -> FormatError {
        let mut progress = self.progress.borrow_mut();
        if let Some(refused) = progress.refused.take() {
            return refused;
        }
        // `serde_json` does not know the place where the file system or a bound ended the reading.
        let mut fault = JsonFault::new(error);
        if !error.is_io() {
            fault.problem += &format!(" (line {}, column {})", error.line(), error.column());
        }
        if progress.inside {
            broken_json(self.file, ItemPlace::Item(progress.index), self.field.take(), fault)
        } else {
            FormatError::for_document(self.file, fault.problem, fault.hint)
        }
    }

    /// Passes an item on, unless the file has too many.
    fn hand_on(&self, value: Value) -> Result<(), FormatError> {
        let progress = &mut *self.progress.borrow_mut();
        if progress.index >= limits::MAX_ITEMS {
            let problem = format!("it has more than {} items", limits::group_digits(limits::MAX_ITEMS));
            return Err(FormatError::for_document(self.file, problem, limits::SPLIT_HINT));
        }
        (progress.take)(ItemPlace::Item(progress.index), value)?;
        progress.index += 1;
        Ok(())
    }
}

impl ItemList<'_> {
    /// Passes an item on. If it is refused, the reason is kept for [`Self::explain_failure`].
    fn hand_on_or_refuse<E: Error>(&self, value: Value) -> Result<(), E> {
        self.hand_on(value).map_err(|refused| {
            self.progress.borrow_mut().refused = Some(refused);
            E::custom("refused")
        })
    }
}

impl<'de> DeserializeSeed<'de> for &ItemList<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for &ItemList<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of items")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        self.progress.borrow_mut().inside = true;
        while let Some(value) = list.next_element_seed(StrictJson(&self.field))? {
            self.hand_on_or_refuse(value)?;
        }
        self.progress.borrow_mut().inside = false;
        Ok(())
    }
}

/// A JSON object with an item as the value of each name.
struct NamedItems<'i, 'a> {
    items: &'i ItemList<'a>,
    /// The name of the item that is being read.
    name: &'i RefCell<String>,
}

impl<'de> DeserializeSeed<'de> for NamedItems<'_, '_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for NamedItems<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with an item for each name")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<(), A::Error> {
        let mut names = BTreeSet::new();
        while let Some(name) = entries.next_key::<String>()? {
            if !names.insert(name.clone()) {
                return Err(A::Error::custom(format_args!("{name:?} is given twice")));
            }
            self.name.replace(name);
            self.items.progress.borrow_mut().inside = true;
            let value = entries.next_value_seed(StrictJson(&self.items.field))?;
            self.items.progress.borrow_mut().inside = false;
            self.items.hand_on_or_refuse(value)?;
        }
        Ok(())
    }
}

/// A JSON object around a list of items.
struct ListInObject<'i, 'a> {
    items: &'i ItemList<'a>,
    field: &'static str,
}

impl<'de> DeserializeSeed<'de> for ListInObject<'_, '_> {
    type Value = Map<String, Value>;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Self::Value, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for ListInObject<'_, '_> {
    type Value = Map<String, Value>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "an object with \"{}\"", self.field)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Self::Value, A::Error> {
        let mut rest = Map::new();
        let mut found = false;
        while let Some(key) = entries.next_key::<String>()? {
            if rest.contains_key(&key) || (found && key == self.field) {
                return Err(A::Error::custom(format_args!("field {key:?} is given twice")));
            }
            if rest.len() > MAX_OTHER_FIELDS {
                return Err(A::Error::custom("it has too many fields"));
            }
            if key == self.field {
                found = true;
                entries.next_value_seed(self.items)?;
            } else {
                rest.insert(key, entries.next_value_seed(StrictJson(&RefCell::default()))?);
            }
        }
        if found { Ok(rest) } else { Err(A::Error::custom(format_args!("field {:?} is missing", self.field))) }
    }
}
