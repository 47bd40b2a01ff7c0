//! The integration tests of `wayword`, one program: a module for each topic.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod align;
mod check;
mod check_edited;
mod children;
mod cli;
mod common;
mod compare;
mod compare_models;
mod compare_tools;
mod contained;
mod damaged_files;
mod detectors;
mod documents;
mod evaluate;
mod evaluate_partial;
mod export;
mod export_agents;
mod export_tables;
mod failures;
mod follow;
mod generate;
mod graphs;
mod habitat;
mod invariants;
mod local_models;
mod lost_worlds;
mod model_kills;
mod models;
mod models_in_process;
mod platforms;
mod real_data;
mod recording;
mod resume;
mod robustness;
mod robustness_elsewhere;
mod settings_examples;
mod similarity;
mod similarity_pictures;
mod spans;
mod steps;
mod study;
mod view;
mod workers;
mod writers;
