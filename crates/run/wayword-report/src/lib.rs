//! Turns runs into files for others: HTML reports for people (`pages`), datasets for other programs (`export`), and pictures, maps
//! and films of scenes (`view`).
//!
//! # Where things are
//! - `export/args.rs`, `mod.rs`: formats and their flags; `items.rs`: records as items; `splits.rs`: the split of a text.
//! - `export/duet.rs`, `table.rs`, `habitat_scenes.rs`: files for agents, Parquet, and the scenes and distances of VLN-CE.
//! - `export/card/`: the dataset card, its text in `card.md`.
//! - `export/steps/`: walks in single actions: settings, parts of a text, cameras, pictures and shards, walking again.
//! - `export/layouts/`: what training code reads, packed from steps; `rxrce.rs` and `duet_pretraining.rs` need no pictures, and
//!   `training_texts.rs` puts texts back into a layout that was read.
//! - `export/highlight.rs`, `pages/doubts/`: words to doubt.
//! - `pages/suspicion.rs`: what speaks against a text, and which come first; `item_order.rs`, `rows.rs`, `report_files.rs`,
//!   `picture_folder.rs`, `page.rs`: the items that a report shows, the list of texts, the files, the pictures beside them, the head.
//!   The templates lie beside them, and the only script, `report.js`.
//! - `pair_check.rs`, `annotate.rs`, `pages/curate/`: `check --by pictures` and `annotate`, and their pages.
//! - `pages/comparison/`, `pages/replay/`: tables, page and replays of a comparison.
//! - `view/path/`, `view/film/`, `view/map/`: what `wayword view` writes.

#[cfg(all(feature = "lerobot", feature = "parquet"))]
pub mod annotate;
pub mod export;
pub mod pages;
pub mod pair_check;
pub mod view;
#[cfg(feature = "habitat")]
pub mod walking;
