//! Calls the CPU kernels for matrix products, and gives them the numbers of candle's tensors as slices.

use candle_core::{CpuStorage, Layout, Result, Tensor, WithDType, bail};
use rten_gemm::{GemmExecutor, GemmInputA, GemmInputB, GemmOptions, PackedBMatrix};
use rten_tensor::NdTensorView;

thread_local! {
    /// The kernels for this CPU. They cannot be shared between threads, and making them is cheap.
    static KERNELS: GemmExecutor = GemmExecutor::default();
}

/// Options of a product `alpha * a b + beta * y + bias`.
pub(crate) type ProductOptions<'a> = GemmOptions<'a, f32, f32, f32>;

/// Writes the matrix product of a and b into y, on all threads.
pub(crate) fn write_product(
    y: &mut [f32],
    a: GemmInputA<'_, f32>,
    b: GemmInputB<'_, f32>,
    options: ProductOptions<'_>,
) -> Result<()> {
    KERNELS.with(|kernels| kernels.gemm(y, a, b, options)).map_err(candle_core::Error::wrap)
}

/// A weight [outputs, inputs], packed as the right factor of products.
pub(super) fn pack_weight(weight: &[f32], outputs: usize, inputs: usize) -> PackedBMatrix<f32> {
    pack_matrix(NdTensorView::from_data([outputs, inputs], weight).transposed())
}

/// A matrix [inputs, outputs], packed as the right factor of products.
pub(super) fn pack_matrix(matrix: NdTensorView<'_, f32, 2>) -> PackedBMatrix<f32> {
    KERNELS.with(|kernels| kernels.prepack_b(matrix))
}

/// The smallest piece of work for a thread, numbers. For less, another thread costs more time than it saves.
pub(super) const PIECE_NUMBERS: usize = 16 << 10;

/// The numbers of a contiguous tensor.
pub(crate) fn contiguous_slice<'a, T: WithDType>(storage: &'a CpuStorage, layout: &Layout) -> Result<&'a [T]> {
    let Some((from, to)) = layout.contiguous_offsets() else { bail!("a tensor is not contiguous") };
    let all = storage.as_slice::<T>()?;
    match all.get(from..to) {
        Some(slice) => Ok(slice),
        None => bail!("a tensor has fewer numbers than its shape"),
    }
}

/// The number of rows of a tensor, and their length, which is that of the last axis.
pub(super) fn row_shape(layout: &Layout) -> Result<(usize, usize)> {
    let dims = layout.shape().dims();
    let Some((&last, others)) = dims.split_last() else { bail!("a single number has no rows") };
    Ok((others.iter().product(), last))
}

/// Whether this crate's own operators can compute with a tensor: 32 bits on the CPU. For all others candle's operators
/// are used.
pub(crate) fn is_cpu_f32(tensor: &Tensor) -> bool {
    tensor.device().is_cpu() && tensor.dtype() == candle_core::DType::F32
}

/// The number of rows of this length that make a piece of work.
pub(super) fn rows_per_piece(row: usize) -> usize {
    (PIECE_NUMBERS / row.max(1)).max(1)
}

/// Calls `then` with the numbers of a tensor in 32 bits on the CPU.
pub(crate) fn with_f32_slice<T>(x: &Tensor, then: impl FnOnce(&[f32]) -> Result<T>) -> Result<T> {
    let x = x.contiguous()?;
    let (storage, layout) = x.storage_and_layout();
    let candle_core::Storage::Cpu(storage) = &*storage else { bail!("a tensor is on another device") };
    then(contiguous_slice::<f32>(storage, layout)?)
}
