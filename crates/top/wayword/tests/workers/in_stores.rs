//! Runs and data in object stores. The store is a folder, or the bucket that `WAYWORD_TEST_S3` names (`trials/scale/objects.sh`).

use super::*;

/// An address of its own.
fn address(building: &Building, name: &str) -> String {
    match std::env::var("WAYWORD_TEST_S3") {
        Ok(bucket) => format!("{bucket}/{}/{name}", std::process::id()),
        Err(_) => format!("file://{}", building.path(&format!("store/{name}")).display()),
    }
}

#[test]
fn workers_send_what_they_make_and_it_is_merged_as_one_machine_makes_it() {
    let building = Building::new();
    assert_eq!(building.generate("one", &RUN[..4]).code, Some(0));
    let run = address(&building, "big");
    let wayword = |args: &[&str]| building.wayword(args);
    let refused = building.generate(&run, &RUN[..4]);
    assert!(refused.refused().contains("a run of one machine"), "{refused:?}");
    let first = worker(&building, &run, "0/2");
    assert_eq!(first.code, Some(0), "{first:?}");
    assert!(first.out.contains(&run), "the place is told as it was named: {first:?}");
    let status = wayword(&["runs", "status", &run, "--json"]).json();
    assert_eq!(status["run"], run.as_str());
    assert!(status["open"].as_u64() > Some(0) && status["done"].as_u64() > Some(0), "{status}");
    let mut other = RUN.to_vec();
    other.extend(["--shard", "1/2", "--repairs", "1"]);
    assert!(building.generate(&run, &other).refused().contains("these differ: repairs"));
    assert!(wayword(&["runs", "merge", &run]).refused().contains("--to"));
    assert!(wayword(&["runs", "merge", &run, "--to", "early"]).refused().contains("not finished"));

    assert_eq!(worker(&building, &run, "1/2").code, Some(0));
    let again = worker(&building, &run, "0/2");
    assert!(again.out.contains("this worker made 0 chunks"), "{again:?}");
    for to in ["merged", "merged", "early"] {
        let merged = wayword(&["runs", "merge", &run, "--to", to]);
        assert_eq!(merged.code, Some(0), "{merged:?}");
        assert!(results(&building.path(to)) == results(&building.path("one")), "the bytes differ");
    }
    assert_eq!(wayword(&["report", "--run", "merged"]).code, Some(0));
    // What a command needs for itself is gone with it.
    let scratch = building.path("scratch");
    fs::create_dir(&scratch).unwrap();
    let ran = common::run(building.command(&["runs", "status", &run]).env("TMPDIR", &scratch));
    assert_eq!((ran.code, fs::read_dir(&scratch).unwrap().count()), (Some(0), 0));
}

#[cfg(feature = "queue")]
#[test]
fn workers_of_a_queue_that_are_killed_lose_nothing_in_a_store() {
    let Some(server) = by_queue::server("workers_of_a_queue_that_are_killed_lose_nothing_in_a_store") else { return };
    let behaviour = Behaviour { latency: Duration::from_millis(10), ..cast() };
    let (whole, killed) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    let [alone, together] = [(), ()].map(|()| server.new_database());
    assert_eq!(with_models(&whole, "one", &["--queue", &alone]).status().unwrap().code(), Some(0));
    let run = address(&killed.building, "killed");
    let queue = flags(&["--queue", &together, "--lease-s", "1"]);
    let start = |part: &[String]| with_models(&killed, &run, &borrowed(part)).spawn().unwrap();
    kill_and_go_on(&[queue.clone(), queue], 4, start);
    by_queue::assert_all_is_done(&killed, &run);
    let merged = killed.building.wayword(&["runs", "merge", &run, "--to", "big"]);
    assert_eq!(merged.code, Some(0), "{merged:?}");
    merge_to_the_same(&whole, &killed);
}

#[test]
fn shards_with_models_are_refused_in_a_store_and_a_queue_is_not() {
    let stage = Stage::new(cast());
    let run = address(&stage.building, "models");
    let refused = with_models(&stage, &run, &["--shard", "0/1"]).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--queue DATABASE"), "{refused:?}");
    assert_eq!(stage.provider.log().received, 0, "nothing is asked");
}

#[test]
fn data_is_fetched_from_a_store_once() {
    let building = Building::new();
    // Where the store is a bucket, the folder is one all the same.
    let address = format!("file://{}", building.path("data").display());
    let cache = building.path("cache");
    let episodes = ["--episodes", EPISODES, "--style", "r2r"];
    let from = |data: &str, out: &str| {
        let mut args = vec!["generate", "--platform", "matterport", "--data", data, "--out", out];
        args.extend(episodes);
        let mut command = building.command(&args);
        common::run(command.env("XDG_CACHE_HOME", &cache).env("HOME", &cache))
    };
    let near = from("data", "near");
    assert_eq!(near.code, Some(0), "{near:?}");
    let far = from(&address, "far");
    assert_eq!(far.code, Some(0), "{far:?}");
    let texts = |out: &str| fs::read(building.path(out).join("instructions.jsonl")).unwrap();
    assert_eq!(texts("near"), texts("far"));
    assert!(cache.join("wayword/data").exists());
    let nothing = from("file:///nowhere/at/all", "none");
    assert_eq!(nothing.code, Some(1), "{nothing:?}");
}
