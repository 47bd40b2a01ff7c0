//! Quantiles of the normal and of Student's t distribution, from which intervals get their width.

/// The standard normal quantile, by Wichura's algorithm AS 241 (PPND16, Applied Statistics 37, 1988): accurate to about
/// sixteen digits. Infinite at 0 and 1, and not a number beyond them.
pub(super) fn normal_quantile(share: f64) -> f64 {
    // The numbers in this function are those of AS 241.
    let from_half = share - 0.5;
    if from_half.abs() <= 0.425 {
        let r = 0.180_625 - from_half * from_half;
        return from_half * evaluate_polynomial(&CENTRE_COEFFICIENTS.0, r)
            / evaluate_polynomial(&CENTRE_COEFFICIENTS.1, r);
    }
    let tail = share.min(1.0 - share);
    if tail <= 0.0 {
        return if tail < 0.0 { f64::NAN } else { f64::INFINITY.copysign(from_half) };
    }
    let root = (-tail.ln()).sqrt();
    let (coefficients, r) =
        if root <= 5.0 { (&MIDDLE_COEFFICIENTS, root - 1.6) } else { (&FAR_COEFFICIENTS, root - 5.0) };
    (evaluate_polynomial(&coefficients.0, r) / evaluate_polynomial(&coefficients.1, r)).copysign(from_half)
}

/// The quantile of Student's distribution, for a share from 0.5 to below 1; `None` for other shares and for 0 degrees of freedom.
///
/// It solves for the quantile by Newton's iteration on the distribution function, an incomplete beta function (Abramowitz and
/// Stegun 26.7.1). Steps that would leave the bounds known to contain the answer are replaced by bisection.
pub(super) fn student_quantile(share: f64, degrees: usize) -> Option<f64> {
    let tail = 1.0 - share;
    if degrees == 0 || !(tail > 0.0 && tail <= 0.5) {
        return None;
    }
    let distribution = StudentDistribution::new(degrees.min(MAX_DEGREES));
    let (mut low, mut high) = (0.0, f64::INFINITY);
    let mut at = normal_quantile(share);
    for _ in 0..MAX_QUANTILE_STEPS {
        let over = distribution.upper_tail(at) - tail;
        if over > 0.0 {
            low = at;
        } else {
            high = at;
        }
        let newton = at + over / distribution.density(at);
        let next = if newton > low && newton < high {
            newton
        } else if high.is_finite() {
            f64::midpoint(low, high)
        } else {
            2.0 * at + 1.0
        };
        if (next - at).abs() <= 1e-15 * at.abs() {
            break;
        }
        at = next;
    }
    Some(at)
}

/// Beyond this many degrees of freedom the quantile equals the normal one in all digits that reports show.
const MAX_DEGREES: usize = 1_000_000;
/// Steps of the iteration at most; then the value so far is returned. Bisection alone needs fewer.
const MAX_QUANTILE_STEPS: usize = 200;

/// Student's distribution with its degrees of freedom.
struct StudentDistribution {
    degrees: f64,
    /// The beta function of half the degrees and one half.
    beta: f64,
}

impl StudentDistribution {
    /// The beta function follows from B(1/2, 1/2) = π or B(1, 1/2) = 2 by B(a + 1, b) = B(a, b) a / (a + b).
    fn new(degrees: usize) -> Self {
        let odd = degrees % 2;
        let start = if odd == 1 { std::f64::consts::PI } else { 2.0 };
        let steps = (2 - odd..degrees).step_by(2);
        let beta = steps.fold(start, |beta, twice| beta * twice as f64 / (twice + 1) as f64);
        Self { degrees: degrees as f64, beta }
    }

    /// The probability density at `t`.
    fn density(&self, t: f64) -> f64 {
        let power = -(self.degrees + 1.0) / 2.0 * (t * t / self.degrees).ln_1p();
        power.exp() / (self.degrees.sqrt() * self.beta)
    }

    /// The probability of a value above `t`, for `t` of at least 0.
    fn upper_tail(&self, t: f64) -> f64 {
        let (a, b) = (self.degrees / 2.0, 0.5);
        let square = t * t;
        let (x, rest) = (self.degrees / (self.degrees + square), square / (self.degrees + square));
        let front = (-a * (square / self.degrees).ln_1p()).exp() * rest.sqrt() / self.beta;
        if x < (a + 1.0) / (a + b + 2.0) {
            0.5 * front * continued_fraction(a, b, x) / a
        } else {
            0.5 * (1.0 - front * continued_fraction(b, a, rest) / b)
        }
    }
}

/// The continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8), by Lentz's method.
fn continued_fraction(a: f64, b: f64, x: f64) -> f64 {
    const SMALLEST_DENOMINATOR: f64 = 1e-300;
    let away_from_zero = |value: f64| if value.abs() < SMALLEST_DENOMINATOR { SMALLEST_DENOMINATOR } else { value };
    let mut c = 1.0;
    let mut d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    let mut value = d;
    for step in 1..10_000 {
        let m = f64::from(step);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = value;
        for term in [even, odd] {
            d = 1.0 / away_from_zero(1.0 + term * d);
            c = away_from_zero(1.0 + term / c);
            value *= c * d;
        }
        if (value - before).abs() <= 1e-16 * value.abs() {
            break;
        }
    }
    value
}

