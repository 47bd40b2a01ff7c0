//! Workers that share a queue and a ledger in PostgreSQL.

use super::*;
use std::sync::Arc;
use wayword_testkit::PostgresServer;

/// A PostgreSQL server, if `WAYWORD_TEST_POSTGRES` asks for one.
pub(super) fn server(test: &str) -> Option<Arc<PostgresServer>> {
    if std::env::var_os("WAYWORD_TEST_POSTGRES").is_none() {
        eprintln!("skipped: {test} needs WAYWORD_TEST_POSTGRES=1 and PostgreSQL's programs");
        return None;
    }
    Some(PostgresServer::shared().unwrap_or_else(|| panic!("{test}: PostgreSQL's initdb and pg_ctl are not installed")))
}

/// Asserts that a run has no open chunk and none that was given up.
pub(super) fn assert_all_is_done(stage: &Stage, out: &str, queue: &str) {
    let status = stage.building.wayword(&["runs", "status", out, "--queue", queue, "--json"]).json();
    assert_eq!((&status["open"], &status["running"], &status["dead"]), (&0.into(), &0.into(), &serde_json::json!({})));
}

#[test]
fn workers_of_a_queue_that_are_killed_make_what_one_makes_and_share_their_calls() {
    let Some(server) = server("workers_of_a_queue_that_are_killed_make_what_one_makes_and_share_their_calls") else {
        return;
    };
    let kills = 4;
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(10), ..cast() };
    let (whole, killed) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    let [alone, together] = [(), ()].map(|()| server.new_database());
    assert_eq!(with_models(&whole, "one", &["--queue", &alone]).status().unwrap().code(), Some(0));
    let queue = flags(&["--queue", &together, "--lease-s", "1"]);
    let start = |part: &[String]| with_models(&killed, "big", &borrowed(part)).spawn().unwrap();
    kill_and_go_on(&[queue.clone(), queue.clone(), queue], kills, start);
    assert_all_is_done(&killed, "big", &together);
    merge_to_the_same(&whole, &killed);
    let log = killed.provider.log();
    assert_eq!(log.distinct_answered(), whole.provider.log().distinct_answered());
    assert_eq!(whole.provider.log().answered, whole.provider.log().distinct_answered(), "nothing is asked twice");
    let again = log.answered - log.distinct_answered();
    eprintln!("{} calls, {again} paid again after {kills} kills", log.answered);
    assert!(again <= kills as u64 * IN_FLIGHT);
    holds_no_key(&killed.building.path("big"));
}
