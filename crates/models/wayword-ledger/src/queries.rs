//! Lists, exports, summarises and drops the calls of a ledger.

use crate::{
    LedgerError,
    call::Row,
    ledger::{Ledger, now_unix_s},
    store::{COLUMNS, sound},
};
use rusqlite::{ToSql, params_from_iter};
use serde::Serialize;
use std::{io::Write, path::Path};

/// Which calls to list, export or drop.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Filter {
    /// Only calls of this model.
    pub model: Option<String>,
    /// Only calls that this run has used.
    pub run: Option<String>,
    /// Only calls whose answer is older than this, seconds.
    pub older_than_s: Option<u64>,
    /// At most this many, the latest ones. [`Ledger::list`] alone uses this.
    pub limit: Option<usize>,
}

/// How costs are grouped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// By model.
    Model,
    /// By the run that paid.
    Run,
    /// By day, UTC.
    Day,
}

/// The cost of a model, a run or a day.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CostLine {
    /// The model, the run or the day.
    pub of: String,
    /// Calls that were answered.
    pub calls: u64,
    /// Tokens of requests.
    pub tokens_in: u64,
    /// Tokens of answers.
    pub tokens_out: u64,
    /// US dollars, of the calls whose price was known.
    pub usd: f64,
    /// Calls whose price was not known.
    pub without_price: u64,
}

/// Removes the uses of dropped calls, and makes the file smaller.
const SWEEP: &str = "DELETE FROM uses WHERE key NOT IN (SELECT key FROM calls); VACUUM";

/// A filter as SQL.
struct Where {
    sql: String,
    values: Vec<Box<dyn ToSql>>,
}

impl Filter {
    fn to_sql(&self) -> Where {
        let (mut sql, mut values) = (String::from(" WHERE TRUE"), Vec::<Box<dyn ToSql>>::new());
        let mut and = |condition: &str, value: Box<dyn ToSql>| {
            values.push(value);
            sql.push_str(&format!(" AND {}", condition.replace('?', &format!("?{}", values.len()))));
        };
        if let Some(model) = &self.model {
            and("model = ?", Box::new(model.clone()));
        }
        if let Some(run) = &self.run {
            and("calls.key IN (SELECT key FROM uses WHERE run = ?)", Box::new(run.clone()));
        }
        if let Some(age_s) = self.older_than_s {
            and("at < ?", Box::new(now_unix_s().saturating_sub_unsigned(age_s)));
        }
        Where { sql, values }
    }
}

