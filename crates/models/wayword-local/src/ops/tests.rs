//! Compares each operator with candle's own, in 64 bits.

use super::*;
use candle_core::{DType, Device, Tensor};

fn random(shape: &[usize], seed: u64) -> Tensor {
    let count = shape.iter().product::<usize>() as u64;
    let draw = |at: u64| (wayword_core::seed::derive_seed(seed + at, &["ops"]) >> 40) as f32 / (1 << 23) as f32 - 1.0;
    Tensor::from_vec((0..count).map(draw).collect(), shape, &Device::Cpu).unwrap()
}

fn wide(x: &Tensor) -> Tensor {
    x.to_dtype(DType::F64).unwrap()
}

#[track_caller]
fn agree(ours: &Tensor, theirs: &Tensor, tolerance: f64) {
    assert_eq!(ours.dims(), theirs.dims());
    let off = (wide(ours) - wide(theirs)).unwrap().abs().unwrap().max_all().unwrap().to_scalar::<f64>().unwrap();
    assert!(off < tolerance, "{off}");
}

#[test]
fn a_layer_agrees_for_every_number_of_rows() {
    for (count, inputs, outputs) in [(1, 7, 5), (3, 64, 200), (50, 33, 129), (300, 96, 64)] {
        let (weight, bias) = (random(&[outputs, inputs], 1), random(&[outputs], 2));
        let x = random(&[2, count, inputs], 3);
        let ours = LinearLayer::new(&weight, Some(bias.clone())).unwrap().apply_to(&x).unwrap();
        let theirs = wide(&x).broadcast_matmul(&wide(&weight).t().unwrap()).unwrap();
        agree(&ours, &theirs.broadcast_add(&wide(&bias)).unwrap(), 1e-5);
    }
}

#[test]
fn a_layer_in_16_bits_computes_in_32() {
    for dtype in [DType::BF16, DType::F16] {
        let weight = random(&[300, 40], 1).to_dtype(dtype).unwrap();
        let x = random(&[5, 40], 3);
        let ours = LinearLayer::new(&weight, None).unwrap().apply_to(&x).unwrap();
        agree(&ours, &wide(&x).matmul(&wide(&weight).t().unwrap()).unwrap(), 1e-5);
    }
}

#[test]
fn activations_agree() {
    let x = (random(&[40_000], 5) * 8.0).unwrap();
    let cases = [Activation::Gelu, Activation::GeluTanh, Activation::QuickGelu, Activation::Relu, Activation::Silu];
    for activation in cases {
        agree(&activation.apply_to(&x).unwrap(), &activation.apply_to(&wide(&x)).unwrap(), 2e-6);
    }
}

#[test]
fn norms_agree() {
    let (x, weight, bias) = (random(&[3, 700, 48], 1), random(&[48], 2), random(&[48], 3));
    let epsilon = 1e-6;
    let wide_x = wide(&x);
    let mean = wide_x.mean_keepdim(2).unwrap();
    let off = wide_x.broadcast_sub(&mean).unwrap();
    let scaled = |off: &Tensor| {
        let variance = (off.sqr().unwrap().mean_keepdim(2).unwrap() + epsilon).unwrap();
        off.broadcast_div(&variance.sqrt().unwrap()).unwrap().broadcast_mul(&wide(&weight)).unwrap()
    };
    let ours = LayerNorm::new(weight.clone(), bias.clone(), epsilon).apply_to(&x).unwrap();
    agree(&ours, &scaled(&off).broadcast_add(&wide(&bias)).unwrap(), 1e-5);
    agree(&RmsNorm::new(weight.clone(), epsilon).apply_to(&x).unwrap(), &scaled(&wide_x), 1e-5);
}

#[test]
fn attention_agrees_with_masks_and_parts_of_a_wider_tensor() {
    let all = random(&[2, 9, 3 * 12], 1);
    let part = |at: usize| all.narrow(2, at * 12, 12).unwrap();
    let mask = causal_mask(9, 9, &Device::Cpu).unwrap();
    for bias in [None, Some(&mask)] {
        let attention = MultiHeadAttention { heads: 3, scale: 0.5, bias };
        let ours = attention.attend_to(&part(0), &part(1), &part(2)).unwrap();
        let wide_bias = bias.map(wide);
        let in_64 = MultiHeadAttention { heads: 3, scale: 0.5, bias: wide_bias.as_ref() };
        agree(&ours, &in_64.attend_to(&wide(&part(0)), &wide(&part(1)), &wide(&part(2))).unwrap(), 1e-6);
    }
}

