//! Compares the backbone with transformers (`fixtures/make_swin.py`), and tests windows and sizes.

use super::*;
use crate::{ModelDevice, WeightPrecision, weights::CheckpointWeights};
use candle_core::safetensors;
use std::path::PathBuf;

fn fixture() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/swin")
}

/// The configuration of `fixtures/make_swin.py`.
fn config() -> SwinConfig {
    SwinConfig { width: 4, depths: vec![2, 2, 2, 1], heads: vec![1, 2, 2, 4], window: 3, ..SwinConfig::for_swin_tiny() }
}

fn load(config: &SwinConfig) -> std::result::Result<SwinBackbone, LocalError> {
    let weights = CheckpointWeights::open(&fixture(), &ModelDevice::cpu(), WeightPrecision::F32)?;
    SwinBackbone::from_weights(&weights.scope_under(""), &SwinTensorNames::TRANSFORMERS, config)
}

fn off(ours: &Tensor, theirs: &Tensor) -> f32 {
    assert_eq!(ours.dims(), theirs.dims());
    (ours - theirs).unwrap().abs().unwrap().max_all().unwrap().to_scalar().unwrap()
}

#[test]
fn every_map_is_that_of_transformers() {
    let expected = safetensors::load(fixture().join("expected.safetensors"), &candle_core::Device::Cpu).unwrap();
    let maps = load(&config()).unwrap().extract_features(&expected["pixels"]).unwrap();
    assert_eq!(maps.len(), 3);
    for (at, map) in maps.iter().enumerate() {
        let off = off(map, &expected[&format!("map{at}")]);
        assert!(off < 1e-5, "map {at}: {off}");
    }
}

#[test]
fn candles_operators_give_the_same_block() {
    let swin = load(&config()).unwrap();
    let positions = Tensor::arange(0_f32, 4.0 * 7.0 * 11.0, &candle_core::Device::Cpu).unwrap();
    let x = (positions.sin().unwrap()).reshape((77, 4)).unwrap();
    for by in [0, 1] {
        let windows = MapWindows::new(7, 11, 3, by);
        let block = &swin.stages[0].blocks[0];
        let ours = block.apply_to(&x.reshape((1, 7, 11, 4)).unwrap(), &windows).unwrap().reshape((77, 4)).unwrap();
        let off = off(&ours, &block.apply_on_device(&x, &windows).unwrap());
        assert!(off < 1e-5, "{off}");
    }
}

#[test]
fn windows_contain_each_position_once_and_separate_distant_cells() {
    let windows = MapWindows::new(5, 4, 3, 1);
    assert_eq!((windows.window_count(), windows.size), (4, 9));
    for (position, &place) in windows.places.iter().enumerate() {
        assert_eq!(windows.positions[place as usize], position as u32);
    }
    let padding = windows.positions.iter().filter(|&&position| position == MapWindows::PADDING_POSITION).count();
    assert_eq!(padding, 36 - 20);
    assert!(windows.window_regions(0).is_none() && windows.window_regions(3).is_some());
    // A map that is a single window is moved too, as in the original.
    let one = MapWindows::new(3, 3, 3, 1);
    assert_eq!(one.positions, [4, 5, 3, 7, 8, 6, 1, 2, 0]);
    assert_eq!(one.regions, [4, 4, 5, 4, 4, 5, 7, 7, 8]);
}

#[test]
fn config_reports_impossible_sizes() {
    for (change, told) in [
        (SwinConfig { heads: vec![1, 2, 2, 3], ..config() }, "heads: 3"),
        (SwinConfig { heads: vec![1], ..config() }, "1 stages"),
        (SwinConfig { window: 0, ..config() }, "window: 0"),
        (SwinConfig { window: 1 << 19, ..config() }, "window, widening"),
        (SwinConfig { depths: vec![1, 1, 65, 1], ..config() }, "depths: 65"),
        (SwinConfig { outputs: vec![4], ..config() }, "no stage 4"),
    ] {
        assert!(change.find_problem().is_some_and(|problem| problem.contains(told)), "{told}");
    }
    assert_eq!(config().find_problem(), None);
    assert_eq!(SwinConfig::for_swin_tiny().find_problem(), None);
}

#[test]
fn another_configuration_is_refused_by_tensor() {
    for (change, told) in [
        (SwinConfig { width: 8, ..config() }, "embeddings.patch_embeddings.projection.weight"),
        (SwinConfig { window: 4, ..config() }, "relative_position_bias_table"),
        (SwinConfig { depths: vec![2, 3, 2, 1], ..config() }, "encoder.layers.1.blocks.2."),
        (SwinConfig { outputs: vec![0], ..config() }, "hidden_states_norms.stage1"),
    ] {
        let error = load(&change).err().expect("it is refused").to_string();
        assert!(error.contains(told) && error.contains("model.safetensors"), "{error}");
    }
}
