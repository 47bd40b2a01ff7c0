//! Gives participants the names that they have in the results.

use crate::StudyData;
use std::collections::BTreeMap;
use wayword_core::seed;

/// Names of participants in the results: `p001` and so on. The order is drawn by the seed, so that a name reveals neither the id in
/// the database nor when the participant consented.
#[derive(Debug, Clone)]
pub(super) struct ParticipantNames<'a> {
    names: BTreeMap<&'a str, String>,
}

impl<'a> ParticipantNames<'a> {
    pub(super) fn new(data: &'a StudyData) -> Self {
        let mut ids: Vec<&str> = data.participants.iter().map(|person| person.id.as_str()).collect();
        ids.sort_by_cached_key(|id| (seed::derive_seed(data.plan.seed, &["names in results", id]), *id));
        let digits = ids.len().to_string().len().max(3);
        let name = |(number, id): (usize, &'a str)| (id, format!("p{number:0digits$}"));
        Self { names: (1..).zip(ids).map(name).collect() }
    }

    /// A participant's name.
    pub(super) fn name_for_id(&self, id: &str) -> &str {
        self.names.get(id).map_or("p?", String::as_str)
    }
}
