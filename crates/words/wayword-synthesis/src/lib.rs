//! From views to words: the dialogue, prompts, styles, writing, checks and repair, and the offline minds.
