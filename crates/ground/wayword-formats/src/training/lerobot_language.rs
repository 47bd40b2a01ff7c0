//! Writes a copy of a LeRobot v3.0 dataset with columns of language.
//!
//! Every other file is linked or copied as it is, and every other column is copied as its bytes stand in the file: nothing is decoded
//! and encoded again. Source: huggingface/lerobot, `src/lerobot/datasets/language.py`, and the order of rows of
//! `annotations/steerable_pipeline/writer.py`.

use super::{
    arrow_schema::with_language_fields,
    columns::{ColumnValues, LanguageRow, NamedColumn},
};
use crate::{FormatError, OutputFile, output};
use parquet::{
    basic::Compression,
    column::{reader::ColumnReader, writer::ColumnCloseResult},
    errors::ParquetError,
    file::{
        metadata::{KeyValue, RowGroupMetaData},
        properties::WriterProperties,
        reader::{FileReader as _, RowGroupReader, SerializedFileReader},
        writer::{SerializedFileWriter, SerializedRowGroupWriter},
    },
    schema::types::Type,
};
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::{self, File},
    io::Read as _,
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::contain_panics;

/// The columns of language.
const LANGUAGE_COLUMNS: [&str; 2] = ["language_persistent", "language_events"];
/// What pandas and Hugging Face's library wrote of the columns at the foot of a file: it would not name the new ones.
const STALE_NOTES: [&str; 2] = ["huggingface", "pandas"];
/// Arrow's own types of the columns. Without this note, lists of a fixed size come back as plain lists.
const ARROW_NOTE: &str = "ARROW:schema";
/// Most folders and files of a dataset.
const MAX_FILES: usize = 1_000_000;
/// Largest description of a dataset that is read, bytes.
const MAX_INFO_BYTES: u64 = 16 << 20;
/// Depth of the folders of a dataset.
const MAX_DEPTH: usize = 8;

/// The language of an episode.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EpisodeLanguage {
    /// Rows that hold from a frame on, with that frame. Their times are filled in from the dataset's own.
    pub persistent: Vec<(usize, LanguageRow)>,
    /// Rows that belong to one frame.
    pub events: Vec<(usize, LanguageRow)>,
}

/// What a copy holds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LanguageCopy {
    /// Episodes with language.
    pub episodes: usize,
    /// Files that were linked.
    pub linked: usize,
    /// Files that were copied, because the disk does not link them.
    pub copied: usize,
}

/// Checks whether a dataset can get language: version 3.0, and no such columns yet.
///
/// # Errors
/// When its description cannot be read, or it is another version or has such columns.
pub fn expect_no_language(root: &Path) -> Result<(), FormatError> {
    let (file, info) = read_info(root)?;
    let version = info.get("codebase_version").and_then(Value::as_str).unwrap_or_default();
    if !version.starts_with("v3.") {
        let problem = format!("codebase_version is {version:?}, and only datasets of v3.0 have columns of language");
        let hint = "convert it with LeRobot's own `convert_dataset_v21_to_v30`";
        return Err(FormatError::for_document(&file, problem, hint));
    }
    let has = |name: &&str| info.get("features").is_some_and(|features| features.get(name).is_some());
    if let Some(name) = LANGUAGE_COLUMNS.iter().find(|name| has(name)) {
        let problem = format!("the dataset has a column {name:?} already");
        return Err(FormatError::for_document(&file, problem, "annotate the dataset from before it got language"));
    }
    Ok(())
}

/// The names of a dataset's cameras, in the order of its description.
///
/// # Errors
/// When its description cannot be read.
pub fn camera_features(root: &Path) -> Result<Vec<String>, FormatError> {
    let (_, info) = read_info(root)?;
    let features = info.get("features").and_then(Value::as_object).into_iter().flatten();
    let is_camera = |feature: &Value| {
        let kind = feature.get("dtype").and_then(Value::as_str);
        kind.is_some_and(|kind| kind == "video" || kind == "image")
    };
    Ok(features.filter(|(_, feature)| is_camera(feature)).map(|(name, _)| name.clone()).collect())
}

fn read_info(root: &Path) -> Result<(PathBuf, Value), FormatError> {
    let file = root.join("meta/info.json");
    let broken = |problem: String| {
        FormatError::for_document(&file, problem, "write the dataset again with LeRobot's own library")
    };
    let opened = File::open(&file).map_err(|source| FormatError::from_io(&file, "open", source))?;
    let mut text = String::new();
    opened
        .take(MAX_INFO_BYTES + 1)
        .read_to_string(&mut text)
        .map_err(|source| FormatError::from_io(&file, "read", source))?;
    if text.len() as u64 > MAX_INFO_BYTES {
        return Err(broken("it is larger than 16 MiB".to_owned()));
    }
    let info = serde_json::from_str(&text).map_err(|error| broken(error.to_string()))?;
    Ok((file, info))
}

