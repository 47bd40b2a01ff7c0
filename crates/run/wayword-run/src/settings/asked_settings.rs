//! The settings as flags and the settings file give them, before defaults are filled in.

use super::{AskedRoles, EvidenceSources, Perception, ProviderTables, Service, TargetMode, group::group};
use crate::{platforms, styles};
use clap::{Args, ValueEnum, builder::PossibleValuesParser};
use serde::Deserialize;
use std::path::PathBuf;
use wayword_synthesis::walk::FrameSelection;

/// Declares the groups with keys at the top of the settings file, by their fields in [`AskedSettings`]: a struct for
/// each group, and the struct `SettingsFile` with the keys of all of them, from which the settings file is read.
macro_rules! top_groups {
    ($($name:ident: $(#[$of:meta])* pub struct $Group:ident { $($(#[$how:meta])* pub $key:ident: Option<$Type:ty>,)* })*) => {
        $(group! { $(#[$of])* pub struct $Group { $($(#[$how])* pub $key: Option<$Type>,)* } })*

        /// The settings file as it is written. `#[serde(flatten)]` in [`AskedSettings`] would do the same, but errors would lose their
        /// line.
        #[derive(Default, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        struct SettingsFile {
            $($($key: Option<$Type>,)*)*
            roles: AskedRoles,
            service: Service,
            providers: ProviderTables,
        }

        impl From<SettingsFile> for AskedSettings {
            fn from(file: SettingsFile) -> Self {
                $(let $name = $Group { $($key: file.$key,)* };)*
                Self { $($name,)* roles: file.roles, service: file.service, providers: file.providers }
            }
        }
    };
}

/// The settings of a run before they are resolved. Every value is optional: one that no flag gives comes from the file, or else
/// from a default.
#[derive(Debug, Clone, Default, PartialEq, Args, Deserialize)]
#[serde(from = "SettingsFile")]
pub struct AskedSettings {
    /// The platform.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// The paths.
    #[command(flatten)]
    pub walks: Walks,
    /// How their views are described, and how texts are written and checked.
    #[command(flatten)]
    pub writing: Writing,
    /// Seed, and number of items.
    #[command(flatten)]
    pub draw: Draw,
    /// Who asks, sees, summarises and writes.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How models are reached, and what may be spent.
    #[command(flatten)]
    pub service: Service,
    /// The user's own providers. Only the settings file has them.
    #[arg(skip)]
    pub providers: ProviderTables,
}

top_groups! {
platform:
    /// Which platform, and where its data is.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct AskedPlatform {
        /// Where scenes come from: house (generated, built in), matterport, habitat, tdw, virtualhome, process or recording.
        /// `wayword platforms` lists what each needs. [default: house]
        #[arg(long, value_parser = PossibleValuesParser::new(platforms::platform_names()), hide_possible_values = true)]
        pub platform: Option<String>,
        /// Folder or file of the platform's data.
        #[arg(long, value_name = "PATH")]
        pub data: Option<PathBuf>,
        /// Address of a running simulator: HOST:PORT for tdw, a URL for virtualhome.
        #[arg(long, value_name = "ADDRESS")]
        pub at: Option<String>,
        /// Take paths on this island of a Habitat navmesh; 0 is the largest. `wayword view map` lists the islands. [default: the
        /// largest that has a ceiling above it, which excludes roofs; in outdoor scenes, the largest]
        #[arg(long, value_name = "N")]
        pub island: Option<usize>,
        /// Walk Habitat's scenes along the viewpoint graphs of this folder, SCENE_connectivity.json in Matterport's format
        /// (ScaleVLN has them for HM3D and Gibson), and not over navmeshes. Scenes that cannot be used are left out and named.
        #[arg(long, value_name = "DIR")]
        pub connectivity: Option<PathBuf>,
    }

walks:
    /// Which paths a run takes.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct Walks {
        /// Take the paths of this dataset file: R2R, REVERIE, RxR, or Wayword if its paths name viewpoints.
        #[arg(long, value_name = "FILE")]
        pub episodes: Option<PathBuf>,
        /// Number of random paths. [default: 10, if no episodes are given]
        #[arg(long, value_name = "N")]
        pub paths: Option<usize>,
        /// Random paths through this many generated houses, with seeds from --seed on: with as many houses as paths each path lies in a
        /// house of its own. For platform house. [default: 20 houses, from seed 0 on]
        #[arg(long, value_name = "N")]
        pub houses: Option<usize>,
        /// Use only this scene. May be given several times.
        #[arg(long, alias = "scene", value_name = "SCENE")]
        pub scan: Option<Vec<String>>,
        /// Number of hops of a random path, on platforms with a viewpoint graph (matterport, process, habitat with --connectivity, recordings without poses).
        /// [default: 4..7]
        #[arg(long, value_name = "FROM..TO")]
        pub hops: Option<String>,
        /// Length of a random path in metres. [default: 5..20]
        #[arg(long, value_name = "FROM..TO")]
        pub metres: Option<String>,
    }

writing:
    /// How views are described, and how texts are written and checked.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct Writing {
        /// Write in this style: r2r, reverie, a TOML file, or NAME=DATASET to take the texts of a dataset file as examples. May be
        /// given several times. [default: r2r and reverie]
        #[arg(long, value_name = "STYLE", value_parser = styles::check_style_name)]
        pub style: Option<Vec<String>>,
        /// Write each style in these languages, separated by commas: en, zh (Chinese). In a language beside its own, the name of a style
        /// gets the tag, as in r2r-zh. [default: the language of the style's texts]
        #[arg(long, value_name = "TAGS", value_delimiter = ',', value_parser = styles::check_language)]
        pub language: Option<Vec<String>>,
        /// At each frame, describe the view along the heading, or all four views. [default: central]
        #[arg(long)]
        pub frames: Option<AskedFrames>,
        /// How a view is described: with one request for JSON (structured, and follow-up with questions about what stays open),
        /// question by question, with fixed queries, or with one request for a description. [default: structured for models over
        /// HTTP, dialogue for labels and models in process]
        #[arg(long)]
        pub perception: Option<Perception>,
        /// Ask at most this many questions per view, with --perception dialogue or follow-up. [default: 9]
        #[arg(long, value_name = "N")]
        pub questions: Option<usize>,
        /// The target of the task at the end: given by the episode or path, or chosen by the writer. [default: given]
        #[arg(long)]
        pub target: Option<TargetMode>,
        /// Rewrite a text that failed a check, at most this many times. [default: 8; if a model writes, 3]
        #[arg(long, value_name = "N")]
        pub repairs: Option<u32>,
        /// Write a text that passed again, at most this many times (0 to 5), if a follower does not arrive by it surely: the model is
        /// told what the text lacks, and the better text is kept. [default: 0; if a model writes, 1]
        #[arg(long, value_name = "N")]
        pub refine: Option<u32>,
        /// Write this many texts (1 to 32), and keep the one by which a follower finds the end of the path most surely for its
        /// length. [default: 4; if a model writes, 1]
        #[arg(long, value_name = "N")]
        pub candidates: Option<u32>,
        /// Write N texts for each path and style, 1 to 9, that differ from each other: as in --per-path 3 for three texts a path, the
        /// number that R2R has. [default: 1]
        #[arg(long, value_name = "N")]
        pub per_path: Option<usize>,
        /// Check texts against these, separated by commas: labels (where the platform has them; else captions), captions, and detector
        /// (what --detector finds and misses). [default: labels; with a detector labels,captions,detector]
        #[arg(long, value_name = "SOURCES")]
        pub evidence: Option<EvidenceSources>,
        /// What `wayword perceive --detector` measured of the detector. Without it a thing that the detector misses is not taken
        /// to be absent.
        #[arg(long, value_name = "FILE")]
        pub detector_figures: Option<PathBuf>,
        /// What the detector looks for in every view, whatever the captions name: off, or a file with a name on each line.
        /// [default: household things, and what the style's texts name]
        #[arg(long, value_name = "off|FILE")]
        pub proposals: Option<PathBuf>,
        /// Shares by the names of objects that `wayword calibrate` made. Texts are checked in a closed world, where absence
        /// counts in full, so it changes only the answers of labels in a dialogue about things that they do not list: "No" or "I
        /// am not sure".
        #[arg(long, value_name = "FILE")]
        pub calibration: Option<PathBuf>,
        /// Treat a text that may mean several places, or several objects at its end, like one that failed a check: it is written
        /// again, and rejected at last. Without it these texts are kept and counted.
        #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
        pub reject_ambiguous: Option<bool>,
        /// Do not follow the texts: their records say neither whether they lead elsewhere nor what they may mean.
        #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
        pub no_route: Option<bool>,
        /// Draw no pictures, where labels see: a run takes a fraction of the time, and its report has no pictures.
        #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
        pub no_pictures: Option<bool>,
    }

draw:
    /// Seed, and number of items.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct Draw {
        /// Seed of everything random. It is part of the names of random paths, so use different seeds for runs that you want to
        /// merge. [default: 0]
        #[arg(long)]
        pub seed: Option<u64>,
        /// Use only the first N items.
        #[arg(long, value_name = "N")]
        pub limit: Option<usize>,
    }
}

