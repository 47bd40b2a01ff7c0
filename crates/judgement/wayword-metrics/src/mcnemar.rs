//! McNemar's test: whether two methods differ in success on the same items. It looks only at the items where exactly one of them
//! succeeds; under chance, each of them wins half of these.

use serde::{Deserialize, Serialize};

/// The result of McNemar's test of two methods.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct McNemar {
    /// Items on which the first alone succeeds.
    pub only_first: usize,
    /// Items on which the second alone succeeds.
    pub only_second: usize,
    /// Two-sided p of the exact binomial test. It treats items as independent.
    pub p: f64,
}

impl McNemar {
    /// The test of pairs: whether the first and whether the second succeeds on an item. `p` is 1 where they never differ.
    #[must_use]
    pub fn from_pairs(pairs: impl Iterator<Item = (bool, bool)>) -> Self {
        let [mut only_first, mut only_second] = [0, 0];
        for (first, second) in pairs {
            only_first += usize::from(first && !second);
            only_second += usize::from(second && !first);
        }
        let p = (2.0 * lower_tail(only_first + only_second, only_first.min(only_second))).min(1.0);
        Self { only_first, only_second, p }
    }
}

/// The probability of at most `most` heads of `coins` fair coins, for `most` up to half of them.
///
/// The greatest term, that of `most` heads, is computed by logarithms: as an `f64` it would be 0 beyond 1,074 coins,
/// and the count of its cases would overflow beyond 1,029. The other terms are shares of it.
fn lower_tail(coins: usize, most: usize) -> f64 {
    let greatest_ln: f64 = (0..most).map(|heads| ((coins - heads) as f64 / (heads + 1) as f64).ln()).sum::<f64>()
        - coins as f64 * std::f64::consts::LN_2;
    let mut share = 1.0;
    let mut shares = 1.0;
    for heads in (1..=most).rev() {
        share *= heads as f64 / (coins - heads + 1) as f64;
        shares += share;
    }
    greatest_ln.exp() * shares
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn test(only_first: usize, only_second: usize) -> McNemar {
        let first = std::iter::repeat_n((true, false), only_first);
        McNemar::from_pairs(first.chain(std::iter::repeat_n((false, true), only_second)))
    }

    #[test]
    fn mcnemar_p_is_one_for_methods_that_never_differ() {
        let same = McNemar::from_pairs([(true, true), (false, false)].into_iter());
        assert_eq!(same, McNemar { only_first: 0, only_second: 0, p: 1.0 });
        assert_eq!(test(8, 8).p, 1.0);
    }

    #[test]
    fn mcnemar_counts_pairs_by_the_only_success() {
        let found = McNemar::from_pairs([(true, false), (true, false), (false, true), (true, true)].into_iter());
        assert_eq!((found.only_first, found.only_second), (2, 1));
    }

    /// By exact fractions (Python's `fractions` and `math.comb`).
    #[test]
    fn p_is_exact_for_few_pairs_and_for_thousands() {
        let known = [
            (1, 0, 1.0),
            (0, 5, 0.0625),
            (3, 10, 0.092_285_156_25),
            (10, 20, 0.098_737_146_705_389_02),
            (59, 6, 4.964_650_327_128_617e-12),
            (121, 59, 4.434_449_263_755_176e-6),
            (480, 520, 0.217_448_293_204_140_94),
            (0, 1000, 1.866_527_237_006_437_8e-301),
            (1500, 1300, 0.000_168_411_622_643_761_2),
            (5000, 5400, 9.116_949_314_540_886e-5),
        ];
        for (first, second, p) in known {
            let found = test(first, second).p;
            assert!((found / p - 1.0).abs() < 1e-10, "{first} against {second}: {found} for {p}");
        }
    }

    proptest! {
        #[test]
        fn mcnemar_p_falls_as_methods_differ_more(agree in 0..400usize, apart in 1..400usize) {
            let (near, far) = (test(agree, agree + apart - 1).p, test(agree, agree + apart).p);
            prop_assert!((0.0..=1.0).contains(&far));
            prop_assert!(far <= near * (1.0 + 1e-9), "{far} after {near}");
            prop_assert_eq!(far, test(agree + apart, agree).p);
        }
    }
}
