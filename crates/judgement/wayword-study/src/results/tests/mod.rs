//! Tests of the results: figures, exports, hostile text, and an empty study.

mod exports;
mod figures;
mod fixtures;
mod hostile;
mod page;
mod planned;
mod reader;
