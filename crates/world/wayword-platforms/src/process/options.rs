//! The settings of a world program: its command, the size of its pictures and the time limits. They come from a world
//! file or from the caller.

use super::{answer::MAX_LINE_BYTES, guard::GuardProgram};
use crate::matterport::file_reading;
use serde::Deserialize;
use std::{
    fmt,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
    time::Duration,
};
use wayword_core::PlatformError;
use wayword_world::output_lines::{OutputLine, to_safe_text};

const MAX_FILE_BYTES: u64 = 1 << 20;
const WORLD_FILE_HINT: &str =
    "a world file holds a JSON object with \"command\": [PROGRAM, ARGUMENT, ...], see docs/PROCESS.md";
/// Longest time limit that can be set, seconds.
const MAX_WAIT_S: f64 = 86_400.0;
/// Longest side of a picture, pixels.
const MAX_SIDE_PX: u32 = 4096;

/// A world program, and its settings.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessOptions {
    /// The world file with these settings, as errors name it; `None` if there is none.
    pub world_file: Option<PathBuf>,
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub arguments: Vec<String>,
    /// The folder in which it runs; if `None`, Wayword's current folder.
    pub folder: Option<PathBuf>,
    /// Width of pictures, pixels.
    pub width_px: u32,
    /// Height of pictures, pixels.
    pub height_px: u32,
    /// Distance between viewpoints if Wayword makes the graph, metres.
    pub spacing_m: f64,
    /// Time limit for the greeting; simulators start slowly.
    pub start_within: Duration,
    /// Time limit for any other answer.
    pub answer_within: Duration,
    /// How often the child may be restarted. Each 200 answers allow one more restart, but never more than this number.
    pub restarts: u32,
    /// A world within this process, which answers in place of a program. `program` is then the name that errors give it.
    pub inside: Option<InsideWorld>,
    /// A program that calls [`stand_guard_if_asked`](super::stand_guard_if_asked) at its very start:
    /// [`this_program`](super::this_program), if it does so. It runs next to the child. If this program is killed,
    /// or exits without dropping the platform, the guard ends the child and the processes that the child started.
    ///
    /// Without a guard, and on systems other than Unix, only the end of its input asks the child to end in this case,
    /// and a child that hangs continues to run. A process that leaves the child's group (`setsid`, a daemon) is never
    /// ended.
    pub guard: Option<GuardProgram>,
}

/// A world within this process: an object of the interpreter that this program runs in.
#[derive(Clone)]
pub struct InsideWorld(Arc<Mutex<Box<AnswerFunction>>>);

/// Gives the answer to a request, each a line without its end.
type AnswerFunction = dyn FnMut(&[u8]) -> Vec<u8> + Send;

impl InsideWorld {
    /// A world that answers each request with a line, as `docs/PROCESS.md` describes, both without the end of the line.
    /// It gets one request at a time, also after a request that took too long.
    pub fn new(answers: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static) -> Self {
        Self(Arc::new(Mutex::new(Box::new(answers))))
    }

    /// The answer to a line that was sent.
    pub(crate) fn answer_line(&self, request: &[u8]) -> OutputLine {
        let mut answers = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let answer = answers(request.trim_ascii_end());
        if answer.len() > MAX_LINE_BYTES { OutputLine::TooLong } else { OutputLine::Whole(answer) }
    }
}

impl fmt::Debug for InsideWorld {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Inside")
    }
}

impl PartialEq for InsideWorld {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// A world file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WorldFile {
    command: Vec<String>,
    #[serde(default)]
    width_px: Option<u32>,
    #[serde(default)]
    height_px: Option<u32>,
    #[serde(default)]
    spacing_m: Option<f64>,
    #[serde(default)]
    start_within_s: Option<f64>,
    #[serde(default)]
    answer_within_s: Option<f64>,
    #[serde(default)]
    restarts: Option<u32>,
}

impl ProcessOptions {
    /// A world within this process, with the default settings. Errors give it this name.
    #[must_use]
    pub fn for_inside_world(name: &str, world: InsideWorld) -> Self {
        Self { inside: Some(world), ..Self::new(name) }
    }

    /// The same options with pictures of another size, and another distance between viewpoints that Wayword makes. A value of
    /// `None` changes nothing.
    ///
    /// # Errors
    /// Names the first value that is out of range.
    pub fn with_sizes(
        self,
        width_px: Option<u32>,
        height_px: Option<u32>,
        spacing_m: Option<f64>,
    ) -> Result<Self, String> {
        Ok(Self {
            width_px: checked_side(width_px, self.width_px, "width_px")?,
            height_px: checked_side(height_px, self.height_px, "height_px")?,
            spacing_m: checked_within(spacing_m, self.spacing_m, 0.2..=10.0, "spacing_m")?,
            ..self
        })
    }

    /// A program without arguments, with the default settings: pictures of 640x480, viewpoints 1 m apart, 3 minutes to
    /// start, 1 minute to answer, 5 restarts, no guard.
    #[must_use]
    pub fn new(program: impl Into<PathBuf>) -> Self {
        Self {
            world_file: None,
            program: program.into(),
            arguments: Vec::new(),
            folder: None,
            width_px: 640,
            height_px: 480,
            spacing_m: 1.0,
            start_within: Duration::from_secs(180),
            answer_within: Duration::from_secs(60),
            restarts: 5,
            inside: None,
            guard: None,
        }
    }

