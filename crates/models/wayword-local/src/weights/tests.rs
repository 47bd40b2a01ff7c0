//! Tests safetensors files and folders of checkpoints, whole, damaged and malicious.

use super::*;
use candle_core::Device as On;
use std::collections::HashMap;

fn checkpoint(folder: &Path) -> PathBuf {
    let weight = Tensor::arange(0_f32, 6.0, &On::Cpu).unwrap().reshape((2, 3)).unwrap();
    let file = folder.join("model.safetensors");
    candle_core::safetensors::save(&HashMap::from([("layer.weight", weight)]), &file).unwrap();
    file
}

fn open(folder: &Path) -> Result<CheckpointWeights, LocalError> {
    CheckpointWeights::open(folder, &ModelDevice::cpu(), WeightPrecision::F32)
}

#[test]
fn a_tensor_is_read_by_name_and_shape() {
    let folder = tempfile::tempdir().unwrap();
    checkpoint(folder.path());
    let weights = open(folder.path()).unwrap();
    let tensor = weights.scope_under("layer").read_tensor("weight", &[2, 3]).unwrap();
    assert_eq!(tensor.to_vec2::<f32>().unwrap(), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]]);
    assert_eq!(weights.size_bytes(), 6 * 4);
}

#[test]
fn an_error_names_file_and_tensor() {
    let folder = tempfile::tempdir().unwrap();
    let file = checkpoint(folder.path());
    let weights = open(folder.path()).unwrap();
    for (tensor, shape, problem) in [("weight", [3, 2], "its shape is [2, 3], not [3, 2]"), ("bias", [2, 3], "missing")]
    {
        let error = weights.scope_under("layer").read_tensor(tensor, &shape).unwrap_err().to_string();
        for part in [file.to_str().unwrap(), &format!("layer.{tensor}"), problem] {
            assert!(error.contains(part), "{error}");
        }
    }
}

#[test]
fn a_file_that_is_cut_off_anywhere_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = checkpoint(folder.path());
    let whole = std::fs::read(&file).unwrap();
    for length in 0..whole.len() {
        std::fs::write(&file, &whole[..length]).unwrap();
        let error = open(folder.path()).err().expect("it is refused").to_string();
        assert!(error.contains("model.safetensors"), "{error}");
    }
}

#[test]
fn a_header_with_a_false_length_is_refused_without_allocating() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.safetensors");
    for size in [u64::MAX, 99_000_000, 9] {
        std::fs::write(&file, [&size.to_le_bytes()[..], b"{}"].concat()).unwrap();
        assert!(open(folder.path()).is_err());
    }
}

#[test]
fn parts_may_not_lie_outside_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["../other.safetensors", "/etc/passwd", "a/b", "..", "a\u{1b}[2J"] {
        let index = serde_json::json!({ "weight_map": { "layer.weight": name } });
        std::fs::write(folder.path().join("model.safetensors.index.json"), index.to_string()).unwrap();
        let error = open(folder.path()).err().expect("it is refused").to_string();
        assert!(error.contains("not the name of a file"), "{error}");
    }
}

#[test]
fn opening_a_folder_without_a_checkpoint_names_the_missing_file() {
    let folder = tempfile::tempdir().unwrap();
    let error = open(folder.path()).err().expect("it is refused").to_string();
    assert!(error.contains("model.safetensors") && error.contains("models fetch"), "{error}");
}
