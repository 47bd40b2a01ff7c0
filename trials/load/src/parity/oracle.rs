//! Runs the PyTorch implementation: a script in Python that makes a random checkpoint, computes the expected numbers, and measures times.

use super::ParityDetector;
use safetensors::SafeTensors;
use serde::Deserialize;
use std::{
    fmt, fs,
    io::{BufRead, BufReader, Write},
    path::{Path, PathBuf},
    process::{Child, ChildStdin, ChildStdout, Command, Stdio},
};
use wayword_core::DetectedBox;
use wayword_run::error::CommandError;

/// The numbers that PyTorch computed with a model.
pub(super) struct PytorchOracle {
    script: PathBuf,
    folder: PathBuf,
    /// The pictures and phrases of the computation.
    pub(super) cases: Vec<ParityCase>,
    /// The contents of the safetensors file with the numbers of all cases.
    tensors: Vec<u8>,
}

/// One comparison: a picture and the phrases that the detector looks for in it.
#[derive(Debug, Deserialize)]
pub(super) struct ParityCase {
    /// Width and height, pixels.
    pub(super) size: (u32, u32),
    /// The short edge at which the picture is shown to the model, where the model's files do not state it.
    #[serde(rename = "short")]
    pub(super) short_px: Option<usize>,
    /// The phrases that the detector looks for.
    pub(super) phrases: Vec<String>,
    /// The finds of each phrase (edges and score), where the model's own boxes are not compared.
    #[serde(default)]
    boxes: Vec<Vec<[f32; 5]>>,
}

impl ParityCase {
    /// The finds of each phrase.
    pub(super) fn expected_finds(&self) -> Vec<Vec<DetectedBox>> {
        let to_box =
            |&[left, top, right, bottom, score]: &[f32; 5]| DetectedBox { box_px: [left, top, right, bottom], score };
        self.boxes.iter().map(|finds| finds.iter().map(to_box).collect()).collect()
    }
}

/// The numbers of a case.
pub(super) struct CaseNumbers<'a> {
    tensors: &'a [u8],
    /// The number of the case.
    at: usize,
}

impl CaseNumbers<'_> {
    /// A tensor of the case, flat.
    pub(super) fn tensor_values(&self, name: &str) -> Result<Vec<f32>, CommandError> {
        let name = format!("{}.{name}", self.at);
        let tensors = SafeTensors::deserialize(self.tensors);
        let numbers = tensors.and_then(|tensors| {
            let bytes = tensors.tensor(&name)?.data().to_vec();
            Ok(bytes.chunks_exact(4).map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect())
        });
        numbers
            .map_err(|error| CommandError::usage(format!("{name}: {error}"), "take the folder away and make it again"))
    }
}

impl PytorchOracle {
    /// Opens a folder with PyTorch's numbers. Runs the script to make it if it doesn't exist.
    pub(super) fn open_or_make(kind: ParityDetector, folder: &Path, python: &Path) -> Result<Self, CommandError> {
        let (script, name) = kind.script_and_name();
        let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../crates/models/wayword-local/fixtures");
        let (script, cases_file) = (fixtures.join(script), folder.join("expected.json"));
        if !cases_file.is_file() {
            let mut command = Command::new(python);
            let made = command.arg(&script).arg("--true").arg(folder).arg(name).stdout(Stdio::null()).status();
            if !made.map_err(|source| io_error(python, "run", source))?.success() {
                return Err(script_error(&script));
            }
        }
        let text = fs::read_to_string(&cases_file).map_err(|source| io_error(&cases_file, "read", source))?;
        let cases = serde_json::from_str(&text).map_err(|error| {
            CommandError::usage(format!("{}: {error}", cases_file.display()), "take the folder away and make it again")
        })?;
        let file = folder.join("expected.safetensors");
        let tensors = fs::read(&file).map_err(|source| io_error(&file, "read", source))?;
        Ok(Self { script, folder: folder.to_owned(), cases, tensors })
    }

    /// The numbers of a case.
    pub(super) fn case_numbers(&self, at: usize) -> CaseNumbers<'_> {
        CaseNumbers { tensors: &self.tensors, at }
    }

    /// Starts the process that measures PyTorch's times.
    pub(super) fn start_clock(&self, python: &Path) -> Result<PytorchClock, CommandError> {
        let mut command = Command::new(python);
        command.arg(&self.script).arg("--time").arg(&self.folder).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().map_err(|source| io_error(python, "run", source))?;
        let (Some(asks), Some(says)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(script_error(&self.script));
        };
        Ok(PytorchClock { child, stdin: asks, stdout: BufReader::new(says), script: self.script.clone() })
    }
}

/// A process that computes one picture each time that it is asked.
pub(super) struct PytorchClock {
    child: Child,
    /// A line asks for one picture.
    stdin: ChildStdin,
    /// A line has the numbers of one picture.
    stdout: BufReader<ChildStdout>,
    script: PathBuf,
}

impl PytorchClock {
    /// The cost of one picture.
    pub(super) fn time_picture(&mut self) -> Result<PictureCost, CommandError> {
        let mut line = String::new();
        let asked = writeln!(self.stdin).and_then(|()| self.stdin.flush());
        asked
            .and_then(|()| self.stdout.read_line(&mut line))
            .map_err(|source| io_error(&self.script, "ask", source))?;
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|number| number.parse().ok()).collect();
        match numbers[..] {
            [wall_s, cpu_s, peak_mib] => Ok(PictureCost { wall_s, cpu_s, peak_mib }),
            _ => Err(script_error(&self.script)),
        }
    }
}

impl Drop for PytorchClock {
    fn drop(&mut self) {
        // It may have ended by itself.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// The time that a picture took, and the most memory of the process so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct PictureCost {
    /// Time on the clock, seconds.
    pub(super) wall_s: f64,
    /// Processor time of all threads, seconds.
    pub(super) cpu_s: f64,
    /// The most memory, MiB.
    pub(super) peak_mib: f64,
}

impl PictureCost {
    /// The median times, and the most memory.
    pub(super) fn median_cost(all: &[Self]) -> Self {
        let middle = |figure: fn(&Self) -> f64| {
            let mut all: Vec<f64> = all.iter().map(figure).collect();
            all.sort_by(f64::total_cmp);
            all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let peak_mib = all.iter().map(|spent| spent.peak_mib).fold(0.0, f64::max);
        Self { wall_s: middle(|spent| spent.wall_s), cpu_s: middle(|spent| spent.cpu_s), peak_mib }
    }
}

impl fmt::Display for PictureCost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:>7.2} {:>16.2} {:>5.0} MiB", self.wall_s, self.cpu_s, self.peak_mib)
    }
}

fn io_error(path: &Path, doing: &'static str, source: std::io::Error) -> CommandError {
    CommandError::Io { path: path.to_owned(), doing, source }
}

fn script_error(script: &Path) -> CommandError {
    let problem = format!("{} failed", script.display());
    CommandError::usage(problem, "install the packages that its head names, or name another Python by --python")
}
