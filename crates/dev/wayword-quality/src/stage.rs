//! The setup that several measurements share: a platform with pictures that a scripted, flawed model can read, and a provider that plays
//! every role.

use rayon::{ThreadPoolBuilder, prelude::*};
use std::path::PathBuf;
use tempfile::TempDir;
use wayword_core::Platform;
use wayword_run::{
    calls::Spent,
    error::Error,
    follow::KnownScenes,
    looking_for::Lookout,
    output::Output,
    pipeline::{Made, RunPlatform, make},
    plan::Plan,
    platforms,
    run_folder::fresh_id,
    settings::{Asked, AskedPlatform, AskedRoles, Draw, Job, Service, Sources, Walks, Writing},
    team::Team,
};
use wayword_testkit::provider::{
    Behaviour, Dialect, Gallery, Pictured, Provider,
    scripts::{Cast, FlawedEye},
};

/// How often the scripted text roles make mistakes, as a share.
pub(super) const CARELESSNESS: f64 = 0.2;
/// Items that are made at a time; they mostly wait for calls.
const AT_A_TIME: usize = 16;

/// The platform of a measurement.
#[derive(Debug, Clone, clap::Args)]
pub struct World {
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
pub(super) struct Stage {
    pub(super) world: Pictured<Box<dyn Platform>>,
    pub(super) provider: Provider,
    folder: TempDir,
    seed: u64,
    asked: World,
}

impl Stage {
    /// A setup in which `hallucinated_share` of the objects that the scripted eye names are not there.
    pub(super) fn new(asked: &World, hallucinated_share: f64) -> Result<Self, Error> {
        let io = |source| Error::Io { path: std::env::temp_dir(), doing: "set the measurement up in", source };
        let gallery = Gallery::default();
        let platform = platforms::open(&asked_job(asked, 1).resolve()?)?;
        let cast = Cast::new(FlawedEye::new(gallery.clone(), asked.seed, hallucinated_share), asked.seed, CARELESSNESS);
        Ok(Self {
            world: Pictured::new(platform, gallery),
            provider: Provider::start(Behaviour::of("words", cast.clone()).and("eye", cast)).map_err(io)?,
            folder: tempfile::tempdir().map_err(io)?,
            seed: asked.seed,
            asked: asked.clone(),
        })
    }

    /// A job of `paths` paths with every role played by the provider. Texts are checked against captions, as on a
    /// platform without labels.
    pub(super) fn job(&self, paths: usize) -> Result<Job, Error> {
        let roles = AskedRoles {
            llm: Some("server/words".into()),
            see: Some("server/eye".into()),
            base_url: Some(self.provider.base_url(Dialect::OpenAi)),
            ..AskedRoles::default()
        };
        let service = Service { ledger: Some(self.folder.path().join("ledger.db")), ..Service::default() };
        Asked {
            roles,
            service,
            writing: Writing {
                evidence: Some(Sources::CAPTIONS),
                style: Some(vec!["r2r".into()]),
                ..Writing::default()
            },
            draw: Draw { seed: Some(self.seed), ..Draw::default() },
            ..asked_job(&self.asked, paths)
        }
        .job()
    }

    /// The calls in the ledger.
    #[cfg(test)]
    pub(super) fn calls(&self) -> Result<Vec<wayword_ledger::Row>, Error> {
        let ledger = wayword_ledger::Ledger::open(&self.folder.path().join("ledger.db"))?;
        Ok(ledger.list(&wayword_ledger::Filter::default())?)
    }

    /// Writes a price list in which every token costs something, and returns its path.
    pub(super) fn prices(&self) -> Result<PathBuf, Error> {
        let file = self.folder.path().join("prices.toml");
        let row = "usd_per_million_in = 10.0\nusd_per_million_out = 20.0\nas_of = \"2026-11-01\"\n";
        let text = format!("[\"server/words\"]\n{row}[\"server/eye\"]\n{row}");
        std::fs::write(&file, text).map_err(Error::io(&file, "write"))?;
        Ok(file)
    }

    /// Makes every item of a job, and returns what was spent.
    pub(super) fn make(&self, job: &Job) -> Result<(Vec<Result<Made, Error>>, Spent), Error> {
        self.make_with(job, None)
    }

    /// The same, with a detector that looks along the paths.
    pub(super) fn make_with(
        &self,
        job: &Job,
        lookout: Option<Lookout>,
    ) -> Result<(Vec<Result<Made, Error>>, Spent), Error> {
        let plan = Plan::writing(job, &self.world)?;
        let calls = plan.models.open(&fresh_id("measure"), &Output::new(false, true))?;
        let team = Team::new(&job.settings, calls.as_ref(), &self.world)?.with(lookout);
        let threads = ThreadPoolBuilder::new().num_threads(AT_A_TIME).build();
        let world = RunPlatform { platform: &self.world, data: None, scenes: &KnownScenes::new() };
        let one = |item| make(item, &job.settings, world, &team, &plan.styles, 1);
        let work = || plan.items.par_iter().map(one).collect();
        let made = match threads {
            Ok(threads) => threads.install(work),
            Err(_) => work(),
        };
        Ok((made, calls.map_or_else(Spent::default, |calls| calls.spent())))
    }
}

fn asked_job(world: &World, paths: usize) -> Asked {
    Asked {
        platform: AskedPlatform {
            platform: Some(world.platform.clone()),
            data: world.data.clone(),
            ..AskedPlatform::default()
        },
        walks: Walks { scan: world.scan.clone().map(|scan| vec![scan]), paths: Some(paths), ..Walks::default() },
        ..Asked::default()
    }
}
