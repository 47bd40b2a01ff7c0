//! `wayword demo`.

use clap::Args;
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_core::{Climb, Move, Turn, Verdict};
use wayword_formats::jsonl::{self, Record};
use wayword_house::scene_name;
use wayword_report::pages as report;
use wayword_run::generate::generate_into;
use wayword_run::{
    count::count,
    error::{Error, Exit},
    output::Output,
    run_folder::{WalkRecord, file, read_lines},
    settings::{Asked, Draw, Walks},
};

/// `wayword demo`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword demo\n  wayword demo --seed 7 --out walk")]
pub struct Demo {
    /// Seed of the house and of the path through it.
    #[arg(long, default_value_t = 3)]
    pub seed: u64,
    /// Folder for the run and its report.
    #[arg(long, default_value = "wayword-demo")]
    pub out: PathBuf,
}

/// The report of a demo shows its one path.
const ITEMS: usize = 1;

pub fn run(args: &Demo, output: &Output) -> Result<Exit, Error> {
    let asked = Asked {
        walks: Walks { scan: Some(vec![scene_name(args.seed)]), paths: Some(1), ..Walks::default() },
        draw: Draw { seed: Some(args.seed), ..Draw::default() },
        ..Asked::default()
    };
    output.say(format_args!("generating {} and a path through it ...", scene_name(args.seed)));
    let summary = generate_into(&args.out, &asked.job()?, output)?;
    if let Some(reason) = &summary.stopped {
        output.say(format_args!("stopped before the end: {reason}"));
        return Ok(summary.exit);
    }
    let report = args.out.join(file::REPORT);
    report::write(&args.out, &report, ITEMS)?;
    let shown = Shown {
        walks: read_lines(&args.out.join(file::WALKS))?,
        records: jsonl::read(&args.out.join(file::INSTRUCTIONS))?,
        report,
    };
    output.data(&shown, &shown);
    Ok(Exit::Done)
}

/// The output of the demo.
#[derive(Serialize)]
struct Shown {
    walks: Vec<WalkRecord>,
    records: Vec<Record>,
    report: PathBuf,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for walk in &self.walks {
            let length = walk.path.length_m().map_or_else(String::new, |length_m| format!("{length_m:.1} m in "));
            writeln!(f, "{}: {length}{}", walk.path.id, count(walk.path.frames.len(), "frame"))?;
            let moves = walk.path.moves();
            for (at, observation) in walk.observations.iter().enumerate() {
                let then = moves.get(at).map_or(String::new(), motion);
                writeln!(f, "  {at:>2}  {}{then}", observation.summary)?;
            }
        }
        for record in &self.records {
            let verdict = if record.instruction.verdict == Verdict::Pass {
                "every check passed"
            } else {
                "not everything could be checked"
            };
            writeln!(f, "\n{} ({verdict}):\n  {}", record.instruction.style, record.instruction.text)?;
        }
        if let Some(record) = self.records.first() {
            let provenance = &record.instruction.provenance;
            let (answerer, writer) = (&provenance.answerer, &provenance.writer);
            writeln!(
                f,
                "\nNo model took part: {answerer} (ground truth) answered the questions, {writer} asked them and wrote."
            )?;
        }
        write!(f, "Report: {}", self.report.display())
    }
}

/// The move after a frame, in brackets.
fn motion(step: &Move) -> String {
    let turn = match step.turn() {
        Turn::Straight => None,
        Turn::SlightLeft => Some("turn slightly left"),
        Turn::SlightRight => Some("turn slightly right"),
        Turn::Left => Some("turn left"),
        Turn::Right => Some("turn right"),
        Turn::Around => Some("turn around"),
    };
    let climb = match step.climb() {
        Climb::Level => None,
        Climb::Up => Some("go up"),
        Climb::Down => Some("go down"),
    };
    let words: Vec<&str> = turn.into_iter().chain(climb).collect();
    if words.is_empty() { String::new() } else { format!("  [{}]", words.join(", ")) }
}
