//! Measures the time of BLIP at the base models' size. `WAYWORD_BLIP` names a folder that `fixtures/make_blip.py
//! --full` wrote. Without this variable the benchmark does not run.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark fails by panicking")]

use criterion::{Criterion, criterion_group, criterion_main};
use std::{hint::black_box, path::PathBuf};
use wayword_core::Image;
use wayword_local::{BlipCaptioner, BlipVqa, ModelDevice, WeightPrecision};

/// Six words that the fixtures' tokenizer knows, one token each.
const QUESTION: &str = "what is in the picture ?";

fn picture(seed: u32) -> Image {
    let byte = |at: u32| ((at ^ seed).wrapping_mul(2_654_435_761) >> 24) as u8;
    Image::new(384, 384, (0..384 * 384 * 3).map(byte).collect()).unwrap()
}

fn blip(criterion: &mut Criterion) {
    let Some(folder) = std::env::var_os("WAYWORD_BLIP").map(PathBuf::from) else {
        #[allow(clippy::print_stderr, reason = "a benchmark has no other output")]
        {
            eprintln!("nothing measured: set WAYWORD_BLIP to a folder that fixtures/make_blip.py --full wrote");
        }
        return;
    };
    let mut group = criterion.benchmark_group("blip");
    group.sample_size(10);
    {
        let captioner =
            BlipCaptioner::load("hf/bench/blip", &folder.join("caption"), &ModelDevice::cpu(), WeightPrecision::F32)
                .unwrap();
        let picture = picture(0);
        group.bench_function("vision", |bencher| {
            bencher.iter(|| captioner.picture_states(black_box(&picture)).unwrap());
        });
        group.bench_function("caption of 20 tokens", |bencher| {
            bencher.iter(|| {
                let tokens = captioner.description_tokens(black_box(&picture), "", 20).unwrap();
                assert_eq!(tokens.len(), 20, "the random weights end a caption early; make them with another seed");
            });
        });
    }
    let vqa = BlipVqa::load("hf/bench/blip", &folder.join("vqa"), &ModelDevice::cpu(), WeightPrecision::F32).unwrap();
    let mut seed = 0;
    group.bench_function("answer of 3 tokens, new picture", |bencher| {
        bencher.iter(|| {
            seed += 1;
            vqa.answer_question(black_box(&picture(seed)), QUESTION, 3).unwrap()
        });
    });
    let known = picture(0);
    group.bench_function("answer of 3 tokens, known picture", |bencher| {
        bencher.iter(|| vqa.answer_question(black_box(&known), QUESTION, 3).unwrap());
    });
}

criterion_group!(benches, blip);
criterion_main!(benches);
