//! Reads the texts of a LeRobot dataset of version 3: the tasks of each episode.

use crate::{Episode, FormatError, limits};
use parquet::{
    file::reader::{FileReader as _, SerializedFileReader},
    record::{Field, Row},
    schema::types::Type,
};
use std::{
    collections::BTreeSet,
    fs::File,
    path::{Path, PathBuf},
};
use wayword_core::SceneId;

/// Largest table of episodes that is read, bytes.
const MAX_TABLE_BYTES: u64 = 256 << 20;
/// Most bytes of all texts.
const MAX_TEXTS_BYTES: usize = 1 << 30;
/// Most tables of episodes.
const MAX_TABLES: usize = 10_000;

/// Reads the tasks of a dataset's episodes, as episodes of recordings.
///
/// # Errors
/// When the tables cannot be read, or the folder's name is no name of a scene.
pub fn read_lerobot_episodes(folder: &Path) -> Result<Vec<Episode>, FormatError> {
    let folder = std::path::absolute(folder).map_err(|source| FormatError::from_io(folder, "find", source))?;
    let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (mut episodes, mut names) = (Vec::new(), BTreeSet::new());
    for table in episode_tables(&folder)? {
        for (number, tasks) in read_table(&table)? {
            let scene = SceneId::new(format!("{name}_{number:06}")).map_err(|error| {
                FormatError::for_document(&folder, format!("its name: {error}"), "give the folder another name")
            })?;
            if !names.insert(scene.clone()) {
                let problem = format!("episode {number} is listed twice");
                return Err(FormatError::for_document(&table, problem, "give each episode its own number"));
            }
            episodes.push(Episode::for_recording(scene, tasks));
        }
    }
    Ok(episodes)
}

/// The tables of the episodes, in order.
fn episode_tables(folder: &Path) -> Result<Vec<PathBuf>, FormatError> {
    let list = |folder: &Path| -> Result<Vec<PathBuf>, FormatError> {
        let failed = |source| FormatError::from_io(folder, "look into", source);
        let entries = std::fs::read_dir(folder).map_err(failed)?.take(MAX_TABLES);
        let mut paths =
            entries.map(|entry| entry.map(|entry| entry.path()).map_err(failed)).collect::<Result<Vec<_>, _>>()?;
        paths.sort();
        Ok(paths)
    };
    let mut tables = Vec::new();
    for chunk in list(&folder.join("meta/episodes"))?.into_iter().filter(|chunk| chunk.is_dir()) {
        tables.extend(
            list(&chunk)?.into_iter().filter(|file| file.extension().is_some_and(|ending| ending == "parquet")),
        );
    }
    Ok(tables)
}

/// The number and the tasks of each episode of a table.
fn read_table(table: &Path) -> Result<Vec<(i64, Vec<String>)>, FormatError> {
    let broken = |problem: String| {
        FormatError::for_document(table, problem, "write the dataset again with LeRobot's own library")
    };
    let file = File::open(table).map_err(|source| FormatError::from_io(table, "open", source))?;
    if file.metadata().map_err(|source| FormatError::from_io(table, "read", source))?.len() > MAX_TABLE_BYTES {
        return Err(broken("it is larger than 256 MiB".to_owned()));
    }
    // The library panics at some broken files.
    let read = wayword_core::contain_panics::run_decoder(|| {
        let reader = SerializedFileReader::new(file).map_err(|error| error.to_string())?;
        let rows = reader.get_row_iter(Some(wanted_columns(&reader)?)).map_err(|error| error.to_string())?;
        let (mut episodes, mut bytes) = (Vec::new(), 0);
        for row in rows {
            let (number, tasks) = episode_of_row(&row.map_err(|error| error.to_string())?)?;
            bytes += tasks.iter().map(String::len).sum::<usize>();
            if episodes.len() >= limits::MAX_ITEMS || bytes > MAX_TEXTS_BYTES {
                return Err("it has more than 1,000,000 episodes or 1 GiB of texts".to_owned());
            }
            episodes.push((number, tasks));
        }
        Ok(episodes)
    });
    read.map_err(broken)
}

/// The columns of numbers and texts alone, so that nothing else of a row is read.
fn wanted_columns(reader: &SerializedFileReader<File>) -> Result<Type, String> {
    let schema = reader.metadata().file_metadata().schema();
    let wanted = schema.get_fields().iter().filter(|field| ["episode_index", "tasks"].contains(&field.name()));
    let fields = wanted.cloned().collect();
    Type::group_type_builder(schema.name()).with_fields(fields).build().map_err(|error| error.to_string())
}

fn episode_of_row(row: &Row) -> Result<(i64, Vec<String>), String> {
    let field = |wanted: &str| {
        let found = row.get_column_iter().find(|(name, _)| *name == wanted);
        found.map(|(_, field)| field).ok_or_else(|| format!("it has no column {wanted:?}"))
    };
    let Field::Long(number) = field("episode_index")? else {
        return Err("episode_index is no whole number".to_owned());
    };
    let Field::ListInternal(tasks) = field("tasks")? else { return Err("tasks is no list".to_owned()) };
    if tasks.len() > limits::MAX_INSTRUCTIONS {
        return Err(format!("episode {number} has more than 1,000 tasks"));
    }
    let text = |field: &Field| match field {
        Field::Str(text) if text.len() <= limits::MAX_INSTRUCTION_BYTES => Ok(text.clone()),
        Field::Str(_) => Err(format!("a task of episode {number} is longer than an instruction may be")),
        _ => Err(format!("a task of episode {number} is no text")),
    };
    Ok((*number, tasks.elements().iter().map(text).collect::<Result<_, _>>()?))
}
