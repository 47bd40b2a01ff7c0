//! The setup that several measurements share: a platform with pictures that a scripted, flawed model can read, and a provider that plays
//! every role.

use rayon::{ThreadPoolBuilder, prelude::*};
use std::path::PathBuf;
use tempfile::TempDir;
use wayword_core::Platform;
use wayword_run::{
    calls::CallSpending,
    error::CommandError,
    follow::KnownScenes,
    lookout::DetectorLookout,
    output::CommandOutput,
    pipeline::{MadeItem, RunPlatform, make_item},
    plan::RunPlan,
    platforms,
    run_folder::fresh_id,
    settings::{
        AskedPlatform, AskedRoles, AskedSettings, Draw, EvidenceSources, Perception, RolePlayer, RunJob, RunSettings,
        Service, Walks, Writing,
    },
    team::RoleTeam,
    written_files::write_file,
};
use wayword_testkit::provider::{
    BarcodePlatform, ModelScript, PictureGallery, ProviderBehaviour, ProviderDialect, ScriptedProvider,
    scripts::{FlawedEye, ScriptedCast},
};

/// How often the scripted text roles make mistakes, as a share.
pub(super) const TEXT_ROLE_ERROR_SHARE: f64 = 0.2;
/// Items that are made at a time; they mostly wait for calls.
const MAX_ITEMS_AT_A_TIME: usize = 16;

/// The platform of a measurement.
#[derive(Debug, Clone, clap::Args)]
pub struct MeasuredWorldArgs {
    /// house or matterport.
    #[arg(long, default_value = "house")]
    pub(super) platform: String,
    /// Folder of the platform's data.
    #[arg(long)]
    pub(super) data: Option<PathBuf>,
    /// Use only this scene.
    #[arg(long)]
    pub(super) scan: Option<String>,
    /// Seed of the paths, and of everything that the scripted roles draw.
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
}

/// A platform, a provider, and a ledger only for them.
pub(super) struct MeasurementStage {
    pub(super) world: BarcodePlatform<Box<dyn Platform>>,
    pub(super) provider: ScriptedProvider,
    /// The folder of the ledger and the price list.
    folder: TempDir,
    seed: u64,
    /// The flags that the stage was made from.
    asked: MeasuredWorldArgs,
}

impl MeasurementStage {
    /// A setup in which `hallucinated_share` of the objects that the scripted eye names are not there.
    pub(super) fn new(asked: &MeasuredWorldArgs, hallucinated_share: f64) -> Result<Self, CommandError> {
        Self::with_eye(asked, |eye| FlawedEye { hallucinated_share, ..eye })
    }

    /// A setup with another eye than the usual one, which invents nothing here.
    pub(super) fn with_eye(
        asked: &MeasuredWorldArgs,
        change: impl FnOnce(FlawedEye) -> FlawedEye,
    ) -> Result<Self, CommandError> {
        let gallery = PictureGallery::default();
        let eye = change(FlawedEye::new(gallery.clone(), asked.seed, 0.0));
        let cast = ScriptedCast::new(eye, asked.seed, TEXT_ROLE_ERROR_SHARE);
        Self::with_scripts(asked, gallery, ProviderBehaviour::for_model("words", cast.clone()).and_model("eye", cast))
    }

    /// A setup in which one script plays all roles but the eye.
    pub(super) fn with_author(
        asked: &MeasuredWorldArgs,
        change: impl FnOnce(FlawedEye) -> FlawedEye,
        author: impl ModelScript + 'static,
    ) -> Result<Self, CommandError> {
        let gallery = PictureGallery::default();
        let eye = change(FlawedEye::new(gallery.clone(), asked.seed, 0.0));
        Self::with_scripts(asked, gallery, ProviderBehaviour::for_model("words", author).and_model("eye", eye))
    }

    fn with_scripts(
        asked: &MeasuredWorldArgs,
        gallery: PictureGallery,
        scripts: ProviderBehaviour,
    ) -> Result<Self, CommandError> {
        let io = |source| CommandError::Io { path: std::env::temp_dir(), doing: "set the measurement up in", source };
        let platform = platforms::open_platform(&asked_job(asked, 1).resolve()?)?;
        Ok(Self {
            world: BarcodePlatform::new(platform, gallery),
            provider: ScriptedProvider::start(scripts).map_err(io)?,
            folder: tempfile::tempdir().map_err(io)?,
            seed: asked.seed,
            asked: asked.clone(),
        })
    }

