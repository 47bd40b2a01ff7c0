//! The queries of the store in a file: lists, sums and removal of calls.

use super::{
    Sqlite,
    schema::{COLUMNS, sound},
};
use crate::{
    By, CostLine, Filter, LedgerError, Row, Spending,
    budget::Spent,
    ledger::now_unix_s,
    store::{Order, Queries},
};
use rusqlite::{ToSql, params, params_from_iter};

/// Removes the uses of dropped calls, and makes the file smaller.
const SWEEP: &str = "DELETE FROM uses WHERE key NOT IN (SELECT key FROM calls); VACUUM";

/// A filter as SQL.
struct Where {
    sql: String,
    values: Vec<Box<dyn ToSql>>,
}

impl Where {
    fn of(filter: &Filter) -> Self {
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

fn order(filter: &Filter, order: Order) -> String {
    let limit = || filter.limit.map_or(String::new(), |limit| format!(" LIMIT {limit}"));
    match order {
        Order::Key => " ORDER BY calls.key".to_owned(),
        Order::Latest => format!(" ORDER BY at DESC, calls.key{}", limit()),
    }
}

impl Queries for Sqlite {
    fn each(
        &self,
        filter: &Filter,
        by: Order,
        take: &mut dyn FnMut(Row) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let Where { sql, values } = Where::of(filter);
        let order = order(filter, by);
        self.writer.flush()?;
        let reader = self.reader();
        let mut statement = reader.prepare(&format!("SELECT {COLUMNS} FROM calls{sql}{order}")).map_err(&failed)?;
        let mut rows = statement.query(params_from_iter(values)).map_err(&failed)?;
        while let Some(next) = rows.next().map_err(&failed)? {
            take(sound(next, &self.path)?)?;
        }
        Ok(())
    }

    fn prune(&self, filter: &Filter) -> Result<usize, LedgerError> {
        let failed = LedgerError::store(&self.path, "prune");
        let Where { sql, values } = Where::of(filter);
        let connection = self.reader();
        let dropped =
            connection.execute(&format!("DELETE FROM calls{sql}"), params_from_iter(values)).map_err(&failed)?;
        connection.execute_batch(SWEEP).map_err(&failed)?;
        Ok(dropped)
    }

    fn prune_changed(&self) -> Result<usize, LedgerError> {
        let failed = LedgerError::store(&self.path, "prune");
        let connection = self.reader();
        let mut changed: Vec<rusqlite::types::Value> = Vec::new();
        let mut statement = connection.prepare(&format!("SELECT {COLUMNS} FROM calls")).map_err(&failed)?;
        let mut rows = statement.query([]).map_err(&failed)?;
        while let Some(row) = rows.next().map_err(&failed)? {
            match sound(row, &self.path) {
                Err(LedgerError::Changed { .. }) => changed.push(row.get(0).map_err(&failed)?),
                other => drop(other?),
            }
        }
        drop(rows);
        drop(statement);
        for key in &changed {
            connection.execute("DELETE FROM calls WHERE key = ?1", [key]).map_err(&failed)?;
        }
        connection.execute_batch(SWEEP).map_err(&failed)?;
        Ok(changed.len())
    }

    fn has_answers_of(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let reader = self.reader();
        let sql = "SELECT 1 FROM calls WHERE model = ?1 AND base_url = ?2 LIMIT 1";
        let mut statement = reader.prepare(sql).map_err(&failed)?;
        statement.exists([model, base_url]).map_err(&failed)
    }

    fn costs(&self, by: By) -> Result<Vec<CostLine>, LedgerError> {
        let failed = LedgerError::store(&self.path, "read");
        let of = match by {
            By::Model => "model",
            By::Run => "run",
            By::Day => "date(at, 'unixepoch')",
        };
        // SUM fails when integers overflow; TOTAL and CAST stop at the largest integer.
        let tokens = "CAST(TOTAL(tokens_in) AS INTEGER), CAST(TOTAL(tokens_out) AS INTEGER)";
        let sql =
            format!("SELECT {of}, COUNT(*), {tokens}, TOTAL(usd), SUM(usd IS NULL) FROM calls GROUP BY 1 ORDER BY 1");
        let reader = self.reader();
        let mut statement = reader.prepare(&sql).map_err(&failed)?;
        let lines = statement.query_map([], |row| {
            Ok(CostLine {
                of: row.get(0)?,
                calls: count(row, 1)?,
                tokens_in: count(row, 2)?,
                tokens_out: count(row, 3)?,
                usd: row.get(4)?,
                without_price: count(row, 5)?,
            })
        });
        lines.and_then(Iterator::collect).map_err(&failed)
    }

    fn lost(&self) -> Result<u64, LedgerError> {
        self.writer.flush()?;
        let sql = "SELECT COUNT(*) FROM sent WHERE outcome IS NULL OR outcome = 'lost'";
        let lost = self.reader().query_row(sql, [], |row| count(row, 0));
        lost.map_err(LedgerError::store(&self.path, "read"))
    }

    fn spent(&self, run: &str) -> Result<Spent, LedgerError> {
        self.writer.flush()?;
        let sql = "SELECT TOTAL(CASE WHEN outcome = 'answered' THEN COALESCE(usd, most_usd)
                                     WHEN outcome IS NULL OR outcome = 'lost' THEN most_usd END),
                   COUNT(*) FROM sent WHERE run = ?1 AND outcome IS NOT 'cancelled'";
        let spent = |row: &rusqlite::Row<'_>| Ok(Spent { usd: row.get(0)?, reserved_usd: 0.0, calls: count(row, 1)? });
        self.reader().query_row(sql, params![run], spent).map_err(LedgerError::store(&self.path, "read"))
    }

    fn spending(&self, run: &str) -> Result<Spending, LedgerError> {
        self.writer.flush()?;
        let sql = "SELECT COUNT(*), TOTAL(outcome IS 'answered'), TOTAL(outcome IS NULL OR outcome = 'lost'),
                   TOTAL(usd), TOTAL(CASE WHEN outcome IS NULL OR outcome = 'lost' THEN most_usd END)
                   FROM sent WHERE run = ?1 AND outcome IS NOT 'cancelled'";
        let spending = |row: &rusqlite::Row<'_>| {
            // TOTAL gives a number with a point.
            let whole = |at: usize| row.get::<_, f64>(at).map(|count| count as u64);
            Ok(Spending {
                requests: count(row, 0)?,
                answered: whole(1)?,
                lost: whole(2)?,
                usd: row.get(3)?,
                maybe_usd: row.get(4)?,
            })
        };
        self.reader().query_row(sql, params![run], spending).map_err(LedgerError::store(&self.path, "read"))
    }
}

fn count(row: &rusqlite::Row<'_>, at: usize) -> rusqlite::Result<u64> {
    row.get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0))
}
