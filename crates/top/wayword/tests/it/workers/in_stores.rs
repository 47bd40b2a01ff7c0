//! Runs and data in object stores. The store is a folder, or the bucket that `WAYWORD_TEST_STORE` names (`trials/scale/objects.sh`).

use super::*;

/// An address of its own.
fn address(building: &Building, name: &str) -> String {
    match std::env::var("WAYWORD_TEST_STORE") {
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
    assert!(wayword(&["runs", "merge", &run]).refused().contains("--out"));
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
    // The temporary folder of a command is removed at its end.
    let scratch = building.path("scratch");
    fs::create_dir(&scratch).unwrap();
    let ran = crate::common::run(building.command(&["runs", "status", &run]).env("TMPDIR", &scratch));
    assert_eq!((ran.code, fs::read_dir(&scratch).unwrap().count()), (Some(0), 0));
}

/// Gives a chunk's mark in a store that is a folder a failure, as if an item had failed. `None` if the store is not a folder.
fn failed(run: &str) -> Option<()> {
    let mark = Path::new(run.strip_prefix("file://")?).join("chunks/000001.done");
    let text = fs::read_to_string(&mark).unwrap();
    fs::write(&mark, text.replace("\"seconds\"", "\"failed\":{\"timed out\":1},\"seconds\"")).unwrap();
    Some(())
}

#[test]
fn a_chunk_that_is_opened_again_in_a_store_is_made_again() {
    let building = Building::new();
    let run = format!("file://{}", building.path("store/again").display());
    assert_eq!(worker(&building, &run, "0/1").code, Some(0));
    let wayword = |args: &[&str]| building.wayword(args);
    failed(&run).unwrap();
    assert_eq!(wayword(&["runs", "merge", &run, "--to", "merged"]).code, Some(3));
    let opened = wayword(&["runs", "retry", &run, "--reason", "timed", "--json"]).json();
    assert_eq!(opened["chunks"], serde_json::json!([1]));
    assert!(wayword(&["runs", "merge", &run, "--to", "merged"]).refused().contains("not finished"));
    assert!(worker(&building, &run, "0/1").out.contains("this worker made 1 chunk "));
    // The folder gets the files that the store has now.
    assert_eq!(wayword(&["runs", "merge", &run, "--to", "merged"]).code, Some(0));

    // A folder with another run is left alone.
    assert_eq!(building.generate("single", &RUN[..4]).code, Some(0));
    assert!(wayword(&["runs", "merge", &run, "--to", "single"]).refused().contains("one machine"));
    let mut other = RUN.to_vec();
    other.extend(["--seed", "9", "--shard", "0/1"]);
    assert_eq!(building.generate("other", &other).code, Some(0));
    let plan = fs::read(building.path("other/plan.json")).unwrap();
    for _ in 0..2 {
        assert!(wayword(&["runs", "merge", &run, "--to", "other"]).refused().contains("another run"));
    }
    assert!(fs::read(building.path("other/plan.json")).unwrap() == plan);
    let nothing = format!("file://{}", building.path("store/nothing").display());
    assert!(wayword(&["runs", "merge", &nothing, "--to", "merged"]).refused().contains("no plan"));
}

#[cfg(feature = "queue")]
#[test]
fn workers_of_a_queue_that_are_killed_lose_nothing_in_a_store() {
    let Some(server) = by_queue::server("workers_of_a_queue_that_are_killed_lose_nothing_in_a_store") else { return };
    let behaviour = ProviderBehaviour { latency: Duration::from_millis(10), ..cast() };
    let (whole, killed) = (Stage::new(behaviour.clone()), Stage::new(behaviour));
    let [alone, together] = [(), ()].map(|()| server.new_database());
    assert_eq!(with_models(&whole, "one", &["--queue", &alone]).status().unwrap().code(), Some(0));
    let run = address(&killed.building, "killed");
    // Shards cannot keep the calls of models there. The error suggests a queue.
    let refused = with_models(&killed, &run, &["--shard", "0/1"]).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(refused.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--queue DATABASE"), "{refused:?}");
    assert_eq!(killed.provider.log().received, 0, "nothing is asked");
    let queue = flags(&["--queue", &together, "--lease-s", "1"]);
    let start = |part: &[String]| with_models(&killed, &run, &borrowed(part)).spawn().unwrap();
    kill_and_go_on(&[queue.clone(), queue], 4, start);
    by_queue::assert_all_is_done(&killed, &run, &together);
    let wayword = |args: &[&str]| killed.building.wayword(args);
    assert!(wayword(&["runs", "status", &run]).refused().contains("--queue"), "a store names no server");
    assert_eq!(wayword(&["runs", "merge", &run, "--to", "big"]).code, Some(0));
    merge_to_the_same(&whole, &killed);

    // A chunk that is opened again gets a mark of its own.
    let epoch = |mark: &str| serde_json::from_str::<serde_json::Value>(mark).unwrap()["epoch"].as_i64().unwrap();
    let mark = || fs::read_to_string(killed.building.path("big/chunks/000001.done")).unwrap();
    let before = epoch(&mark());
    let mut table = wayword_database::PostgresDatabase::from_name(&together, None).unwrap().connect().unwrap();
    let failed = "UPDATE wayword_queue.chunks SET state = 'dead', reason = 'timed out' WHERE chunk = 1";
    assert_eq!(table.execute(failed, &[]).unwrap(), 1);
    let retry = ["runs", "retry", &run, "--queue", &together, "--reason", "timed", "--json"];
    assert_eq!(wayword(&retry).json()["chunks"], serde_json::json!([1]));
    assert_eq!(with_models(&killed, &run, &["--queue", &together]).status().unwrap().code(), Some(0));
    assert_eq!(wayword(&["runs", "merge", &run, "--to", "big"]).code, Some(0));
    assert!(epoch(&mark()) > before);
    merge_to_the_same(&whole, &killed);
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
        crate::common::run(command.env("XDG_CACHE_HOME", &cache).env("HOME", &cache))
    };
    let near = from("data", "near");
    assert_eq!(near.code, Some(0), "{near:?}");
    let far = from(&address, "far");
    assert_eq!(far.code, Some(0), "{far:?}");
    let texts = |out: &str| fs::read(building.path(out).join("instructions.jsonl")).unwrap();
    assert_eq!(texts("near"), texts("far"));
    // The second time no file is fetched.
    let data = fs::read_dir(cache.join("wayword/data")).unwrap().next().unwrap().unwrap().path();
    let is_data = |name: &PathBuf| name.extension().is_some_and(|end| end == "house");
    let file = files(&data).into_keys().find(is_data).unwrap();
    let fetched = data.join(file);
    let written = fs::metadata(&fetched).unwrap().modified().unwrap();
    assert_eq!(from(&address, "again").code, Some(0));
    assert_eq!(fs::metadata(&fetched).unwrap().modified().unwrap(), written);
    let nothing = from(&format!("file://{}", building.path("nothing").display()), "none");
    assert!(nothing.refused().contains("no data there") && !building.path("nothing").exists(), "{nothing:?}");
}
