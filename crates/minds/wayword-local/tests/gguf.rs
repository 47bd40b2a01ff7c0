//! Small instruct models against transformers: `fixtures/make_gguf.py` says how the replies were made.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a test fails by panicking"
)]

use serde::Deserialize;
use std::{path::PathBuf, sync::Arc};
use wayword_core::{Finish, Image, Message, Role, Sampling};
use wayword_local::{Device, GgufModel, LocalError, Spoken};

const MODELS: [&str; 4] = ["qwen2", "qwen3", "llama2", "llama3"];

#[derive(Deserialize)]
struct Case {
    messages: Vec<Said>,
    ids: Vec<u32>,
    made: Vec<u32>,
    ended: bool,
    text: String,
}

#[derive(Deserialize)]
struct Said {
    role: Role,
    content: String,
}

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/gguf").join(name)
}

fn load(name: &str) -> GgufModel {
    GgufModel::load(&fixture(&format!("{name}.gguf")), &Device::cpu()).unwrap()
}

fn cases(name: &str) -> Vec<Case> {
    serde_json::from_str(&std::fs::read_to_string(fixture(&format!("{name}.json"))).unwrap()).unwrap()
}

fn user(text: &str) -> Message {
    Message { role: Role::User, text: text.to_owned(), image: None }
}

fn sampling(temperature: f64, max_tokens: u32, seed: u64) -> Sampling {
    Sampling { temperature, max_tokens, seed }
}

fn say(model: &GgufModel, messages: &[Message], sampling: &Sampling) -> Result<Spoken, LocalError> {
    let mut pieces = String::new();
    let spoken = model.reply(messages, sampling, &mut |piece| pieces.push_str(piece))?;
    assert_eq!(pieces, spoken.reply.text, "the pieces are the reply");
    Ok(spoken)
}

#[test]
fn replies_are_those_of_transformers() {
    for name in MODELS {
        let model = load(name);
        for case in cases(name) {
            let message = |said: &Said| Message { role: said.role, text: said.content.clone(), image: None };
            let messages: Vec<Message> = case.messages.iter().map(message).collect();
            let spoken = say(&model, &messages, &sampling(0.0, case.made.len() as u32, 0)).unwrap();
            assert_eq!(spoken.reply.text, case.text.trim(), "{name}");
            assert_eq!(
                (spoken.tokens_in, spoken.tokens_out),
                (case.ids.len() as u64, case.made.len() as u64),
                "{name}"
            );
            assert_eq!(spoken.reply.finish == Finish::Stop, case.ended, "{name}");
        }
    }
}

#[test]
fn a_seed_is_a_reply_and_another_seed_another() {
    let model = load("llama3");
    let messages = [user("Which way?")];
    let draw = |seed| say(&model, &messages, &sampling(1.0, 12, seed)).unwrap();
    assert_eq!(draw(1), draw(1));
    assert!((2..6).any(|seed| draw(seed) != draw(1)));
}

#[test]
fn a_reply_ends_at_its_limit_and_where_the_model_can_read_no_more() {
    let model = load("qwen3");
    let none = say(&model, &[user("Go.")], &sampling(0.0, 0, 0)).unwrap();
    assert_eq!((&none.reply.text[..], none.reply.finish, none.tokens_out), ("", Finish::Length, 0));
    // The fixture reads 512 tokens, and each of these words takes several.
    let long = say(&model, &[user(&"zyx ".repeat(115))], &sampling(0.0, 500, 0)).unwrap();
    assert_eq!(long.reply.finish, Finish::Length);
    assert!(long.tokens_in < 512 && long.tokens_in + long.tokens_out == 513, "{} {}", long.tokens_in, long.tokens_out);
    let error = say(&model, &[user(&"zyx ".repeat(300))], &sampling(0.0, 1, 0)).unwrap_err().to_string();
    assert!(error.contains("qwen3.gguf") && error.contains("511"), "{error}");
    let error = say(&model, &[user(&"zyx ".repeat(1 << 20))], &sampling(0.0, 1, 0)).unwrap_err().to_string();
    assert!(error.contains("too long"), "{error}");
}

