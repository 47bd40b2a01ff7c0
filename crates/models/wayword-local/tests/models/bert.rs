//! Compares sentence encoders with PyTorch: `fixtures/make_bert.py` made the numbers.

use crate::common::{self, copy, fixture, refused};
use serde_json::json;
use std::path::{Path, PathBuf};
use wayword_local::{ModelDevice, SentenceEncoder, WeightPrecision};

fn load(folder: &Path) -> Result<SentenceEncoder, wayword_local::LocalError> {
    SentenceEncoder::load("hf/test/bert", folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[derive(serde::Deserialize)]
struct Expected {
    text: String,
    vector: Vec<f32>,
}

#[track_caller]
fn agrees(encoder: &SentenceEncoder, expected: &Path) {
    let expected: Vec<Expected> = serde_json::from_str(&std::fs::read_to_string(expected).unwrap()).unwrap();
    let texts: Vec<&str> = expected.iter().map(|one| &one.text[..]).collect();
    let ours = encoder.unit_vectors(&texts).unwrap();
    for (ours, theirs) in ours.iter().zip(&expected) {
        let off = ours.iter().zip(&theirs.vector).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(ours.len() == theirs.vector.len() && off < 1e-5, "{:?}: {off}", theirs.text);
    }
    // A text has the same vector alone and among others.
    for (text, among) in texts.iter().zip(&ours) {
        let alone = encoder.unit_vectors(&[text]).unwrap().remove(0);
        assert!(alone.iter().zip(among).all(|(a, b)| (a - b).abs() < 1e-5), "{text:?}");
    }
}

#[test]
fn vectors_agree_with_pytorch() {
    agrees(&load(&fixture("bert")).unwrap(), &fixture("bert").join("expected.json"));
}

/// A tokenizer as paraphrase-multilingual-MiniLM-L12-v2 has it: SentencePiece's normalisation and a Unigram vocabulary.
/// `fixtures/make_bert_multilingual.py` made the numbers.
#[test]
fn vectors_of_other_languages_agree_with_pytorch() {
    agrees(&load(&fixture("bert_multilingual")).unwrap(), &fixture("bert_multilingual").join("expected.json"));
}

/// The same with the real weights: needs a folder with paraphrase-multilingual-MiniLM-L12-v2 and the `expected.json` of
/// `make_bert_multilingual.py --expect`.
#[test]
fn real_multilingual_weights_agree_with_pytorch() {
    let Some(folder) = std::env::var_os("WAYWORD_MULTILINGUAL_MINILM").map(PathBuf::from) else {
        eprintln!(
            "skipped: set WAYWORD_MULTILINGUAL_MINILM to a folder with paraphrase-multilingual-MiniLM-L12-v2 and expected.json (fixtures/make_bert_multilingual.py --expect)"
        );
        return;
    };
    agrees(&load(&folder).unwrap(), &folder.join("expected.json"));
}

/// Real sentences with the real weights: needs a folder with all-MiniLM-L6-v2 and the `expected.json` of `make_bert.py
/// --expect`.
#[test]
fn real_weights_agree_with_pytorch() {
    let Some(folder) = std::env::var_os("WAYWORD_MINILM").map(PathBuf::from) else {
        eprintln!(
            "skipped: set WAYWORD_MINILM to a folder with all-MiniLM-L6-v2 and expected.json (fixtures/make_bert.py --expect)"
        );
        return;
    };
    agrees(&load(&folder).unwrap(), &folder.join("expected.json"));
}

#[test]
fn sixteen_bits_come_near() {
    let whole = load(&fixture("bert")).unwrap();
    let half =
        SentenceEncoder::load("hf/test/bert", &fixture("bert"), &ModelDevice::cpu(), WeightPrecision::Bf16).unwrap();
    let text = "Go past the table and stop at the sink.";
    let (whole, half) = (whole.unit_vectors(&[text]).unwrap(), half.unit_vectors(&[text]).unwrap());
    let cosine: f32 = whole[0].iter().zip(&half[0]).map(|(a, b)| a * b).sum();
    assert!((0.99..0.999_999).contains(&cosine), "{cosine}");
}

/// The error of loading a copy of the fixture with one file changed.
fn damaged(file: &str, change: impl FnOnce(Vec<u8>) -> Vec<u8>) -> String {
    let folder = copy("bert");
    common::change(folder.path(), file, change);
    refused(load(folder.path()))
}

#[test]
fn load_names_the_damaged_file_and_tensor() {
    let cut = damaged("model.safetensors", |bytes| bytes[..bytes.len() / 2].to_vec());
    assert!(cut.contains("model.safetensors") && cut.contains("bytes"), "{cut}");
    let resized = damaged("config.json", |bytes| {
        String::from_utf8(bytes).unwrap().replace("\"hidden_size\": 24", "\"hidden_size\": 27").into_bytes()
    });
    assert!(resized.contains("embeddings.") && resized.contains("[2, 24], not [2, 27]"), "{resized}");
    let other = damaged("config.json", |bytes| {
        String::from_utf8(bytes).unwrap().replace("\"model_type\": \"bert\"", "\"model_type\": \"t5\"").into_bytes()
    });
    assert!(other.contains("config.json") && other.contains("t5 is not bert"), "{other}");
}

/// A copy of the fixture with these files, each with its content.
fn saved(files: &[(&str, serde_json::Value)]) -> tempfile::TempDir {
    let folder = copy("bert");
    for (file, content) in files {
        let path = folder.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, content.to_string()).unwrap();
    }
    folder
}

const TEXTS: [&str; 3] = ["Go past the table and stop at the sink.", "Turn left.", "stop"];

fn vectors(folder: &Path) -> Vec<Vec<f32>> {
    load(folder).unwrap().unit_vectors(&TEXTS).unwrap()
}

#[track_caller]
fn same(ours: &[Vec<f32>], theirs: &[Vec<f32>]) {
    for (ours, theirs) in ours.iter().flatten().zip(theirs.iter().flatten()) {
        assert!((ours - theirs).abs() < 1e-5, "{ours} {theirs}");
    }
    assert_eq!(ours.iter().map(Vec::len).collect::<Vec<_>>(), theirs.iter().map(Vec::len).collect::<Vec<_>>());
}

fn pooled(config: serde_json::Value) -> tempfile::TempDir {
    saved(&[("1_Pooling/config.json", config)])
}

#[test]
fn both_forms_of_the_pooling_give_the_same_vectors() {
    let forms = |old: &str, new: &str| {
        let old = pooled(json!({"word_embedding_dimension": 24, "pooling_mode_mean_tokens": false, old: true}));
        let new = json!({"embedding_dimension": 24, "pooling_mode": new, "include_prompt": true});
        let old = vectors(old.path());
        same(&vectors(pooled(new.clone()).path()), &old);
        let listed = json!({"pooling_mode": [new["pooling_mode"]]});
        same(&vectors(pooled(listed).path()), &old);
        old
    };
    let mean = forms("pooling_mode_mean_tokens", "mean");
    let first = forms("pooling_mode_cls_token", "cls");
    let last = forms("pooling_mode_lasttoken", "lasttoken");
    same(&vectors(&fixture("bert")), &mean);
    assert!(mean != first && first != last && last != mean);
    // The last token is that of each text, and not the padding.
    for (text, vector) in TEXTS.iter().zip(&last) {
        let folder = pooled(json!({"pooling_mode": "lasttoken"}));
        same(&load(folder.path()).unwrap().unit_vectors(&[text]).unwrap(), std::slice::from_ref(vector));
    }
    // Two poolings stand side by side. Each part is in the direction of the vector of that pooling.
    let both = vectors(pooled(json!({"pooling_mode": ["cls", "mean"]})).path());
    for (both, (first, mean)) in both.iter().zip(first.iter().zip(&mean)) {
        assert_eq!(both.len(), 48);
        for (part, whole) in [(&both[..24], first), (&both[24..], mean)] {
            let length = part.iter().map(|number| number * number).sum::<f32>().sqrt();
            assert!(part.iter().zip(whole).all(|(part, whole)| (part / length - whole).abs() < 1e-5));
        }
    }
    let old_both = json!({"pooling_mode_cls_token": true, "pooling_mode_mean_tokens": true});
    same(&vectors(pooled(old_both).path()), &both);
    for (config, name) in [
        (json!({"pooling_mode": "max"}), "\"max\""),
        (json!({"pooling_mode_max_tokens": true}), "\"max\""),
        (json!({"pooling_mode": ["mean", "weightedmean"]}), "\"weightedmean\""),
        (json!({"pooling_mode": "attention"}), "\"attention\""),
        (json!({"pooling_mode_mean_sqrt_len_tokens": true}), "\"mean_sqrt_len_tokens\""),
    ] {
        let error = refused(load(pooled(config).path()));
        assert!(error.contains("1_Pooling/config.json") && error.contains(name), "{error}");
    }
}

/// `modules.json` with these paths and types behind the transformer.
fn listed(modules: &[(&str, &str)]) -> (&'static str, serde_json::Value) {
    let all = std::iter::once(&("", "sentence_transformers.models.Transformer")).chain(modules);
    let all: Vec<_> =
        all.enumerate().map(|(at, (path, kind))| json!({"idx": at, "path": path, "type": kind})).collect();
    ("modules.json", all.into())
}

const POOLING: (&str, &str) = ("1_Pooling", "sentence_transformers.models.Pooling");
const DENSE: (&str, &str) = ("2_Dense", "sentence_transformers.base.modules.dense.Dense");
const NORMALIZE: (&str, &str) = ("3_Normalize", "sentence_transformers.models.Normalize");

/// Writes a layer of 24 inputs and 2 outputs: the sums of the first and of the second half, and a bias.
fn write_layer(folder: &Path, bias: Option<[f32; 2]>) {
    let weight: Vec<f32> = (0..48).map(|at| if (at / 24) == (at % 24) / 12 { 1.0 } else { 0.0 }).collect();
    let mut bytes: Vec<u8> = weight.iter().flat_map(|number| number.to_le_bytes()).collect();
    let mut head = json!({"linear.weight": {"dtype": "F32", "shape": [2, 24], "data_offsets": [0, 192]}});
    if let Some(bias) = bias {
        bytes.extend(bias.iter().flat_map(|number| number.to_le_bytes()));
        head["linear.bias"] = json!({"dtype": "F32", "shape": [2], "data_offsets": [192, 200]});
    }
    let head = head.to_string();
    let file = [&(head.len() as u64).to_le_bytes(), head.as_bytes(), &bytes].concat();
    std::fs::write(folder.join("2_Dense/model.safetensors"), file).unwrap();
}

fn dense(config: &serde_json::Value, bias: Option<[f32; 2]>, modules: &[(&str, &str)]) -> tempfile::TempDir {
    let mean = json!({"pooling_mode": "mean"});
    let folder = saved(&[("1_Pooling/config.json", mean), ("2_Dense/config.json", config.clone()), listed(modules)]);
    write_layer(folder.path(), bias);
    folder
}

#[test]
fn layers_behind_the_pooling_are_computed() {
    let unit = |[x, y]: [f32; 2]| vec![x / x.hypot(y), y / x.hypot(y)];
    let mean = vectors(&fixture("bert"));
    let config = |activation: &str| json!({"in_features": 24, "out_features": 2, "bias": true, "activation_function": activation});
    let bias = [0.25, -0.5];
    let sums = |vector: &Vec<f32>| [vector[..12].iter().sum::<f32>() + 0.25, vector[12..].iter().sum::<f32>() - 0.5];
    // With vectors of length 1 before the layer, its input is known.
    for (activation, expected) in [
        ("torch.nn.modules.linear.Identity", mean.iter().map(|vector| unit(sums(vector))).collect::<Vec<_>>()),
        ("torch.nn.modules.activation.Tanh", mean.iter().map(|vector| unit(sums(vector).map(f32::tanh))).collect()),
    ] {
        let folder = dense(&config(activation), Some(bias), &[POOLING, NORMALIZE, DENSE]);
        same(&vectors(folder.path()), &expected);
        let normalized = dense(&config(activation), Some(bias), &[POOLING, NORMALIZE, DENSE, NORMALIZE]);
        same(&vectors(normalized.path()), &expected);
    }
    let identity = config("torch.nn.modules.linear.Identity");
    let unnormalized = vectors(dense(&identity, Some(bias), &[POOLING, DENSE]).path());
    assert!(unnormalized != vectors(dense(&identity, Some(bias), &[POOLING, NORMALIZE, DENSE]).path()));
    let unbiased = json!({"in_features": 24, "out_features": 2, "bias": false, "activation_function": "torch.nn.modules.linear.Identity"});
    let expected: Vec<_> =
        mean.iter().map(|vector| unit([vector[..12].iter().sum(), vector[12..].iter().sum()])).collect();
    same(&vectors(dense(&unbiased, None, &[POOLING, DENSE]).path()), &expected);
    for (key, value, told) in [
        ("activation_function", json!("torch.nn.modules.activation.GELU"), "activation_function is GELU"),
        ("in_features", json!(12), "in_features is 12, but the vectors before it have 24 numbers"),
        ("out_features", json!(0), "out_features: 0"),
        ("use_residual", json!(true), "use_residual is true"),
        ("module_input_name", json!("token_embeddings"), "module_input_name is \"token_embeddings\""),
        ("bias", json!(false), "bias is false, but in the weights there is one"),
    ] {
        let mut config = identity.clone();
        config[key] = value;
        let error = refused(load(dense(&config, Some(bias), &[POOLING, DENSE]).path()));
        assert!(error.contains("2_Dense/config.json") && error.contains(told), "{error}");
    }
    let lost = dense(&identity, Some(bias), &[POOLING, DENSE]);
    std::fs::remove_file(lost.path().join("2_Dense/model.safetensors")).unwrap();
    assert!(refused(load(lost.path())).contains("2_Dense/model.safetensors"));
}

#[test]
fn what_is_not_done_here_is_refused_by_its_name() {
    let mean = ("1_Pooling/config.json", json!({"pooling_mode": "mean"}));
    for (modules, told) in [
        (&[POOLING, ("2_LayerNorm", "sentence_transformers.models.LayerNorm")][..], "models.LayerNorm"),
        (&[POOLING, ("", "my_code.Whitening")], "my_code.Whitening"),
        (
            &[("1_Dense", "sentence_transformers.models.Dense"), POOLING],
            "module 1 is sentence_transformers.models.Dense",
        ),
        (&[], "lists no pooling"),
        (&[("../1_Pooling", POOLING.1)], "leads out of the folder"),
    ] {
        let error = refused(load(saved(&[mean.clone(), listed(modules)]).path()));
        assert!(error.contains("modules.json") && error.contains(told), "{error}");
    }
    let elsewhere = json!([{"idx": 0, "path": "0_BERT", "type": "sentence_transformers.models.Transformer"}]);
    assert!(refused(load(saved(&[("modules.json", elsewhere)]).path())).contains("the transformer is in \"0_BERT\""));
    for (key, value, told) in [
        ("model_type", json!("SparseEncoder"), "model_type is SparseEncoder"),
        ("similarity_fn_name", json!("euclidean"), "similarity_fn_name is \"euclidean\""),
        ("similarity_fn_name", json!("dot"), "similarity_fn_name is \"dot\""),
        ("truncate_dim", json!(8), "truncate_dim is 8"),
        ("default_prompt_name", json!("query"), "`prompts` has no such text"),
    ] {
        let error = refused(load(saved(&[("config_sentence_transformers.json", json!({key: value}))]).path()));
        assert!(error.contains("config_sentence_transformers.json") && error.contains(told), "{error}");
    }
    let task = ("sentence_bert_config.json", json!({"transformer_task": "fill-mask"}));
    assert!(refused(load(saved(&[task]).path())).contains("transformer_task is \"fill-mask\""));
    // For vectors of length 1, dot products are cosines.
    let dot = ("config_sentence_transformers.json", json!({"similarity_fn_name": "dot"}));
    same(&vectors(saved(&[mean, listed(&[POOLING, NORMALIZE]), dot]).path()), &vectors(&fixture("bert")));
}

#[test]
fn the_default_prompt_stands_before_every_text() {
    let settings = |name: serde_json::Value| json!({"prompts": {"query": "turn left and ", "document": ""}, "default_prompt_name": name});
    let file = "config_sentence_transformers.json";
    let plain = vectors(&fixture("bert"));
    for name in [json!(null), json!("document")] {
        same(&vectors(saved(&[(file, settings(name))]).path()), &plain);
    }
    let prompted = saved(&[(file, settings(json!("query")))]);
    let written: Vec<String> = TEXTS.iter().map(|text| format!("turn left and {text}")).collect();
    let written: Vec<&str> = written.iter().map(String::as_str).collect();
    same(&vectors(prompted.path()), &load(&fixture("bert")).unwrap().unit_vectors(&written).unwrap());
    let pooling = ("1_Pooling/config.json", json!({"pooling_mode": "mean", "include_prompt": false}));
    let error = refused(load(saved(&[(file, settings(json!("query"))), pooling]).path()));
    assert!(error.contains("include_prompt is false"), "{error}");
}

#[test]
fn the_tokenizer_limits_texts_where_nothing_else_does() {
    let long = "go past the table and the sink and the table and stop";
    let encode =
        |files: &[(&str, serde_json::Value)]| load(saved(files).path()).unwrap().unit_vectors(&[long]).unwrap();
    let short = encode(&[("sentence_bert_config.json", json!({"max_seq_length": 6}))]);
    let new = json!({"transformer_task": "feature-extraction", "module_output_name": "token_embeddings"});
    let by_tokenizer = ("tokenizer_config.json", json!({"model_max_length": 6}));
    same(&encode(&[("sentence_bert_config.json", new.clone()), by_tokenizer]), &short);
    let without = ("tokenizer_config.json", json!({"model_max_length": 1e30}));
    assert!(encode(&[("sentence_bert_config.json", new), without]) != short);
}
