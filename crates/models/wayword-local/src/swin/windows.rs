//! Divides the positions of a map into windows. A position is a cell of the map; a place is a cell of a window.

/// The windows of a map, and where each position lies in them.
pub(super) struct MapWindows {
    /// For each place of each window, the position on the map, rows from the top; [`MapWindows::PADDING_POSITION`] for
    /// padding.
    pub(super) positions: Vec<u32>,
    /// For each position on the map, its place in the windows.
    pub(super) places: Vec<u32>,
    /// The region of each place. When windows are shifted, those at the edge contain cells from opposite sides of the
    /// map. These cells have different regions, and do not see each other. Empty if windows are not shifted.
    pub(super) regions: Vec<u8>,
    /// The number of places of a window.
    pub(super) size: usize,
}

impl MapWindows {
    /// Marks a place that is padding, instead of a position.
    pub(super) const PADDING_POSITION: u32 = u32::MAX;

    /// Windows of `edge` x `edge` positions. The map is padded at the right and at the bottom to whole windows, and
    /// then moved up and left by `shift` positions. Cells that leave the map come in on the other side.
    pub(super) fn new(height: usize, width: usize, edge: usize, shift: usize) -> Self {
        let (down, across) = (height.div_ceil(edge), width.div_ceil(edge));
        let (padded_height, padded_width) = (down * edge, across * edge);
        let region = |at: usize, padded: usize| u8::from(at >= padded - edge) + u8::from(at >= padded - shift);
        let count = padded_height * padded_width;
        let (mut positions, mut regions) = (Vec::with_capacity(count), Vec::new());
        let mut places = vec![0; height * width];
        for window in 0..down * across {
            for place in 0..edge * edge {
                let row = window / across * edge + place / edge;
                let column = window % across * edge + place % edge;
                let (y, x) = ((row + shift) % padded_height, (column + shift) % padded_width);
                if shift > 0 {
                    regions.push(region(row, padded_height) * 3 + region(column, padded_width));
                }
                if y < height && x < width {
                    places[y * width + x] = positions.len() as u32;
                    positions.push((y * width + x) as u32);
                } else {
                    positions.push(Self::PADDING_POSITION);
                }
            }
        }
        Self { positions, places, regions, size: edge * edge }
    }

    /// The number of windows.
    pub(super) fn window_count(&self) -> usize {
        self.positions.len() / self.size.max(1)
    }

    /// The regions of the places of a window. `None` if all are neighbours on the map.
    pub(super) fn window_regions(&self, window: usize) -> Option<&[u8]> {
        let regions = self.regions.get(window * self.size..(window + 1) * self.size)?;
        regions.iter().any(|region| *region != regions[0]).then_some(regions)
    }
}

/// For each pair of places of a window (query, then key), its row in the table of biases. The rows are ordered by the
/// distance downwards, then by the distance to the right, each from `1 - edge` to `edge - 1`.
pub(super) fn bias_rows(edge: usize) -> Vec<usize> {
    let size = edge * edge;
    let row = |pair: usize| {
        let (query, key) = (pair / size, pair % size);
        let down = query / edge + edge - 1 - key / edge;
        let across = query % edge + edge - 1 - key % edge;
        down * (2 * edge - 1) + across
    };
    (0..size * size).map(row).collect()
}
