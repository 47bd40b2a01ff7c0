//! GLIP-T at its true size against the oracle in PyTorch, and its speed. Not in CI: `fixtures/make_glip.py --true FOLDER`
//! makes a gigabyte.
//!
//! ```text
//! python fixtures/make_glip.py --true FOLDER
//! WAYWORD_GLIP=FOLDER cargo test -p wayword-local --test glip_true -- --ignored --nocapture --test-threads 1
//! ```

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stdout, reason = "a measurement is read by people")]

use candle_core::{Device as On, safetensors};
use std::{path::PathBuf, time::Instant};
use wayword_core::Image;
use wayword_local::{Device, Glip, GlipFiles, Precision};

fn load(short: usize) -> (PathBuf, Glip) {
    let folder = PathBuf::from(std::env::var_os("WAYWORD_GLIP").expect("WAYWORD_GLIP names the folder"));
    let files = GlipFiles { weights: folder.join("glip.pth"), tokenizer: folder.clone(), identity: String::new() };
    let begun = Instant::now();
    let glip = Glip::load("hf/test/glip:glip.pth", &files, short, &Device::cpu(), Precision::F32).unwrap();
    println!("loaded in {:.1} s", begun.elapsed().as_secs_f64());
    (folder, glip)
}

#[derive(serde::Deserialize)]
struct Case {
    size: (u32, u32),
    short: usize,
    phrases: Vec<String>,
    boxes: Vec<Vec<[f32; 5]>>,
}

/// The same formula as in `fixtures/make_glip.py`.
fn drawn((width, height): (u32, u32)) -> Image {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
}

fn off<'a>(ours: impl Iterator<Item = &'a f32>, theirs: &[f32]) -> f32 {
    ours.zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
#[ignore = "needs WAYWORD_GLIP"]
fn glip_t_is_the_oracles() {
    for short in [480, 800] {
        let (folder, glip) = load(short);
        let cases: Vec<Case> =
            serde_json::from_str(&std::fs::read_to_string(folder.join("expected.json")).unwrap()).unwrap();
        for (at, case) in cases.iter().enumerate().filter(|(_, case)| case.short == short) {
            let expected = safetensors::load(folder.join(format!("expected{at}.safetensors")), &On::Cpu).unwrap();
            let expected = |name: &str| expected[name].flatten_all().unwrap().to_vec1::<f32>().unwrap();
            let phrases: Vec<&str> = case.phrases.iter().map(String::as_str).collect();
            let image = drawn(case.size);
            let (logits, boxes) = glip.raw(&image, &phrases).unwrap();
            let logits_off = off(logits.iter(), &expected("logits"));
            let deltas_off = off(boxes.chunks(5).flat_map(|row| &row[..4]), &expected("deltas"));
            let centres_off = off(boxes.chunks(5).map(|row| &row[4]), &expected("centres"));
            let found = glip.find(&image, &phrases).unwrap();
            let (mut boxes_off, mut scores_off, mut other) = (0.0_f32, 0.0_f32, 0);
            for (found, expected) in found.iter().zip(&case.boxes) {
                other += found.len().abs_diff(expected.len());
                // Boxes whose scores are nearly equal may stand in another order.
                for expected in expected {
                    let far = |found: &wayword_core::Found| off(found.box_px.iter(), &expected[..4]);
                    let Some(near) = found.iter().min_by(|a, b| far(a).total_cmp(&far(b))) else { continue };
                    if far(near) > 1.0 {
                        other += 1;
                        continue;
                    }
                    boxes_off = boxes_off.max(far(near));
                    scores_off = scores_off.max((near.score - expected[4]).abs());
                }
            }
            println!(
                "{:?}, {} phrases: logits {logits_off:.1e}, distances {deltas_off:.1e}, centres {centres_off:.1e}; boxes {boxes_off:.1e} px, scores {scores_off:.1e}, {other} others",
                case.size,
                phrases.len()
            );
            assert!(logits_off < 1e-4 && boxes_off < 1e-3 && scores_off < 1e-4 && other == 0);
        }
    }
}

/// Seconds of all processors so far, and the most memory so far, MiB (Linux).
fn used() -> (f64, u64) {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks: u64 = stat.split_whitespace().skip(13).take(2).filter_map(|field| field.parse::<u64>().ok()).sum();
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB")?.trim().parse().ok());
    (ticks as f64 / 100.0, peak.unwrap_or(0_u64) >> 10)
}

#[test]
#[ignore = "needs WAYWORD_GLIP"]
fn glip_t_takes_this_long() {
    let (_, glip) = load(480);
    let image = drawn((640, 480));
    for round in 0..5 {
        // Another picture each time, because features are kept.
        let mut rgb = image.rgb().to_vec();
        rgb[0] = round;
        let image = Image::new(640, 480, rgb).unwrap();
        let (begun, before) = (Instant::now(), used().0);
        let count = glip.find(&image, &["blue chair", "fireplace", "a wooden door"]).unwrap().len();
        let (first, (after, peak)) = (begun.elapsed().as_secs_f64(), used());
        let begun = Instant::now();
        glip.find(&image, &["blue chair", "fireplace", "a wooden door"]).unwrap();
        println!(
            "{count} phrases: {first:.2} s, {:.2} s of processors; again {:.2} s; at most {peak} MiB",
            after - before,
            begun.elapsed().as_secs_f64()
        );
    }
}
