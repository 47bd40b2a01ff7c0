//! Reads the rate limits that a service advertises in its response headers.

use ureq::http::HeaderMap;

/// Limits per minute; `None` where the service advertises none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct AdvertisedLimits {
    pub(crate) requests_per_minute: Option<f64>,
    pub(crate) tokens_per_minute: Option<f64>,
}

impl AdvertisedLimits {
    /// Reads the limits. `requests_per_day` is set for a service that gives its requests per day.
    pub(crate) fn from_headers(headers: &HeaderMap, requests_per_day: bool) -> Self {
        let number = |name: &str| {
            let number: f64 = headers.get(name)?.to_str().ok()?.trim().parse().ok()?;
            (number.is_finite() && number >= 1.0).then_some(number)
        };
        let requests = if requests_per_day { None } else { number("x-ratelimit-limit-requests") };
        // Anthropic has separate limits for tokens in and out. The limit for both together is their sum.
        let sum_of_both = || {
            let (tokens_in, tokens_out) =
                (number("anthropic-ratelimit-input-tokens-limit")?, number("anthropic-ratelimit-output-tokens-limit")?);
            Some(tokens_in + tokens_out)
        };
        Self {
            requests_per_minute: requests.or_else(|| number("anthropic-ratelimit-requests-limit")),
            tokens_per_minute: number("x-ratelimit-limit-tokens")
                .or_else(|| number("anthropic-ratelimit-tokens-limit"))
                .or_else(sum_of_both),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ureq::http::HeaderValue;

    #[test]
    fn limits_are_read_from_either_familys_headers() {
        let mut headers = HeaderMap::new();
        headers.insert("x-ratelimit-limit-requests", HeaderValue::from_static("600"));
        headers.insert("anthropic-ratelimit-tokens-limit", HeaderValue::from_static("80000"));
        let advertised = AdvertisedLimits::from_headers(&headers, false);
        assert_eq!(advertised, AdvertisedLimits { requests_per_minute: Some(600.0), tokens_per_minute: Some(80000.0) });
        assert_eq!(AdvertisedLimits::from_headers(&headers, true).requests_per_minute, None);
    }

    #[test]
    fn nonsense_is_no_limit() {
        let mut headers = HeaderMap::new();
        for value in ["0", "-5", "NaN", "inf", "many", ""] {
            headers.insert("x-ratelimit-limit-requests", HeaderValue::from_static(value));
            assert_eq!(AdvertisedLimits::from_headers(&headers, false), AdvertisedLimits::default(), "{value}");
        }
    }
}
