//! The tables of a ledger in a database.

use wayword_database::SchemaTables;

/// The tables of a ledger.
pub const LEDGER_TABLES: SchemaTables =
    SchemaTables { schema: "wayword_ledger", steps: &[CREATE_TABLES_SQL], grants: GRANT_SQL };

/// `calls`, `uses`, `sent` and `claims` are as in a file. `answer` is a string of JSON, because a text of PostgreSQL
/// cannot hold the character 0. Money is in whole billionths of a dollar, so that sums are exact.
///
/// `runs` has the sum of all reservations for the requests of a run. Every request changes this row, so no other statement does.
/// `settled` has the amounts that were released or spent: a run has a few rows there, and each program changes one of them, so that
/// programs do not wait for each other. The most that a run may have cost is `reserved - released + spent`.
///
/// `presence` has the last sign of life of each program, and `rates` the times at which the next request and the next token to a
/// provider are due.
const CREATE_TABLES_SQL: &str = "
CREATE TABLE wayword_ledger.calls (
    key TEXT COLLATE \"C\" PRIMARY KEY, model TEXT NOT NULL, base_url TEXT NOT NULL, request TEXT NOT NULL,
    replicate BIGINT NOT NULL, answer TEXT NOT NULL, finish TEXT NOT NULL, tokens_in BIGINT NOT NULL,
    tokens_out BIGINT NOT NULL, usd DOUBLE PRECISION, latency_ms BIGINT NOT NULL, attempts BIGINT NOT NULL,
    at BIGINT NOT NULL, run TEXT NOT NULL, checksum TEXT NOT NULL
);
CREATE INDEX calls_at ON wayword_ledger.calls (at DESC, key);
CREATE TABLE wayword_ledger.uses (run TEXT NOT NULL, key TEXT COLLATE \"C\" NOT NULL, PRIMARY KEY (run, key));
CREATE TABLE wayword_ledger.sent (
    program TEXT NOT NULL, number BIGINT NOT NULL, run TEXT NOT NULL, key TEXT COLLATE \"C\" NOT NULL, most BIGINT,
    usd DOUBLE PRECISION, at BIGINT NOT NULL, outcome TEXT, reason TEXT, PRIMARY KEY (program, number)
) WITH (fillfactor = 80);
CREATE INDEX sent_of_run ON wayword_ledger.sent (run);
CREATE INDEX sent_of_key ON wayword_ledger.sent (key);
CREATE TABLE wayword_ledger.claims (key TEXT COLLATE \"C\" PRIMARY KEY, holder TEXT NOT NULL);
CREATE TABLE wayword_ledger.runs (
    run TEXT PRIMARY KEY, reserved BIGINT NOT NULL DEFAULT 0, calls BIGINT NOT NULL DEFAULT 0
) WITH (fillfactor = 10);
CREATE TABLE wayword_ledger.settled (
    run TEXT NOT NULL, slot SMALLINT NOT NULL, released BIGINT NOT NULL, spent BIGINT NOT NULL,
    cancelled BIGINT NOT NULL, PRIMARY KEY (run, slot)
) WITH (fillfactor = 10);
CREATE TABLE wayword_ledger.presence (program TEXT PRIMARY KEY, beat TIMESTAMPTZ NOT NULL) WITH (fillfactor = 50);
CREATE TABLE wayword_ledger.rates (
    provider TEXT PRIMARY KEY, requests TIMESTAMPTZ NOT NULL, tokens TIMESTAMPTZ NOT NULL
) WITH (fillfactor = 10);
";

const GRANT_SQL: &str = "
GRANT USAGE ON SCHEMA wayword_ledger TO ROLE;
GRANT SELECT ON wayword_ledger.version TO ROLE;
GRANT SELECT, INSERT, UPDATE, DELETE ON wayword_ledger.calls, wayword_ledger.uses, wayword_ledger.sent,
    wayword_ledger.claims, wayword_ledger.runs, wayword_ledger.settled, wayword_ledger.presence, wayword_ledger.rates
    TO ROLE;
";
