//! What flags and the settings file ask for, group by group: each group is written once, and both are read into it.

use super::{Against, AskedRoles, Perception, Providers, Service, TargetMode};
use crate::{styles, world};
use clap::{Args, ValueEnum, builder::PossibleValuesParser};
use serde::Deserialize;
use std::path::PathBuf;
use wayword_synthesis::walk::FrameSelection;

/// A group of settings. All of it is optional, so that one says what another leaves out.
macro_rules! group {
    ($(#[$of:meta])* pub struct $Group:ident { $($(#[$how:meta])* pub $key:ident: Option<$Type:ty>,)* }) => {
        $(#[$of])*
        pub struct $Group { $($(#[$how])* pub $key: Option<$Type>,)* }

        impl $Group {
            /// What this says; what it leaves out, as `other` says it.
            pub(super) fn over(self, other: Self) -> Self {
                Self { $($key: self.$key.or(other.$key),)* }
            }
        }
    };
}
pub(super) use group;

/// Groups whose keys stand beside each other at the top of the settings file, by their fields in [`Asked`].
macro_rules! top_groups {
    ($($name:ident: $(#[$of:meta])* pub struct $Group:ident { $($(#[$how:meta])* pub $key:ident: Option<$Type:ty>,)* })*) => {
        $(group! { $(#[$of])* pub struct $Group { $($(#[$how])* pub $key: Option<$Type>,)* } })*

        /// The settings file as it is written. `#[serde(flatten)]` in [`Asked`] would do the same, but errors would no longer
        /// tell their line.
        #[derive(Default, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        struct SettingsFile {
            $($($key: Option<$Type>,)*)*
            roles: AskedRoles,
            service: Service,
            providers: Providers,
        }

        impl From<SettingsFile> for Asked {
            fn from(file: SettingsFile) -> Self {
                $(let $name = $Group { $($key: file.$key,)* };)*
                Self { $($name,)* roles: file.roles, service: file.service, providers: file.providers }
            }
        }
    };
}

/// What a run is asked to do. Everything is optional here: what a flag leaves out comes from the file, then from a default.
#[derive(Debug, Clone, Default, PartialEq, Args, Deserialize)]
#[serde(from = "SettingsFile")]
pub struct Asked {
    /// The world.
    #[command(flatten)]
    pub world: World,
    /// The paths that are walked.
    #[command(flatten)]
    pub walks: Walks,
    /// How they are seen and told of.
    #[command(flatten)]
    pub telling: Telling,
    /// What is drawn, and how many items.
    #[command(flatten)]
    pub draw: Draw,
    /// Who asks, sees, sums up and writes.
    #[command(flatten)]
    pub roles: AskedRoles,
    /// How models are reached, and what may be spent.
    #[command(flatten)]
    pub service: Service,
    /// Providers of the user's own; the settings file alone has them.
    #[arg(skip)]
    pub providers: Providers,
}

top_groups! {
world:
    /// Which world, and where its data lies.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct World {
        /// The world: house (generated, built in), matterport, habitat, tdw, virtualhome, process or recording; `wayword platforms`
        /// lists what each needs. [default: house]
        #[arg(long, value_parser = PossibleValuesParser::new(world::names()), hide_possible_values = true)]
        pub platform: Option<String>,
        /// Folder or file of the world's data.
        #[arg(long, value_name = "PATH")]
        pub data: Option<PathBuf>,
        /// Address of a world that runs: HOST:PORT for tdw, a URL for virtualhome.
        #[arg(long, value_name = "ADDRESS")]
        pub at: Option<String>,
        /// Walk on this island of a Habitat scene's ground, 0 being the largest; `wayword view map` lists them. [default: the one
        /// that lies under ceilings, or under the open sky where there are none]
        #[arg(long, value_name = "N")]
        pub island: Option<usize>,
    }

walks:
    /// Which paths are walked.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct Walks {
        /// Walk the paths of a dataset: R2R, REVERIE, RxR or Wayword.
        #[arg(long, value_name = "FILE")]
        pub episodes: Option<PathBuf>,
        /// Walk so many random paths. [default: 10, where no episodes are given]
        #[arg(long, value_name = "N")]
        pub paths: Option<usize>,
        /// Keep to this scene; may be given several times.
        #[arg(long, value_name = "SCENE")]
        pub scan: Option<Vec<String>>,
        /// Hops of random paths. [default: 4..7]
        #[arg(long, value_name = "FROM..TO")]
        pub hops: Option<String>,
        /// Lengths of random paths in metres. [default: 5..20]
        #[arg(long, value_name = "FROM..TO")]
        pub metres: Option<String>,
    }

telling:
    /// How paths are seen, and how they are told of.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct Telling {
        /// Style: r2r, reverie, a TOML file, or NAME=DATASET for a dataset's own texts; may be given several times.
        #[arg(long, value_name = "STYLE", value_parser = styles::typed)]
        pub style: Option<Vec<String>>,
        /// Caption the view along the heading, or four views around. [default: central]
        #[arg(long)]
        pub frames: Option<Frames>,
        /// Question by question, fixed queries without a dialogue, or a single request for a description. [default: dialogue]
        #[arg(long)]
        pub perception: Option<Perception>,
        /// Most questions per view. [default: 9]
        #[arg(long, value_name = "N")]
        pub questions: Option<usize>,
        /// Name the episode's object to the writer, or leave the choice to it. [default: given]
        #[arg(long)]
        pub target: Option<TargetMode>,
        /// How often a text that failed a check is written again. [default: 8, where a model writes 3]
        #[arg(long, value_name = "N")]
        pub repairs: Option<u32>,
        /// Hold texts against the platform's labels where it has them, or against the captions alone. [default: labels]
        #[arg(long)]
        pub evidence: Option<Against>,
    }

draw:
    /// What is drawn, and how many items.
    #[derive(Debug, Clone, Default, PartialEq, Args)]
    pub struct Draw {
        /// Seed of everything random; random paths are named by it, so runs that are to be merged need different ones. [default: 0]
        #[arg(long)]
        pub seed: Option<u64>,
        /// Only the first so many items.
        #[arg(long, value_name = "N")]
        pub limit: Option<usize>,
    }
}

/// Which views are captioned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum Frames {
    /// The view along the heading.
    Central,
    /// North, east, south and west, condensed.
    Panoramic,
}

impl From<Frames> for FrameSelection {
    fn from(frames: Frames) -> Self {
        match frames {
            Frames::Central => Self::Central,
            Frames::Panoramic => Self::Panoramic,
        }
    }
}

impl World {
    /// Its name: the default's where none is asked for.
    #[must_use]
    pub fn name(&self) -> &str {
        self.platform.as_deref().unwrap_or("house")
    }
}

impl Walks {
    /// What flags ask for, with the rest from a file.
    fn or(self, mut file: Self) -> Self {
        // Episodes and random paths exclude each other, so a flag for one wins over a file's other.
        if self.paths.is_some() {
            file.episodes = None;
        }
        if self.episodes.is_some() {
            file.paths = None;
        }
        self.over(file)
    }
}

impl Asked {
    /// What flags ask for, with the rest from a file.
    #[must_use]
    pub fn or(self, file: Self) -> Self {
        Self {
            world: self.world.over(file.world),
            walks: self.walks.or(file.walks),
            telling: self.telling.over(file.telling),
            draw: self.draw.over(file.draw),
            roles: self.roles.or(file.roles),
            service: self.service.or(file.service),
            providers: file.providers,
        }
    }
}

impl From<World> for Asked {
    fn from(world: World) -> Self {
        Self { world, ..Self::default() }
    }
}
