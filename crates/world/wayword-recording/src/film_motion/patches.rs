//! Small patches of one panorama, and how well each agrees with every place of another.
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "counts and places of a panorama of a hundred pixels"
)]
#![expect(clippy::indexing_slicing, reason = "sums over windows in the hot loop; windows are kept inside the panorama")]

use super::panorama::{PANORAMA_COLUMNS, PicturePanorama};

/// Pixels on each side of a patch's middle.
pub(super) const RADIUS: usize = 4;
/// Pixels along a side of a patch.
const SIDE: usize = 2 * RADIUS + 1;
/// Rows above and below a patch's own in which it is looked for.
pub(super) const ROW_REACH: usize = 12;
/// A patch is also looked for enlarged by this much, as things are that come nearer.
pub(super) const ENLARGED: f64 = 1.3;
/// Each square of this many pixels gives one patch.
const CELL: usize = 8;
/// Most patches of a panorama.
const MOST_PATCHES: usize = 72;
/// Contrast of a patch along its row below which it is noise, grey values.
const LEAST_CONTRAST: f32 = 2.5;
/// Added to variances: what noise makes of a flat wall must not agree with anything.
const NOISE_VARIANCE: f32 = 6.0;
/// Places in a row where a patch fits.
const WIDTH: usize = PANORAMA_COLUMNS - 2 * RADIUS;
/// The agreement at a place that the picture does not show.
pub(super) const UNSEEN: f32 = -2.0;

/// Where a patch agrees with another panorama.
#[derive(Debug, Clone)]
pub(super) struct PicturePatch {
    /// Column of its middle.
    pub(super) column: usize,
    /// Row of its middle.
    pub(super) row: usize,
    /// Agreement of the patch as it is.
    pub(super) plain: PatchAgreement,
    /// Agreement of the enlarged patch.
    pub(super) enlarged: PatchAgreement,
}

/// Correlations of a patch with the places of a panorama, from -1 to 1.
#[derive(Debug, Clone)]
pub(super) struct PatchAgreement {
    first_row: usize,
    rows: usize,
    values: Vec<f32>,
    /// The best of each place and its eight neighbours.
    best_near: Vec<f32>,
}

impl PatchAgreement {
    /// The agreement at a place; [`UNSEEN`] outside.
    pub(super) fn at(&self, column: isize, row: isize) -> f32 {
        self.place(column, row).map_or(UNSEEN, |at| self.values[at])
    }

    /// The best agreement at a place and its neighbours.
    pub(super) fn best_near(&self, column: isize, row: isize) -> f32 {
        self.place(column, row).map_or(UNSEEN, |at| self.best_near[at])
    }

    fn place(&self, column: isize, row: isize) -> Option<usize> {
        let row = usize::try_from(row).ok()?.checked_sub(self.first_row)?;
        let column = usize::try_from(column).ok().filter(|&column| column < PANORAMA_COLUMNS)?;
        (row < self.rows).then_some(row * PANORAMA_COLUMNS + column)
    }
}

/// The patches of `from`, looked for in `to`.
pub(super) fn matched_patches(from: &PicturePanorama, to: &PicturePanorama) -> Vec<PicturePatch> {
    let windows = PatchWindows::of(to);
    let look = |column, row, zoom| {
        let template = PatchTemplate::cut(from, column, row, zoom);
        windows.agreement(to, &template, row)
    };
    let places = textured_places(from);
    places
        .into_iter()
        .map(|(column, row)| PicturePatch {
            column,
            row,
            plain: look(column, row, 1.0),
            enlarged: look(column, row, ENLARGED),
        })
        .collect()
}

/// The place with the most contrast along its row in each square of the panorama; the strongest of these.
fn textured_places(panorama: &PicturePanorama) -> Vec<(usize, usize)> {
    let mut places: Vec<(f32, usize, usize)> = Vec::new();
    for top in (RADIUS..panorama.rows.saturating_sub(RADIUS)).step_by(CELL) {
        for left in (RADIUS..PANORAMA_COLUMNS - RADIUS).step_by(CELL) {
            let rows = top..(top + CELL).min(panorama.rows - RADIUS);
            let best = rows
                .flat_map(|row| (left..(left + CELL).min(PANORAMA_COLUMNS - RADIUS)).map(move |column| (column, row)))
                .filter(|&(column, row)| is_all_seen(panorama, column, row))
                .map(|(column, row)| (contrast(panorama, column, row), column, row))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            places.extend(best.filter(|best| best.0 >= LEAST_CONTRAST));
        }
    }
    places.sort_by(|a, b| b.0.total_cmp(&a.0));
    places.into_iter().take(MOST_PATCHES).map(|(_, column, row)| (column, row)).collect()
}

/// Whether the four corners of a patch are seen, and so all of it.
fn is_all_seen(panorama: &PicturePanorama, column: usize, row: usize) -> bool {
    let seen = |column: usize, row: usize| panorama.is_seen[row * PANORAMA_COLUMNS + column];
    let (left, right, top, bottom) = (column - RADIUS, column + RADIUS, row - RADIUS, row + RADIUS);
    seen(left, top) && seen(right, top) && seen(left, bottom) && seen(right, bottom)
}

/// Root mean square of the differences along the rows of a patch's inner part.
fn contrast(panorama: &PicturePanorama, column: usize, row: usize) -> f32 {
    let mut sum = 0.0;
    for y in row - 2..=row + 2 {
        for x in column - 2..=column + 2 {
            let at = y * PANORAMA_COLUMNS + x;
            sum += (panorama.values[at + 1] - panorama.values[at - 1]).powi(2);
        }
    }
    (sum / 25.0).sqrt() / 2.0
}

