//! What models cost: the answers that an item or a text used, whether they were made for it or the ledger had them already. So these
//! figures are the same however often a run is stopped and continued.

use serde::{Deserialize, Serialize};
use serde_json::{Map as JsonMap, Value};
use wayword_formats::jsonl::InstructionRecord;
use wayword_ledger::{AccountTotals, CallAccount};
use wayword_synthesis::repair::WritingOutcome;

/// The answers of models that an item used: to see, to summarise, and to write all its texts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ItemCalls {
    /// How many.
    pub answers: u64,
    /// Tokens that were sent for them.
    pub tokens_in: u64,
    /// Tokens that came back.
    pub tokens_out: u64,
    /// US dollars; models without a known price count as 0.
    pub usd: f64,
    /// How many of the answers are of models without a known price.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub unpriced: u64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands a reference")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

impl ItemCalls {
    /// What an account counted; `None` where no model was asked.
    #[must_use]
    pub fn of_account(account: &CallAccount) -> Option<Self> {
        let AccountTotals { answers, unpriced, tokens_in, tokens_out, usd } = account.totals();
        (answers > 0).then_some(Self { answers, tokens_in, tokens_out, usd, unpriced })
    }

    /// US dollars; `None` where the price of an answer is not known.
    #[must_use]
    pub fn cost_usd(&self) -> Option<f64> {
        (self.unpriced == 0).then_some(self.usd)
    }
}

/// What one text cost: the field `cost` of a line of `instructions.jsonl` or `rejected.jsonl`. It counts the calls that wrote the
/// text and its drafts, and those that asked about their words; what looking along the path cost is in [`ItemCalls`] of the walk.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TextCost {
    /// US dollars; `None` where the price of a model is not known.
    pub cost_usd: Option<f64>,
    /// Answers of models.
    pub calls: u64,
    /// Tokens that were sent for them.
    pub tokens_in: u64,
    /// Tokens that came back.
    pub tokens_out: u64,
    /// Texts that a model wrote for it, the kept one included.
    pub drafts: u64,
}

/// The field of a record that has what its text cost.
const COST_FIELD: &str = "cost";

impl TextCost {
    /// What a text cost by its account; `None` where no model was asked.
    #[must_use]
    pub fn of_outcome(account: &CallAccount, outcome: &WritingOutcome) -> Option<Self> {
        let calls = ItemCalls::of_account(account)?;
        let drafts = match outcome {
            WritingOutcome::Accepted(instruction) => {
                let provenance = &instruction.provenance;
                // The kept text is one of the model's, unless another writer finished for it.
                provenance.drafts.len() + usize::from(provenance.finished_for.is_none())
            }
            WritingOutcome::Rejected { drafts, .. } => drafts.len(),
        };
        let ItemCalls { answers, tokens_in, tokens_out, .. } = calls;
        Some(Self { cost_usd: calls.cost_usd(), calls: answers, tokens_in, tokens_out, drafts: drafts as u64 })
    }

    /// What the text of a record cost; `None` where no model took part, and in records of older versions.
    #[must_use]
    pub fn of_record(record: &InstructionRecord) -> Option<Self> {
        record.extra.get(COST_FIELD).and_then(|cost| serde_json::from_value(cost.clone()).ok())
    }

    /// Adds itself to the additional fields of a record.
    pub fn add_to(self, extra: &mut JsonMap<String, Value>) {
        if let Ok(cost) = serde_json::to_value(self) {
            extra.insert(COST_FIELD.to_owned(), cost);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::WrittenDraft;

    fn rejected(drafts: usize) -> WritingOutcome {
        let draft = |number: usize| WrittenDraft {
            text: number.to_string(),
            candidate: 0,
            reasons: Vec::new(),
            findings: Vec::new(),
        };
        WritingOutcome::Rejected { last: None, reason: "why".into(), drafts: (0..drafts).map(draft).collect() }
    }

    #[test]
    fn a_text_without_a_model_has_no_cost() {
        assert_eq!(TextCost::of_outcome(&CallAccount::default(), &rejected(0)), None);
    }

    #[test]
    fn an_unknown_price_is_null_and_not_nothing() {
        let calls = ItemCalls { answers: 2, tokens_in: 9, tokens_out: 3, usd: 0.5, unpriced: 1 };
        assert_eq!(calls.cost_usd(), None);
        assert_eq!(ItemCalls { unpriced: 0, ..calls }.cost_usd(), Some(0.5));
        let cost = TextCost { cost_usd: None, calls: 2, tokens_in: 9, tokens_out: 3, drafts: 1 };
        let mut extra = JsonMap::new();
        cost.add_to(&mut extra);
        assert_eq!(
            serde_json::to_string(&extra).unwrap(),
            r#"{"cost":{"cost_usd":null,"calls":2,"tokens_in":9,"tokens_out":3,"drafts":1}}"#
        );
        // Lines of older versions do not count the answers without a price.
        let old: ItemCalls = serde_json::from_str(r#"{"answers":1,"tokens_in":1,"tokens_out":1,"usd":0.0}"#).unwrap();
        assert_eq!((old.unpriced, serde_json::to_value(old).unwrap().get("unpriced")), (0, None));
    }
}
