//! What share of the requests met something lately.

/// About so many requests are remembered.
const REMEMBERED: f64 = 64.0;

/// A share of the latest requests, in which older ones count for less and less.
#[derive(Debug, Default)]
pub(super) struct Share {
    met: f64,
    all: f64,
}

impl Share {
    /// Counts a request; returns the share with it.
    pub(super) fn count(&mut self, met: bool) -> f64 {
        let kept = 1.0 - 1.0 / REMEMBERED;
        self.met = self.met * kept + f64::from(u8::from(met));
        self.all = self.all * kept + 1.0;
        self.met / self.all
    }

    /// Takes what was met so far as dealt with.
    pub(super) fn settle(&mut self) {
        self.met = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_counts_whole_and_old_ones_hardly() {
        let mut share = Share::default();
        assert_eq!(share.count(true), 1.0);
        let after_calm = (0..400).fold(1.0, |_, _| share.count(false));
        assert!(after_calm < 0.01, "{after_calm}");
        assert!((0.01..0.03).contains(&share.count(true)));
        let after_storm = (0..400).fold(0.0, |_, _| share.count(true));
        assert!(after_storm > 0.99, "{after_storm}");
    }
}
