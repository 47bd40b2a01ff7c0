//! Compares prepared pictures with Pillow and transformers (`fixtures/make_picture.py`).

use super::*;
use serde::Deserialize;

/// The result of transformers for a picture (`fixtures/make_picture.py`).
#[derive(Deserialize)]
struct Case {
    width: u32,
    height: u32,
    config: serde_json::Value,
    shape: [usize; 3],
    sha256: String,
    numbers: Vec<f32>,
}

fn cases() -> Vec<Case> {
    serde_json::from_str(include_str!("../../fixtures/picture/pillow.json")).unwrap()
}

/// The same formula as in `fixtures/make_picture.py`.
fn drawn(width: u32, height: u32) -> Image {
    let byte = |at: u32| {
        let (x, y, colour) = (at / 3 % width, at / 3 / width, at % 3);
        ((x * x * 7 + y * 13 + colour * 50 + x * y % 31 * 5) % 256) as u8
    };
    Image::new(width, height, (0..width * height * 3).map(byte).collect()).unwrap()
}

fn processor(config: &serde_json::Value) -> Result<PictureProcessor, LocalError> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("preprocessor_config.json"), config.to_string()).unwrap();
    PictureProcessor::load(folder.path())
}

fn numbers(processor: &PictureProcessor, images: &[&Image]) -> Vec<f32> {
    processor.to_tensor(images, &ModelDevice::cpu()).unwrap().flatten_all().unwrap().to_vec1().unwrap()
}

#[test]
fn resampled_pixels_equal_pillows() {
    for Case { width, height, mut config, shape, sha256, .. } in cases() {
        config["do_rescale"] = false.into();
        config["do_normalize"] = false.into();
        let processor = processor(&config).unwrap();
        assert_eq!([3, processor.size_px().0, processor.size_px().1], shape, "{config}");
        let bytes: Vec<u8> = numbers(&processor, &[&drawn(width, height)]).iter().map(|&number| number as u8).collect();
        let hash: String = Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hash, sha256, "{width} x {height}: {config}");
    }
}

#[test]
fn numbers_are_transformers() {
    for Case { width, height, config, numbers: expected, .. } in cases() {
        let ours = numbers(&processor(&config).unwrap(), &[&drawn(width, height)]);
        let step = (ours.len() / 40).max(1);
        for (ours, theirs) in ours.iter().step_by(step).zip(&expected) {
            assert!((ours - theirs).abs() < 1e-6, "{width} x {height}: {ours} for {theirs}");
        }
    }
}

#[test]
fn a_picture_is_the_same_alone_and_among_others() {
    let processor = processor(&serde_json::json!({ "size": 16, "crop_size": 16 })).unwrap();
    let (one, other) = (drawn(20, 30), drawn(31, 17));
    let both = [numbers(&processor, &[&one]), numbers(&processor, &[&other])].concat();
    assert_eq!(numbers(&processor, &[&one, &other]), both);
    assert!(numbers(&processor, &[]).is_empty());
}

#[test]
fn a_thin_picture_takes_no_more_memory_than_a_square_one() {
    // Resized without cropping it would have 224 x 22 million pixels.
    let processor = processor(&serde_json::json!({})).unwrap();
    assert_eq!(numbers(&processor, &[&drawn(1, 100_000)]).len(), 3 * 224 * 224);
}

#[test]
fn a_picture_without_pixels_is_refused() {
    let processor = processor(&serde_json::json!({})).unwrap();
    let empty = Image::new(0, 7, Vec::new()).unwrap();
    let error = processor.to_tensor(&[&empty], &ModelDevice::cpu()).unwrap_err().to_string();
    assert!(error.contains("0 x 7"), "{error}");
}

#[test]
fn processor_reports_settings_it_does_not_support() {
    for (config, told) in [
        (serde_json::json!({ "image_processor_type": "ViTImageProcessor" }), "ViTImageProcessor"),
        (serde_json::json!({ "resample": 0 }), "resample: 0"),
        (serde_json::json!({ "size": 1_000_000 }), "1000000 pixels"),
        (serde_json::json!({ "crop_size": 0 }), "0 pixels"),
        (serde_json::json!({ "do_resize": false }), "do_resize"),
        (serde_json::json!({ "do_center_crop": false }), "shortest edge"),
        (serde_json::json!({ "image_std": [0.2, 0.0, 0.2] }), "image_std"),
        (serde_json::json!({ "image_mean": [0.2, 0.1] }), "invalid length 2"),
    ] {
        let error = processor(&config).err().expect("it is refused").to_string();
        assert!(error.contains(told) && error.contains("preprocessor_config.json"), "{error}");
    }
}

#[test]
fn the_same_pixels_in_another_shape_are_another_picture() {
    let shaped = |width, height| picture_digest(&Image::new(width, height, vec![7; 36]).unwrap());
    assert_ne!(shaped(3, 4), shaped(4, 3));
    assert_eq!(shaped(3, 4), shaped(3, 4));
}

#[test]
fn the_processor_of_newer_releases_is_read() {
    let config = serde_json::json!({
        "image_processor_type": "CLIPImageProcessorFast", "size": {"shortest_edge": 8}, "crop_size": {"height": 8, "width": 8},
        "resample": 3,
    });
    let load = |processor: serde_json::Value| {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("processor_config.json"), processor.to_string()).unwrap();
        PictureProcessor::load(folder.path()).map_err(|error| error.to_string())
    };
    let image = drawn(20, 12);
    let new = load(serde_json::json!({"image_processor": config, "processor_class": "CLIPProcessor"})).unwrap();
    assert_eq!(numbers(&new, &[&image]), numbers(&processor(&config).unwrap(), &[&image]));
    let mut other = config;
    other["image_processor_type"] = "SiglipImageProcessor".into();
    let error = load(serde_json::json!({"image_processor": other})).err().unwrap();
    assert!(error.contains("processor_config.json") && error.contains("SiglipImageProcessor"), "{error}");
    // A file for texts alone says nothing of pictures.
    let error = load(serde_json::json!({"processor_class": "CLIPProcessor"})).err().unwrap();
    assert!(error.contains("preprocessor_config.json"), "{error}");
}
