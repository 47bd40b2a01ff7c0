//! Tests on Parquet files of several programs, and on files that are put together here by hand.

use super::*;
use proptest::prelude::*;
use std::{cell::RefCell, fs, io::Write};

/// The rows that `fixtures/make_parquet.py` describes, as pyarrow, polars, DuckDB and fastparquet write them.
const FILES: [&str; 7] = [
    "pyarrow_snappy",
    "pyarrow_v2_gzip",
    "pyarrow_v2_zstd",
    "pyarrow_none",
    "polars",
    "duckdb",
    // This file has neither lists nor pictures.
    "fastparquet",
];
const ROWS: u64 = 40;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/parquet").join(name).with_extension("parquet")
}

fn numbers(table: &ParquetTable, name: &str, rows: Range<u64>) -> Result<Vec<f64>, String> {
    let mut numbers = Vec::new();
    let read = table.read_numbers(name, rows, &mut |_, number| {
        numbers.push(number);
        Ok(())
    });
    read.map(|()| numbers).map_err(|error| error.to_string())
}

fn pictures(table: &ParquetTable, wanted: &[u64]) -> Result<Vec<(u64, Option<String>)>, String> {
    let mut pictures = Vec::new();
    let read = table.read_bytes("picture", wanted, &mut |row, bytes| {
        pictures.push((row, bytes.map(|bytes| String::from_utf8_lossy(bytes).into_owned())));
        Ok(())
    });
    read.map(|()| pictures).map_err(|error| error.to_string())
}

fn picture(row: u64) -> (u64, Option<String>) {
    (row, (row % 7 != 3).then(|| format!("picture {row};").repeat(1 + (row % 3) as usize)))
}

fn expected(rows: Range<u64>, of: impl Fn(f64) -> f64) -> Vec<f64> {
    rows.map(|row| of(row as f64)).collect()
}

#[test]
fn numbers_are_read_from_files_of_every_program() {
    for name in FILES {
        let table = ParquetTable::open(&fixture(name)).unwrap();
        assert_eq!(table.row_count(), ROWS, "{name}");
        for rows in [0..40, 0..1, 39..40, 7..33, 24..26, 12..12] {
            let read = |column| numbers(&table, column, rows.clone()).unwrap();
            assert_eq!(read("index"), expected(rows.clone(), |row| row), "{name}");
            assert_eq!(read("same"), expected(rows.clone(), |_| 5.0), "{name}");
            assert_eq!(read("timestamp"), expected(rows.clone(), |row| row / 8.0), "{name}");
            assert_eq!(read("score"), expected(rows.clone(), |row| row * row / 7.0), "{name}");
        }
    }
}

#[test]
fn lists_and_pictures_are_read_from_files_of_every_program() {
    for name in &FILES[..6] {
        let table = ParquetTable::open(&fixture(name)).unwrap();
        for rows in [0..40, 0..1, 39..40, 7..33, 24..26] {
            let read = table.read_lists("state", rows.clone(), 3, &[2, 1]).unwrap();
            let expected: Vec<f64> = rows.flat_map(|row| [row as f64 / 2.0, -(row as f64)]).collect();
            assert_eq!(read, expected, "{name}");
        }
        for wanted in [vec![0], vec![39], vec![3], vec![1, 2, 23, 24, 25, 26, 38], (0..ROWS).collect()] {
            let expected: Vec<_> = wanted.iter().map(|row| picture(*row)).collect();
            assert_eq!(pictures(&table, &wanted).unwrap(), expected, "{name}");
        }
    }
}

#[test]
fn columns_that_are_not_there_or_other_are_named() {
    let table = ParquetTable::open(&fixture("pyarrow_none")).unwrap();
    assert!(numbers(&table, "nothing", 0..1).unwrap_err().contains("has no column \"nothing\""));
    assert!(numbers(&table, "state", 0..1).unwrap_err().contains("\"state\" is not of the expected type"));
    assert!(table.read_lists("index", 0..1, 3, &[0]).unwrap_err().to_string().contains("expected type"));
    let error = table.read_lists("state", 5..7, 2, &[0]).unwrap_err().to_string();
    assert!(error.contains("row 0 is not a list of 2 numbers"), "{error}");
    let error = table.read_lists("state", 5..7, 4, &[0]).unwrap_err().to_string();
    assert!(error.contains("row 0 is not a list of 4 numbers"), "{error}");
}

#[test]
fn open_refuses_files_that_are_no_parquet() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.parquet");
    let open = |bytes: &[u8]| {
        fs::write(&file, bytes).unwrap();
        ParquetTable::open(&file).map(|table| table.row_count()).map_err(|error| error.to_string())
    };
    assert!(open(b"PAR1").unwrap_err().contains("too short"));
    assert!(open(b"version https://git-lfs.github.com/spec/v1").unwrap_err().contains("does not end in PAR1"));
    assert!(open(b"PAR1\xff\xff\xff\x7fPAR1").unwrap_err().contains("a footer of 2147483647 bytes"));
    assert!(open(b"PAR1\x00\x00\x00\x00\x00PAR1").is_err());
}