impl Ledger {
    /// Lists calls, the latest first.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn list(&self, filter: &Filter) -> Result<Vec<Row>, LedgerError> {
        let limit = filter.limit.map_or(String::new(), |limit| format!(" LIMIT {limit}"));
        let mut rows = Vec::new();
        self.each(filter, &format!(" ORDER BY at DESC, calls.key{limit}"), |row| {
            rows.push(row);
            Ok(())
        })?;
        Ok(rows)
    }

    /// Writes calls as JSON lines, in the order of their keys. Returns how many.
    ///
    /// # Errors
    /// When the ledger cannot be read or the lines cannot be written.
    pub fn export(&self, filter: &Filter, mut out: impl Write) -> Result<usize, LedgerError> {
        let failed = LedgerError::io(self.path(), "export");
        let mut count = 0;
        self.each(filter, " ORDER BY calls.key", |row| {
            let mut line = serde_json::to_vec(&row).map_err(|error| failed(error.into()))?;
            line.push(b'\n');
            count += 1;
            out.write_all(&line).map_err(&failed)
        })?;
        Ok(count)
    }

    /// Writes calls to a file, as [`Ledger::export`] does. The file is complete or does not exist.
    ///
    /// # Errors
    /// When the ledger cannot be read or the file cannot be written.
    pub fn export_to(&self, filter: &Filter, path: &Path) -> Result<usize, LedgerError> {
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(".new");
        let unfinished = path.with_file_name(name);
        let failed = LedgerError::io(&unfinished, "write");
        let mut file = std::io::BufWriter::new(std::fs::File::create(&unfinished).map_err(&failed)?);
        let count = self.export(filter, &mut file)?;
        let file = file.into_inner().map_err(|error| failed(error.into_error()))?;
        file.sync_all().map_err(&failed)?;
        std::fs::rename(&unfinished, path).map_err(LedgerError::io(path, "write"))?;
        Ok(count)
    }

    /// Drops calls, and returns how many. The ledger keeps what runs have spent.
    ///
    /// # Errors
    /// When the ledger cannot be written.
    pub fn prune(&self, filter: &Filter) -> Result<usize, LedgerError> {
        let failed = LedgerError::store(self.path(), "prune");
        let Where { sql, values } = filter.to_sql();
        let connection = self.store().reader();
        let dropped =
            connection.execute(&format!("DELETE FROM calls{sql}"), params_from_iter(values)).map_err(&failed)?;
        connection.execute_batch(SWEEP).map_err(&failed)?;
        Ok(dropped)
    }

    /// Whether the ledger has any answer of a model at an address.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn has_answers_of(&self, model: &str, base_url: &str) -> Result<bool, LedgerError> {
        let failed = LedgerError::store(self.path(), "read");
        let reader = self.store().reader();
        let sql = "SELECT 1 FROM calls WHERE model = ?1 AND base_url = ?2 LIMIT 1";
        let mut statement = reader.prepare(sql).map_err(&failed)?;
        statement.exists([model, base_url]).map_err(&failed)
    }

    /// Drops the answers that were changed after they were written, and returns how many. The ledger keeps what runs
    /// have spent.
    ///
    /// # Errors
    /// When the ledger cannot be read or written.
    pub fn prune_changed(&self) -> Result<usize, LedgerError> {
        let failed = LedgerError::store(self.path(), "prune");
        let connection = self.store().reader();
        let mut changed: Vec<rusqlite::types::Value> = Vec::new();
        let mut statement = connection.prepare(&format!("SELECT {COLUMNS} FROM calls")).map_err(&failed)?;
        let mut rows = statement.query([]).map_err(&failed)?;
        while let Some(row) = rows.next().map_err(&failed)? {
            match sound(row, self.path()) {
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

    /// What calls have cost, by model, run or day.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn costs(&self, by: By) -> Result<Vec<CostLine>, LedgerError> {
        let failed = LedgerError::store(self.path(), "read");
        let of = match by {
            By::Model => "model",
            By::Run => "run",
            By::Day => "date(at, 'unixepoch')",
        };
        // SUM fails when integers overflow; TOTAL and CAST stop at the largest integer.
        let tokens = "CAST(TOTAL(tokens_in) AS INTEGER), CAST(TOTAL(tokens_out) AS INTEGER)";
        let sql =
            format!("SELECT {of}, COUNT(*), {tokens}, TOTAL(usd), SUM(usd IS NULL) FROM calls GROUP BY 1 ORDER BY 1");
        let reader = self.store().reader();
        let mut statement = reader.prepare(&sql).map_err(&failed)?;
        let lines = statement.query_map([], |row| {
            let count = |at: usize| row.get::<_, i64>(at).map(|count| u64::try_from(count).unwrap_or(0));
            Ok(CostLine {
                of: row.get(0)?,
                calls: count(1)?,
                tokens_in: count(2)?,
                tokens_out: count(3)?,
                usd: row.get(4)?,
                without_price: count(5)?,
            })
        });
        lines.and_then(Iterator::collect).map_err(&failed)
    }

    /// How many requests were sent without a known answer. They may have been paid for.
    ///
    /// # Errors
    /// When the ledger cannot be read.
    pub fn lost(&self) -> Result<u64, LedgerError> {
        self.store().writer.flush()?;
        let sql = "SELECT COUNT(*) FROM sent WHERE outcome IS NULL OR outcome = 'lost'";
        let lost = self.store().reader().query_row(sql, [], |row| row.get::<_, i64>(0));
        lost.map(|lost| u64::try_from(lost).unwrap_or(0)).map_err(LedgerError::store(self.path(), "read"))
    }

    fn each(
        &self,
        filter: &Filter,
        order: &str,
        mut take: impl FnMut(Row) -> Result<(), LedgerError>,
    ) -> Result<(), LedgerError> {
        let failed = LedgerError::store(self.path(), "read");
        let Where { sql, values } = filter.to_sql();
        self.store().writer.flush()?;
        let reader = self.store().reader();
        let mut statement = reader.prepare(&format!("SELECT {COLUMNS} FROM calls{sql}{order}")).map_err(&failed)?;
        let mut rows = statement.query(params_from_iter(values)).map_err(&failed)?;
        while let Some(next) = rows.next().map_err(&failed)? {
            take(sound(next, self.path())?)?;
        }
        Ok(())
    }
}
