//! The queries of the store in a file: lists, sums and removal of calls.

use super::{
    SqliteStore,
    schema::{CALL_COLUMNS, read_checked_entry},
};
use crate::{
    CostGrouping, CostLine, LedgerEntry, LedgerError, LedgerFilter, RunSpending,
    budget::SpentBudget,
    ledger::now_unix_s,
    store::{CallOrder, CallQueries},
};
use rusqlite::{ToSql, params, params_from_iter};

/// Removes the uses of dropped calls, and makes the file smaller.
const SWEEP_SQL: &str = "DELETE FROM uses WHERE key NOT IN (SELECT key FROM calls); VACUUM";

/// A filter as SQL: its conditions, with a number such as `?1` for each value.
struct FilterSql {
    sql: String,
    values: Vec<Box<dyn ToSql>>,
}

impl FilterSql {
    fn from_filter(filter: &LedgerFilter) -> Self {
        let (mut sql, mut values) = (String::from(" WHERE TRUE"), Vec::<Box<dyn ToSql>>::new());
        let mut and = |condition: &str, value: Box<dyn ToSql>| {
            values.push(value);
            sql.push_str(&format!(" AND {}", condition.replace('?', &format!("?{}", values.len()))));
        };
        if let Some(model) = &filter.model {
            and("model = ?", Box::new(model.clone()));
        }
        if let Some(run) = &filter.run {
            and("calls.key IN (SELECT key FROM uses WHERE run = ?)", Box::new(run.clone()));
        }
        if let Some(age_s) = filter.older_than_s {
            and("at < ?", Box::new(now_unix_s().saturating_sub_unsigned(age_s)));
        }
        Self { sql, values }
    }
}

/// The order of the calls, and how many, as SQL.
fn order_sql(filter: &LedgerFilter, order: CallOrder) -> String {
    let limit = || filter.limit.map_or(String::new(), |limit| format!(" LIMIT {limit}"));
    match order {
        CallOrder::Key => " ORDER BY calls.key".to_owned(),
        CallOrder::Latest => format!(" ORDER BY at DESC, calls.key{}", limit()),
    }
}

impl CallQueries for SqliteStore {
    fn for_each_call(
        &self,
        filter: &LedgerFilter,
        by: CallOrder,
        take: &mut dyn FnMut(LedgerEntry) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        let failed = LedgerError::store_error(&self.path, "read");
        let FilterSql { sql, values } = FilterSql::from_filter(filter);
        let order = order_sql(filter, by);
        self.writer.flush()?;
        let reader = self.lock_reader();
        let mut statement =
            reader.prepare(&format!("SELECT {CALL_COLUMNS} FROM calls{sql}{order}")).map_err(&failed)?;
        let mut rows = statement.query(params_from_iter(values)).map_err(&failed)?;
        while let Some(next) = rows.next().map_err(&failed)? {
            take(read_checked_entry(next, &self.path)?)?;
        }
        Ok(())
    }

