//! Compares a detector that runs in this process with an implementation in PyTorch, on the same random weights of the true size: its
//! numbers, its time and its memory.

mod oracle;
mod subject;

use oracle::{ParityCase, PictureCost, PytorchOracle};
use std::{
    path::{Path, PathBuf},
    time::Instant,
};
use subject::ParitySubject;
use wayword_core::Image;
use wayword_run::{error::CommandError, output::CommandOutput};
use wayword_testkit::resources;

/// The flags of `parity`.
#[derive(Debug, clap::Args)]
pub(super) struct ParityArgs {
    /// The detector.
    #[arg(value_enum)]
    detector: ParityDetector,
    /// A folder for random checkpoints and PyTorch's numbers, up to 2 GB for each detector. Missing files are made.
    #[arg(long)]
    folder: PathBuf,
    /// Compute so many pictures with each of the two, in turns, and compare the times.
    #[arg(long, default_value_t = 0)]
    times: usize,
    /// Python with the packages that the scripts in `crates/models/wayword-local/fixtures` name.
    #[arg(long, default_value = "python3")]
    python: PathBuf,
}

/// The detectors that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum ParityDetector {
    GlipT,
    GroundingDinoTiny,
    GroundingDinoBase,
    MmGroundingDinoTiny,
    MmGroundingDinoBase,
    Owlv2Base,
}

/// The largest differences between the numbers of two implementations.
#[derive(Debug, Clone, Copy, Default)]
struct NumberDifference {
    logits: f32,
    /// Of the edges of boxes, pixels.
    boxes_px: f32,
}

/// The largest differences with which numbers count as equal.
const MAX_DIFFERENCE: NumberDifference = NumberDifference { logits: 1e-4, boxes_px: 1e-3 };

/// The number of threads of each side.
const THREAD_COUNT: usize = 2;

/// Width and height of the pictures of which the time is measured, pixels.
const TIMED_SIZE_PX: (u32, u32) = (640, 480);

/// Compares all cases, and the times if the flags ask for them. Prints one line for each.
pub(super) fn measure_parity(flags: &ParityArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let threads = rayon::ThreadPoolBuilder::new().num_threads(THREAD_COUNT).build_global();
    threads.map_err(|error| CommandError::usage(format!("cannot use {THREAD_COUNT} threads: {error}"), "try again"))?;
    let folder = flags.folder.join(flags.detector.script_and_name().1);
    let oracle = PytorchOracle::open_or_make(flags.detector, &folder, &flags.python)?;
    let mut lines = Vec::new();
    if flags.times > 0 {
        lines.extend(compare_times(flags, &folder, &oracle)?);
    }
    lines.push("picture    phrases   logits     boxes".to_owned());
    let mut loaded: Option<(Option<usize>, ParitySubject)> = None;
    for (at, case) in oracle.cases.iter().enumerate() {
        // GLIP's pictures are shown at several sizes, so it is loaded again when the size changes.
        let subject = match loaded.take() {
            Some((short_px, subject)) if short_px == case.short_px => subject,
            _ => ParitySubject::load_detector(flags.detector, &folder, case.short_px)?,
        };
        let off = subject.compare_case(case, &oracle.case_numbers(at))?;
        lines.push(case_line(case, off));
        loaded = Some((case.short_px, subject));
    }
    output.print_result(&(), lines.join("\n"));
    Ok(())
}

/// The line of a case: its picture, its phrases and the differences.
fn case_line(case: &ParityCase, off: NumberDifference) -> String {
    let (width, height) = case.size;
    let reached = if off.logits <= MAX_DIFFERENCE.logits && off.boxes_px <= MAX_DIFFERENCE.boxes_px {
        ""
    } else {
        "  not reached"
    };
    let size = format!("{width}x{height}");
    format!("{size:<10} {:>7}  {:>7.1e}  {:>7.1e} px{reached}", case.phrases.len(), off.logits, off.boxes_px)
}

