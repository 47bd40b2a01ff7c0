//! Tests of the results: figures, exports, hostile text, and an empty study.

mod ends_and_exclusions;
mod exports;
mod figures;
mod fixtures;
mod hostile;
mod page;
mod planned;
mod preregistered;
mod reader;
mod scripts;
