//! The command line of Wayword.
fn main() {}
