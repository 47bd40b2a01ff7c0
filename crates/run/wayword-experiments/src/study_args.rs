//! The command line of `wayword study`. It is compiled even into builds without studies.

use clap::{Args, Subcommand, ValueEnum};
use std::{net::SocketAddr, path::PathBuf, str::FromStr};
use wayword_run::settings::AskedPlatform;

/// `wayword study`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword study new --run ours=runs/central#r2r --run theirs=runs/other#r2r --mode follow --out STUDY
      Make a study: people follow the texts of two runs through generated houses.
  wayword study plan STUDY
      See how many people it needs, and which differences it would find.
  wayword study serve STUDY --preview
      Walk through it yourself. Nothing is stored.
  wayword study serve STUDY --links 3
      Show it on this machine, and print three personal links.
  wayword study status STUDY
  wayword study results STUDY --out FOLDER
  wayword study close STUDY

docs/STUDY.md says what participants see, how nothing is lost, and what stands in the results.")]
pub struct StudyArgs {
    /// What to do.
    #[command(subcommand)]
    pub command: StudyCommand,
}

/// What can be done with a study.
#[derive(Debug, Subcommand)]
pub enum StudyCommand {
    /// Make a study from runs: choose paths, draw their pictures, write its folder.
    New(Box<StudyNew>),
    /// Show the study to people.
    Serve(StudyServe),
    /// Make personal links, one for each participant.
    Invite(StudyInvite),
    /// Show how many people the study needs, and which differences it would find.
    Plan(StudyPlan),
    /// Write the words of all pages in English, as a file to translate.
    #[command(after_long_help = "Examples:\n  wayword study texts > de.toml")]
    Texts,
    /// Show how far it is.
    Status(StudyStatus),
    /// Write tables, plots, raw data and a codebook.
    Results(StudyResults),
    /// Remove all that one participant gave.
    Forget(StudyForget),
    /// Compare a recruiter's list of participants with ours.
    Reconcile(StudyReconcile),
    /// Take no more answers, and drop the recruiter's ids.
    Close(StudyClose),
}

/// `wayword study new`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword study new --run ours=runs/houses#r2r --mode follow --out STUDY
  wayword study new --run a=runs/central#r2r --run b=runs/other#r2r --include original,other-path --episodes R2R_val_seen.json \\
      --platform matterport --data DATA --i-have-the-right --items 60 --per-item 5 --mode rate --out STUDY
  wayword study new --run plain=runs/a#r2r --run marked=runs/a#r2r --doubts marked --mode follow --out STUDY
  wayword study new --run a=runs/a#r2r --run b=runs/b#r2r --mode pair --recruiter prolific --out STUDY
  wayword study texts > de.toml
  wayword study new --run ours=runs/houses#r2r --mode rate --texts de.toml --out STUDY
      Pages in another language: translate the file in between.")]
pub struct StudyNew {
    /// A set of texts: NAME=RUN#STYLE or NAME=FILE. Give the flag several times to compare sets.
    #[arg(long, value_name = "NAME=SET", required = true)]
    pub run: Vec<NamedSet>,
    /// Controls: original (the texts of --episodes), other-path (a text of another path in the same scene) and corrupted (the text itself,
    /// with its sides turned and its landmarks exchanged). The last two show what a wrong text reaches; corrupted needs no second path.
    #[arg(long, value_name = "CONTROLS", value_delimiter = ',')]
    pub include: Vec<StudyControl>,
    /// Mark the words to doubt in the texts of this set or control, with the alternatives, for those who follow them.
    /// May be given several times. The same run under two names, one of them marked, shows what the marks are worth.
    #[arg(long, value_name = "NAME")]
    pub doubts: Vec<String>,
    /// Dataset file of the paths: R2R, REVERIE, RxR, VLN-CE or Wayword. [default: the paths of the first run]
    #[arg(long, value_name = "FILE")]
    pub episodes: Option<PathBuf>,
    /// The platform of the paths.
    #[command(flatten)]
    pub platform: AskedPlatform,
    /// What people do: follow (follow the text as an instruction), rate (answer four questions about it) or pair (choose between two).
    #[arg(long, value_name = "MODE")]
    pub mode: StudyMode,
    /// How many paths. Each has one text for every condition. One more path is for practice, so N + 1 paths are needed.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub items: u32,
    /// How many answers each text gets, from as many people.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub per_item: u32,
    /// How many texts a participant gets, each about another path.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=200))]
    pub per_participant: u32,
    /// Where participants come from: links (personal ones), prolific or mturk.
    #[arg(long, value_name = "RECRUITER", default_value = "links")]
    pub recruiter: StudyRecruiter,
    /// The words of the pages in another language: a translation of what `study texts` writes.
    #[arg(long, value_name = "FILE")]
    pub texts: Option<PathBuf>,
    /// Confirm that you may show the pictures of this platform to participants. Every platform but house needs it: its scenes
    /// belong to somebody.
    #[arg(long)]
    pub i_have_the_right: bool,
    /// Seed of the choice of paths and of everything else that is random, but tokens.
    #[arg(long, default_value_t = 0)]
    pub seed: u64,
    /// Folder for the study.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// Texts that show what the figures of a study are worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StudyControl {
    /// Those of the dataset.
    #[value(name = "original", alias = "people")]
    People,
    /// Those of other paths.
    OtherPath,
    /// Those of the first run, or of people, with their sides turned and their landmarks exchanged.
    Corrupted,
}