/// Writes the copy into an empty folder. `languages` has the language of each episode, by its number; episodes that are not in it get
/// empty lists.
///
/// # Errors
/// When the dataset cannot be read, a row names a frame that its episode lacks, or a file cannot be written.
pub fn write_language_copy(
    root: &Path,
    out: &Path,
    languages: &BTreeMap<i64, EpisodeLanguage>,
) -> Result<LanguageCopy, FormatError> {
    let (_, mut info) = read_info(root)?;
    let mut copy = LanguageCopy { episodes: languages.len(), ..LanguageCopy::default() };
    let mut files = Vec::new();
    list_files(root, Path::new(""), 0, &mut files)?;
    for file in &files {
        let (from, to) = (root.join(file), out.join(file));
        let folder = to.parent().unwrap_or(out);
        fs::create_dir_all(folder).map_err(|source| FormatError::from_io(folder, "make the folder", source))?;
        if file.starts_with("data") && file.extension().is_some_and(|ending| ending == "parquet") {
            write_table(&from, &to, languages)?;
        } else if file != Path::new("meta/info.json") {
            if to.exists() {
                // A command that was stopped left it.
                fs::remove_file(&to).map_err(|source| FormatError::from_io(&to, "replace", source))?;
            }
            match fs::hard_link(&from, &to) {
                Ok(()) => copy.linked += 1,
                Err(_) => {
                    fs::copy(&from, &to).map_err(|source| FormatError::from_io(&to, "copy", source))?;
                    copy.copied += 1;
                }
            }
        }
    }
    if let Some(features) = info.get_mut("features").and_then(Value::as_object_mut) {
        for name in LANGUAGE_COLUMNS {
            features.insert(name.to_owned(), json!({"dtype": "language", "shape": [1], "names": null}));
        }
    }
    output::write_file(&out.join("meta/info.json"), |out| Ok(serde_json::to_writer_pretty(out, &info)?))?;
    Ok(copy)
}

/// The files of a dataset, below its folder, sorted, without hidden ones and links.
fn list_files(root: &Path, below: &Path, depth: usize, files: &mut Vec<PathBuf>) -> Result<(), FormatError> {
    let folder = root.join(below);
    let failed = |source| FormatError::from_io(&folder, "look into", source);
    let mut entries = fs::read_dir(&folder).map_err(failed)?.collect::<Result<Vec<_>, _>>().map_err(failed)?;
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let name = entry.file_name();
        if name.to_string_lossy().starts_with('.') {
            continue;
        }
        let path = below.join(&name);
        let kind = fs::metadata(root.join(&path)).map_err(failed)?;
        if kind.is_dir() && depth < MAX_DEPTH {
            list_files(root, &path, depth + 1, files)?;
        } else if kind.is_file() {
            files.push(path);
        }
        if files.len() > MAX_FILES {
            let problem = "it holds more than 1,000,000 files".to_owned();
            return Err(FormatError::for_document(root, problem, "give the folder of one dataset"));
        }
    }
    Ok(())
}

/// Writes a table of rows again with the columns of language behind its own.
fn write_table(from: &Path, to: &Path, languages: &BTreeMap<i64, EpisodeLanguage>) -> Result<(), FormatError> {
    let broken = |problem: String| {
        FormatError::for_document(from, problem, "write the dataset again with LeRobot's own library")
    };
    let source = File::open(from).map_err(|source| FormatError::from_io(from, "open", source))?;
    let target = OutputFile::begin(to).map_err(|source| FormatError::from_io(to, "write", source))?;
    // The library panics at some broken files.
    let written = contain_panics::run_decoder(|| {
        let reader = SerializedFileReader::new(source.try_clone().map_err(|error| error.to_string())?)
            .map_err(|error| error.to_string())?;
        let told = |error: ParquetError| error.to_string();
        let groups = (0..reader.num_row_groups())
            .map(|number| FrameRow::read_group(reader.get_row_group(number).map_err(told)?.as_ref()))
            .collect::<Result<Vec<_>, String>>()?;
        let lists = persistent_lists(&groups.concat(), languages)?;
        let mut writer = begin_table(&reader, target).map_err(told)?;
        for (rows, group) in groups.iter().zip(reader.metadata().row_groups()) {
            let mut out = writer.next_row_group().map_err(told)?;
            copy_columns(&source, group, &mut out).map_err(told)?;
            let persistent = rows.iter().map(|row| lists.get(&row.episode).cloned().unwrap_or_default()).collect();
            let events = rows.iter().map(|row| events_of(row, languages)).collect();
            ColumnValues::LanguagePersistent(persistent).write_rows(&mut out).map_err(told)?;
            ColumnValues::LanguageEvents(events).write_rows(&mut out).map_err(told)?;
            out.close().map_err(told)?;
        }
        writer.into_inner().map_err(told)
    });
    written.map_err(broken)?.finish().map_err(|source| FormatError::from_io(to, "write", source))
}