    /// The command as errors name it: the script if there is one, because the interpreter's name would not help.
    pub(crate) fn shown_command(&self) -> PathBuf {
        let script = self.arguments.first().filter(|first| Path::new(first).extension().is_some());
        script.map_or_else(|| self.program.clone(), |script| PathBuf::from(to_safe_text(script, 200)))
    }

    /// Reads a file: a world file if its name ends in `.json`, else the file is the program itself. A world file's
    /// command runs in the file's folder.
    ///
    /// # Errors
    /// If the file is missing, or is not a valid world file.
    pub fn read_world_file(file: &Path) -> Result<Self, PlatformError> {
        let wrong = |reason: String| file_reading::file_error(file, reason, WORLD_FILE_HINT);
        if file.extension().is_none_or(|end| end != "json") {
            let program = file.canonicalize().map_err(|error| wrong(error.to_string()))?;
            return Ok(Self::new(program));
        }
        let text = file_reading::text_if_there(file, MAX_FILE_BYTES, WORLD_FILE_HINT)?
            .ok_or_else(|| wrong("there is no such file".into()))?;
        let world: WorldFile = serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
        let resolved = file.canonicalize().map_err(|error| wrong(error.to_string()))?;
        let options = world.into_options(resolved.parent().unwrap_or(Path::new("."))).map_err(wrong)?;
        Ok(Self { world_file: Some(file.to_owned()), ..options })
    }
}

impl WorldFile {
    fn into_options(self, folder: &Path) -> Result<ProcessOptions, String> {
        let mut command = self.command.into_iter();
        let program = PathBuf::from(command.next().ok_or("\"command\" is empty")?);
        // A bare name is searched in PATH; a path is relative to the world file's folder.
        let program = if program.components().count() > 1 { folder.join(program) } else { program };
        let default = ProcessOptions::new(program).with_sizes(self.width_px, self.height_px, self.spacing_m)?;
        Ok(ProcessOptions {
            arguments: command.collect(),
            folder: Some(folder.to_owned()),
            start_within: checked_wait(self.start_within_s, default.start_within, "start_within_s")?,
            answer_within: checked_wait(self.answer_within_s, default.answer_within, "answer_within_s")?,
            restarts: self.restarts.unwrap_or(default.restarts),
            ..default
        })
    }
}

fn checked_side(given: Option<u32>, default: u32, name: &str) -> Result<u32, String> {
    checked_within(given, default, 16..=MAX_SIDE_PX, name)
}

fn checked_wait(given_s: Option<f64>, default: Duration, name: &str) -> Result<Duration, String> {
    checked_within(given_s, default.as_secs_f64(), 0.01..=MAX_WAIT_S, name).map(Duration::from_secs_f64)
}

/// A setting if it is within a range, or the default; the error names the setting and the range.
fn checked_within<T: PartialOrd + std::fmt::Display>(
    given: Option<T>,
    default: T,
    range: std::ops::RangeInclusive<T>,
    name: &str,
) -> Result<T, String> {
    let value = given.unwrap_or(default);
    let fits = range.contains(&value);
    fits.then_some(()).map_or_else(
        || Err(format!("\"{name}\" must be between {} and {}", range.start(), range.end())),
        |()| Ok(value),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read(text: &str) -> Result<ProcessOptions, PlatformError> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("world.json");
        fs::write(&file, text).unwrap();
        ProcessOptions::read_world_file(&file)
    }

    #[test]
    fn a_world_file_runs_its_command_in_its_own_folder() {
        let options =
            read(r#"{"command": ["python3", "world.py", "--scene", "a b"], "answer_within_s": 0.5}"#).unwrap();
        assert_eq!(options.program, Path::new("python3"));
        assert_eq!(options.arguments, ["world.py", "--scene", "a b"]);
        assert_eq!(options.answer_within, Duration::from_millis(500));
        let folder = options.folder.unwrap();
        assert_eq!(read(r#"{"command": ["python3"]}"#).unwrap().width_px, 640);
        let beside = read(r#"{"command": ["bin/world"]}"#).unwrap();
        assert!(
            beside.program.is_absolute() && beside.program.ends_with("bin/world"),
            "{:?} {folder:?}",
            beside.program
        );
    }

    #[test]
    fn read_world_file_refuses_a_wrong_file_with_a_hint() {
        for bad in [
            "",
            "[]",
            "{}",
            r#"{"command": []}"#,
            r#"{"command": "python3 world.py"}"#,
            r#"{"command": ["x"], "timeout": 3}"#,
            r#"{"command": ["x"], "width_px": 100000}"#,
            r#"{"command": ["x"], "answer_within_s": -1}"#,
            r#"{"command": ["x"], "answer_within_s": 1e300}"#,
            r#"{"command": ["x"], "spacing_m": 0}"#,
        ] {
            let error = read(bad).unwrap_err().to_string();
            assert!(error.contains("world.json") && error.contains("docs/PROCESS.md"), "{bad}: {error}");
        }
        assert!(ProcessOptions::read_world_file(Path::new("/nowhere/world.py")).is_err());
    }
}
