//! `wayword ledger`: what was asked, what it cost, and what is kept of it.

use crate::{
    calls::ledger_path,
    cli::{Ledger as Args, LedgerCommand},
    count::count,
    error::{Error, Exit},
    output::Output,
    settings::Service,
};
use serde::Serialize;
use std::fmt;
use wayword_ledger::{CostLine, Filter, Ledger, Row};

const SECONDS_PER_DAY: u64 = 86_400;

pub(super) fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let path = ledger_path(&Service { ledger: args.ledger.clone(), ..Service::default() })?;
    if !path.exists() {
        return Err(Error::usage(
            format!("{}: there is no ledger yet", path.display()),
            "it is made by the first command that asks a model; name another with --ledger FILE",
        ));
    }
    let ledger = Ledger::open(&path)?;
    match &args.command {
        LedgerCommand::Show { filter, limit } => {
            let rows = ledger.list(&Filter { limit: Some(*limit), ..filter.filter() })?;
            let shown = Shown { rows };
            output.data(&shown, &shown);
        }
        LedgerCommand::Cost { by } => {
            let costs = Costs { lines: ledger.costs((*by).into())?, lost: ledger.lost()? };
            output.data(&costs, &costs);
        }
        LedgerCommand::Export { filter, out } => {
            let rows = ledger.export_to(&filter.filter(), out)?;
            let done = Done { ledger: path.display().to_string(), rows };
            output.data(&done, format_args!("{} written to {}", count(rows, "call"), out.display()));
        }
        LedgerCommand::Prune { older_than_days, model, changed } => {
            if older_than_days.is_none() && model.is_none() && !changed {
                return Err(Error::usage(
                    "that would empty the ledger",
                    "say what to drop: --older-than-days, --model or --changed",
                ));
            }
            let filter = Filter {
                older_than_s: older_than_days.map(|days| days.saturating_mul(SECONDS_PER_DAY)),
                model: model.clone(),
                ..Filter::default()
            };
            let rows = if *changed { ledger.prune_changed()? } else { ledger.prune(&filter)? };
            let done = Done { ledger: path.display().to_string(), rows };
            output.data(&done, format_args!("{} dropped; asking again will cost again", count(rows, "call")));
        }
    }
    Ok(Exit::Done)
}

/// How many rows a command was about.
#[derive(Serialize)]
struct Done {
    ledger: String,
    rows: usize,
}

#[derive(Serialize)]
struct Shown {
    rows: Vec<Row>,
}

/// Characters of an answer that a line shows.
const SHOWN_CHARS: usize = 70;

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for row in &self.rows {
            let answer: String = row.answer.text.split_whitespace().collect::<Vec<_>>().join(" ");
            let answer: String = answer.chars().filter(|c| !c.is_control()).take(SHOWN_CHARS).collect();
            let key: String = row.key.to_string().chars().take(12).collect();
            writeln!(
                f,
                "{key}  {}  {} in, {} out, {} ms: {answer}",
                row.call.model, row.answer.tokens_in, row.answer.tokens_out, row.answer.latency_ms
            )?;
        }
        write!(f, "{}", count(self.rows.len(), "call"))
    }
}

#[derive(Serialize)]
struct Costs {
    lines: Vec<CostLine>,
    /// Requests that were sent and whose answer is not known.
    lost: u64,
}

impl fmt::Display for Costs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in &self.lines {
            let unknown = match line.without_price {
                0 => String::new(),
                calls => format!(" and {}", count(calls, "call of unknown price")),
            };
            writeln!(
                f,
                "{:<40} {:>14}  {:>10} in  {:>10} out  ${:.4}{unknown}",
                line.of,
                count(line.calls, "call"),
                line.tokens_in,
                line.tokens_out,
                line.usd
            )?;
        }
        write!(f, "{} sent without a known answer; what was sent may have been paid for", count(self.lost, "request"))
    }
}
