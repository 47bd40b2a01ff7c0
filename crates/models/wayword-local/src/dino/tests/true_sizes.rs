//! Parity and times at the true sizes, outside CI: of the folders that `make_dino.py --true FOLDER` made.

#![allow(clippy::print_stderr, reason = "these are measurements")]

use super::{drawn, load, numbers, off};
use candle_core::Tensor;
use std::{collections::HashMap, path::PathBuf, time::Instant};

/// The same words as in `fixtures/make_dino.py`, as phrases.
const WORDS: &str = "red door stairs kitchen table sink bed lamp chair plant sofa window mirror shelf towel rug clock stove oven \
                     desk book vase pillow cup bowl basket bench box bin fan heater radiator curtain picture frame wardrobe \
                     drawer counter stool bath";

/// The folders in the folder that `WAYWORD_DINO` names.
fn folders() -> Vec<PathBuf> {
    let all = std::env::var("WAYWORD_DINO").expect("WAYWORD_DINO names the folder that make_dino.py --true made");
    let mut folders: Vec<PathBuf> = std::fs::read_dir(all).unwrap().map(|entry| entry.unwrap().path()).collect();
    folders.retain(|folder| folder.join("expected.safetensors").exists());
    folders.sort();
    folders
}

#[test]
#[ignore = "needs checkpoints of true size: WAYWORD_DINO"]
fn true_sizes_agree_with_pytorch() {
    let words: Vec<&str> = WORDS.split_whitespace().collect();
    assert_eq!(words.len(), 40);
    for folder in folders() {
        let dino = load(&folder);
        let file = folder.join("expected.safetensors");
        let expected: HashMap<String, Tensor> =
            candle_core::safetensors::load(file, &candle_core::Device::Cpu).unwrap();
        for (width, height) in [(640, 480), (1066, 800)] {
            let features = dino.features(&drawn(width, height)).unwrap();
            for phrases in [3, 40] {
                let stage = |stage: &str| numbers(&expected[&format!("{width}.{phrases}.{stage}")]);
                let (_, text) = dino.prompts(&words[..phrases]).unwrap().remove(0);
                let candidates = off(&dino.candidates(&features, &text).unwrap(), &stage("candidates"));
                let theirs: Vec<u32> = stage("picked").iter().map(|&at| at as u32).collect();
                let mut moved = 0;
                // Equal candidates may change places, so the order is theirs. The set must be the same.
                let seen = dino.look(&features, &text, |ours| {
                    moved = ours.iter().zip(&theirs).filter(|(a, b)| a != b).count();
                    let sorted = |mut order: Vec<u32>| {
                        order.sort_unstable();
                        order
                    };
                    assert_eq!(sorted(ours), sorted(theirs.clone()));
                    theirs
                });
                let seen = seen.unwrap();
                let logits = off(&numbers(&seen.logits), &stage("logits"));
                let pixels = [width as f32, height as f32, width as f32, height as f32];
                let scaled = |edges: Vec<f32>| -> Vec<f32> {
                    edges.iter().zip(pixels.iter().cycle()).map(|(edge, pixels)| edge * pixels).collect()
                };
                let boxes = off(&scaled(seen.boxes.concat()), &scaled(stage("boxes")));
                eprintln!(
                    "{} {width}x{height} {phrases} phrases: logits {logits:.1e}, boxes {boxes:.1e} px, candidates {candidates:.1e} ({moved} changed places)",
                    folder.display()
                );
                assert!(logits < 1e-3 && boxes < 1e-2, "{logits} {boxes}");
            }
        }
    }
}

#[test]
#[ignore = "needs checkpoints of true size: WAYWORD_DINO"]
fn the_time_of_a_picture() {
    for folder in folders() {
        let mut dino = load(&folder);
        dino.shows(480, 800);
        let image = drawn(640, 480);
        let phrases = ["red door", "stairs", "kitchen table", "sink"];
        for at in 0..6 {
            let begun = Instant::now();
            let prompts = dino.prompts(&phrases).unwrap();
            assert_eq!(prompts[0].0.ids.len(), 12);
            let read = begun.elapsed();
            let features = dino.fresh(&image).unwrap();
            let looked = begun.elapsed();
            let (cells, text) = dino.encoded(&features, &prompts[0].1).unwrap();
            let encoded = begun.elapsed();
            dino.seen_behind(&features, (&cells, &text)).unwrap();
            let all = begun.elapsed();
            if at > 0 {
                eprintln!(
                    "{} {all:.3?}: text {read:.3?}, picture {:.3?}, encoder {:.3?}, decoder {:.3?}",
                    folder.display(),
                    looked - read,
                    encoded - looked,
                    all - encoded
                );
            }
        }
    }
}
