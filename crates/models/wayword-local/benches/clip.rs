//! Measures the time of a CLIP of ViT-B/32's size with random weights, or of the model in the folder `WAYWORD_CLIP`.

#![allow(clippy::unwrap_used, missing_docs, reason = "a benchmark may fail")]

use candle_core::{Device as On, Tensor};
use criterion::{Criterion, criterion_group, criterion_main};
use std::{collections::HashMap, hint::black_box, path::Path};
use wayword_core::Image;
use wayword_local::{ClipModel, ModelDevice, WeightPrecision};

/// Writes random weights with a configuration and a tokenizer.
fn random_model(folder: &Path) {
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/clip");
    std::fs::write(folder.join("config.json"), r#"{"model_type": "clip"}"#).unwrap();
    std::fs::write(folder.join("preprocessor_config.json"), "{}").unwrap();
    std::fs::copy(fixture.join("tokenizer.json"), folder.join("tokenizer.json")).unwrap();
    let mut tensors = HashMap::new();
    let mut add = |name: String, shape: &[usize]| {
        tensors.insert(name, Tensor::randn(0_f32, 0.03, shape, &On::Cpu).unwrap());
    };
    add("vision_model.embeddings.class_embedding".to_owned(), &[768]);
    add("vision_model.embeddings.patch_embedding.weight".to_owned(), &[768, 3, 32, 32]);
    add("vision_model.embeddings.position_embedding.weight".to_owned(), &[50, 768]);
    add("text_model.embeddings.token_embedding.weight".to_owned(), &[49408, 512]);
    add("text_model.embeddings.position_embedding.weight".to_owned(), &[77, 512]);
    add("visual_projection.weight".to_owned(), &[512, 768]);
    add("text_projection.weight".to_owned(), &[512, 512]);
    let mut layer = |name: String, inputs: Option<usize>, outputs: usize| {
        let shape: Vec<usize> = [outputs].into_iter().chain(inputs).collect();
        add(format!("{name}.weight"), &shape);
        add(format!("{name}.bias"), &[outputs]);
    };
    layer("vision_model.pre_layrnorm".to_owned(), None, 768);
    layer("vision_model.post_layernorm".to_owned(), None, 768);
    layer("text_model.final_layer_norm".to_owned(), None, 512);
    for (tower, size) in [("vision_model", 768), ("text_model", 512)] {
        for at in 0..12 {
            let name = |part: &str| format!("{tower}.encoder.layers.{at}.{part}");
            for part in ["q_proj", "k_proj", "v_proj", "out_proj"] {
                layer(name(&format!("self_attn.{part}")), Some(size), size);
            }
            layer(name("layer_norm1"), None, size);
            layer(name("layer_norm2"), None, size);
            layer(name("mlp.fc1"), Some(size), 4 * size);
            layer(name("mlp.fc2"), Some(4 * size), size);
        }
    }
    candle_core::safetensors::save(&tensors, folder.join("model.safetensors")).unwrap();
}

fn picture(width: u32, height: u32) -> Image {
    Image::new(width, height, (0..width * height * 3).map(|at| (at * 7 % 251) as u8).collect()).unwrap()
}

fn encode(criterion: &mut Criterion) {
    let made = tempfile::tempdir().unwrap();
    let folder = match std::env::var_os("WAYWORD_CLIP") {
        Some(folder) => folder.into(),
        None => {
            random_model(made.path());
            made.path().to_owned()
        }
    };
    let clip = ClipModel::load("hf/bench/clip", &folder, &ModelDevice::cpu(), WeightPrecision::F32).unwrap();
    let mut group = criterion.benchmark_group("clip");
    group.sample_size(10);
    let (image, large) = (picture(224, 224), picture(640, 480));
    for count in [1, 8, 32] {
        let images = vec![&image; count];
        group.bench_function(format!("pictures batch {count}"), |bencher| {
            bencher.iter(|| clip.image_features(black_box(&images)).unwrap());
        });
    }
    group.bench_function("picture of 640 x 480", |bencher| {
        bencher.iter(|| clip.image_features(black_box(&[&large])).unwrap());
    });
    let texts = vec!["a photo of the kitchen table beside a red door"; 32];
    for count in [1, 32] {
        group.bench_function(format!("texts batch {count}"), |bencher| {
            bencher.iter(|| clip.text_features(black_box(&texts[..count])).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, encode);
criterion_main!(benches);
