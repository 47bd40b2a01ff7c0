//! The queries of the store in a database: lists, sums and removal of calls.

use super::{
    PostgresStore, amount,
    rows::{columns, read_checked_entry},
};
use crate::{
    CostGrouping, CostLine, LedgerEntry, LedgerError, LedgerFilter, RunSpending,
    budget::SpentBudget,
    ledger::now_unix_s,
    store::{CallOrder, CallQueries},
};
use wayword_database::postgres::{self, types::ToSql};

/// How many rows one query fetches. The next query goes on after the last of them.
const PAGE_ROWS: i64 = 500;
/// How many rows one statement drops. It is repeated until none is left, so that no statement runs into its time limit.
const MAX_DROPPED_ROWS: i64 = 5000;

/// The conditions of a filter: model (`$1`), run (`$2`), and time (`$3`). Those that are NULL do not restrict.
macro_rules! filtered {
    () => {
        " FROM wayword_ledger.calls WHERE ($1::text IS NULL OR model = $1)
          AND ($2::text IS NULL OR calls.key IN (SELECT u.key FROM wayword_ledger.uses AS u WHERE u.run = $2))
          AND ($3::bigint IS NULL OR at < $3)"
    };
}

/// A page of `$5` calls in the order of their keys, after key `$4`.
const BY_KEY_SQL: &str = concat!(
    "SELECT ",
    columns!(),
    filtered!(),
    " AND ($4::text IS NULL OR calls.key > $4) ORDER BY calls.key LIMIT $5"
);

/// A page of `$5` calls, the latest first, after the call of time `$6` and key `$4`.
const LATEST_SQL: &str = concat!(
    "SELECT ",
    columns!(),
    filtered!(),
    " AND ($6::bigint IS NULL OR at < $6 OR (at = $6 AND calls.key > $4)) ORDER BY at DESC, calls.key LIMIT $5"
);

/// Drops at most `$4` calls of a filter, with the notes of which runs used them.
const PRUNE_SQL: &str = concat!(
    "WITH dropped AS (DELETE FROM wayword_ledger.calls WHERE key IN (SELECT calls.key",
    filtered!(),
    " ORDER BY calls.key LIMIT $4) RETURNING key),
     swept AS (DELETE FROM wayword_ledger.uses AS u USING dropped WHERE u.key = dropped.key)
     SELECT count(*) FROM dropped"
);

/// Drops one call.
const DROP_SQL: &str = "
WITH swept AS (DELETE FROM wayword_ledger.uses WHERE key = $1)
DELETE FROM wayword_ledger.calls WHERE key = $1";

/// Sums of costs, grouped by an expression of SQL.
macro_rules! costs {
    ($group:literal) => {
        concat!(
            "SELECT ",
            $group,
            ", count(*), least(coalesce(sum(tokens_in), 0), 9223372036854775807)::bigint,
             least(coalesce(sum(tokens_out), 0), 9223372036854775807)::bigint, coalesce(sum(usd), 0),
             count(*) FILTER (WHERE usd IS NULL) FROM wayword_ledger.calls GROUP BY 1 ORDER BY 1"
        )
    };
}

/// The reserved and the spent amount of a run (billionths of a dollar), and its requests.
const SPENT_SQL: &str = "
SELECT r.reserved - coalesce(sum(s.released), 0)::bigint, coalesce(sum(s.spent), 0)::bigint,
    r.calls - coalesce(sum(s.cancelled), 0)::bigint
FROM wayword_ledger.runs AS r LEFT JOIN wayword_ledger.settled AS s ON s.run = r.run
WHERE r.run = $1 GROUP BY r.reserved, r.calls";

/// The columns of a [`RunSpending`], in the order of its fields.
const SPENDING_SQL: &str = "
SELECT count(*), count(*) FILTER (WHERE outcome = 'answered'),
    count(*) FILTER (WHERE outcome IS NULL OR outcome = 'lost'), coalesce(sum(usd), 0),
    coalesce(sum(most) FILTER (WHERE outcome IS NULL OR outcome = 'lost'), 0)::bigint
FROM wayword_ledger.sent WHERE run = $1 AND outcome IS DISTINCT FROM 'cancelled'";

/// How many requests have no known answer.
const LOST_SQL: &str = "SELECT count(*) FROM wayword_ledger.sent WHERE outcome IS NULL OR outcome = 'lost'";

/// The values of a filter's conditions.
struct FilterValues<'a> {
    model: Option<&'a str>,
    run: Option<&'a str>,
    /// Only calls that were answered before this time, seconds since 1970.
    before: Option<i64>,
}

impl<'a> FilterValues<'a> {
    fn from_filter(filter: &'a LedgerFilter) -> Self {
        let before = filter.older_than_s.map(|age_s| now_unix_s().saturating_sub_unsigned(age_s));
        Self { model: filter.model.as_deref(), run: filter.run.as_deref(), before }
    }

    fn as_sql_values(&self) -> [&(dyn ToSql + Sync); 3] {
        [&self.model, &self.run, &self.before]
    }
}