#[test]
fn attention_over_many_keys_is_computed_in_pieces() {
    // More scores than are computed at a time, and keys that are packed for several pieces of the queries.
    for (batch, queries, keys) in [(2, 500, 500), (1, 1, 900), (1, 130, 7), (3, 97, 1)] {
        let (q, k, v) =
            (random(&[batch, queries, 12], 1), random(&[batch, keys, 12], 2), random(&[batch, keys, 12], 3));
        let mask = random(&[batch, 3, queries, keys], 4);
        for bias in [None, Some(&mask)] {
            let ours = MultiHeadAttention { heads: 3, scale: 0.5, bias }.attend_to(&q, &k, &v).unwrap();
            let wide_bias = bias.map(wide);
            let in_64 = MultiHeadAttention { heads: 3, scale: 0.5, bias: wide_bias.as_ref() };
            agree(&ours, &in_64.attend_to(&wide(&q), &wide(&k), &wide(&v)).unwrap(), 1e-5);
        }
    }
}

#[test]
fn fused_operators_agree_with_single_ones() {
    let norm = LayerNorm::new(random(&[48], 1), random(&[48], 2), 1e-5);
    for dtype in [DType::F32, DType::BF16] {
        let layer = |outputs: usize, inputs: usize, seed| {
            let weight = random(&[outputs, inputs], seed).to_dtype(dtype).unwrap();
            LinearLayer::new(&weight, Some(random(&[outputs], seed + 1))).unwrap()
        };
        let (wide, narrow) = (layer(200, 48, 3), layer(48, 200, 5));
        for count in [1, 5, 150, 431] {
            let x = random(&[1, count, 48], 7);
            let normed = norm.apply_to(&x).unwrap();
            agree(&wide.apply_to_normed(&x, &norm).unwrap(), &wide.apply_to(&normed).unwrap(), 1e-5);
            let thought = Activation::QuickGelu.apply_to(&wide.apply_to(&normed).unwrap()).unwrap();
            let one_by_one = (narrow.apply_to(&thought).unwrap() + &x).unwrap();
            agree(&narrow.apply_and_add(&thought, &x).unwrap(), &one_by_one, 1e-4);
            agree(&narrow.apply_add_and_norm(&thought, &x, &norm).unwrap(), &norm.apply_to(&one_by_one).unwrap(), 1e-4);
            let then = |before, after| {
                let activation = Activation::QuickGelu;
                FeedForward { before, wide: &wide, activation, narrow: &narrow, after }.apply_to(&x).unwrap()
            };
            agree(&then(Some(&norm), None), &one_by_one, 1e-4);
            agree(&then(Some(&norm), Some(&norm)), &norm.apply_to(&one_by_one).unwrap(), 1e-4);
            let thought = Activation::QuickGelu.apply_to(&wide.apply_to(&x).unwrap()).unwrap();
            agree(&then(None, None), &(narrow.apply_to(&thought).unwrap() + &x).unwrap(), 1e-4);
        }
    }
}

#[test]
fn causal_mask_hides_later_keys_only() {
    let mask = causal_mask(2, 3, &Device::Cpu).unwrap().to_vec2::<f32>().unwrap();
    assert_eq!(mask, [[0.0, 0.0, f32::NEG_INFINITY], [0.0, 0.0, 0.0]]);
}

#[test]
fn patches_times_a_linear_layer_equal_a_convolution() {
    let (pictures, kernel) = (random(&[2, 3, 8, 12], 1), random(&[5, 3, 4, 4], 2));
    let layer = LinearLayer::new(&kernel.reshape((5, 48)).unwrap(), None).unwrap();
    let ours = layer.apply_to(&cut_patches(&pictures, 4).unwrap()).unwrap();
    let theirs = wide(&pictures).conv2d(&wide(&kernel), 0, 4, 1, 1).unwrap();
    agree(&ours, &theirs.flatten_from(2).unwrap().transpose(1, 2).unwrap(), 1e-5);
}
