//! Items per second of whole runs, from path to checked instructions on the disk: with labels alone, and in a generated house
//! with drawn pictures.

#![allow(clippy::expect_used, missing_docs, reason = "a benchmark may fail")]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use std::time::Duration;
use wayword_run::{
    generate::{RunSummary, generate_into},
    output::CommandOutput,
    settings::{AskedPlatform, AskedSettings, Draw, Walks},
};

/// A run into a new folder; the default is both styles.
fn run(asked: AskedSettings) -> RunSummary {
    let folder = tempfile::tempdir().expect("a folder for the run");
    let job = asked.into_job().expect("settings that make sense");
    generate_into(folder.path(), &job, &CommandOutput::new(true, true)).expect("the run succeeds")
}

fn labels(criterion: &mut Criterion) {
    let data = tempfile::tempdir().expect("a folder for the building");
    wayword_testkit::write_building(data.path()).expect("the building is written");
    let asked = |episodes: Option<&str>, paths: Option<usize>| AskedSettings {
        platform: AskedPlatform {
            platform: Some("matterport".into()),
            data: Some(data.path().to_owned()),
            ..AskedPlatform::default()
        },
        walks: Walks {
            episodes: episodes.map(|file| data.path().join(file)),
            paths,
            hops: Some("3..7".into()),
            ..Walks::default()
        },
        ..AskedSettings::default()
    };
    let mut group = criterion.benchmark_group("run on labels, both styles");
    group.sample_size(10).measurement_time(Duration::from_secs(10));
    group.throughput(Throughput::Elements(10));
    group.bench_function("10 episodes", |bencher| {
        let asked = || asked(Some("reverie/REVERIE_val_seen.json"), None);
        bencher.iter_batched(asked, run, BatchSize::PerIteration);
    });
    group.throughput(Throughput::Elements(500));
    group.bench_function("500 random paths", |bencher| {
        bencher.iter_batched(|| asked(None, Some(500)), run, BatchSize::PerIteration);
    });
    group.finish();
}

fn house(criterion: &mut Criterion) {
    let asked = || AskedSettings {
        walks: Walks { paths: Some(1), scan: Some(vec!["house2-3".into()]), ..Walks::default() },
        draw: Draw { seed: Some(3), ..Draw::default() },
        ..AskedSettings::default()
    };
    let mut group = criterion.benchmark_group("run in a house, both styles");
    group.sample_size(10).measurement_time(Duration::from_secs(30));
    group.throughput(Throughput::Elements(1));
    group.bench_function("1 path with its pictures, house built anew", |bencher| {
        bencher.iter_batched(asked, run, BatchSize::PerIteration);
    });
    group.finish();
}

criterion_group!(benches, labels, house);
criterion_main!(benches);
