//! What results must be, whatever people gave.

mod exports;
mod figures;
mod hostile;
mod look;
mod made;
mod planned;
mod reader;
