//! Encodes positions as sines and cosines of many wave lengths, so that a linear layer can compare near and far ones.

use std::f32::consts::TAU;

/// The ratio of the longest to the shortest wave length, for tokens and boxes.
const TOKEN_TEMPERATURE: f32 = 10_000.0;

/// The wave lengths of `count` numbers. Each is there twice, for a sine and a cosine. The longest is nearly
/// `temperature` times the shortest.
fn wave_lengths(count: usize, temperature: f32) -> Vec<f32> {
    (0..count).map(|at| temperature.powf(2.0 * (at / 2) as f32 / count as f32)).collect()
}

/// Writes the sine and the cosine of a phase for each pair of wave lengths.
fn write_waves(phase: f32, lengths: &[f32], to: &mut [f32]) {
    for (at, (number, length)) in to.iter_mut().zip(lengths).enumerate() {
        let angle = phase / length;
        *number = if at % 2 == 0 { libm::sinf(angle) } else { libm::cosf(angle) };
    }
}

/// The positions of the cells of a map, row by row, `size` numbers each: first those of the row, then of the column.
pub(super) fn map_positions(height: usize, width: usize, size: usize, temperature: f32) -> Vec<f32> {
    // As in transformers, so that no division is by 0.
    const POSITION_EPSILON: f32 = 1e-6;
    let lengths = wave_lengths(size / 2, temperature);
    let axis_waves = |count: usize| -> Vec<Vec<f32>> {
        let at = |at: usize| {
            let mut numbers = vec![0.0; size / 2];
            write_waves((at + 1) as f32 / (count as f32 + POSITION_EPSILON) * TAU, &lengths, &mut numbers);
            numbers
        };
        (0..count).map(at).collect()
    };
    let (rows, columns) = (axis_waves(height), axis_waves(width));
    let mut all = Vec::with_capacity(height * width * size);
    for row in &rows {
        for column in &columns {
            all.extend_from_slice(row);
            all.extend_from_slice(column);
        }
    }
    all
}

/// The positions of tokens within their phrases, `size` numbers each.
pub(super) fn token_positions(places: &[u32], size: usize) -> Vec<f32> {
    let lengths = wave_lengths(size, TOKEN_TEMPERATURE);
    let mut all = vec![0.0; places.len() * size];
    for (numbers, &place) in all.chunks_mut(size.max(1)).zip(places) {
        write_waves(place as f32 * TAU, &lengths, numbers);
    }
    all
}

/// The positions of boxes (middle, width and height), `2 * size` numbers each, in the order y, x, width, height.
pub(super) fn box_positions(boxes: &[[f32; 4]], size: usize) -> Vec<f32> {
    let each = size / 2;
    let lengths = wave_lengths(each, TOKEN_TEMPERATURE);
    let mut all = vec![0.0; boxes.len() * 4 * each];
    for (numbers, &[x, y, width, height]) in all.chunks_mut(4 * each.max(1)).zip(boxes) {
        for (numbers, edge) in numbers.chunks_mut(each.max(1)).zip([y, x, width, height]) {
            write_waves(edge * TAU, &lengths, numbers);
        }
    }
    all
}