fn begin_table(
    reader: &SerializedFileReader<File>,
    target: OutputFile,
) -> Result<SerializedFileWriter<OutputFile>, ParquetError> {
    let foot = reader.metadata().file_metadata();
    let mut fields = foot.schema().get_fields().to_vec();
    let new: [NamedColumn; 2] = [
        (LANGUAGE_COLUMNS[0].to_owned(), ColumnValues::LanguagePersistent(Vec::new())),
        (LANGUAGE_COLUMNS[1].to_owned(), ColumnValues::LanguageEvents(Vec::new())),
    ];
    for (name, values) in &new {
        fields.push(values.field_type(name)?);
    }
    let schema = Arc::new(Type::group_type_builder(foot.schema().name()).with_fields(fields).build()?);
    let kept = |note: &KeyValue| match note.key.as_str() {
        ARROW_NOTE => Some(KeyValue::new(ARROW_NOTE.to_owned(), with_language_fields(note.value.as_deref()?)?)),
        key if STALE_NOTES.contains(&key) => None,
        _ => Some(note.clone()),
    };
    let notes: Vec<KeyValue> = foot.key_value_metadata().into_iter().flatten().filter_map(kept).collect();
    let properties =
        WriterProperties::builder().set_compression(Compression::SNAPPY).set_key_value_metadata(Some(notes)).build();
    SerializedFileWriter::new(target, schema, Arc::new(properties))
}

/// Copies the bytes of all columns of a group.
fn copy_columns(
    source: &File,
    group: &RowGroupMetaData,
    out: &mut SerializedRowGroupWriter<'_, OutputFile>,
) -> Result<(), ParquetError> {
    for column in group.columns() {
        let copied = ColumnCloseResult {
            bytes_written: u64::try_from(column.compressed_size()).unwrap_or_default(),
            rows_written: u64::try_from(group.num_rows()).unwrap_or_default(),
            metadata: column.clone(),
            bloom_filter: None,
            column_index: None,
            offset_index: None,
        };
        out.append_column(source, copied)?;
    }
    Ok(())
}

/// A row of the dataset: its episode, its frame in it and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FrameRow {
    episode: i64,
    frame: usize,
    time_s: f32,
}

impl FrameRow {
    fn read_group(group: &dyn RowGroupReader) -> Result<Vec<Self>, String> {
        let count = usize::try_from(group.metadata().num_rows()).unwrap_or_default();
        let episodes = read_numbers(group, "episode_index", count)?;
        let frames = read_numbers(group, "frame_index", count)?;
        let times = read_numbers(group, "timestamp", count)?;
        let rows = episodes.into_iter().zip(frames).zip(times);
        let row = |((episode, frame), time_s): ((f64, f64), f64)| {
            if episode < 0.0 || !(0.0..=MAX_FRAME).contains(&frame) {
                return Err(format!("a row has episode {episode} and frame {frame}"));
            }
            // Whole numbers far below the limits of these types.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            Ok(Self { episode: episode as i64, frame: frame as usize, time_s: time_s as f32 })
        };
        rows.map(row).collect()
    }
}

/// Most frames of an episode.
const MAX_FRAME: f64 = 1e9;