/// What people do.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StudyMode {
    /// Follow it as an instruction.
    Follow,
    /// Answer questions about it.
    Rate,
    /// Choose between two.
    Pair,
}

/// Where participants come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum StudyRecruiter {
    /// Personal links.
    Links,
    /// Prolific's placeholders.
    Prolific,
    /// MTurk's parameters.
    Mturk,
}

/// `wayword study serve`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword study serve STUDY --links 5
      On this machine only. Put a server with TLS before it, and name the address that people use: --public https://study.example.org
  wayword study serve STUDY --listen 0.0.0.0:8443 --tls cert.pem key.pem
  wayword study serve STUDY --listen 0.0.0.0:8443 --self-signed --links 1
      For phones in the room: prints a link and a QR code. Browsers warn of the certificate.

Stop it with Ctrl-C, and start it again with the same command, but without --links: participants go on where they were, and the links that
were made stay valid.")]
pub struct StudyServe {
    /// Folder of the study.
    pub study: PathBuf,
    /// Address and port to listen on, as 127.0.0.1:8080 or 0.0.0.0:8080.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:8080", value_parser = listen_address)]
    pub listen: SocketAddr,
    /// The address that participants open, where another server passes requests on to this one.
    #[arg(long, value_name = "URL", value_parser = public_url)]
    pub public: Option<String>,
    /// Certificate chain and private key, as PEM files.
    #[arg(long, num_args = 2, value_names = ["CERT", "KEY"], conflicts_with_all = ["self_signed", "insecure_lan"])]
    pub tls: Option<Vec<PathBuf>>,
    /// Use a certificate that the study makes for itself.
    #[arg(long, conflicts_with = "insecure_lan")]
    pub self_signed: bool,
    /// Listen on other addresses than this machine's without TLS. Others in the network can read along.
    #[arg(long)]
    pub insecure_lan: bool,
    /// Show the study to yourself: a link that walks through it, on marked pages. Nothing is stored. It can run beside the site for participants, with
    /// another --listen.
    #[arg(long, conflicts_with = "links")]
    pub preview: bool,
    /// Make so many new personal links, and print them. Links of earlier commands stay valid.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub links: u32,
}

/// Reads an address to listen on. The names `localhost` and an empty host mean this machine alone.
fn listen_address(text: &str) -> Result<SocketAddr, String> {
    let form = "give an address and a port, as 127.0.0.1:8080, or 0.0.0.0:8443 for all networks";
    let Some((host, port)) = text.rsplit_once(':') else {
        return Err(format!("the port is missing; {form}"));
    };
    if port.parse::<u16>().is_err() {
        return Err(format!("{port:?} is no port, which is a number from 0 to 65535; {form}"));
    }
    let host = if host.is_empty() || host.eq_ignore_ascii_case("localhost") { "127.0.0.1" } else { host };
    format!("{host}:{port}").parse().map_err(|_| format!("{host:?} is no IP address; {form}"))
}

fn public_url(text: &str) -> Result<String, String> {
    let host =
        text.strip_prefix("https://").or_else(|| text.strip_prefix("http://")).map(|host| host.trim_end_matches('/'));
    match host {
        Some(host) if !host.is_empty() && !host.contains('/') => Ok(text.trim_end_matches('/').to_owned()),
        _ => Err("give the scheme and host alone, as https://study.example.org".to_owned()),
    }
}

/// `wayword study invite`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword study invite STUDY --links 20 --public https://study.example.org")]
pub struct StudyInvite {
    /// Folder of the study.
    pub study: PathBuf,
    /// How many links.
    #[arg(long = "links", alias = "count", value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub count: u32,
    /// The address that participants open.
    #[arg(long = "public", alias = "url", value_name = "URL", default_value = "http://127.0.0.1:8080", value_parser = public_url)]
    pub url: String,
}