    /// A job of `paths` paths with every role played by the provider. Texts are checked against captions, as on a
    /// platform without labels.
    pub(super) fn writing_job(&self, paths: usize) -> Result<RunJob, CommandError> {
        let roles = AskedRoles {
            llm: Some("server/words".into()),
            see: Some("server/eye".into()),
            base_url: Some(self.provider.base_url(ProviderDialect::OpenAi)),
            ..AskedRoles::default()
        };
        let service = Service { ledger: Some(self.folder.path().join("ledger.db")), ..Service::default() };
        AskedSettings {
            roles,
            service,
            writing: Writing {
                evidence: Some(EvidenceSources::CAPTIONS_ALONE),
                style: Some(vec!["r2r".into()]),
                ..Writing::default()
            },
            draw: Draw { seed: Some(self.seed), ..Draw::default() },
            ..asked_job(&self.asked, paths)
        }
        .into_job()
    }

    /// A job of `paths` paths in which only the eye is a model, and gives structured answers. Rules play all other roles.
    pub(super) fn looking_job(&self, paths: usize) -> Result<RunJob, CommandError> {
        let mut job = self.writing_job(paths)?;
        let roles = &mut job.settings.roles;
        (roles.ask, roles.summarise, roles.write) = (RolePlayer::Rules, RolePlayer::Rules, RolePlayer::Rules);
        debug_assert!(roles.see != RolePlayer::Labels);
        let RunSettings { perception, evidence, .. } = &mut job.settings;
        (*perception, *evidence) = (Perception::Structured, EvidenceSources::default());
        Ok(job)
    }

    /// The calls in the ledger.
    #[cfg(test)]
    pub(super) fn calls(&self) -> Result<Vec<wayword_ledger::LedgerEntry>, CommandError> {
        let ledger = wayword_ledger::Ledger::open(&self.folder.path().join("ledger.db"))?;
        Ok(ledger.list_calls(&wayword_ledger::LedgerFilter::default())?)
    }

    /// Writes a price list in which every token costs something, and returns its path.
    pub(super) fn write_prices(&self) -> Result<PathBuf, CommandError> {
        let file = self.folder.path().join("prices.toml");
        let row = "usd_per_million_in = 10.0\nusd_per_million_out = 20.0\nas_of = \"2026-11-01\"\n";
        let text = format!("[\"server/words\"]\n{row}[\"server/eye\"]\n{row}");
        write_file(&file, text)?;
        Ok(file)
    }

    /// Makes every item of a job, and returns what was spent.
    pub(super) fn make_items(
        &self,
        job: &RunJob,
    ) -> Result<(Vec<Result<MadeItem, CommandError>>, CallSpending), CommandError> {
        self.make_items_with_detector(job, None)
    }

    /// Makes the items of a job one after the other; `before` is called with the number of each.
    pub(super) fn make_items_in_turn(
        &self,
        job: &RunJob,
        mut before: impl FnMut(usize),
    ) -> Result<Vec<MadeItem>, CommandError> {
        let plan = RunPlan::for_writing(job, &self.world)?;
        let calls = plan.models.open_calls(&fresh_id("measure"), &CommandOutput::new(false, true))?;
        let team = RoleTeam::new(&job.settings, calls.as_ref(), &self.world)?;
        let world = RunPlatform { platform: &self.world, data: None, scenes: &KnownScenes::new() };
        let make = |(number, item)| {
            before(number);
            make_item(item, &job.settings, world, &team, &plan.styles, 1)
        };
        plan.items.iter().enumerate().map(make).collect()
    }

    /// Makes every item of a job, with a detector that looks along the paths, and returns what was spent.
    pub(super) fn make_items_with_detector(
        &self,
        job: &RunJob,
        lookout: Option<DetectorLookout>,
    ) -> Result<(Vec<Result<MadeItem, CommandError>>, CallSpending), CommandError> {
        let plan = RunPlan::for_writing(job, &self.world)?;
        let calls = plan.models.open_calls(&fresh_id("measure"), &CommandOutput::new(false, true))?;
        let team = RoleTeam::new(&job.settings, calls.as_ref(), &self.world)?.with_lookout(lookout);
        let threads = ThreadPoolBuilder::new().num_threads(MAX_ITEMS_AT_A_TIME).build();
        let world = RunPlatform { platform: &self.world, data: None, scenes: &KnownScenes::new() };
        let make = |item| make_item(item, &job.settings, world, &team, &plan.styles, 1);
        let work = || plan.items.par_iter().map(make).collect();
        let made = match threads {
            Ok(threads) => threads.install(work),
            Err(_) => work(),
        };
        Ok((made, calls.map_or_else(CallSpending::default, |calls| calls.spent_so_far())))
    }
}

/// The settings of a job of `paths` paths on a platform.
fn asked_job(world: &MeasuredWorldArgs, paths: usize) -> AskedSettings {
    AskedSettings {
        platform: AskedPlatform {
            platform: Some(world.platform.clone()),
            data: world.data.clone(),
            ..AskedPlatform::default()
        },
        walks: Walks { scan: world.scan.clone().map(|scan| vec![scan]), paths: Some(paths), ..Walks::default() },
        ..AskedSettings::default()
    }
}
