//! Turns runs into files for others: HTML reports for people (`pages`), datasets for other programs (`export`), and pictures, maps
//! and films of scenes (`view`).

pub mod export;
pub mod pages;
pub mod view;
#[cfg(feature = "habitat")]
pub mod walking;
