use super::*;
use proptest::prelude::*;
use std::{cell::RefCell, fs};

/// The rows that `fixtures/make_parquet.py` describes, as pyarrow, polars, DuckDB and fastparquet write them.
const FILES: [&str; 7] = [
    "pyarrow_snappy",
    "pyarrow_v2_gzip",
    "pyarrow_v2_zstd",
    "pyarrow_none",
    "polars",
    "duckdb",
    // Has neither lists nor pictures.
    "fastparquet",
];
const ROWS: u64 = 40;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/parquet").join(name).with_extension("parquet")
}

fn numbers(table: &Table, name: &str, rows: Range<u64>) -> Result<Vec<f64>, String> {
    let mut numbers = Vec::new();
    let read = table.numbers(name, rows, &mut |_, number| {
        numbers.push(number);
        Ok(())
    });
    read.map(|()| numbers).map_err(|error| error.to_string())
}

fn pictures(table: &Table, wanted: &[u64]) -> Result<Vec<(u64, Option<String>)>, String> {
    let mut pictures = Vec::new();
    let read = table.bytes("picture", wanted, &mut |row, bytes| {
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
        let table = Table::open(&fixture(name)).unwrap();
        assert_eq!(table.rows(), ROWS, "{name}");
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
        let table = Table::open(&fixture(name)).unwrap();
        for rows in [0..40, 0..1, 39..40, 7..33, 24..26] {
            let read = table.lists("state", rows.clone(), 3, &[2, 1]).unwrap();
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
    let table = Table::open(&fixture("pyarrow_none")).unwrap();
    assert!(numbers(&table, "nothing", 0..1).unwrap_err().contains("has no column \"nothing\""));
    assert!(numbers(&table, "state", 0..1).unwrap_err().contains("\"state\" is of another kind"));
    assert!(table.lists("index", 0..1, 3, &[0]).unwrap_err().to_string().contains("another kind"));
    let error = table.lists("state", 5..7, 2, &[0]).unwrap_err().to_string();
    assert!(error.contains("row 0 is no list of 2 numbers"), "{error}");
    let error = table.lists("state", 5..7, 4, &[0]).unwrap_err().to_string();
    assert!(error.contains("row 0 is no list of 4 numbers"), "{error}");
}

#[test]
fn what_is_no_parquet_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("x.parquet");
    let open = |bytes: &[u8]| {
        fs::write(&file, bytes).unwrap();
        Table::open(&file).map(|table| table.rows()).map_err(|error| error.to_string())
    };
    assert!(open(b"PAR1").unwrap_err().contains("too short"));
    assert!(open(b"version https://git-lfs.github.com/spec/v1").unwrap_err().contains("does not end in PAR1"));
    assert!(open(b"PAR1\xff\xff\xff\x7fPAR1").unwrap_err().contains("a footer of 2147483647 bytes"));
    assert!(open(b"PAR1\x00\x00\x00\x00\x00PAR1").is_err());
}

/// Everything that is read of a file.
fn read_all(path: &Path) -> Result<u64, String> {
    let table = Table::open(path).map_err(|error| error.to_string())?;
    let rows = table.rows();
    let read = [
        ["index", "same", "timestamp", "score"].map(|name| numbers(&table, name, 0..rows).map(|_| ())).to_vec(),
        vec![table.lists("state", 3..rows, 3, &[0]).map(|_| ()).map_err(|error| error.to_string())],
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
