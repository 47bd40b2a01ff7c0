//! Tests of the results: figures, exports, hostile text, and an empty study.

mod exports;
mod figures;
mod hostile;
mod made;
mod page;
mod planned;
mod reader;
