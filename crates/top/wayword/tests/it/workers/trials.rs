//! Trials that take long or need root, and are not part of the tests:
//!
//! ```text
//! WAYWORD_TEST_POSTGRES=1 cargo test -p wayword --features queue --test workers -- --ignored --nocapture
//! ```

use super::{by_queue::*, *};
use std::time::{Duration, Instant};

const WORKERS: usize = 8;
const KILLS: usize = 100;
const STOPS: usize = 6;
const LONG: Duration = Duration::from_secs(600);
/// How long a sign of life counts, seconds.
const LEASE_S: u64 = 4;

/// The run of the trial. Its chunks are small, because one that is begun three times in vain is given up.
const BIG: [&str; 6] = ["--paths", "600", "--per-path", "2", "--chunk", "1"];

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status().unwrap();
    assert!(sent.success(), "kill {name}");
}

/// Counts of the blows that workers got.
#[derive(Debug, Default)]
struct Blows {
    kills: usize,
    stops: usize,
    restarts: usize,
}

/// The workers of a run, each with the time at which it goes on, if it is suspended.
struct Crowd<'a> {
    start: &'a dyn Fn() -> Child,
    workers: Vec<(Child, Option<Instant>)>,
}

impl Crowd<'_> {
    /// Whether all have ended by themselves. Workers that were suspended for long enough go on.
    fn look(&mut self) -> bool {
        let mut ended = 0;
        for (child, until) in &mut self.workers {
            if until.is_some_and(|until| until < Instant::now()) {
                signal(child, "-CONT");
                *until = None;
            }
            if let Some(status) = child.try_wait().unwrap() {
                assert_eq!(status.code(), Some(0));
                ended += 1;
            }
        }
        ended == self.workers.len()
    }

    fn kill(&mut self, at: usize) -> bool {
        let (child, until) = &mut self.workers[at];
        if child.try_wait().unwrap().is_some() || until.is_some() {
            return false;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        *child = (self.start)();
        true
    }

    fn suspend(&mut self, at: usize, long: Duration) -> bool {
        let (child, until) = &mut self.workers[at];
        if child.try_wait().unwrap().is_some() || until.is_some() {
            return false;
        }
        signal(child, "-STOP");
        *until = Some(Instant::now() + long);
        true
    }
}

/// Bytes of a row in each table that grows with a run, with its indexes.
fn tell_sizes(url: &str) {
    let mut client = wayword_database::PostgresDatabase::from_name(url, None).unwrap().connect().unwrap();
    for table in ["wayword_ledger.calls", "wayword_ledger.sent", "wayword_ledger.uses", "wayword_queue.chunks"] {
        let sql = format!("SELECT pg_total_relation_size('{table}'), count(*) FROM {table}");
        let row = client.query_one(&sql, &[]).unwrap();
        let [bytes, rows] = [row.get::<_, i64>(0), row.get::<_, i64>(1)];
        eprintln!("{table}: {rows} rows of {} bytes", bytes / rows.max(1));
    }
}

/// Ten minutes of kills, suspensions past the lease, and two restarts of the database.
#[test]
#[ignore = "takes a quarter of an hour"]
fn ten_minutes_of_kills_lose_and_double_no_result() {
    let Some(server) = server("nothing_is_lost_or_double_after_ten_minutes_of_kills") else { return };
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(200), ..cast() };
    let (whole, killed) = (Stage::new(ProviderBehaviour { latency: Duration::ZERO, ..cast() }), Stage::new(behaviour));
    let [alone, together] = [(), ()].map(|()| server.new_database());
    let mut one = BIG.to_vec();
    one.extend(["--queue", &alone]);
    assert_eq!(asking_models(&whole, "one", &one).status().unwrap().code(), Some(0));
    let calls = whole.provider.log().distinct_answered();
    // At this rate the run would take ten minutes, and the blows make it longer.
    let rate = (calls as f64 / LONG.as_secs_f64() * 60.0).round().to_string();
    eprintln!("{calls} calls; at most {rate} a minute");
    tell_sizes(&alone);

    let lease = LEASE_S.to_string();
    let mut flags = BIG.to_vec();
    flags.extend(["--queue", &together, "--lease-s", &lease, "--requests-per-minute", &rate]);
    let start = || asking_models(&killed, "big", &flags).spawn().unwrap();
    let workers = (0..WORKERS).map(|_| (start(), None)).collect();
    let mut crowd = Crowd { start: &start, workers };
    let (begun, mut blows, mut rng) = (Instant::now(), Blows::default(), seeded_rng(5, &["blows"]));
    while !crowd.look() {
        thread::sleep(Duration::from_millis(100));
        let share = begun.elapsed().as_secs_f64() / LONG.as_secs_f64();
        let due = |of: usize| ((share * of as f64) as usize).min(of);
        let at = rng.random_range(0..WORKERS);
        if blows.kills < due(KILLS) {
            blows.kills += usize::from(crowd.kill(at));
        } else if blows.stops < due(STOPS) {
            blows.stops += usize::from(crowd.suspend(at, Duration::from_secs(3 * LEASE_S)));
        } else if blows.restarts < due(3).min(2) {
            server.restart();
            blows.restarts += 1;
        }
    }
    let took_s = begun.elapsed().as_secs_f64();
    // A chunk with three killed workers is given up, and the status lists it.
    let wayword = |args: &[&str]| killed.building.wayword(args).json();
    let opened = wayword(&["runs", "retry", "big", "--reason", "its worker ended each time", "--json"]);
    eprintln!("given up, and opened again: chunks {}", opened["chunks"]);
    assert_eq!(start().wait().unwrap().code(), Some(0));
    let log = killed.provider.log();
    let again = log.answered - log.distinct_answered();
    eprintln!("{blows:?} in {took_s:.0} s: {} calls, {again} paid again", log.answered);
    assert_all_is_done(&killed, "big", &together);
    merge_to_the_same(&whole, &killed);
    assert_eq!(log.distinct_answered(), calls, "nothing is lost");
    // A worker has few calls in flight at that rate.
    assert!(again <= 2 * (blows.kills + blows.stops) as u64, "{again} paid again");
    assert_eq!((blows.kills, blows.stops, blows.restarts), (KILLS, STOPS, 2), "the run was too short");
}

