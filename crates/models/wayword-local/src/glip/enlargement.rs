//! Enlarges a map to the size of a finer one: bilinear, with corners aligned, so that the outermost positions of both
//! maps coincide. Example: positions 0, 1, 2 become 0, 0.5, 1, 1.5, 2.

use crate::ops::conv3::FeatureMap;

/// The enlargement of one axis. For each new position: the old position before it, the old one after it, and the weight
/// of the latter.
pub(super) struct EnlargedAxis(pub(super) Vec<(usize, usize, f32)>);

impl EnlargedAxis {
    /// The enlargement from `from` positions to `to`.
    pub(super) fn new(from: usize, to: usize) -> Self {
        let step = if to > 1 { (from.saturating_sub(1)) as f32 / (to - 1) as f32 } else { 0.0 };
        let last = from.saturating_sub(1);
        let one = |at: usize| {
            let place = at as f32 * step;
            let before = (place as usize).min(last);
            (before, (before + 1).min(last), place - before as f32)
        };
        Self((0..to).map(one).collect())
    }

    /// The weight of each old position in the mean of all new ones.
    fn mean_shares(&self, from: usize) -> Vec<f64> {
        let mut shares = vec![0.0; from];
        for &(before, behind, share) in &self.0 {
            shares[before] += f64::from(1.0 - share) / self.0.len() as f64;
            shares[behind] += f64::from(share) / self.0.len() as f64;
        }
        shares
    }
}

/// The enlargement of a map.
pub(super) struct MapEnlargement {
    down: EnlargedAxis,
    across: EnlargedAxis,
    /// The width of the old map, positions.
    width: usize,
}

impl MapEnlargement {
    pub(super) fn new(map: &FeatureMap, height: usize, width: usize) -> Self {
        Self {
            down: EnlargedAxis::new(map.height, height),
            across: EnlargedAxis::new(map.width, width),
            width: map.width,
        }
    }

    /// The four old positions around a new one, with their weights.
    pub(super) fn corner_shares(&self, position: usize) -> [(usize, f32); 4] {
        let (above, below, down) = self.down.0[position / self.across.0.len()];
        let (left, right, across) = self.across.0[position % self.across.0.len()];
        [
            (above * self.width + left, (1.0 - down) * (1.0 - across)),
            (above * self.width + right, (1.0 - down) * across),
            (below * self.width + left, down * (1.0 - across)),
            (below * self.width + right, down * across),
        ]
    }

    /// The weight of each old position in the mean of all new ones.
    pub(super) fn mean_shares(&self, map: &FeatureMap) -> Vec<f32> {
        let (down, across) = (self.down.mean_shares(map.height), self.across.mean_shares(map.width));
        down.iter().flat_map(|down| across.iter().map(move |across| (down * across) as f32)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enlargement_aligns_the_corners_of_both_maps() {
        assert_eq!(EnlargedAxis::new(3, 5).0, [(0, 1, 0.0), (0, 1, 0.5), (1, 2, 0.0), (1, 2, 0.5), (2, 2, 0.0)]);
        assert_eq!(EnlargedAxis::new(1, 2).0, [(0, 0, 0.0), (0, 0, 0.0)]);
        assert_eq!(EnlargedAxis::new(4, 1).0, [(0, 1, 0.0)]);
        let sum: f64 = EnlargedAxis::new(3, 7).mean_shares(3).iter().sum();
        assert!((sum - 1.0).abs() < 1e-6);
    }
}
