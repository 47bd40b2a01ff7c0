//! The calls, tokens and money of a command, and how they are printed.

use crate::count::count_phrase;
use serde::Serialize;
use std::fmt;

/// Calls, tokens and money of this command, without what earlier commands of the same run spent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct CallSpending {
    /// Requests that were sent, repeated attempts among them.
    pub requests: u64,
    /// Answers that were paid for.
    pub answered: u64,
    /// Answers that the ledger or the recording had.
    pub from_ledger: u64,
    /// Requests that failed.
    pub failed: u64,
    /// Requests that may have been paid for although no answer came.
    pub lost: u64,
    /// Tokens that were sent.
    pub tokens_in: u64,
    /// Tokens that came back.
    pub tokens_out: u64,
    /// The cost of the answers, US dollars; models without a known price count as 0.
    pub usd: f64,
    /// The most that the lost requests may have cost, US dollars.
    pub maybe_usd: f64,
}

impl fmt::Display for CallSpending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} from the ledger", count_phrase(self.answered, "call"), self.from_ledger)?;
        if self.failed > 0 {
            write!(f, ", {} failed", count_phrase(self.failed, "attempt"))?;
        }
        write!(f, ", {} tokens in, {} out", short_token_count(self.tokens_in), short_token_count(self.tokens_out))?;
        if self.usd > 0.0 {
            write!(f, ", ${:.4}", self.usd)?;
        }
        if self.lost > 0 {
            write!(f, " ({} lost, at most ${:.4} more)", count_phrase(self.lost, "answer"), self.maybe_usd)?;
        }
        Ok(())
    }
}

/// A number of tokens, short enough for a progress bar.
fn short_token_count(tokens: u64) -> String {
    match tokens {
        0..10_000 => tokens.to_string(),
        10_000..10_000_000 => format!("{:.1}k", tokens as f64 / 1e3),
        _ => format!("{:.1}M", tokens as f64 / 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn call_spending_shows_money_and_losses_only_if_there_are_any() {
        let free =
            CallSpending { answered: 12, from_ledger: 3, tokens_in: 12_345, tokens_out: 99, ..CallSpending::default() };
        assert_eq!(free.to_string(), "12 calls, 3 from the ledger, 12.3k tokens in, 99 out");
        let paid = CallSpending { usd: 0.5, lost: 1, maybe_usd: 0.01, failed: 2, ..free };
        assert!(paid.to_string().ends_with("99 out, $0.5000 (1 answer lost, at most $0.0100 more)"));
    }
}
