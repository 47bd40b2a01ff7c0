//! How the positions of a map are put into windows.

/// The windows of a map, and where each position lies in them.
pub(super) struct Windows {
    /// For each place of each window, the position on the map, rows from the top; [`Windows::PAD`] for padding.
    pub(super) positions: Vec<u32>,
    /// For each position on the map, its place in the windows.
    pub(super) places: Vec<u32>,
    /// For each place, its region. Places of one window that are of different regions are not neighbours on the map,
    /// and do not see each other. Empty where all are neighbours.
    pub(super) regions: Vec<u8>,
    /// Places of a window.
    pub(super) size: usize,
}

impl Windows {
    /// Instead of a position: padding.
    pub(super) const PAD: u32 = u32::MAX;

    /// Windows of `edge` x `edge` positions of a map that is padded on the right and at the bottom to whole windows, and
    /// then moved up and left by `by` positions. What leaves the map comes in on the other side.
    pub(super) fn new(height: usize, width: usize, edge: usize, by: usize) -> Self {
        let (down, across) = (height.div_ceil(edge), width.div_ceil(edge));
        let (padded_height, padded_width) = (down * edge, across * edge);
        let region = |at: usize, padded: usize| u8::from(at >= padded - edge) + u8::from(at >= padded - by);
        let count = padded_height * padded_width;
        let (mut positions, mut regions) = (Vec::with_capacity(count), Vec::new());
        let mut places = vec![0; height * width];
        for window in 0..down * across {
            for place in 0..edge * edge {
                let row = window / across * edge + place / edge;
                let column = window % across * edge + place % edge;
                let (y, x) = ((row + by) % padded_height, (column + by) % padded_width);
                if by > 0 {
                    regions.push(region(row, padded_height) * 3 + region(column, padded_width));
                }
                if y < height && x < width {
                    places[y * width + x] = positions.len() as u32;
                    positions.push((y * width + x) as u32);
                } else {
                    positions.push(Self::PAD);
                }
            }
        }
        Self { positions, places, regions, size: edge * edge }
    }

    /// How many windows there are.
    pub(super) fn count(&self) -> usize {
        self.positions.len() / self.size.max(1)
    }

    /// The regions of the places of a window; none where all are neighbours.
    pub(super) fn regions_of(&self, window: usize) -> Option<&[u8]> {
        let regions = self.regions.get(window * self.size..(window + 1) * self.size)?;
        regions.iter().any(|region| *region != regions[0]).then_some(regions)
    }
}

/// For each pair of places of a window (query, then key), the row of the table of biases: the rows are ordered by the
/// distance downwards, then by the distance to the right, each from `1 - edge` to `edge - 1`.
pub(super) fn distances(edge: usize) -> Vec<usize> {
    let size = edge * edge;
    let row = |pair: usize| {
        let (query, key) = (pair / size, pair % size);
        let down = query / edge + edge - 1 - key / edge;
        let across = query % edge + edge - 1 - key % edge;
        down * (2 * edge - 1) + across
    };
    (0..size * size).map(row).collect()
}
