//! A store in a database of PostgreSQL, which many programs on many machines share.
//!
//! Every change is one statement that has no effect when it is executed twice, because it is sent again after a lost connection. To
//! avoid deadlocks, statements that change several tables change them in this order: `runs`, `sent`, `calls`, `uses`, `claims`,
//! `settled`.

mod amount;
mod link;
mod presence;
mod queries;
mod rates;
mod rows;
mod tables;

use super::{CallQueries, CallStore, ClaimHolder, ClaimState, PendingRequest, RequestEnd, SendSlot, SentRequest};
use crate::{
    CallAnswer, CallKey, LedgerEntry, LedgerError, LedgerLocation, ProviderRates, RequestRefusedError,
    budget::check_limits, checksum,
};
use link::{DatabaseLink, ReserveOutcome};
use presence::DatabasePresence;
use rows::{columns, count_to_i64, read_checked_entry, without_nul};
use std::sync::{Arc, OnceLock};
use wayword_database::{PostgresDatabase, postgres::types::ToSql, prepare_tables};

pub(crate) use presence::LeaseTiming;
pub use tables::LEDGER_TABLES;

/// How often a refused reservation is tried again if the request should fit by the current state of the ledger.
const MAX_RESERVE_TRIES: usize = 20;

/// Selects the answer of a call and notes that a run has used it.
const ANSWER_SQL: &str = concat!(
    "WITH used AS (
        INSERT INTO wayword_ledger.uses (run, key)
        SELECT $2, key FROM wayword_ledger.calls WHERE key = $1
        AND NOT EXISTS (SELECT FROM wayword_ledger.uses WHERE run = $2 AND key = $1) ON CONFLICT DO NOTHING
    )
    SELECT ",
    columns!(),
    " FROM wayword_ledger.calls WHERE key = $1"
);

/// Gives call `$1` to program `$2`, unless the call is answered or a program other than `$3` has it. Selects whether the call is
/// answered, and whether program `$2` has it now.
const CLAIM_SQL: &str = "
WITH given AS (
    INSERT INTO wayword_ledger.claims AS c (key, holder)
    SELECT $1, $2 WHERE NOT EXISTS (SELECT FROM wayword_ledger.calls WHERE key = $1)
    ON CONFLICT (key) DO UPDATE SET holder = $2 WHERE c.holder = $2 OR c.holder = $3 RETURNING 1
)
SELECT EXISTS (SELECT FROM wayword_ledger.calls WHERE key = $1), EXISTS (SELECT FROM given)";

/// Selects whether a call is answered.
const IS_ANSWERED_SQL: &str = "SELECT EXISTS (SELECT FROM wayword_ledger.calls WHERE key = $1)";

/// Selects the holder of a claim. While the server has been running for less than a lease, no holder counts as gone, because programs
/// could not give signs of life before.
const HOLDER_SQL: &str = "
SELECT holder, (SELECT count(*) FROM wayword_ledger.sent AS s WHERE s.key = c.key AND s.program = c.holder),
    pg_postmaster_start_time() < clock_timestamp() - make_interval(secs => $2) AND NOT EXISTS (
        SELECT FROM wayword_ledger.presence AS p
        WHERE p.program = c.holder AND p.beat > clock_timestamp() - make_interval(secs => $2)
    )
FROM wayword_ledger.claims AS c WHERE key = $1";

/// Stores an answer if it is the first, ends its request, releases the money that it did not cost, and releases the claim. The
/// conditions on row counts, which are always true, only make one part wait for the other.
const STORE_ANSWER_SQL: &str = "
WITH moved AS (
    UPDATE wayword_ledger.sent SET outcome = 'answered', usd = $10
    WHERE program = $16 AND number = $17 AND outcome IS NULL RETURNING run, coalesce(most, 0) AS most
),
kept AS (
    INSERT INTO wayword_ledger.calls
    SELECT $1, $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12, $13, $14, $15 WHERE (SELECT count(*) FROM moved) >= 0
    ON CONFLICT (key) DO NOTHING RETURNING 1
),
used AS (
    INSERT INTO wayword_ledger.uses (run, key) SELECT $14, $1 WHERE (SELECT count(*) FROM kept) >= 0
    ON CONFLICT DO NOTHING RETURNING 1
),
freed AS (
    DELETE FROM wayword_ledger.claims WHERE key = $1 AND holder = $16 AND (SELECT count(*) FROM used) >= 0 RETURNING 1
),
paid AS (
    INSERT INTO wayword_ledger.settled AS s (run, slot, released, spent, cancelled)
    SELECT run, $18, most, coalesce($19::bigint, most), 0 FROM moved WHERE (SELECT count(*) FROM freed) >= 0
    ON CONFLICT (run, slot) DO UPDATE SET released = s.released + EXCLUDED.released, spent = s.spent + EXCLUDED.spent
)
SELECT EXISTS (SELECT FROM kept)";

/// A ledger in a database.
#[derive(Debug)]
pub(crate) struct PostgresStore {
    link: Arc<DatabaseLink>,
    /// How often this program gives a sign of life, and when others count as gone.
    pulse: LeaseTiming,
    /// Shows other programs that this one is running, from its first claim on.
    presence: OnceLock<Result<DatabasePresence, LedgerError>>,
}

impl PostgresStore {
    pub(crate) fn open(database: &PostgresDatabase, pulse: LeaseTiming) -> Result<Self, LedgerError> {
        let link = DatabaseLink::new(database.clone());
        prepare_tables(&link.pool, &LEDGER_TABLES)?;
        Ok(Self { link: Arc::new(link), pulse, presence: OnceLock::new() })
    }