/// The times of both sides, in turns.
fn compare_times(flags: &ParityArgs, folder: &Path, oracle: &PytorchOracle) -> Result<Vec<String>, CommandError> {
    let subject = ParitySubject::load_detector(flags.detector, &flags.detector.timed_folder(folder), Some(480))?;
    let mut clock = oracle.start_clock(&flags.python)?;
    let (mut ours, mut theirs, mut twenty_costs) = (Vec::new(), Vec::new(), Vec::new());
    // The first round warms up and does not count.
    for round in 0..=flags.times {
        let our_cost = time_picture(&subject, round, &flags.detector.round_phrases(round))?;
        let their_cost = clock.time_picture()?;
        if flags.detector == ParityDetector::Owlv2Base {
            twenty_costs.push(time_picture(&subject, round + 100, &twenty_phrases(round))?);
        }
        if round > 0 {
            ours.push(our_cost);
            theirs.push(their_cost);
        } else {
            twenty_costs.clear();
        }
    }
    let (ours, theirs) = (PictureCost::median_cost(&ours), PictureCost::median_cost(&theirs));
    let mut lines = vec![
        "side       seconds  of both threads   at most".to_owned(),
        format!("Wayword    {ours}"),
        format!("PyTorch    {theirs}"),
        format!("ratio      {:>7.2} {:>16.2}", ours.wall_s / theirs.wall_s, ours.cpu_s / theirs.cpu_s),
    ];
    if !twenty_costs.is_empty() {
        let twenty_costs = PictureCost::median_cost(&twenty_costs);
        lines.push(format!(
            "20 phrases {twenty_costs}, {:.3} of the time of 3 phrases",
            twenty_costs.cpu_s / ours.cpu_s
        ));
    }
    Ok(lines)
}

/// The cost of one picture that is not in any cache.
fn time_picture(subject: &ParitySubject, number: usize, phrases: &[String]) -> Result<PictureCost, CommandError> {
    let image = test_picture(TIMED_SIZE_PX, number as u8)?;
    let phrases: Vec<&str> = phrases.iter().map(String::as_str).collect();
    let (begun, before) = (Instant::now(), resources::processor_time());
    subject.find_phrases(&image, &phrases)?;
    let (wall, busy) = (begun.elapsed(), resources::processor_time().saturating_sub(before));
    Ok(PictureCost { wall_s: wall.as_secs_f64(), cpu_s: busy.as_secs_f64(), peak_mib: resources::peak_mib() })
}

/// Twenty phrases that no earlier round had, so that no cache has them.
fn twenty_phrases(round: usize) -> Vec<String> {
    (0..20).map(|at| format!("{} door {round}", char::from(b'a' + at))).collect()
}

/// A picture by the formula that the scripts for PyTorch's numbers use too. `number` changes one byte.
fn test_picture((width, height): (u32, u32), number: u8) -> Result<Image, CommandError> {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    let mut rgb: Vec<u8> = (0..width * height * 3).map(byte).collect();
    if let Some(first) = rgb.first_mut() {
        *first = first.wrapping_add(number);
    }
    let made = Image::new(width, height, rgb);
    made.map_err(|error| CommandError::usage(error.to_string(), "take the folder away and make it again"))
}

impl ParityDetector {
    /// The script that makes its random checkpoint, and the model's name there.
    fn script_and_name(self) -> (&'static str, &'static str) {
        match self {
            Self::GlipT => ("make_glip.py", "glip"),
            Self::GroundingDinoTiny => ("make_dino.py", "grounding-dino-tiny"),
            Self::GroundingDinoBase => ("make_dino.py", "grounding-dino-base"),
            Self::MmGroundingDinoTiny => ("make_dino.py", "mm-grounding-dino-tiny"),
            Self::MmGroundingDinoBase => ("make_dino.py", "mm-grounding-dino-base"),
            Self::Owlv2Base => ("make_owl.py", "owl"),
        }
    }

    /// The folder of the model that is timed. Grounding DINO's settings contain the size of pictures, so it has a copy for smaller ones.
    fn timed_folder(self, folder: &Path) -> PathBuf {
        match self {
            Self::GlipT | Self::Owlv2Base => folder.to_owned(),
            _ => folder.join("small"),
        }
    }

    /// Phrases of 12 tokens, the tokens at both ends included. OWLv2 keeps the texts that it has encoded, so it gets others each round.
    fn round_phrases(self, round: usize) -> Vec<String> {
        let all = |phrases: &[&str]| phrases.iter().map(|&phrase| phrase.to_owned()).collect();
        match self {
            Self::GlipT => all(&["blue chair", "lamp", "sink", "a wooden door"]),
            Self::Owlv2Base => ["red door", "sink", "stairs"].iter().map(|name| format!("{name} {round}")).collect(),
            _ => all(&["red door", "stairs", "kitchen table", "sink"]),
        }
    }
}
