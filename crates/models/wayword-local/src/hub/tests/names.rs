//! Tests the names of models, which become paths and addresses, and the addresses that a redirect may lead to.

use crate::hub::{
    ModelName,
    cache::RepoFolder,
    client::WebAddress,
    name::{HubModelName, ModelSource},
};
use proptest::prelude::*;
use std::path::{Component, Path};

#[test]
fn parse_finds_the_place_of_a_model() {
    let hub = |text: &str| match ModelName::parse(text).unwrap().source {
        ModelSource::Hub(model) => (model.org, model.name, model.revision, model.file.unwrap_or_default()),
        other => panic!("{text}: {other:?}"),
    };
    let told = |parts: [&str; 4]| parts.map(str::to_owned).into();
    assert_eq!(hub("hf/Salesforce/blip-vqa-base"), told(["Salesforce", "blip-vqa-base", "main", ""]));
    assert_eq!(hub("hf/a/b.c_d@refs/pr/7"), told(["a", "b.c_d", "refs/pr/7", ""]));
    assert_eq!(hub("hf/a/b:q4/x.GGUF"), told(["a", "b", "main", "q4/x.GGUF"]));
    assert_eq!(hub("hf/a/b@v1:x.gguf"), told(["a", "b", "v1", "x.gguf"]));
    assert_eq!(hub("hf/a/b@v1:x.pth"), told(["a", "b", "v1", "x.pth"]));
    for (text, kinds) in [("hf/a/b", (false, false)), ("hf/a/b:x.gguf", (true, false)), ("hf/a/b:x.pth", (false, true))]
    {
        let name = ModelName::parse(text).unwrap();
        assert_eq!((name.is_gguf(), name.is_trained(), name.is_file()), (kinds.0, kinds.1, kinds.0 || kinds.1));
    }
    for (text, source) in [
        ("hf//models/blip", ModelSource::Folder("/models/blip".into())),
        ("hf/./blip", ModelSource::Folder("./blip".into())),
        ("hf/../blip:2@home", ModelSource::Folder("../blip:2@home".into())),
        ("hf//models/x.gguf", ModelSource::File("/models/x.gguf".into())),
        ("hf/./x.pth", ModelSource::File("./x.pth".into())),
    ] {
        let name = ModelName::parse(text).unwrap();
        assert_eq!((&name.source, name.to_string().as_str()), (&source, text));
    }
}

#[test]
fn names_that_lead_elsewhere_or_nowhere_are_refused() {
    for text in [
        "",
        "hf/",
        "hf/name",
        "ollama/a/b",
        "hf/a/",
        "hf/a/b/c",
        "hf/a/..",
        "hf/.a/b",
        "hf/a--b/c",
        "hf/a/b@",
        "hf/a/b@../x",
        "hf/a/b@x/../../y",
        "hf/a/b@/x",
        "hf/a/b@x:y",
        "hf/a/b:",
        "hf/a/b:model.bin",
        "hf/a/b:../x.gguf",
        "hf/a/b:/x.gguf",
        "hf/a/b:x\\y.gguf",
        "hf/a/b:.gguf",
        "hf/a/b:x?.gguf",
        "hf/a b/c",
        "hf/a/b\n",
        "hf//a\u{0}b",
        "hf/a\u{e9}/b",
    ] {
        let problem = ModelName::parse(text).expect_err(text).to_string();
        assert!(problem.contains("\nhint: names are hf/ORG/NAME"), "{problem}");
        assert!(!problem.split("\nhint").next().unwrap().chars().any(char::is_control), "{problem:?}");
    }
    assert!(ModelName::parse(&format!("hf/a/{}", "b".repeat(97))).is_err());
}

/// A valid name with a few characters put into it.
fn nearly_a_name() -> impl Strategy<Value = String> {
    let names = prop::sample::select(vec!["hf/org/name", "hf/org/name@main", "hf/org/name@refs/pr/1:q4/file.gguf"]);
    let odd = prop::collection::vec((any::<prop::sample::Index>(), "[-a./@:%\\\\?# ]{1,2}"), 0..3);
    (names, odd).prop_map(|(name, odd)| {
        odd.into_iter().fold(name.to_owned(), |mut name, (at, odd)| {
            name.insert_str(at.index(name.len() + 1), &odd);
            name
        })
    })
}

#[test]
fn revisions_and_files_are_encoded() {
    let hub = WebAddress::parse_endpoint("https://huggingface.co/").unwrap();
    let on_hub = HubModelName { org: "org".into(), name: "name".into(), revision: "main".into(), file: None };
    assert_eq!(
        hub.file_address(&on_hub, "refs/pr/1", "a/b+c.gguf"),
        "https://huggingface.co/org/name/resolve/refs%2Fpr%2F1/a/b%2Bc.gguf"
    );
}

#[test]
fn redirects_lead_within_the_host_or_elsewhere_but_never_from_https_to_http() {
    let from = WebAddress::parse("https://hub.example/a/b?c=d").unwrap();
    assert_eq!(from.follow_location("/x?y=z").unwrap().text, "https://hub.example:443/x?y=z");
    assert_eq!(from.follow_location("/x").unwrap().server_origin(), from.server_origin());
    assert_eq!(from.follow_location("//other.example/x").unwrap().server_origin().1, "other.example");
    assert_ne!(from.follow_location("https://hub.example:8443/").unwrap().server_origin(), from.server_origin());
    for location in ["http://hub.example/", "ftp://hub.example/", "x", "", "https://u:p@hub.example/", "//"] {
        assert!(from.follow_location(location).is_err(), "{location}");
    }
}

#[test]
fn error_does_not_repeat_an_invalid_endpoint() {
    for text in ["", "huggingface.co", "https://me:hunter2@host", "https://host/?q", "https://host/#x", "http://"] {
        let problem = WebAddress::parse_endpoint(text).unwrap_err();
        assert!(!problem.contains("hunter2"));
    }
}

proptest! {
    #[test]
    fn whatever_is_accepted_stays_in_its_folder_and_below_its_address(text in nearly_a_name()) {
        let Ok(name) = ModelName::parse(&text) else { return Ok(()) };
        prop_assert_eq!(name.to_string(), &text[..]);
        let ModelSource::Hub(model) = &name.source else { return Ok(()) };
        let repo = RepoFolder::new(Path::new("/cache"), model);
        let file = model.file.as_deref().unwrap_or("config.json");
        let path = repo.snapshot_folder(&model.revision).join(file);
        let begin = Path::new("/cache").join(format!("models--{}--{}", model.org, model.name)).join("snapshots");
        let below = path.strip_prefix(&begin).unwrap();
        prop_assert!(below.components().all(|part| matches!(part, Component::Normal(_))), "{}", path.display());
        let address = WebAddress::parse_endpoint("https://hub.example").unwrap().file_address(model, &model.revision, file);
        let parsed: ureq::http::Uri = address.parse().unwrap();
        prop_assert_eq!(parsed.host(), Some("hub.example"));
        prop_assert_eq!(parsed.query(), None);
        prop_assert!(!parsed.path().contains("/../") && !parsed.path().contains("//"), "{}", address);
        prop_assert_eq!(parsed.path().split('/').nth(3), Some("resolve"));
    }

    #[test]
    fn any_text_is_a_name_or_none(text in "\\PC{0,40}", name in "hf/\\PC{0,40}") {
        let _ = ModelName::parse(&text);
        let _ = ModelName::parse(&name);
    }
}