/// `wayword study plan`.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  wayword study plan STUDY
  wayword study plan STUDY --effect 15 --base 70
      How often it finds 15 points between two shares around 70 %, and how many participants that needs.
  wayword study plan STUDY --person-sd 0.5 --route-sd 0.8 --routes 80
      With your own assumptions of how much persons and routes differ, and another number of routes.
  wayword study plan STUDY --out preregistration.md
      Write a sheet for preregistration, filled in from study.toml and this plan.")]
pub struct StudyPlan {
    /// Folder of the study.
    pub study: PathBuf,
    /// The difference that the study shall find, in points of per cent; in mode pair, the distance from an even split.
    #[arg(long, value_name = "POINTS", default_value_t = 20.0)]
    pub effect: f64,
    /// The share around which both conditions lie, in per cent. At 50 a difference is hardest to find.
    #[arg(long, value_name = "PERCENT", default_value_t = 50.0)]
    pub base: f64,
    /// How much persons differ in what a condition does to them: a standard deviation on the logit scale. [default: 0, 0.5 and 1]
    #[arg(long, value_name = "SD")]
    pub person_sd: Option<f64>,
    /// How much routes differ in the same sense. [default: 0, 0.5 and 1]
    #[arg(long, value_name = "SD")]
    pub route_sd: Option<f64>,
    /// Plan for another number of routes than the study has.
    #[arg(long, value_name = "N")]
    pub routes: Option<usize>,
    /// Plan for another number of participants than the study needs.
    #[arg(long, value_name = "N")]
    pub participants: Option<usize>,
    /// Write a sheet for preregistration (Markdown) to this new file.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wayword study status`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword study status STUDY\n  wayword study status STUDY --participants")]
pub struct StudyStatus {
    /// Folder of the study.
    pub study: PathBuf,
    /// List the participants too.
    #[arg(long)]
    pub participants: bool,
}

/// `wayword study results`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword study results STUDY --out FOLDER")]
pub struct StudyResults {
    /// Folder of the study.
    pub study: PathBuf,
    /// Folder for tables, plots, raw data and codebook.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
}

/// `wayword study forget`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Examples:\n  wayword study forget STUDY --participant 5f2c1e --dry-run\n  wayword study forget STUDY --participant 5f2c1e"
)]
pub struct StudyForget {
    /// Folder of the study.
    pub study: PathBuf,
    /// The participant: our id (`status --participants` lists them), the recruiter's, or a personal link.
    // Ids are drawn from an alphabet that has a hyphen, so one may begin with it.
    #[arg(long, value_name = "ID", allow_hyphen_values = true)]
    pub participant: String,
    /// Only show what would be removed.
    #[arg(long)]
    pub dry_run: bool,
}

/// `wayword study reconcile`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword study reconcile STUDY prolific_export.csv")]
pub struct StudyReconcile {
    /// Folder of the study.
    pub study: PathBuf,
    /// The recruiter's export: CSV with a column `Participant id` (or `WorkerId`) and a column `Status`.
    pub csv: PathBuf,
}

/// `wayword study close`.
#[derive(Debug, Args)]
#[command(after_long_help = "Examples:\n  wayword study close STUDY")]
pub struct StudyClose {
    /// Folder of the study.
    pub study: PathBuf,
    /// Close it even if participants are in the middle of it.
    #[arg(long)]
    pub even_if_live: bool,
}

/// A name and a source of texts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamedSet {
    /// The condition.
    pub name: String,
    /// Run or file.
    pub source: String,
}

impl FromStr for NamedSet {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        let is_plain = |name: &str| {
            !name.is_empty()
                && name.chars().all(|letter| letter.is_ascii_alphanumeric() || matches!(letter, '-' | '_' | '.'))
        };
        match typed.split_once('=') {
            Some((name, source)) if is_plain(name) && !source.is_empty() => {
                Ok(Self { name: name.to_owned(), source: source.to_owned() })
            }
            _ => Err("give NAME=RUN#STYLE or NAME=FILE; a name has letters, digits, - _ and .".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_to_listen_on_is_read_or_refused_with_its_form() {
        for (text, read) in [
            ("localhost:8080", "127.0.0.1:8080"),
            (":0", "127.0.0.1:0"),
            ("0.0.0.0:8443", "0.0.0.0:8443"),
            ("[::1]:80", "[::1]:80"),
        ] {
            assert_eq!(listen_address(text).map(|address| address.to_string()).as_deref(), Ok(read));
        }
        for (text, said) in [
            ("localhost", "the port is missing"),
            (":80999", "\"80999\" is no port"),
            ("127.0.0.1:", "\"\" is no port"),
            ("study.example.org:80", "is no IP address"),
            ("::1:80", "is no IP address"),
        ] {
            let told = listen_address(text).unwrap_err();
            assert!(told.contains(said) && told.contains("127.0.0.1:8080"), "{text}: {told}");
        }
    }
}