/// A patch without its mean, and its variance.
struct PatchTemplate {
    values: [f32; SIDE * SIDE],
    variance: f32,
}

impl PatchTemplate {
    /// Cuts a patch out, enlarged.
    fn cut(panorama: &PicturePanorama, column: usize, row: usize, zoom: f64) -> Self {
        let mut values = [0.0; SIDE * SIDE];
        for (at, value) in values.iter_mut().enumerate() {
            let offset = |at: usize| (at as f64 - RADIUS as f64) / zoom;
            *value = between_pixels(panorama, column as f64 + offset(at % SIDE), row as f64 + offset(at / SIDE));
        }
        let count = values.len() as f32;
        let mean = values.iter().sum::<f32>() / count;
        for value in &mut values {
            *value -= mean;
        }
        let variance = values.iter().map(|value| value * value).sum::<f32>() / count;
        Self { values, variance }
    }
}

/// The value at a place between pixels, at least a pixel inside the panorama.
#[expect(clippy::cast_sign_loss, reason = "places of patches lie inside")]
fn between_pixels(panorama: &PicturePanorama, x: f64, y: f64) -> f32 {
    let (column, row) = ((x as usize).min(PANORAMA_COLUMNS - 2), (y as usize).min(panorama.rows - 2));
    let (share_x, share_y) = ((x - column as f64) as f32, (y - row as f64) as f32);
    let at = row * PANORAMA_COLUMNS + column;
    let upper = panorama.values[at] * (1.0 - share_x) + panorama.values[at + 1] * share_x;
    let lower =
        panorama.values[at + PANORAMA_COLUMNS] * (1.0 - share_x) + panorama.values[at + PANORAMA_COLUMNS + 1] * share_x;
    upper * (1.0 - share_y) + lower * share_y
}

/// What the windows of a panorama have in common for all patches: 1 / standard deviation, and 0 where not seen.
struct PatchWindows {
    inverse_deviation: Vec<f32>,
}

impl PatchWindows {
    fn of(panorama: &PicturePanorama) -> Self {
        let mut inverse_deviation = vec![0.0; panorama.rows * PANORAMA_COLUMNS];
        for row in RADIUS..panorama.rows.saturating_sub(RADIUS) {
            for column in RADIUS..PANORAMA_COLUMNS - RADIUS {
                if !is_all_seen(panorama, column, row) {
                    continue;
                }
                let (mut sum, mut squares) = (0.0, 0.0);
                for y in row - RADIUS..=row + RADIUS {
                    let start = y * PANORAMA_COLUMNS + column - RADIUS;
                    for value in &panorama.values[start..start + SIDE] {
                        sum += value;
                        squares += value * value;
                    }
                }
                let count = (SIDE * SIDE) as f32;
                let variance = (squares / count - (sum / count).powi(2)).max(0.0);
                inverse_deviation[row * PANORAMA_COLUMNS + column] = 1.0 / (variance + NOISE_VARIANCE).sqrt();
            }
        }
        Self { inverse_deviation }
    }

    /// The correlation of a patch from `row` with the windows of the rows around it.
    fn agreement(&self, to: &PicturePanorama, template: &PatchTemplate, row: usize) -> PatchAgreement {
        let first_row = row.saturating_sub(ROW_REACH).max(RADIUS);
        let rows = (row + ROW_REACH + 1).min(to.rows - RADIUS).saturating_sub(first_row);
        let mut values = vec![UNSEEN; rows * PANORAMA_COLUMNS];
        let scale = 1.0 / ((template.variance + NOISE_VARIANCE).sqrt() * (SIDE * SIDE) as f32);
        for (at, line) in values.chunks_exact_mut(PANORAMA_COLUMNS).enumerate() {
            let mut sums = [0.0_f32; WIDTH];
            for (part, weight) in template.values.iter().enumerate() {
                let start = (first_row + at + part / SIDE - RADIUS) * PANORAMA_COLUMNS + part % SIDE;
                for (sum, value) in sums.iter_mut().zip(&to.values[start..start + WIDTH]) {
                    *sum += weight * value;
                }
            }
            let deviations = &self.inverse_deviation[(first_row + at) * PANORAMA_COLUMNS + RADIUS..][..WIDTH];
            for ((value, sum), deviation) in line[RADIUS..].iter_mut().zip(sums).zip(deviations) {
                *value = if *deviation == 0.0 { UNSEEN } else { sum * deviation * scale };
            }
        }
        let best_near = best_near(&values);
        PatchAgreement { first_row, rows, values, best_near }
    }
}

/// The best of each value and its eight neighbours; unseen stays unseen.
fn best_near(values: &[f32]) -> Vec<f32> {
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let mut across = values.to_vec();
    for (best, line) in across.chunks_exact_mut(PANORAMA_COLUMNS).zip(values.chunks_exact(PANORAMA_COLUMNS)) {
        for (best, three) in best[1..].iter_mut().zip(line.windows(3)) {
            *best = larger(three[1], larger(three[0], three[2]));
        }
    }
    let mut near = across.clone();
    for (near, above) in near.iter_mut().skip(PANORAMA_COLUMNS).zip(&across) {
        *near = larger(*near, *above);
    }
    for (near, below) in near.iter_mut().zip(across.iter().skip(PANORAMA_COLUMNS)) {
        *near = larger(*near, *below);
    }
    for (near, value) in near.iter_mut().zip(values) {
        *near = if *value == UNSEEN { UNSEEN } else { *near };
    }
    near
}
