//! Compares the pass on the processor with candle's operators.

use super::*;
use candle_core::Device;

fn random(shape: &[usize], seed: u64, scale: f32) -> Tensor {
    let count = shape.iter().product::<usize>() as u64;
    let draw = |at: u64| {
        ((wayword_core::seed::derive_seed(seed + at, &["dino"]) >> 40) as f32 / (1 << 23) as f32 - 1.0) * scale
    };
    Tensor::from_vec((0..count).map(draw).collect(), shape, &Device::Cpu).unwrap()
}

#[test]
fn processor_pass_agrees_with_candles_operators() {
    let levels = [
        FeatureLevel { height: 5, width: 7 },
        FeatureLevel { height: 2, width: 3 },
        FeatureLevel { height: 1, width: 1 },
    ];
    let shape = SamplingShape { heads: 2, levels: 3, points: 2 };
    let values = random(&[35 + 6 + 1, 8], 1, 1.0);
    let boxes = [[0.1, 0.2, 0.3, 0.4], [0.99, 0.01, 1.5, 0.2], [0.5, 0.5, 0.01, 0.9]];
    for from in [SamplingOrigin::Cells, SamplingOrigin::Boxes(&boxes)] {
        let from = sampling_starts(from, &levels, shape.points);
        // Offsets of some cells, many of which lead out of the picture.
        let points = random(&[from.len(), 3 * shape.sample_count()], 7, 4.0);
        let look = DeformableSampler { shape, levels: &levels, from: &from };
        let ours = values.apply_op2_no_bwd(&points, &look).unwrap();
        let theirs = sample_on_device(shape, &values, &points, &levels, &from).unwrap();
        let off = (&ours - theirs).unwrap().abs().unwrap().max_all().unwrap().to_scalar::<f32>().unwrap();
        let most = ours.abs().unwrap().max_all().unwrap().to_scalar::<f32>().unwrap();
        assert!(off < 1e-5 && most > 0.1, "{off} of {most}");
    }
}

#[test]
fn samples_at_infinite_or_nan_positions_are_zero() {
    let level = [FeatureLevel { height: 2, width: 2 }];
    let shape = SamplingShape { heads: 1, levels: 1, points: 1 };
    let values = random(&[4, 2], 1, 1.0);
    for offset in [f32::NAN, f32::INFINITY, f32::MAX] {
        let points = Tensor::new(&[[offset, 0.0, 1.0]], &Device::Cpu).unwrap();
        let from = sampling_starts(SamplingOrigin::Boxes(&[[0.5; 4]]), &level, 1);
        let found =
            values.apply_op2_no_bwd(&points, &DeformableSampler { shape, levels: &level, from: &from }).unwrap();
        assert_eq!(found.to_vec2::<f32>().unwrap(), [[0.0, 0.0]]);
    }
}
