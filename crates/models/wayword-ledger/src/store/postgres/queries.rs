//! The queries of the store in a database: lists, sums and removal of calls.

use super::{
    Postgres, amount,
    rows::{columns, sound},
};
use crate::{
    By, CostLine, Filter, LedgerError, Row, Spending,
    budget::Spent,
    ledger::now_unix_s,
    store::{Order, Queries},
};
use wayword_database::postgres::{self, types::ToSql};

/// How many rows are fetched, or dropped, at a time.
const PAGE: i64 = 500;
const MOST_DROPPED: i64 = 5000;

/// The conditions of a filter: model, run, and time.
macro_rules! filtered {
    () => {
        " FROM wayword_ledger.calls WHERE ($1::text IS NULL OR model = $1)
          AND ($2::text IS NULL OR calls.key IN (SELECT u.key FROM wayword_ledger.uses AS u WHERE u.run = $2))
          AND ($3::bigint IS NULL OR at < $3)"
    };
}

const BY_KEY: &str = concat!(
    "SELECT ",
    columns!(),
    filtered!(),
    " AND ($4::text IS NULL OR calls.key > $4) ORDER BY calls.key LIMIT $5"
);

const LATEST: &str = concat!(
    "SELECT ",
    columns!(),
    filtered!(),
    " AND ($6::bigint IS NULL OR at < $6 OR (at = $6 AND calls.key > $4)) ORDER BY at DESC, calls.key LIMIT $5"
);

const PRUNE: &str = concat!(
    "WITH dropped AS (DELETE FROM wayword_ledger.calls WHERE key IN (SELECT calls.key",
    filtered!(),
    " ORDER BY calls.key LIMIT $4) RETURNING key),
     swept AS (DELETE FROM wayword_ledger.uses AS u USING dropped WHERE u.key = dropped.key)
     SELECT count(*) FROM dropped"
);

const DROP: &str = "
WITH swept AS (DELETE FROM wayword_ledger.uses WHERE key = $1)
DELETE FROM wayword_ledger.calls WHERE key = $1";

macro_rules! costs {
    ($of:literal) => {
        concat!(
            "SELECT ",
            $of,
            ", count(*), least(coalesce(sum(tokens_in), 0), 9223372036854775807)::bigint,
             least(coalesce(sum(tokens_out), 0), 9223372036854775807)::bigint, coalesce(sum(usd), 0),
             count(*) FILTER (WHERE usd IS NULL) FROM wayword_ledger.calls GROUP BY 1 ORDER BY 1"
        )
    };
}

const SPENT: &str = "
SELECT r.reserved - coalesce(sum(s.released), 0)::bigint, coalesce(sum(s.spent), 0)::bigint,
    r.calls - coalesce(sum(s.cancelled), 0)::bigint
FROM wayword_ledger.runs AS r LEFT JOIN wayword_ledger.settled AS s ON s.run = r.run
WHERE r.run = $1 GROUP BY r.reserved, r.calls";

const SPENDING: &str = "
SELECT count(*), count(*) FILTER (WHERE outcome = 'answered'),
    count(*) FILTER (WHERE outcome IS NULL OR outcome = 'lost'), coalesce(sum(usd), 0),
    coalesce(sum(most) FILTER (WHERE outcome IS NULL OR outcome = 'lost'), 0)::bigint
FROM wayword_ledger.sent WHERE run = $1 AND outcome IS DISTINCT FROM 'cancelled'";

const LOST: &str = "SELECT count(*) FROM wayword_ledger.sent WHERE outcome IS NULL OR outcome = 'lost'";

/// The values of a filter's conditions.
struct Values<'a> {
    model: Option<&'a str>,
    run: Option<&'a str>,
    before: Option<i64>,
}

impl<'a> Values<'a> {
    fn of(filter: &'a Filter) -> Self {
        let before = filter.older_than_s.map(|age_s| now_unix_s().saturating_sub_unsigned(age_s));
        Self { model: filter.model.as_deref(), run: filter.run.as_deref(), before }
    }

    fn all(&self) -> [&(dyn ToSql + Sync); 3] {
        [&self.model, &self.run, &self.before]
    }
}

