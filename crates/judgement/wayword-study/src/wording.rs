//! The wording of the statements and questions about texts. It is the same in every study, so that results can be compared.

/// A question with the words of its five levels, from 1 to 5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct RatingScale {
    /// Its short name in tables and files.
    pub name: &'static str,
    /// The question or statement.
    pub text: &'static str,
    /// The words of the five levels.
    pub levels: [&'static str; 5],
}

/// Levels of agreement with a statement; attention checks use them too.
pub(crate) const AGREEMENT_LEVELS: [&str; 5] =
    ["Strongly disagree", "Disagree", "Neither agree nor disagree", "Agree", "Strongly agree"];

/// After a walk: the three statements of HEAR's study (Zhao et al. 2024), in our words.
pub const FOLLOW_STATEMENTS: [RatingScale; 3] = [
    RatingScale { name: "easy", text: "The directions were easy to follow.", levels: AGREEMENT_LEVELS },
    RatingScale {
        name: "confident",
        text: "I am confident that I went the way the directions describe.",
        levels: AGREEMENT_LEVELS,
    },
    RatingScale {
        name: "demanding",
        text: "Following the directions was mentally demanding.",
        levels: AGREEMENT_LEVELS,
    },
];

/// About a text: the four questions of arXiv 2403.11487. Its wording and scale are lost; these words are ours.
pub const RATE_QUESTIONS: [RatingScale; 4] = [
    RatingScale {
        name: "similar",
        text: "How similar are these directions to ones you would write?",
        levels: ["Very different", "Slightly similar", "Partly similar", "Mostly similar", "Almost the same"],
    },
    RatingScale {
        name: "accurate",
        text: "How accurately do the directions describe the walk?",
        levels: ["Not at all", "Slightly", "Moderately", "Well", "Very well"],
    },
    RatingScale {
        name: "ghosts",
        text: "Do the directions mention things that you did not see on the walk?",
        levels: ["None", "One", "Two", "Three", "More than three"],
    },
    RatingScale {
        name: "reachable",
        text: "Could a robot reach the end of the walk with these directions?",
        levels: ["Certainly not", "Probably not", "Perhaps", "Probably", "Certainly"],
    },
];
