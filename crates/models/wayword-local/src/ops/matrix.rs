//! Products of two computed matrices, and softmax over rows.

use super::kernels::{ProductOptions, is_cpu_f32, rows_per_piece, with_f32_slice, write_product};
use candle_core::{Result, Tensor, bail};
use rayon::prelude::*;
use rten_gemm::{BiasVector, GemmInputA, GemmInputB};
use rten_simd::SimdOp;
use rten_tensor::NdTensorView;
use rten_vecmath::Softmax;

/// The product of a [rows, inner] and b [inner, columns]. b may be a transposed view.
pub(crate) fn multiply_matrices(a: &Tensor, b: &Tensor) -> Result<Tensor> {
    let shape = (a.dim(0)?, b.dim(1)?);
    if !is_cpu_f32(a) {
        return a.matmul(b);
    }
    let mut y = vec![0.0; shape.0 * shape.1];
    multiply_into(&mut y, a, b, ProductOptions::default())?;
    Tensor::from_vec(y, shape, a.device())
}

/// Computes x + a b, plus a bias [columns] for each row.
pub(crate) fn add_product(x: &Tensor, a: &Tensor, b: &Tensor, bias: Option<&Tensor>) -> Result<Tensor> {
    if !is_cpu_f32(a) {
        let sum = (x + a.matmul(b)?)?;
        return bias.map_or(Ok(sum.clone()), |bias| sum.broadcast_add(bias));
    }
    let mut y = with_f32_slice(x, |x| Ok(x.to_vec()))?;
    let options = ProductOptions { beta: 1.0, ..ProductOptions::default() };
    match bias {
        None => multiply_into(&mut y, a, b, options)?,
        Some(bias) => {
            with_f32_slice(bias, |bias| {
                multiply_into(&mut y, a, b, ProductOptions { bias: Some(BiasVector::Row(bias)), ..options })
            })?;
        }
    }
    Tensor::from_vec(y, x.shape(), x.device())
}

/// Writes the product of a [rows, inner] and b [inner, columns] into y.
fn multiply_into(y: &mut [f32], a: &Tensor, b: &Tensor, options: ProductOptions<'_>) -> Result<()> {
    let ((rows, inner), (b_inner, columns)) = (a.dims2()?, b.dims2()?);
    if inner != b_inner {
        bail!("matrices {:?} and {:?} do not fit together", a.shape(), b.shape());
    }
    // A transposed view is read in the order in which its memory lies, without a copy.
    let is_turned = b.t()?.is_contiguous() && !b.is_contiguous();
    let stored = if is_turned { b.t()? } else { b.contiguous()? };
    with_f32_slice(a, |a| {
        with_f32_slice(&stored, |b| {
            let a = GemmInputA::Unpacked(NdTensorView::from_data([rows, inner], a));
            let b = match is_turned {
                true => NdTensorView::from_data([columns, inner], b).transposed(),
                false => NdTensorView::from_data([inner, columns], b),
            };
            write_product(y, a, GemmInputB::Unpacked(b), options)
        })
    })
}

/// Softmax over the last axis.
pub(crate) fn softmax_rows(x: &Tensor) -> Result<Tensor> {
    if !is_cpu_f32(x) {
        return candle_nn::ops::softmax_last_dim(&x.contiguous()?);
    }
    let row = x.dim(candle_core::D::Minus1)?.max(1);
    let mut y = with_f32_slice(x, |x| Ok(x.to_vec()))?;
    y.par_chunks_mut(row * rows_per_piece(row)).for_each(|rows| {
        for row in rows.chunks_exact_mut(row) {
            Softmax::new_mut(row).dispatch();
        }
    });
    Tensor::from_vec(y, x.shape(), x.device())
}

#[cfg(test)]
mod tests {
    use super::*;
    use candle_core::Device;

    fn drawn(shape: &[usize], seed: u64) -> Tensor {
        let draw =
            |at: u64| (wayword_core::seed::derive_seed(seed + at, &["matrix"]) >> 40) as f32 / (1 << 23) as f32 - 1.0;
        let count = shape.iter().product::<usize>() as u64;
        Tensor::from_vec((0..count).map(draw).collect(), shape, &Device::Cpu).unwrap()
    }

    fn agree(ours: &Tensor, theirs: &Tensor) {
        assert_eq!(ours.dims(), theirs.dims());
        let off = (ours - theirs).unwrap().abs().unwrap().max_all().unwrap().to_scalar::<f32>().unwrap();
        assert!(off < 1e-5, "{off}");
    }

    #[test]
    fn products_and_softmax_agree_with_candle() {
        let (a, b, turned) = (drawn(&[70, 33], 1), drawn(&[33, 40], 2), drawn(&[40, 33], 3));
        agree(&multiply_matrices(&a, &b).unwrap(), &a.matmul(&b).unwrap());
        agree(&multiply_matrices(&a, &turned.t().unwrap()).unwrap(), &a.matmul(&turned.t().unwrap()).unwrap());
        let (x, bias) = (drawn(&[70, 40], 4), drawn(&[40], 5));
        let sum = (&x + a.matmul(&b).unwrap()).unwrap();
        agree(&add_product(&x, &a, &b, None).unwrap(), &sum);
        agree(&add_product(&x, &a, &b, Some(&bias)).unwrap(), &sum.broadcast_add(&bias).unwrap());
        assert!(multiply_matrices(&a, &turned).is_err());
        let x = drawn(&[3, 50, 7], 6);
        agree(&softmax_rows(&x).unwrap(), &candle_nn::ops::softmax_last_dim(&x).unwrap());
    }
}