/// The numbers of a column, one for each row.
fn read_numbers(group: &dyn RowGroupReader, name: &str, count: usize) -> Result<Vec<f64>, String> {
    let is_named = |at: &usize| group.metadata().column(*at).column_path().string() == name;
    let at = (0..group.num_columns()).find(is_named).ok_or_else(|| format!("it has no column {name:?}"))?;
    let mut numbers = Vec::new();
    let wrong = |error: ParquetError| format!("column {name:?}: {error}");
    macro_rules! read {
        ($reader:expr) => {{
            let (mut values, mut levels) = (Vec::new(), Vec::new());
            $reader.read_records(count, Some(&mut levels), None, &mut values).map_err(wrong)?;
            numbers.extend(values.into_iter().map(|value| value as f64));
        }};
    }
    match group.get_column_reader(at).map_err(wrong)? {
        ColumnReader::Int64ColumnReader(mut reader) => read!(reader),
        ColumnReader::Int32ColumnReader(mut reader) => read!(reader),
        ColumnReader::FloatColumnReader(mut reader) => read!(reader),
        ColumnReader::DoubleColumnReader(mut reader) => read!(reader),
        _ => return Err(format!("column {name:?} holds no numbers")),
    }
    if numbers.len() != count {
        return Err(format!("column {name:?} has {} numbers for {count} rows", numbers.len()));
    }
    Ok(numbers)
}

/// The lists of the episodes that have rows in a table, sorted as LeRobot's writer sorts them.
fn persistent_lists(
    rows: &[FrameRow],
    languages: &BTreeMap<i64, EpisodeLanguage>,
) -> Result<BTreeMap<i64, Vec<LanguageRow>>, String> {
    let times: BTreeMap<(i64, usize), f32> = rows.iter().map(|row| ((row.episode, row.frame), row.time_s)).collect();
    let mut lists = BTreeMap::new();
    for episode in rows.iter().map(|row| row.episode).collect::<BTreeSet<_>>() {
        let timed = |(frame, said): &(usize, LanguageRow)| {
            let time_s = times.get(&(episode, *frame)).copied();
            let time_s = time_s.ok_or_else(|| format!("episode {episode} has no frame {frame} in this table"))?;
            Ok(LanguageRow { time_s, ..said.clone() })
        };
        let own = languages.get(&episode).into_iter().flat_map(|language| &language.persistent);
        let mut list = own.map(timed).collect::<Result<Vec<_>, String>>()?;
        list.sort_by(|a, b| a.time_s.total_cmp(&b.time_s).then((a.style, a.role).cmp(&(b.style, b.role))));
        lists.insert(episode, list);
    }
    Ok(lists)
}