#[test]
fn a_picture_and_a_temperature_that_is_none_are_refused() {
    let model = load("qwen2");
    let picture = Image::new(1, 1, vec![0; 3]).unwrap();
    let message = Message { image: Some(Arc::new(picture)), ..user("What is this?") };
    let error = say(&model, &[message], &sampling(0.0, 1, 0)).unwrap_err().to_string();
    assert!(error.contains("qwen2.gguf") && error.contains("picture"), "{error}");
    let error = say(&model, &[user("Go.")], &sampling(f64::NAN, 1, 0)).unwrap_err().to_string();
    assert!(error.contains("temperature"), "{error}");
}

/// What loading a changed fixture says.
fn refusal(name: &str, change: impl FnOnce(&mut Vec<u8>)) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("damaged.gguf");
    let mut bytes = std::fs::read(fixture(&format!("{name}.gguf"))).unwrap();
    change(&mut bytes);
    std::fs::write(&file, bytes).unwrap();
    let error = GgufModel::load(&file, &Device::cpu()).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.contains("damaged.gguf"), "{error:?} names no file");
    error
}

/// Puts other bytes in the place of the first that are alike.
fn put(bytes: &mut [u8], old: &[u8], new: &[u8]) {
    let at = bytes.windows(old.len()).position(|window| window == old).unwrap();
    bytes[at..at + new.len()].copy_from_slice(new);
}

#[test]
fn damaged_files_say_which_field_or_tensor() {
    /// The kind (4: 32 bits) and number that follow a key.
    fn number(key: &str, number: u32) -> Vec<u8> {
        [key.as_bytes(), &4_u32.to_le_bytes(), &number.to_le_bytes()].concat()
    }
    let sets = |key: &'static str, to: u32| move |bytes: &mut Vec<u8>| put(bytes, key.as_bytes(), &number(key, to));
    let cases: Vec<(String, &str)> = vec![
        (refusal("qwen2", |bytes| bytes.truncate(100)), "cut off"),
        (refusal("qwen2", |bytes| bytes.truncate(bytes.len() - 64)), "tensor"),
        (refusal("qwen2", |bytes| put(bytes, b"qwen2", b"gemma")), "general.architecture: gemma"),
        (refusal("qwen2", sets("qwen2.attention.head_count", 0)), "qwen2.attention.head_count"),
        (refusal("qwen2", sets("qwen2.attention.head_count", 5)), "qwen2.attention.head_count"),
        (refusal("qwen2", sets("qwen2.attention.head_count_kv", 3)), "qwen2.attention.head_count_kv"),
        (refusal("qwen2", sets("qwen2.block_count", 4_000_000_000)), "qwen2.block_count"),
        (refusal("qwen2", sets("qwen2.block_count", 3)), "tensor blk.2."),
        (refusal("qwen2", sets("qwen2.embedding_length", 64)), "tensor token_embd.weight"),
        (refusal("qwen2", sets("qwen2.feed_forward_length", 64)), "tensor blk.0.ffn_gate.weight"),
        (refusal("qwen2", sets("tokenizer.ggml.eos_token_id", 100_000)), "tokenizer.ggml.eos_token_id"),
        (refusal("qwen2", |bytes| put(bytes, b"blk.1.attn_k.bias", b"blk.1.attn_k.bios")), "tensor blk.1.attn_k.bias"),
        (refusal("qwen3", |bytes| put(bytes, b"blk.1.attn_q_norm", b"blk.1.attn_q_nerm")), "blk.1.attn_q_norm.weight"),
        (
            refusal("llama2", |bytes| put(bytes, b"tokenizer.chat_template", b"tokenizer.chat_tamplate")),
            "chat_template",
        ),
        (
            refusal("qwen2", |bytes| put(bytes, b"tokenizer.ggml.merges", b"tokenizer.ggml.morges")),
            "tokenizer.ggml.merges",
        ),
        (refusal("llama3", |bytes| put(bytes, b"llama-bpe", b"klama-bpe")), "tokenizer.ggml.pre: klama-bpe"),
        (
            refusal("llama2", |bytes| put(bytes, b"tokenizer.ggml.scores", b"tokenizer.ggml.scares")),
            "tokenizer.ggml.scores",
        ),
    ];
    for (error, expected) in cases {
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = GgufModel::load(&fixture("none.gguf"), &Device::cpu()).err().unwrap().to_string();
    assert!(error.contains("none.gguf"), "{error}");
}
