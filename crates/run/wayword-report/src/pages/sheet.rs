//! Converts world coordinates to places on a map: metres to units of the drawing, north up.

/// The limits of a sheet, in units of the drawing.
pub(crate) struct SheetLimits {
    /// Largest width and height of the sheet.
    pub(crate) most: [f64; 2],
    /// Smallest width and height of the sheet, so that north arrow and scale bar fit.
    pub(crate) least: [f64; 2],
    /// Room for signs around the drawing.
    pub(crate) padding: f64,
    /// How much of the scene is shown around the drawn places, metres.
    pub(crate) margin_m: f64,
    /// Most units per metre, so that a short path is not drawn huge.
    pub(crate) most_scale: f64,
}

/// The conversion from world coordinates to a sheet.
pub(crate) struct MapSheet {
    /// Units per metre.
    pub(crate) scale: f64,
    /// The sheet's upper left corner in world coordinates, metres.
    corner: [f64; 2],
    pub(crate) size: [f64; 2],
}

/// Longest scale bar, units.
const MAX_BAR_UNITS: f64 = 90.0;

impl MapSheet {
    /// The sheet for places in world coordinates, metres; `None` if there are none, or they are too far apart for
    /// numbers.
    pub(crate) fn around_points(points: impl Iterator<Item = [f64; 2]>, paper: &SheetLimits) -> Option<Self> {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        for axis in 0..2 {
            low[axis] -= paper.margin_m;
            high[axis] += paper.margin_m;
        }
        let span = [high[0] - low[0], high[1] - low[1]];
        if !span.iter().all(|span| span.is_finite()) {
            return None;
        }
        let fits = |axis: usize| (paper.most[axis] - 2.0 * paper.padding) / span[axis];
        let scale = fits(0).min(fits(1)).min(paper.most_scale);
        let size = [0, 1].map(|axis| round_to_tenth((span[axis] * scale + 2.0 * paper.padding).max(paper.least[axis])));
        let margin_m = [0, 1].map(|axis| (size[axis] / scale - span[axis]) / 2.0);
        Some(Self { scale, corner: [low[0] - margin_m[0], high[1] + margin_m[1]], size })
    }

    /// The place of world coordinates on the sheet.
    pub(crate) fn place_point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [round_to_tenth((x - self.corner[0]) * self.scale), round_to_tenth((self.corner[1] - y) * self.scale)]
    }

    /// The scale bar: its length in units, and in metres.
    pub(crate) fn scale_bar(&self) -> (f64, u32) {
        let bars = [1, 2, 5, 10, 20, 50, 100, 200, 500];
        let bar_m = bars.into_iter().rfind(|m| f64::from(*m) * self.scale <= MAX_BAR_UNITS).unwrap_or(1);
        (round_to_tenth(f64::from(bar_m) * self.scale), bar_m)
    }
}

/// Rounded to tenths of a unit.
pub(crate) fn round_to_tenth(units: f64) -> f64 {
    (units * 10.0).round() / 10.0
}
