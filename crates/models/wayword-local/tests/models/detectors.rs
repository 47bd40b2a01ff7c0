//! Finds a detector in process by its name, and keeps its calls.

use crate::common::{fixture, refused};
use std::{
    f64::consts::FRAC_PI_2,
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{DVec3, Heading, Image, ObjectDetector, Pose, View};
use wayword_ledger::{Ledger, LedgerFilter, LedgerRun, RunLimits};
use wayword_local::{HubConfig, LoadingOptions, LocalModels, ModelDevice, ModelHub, WeightPrecision};

fn name(folder: &Path) -> String {
    format!("hf/{}", folder.display())
}

fn models(run: LedgerRun, memory_bytes: Option<u64>, precision: Option<WeightPrecision>) -> LocalModels {
    let mut config = HubConfig::new(PathBuf::from("/nowhere"));
    config.offline = true;
    let loading = LoadingOptions { device: ModelDevice::cpu(), precision, memory_bytes };
    LocalModels::new(ModelHub::new(config).unwrap(), loading, Box::new(()), run)
}

fn run(ledger: &Ledger, id: &str) -> LedgerRun {
    ledger.start_run(id, RunLimits::default()).unwrap()
}

fn view(shade: u8) -> View {
    let bytes = (0..40 * 30 * 3_u32).map(|at| (at * 7 % 251) as u8 ^ shade).collect();
    let image = Image::new(40, 30, bytes).unwrap();
    View::new(Pose::looking_level(DVec3::ZERO, Heading::NORTH), FRAC_PI_2, Some(Arc::new(image)), None)
}

#[test]
fn answers_are_stored_by_view_and_phrase() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = Ledger::open(&folder.path().join("ledger.db")).unwrap();
    let (first, second) = (run(&ledger, "first"), run(&ledger, "second"));
    let name = name(&fixture("owl"));
    let (here, there) = (view(0), view(1));
    let owl = models(first.clone(), None, None).get_detector(&name).unwrap();
    assert_eq!(owl.name(), name);
    assert!(owl.origin().contains("sha256:") && owl.origin().contains("f32"), "{}", owl.origin());
    let computed = owl.detect_phrases(&[&here, &there], &["stairs", "red door", "sink"]);
    assert_eq!((first.totals().answered, first.totals().hits), (6, 0));
    // Another process, with another list of phrases.
    let again = models(second.clone(), None, None)
        .get_detector(&name)
        .unwrap()
        .detect_phrases(&[&there], &["sink", "lamp", "stairs"]);
    assert_eq!((second.totals().answered, second.totals().hits), (1, 2));
    let (again, computed) = (again[0].as_ref().unwrap(), computed[1].as_ref().unwrap());
    assert_eq!((&again[0], &again[2]), (&computed[2], &computed[0]));
    assert!(again.iter().all(|places| !places.is_empty()));
    assert_eq!(ledger.list_calls(&LedgerFilter::default()).unwrap().len(), 7);
    assert_eq!(second.totals().usd, 0.0);
    // Other weights have other answers.
    let third = run(&ledger, "third");
    models(third.clone(), None, Some(WeightPrecision::Bf16))
        .get_detector(&name)
        .unwrap()
        .detect_phrases(&[&there], &["sink"]);
    assert_eq!(third.totals().hits, 0);
}

#[test]
fn a_detector_is_loaded_once_and_looked_for_without_loading() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = Ledger::open(&folder.path().join("ledger.db")).unwrap();
    let models = models(run(&ledger, "run"), None, None);
    let name = name(&fixture("owl"));
    models.ensure_detector_files(&name).unwrap();
    assert!(Arc::ptr_eq(&models.get_detector(&name).unwrap(), &models.get_detector(&name).unwrap()));
}

#[test]
fn a_model_that_is_no_detector_is_refused_before_loading() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = Ledger::open(&folder.path().join("ledger.db")).unwrap();
    let models = models(run(&ledger, "run"), None, None);
    for (name, told) in [
        (name(&fixture("clip")), vec!["config.json", "model_type clip", "owlv2-base-patch16-ensemble"]),
        (name(&fixture("nothing")), vec!["config.json", "missing"]),
        ("hf/a/b+c/d".to_owned(), vec!["a detector is one model"]),
        ("openai/gpt".to_owned(), vec!["does not begin with hf/"]),
        ("hf/a/b:c.gguf".to_owned(), vec!["GGUF"]),
    ] {
        let at_hand = models.ensure_detector_files(&name).unwrap_err().to_string();
        let loaded = refused(models.get_detector(&name));
        for error in [at_hand, loaded] {
            assert!(told.iter().all(|told| error.contains(told)), "{error}");
        }
    }
    assert!(LocalModels::check_detector_name("hf/a/b").is_ok() && LocalModels::check_detector_name("hf/a").is_err());
}

#[test]
fn a_detector_that_does_not_fit_into_the_memory_is_refused_before_it_is_loaded() {
    let folder = tempfile::tempdir().unwrap();
    let ledger = Ledger::open(&folder.path().join("ledger.db")).unwrap();
    // The weights are small: the features that it keeps are not.
    let models = models(run(&ledger, "run"), Some(500 << 20), None);
    let error = refused(models.get_detector(&name(&fixture("owl"))));
    assert!(error.contains("fixtures/owl") && error.contains("of memory"), "{error}");
}
