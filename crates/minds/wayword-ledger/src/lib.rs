//! Every call of a model, made once and kept.
