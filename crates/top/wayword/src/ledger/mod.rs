//! `wayword ledger`: lists the calls that the ledger keeps, sums their cost, exports and drops them.

pub mod args;
use crate::ledger::args::{Ledger as Args, LedgerCommand};
use serde::Serialize;
use std::fmt;
use wayword_ledger::{CostLine, Filter, Ledger, Row};
use wayword_run::{
    calls::ledger_path,
    count::count,
    error::{Error, Exit},
    output::Output,
    settings::Service,
};

const SECONDS_PER_DAY: u64 = 86_400;

pub fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let path = ledger_path(&Service { ledger: args.ledger.clone(), ..Service::default() })?;
    if !path.exists() {
        return Err(Error::usage(
            format!("{}: there is no ledger yet", path.display()),
            "the first command that asks a model makes it; if yours is elsewhere, give --ledger FILE",
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
                    "prune without a filter would empty the ledger",
                    "say which calls to drop: --older-than-days, --model or --changed",
                ));
            }
            let filter = Filter {
                older_than_s: older_than_days.map(|days| days.saturating_mul(SECONDS_PER_DAY)),
                model: model.clone(),
                ..Filter::default()
            };
            let rows = if *changed { ledger.prune_changed()? } else { ledger.prune(&filter)? };
            let done = Done { ledger: path.display().to_string(), rows };
            let then = if rows == 0 {
                "the ledger holds none that match"
            } else {
                "a run that needs them again pays for them again"
            };
            output.data(&done, format_args!("{} dropped: {then}", count(rows, "call")));
        }
    }
    Ok(Exit::Done)
}

/// How many calls a command exported or dropped.
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
        if self.rows.is_empty() {
            return write!(f, "0 calls: the ledger holds none that match");
        }
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
    /// Requests that were sent and got no answer that is known.
    lost: u64,
}

impl fmt::Display for Costs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.lines.is_empty() {
            writeln!(f, "the ledger holds no calls yet")?;
        }
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
        match self.lost {
            0 => write!(f, "no request was lost (sent, but without a known answer)"),
            lost => {
                let lost = count(lost, "request");
                write!(f, "{lost} lost (sent, but without a known answer); the provider may have charged for this")
            }
        }
    }
}