    fn prune_calls(&self, filter: &LedgerFilter) -> Result<usize, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "prune");
        let FilterSql { sql, values } = FilterSql::from_filter(filter);
        let connection = self.lock_reader();
        let dropped =
            connection.execute(&format!("DELETE FROM calls{sql}"), params_from_iter(values)).map_err(&failed)?;
        connection.execute_batch(SWEEP_SQL).map_err(&failed)?;
        Ok(dropped)
    }

    fn prune_changed(&self) -> Result<usize, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "prune");
        let connection = self.lock_reader();
        let mut changed: Vec<rusqlite::types::Value> = Vec::new();
        let mut statement = connection.prepare(&format!("SELECT {CALL_COLUMNS} FROM calls")).map_err(&failed)?;
        let mut rows = statement.query([]).map_err(&failed)?;
        while let Some(row) = rows.next().map_err(&failed)? {
            match read_checked_entry(row, &self.path) {
                Err(LedgerError::Changed { .. }) => changed.push(row.get(0).map_err(&failed)?),
                other => drop(other?),
            }
        }
        drop(rows);
        drop(statement);
        for key in &changed {
            connection.execute("DELETE FROM calls WHERE key = ?1", [key]).map_err(&failed)?;
        }
        connection.execute_batch(SWEEP_SQL).map_err(&failed)?;
        Ok(changed.len())
    }

    fn has_answers_from(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "read");
        let reader = self.lock_reader();
        let sql = "SELECT 1 FROM calls WHERE model = ?1 AND base_url = ?2 LIMIT 1";
        let mut statement = reader.prepare(sql).map_err(&failed)?;
        statement.exists([model, base_url]).map_err(&failed)
    }

    fn sum_costs(&self, by: CostGrouping) -> Result<Vec<CostLine>, LedgerError> {
        let failed = LedgerError::store_error(&self.path, "read");
        let group = match by {
            CostGrouping::Model => "model",
            CostGrouping::Run => "run",
            CostGrouping::Day => "date(at, 'unixepoch')",
        };
        // SUM fails when integers overflow; TOTAL and CAST stop at the largest integer.
        let tokens = "CAST(TOTAL(tokens_in) AS INTEGER), CAST(TOTAL(tokens_out) AS INTEGER)";
        let sql = format!(
            "SELECT {group}, COUNT(*), {tokens}, TOTAL(usd), SUM(usd IS NULL) FROM calls GROUP BY 1 ORDER BY 1"
        );
        let reader = self.lock_reader();
        let mut statement = reader.prepare(&sql).map_err(&failed)?;
        let lines = statement.query_map([], |row| {
            Ok(CostLine {
                of: row.get(0)?,
                calls: count_column(row, 1)?,
                tokens_in: count_column(row, 2)?,
                tokens_out: count_column(row, 3)?,
                usd: row.get(4)?,
                without_price: count_column(row, 5)?,
            })
        });
        lines.and_then(Iterator::collect).map_err(&failed)
    }

    fn count_lost_requests(&self) -> Result<u64, LedgerError> {
        self.writer.flush()?;
        let sql = "SELECT COUNT(*) FROM sent WHERE outcome IS NULL OR outcome = 'lost'";
        let lost = self.lock_reader().query_row(sql, [], |row| count_column(row, 0));
        lost.map_err(LedgerError::store_error(&self.path, "read"))
    }

    fn spent_budget(&self, run: &str) -> Result<SpentBudget, LedgerError> {
        self.writer.flush()?;
        let sql = "SELECT TOTAL(CASE WHEN outcome = 'answered' THEN COALESCE(usd, most_usd)
                                     WHEN outcome IS NULL OR outcome = 'lost' THEN most_usd END),
                   COUNT(*) FROM sent WHERE run = ?1 AND outcome IS NOT 'cancelled'";
        let spent = |row: &rusqlite::Row<'_>| {
            Ok(SpentBudget { usd: row.get(0)?, reserved_usd: 0.0, calls: count_column(row, 1)? })
        };
        self.lock_reader().query_row(sql, params![run], spent).map_err(LedgerError::store_error(&self.path, "read"))
    }

    fn run_spending(&self, run: &str) -> Result<RunSpending, LedgerError> {
        self.writer.flush()?;
        let sql = "SELECT COUNT(*), TOTAL(outcome IS 'answered'), TOTAL(outcome IS NULL OR outcome = 'lost'),
                   TOTAL(usd), TOTAL(CASE WHEN outcome IS NULL OR outcome = 'lost' THEN most_usd END)
                   FROM sent WHERE run = ?1 AND outcome IS NOT 'cancelled'";
        let spending = |row: &rusqlite::Row<'_>| {
            // TOTAL gives a floating-point number.
            let whole = |at: usize| row.get::<_, f64>(at).map(|count| count as u64);
            Ok(RunSpending {
                requests: count_column(row, 0)?,
                answered: whole(1)?,
                lost: whole(2)?,
                usd: row.get(3)?,
                maybe_usd: row.get(4)?,
            })
        };
        self.lock_reader().query_row(sql, params![run], spending).map_err(LedgerError::store_error(&self.path, "read"))
    }
}

/// A column of a row as a count.
fn count_column(row: &rusqlite::Row<'_>, at: usize) -> rusqlite::Result<u64> {
    row.get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0))
}
