//! Time of an OWLv2 in the folder `WAYWORD_OWL` (`fixtures/make_owl.py --true`), from decoded picture to boxes, or of the
//! tiny fixture.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use criterion::{Criterion, criterion_group, criterion_main};
use std::{hint::black_box, path::Path, time::Duration};
use wayword_core::Image;
use wayword_local::{Device, Owl, Precision};

/// A picture that differs by `number`, so that nothing of it was kept.
fn picture(number: u32) -> Image {
    Image::new(640, 480, (0..640 * 480 * 3).map(|at| (at * 7 % 251 + number % 5) as u8).collect()).unwrap()
}

fn detect(criterion: &mut Criterion) {
    let folder = match std::env::var_os("WAYWORD_OWL") {
        Some(folder) => folder.into(),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/owl"),
    };
    let load = || Owl::load("hf/bench/owl", &folder, &Device::cpu(), Precision::F32).unwrap();
    let mut group = criterion.benchmark_group("owl");
    group.sample_size(10).warm_up_time(Duration::from_millis(1));
    for count in [1, 20] {
        let phrases: Vec<String> = (b'a'..).take(count).map(|letter| char::from(letter).to_string()).collect();
        let phrases: Vec<&str> = phrases.iter().map(String::as_str).collect();
        // Each time another picture, and a model that has seen no text.
        group.bench_function(format!("480 x 640, {count} phrases"), |bencher| {
            let mut number = 0;
            let shown = || {
                number += 1;
                (load(), picture(number))
            };
            let find = |(owl, shown): (Owl, Image)| owl.find(black_box(&shown), &phrases).unwrap();
            bencher.iter_batched(shown, find, criterion::BatchSize::PerIteration);
        });
    }
    group.finish();
}

criterion_group!(benches, detect);
criterion_main!(benches);