/// A disk that is full ends a worker, and a larger one lets it go on.
#[test]
#[ignore = "needs root, to mount a small file system"]
fn a_full_disk_loses_nothing() {
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(10), ..cast() };
    let (whole, full) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    assert_eq!(with_models(&whole, "one", &["--shard", "0/1"]).status().unwrap().code(), Some(0));
    let bytes: usize = files(&whole.building.path("one")).values().map(Vec::len).sum();
    let big = full.building.path("big");
    fs::create_dir_all(&big).unwrap();
    let mount = |options: String| {
        let done = Command::new("mount").args(["-t", "tmpfs", "-o", &options, "tmpfs"]).arg(&big).status().unwrap();
        assert!(done.success(), "mount {options}");
    };
    // Room for a third, and then for all. A page is the least that a file takes.
    mount(format!("size={}", bytes / 3));
    let worker = || with_models(&full, "big", &["--shard", "0/1", "--lease-s", "0.1"]).output().unwrap();
    let ended = worker();
    let first = full.provider.log().answered;
    mount("remount,size=512m".to_owned());
    let went_on = worker();
    let again = full.provider.log().answered - whole.provider.log().answered;
    let merged = full.building.wayword(&["runs", "merge", "big"]);
    let kept = results(&big);
    assert!(Command::new("umount").arg(&big).status().unwrap().success());

    assert_eq!(ended.status.code(), Some(7), "a full disk is told");
    assert!(first < whole.provider.log().answered && first > 0);
    assert_eq!(went_on.status.code(), Some(0));
    assert_eq!(merged.code, Some(0), "{merged:?}");
    assert_eq!(whole.building.wayword(&["runs", "merge", "one"]).code, Some(0));
    let mut one = results(&whole.building.path("one"));
    let mut kept = kept;
    for files in [&mut one, &mut kept] {
        files.remove(Path::new("config.toml"));
    }
    assert!(kept == one, "the results differ");
    eprintln!("{first} calls before the disk was full, {again} paid again");
    assert!(again <= IN_FLIGHT, "{again} paid again");
}

/// On a network file system (`statfs` is faked to report one), shards need no SQLite and no lock.
#[test]
#[ignore = "needs strace 5.11 or later, which fakes the answers of statfs"]
fn shards_on_a_network_file_system_use_no_lock_and_no_sqlite() {
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(10), ..cast() };
    let (near, far) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    let traced = far.building.path("trace");
    let on_nfs = |command: &Command| {
        let fake = "inject=statfs:poke_exit=@arg2=6969000000000000";
        let mut under = Command::new("strace");
        under.args(["-f", "-qq", "-e", "trace=statfs,flock,fcntl", "-e", fake, "-o"]).arg(&traced);
        under.arg(command.get_program()).args(command.get_args());
        under.current_dir(command.get_current_dir().unwrap()).env(KEY_ENV, KEY);
        under.output().unwrap()
    };
    let refused = on_nfs(&asking_models(&far, "single", &["--paths", "2", "--ledger", "calls.db"]));
    let told = String::from_utf8_lossy(&refused.stderr);
    assert!(!refused.status.success() && told.contains("NFS"), "one machine is told of the network: {told}");

    assert_eq!(with_models(&near, "one", &["--shard", "0/1"]).status().unwrap().code(), Some(0));
    for part in ["0/2", "1/2"] {
        let ran = on_nfs(&with_models(&far, "big", &["--shard", part]));
        assert_eq!(ran.status.code(), Some(0), "{ran:?}");
        let calls = fs::read_to_string(&traced).unwrap();
        let locks = calls
            .lines()
            .filter(|line| line.contains("flock(") || line.contains("F_SETLK") || line.contains("F_OFD_SETLK"));
        assert_eq!(locks.collect::<Vec<_>>(), Vec::<&str>::new());
    }
    merge_to_the_same(&near, &far);
}
