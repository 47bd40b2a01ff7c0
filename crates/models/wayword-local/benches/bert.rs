//! Measures the time of a sentence encoder of MiniLM's size, with random weights or the weights in the folder
//! `WAYWORD_MINILM`.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark fails by panicking")]

use candle_core::{Device as On, Tensor};
use criterion::{Criterion, criterion_group, criterion_main};
use std::{collections::HashMap, hint::black_box, path::Path};
use wayword_local::{ModelDevice, SentenceEncoder, WeightPrecision};

const SIZE: usize = 384;
const INNER: usize = 1536;
const VOCABULARY: usize = 30522;

/// Writes random weights with a configuration and a tokenizer.
fn random_model(folder: &Path) {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/bert");
    let config = serde_json::json!({
        "model_type": "bert", "vocab_size": VOCABULARY, "hidden_size": SIZE, "num_hidden_layers": 6,
        "num_attention_heads": 12, "intermediate_size": INNER, "hidden_act": "gelu", "max_position_embeddings": 512,
    });
    std::fs::write(folder.join("config.json"), config.to_string()).unwrap();
    std::fs::copy(fixture.join("tokenizer.json"), folder.join("tokenizer.json")).unwrap();
    let mut tensors = HashMap::new();
    let mut add = |name: String, shape: &[usize]| {
        tensors.insert(name, Tensor::randn(0_f32, 0.05, shape, &On::Cpu).unwrap());
    };
    for (table, count) in [("word", VOCABULARY), ("position", 512), ("token_type", 2)] {
        add(format!("embeddings.{table}_embeddings.weight"), &[count, SIZE]);
    }
    let mut layer = |name: String, inputs: usize, outputs: usize| {
        add(format!("{name}.weight"), if inputs == 0 { vec![outputs] } else { vec![outputs, inputs] }.as_slice());
        add(format!("{name}.bias"), &[outputs]);
    };
    layer("embeddings.LayerNorm".to_owned(), 0, SIZE);
    for at in 0..6 {
        let name = |part: &str| format!("encoder.layer.{at}.{part}");
        for part in ["attention.self.query", "attention.self.key", "attention.self.value", "attention.output.dense"] {
            layer(name(part), SIZE, SIZE);
        }
        layer(name("attention.output.LayerNorm"), 0, SIZE);
        layer(name("intermediate.dense"), SIZE, INNER);
        layer(name("output.dense"), INNER, SIZE);
        layer(name("output.LayerNorm"), 0, SIZE);
    }
    candle_core::safetensors::save(&tensors, folder.join("model.safetensors")).unwrap();
}

fn encode(criterion: &mut Criterion) {
    let made = tempfile::tempdir().unwrap();
    let folder = match std::env::var_os("WAYWORD_MINILM") {
        Some(folder) => folder.into(),
        None => {
            random_model(made.path());
            made.path().to_owned()
        }
    };
    let encoder = SentenceEncoder::load("hf/bench/minilm", &folder, &ModelDevice::cpu(), WeightPrecision::F32).unwrap();
    let text = |at: usize| {
        format!(
            "Go past the table and stop at the sink. Walk up the stairs to the bedroom, turn right and wait by the \
             kitchen door {at}"
        )
    };
    let texts: Vec<String> = (0..32).map(text).collect();
    let texts: Vec<&str> = texts.iter().map(|text| &text[..]).collect();
    for count in [1, 32] {
        criterion.bench_function(&format!("minilm batch {count}"), |bencher| {
            bencher.iter(|| encoder.unit_vectors(black_box(&texts[..count])).unwrap());
        });
    }
}

criterion_group!(benches, encode);
criterion_main!(benches);