    /// Shows other programs that this one is running.
    fn show_presence(&self) -> Result<(), LedgerError> {
        match self.presence.get_or_init(|| DatabasePresence::new(&self.link, self.pulse)) {
            Ok(_) => Ok(()),
            Err(error) => Err(error.clone()),
        }
    }
}

impl CallStore for PostgresStore {
    fn ledger_location(&self) -> LedgerLocation {
        self.link.ledger_location()
    }

    fn find_answer(&self, key: &CallKey, run: &str) -> Result<Option<CallAnswer>, LedgerError> {
        let rows = self.link.query_rows("look for an answer", ANSWER_SQL, &[&key.as_str(), &run])?;
        rows.first().map(|row| read_checked_entry(row, &self.ledger_location()).map(|entry| entry.answer)).transpose()
    }

    fn claim_call(&self, key: &CallKey, from: Option<&str>) -> Result<ClaimState, LedgerError> {
        self.show_presence()?;
        let values: [&(dyn ToSql + Sync); 3] = [&key.as_str(), &self.link.program, &from];
        let read = |row: &wayword_database::postgres::Row| Ok((row.try_get(0)?, row.try_get(1)?));
        match self.link.query_row("claim a call", CLAIM_SQL, &values, read)?.unwrap_or_default() {
            (true, _) => return Ok(ClaimState::Answered),
            (false, false) => return Ok(ClaimState::Others),
            (false, true) => {}
        }
        // The statement may have waited for the one that stored the answer, and did not see it.
        let is_answered =
            self.link.query_row("claim a call", IS_ANSWERED_SQL, &[&key.as_str()], |row| row.try_get(0))?;
        if is_answered == Some(true) {
            self.release_call(key);
            return Ok(ClaimState::Answered);
        }
        Ok(ClaimState::Ours)
    }

    fn release_call(&self, key: &CallKey) {
        self.link.release_claim(key);
    }

    fn claim_holder(&self, key: &CallKey) -> Result<Option<ClaimHolder>, LedgerError> {
        let gone_s = self.pulse.gone.as_secs_f64();
        self.link.query_row("look who makes a call", HOLDER_SQL, &[&key.as_str(), &gone_s], |row| {
            Ok(ClaimHolder { name: row.try_get(0)?, sent: row.try_get(1)?, is_gone: row.try_get(2)? })
        })
    }

    fn write_request(&self, request: &PendingRequest<'_>) -> Result<i64, RequestRefusedError> {
        self.show_presence()?;
        let PendingRequest { limits, most_usd, .. } = *request;
        if limits.max_usd.is_some() && most_usd.is_none() {
            return Err(RequestRefusedError::NoPrice);
        }
        let number = self.link.next_request_number();
        for _ in 0..MAX_RESERVE_TRIES {
            match self.link.reserve_request(number, request)? {
                ReserveOutcome::Yes => return Ok(number),
                // If another request has ended meanwhile, this one may fit after all.
                ReserveOutcome::No => check_limits(limits, self.spent_budget(request.run)?, most_usd)?,
                ReserveOutcome::Again => {}
            }
        }
        let spent = self.spent_budget(request.run)?;
        Err(match (limits.max_usd, limits.max_calls) {
            (None, Some(max_calls)) => RequestRefusedError::MaxCalls { max_calls },
            (max_usd, _) => RequestRefusedError::MaxUsd {
                max_usd: max_usd.unwrap_or(f64::INFINITY),
                spent_usd: spent.usd + spent.reserved_usd,
                next_usd: most_usd.unwrap_or(0.0),
            },
        })
    }

    fn write_end(&self, sent: &SentRequest, end: RequestEnd, reason: &str) {
        self.link.end_request(sent.number, end, reason);
    }

    fn write_answer(&self, sent: Option<&SentRequest>, row: LedgerEntry) -> Result<bool, LedgerError> {
        let (call, answer) = (&row.call, &row.answer);
        let counts = [answer.tokens_in, answer.tokens_out, answer.latency_ms].map(count_to_i64);
        let [tokens_in, tokens_out, latency_ms] = &counts;
        let request = call.request.to_string();
        let answer_json = serde_json::Value::from(answer.text.as_str()).to_string();
        let values: [&(dyn ToSql + Sync); 19] = [
            &row.key.as_str(),
            &call.model,
            &call.base_url,
            &request,
            &i64::from(call.replicate),
            &answer_json,
            &without_nul(&answer.finish),
            tokens_in,
            tokens_out,
            &answer.usd,
            latency_ms,
            &i64::from(answer.attempts),
            &row.at_unix_s,
            &row.run,
            &checksum::answer_checksum(&row.key, answer),
            &self.link.program,
            &sent.map(|sent| sent.number),
            &self.link.slot,
            &answer.usd.map(amount::nanos_rounded_up),
        ];
        Ok(self.link.query_row("store an answer", STORE_ANSWER_SQL, &values, |row| row.try_get(0))?.unwrap_or(false))
    }

    fn flush(&self) -> Result<(), LedgerError> {
        self.link.catch_up()
    }

    fn keeps_budget(&self) -> bool {
        true
    }

    fn shares_rates(&self) -> bool {
        true
    }

    fn next_slot(&self, provider: &str, rates: ProviderRates, tokens: u64) -> Result<Option<SendSlot>, LedgerError> {
        rates::take_turn(&self.link, provider, rates, tokens)
    }
}
