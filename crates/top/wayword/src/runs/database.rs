//! `wayword runs database`: makes the tables that workers share in a database, or prints their SQL.

use crate::runs::args::RunsDatabase;
use wayword_run::{
    error::{Error, Exit},
    output::Output,
};

#[cfg(feature = "queue")]
pub fn run(args: &RunsDatabase, output: &Output) -> Result<Exit, Error> {
    use wayword_database::{Database, Pool, prepare};
    let database = Database::named(&args.database, args.password_env.as_deref())?;
    let tables = [wayword_queue::TABLES, wayword_ledger::TABLES];
    let sql: String = tables.iter().map(|tables| tables.sql(args.role.as_deref())).collect();
    if args.sql {
        output.data(&serde_json::json!({ "sql": sql }), &sql);
        return Ok(Exit::Done);
    }
    let pool = Pool::new(database, 1);
    for tables in &tables {
        prepare(&pool, tables)?;
    }
    if let Some(role) = &args.role {
        let grants: String = tables.iter().map(|tables| tables.granted(role)).collect();
        pool.with("give the role its rights", |connection| connection.client().batch_execute(&grants))?;
    }
    let told = serde_json::json!({ "database": pool.database().shown(), "role": args.role });
    output.data(&told, format_args!("{}: the tables are there", pool.database().shown()));
    Ok(Exit::Done)
}

#[cfg(not(feature = "queue"))]
pub fn run(_: &RunsDatabase, _: &Output) -> Result<Exit, Error> {
    Err(Error::not_built("no database can be used: this build has no way to one"))
}