impl Queries for Postgres {
    fn each(
        &self,
        filter: &Filter,
        order: Order,
        take: &mut dyn FnMut(Row) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        let values = Values::of(filter);
        let limit = filter.limit.filter(|_| order == Order::Latest);
        let mut left = limit.map_or(i64::MAX, |limit| i64::try_from(limit).unwrap_or(i64::MAX));
        let (mut key, mut at) = (None::<String>, None::<i64>);
        while left > 0 {
            let page = left.min(PAGE);
            let [model, run, before] = values.all();
            let rows = match order {
                Order::Key => self.link.rows("list calls", BY_KEY, &[model, run, before, &key, &page])?,
                Order::Latest => self.link.rows("list calls", LATEST, &[model, run, before, &key, &page, &at])?,
            };
            let is_last = (rows.len() as i64) < page;
            left -= rows.len() as i64;
            for row in &rows {
                let row = sound(row, &self.link.place())?;
                (key, at) = (Some(row.key.to_string()), Some(row.at_unix_s));
                take(row)?;
            }
            if is_last {
                break;
            }
        }
        Ok(())
    }

    fn prune(&self, filter: &Filter) -> Result<usize, LedgerError> {
        let values = Values::of(filter);
        let [model, run, before] = values.all();
        let mut all = 0;
        loop {
            let values = [model, run, before, &MOST_DROPPED];
            let dropped = self.link.row("drop calls", PRUNE, &values, |row| count(row, 0))?.unwrap_or(0);
            all += usize::try_from(dropped).unwrap_or(0);
            if dropped == 0 {
                return Ok(all);
            }
        }
    }

    fn prune_changed(&self) -> Result<usize, LedgerError> {
        let (mut changed, mut after) = (Vec::<String>::new(), None::<String>);
        let all = Filter::default();
        let values = Values::of(&all);
        loop {
            let [model, run, before] = values.all();
            let rows = self.link.rows("list calls", BY_KEY, &[model, run, before, &after, &PAGE])?;
            for row in &rows {
                after = row.try_get(0).ok();
                match sound(row, &self.link.place()) {
                    Err(LedgerError::Changed { .. }) => changed.extend(after.clone()),
                    other => drop(other?),
                }
            }
            if (rows.len() as i64) < PAGE {
                break;
            }
        }
        for key in &changed {
            self.link.rows("drop a call", DROP, &[key])?;
        }
        Ok(changed.len())
    }

    fn costs(&self, by: By) -> Result<Vec<CostLine>, LedgerError> {
        let sql = match by {
            By::Model => costs!("model"),
            By::Run => costs!("run"),
            By::Day => costs!("to_char(to_timestamp(at) AT TIME ZONE 'UTC', 'YYYY-MM-DD')"),
        };
        let line = |row: &postgres::Row| {
            Ok(CostLine {
                of: row.try_get(0)?,
                calls: count(row, 1)?,
                tokens_in: count(row, 2)?,
                tokens_out: count(row, 3)?,
                usd: row.try_get(4)?,
                without_price: count(row, 5)?,
            })
        };
        let lines = self.link.pool.with("sum up costs", |connection| {
            connection.rows(sql, &[])?.iter().map(line).collect::<Result<Vec<_>, postgres::Error>>()
        });
        Ok(lines?)
    }

    fn has_answers_of(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        let sql = "SELECT 1 FROM wayword_ledger.calls WHERE model = $1 AND base_url = $2 LIMIT 1";
        Ok(!self.link.rows("look for a model's answers", sql, &[&model, &base_url])?.is_empty())
    }

    fn lost(&self) -> Result<u64, LedgerError> {
        self.link.catch_up()?;
        Ok(self.link.row("count lost requests", LOST, &[], |row| count(row, 0))?.unwrap_or(0))
    }

    fn spent(&self, run: &str) -> Result<Spent, LedgerError> {
        self.link.catch_up()?;
        let spent = |row: &postgres::Row| {
            Ok(Spent {
                reserved_usd: amount::usd(row.try_get(0)?),
                usd: amount::usd(row.try_get(1)?),
                calls: count(row, 2)?,
            })
        };
        Ok(self.link.row("sum up what a run has spent", SPENT, &[&run], spent)?.unwrap_or_default())
    }

    fn spending(&self, run: &str) -> Result<Spending, LedgerError> {
        self.link.catch_up()?;
        let spending = |row: &postgres::Row| {
            Ok(Spending {
                requests: count(row, 0)?,
                answered: count(row, 1)?,
                lost: count(row, 2)?,
                usd: row.try_get(3)?,
                maybe_usd: amount::usd(row.try_get(4)?),
            })
        };
        Ok(self.link.row("sum up what a run has spent", SPENDING, &[&run], spending)?.unwrap_or_default())
    }
}

fn count(row: &postgres::Row, at: usize) -> Result<u64, postgres::Error> {
    row.try_get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0))
}
