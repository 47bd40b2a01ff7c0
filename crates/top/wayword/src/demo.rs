//! `wayword demo`: writes instructions for one path through a generated house, without a model, and prints them.

use clap::Args;
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_core::{ClimbDirection, PathMove, TurnKind, Verdict};
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_house::scene_name;
use wayword_report::pages;
use wayword_run::generate::generate_into;
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    run_folder::{WalkRecord, expect_run_place, file, read_lines},
    settings::{AskedSettings, Draw, Walks},
};

/// `wayword demo`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword demo\n  wayword demo --seed 7 --out walk")]
pub struct DemoArgs {
    /// Seed of the house and of the path through it.
    #[arg(long, default_value_t = 3)]
    pub seed: u64,
    /// Folder for the run and its report.
    #[arg(long, default_value = "wayword-demo")]
    pub out: PathBuf,
}

/// The report of a demo shows its one path.
const DEMO_ITEMS: usize = 1;

pub(crate) fn run_demo(args: &DemoArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let asked = AskedSettings {
        walks: Walks { scan: Some(vec![scene_name(args.seed)]), paths: Some(1), ..Walks::default() },
        draw: Draw { seed: Some(args.seed), ..Draw::default() },
        ..AskedSettings::default()
    };
    expect_run_place(&args.out)?;
    output.say(format_args!("generating {} and a path through it ...", scene_name(args.seed)));
    let summary = generate_into(&args.out, &asked.into_job()?, output)?;
    if let Some(reason) = &summary.stopped {
        output.say(format_args!("stopped before the end: {reason}"));
        return Ok(summary.exit);
    }
    let report = args.out.join(file::REPORT);
    pages::write_report(&args.out, &report, DEMO_ITEMS)?;
    let shown = DemoOutput {
        walks: read_lines(&args.out.join(file::WALKS))?,
        records: jsonl::read_records(&args.out.join(file::INSTRUCTIONS))?,
        report,
    };
    output.print_result(&shown, &shown);
    Ok(Exit::Done)
}

/// The output of the demo.
#[derive(Serialize)]
struct DemoOutput {
    walks: Vec<WalkRecord>,
    records: Vec<InstructionRecord>,
    report: PathBuf,
}

impl fmt::Display for DemoOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for walk in &self.walks {
            let length = walk.path.length_m().map_or_else(String::new, |length_m| format!("{length_m:.1} m in "));
            writeln!(f, "{}: {length}{}", walk.path.id, count_phrase(walk.path.frames.len(), "frame"))?;
            let moves = walk.path.moves();
            for (at, observation) in walk.observations.iter().enumerate() {
                let then = moves.get(at).map_or(String::new(), describe_move);
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
fn describe_move(step: &PathMove) -> String {
    let turn = match step.turn() {
        TurnKind::Straight => None,
        TurnKind::SlightLeft => Some("turn slightly left"),
        TurnKind::SlightRight => Some("turn slightly right"),
        TurnKind::Left => Some("turn left"),
        TurnKind::Right => Some("turn right"),
        TurnKind::Around => Some("turn around"),
    };
    let climb = match step.climb() {
        ClimbDirection::Level => None,
        ClimbDirection::Up => Some("go up"),
        ClimbDirection::Down => Some("go down"),
    };
    let words: Vec<&str> = turn.into_iter().chain(climb).collect();
    if words.is_empty() { String::new() } else { format!("  [{}]", words.join(", ")) }
}
