//! Compares plain and deformed convolutions with candle's, and tests the reading of offsets.

use super::*;
use candle_core::Device;

fn drawn(shape: &[usize], seed: u64) -> Tensor {
    let draw = |at: u64| (wayword_core::seed::derive_seed(seed + at, &["conv"]) >> 40) as f32 / (1 << 23) as f32 - 1.0;
    let count = shape.iter().product::<usize>() as u64;
    Tensor::from_vec((0..count).map(draw).collect(), shape, &Device::Cpu).unwrap()
}

fn conv() -> (Conv3Layer, Tensor, Tensor) {
    let (kernel, bias) = (drawn(&[5, 4, 3, 3], 1), drawn(&[5], 2));
    let rows = kernel.permute((0, 2, 3, 1)).unwrap().contiguous().unwrap().flatten_from(1).unwrap();
    let linear = LinearLayer::new(&rows, Some(bias.clone())).unwrap();
    (Conv3Layer { linear, inputs: 4, outputs: 5 }, kernel, bias)
}

fn off(a: &Tensor, b: &Tensor) -> f32 {
    assert_eq!(a.dims(), b.dims());
    (a - b).unwrap().abs().unwrap().max_all().unwrap().to_scalar().unwrap()
}

#[test]
fn plain_convolution_agrees_with_candle() {
    let (conv, kernel, bias) = conv();
    for (height, width, stride) in [(13, 9, 1), (13, 9, 2), (12, 8, 2), (1, 1, 2), (1, 2, 1)] {
        let x = drawn(&[height * width, 4], 3);
        let ours = conv.convolve_plain(&FeatureMap { x: x.clone(), height, width }, stride).unwrap();
        let image = x.t().unwrap().contiguous().unwrap().reshape((1, 4, height, width)).unwrap();
        let theirs = image.conv2d(&kernel, 1, stride, 1, 1).unwrap();
        let theirs = theirs.flatten_from(2).unwrap().squeeze(0).unwrap().t().unwrap();
        assert!(off(&ours.x, &theirs.broadcast_add(&bias).unwrap()) < 1e-5);
    }
}

#[test]
fn offsets_of_whole_positions_are_a_moved_map() {
    let (conv, ..) = conv();
    let (height, width) = (7, 6);
    let x = drawn(&[42, 4], 5);
    // All taps read one row further down, and rows below the map are 0. The sigmoid of a mask of 40 is 1.
    let bends: Vec<f32> = (0..42 * OFFSET_NUMBERS_PER_POSITION)
        .map(|at| {
            [1.0, 0.0, 40.0]
                [if at % OFFSET_NUMBERS_PER_POSITION < 18 { at % OFFSET_NUMBERS_PER_POSITION % 2 } else { 2 }]
        })
        .collect();
    let bends = Tensor::from_vec(bends, (42, OFFSET_NUMBERS_PER_POSITION), &Device::Cpu).unwrap();
    let bends = TapOffsets::new(&FeatureMap { x: bends, height, width }).unwrap();
    let ours = conv.convolve_deformed(&FeatureMap { x: x.clone(), height, width }, 1, &bends).unwrap();
    let moved = x.narrow(0, width, 36).unwrap().pad_with_zeros(0, 0, width).unwrap();
    let plain = conv.convolve_plain(&FeatureMap { x: moved, height, width }, 1).unwrap();
    // In the first row the plain convolution of the moved map lacks the row that left it.
    let rest = |map: &FeatureMap| map.x.narrow(0, width, 36).unwrap();
    assert!(off(&rest(&ours), &rest(&plain)) < 1e-5);
}

#[test]
fn candles_operators_give_the_same_convolution() {
    let (conv, ..) = conv();
    let (height, width) = (9, 7);
    let map = FeatureMap { x: drawn(&[63, 4], 7), height, width };
    for (stride, shape) in [(1, (9, 7)), (2, (5, 4)), (1, (18, 14))] {
        let bends = (drawn(&[shape.0 * shape.1, OFFSET_NUMBERS_PER_POSITION], 9) * 3.0).unwrap();
        let bends = TapOffsets::new(&FeatureMap { x: bends, height: shape.0, width: shape.1 }).unwrap();
        let ours = conv.convolve_deformed(&map, stride, &bends).unwrap();
        let size = map.size_after(stride);
        let corners = |position: usize, tap: usize| {
            let (y, x) = tap_place(position, tap, size.1, stride);
            let (down, across, mask) = bends.tap_offset(size, position, tap);
            corners_around(y as f32 + down, x as f32 + across, mask, &map)
        };
        let theirs = conv.linear.apply_to(&gather_taps_on_device(&map, size.0 * size.1, 4, corners).unwrap()).unwrap();
        assert!(off(&ours.x, &theirs) < 1e-5);
    }
}

#[test]
fn offsets_of_another_size_are_read_as_memory() {
    // Each number is its place in memory: channel by channel, 18 channels of 2 x 3, then 9 of masks.
    let memory = |position: usize, channel: usize| match channel {
        0..18 => (channel * 6 + position) as f32,
        _ => ((channel - 18) * 6 + position) as f32 / 1000.0,
    };
    let numbers = (0..6 * OFFSET_NUMBERS_PER_POSITION)
        .map(|at| memory(at / OFFSET_NUMBERS_PER_POSITION, at % OFFSET_NUMBERS_PER_POSITION))
        .collect();
    let bends = TapOffsets { numbers, height: 2, width: 3 };
    for (position, tap) in [(0, 0), (1, 4), (0, 8)] {
        let (down, across, mask) = bends.tap_offset((1, 2), position, tap);
        assert_eq!(down, (2 * tap * 2 + position) as f32);
        assert_eq!(across, ((2 * tap + 1) * 2 + position) as f32);
        assert_eq!(mask, (tap * 2 + position) as f32 / 1000.0);
    }
}

#[test]
fn offsets_far_away_or_without_a_value_do_no_harm() {
    let (conv, ..) = conv();
    let map = FeatureMap { x: drawn(&[6, 4], 7), height: 2, width: 3 };
    for number in [1e30, -1e30, f32::INFINITY, f32::NAN] {
        let bends = Tensor::full(number, (6, OFFSET_NUMBERS_PER_POSITION), &Device::Cpu).unwrap();
        let bends = TapOffsets::new(&FeatureMap { x: bends, height: 2, width: 3 }).unwrap();
        assert_eq!(conv.convolve_deformed(&map, 1, &bends).unwrap().x.dims(), [6, 5]);
    }
}