/// A number as Thrift writes it: zigzag, seven bits to a byte.
fn int(number: i64) -> Vec<u8> {
    let mut left = (number << 1 ^ number >> 63) as u64;
    let mut bytes = Vec::new();
    while left > 0x7f {
        bytes.push(left as u8 | 0x80);
        left >>= 7;
    }
    bytes.push(left as u8);
    bytes
}

/// A node of a schema, of INT32 if it is a column.
fn node(name: &str, repetition: i64, children: i64) -> Vec<u8> {
    let name = [&[0x18, name.len() as u8], name.as_bytes()].concat();
    [vec![0x15, 2, 0x25], int(repetition), name, vec![0x15], int(children), vec![0]].concat()
}

/// Where a column of some bytes lies: after the file's first four bytes.
fn chunk(codec: i64, bytes: i64) -> Vec<u8> {
    let about = [vec![0x1c, 0x15, 2, 0x19, 5, 0x19, 8, 0x15], int(codec), vec![0x16, 2, 0x16, 2, 0x16], int(bytes)];
    [vec![0x26, 0], about.concat(), vec![0x26, 8, 0, 0]].concat()
}

/// A file with row groups that all use the same bytes.
fn file(schema: &[Vec<u8>], chunk: &[u8], rows: &[i64], pages: &[u8]) -> Vec<u8> {
    let group = |rows: &i64| [&[0x19, 0x1c], chunk, &[0x16, 0, 0x16], &int(*rows), &[0]].concat();
    let groups: Vec<u8> = rows.iter().flat_map(group).collect();
    let schema = [vec![0x15, 2, 0x19, 0xfc, schema.len() as u8], schema.concat()].concat();
    let footer = [schema, vec![0x16, 0, 0x19, 0xfc, rows.len() as u8], groups, vec![0]].concat();
    [b"PAR1", pages, &footer, &(footer.len() as u32).to_le_bytes(), b"PAR1"].concat()
}

/// A page with its header: values in the layout of version 1 if `kind` is 0, a dictionary if it is 2.
fn page(kind: i64, values: i64, encoding: i64, bytes: &[u8]) -> Vec<u8> {
    let begins = [vec![0x15], int(kind), vec![0x15, 2, 0x15], int(bytes.len() as i64)].concat();
    let about = [vec![if kind == 0 { 0x2c } else { 0x4c }, 0x15], int(values), vec![0x15], int(encoding)].concat();
    let levels: &[u8] = if kind == 0 { &[0x15, 6, 0x15, 6] } else { &[] };
    [&begins, &about, levels, &[0, 0], bytes].concat()
}

/// Reads the column `x` of a file: its numbers, or the first element of its lists if it repeats.
fn read_x(bytes: &[u8]) -> Result<Vec<f64>, String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.parquet");
    fs::write(&file, bytes).unwrap();
    let table = ParquetTable::open(&file).map_err(|error| error.to_string())?;
    let rows = 0..table.row_count();
    match table.leaf_columns()[0].max_rep_level() {
        0 => numbers(&table, "x", rows),
        _ => table.read_lists("x", rows, 3, &[0]).map_err(|error| error.to_string()),
    }
}

/// A file with one column, `x`, of two rows.
fn with_pages(repetition: i64, codec: i64, pages: &[u8]) -> Result<Vec<f64>, String> {
    let schema = [node("schema", 0, 1), node("x", repetition, 0)];
    read_x(&file(&schema, &chunk(codec, pages.len() as i64), &[2], pages))
}

#[test]
fn a_schema_that_does_not_close_is_refused() {
    let read = |schema: &[Vec<u8>]| read_x(&file(schema, &chunk(0, 0), &[], &[])).unwrap_err();
    assert!(read(&[node("schema", 0, 2), node("x", 0, 0)]).contains("fewer columns"));
    assert!(read(&[node("schema", 0, 0), node("x", 0, 0)]).contains("more columns"));
    assert!(read(&vec![node("x", 1, 1); 100]).contains("nested more than 16 deep"));
    // No memory is reserved for announced children.
    assert!(read(&[node("schema", 0, i64::from(i32::MAX)), node("x", 0, 0)]).contains("fewer columns"));
    assert!(read(&[node("schema", 0, i64::MAX)]).contains("fewer columns"));
}

#[test]
fn more_than_a_file_can_hold_is_refused() {
    let schema = [node("schema", 0, 1), node("x", 0, 0)];
    let read = |bytes: i64, rows: &[i64]| read_x(&file(&schema, &chunk(0, bytes), rows, &[0; 64])).unwrap_err();
    assert!(read(64, &[i64::MAX, 1]).contains("rows in "));
    assert!(read(64, &[-1]).contains("no valid number of rows"));
    assert!(read(64, &[1; 9]).contains("claims columns of 576 bytes in all"));
    for bytes in [500, i64::MAX, -1] {
        assert!(read(bytes, &[1]).contains("column \"x\" lies outside the file"));
    }
}

