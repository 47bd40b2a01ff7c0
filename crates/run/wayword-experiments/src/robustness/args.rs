//! The command line of `wayword robustness`.

use clap::Args;
use std::path::PathBuf;
use wayword_run::settings::Service;

/// `wayword robustness`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword robustness --run runs/houses --out runs/robust
      Write the run's texts again in the default set of changed worlds, and say how much of them changes.
  wayword robustness --list
      Show all changes, with their units and what the default set is.
  wayword robustness --run runs/houses --change mirror --change camera_height_m=0.3,0.88,1.6 --out runs/robust
  wayword robustness --run runs/houses --eye recall=0.9,mistakes=0.05 --change blur_px=2,8,20 --out runs/blurred
      Pictures change here, so a scripted eye looks; its recall falls with the dose by a stated formula.
  wayword robustness --run runs/houses --eye guesses-sides --change mirror --out runs/guesses
  wayword robustness --run runs/houses --change platform=habitat --out runs/elsewhere
      The same poses on another platform: the houses are saved as glTF and read as Habitat reads them.
  wayword robustness --run runs/houses --change platform=virtualhome@http://127.0.0.1:8080 --scene-name house2-3=home_2 --out runs/elsewhere
  wayword robustness --compared runs/table
      Mean and spread of each agent's success over the sets of a comparison, and where it varies.

Give the same command again to continue. With more --change, only these are added. docs/ROBUSTNESS.md says what the figures mean.")]
pub struct RobustnessArgs {
    /// The run whose texts are written again. Its platform, paths, styles and models are used.
    #[arg(long, value_name = "DIR", required_unless_present_any = ["list", "compared"])]
    pub run: Option<PathBuf>,
    /// A change, with its doses: NAME or NAME=DOSE,DOSE. Give the flag several times. [default: the default set of --list]
    #[arg(long, value_name = "CHANGE")]
    pub change: Vec<String>,
    /// Folder for the texts, the figures and the page. Give the same command again to continue.
    #[arg(long, value_name = "DIR", required_unless_present_any = ["list", "compared"])]
    pub out: Option<PathBuf>,
    /// Show all changes and the default set, and do nothing.
    #[arg(long)]
    pub list: bool,
    /// A folder that `wayword compare` made: how much success varies among its sets of instructions, and whether they rank
    /// agents alike. Give the flag several times to join folders; each has its sets.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["run", "change", "out", "eye", "list"])]
    pub compared: Vec<PathBuf>,
    /// A scripted eye sees instead of labels: recall=SHARE, mistakes=SHARE, falls=SHARE, rises=SHARE, guesses-sides, joined by
    /// commas. It answers from the labels of the same pose; its recall falls and its mistakes rise with the dose.
    #[arg(long, value_name = "EYE")]
    pub eye: Option<String>,
    /// The name that another platform has for a scene of the run, for `--change platform=`: SCENE=NAME, or @FILE with one such
    /// line for each scene. Give the flag several times. A scene may have several names: on each platform the first counts
    /// that is there, and after these the scene's own name.
    #[arg(long, value_name = "SCENE=NAME|@FILE")]
    pub scene_name: Vec<String>,
    /// Use only the first N paths of the run.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub limit: Option<u32>,
    /// Number of bootstrap resamples for the intervals.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = clap::value_parser!(u32).range(100..=100_000))]
    pub resamples: u32,
    /// Seed of everything random.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Settings as TOML; only its tables `service` and `providers` are used.
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
    /// How models are reached.
    #[command(flatten)]
    pub service: Service,
}