/// The rows of language that belong to a row of the dataset alone.
fn events_of(row: &FrameRow, languages: &BTreeMap<i64, EpisodeLanguage>) -> Vec<LanguageRow> {
    let own = languages.get(&row.episode).into_iter().flat_map(|language| &language.events);
    let mut said: Vec<LanguageRow> =
        own.filter(|(frame, _)| *frame == row.frame).map(|(_, said)| said.clone()).collect();
    said.sort_by(|a, b| (a.style, a.role, &a.camera).cmp(&(b.style, b.role, &b.camera)));
    said
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::training::columns::ColumnFile;
    use std::io::{Seek as _, SeekFrom};

    /// A dataset of two episodes of three frames at 4 frames a second, with a file in place of a video.
    fn dataset(root: &Path) {
        for folder in ["meta", "data/chunk-000", "videos/front"] {
            fs::create_dir_all(root.join(folder)).unwrap();
        }
        let info = json!({
            "codebase_version": "v3.0",
            "fps": 4,
            "features": {"observation.images.front": {"dtype": "video"}, "action": {"dtype": "float32"}},
        });
        fs::write(root.join("meta/info.json"), info.to_string()).unwrap();
        fs::write(root.join("videos/front/file-000.mp4"), b"not really a video").unwrap();
        fs::write(root.join(".cache"), b"hidden").unwrap();
        let columns = |episode: i64| -> Vec<NamedColumn> {
            vec![
                ("action".to_owned(), ColumnValues::Float32List(vec![vec![0.5, 1.0]; 3])),
                ("timestamp".to_owned(), ColumnValues::Float32(vec![0.0, 0.25, 0.5])),
                ("frame_index".to_owned(), ColumnValues::Int64(vec![0, 1, 2])),
                ("episode_index".to_owned(), ColumnValues::Int64(vec![episode; 3])),
            ]
        };
        let notes = [("huggingface", "stale"), ("mine", "kept")];
        let mut file = ColumnFile::begin(&root.join("data/chunk-000/file-000.parquet"), &columns(0), &notes).unwrap();
        file.write_group(&columns(0)).unwrap();
        file.write_group(&columns(1)).unwrap();
        file.finish().unwrap();
    }

    fn row(style: &'static str, content: &str) -> LanguageRow {
        LanguageRow { role: "assistant", content: content.to_owned(), style, time_s: 9.0, camera: None }
    }

    fn languages() -> BTreeMap<i64, EpisodeLanguage> {
        let persistent = vec![
            (2, row("subtask", "Stop.")),
            (0, row("subtask", "Turn left.")),
            (0, row("plan", "1. Turn left.\n2. Stop.")),
        ];
        let asked = LanguageRow { camera: Some("observation.images.front".to_owned()), ..row("vqa", "{}") };
        let events = vec![(1, LanguageRow { role: "user", ..asked.clone() }), (1, asked)];
        BTreeMap::from([(1, EpisodeLanguage { persistent, events })])
    }

    /// The bytes of each column chunk of a table.
    fn chunk_bytes(file: &Path) -> Vec<Vec<u8>> {
        let reader = SerializedFileReader::new(File::open(file).unwrap()).unwrap();
        let chunks = reader.metadata().row_groups().iter().flat_map(RowGroupMetaData::columns);
        let bytes = |column: &parquet::file::metadata::ColumnChunkMetaData| {
            let (from, length) = column.byte_range();
            let mut opened = File::open(file).unwrap();
            opened.seek(SeekFrom::Start(from)).unwrap();
            let mut bytes = vec![0; usize::try_from(length).unwrap()];
            opened.read_exact(&mut bytes).unwrap();
            bytes
        };
        chunks.map(bytes).collect()
    }

    #[test]
    fn a_copy_has_the_same_columns_byte_for_byte_and_language_behind_them() {
        let folder = tempfile::tempdir().unwrap();
        let (root, out) = (folder.path().join("plain"), folder.path().join("copy"));
        dataset(&root);
        expect_no_language(&root).unwrap();
        assert_eq!(camera_features(&root).unwrap(), ["observation.images.front"]);
        let copy = write_language_copy(&root, &out, &languages()).unwrap();
        assert_eq!((copy.episodes, copy.linked + copy.copied), (1, 1));
        assert_eq!(fs::read(out.join("videos/front/file-000.mp4")).unwrap(), b"not really a video");
        assert!(!out.join(".cache").exists());
        let table = "data/chunk-000/file-000.parquet";
        let (before, after) = (chunk_bytes(&root.join(table)), chunk_bytes(&out.join(table)));
        // Four columns of each of the two groups come first; the leaves of language follow.
        let own = after.len() / 2;
        assert_eq!([&after[..4], &after[own..own + 4]].concat(), before);
        let reader = SerializedFileReader::new(File::open(out.join(table)).unwrap()).unwrap();
        let rows: Vec<String> = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string()).collect();
        assert!(rows[0].contains("language_persistent: []") && rows[0].contains("language_events: []"), "{}", rows[0]);
        // Sorted by time, style and role, with the dataset's own times.
        let places =
            ["style: \"plan\", timestamp: 0", "Turn left.\", style: \"subtask\", timestamp: 0", "timestamp: 0.5"];
        let found: Vec<usize> = places.iter().map(|place| rows[3].find(place).unwrap_or(usize::MAX)).collect();
        assert!(found.is_sorted() && found[2] < usize::MAX, "{}", rows[3]);
        assert!(rows[4].contains("role: \"user\"") && !rows[3].contains("style: \"vqa\""), "{}", rows[4]);
        let notes = reader.metadata().file_metadata().key_value_metadata().unwrap();
        assert_eq!(notes.iter().map(|note| note.key.as_str()).collect::<Vec<_>>(), ["mine"]);
        assert!(expect_no_language(&out).unwrap_err().to_string().contains("has a column \"language_persistent\""));
        // The same again, over what is there.
        write_language_copy(&root, &out, &languages()).unwrap();
    }

    #[test]
    fn a_row_of_a_frame_that_its_episode_lacks_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path().join("plain");
        dataset(&root);
        let late = EpisodeLanguage { persistent: vec![(7, row("subtask", "Go."))], events: Vec::new() };
        let error = write_language_copy(&root, &folder.path().join("copy"), &BTreeMap::from([(0, late)])).unwrap_err();
        assert!(error.to_string().contains("episode 0 has no frame 7"), "{error}");
    }

    #[test]
    fn other_versions_and_broken_tables_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let root = folder.path();
        dataset(root);
        fs::write(root.join("data/chunk-000/file-000.parquet"), b"PAR1 and nothing").unwrap();
        assert!(write_language_copy(root, &folder.path().join("copy"), &languages()).is_err());
        fs::write(root.join("meta/info.json"), r#"{"codebase_version": "v2.1", "features": {}}"#).unwrap();
        assert!(expect_no_language(root).unwrap_err().to_string().contains("v2.1"));
        fs::write(root.join("meta/info.json"), "{").unwrap();
        assert!(camera_features(root).is_err());
    }
}
