//! What a Parquet file says about itself: its columns, and where they lie (apache/parquet-format, `parquet.thrift`).

use super::thrift::{self, Thing};

/// Most columns of a file, and deepest nesting of one.
const MAX_COLUMNS: usize = 100_000;
const MAX_NESTING: usize = 16;
/// Most rows for each byte of a file. A dataset counts its rows in at least one column, which takes more than a bit for each; a
/// file with more announces what it does not hold.
const MAX_ROWS_PER_BYTE: u64 = 16;

/// How a column's values are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Physical {
    Int32,
    Int64,
    Float,
    Double,
    Bytes,
    /// What datasets of LeRobot do not need: truths, times of 96 bits, bytes of a fixed length.
    Other,
}

impl Physical {
    /// Bytes of a value; `None` where its length is written before it, or it is not read.
    pub(super) const fn size(self) -> Option<usize> {
        match self {
            Self::Int32 | Self::Float => Some(4),
            Self::Int64 | Self::Double => Some(8),
            Self::Bytes | Self::Other => None,
        }
    }
}

/// How pages are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Codec {
    None,
    Snappy,
    Gzip,
    Zstandard,
    /// Its number in `parquet.thrift`.
    Other(i64),
}

/// A column that holds values.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Leaf {
    /// Names from the outermost on.
    pub(super) path: Vec<String>,
    pub(super) physical: Physical,
    /// Highest definition and repetition level.
    pub(super) max_definition: u32,
    pub(super) max_repetition: u32,
}

/// Where the values of a column lie, for a group of rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Chunk {
    pub(super) codec: Codec,
    /// First byte, and the byte after the last.
    pub(super) start: u64,
    pub(super) end: u64,
}

/// Rows that lie together.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    pub(super) rows: u64,
    /// One for each leaf.
    pub(super) chunks: Vec<Chunk>,
}

/// What a file says about itself.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Footer {
    pub(super) leaves: Vec<Leaf>,
    pub(super) groups: Vec<Group>,
}

impl Footer {
    /// Reads the footer of a file of some length.
    ///
    /// # Errors
    /// When it contradicts itself or the file's length.
    pub(super) fn read(bytes: &[u8], file_bytes: u64) -> Result<Self, String> {
        let (thing, _) = thrift::read(bytes)?;
        let leaves = leaves(thing.list(2))?;
        let groups = thing.list(4).iter().map(|group| read_group(group, leaves.len(), file_bytes));
        let groups: Vec<Group> = groups.collect::<Result<_, _>>()?;
        check_sizes(&groups, file_bytes)?;
        Ok(Self { leaves, groups })
    }
}

/// Refuses what a file of this length cannot hold.
fn check_sizes(groups: &[Group], file_bytes: u64) -> Result<(), String> {
    let rows = groups.iter().fold(0_u64, |rows, group| rows.saturating_add(group.rows));
    if rows > file_bytes.saturating_mul(MAX_ROWS_PER_BYTE) {
        return Err(format!("announces {rows} rows in {file_bytes} bytes"));
    }
    // Else a short file could have the same bytes unfolded again and again.
    let chunks = groups.iter().flat_map(|group| &group.chunks);
    let bytes = chunks.fold(0_u64, |bytes, chunk| bytes.saturating_add(chunk.end - chunk.start));
    if bytes > file_bytes {
        return Err(format!("announces columns of {bytes} bytes in all, in a file of {file_bytes}"));
    }
    Ok(())
}

fn read_group(group: &Thing<'_>, leaves: usize, file_bytes: u64) -> Result<Group, String> {
    let rows = group.count(3).ok_or("a group of rows has no number of rows")?;
    let chunks = group.list(1).iter().map(|chunk| read_chunk(chunk, file_bytes));
    let chunks: Vec<Chunk> = chunks.collect::<Result<_, _>>()?;
    if chunks.len() != leaves {
        return Err(format!("a group of rows has {} columns where the file has {leaves}", chunks.len()));
    }
    Ok(Group { rows, chunks })
}

fn read_chunk(chunk: &Thing<'_>, file_bytes: u64) -> Result<Chunk, String> {
    if chunk.field(1).is_some() || chunk.field(8).is_some() {
        return Err("a column is encrypted or lies in another file".to_owned());
    }
    let about = chunk.field(3).ok_or("a column says nothing about itself")?;
    let data = about.count(9).ok_or("a column has no place")?;
    // Some writers say 0 where there is no dictionary.
    let start = about.count(11).filter(|dictionary| (1..data).contains(dictionary)).unwrap_or(data);
    let length = about.count(7).ok_or("a column has no length")?;
    let end = start.checked_add(length).filter(|end| *end <= file_bytes);
    let end =
        end.ok_or_else(|| format!("a column is to lie at bytes {start} to {start} + {length}, of {file_bytes}"))?;
    let codec = match about.number(4) {
        Some(0) => Codec::None,
        Some(1) => Codec::Snappy,
        Some(2) => Codec::Gzip,
        Some(6) => Codec::Zstandard,
        other => Codec::Other(other.unwrap_or(-1)),
    };
    Ok(Chunk { codec, start, end })
}

