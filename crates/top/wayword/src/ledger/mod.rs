//! `wayword ledger`: lists the calls that the ledger keeps, sums their cost, exports and drops them.

pub(crate) mod args;
use crate::ledger::args::{LedgerArgs as Args, LedgerCommand};
use serde::Serialize;
use std::fmt;
use wayword_formats::OutputFile;
use wayword_ledger::{CostLine, Ledger, LedgerEntry, LedgerFilter};
use wayword_run::{
    calls::ledger_path,
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    settings::Service,
    written_files::{find_output_place, refuse_over_input},
};

const SECONDS_PER_DAY: u64 = 86_400;

pub(crate) fn run_ledger(args: &Args, output: &CommandOutput) -> Result<Exit, CommandError> {
    let path = ledger_path(&Service { ledger: args.ledger.clone(), ..Service::default() })?;
    if !path.exists() {
        return Err(CommandError::usage(
            format!("{}: there is no ledger yet", path.display()),
            "the first command that asks a model makes it; if yours is elsewhere, give --ledger FILE",
        ));
    }
    let ledger = Ledger::open(&path)?;
    match &args.command {
        LedgerCommand::Show { filter, limit } => {
            let rows = ledger.list_calls(&LedgerFilter { limit: Some(*limit), ..filter.to_filter() })?;
            let shown = ShownCalls { rows };
            output.print_result(&shown, &shown);
        }
        LedgerCommand::Cost { by } => {
            let costs = LedgerCosts { lines: ledger.sum_costs((*by).into())?, lost: ledger.count_lost_requests()? };
            output.print_result(&costs, &costs);
        }
        LedgerCommand::Export { filter, out } => {
            refuse_over_input("--out", out, [path.clone()])?;
            let output = &output.beside_data(&find_output_place(out)?);
            let failed = || CommandError::io(out, "write");
            let mut lines = OutputFile::begin(out).map_err(failed())?;
            let rows = ledger.export_calls(&filter.to_filter(), out, &mut lines)?;
            lines.finish().map_err(failed())?;
            let done = LedgerOutcome { ledger: path.display().to_string(), rows };
            output.print_result(&done, format_args!("{} written to {}", count_phrase(rows, "call"), out.display()));
        }
        LedgerCommand::Prune { older_than_days, model, changed } => {
            if older_than_days.is_none() && model.is_none() && !changed {
                return Err(CommandError::usage(
                    "prune without a filter would empty the ledger",
                    "say which calls to drop: --older-than-days, --model or --changed",
                ));
            }
            let filter = LedgerFilter {
                older_than_s: older_than_days.map(|days| days.saturating_mul(SECONDS_PER_DAY)),
                model: model.clone(),
                ..LedgerFilter::default()
            };
            let rows = if *changed { ledger.prune_changed()? } else { ledger.prune_calls(&filter)? };
            let done = LedgerOutcome { ledger: path.display().to_string(), rows };
            let consequence = if rows == 0 {
                "the ledger holds none that match (--model takes a whole name, as `wayword ledger show` prints it)"
            } else {
                "a run that needs them again pays for them again"
            };
            output.print_result(&done, format_args!("{} dropped: {consequence}", count_phrase(rows, "call")));
        }
    }
    Ok(Exit::Done)
}

/// How many calls a command exported or dropped.
#[derive(Serialize)]
struct LedgerOutcome {
    ledger: String,
    rows: usize,
}

/// Calls of the ledger, as a list.
#[derive(Serialize)]
struct ShownCalls {
    rows: Vec<LedgerEntry>,
}

/// Characters of an answer that a line shows; the rest is cut off.
const SHOWN_CHARS: usize = 70;

impl fmt::Display for ShownCalls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.rows.is_empty() {
            return write!(f, "0 calls: the ledger holds none that match");
        }
        for row in &self.rows {
            let answer: String = row.answer.text.split_whitespace().collect::<Vec<_>>().join(" ");
            let answer: String = answer.chars().filter(|c| !c.is_control()).take(SHOWN_CHARS).collect();
            // The first 12 digits of the hash are enough to find a call.
            let key: String = row.key.to_string().chars().take(12).collect();
            writeln!(
                f,
                "{key}  {}  {} in, {} out, {} ms: {answer}",
                row.call.model, row.answer.tokens_in, row.answer.tokens_out, row.answer.latency_ms
            )?;
        }
        write!(f, "{}", count_phrase(self.rows.len(), "call"))
    }
}

/// The cost of the calls, by model, run or day.
#[derive(Serialize)]
struct LedgerCosts {
    lines: Vec<CostLine>,
    /// Requests that were sent and got no answer that is known.
    lost: u64,
}

impl fmt::Display for LedgerCosts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.lines.is_empty() {
            writeln!(f, "the ledger holds no calls yet")?;
        }
        for line in &self.lines {
            let unknown = match line.without_price {
                0 => String::new(),
                calls => format!(" and {}", count_phrase(calls, "call of unknown price")),
            };
            writeln!(
                f,
                "{:<40} {:>14}  {:>10} in  {:>10} out  ${:.4}{unknown}",
                line.of,
                count_phrase(line.calls, "call"),
                line.tokens_in,
                line.tokens_out,
                line.usd
            )?;
        }
        match self.lost {
            0 => write!(f, "no request was lost (sent, but without a known answer)"),
            lost => {
                let lost = count_phrase(lost, "request");
                write!(f, "{lost} lost (sent, but without a known answer); the provider may have charged for this")
            }
        }
    }
}