/// Which views are described.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum AskedFrames {
    /// The view along the heading.
    Central,
    /// North, east, south and west, condensed into one description.
    Panoramic,
}

impl From<AskedFrames> for FrameSelection {
    fn from(frames: AskedFrames) -> Self {
        match frames {
            AskedFrames::Central => Self::Central,
            AskedFrames::Panoramic => Self::Panoramic,
        }
    }
}

impl AskedPlatform {
    /// The platform's name, or that of the default.
    #[must_use]
    pub fn name(&self) -> &str {
        self.platform.as_deref().unwrap_or("house")
    }
}

impl Walks {
    /// The values of flags, completed by those of a file.
    fn or_file(self, mut file: Self) -> Self {
        // Episodes and random paths exclude each other, so a flag for one also removes the other of a file; likewise houses and scenes.
        if self.paths.is_some() || self.houses.is_some() {
            file.episodes = None;
        }
        if self.episodes.is_some() {
            (file.paths, file.houses) = (None, None);
        }
        if self.houses.is_some() {
            file.scan = None;
        }
        if self.scan.is_some() {
            file.houses = None;
        }
        self.over(file)
    }
}

impl AskedSettings {
    /// The values of flags, completed by those of a file.
    #[must_use]
    pub fn or_file(self, file: Self) -> Self {
        Self {
            platform: self.platform.over(file.platform),
            walks: self.walks.or_file(file.walks),
            writing: self.writing.over(file.writing),
            draw: self.draw.over(file.draw),
            roles: self.roles.or_file(file.roles),
            service: self.service.or_file(file.service),
            providers: file.providers,
        }
    }
}

impl From<AskedPlatform> for AskedSettings {
    fn from(platform: AskedPlatform) -> Self {
        Self { platform, ..Self::default() }
    }
}