/// The value of a polynomial, constant term first, by Horner's rule.
fn evaluate_polynomial(coefficients: &[f64; 8], at: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * at + coefficient)
}

/// Numerator and denominator of a rational approximation, constant terms first.
type RationalCoefficients = ([f64; 8], [f64; 8]);

/// For shares from 0.075 to 0.925, by the distance from one half.
#[rustfmt::skip]
const CENTRE_COEFFICIENTS: RationalCoefficients = (
    [3.387_132_872_796_366_5, 1.331_416_678_917_843_8e2, 1.971_590_950_306_551_3e3, 1.373_169_376_550_946e4,
     4.592_195_393_154_987e4, 6.726_577_092_700_87e4, 3.343_057_558_358_813e4, 2.509_080_928_730_122_7e3],
    [1.0, 4.231_333_070_160_091e1, 6.871_870_074_920_579e2, 5.394_196_021_424_751e3,
     2.121_379_430_158_659_7e4, 3.930_789_580_009_271e4, 2.872_908_573_572_194_3e4, 5.226_495_278_852_854e3],
);
/// For smaller tails down to e^-25.
#[rustfmt::skip]
const MIDDLE_COEFFICIENTS: RationalCoefficients = (
    [1.423_437_110_749_683_5, 4.630_337_846_156_546, 5.769_497_221_460_691, 3.647_848_324_763_204_5,
     1.270_458_252_452_368_4, 2.417_807_251_774_506e-1, 2.272_384_498_926_918_4e-2, 7.745_450_142_783_414e-4],
    [1.0, 2.053_191_626_637_759, 1.676_384_830_183_803_8, 6.897_673_349_851e-1,
     1.481_039_764_274_800_8e-1, 1.519_866_656_361_645_7e-2, 5.475_938_084_995_345e-4, 1.050_750_071_644_416_9e-9],
);
/// For tails below e^-25.
#[rustfmt::skip]
const FAR_COEFFICIENTS: RationalCoefficients = (
    [6.657_904_643_501_103, 5.463_784_911_164_114, 1.784_826_539_917_291_3, 2.965_605_718_285_048_7e-1,
     2.653_218_952_657_612_4e-2, 1.242_660_947_388_078_4e-3, 2.711_555_568_743_487_6e-5, 2.010_334_399_292_288e-7],
    [1.0, 5.998_322_065_558_88e-1, 1.369_298_809_227_358e-1, 1.487_536_129_085_061_5e-2,
     7.868_691_311_456_133e-4, 1.846_318_317_510_054_8e-5, 1.421_511_758_316_446e-7, 2.044_263_103_389_939_8e-15],
);

#[cfg(test)]
mod tests {
    use super::*;

    /// By SciPy 1.17 (`scipy.stats.norm.ppf`).
    #[test]
    fn normal_quantiles_are_known() {
        let known = NORMAL;
        for (share, expected) in known {
            let found = normal_quantile(share);
            assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{share}: {found} for {expected}");
        }
        assert_eq!(normal_quantile(0.5), 0.0);
        assert_eq!((normal_quantile(1.0), normal_quantile(0.0)), (f64::INFINITY, f64::NEG_INFINITY));
        assert!(normal_quantile(1.5).is_nan());
    }

    /// By SciPy 1.17 (`scipy.stats.t.ppf`).
    #[test]
    fn student_quantiles_are_known() {
        for (share, degrees, expected) in STUDENT {
            let found = student_quantile(share, degrees).unwrap();
            assert!((found / expected - 1.0).abs() < 1e-12, "{share} of {degrees}: {found} for {expected}");
        }
    }

    #[test]
    fn student_quantile_is_none_outside_its_range() {
        assert_eq!(student_quantile(0.975, 0), None);
        assert_eq!(student_quantile(1.0, 3), None);
        assert_eq!(student_quantile(0.4, 3), None);
        assert_eq!(student_quantile(f64::NAN, 3), None);
        assert_eq!(student_quantile(0.5, 3).map(f64::abs), Some(0.0));
    }

    #[test]
    fn many_degrees_are_nearly_normal() {
        let far = student_quantile(0.975, usize::MAX).unwrap();
        assert!((far - normal_quantile(0.975)).abs() < 1e-5, "{far}");
    }

    const NORMAL: [(f64, f64); 8] = [
        (0.975, 1.959963984540054),
        (0.95, 1.6448536269514722),
        (0.6, 0.2533471031357997),
        (0.1, -1.2815515655446004),
        (0.005, -2.575829303548901),
        (1e-06, -4.753424308822899),
        (1e-20, -9.262340089798409),
        (0.999999999, 5.997807019601637),
    ];
    const STUDENT: [(f64, usize, f64); 13] = [
        (0.975, 1, 12.706204736174694),
        (0.975, 2, 4.302652729749462),
        (0.975, 5, 2.5705818356363146),
        (0.975, 29, 2.045229642132703),
        (0.975, 59, 2.000995378088267),
        (0.95, 14, 1.761310135774891),
        (0.995, 7, 3.4994832973504924),
        (0.6, 3, 0.2766706623326898),
        (0.975, 300, 1.9679030112610865),
        (0.999, 4, 7.173182219782307),
        (0.51, 100, 0.02513169753771459),
        (0.999999, 2, 707.1057205157672),
        (0.975, 5000, 1.9604385517065073),
    ];
}
