//! `wayword runs database`: makes the tables that workers share in a database, or prints their SQL.

use crate::runs::args::RunsDatabase;
use wayword_run::{
    error::{CommandError, Exit},
    output::CommandOutput,
};

#[cfg(feature = "queue")]
pub(super) fn run_database(args: &RunsDatabase, output: &CommandOutput) -> Result<Exit, CommandError> {
    use wayword_database::{ConnectionPool, PostgresDatabase, prepare_tables};
    let database = PostgresDatabase::from_name(&args.database, args.password_env.as_deref())?;
    let tables = [wayword_queue::QUEUE_TABLES, wayword_ledger::LEDGER_TABLES];
    let sql: String = tables.iter().map(|tables| tables.creation_sql(args.role.as_deref())).collect();
    if args.sql {
        output.print_result(&serde_json::json!({ "sql": sql }), &sql);
        return Ok(Exit::Done);
    }
    let pool = ConnectionPool::new(database, 1);
    for tables in &tables {
        prepare_tables(&pool, tables)?;
    }
    if let Some(role) = &args.role {
        let grants: String = tables.iter().map(|tables| tables.grants_sql(role)).collect();
        pool.with_connection("give the role its rights", |connection| connection.client().batch_execute(&grants))?;
    }
    let result = serde_json::json!({ "database": pool.database().shown_name(), "role": args.role });
    output.print_result(&result, format_args!("{}: the tables are there", pool.database().shown_name()));
    Ok(Exit::Done)
}

#[cfg(not(feature = "queue"))]
pub(super) fn run_database(_: &RunsDatabase, _: &CommandOutput) -> Result<Exit, CommandError> {
    Err(CommandError::not_built("no database can be used: this build has no way to one"))
}