impl CallQueries for PostgresStore {
    fn for_each_call(
        &self,
        filter: &LedgerFilter,
        order: CallOrder,
        take: &mut dyn FnMut(LedgerEntry) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        let values = FilterValues::from_filter(filter);
        let limit = filter.limit.filter(|_| order == CallOrder::Latest);
        let mut remaining = limit.map_or(i64::MAX, |limit| i64::try_from(limit).unwrap_or(i64::MAX));
        let (mut key, mut at) = (None::<String>, None::<i64>);
        while remaining > 0 {
            let page = remaining.min(PAGE_ROWS);
            let [model, run, before] = values.as_sql_values();
            let rows = match order {
                CallOrder::Key => self.link.query_rows("list calls", BY_KEY_SQL, &[model, run, before, &key, &page])?,
                CallOrder::Latest => {
                    self.link.query_rows("list calls", LATEST_SQL, &[model, run, before, &key, &page, &at])?
                }
            };
            let is_last = (rows.len() as i64) < page;
            remaining -= rows.len() as i64;
            for row in &rows {
                let row = read_checked_entry(row, &self.link.ledger_location())?;
                (key, at) = (Some(row.key.to_string()), Some(row.at_unix_s));
                take(row)?;
            }
            if is_last {
                break;
            }
        }
        Ok(())
    }

    fn prune_calls(&self, filter: &LedgerFilter) -> Result<usize, LedgerError> {
        let values = FilterValues::from_filter(filter);
        let [model, run, before] = values.as_sql_values();
        let mut all = 0;
        loop {
            let values = [model, run, before, &MAX_DROPPED_ROWS];
            let dropped =
                self.link.query_row("drop calls", PRUNE_SQL, &values, |row| count_column(row, 0))?.unwrap_or(0);
            all += usize::try_from(dropped).unwrap_or(0);
            if dropped == 0 {
                return Ok(all);
            }
        }
    }

    fn prune_changed(&self) -> Result<usize, LedgerError> {
        let (mut changed, mut after) = (Vec::<String>::new(), None::<String>);
        let all = LedgerFilter::default();
        let values = FilterValues::from_filter(&all);
        loop {
            let [model, run, before] = values.as_sql_values();
            let rows = self.link.query_rows("list calls", BY_KEY_SQL, &[model, run, before, &after, &PAGE_ROWS])?;
            for row in &rows {
                after = row.try_get(0).ok();
                match read_checked_entry(row, &self.link.ledger_location()) {
                    Err(LedgerError::Changed { .. }) => changed.extend(after.clone()),
                    other => drop(other?),
                }
            }
            if (rows.len() as i64) < PAGE_ROWS {
                break;
            }
        }
        for key in &changed {
            self.link.query_rows("drop a call", DROP_SQL, &[key])?;
        }
        Ok(changed.len())
    }

    fn sum_costs(&self, by: CostGrouping) -> Result<Vec<CostLine>, LedgerError> {
        let sql = match by {
            CostGrouping::Model => costs!("model"),
            CostGrouping::Run => costs!("run"),
            CostGrouping::Day => costs!("to_char(to_timestamp(at) AT TIME ZONE 'UTC', 'YYYY-MM-DD')"),
        };
        let line = |row: &postgres::Row| {
            Ok(CostLine {
                of: row.try_get(0)?,
                calls: count_column(row, 1)?,
                tokens_in: count_column(row, 2)?,
                tokens_out: count_column(row, 3)?,
                usd: row.try_get(4)?,
                without_price: count_column(row, 5)?,
            })
        };
        let lines = self.link.pool.with_connection("sum up costs", |connection| {
            connection.query_rows(sql, &[])?.iter().map(line).collect::<Result<Vec<_>, postgres::Error>>()
        });
        Ok(lines?)
    }

    fn has_answers_from(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        let sql = "SELECT 1 FROM wayword_ledger.calls WHERE model = $1 AND base_url = $2 LIMIT 1";
        Ok(!self.link.query_rows("look for a model's answers", sql, &[&model, &base_url])?.is_empty())
    }

    fn count_lost_requests(&self) -> Result<u64, LedgerError> {
        self.link.catch_up()?;
        Ok(self.link.query_row("count lost requests", LOST_SQL, &[], |row| count_column(row, 0))?.unwrap_or(0))
    }

    fn spent_budget(&self, run: &str) -> Result<SpentBudget, LedgerError> {
        self.link.catch_up()?;
        let spent = |row: &postgres::Row| {
            Ok(SpentBudget {
                reserved_usd: amount::usd_from_nanos(row.try_get(0)?),
                usd: amount::usd_from_nanos(row.try_get(1)?),
                calls: count_column(row, 2)?,
            })
        };
        Ok(self.link.query_row("sum up what a run has spent", SPENT_SQL, &[&run], spent)?.unwrap_or_default())
    }

    fn run_spending(&self, run: &str) -> Result<RunSpending, LedgerError> {
        self.link.catch_up()?;
        let spending = |row: &postgres::Row| {
            Ok(RunSpending {
                requests: count_column(row, 0)?,
                answered: count_column(row, 1)?,
                lost: count_column(row, 2)?,
                usd: row.try_get(3)?,
                maybe_usd: amount::usd_from_nanos(row.try_get(4)?),
            })
        };
        Ok(self.link.query_row("sum up what a run has spent", SPENDING_SQL, &[&run], spending)?.unwrap_or_default())
    }
}

/// A column of a row as a count.
fn count_column(row: &postgres::Row, at: usize) -> Result<u64, postgres::Error> {
    row.try_get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0))
}
