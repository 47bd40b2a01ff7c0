//! The ambiguity of an instruction: other places and objects that it fits as well.

use serde::{Deserialize, Serialize};

/// How many ends and objects an instruction fits. It is no verdict: an ambiguous text can be true of its path.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextAmbiguity {
    /// The number of places where a walk by this text may end: the annotated end, and the ends of other walks that fit
    /// the text about as well. They are 3 m apart or more. `None` where no other walk is known.
    pub ends: Option<usize>,
    /// The number of objects at the end of the path that the text's task may mean; 0 where the task names no known
    /// object.
    pub objects: usize,
    /// What only the annotated end has, where there are several ends.
    pub told_apart_by: Option<String>,
    /// Why [`Self::ends`] is not known, where it is `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unverified: Option<String>,
}

impl TextAmbiguity {
    /// Whether the text may mean several places, or several objects.
    #[must_use]
    pub fn is_ambiguous(&self) -> bool {
        self.ends.is_some_and(|ends| ends > 1) || self.objects > 1
    }

    /// A sentence for the user that names the ambiguity; `None` if the text is not ambiguous.
    #[must_use]
    pub fn to_sentence(&self) -> Option<String> {
        match (self.ends, self.objects) {
            (Some(ends), _) if ends > 1 => Some(format!("the text is ambiguous: it may end at {ends} places")),
            (_, objects) if objects > 1 => Some(format!("the text is ambiguous: its task may mean {objects} objects")),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ambiguity_counts_ends_and_objects() {
        let sentence = |ends, objects| TextAmbiguity { ends, objects, ..TextAmbiguity::default() }.to_sentence();
        assert!(sentence(Some(3), 1).unwrap().contains("3 places"));
        assert!(sentence(Some(1), 2).unwrap().contains("2 objects"));
        assert!(sentence(None, 2).is_some());
        assert_eq!((sentence(Some(1), 1), sentence(None, 0)), (None, None));
    }
}