/// The columns that hold values, from the schema: a tree whose nodes are written down from the root on, each with the number of
/// its children.
fn leaves(elements: &[Thing<'_>]) -> Result<Vec<Leaf>, String> {
    let (root, elements) = elements.split_first().ok_or("has no schema")?;
    if elements.len() > MAX_COLUMNS {
        return Err(format!("has more than {MAX_COLUMNS} columns"));
    }
    let mut leaves = Vec::new();
    // Nodes above the next one: how many of their children are still to come, their name, and their levels.
    let mut above = vec![(root.count(5).unwrap_or(0), String::new(), 0, 0)];
    for element in elements {
        while above.last().is_some_and(|(left, ..)| *left == 0) {
            above.pop();
        }
        let (left, _, definition, repetition) = above.last_mut().ok_or("the schema has more columns than it says")?;
        *left -= 1;
        let name = element.text(4).ok_or("a column has no name")?.to_owned();
        // 0 required, 1 optional, 2 repeated.
        let kind = element.number(3).unwrap_or(0);
        let levels = (*definition + u32::from(kind != 0), *repetition + u32::from(kind == 2));
        match element.count(5) {
            None | Some(0) => {
                let names = above.iter().skip(1).map(|(_, name, ..)| name.clone());
                let path = names.chain([name]).collect();
                let (max_definition, max_repetition) = levels;
                leaves.push(Leaf { path, physical: physical(element.number(1)), max_definition, max_repetition });
            }
            Some(_) if above.len() == MAX_NESTING => {
                return Err(format!("columns are nested more than {MAX_NESTING} deep"));
            }
            Some(children) => above.push((children, name, levels.0, levels.1)),
        }
    }
    if above.iter().any(|(left, ..)| *left > 0) {
        return Err("the schema has fewer columns than it says".to_owned());
    }
    Ok(leaves)
}

fn physical(kind: Option<i64>) -> Physical {
    match kind {
        Some(1) => Physical::Int32,
        Some(2) => Physical::Int64,
        Some(4) => Physical::Float,
        Some(5) => Physical::Double,
        Some(6) => Physical::Bytes,
        _ => Physical::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn element(name: &'static str, children: i64, kind: i64) -> Thing<'static> {
        let fields = vec![
            (1, Thing::Number(5)),
            (3, Thing::Number(kind)),
            (4, Thing::Bytes(name.as_bytes())),
            (5, Thing::Number(children)),
        ];
        Thing::Fields(fields)
    }

    #[test]
    fn levels_count_what_is_optional_and_what_repeats() {
        let schema = [
            element("schema", 2, 0),
            element("a", 1, 1),
            element("list", 1, 2),
            element("element", 0, 1),
            element("b", 0, 0),
        ];
        let leaves = leaves(&schema).unwrap();
        assert_eq!(leaves[0].path, ["a", "list", "element"]);
        assert_eq!((leaves[0].max_definition, leaves[0].max_repetition), (3, 1));
        assert_eq!(leaves[1].path, ["b"]);
        assert_eq!((leaves[1].max_definition, leaves[1].max_repetition), (0, 0));
    }

    #[test]
    fn a_tree_that_does_not_close_is_refused() {
        assert!(leaves(&[element("schema", 2, 0), element("a", 0, 0)]).unwrap_err().contains("fewer"));
        assert!(leaves(&[element("schema", 0, 0), element("a", 0, 0)]).unwrap_err().contains("more"));
        assert!(leaves(&vec![element("a", 1, 0); 100]).unwrap_err().contains("deep"));
        // What is announced is not reserved.
        assert!(leaves(&[element("schema", i64::MAX, 0)]).is_err());
    }

    #[test]
    fn more_than_a_file_can_hold_is_refused() {
        let group = |rows| Group { rows, chunks: vec![Chunk { codec: Codec::None, start: 4, end: 44 }] };
        assert_eq!(check_sizes(&[group(700), group(700)], 100), Ok(()));
        assert!(check_sizes(&[group(u64::MAX), group(1)], 100).unwrap_err().contains("rows in 100 bytes"));
        let again = check_sizes(&[group(1), group(1), group(1)], 100);
        assert!(again.unwrap_err().contains("columns of 120 bytes in all"));
    }
}