#[test]
fn a_file_that_was_put_together_by_hand_is_read() {
    let numbers = [[7, 0, 0, 0], [8, 0, 0, 0]].concat();
    assert_eq!(with_pages(0, 0, &page(0, 2, 0, &numbers)), Ok(vec![7.0, 8.0]));
    // A page without values is skipped.
    let pages = [page(0, 1, 0, &numbers[..4]), page(0, 0, 0, &[]), page(0, 1, 0, &numbers[4..])];
    assert_eq!(with_pages(0, 0, &pages.concat()), Ok(vec![7.0, 8.0]));
    let entries = [page(2, 2, 0, &numbers), page(0, 2, 8, &[1, 3, 2])].concat();
    assert_eq!(with_pages(0, 0, &entries), Ok(vec![7.0, 8.0]));
}

#[test]
fn a_page_that_is_to_become_too_large_is_refused() {
    let gigabyte = [0x80, 0x80, 0x80, 0x80, 4, 0, 0];
    let error = with_pages(0, 1, &page(0, 2, 0, &gigabyte)).unwrap_err();
    assert!(error.contains("column \"x\": at row 0 or soon after it"), "{error}");
    assert!(error.contains("7 bytes decompress to more than 8388608"), "{error}");
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    gzip.write_all(&vec![0; 20 << 20]).unwrap();
    let error = with_pages(0, 2, &page(0, 2, 0, &gzip.finish().unwrap())).unwrap_err();
    assert!(error.contains("decompress to more than 8388608"), "{error}");
    assert!(with_pages(0, 4, &page(0, 2, 0, &[0; 9])).unwrap_err().contains("is compressed with BROTLI"));
}

#[test]
fn pages_may_not_announce_more_than_they_hold() {
    let entries = page(2, i64::from(i32::MAX), 0, &[0; 40]);
    assert!(with_pages(0, 0, &entries).unwrap_err().contains("a dictionary of 2147483647 entries in 40 bytes"));
    assert!(with_pages(0, 0, &page(0, 2, 8, &[1, 3, 2])).unwrap_err().contains("is broken"));
    assert!(with_pages(0, 0, &page(0, 2, 0, &[0; 7])).unwrap_err().contains("at row 0"));
    assert!(with_pages(0, 0, &page(0, 1, 0, &[0; 4])).unwrap_err().contains("ends before row 1"));
    assert!(with_pages(0, 0, &page(0, 2, 6, &[0; 8])).unwrap_err().contains("have encoding 6 of parquet.thrift"));
    // Field 9 is a list of 2^31 - 1 floating-point numbers, which is not needed.
    let header = [0x15, 0, 0x15, 2, 0x15, 8, 0x69, 0xf7, 0xff, 0xff, 0xff, 0xff, 7];
    assert!(with_pages(0, 0, &header).unwrap_err().contains("2147483647 elements should follow in 0 bytes"));
    // Two runs, of a list that goes on and of missing values: a few bytes for any number of values.
    let run = [5, 0, 0, 0, 0xfe, 0xff, 0xff, 0xff, 0x0f];
    let lists = [&run[..], &[1], &run, &[0]].concat();
    let error = with_pages(2, 0, &page(0, i64::from(i32::MAX), 0, &lists)).unwrap_err();
    assert!(error.contains("announce 2147483647 values for a few rows"), "{error}");
}

/// Everything that is read of a file.
fn read_all(path: &Path) -> Result<u64, String> {
    let table = ParquetTable::open(path).map_err(|error| error.to_string())?;
    let rows = table.row_count();
    let read = [
        ["index", "same", "timestamp", "score"].map(|name| numbers(&table, name, 0..rows).map(|_| ())).to_vec(),
        vec![table.read_lists("state", 3..rows, 3, &[0]).map(|_| ()).map_err(|error| error.to_string())],
        vec![pictures(&table, &(0..rows.min(50)).collect::<Vec<_>>()).map(|_| ())],
    ];
    read.concat().into_iter().collect::<Result<(), String>>().map(|()| rows)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    #[test]
    fn no_broken_file_panics(which in 0..FILES.len(), changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6), cut in prop::option::weighted(0.1, any::<prop::sample::Index>())) {
        thread_local!(static FOLDER: RefCell<tempfile::TempDir> = RefCell::new(tempfile::tempdir().unwrap()));
        let mut bytes = fs::read(fixture(FILES[which])).unwrap();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.drain(..cut.index(bytes.len()));
        }
        let result = FOLDER.with_borrow(|folder| {
            let file = folder.path().join("broken.parquet");
            fs::write(&file, &bytes).unwrap();
            read_all(&file)
        });
        if let Ok(rows) = result {
            prop_assert!(rows <= bytes.len() as u64 * 16);
        }
    }
}
