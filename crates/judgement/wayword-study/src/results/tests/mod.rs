//! What results must be, whatever people gave.

mod exports;
mod figures;
mod hostile;
mod made;
mod page;
mod planned;
mod reader;
