//! `wayword study serve`: runs the site of a study, and prints its address and links.

use super::{make_links, messages::unused_links_note};
use crate::study_args::StudyServe;
use qrcode::{QrCode, render::unicode::Dense1x2};
use serde::Serialize;
use wayword_run::{
    error::{CommandError, Exit},
    interrupt,
    output::CommandOutput,
};
use wayword_study::{ListenOptions, RecruiterSettings, SiteAddress, SiteSecurity, Study, preview_study, serve_study};

/// The addresses under which the site can be reached.
#[derive(Debug, Serialize)]
struct ServedSite {
    url: String,
    /// Whether the study takes no more answers. Those who finished still get their code.
    is_closed: bool,
    /// The link that walks through a preview.
    #[serde(skip_serializing_if = "Option::is_none")]
    preview_link: Option<String>,
    /// The link for the recruiter. For Prolific it contains placeholders that Prolific fills in.
    #[serde(skip_serializing_if = "Option::is_none")]
    recruiter_link: Option<String>,
    /// New personal links.
    links: Vec<String>,
    /// How many earlier links nobody has used.
    unused_before: u32,
}

pub(super) fn run_serve(args: &StudyServe, output: &CommandOutput) -> Result<Exit, CommandError> {
    let _interrupt_guard = interrupt::finish_answers_first();
    let study = Study::open(&args.study)?;
    let is_closed = !args.preview && study.is_closed()?;
    if args.links > 0 {
        study.check_invitation(args.links)?;
    }
    let security = match &args.tls {
        Some(files) => SiteSecurity::Tls { certificate: files[0].clone(), key: files[1].clone() },
        None if args.self_signed => SiteSecurity::SelfSigned,
        None if args.insecure_lan => SiteSecurity::InsecureLan,
        None => SiteSecurity::Loopback,
    };
    if security == SiteSecurity::InsecureLan {
        output
            .say("warning: without TLS, others in this network can read what participants send, and take their place");
    }
    let listen = ListenOptions { address: args.listen, security, public: args.public.clone() };
    let announced_study = study.clone();
    let mut announced = Ok(());
    let started = |started: &SiteAddress| announced = announce_site(&announced_study, started, args, is_closed, output);
    if args.preview {
        preview_study(study, &listen, started, interrupt::is_interrupted)?;
        announced?;
        output.say("stopped; nothing was stored");
        return Ok(Exit::Done);
    }
    serve_study(study, &listen, started, interrupt::is_interrupted)?;
    announced?;
    output.say(format_args!("stopped; {}", how_to_go_on(args)));
    Ok(Exit::Done)
}

fn announce_site(
    study: &Study,
    started: &SiteAddress,
    args: &StudyServe,
    is_closed: bool,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let mut serving = ServedSite {
        url: started.url.clone(),
        is_closed,
        preview_link: None,
        recruiter_link: None,
        links: Vec::new(),
        unused_before: 0,
    };
    if is_closed || args.preview {
        serving.preview_link = (!is_closed).then(|| format!("{}/preview", started.url));
        output.print_result(&serving, describe_site(&serving, args.self_signed));
        output.say("Ctrl-C stops it");
        return Ok(());
    }
    if args.links > 0 {
        let made = make_links(study, args.links, &started.url)?;
        (serving.links, serving.unused_before) = (made.links, made.unused_before);
    }
    serving.recruiter_link = match &study.settings.recruiter {
        RecruiterSettings::Links => None,
        RecruiterSettings::Parameters { person, session, study, .. } => {
            Some(recruiter_link(&started.url, [person, study, session]))
        }
    };
    output.print_result(&serving, describe_site(&serving, args.self_signed));
    if study.settings.contact.trim().is_empty() {
        output
            .say("study.toml: `contact` is empty: participants could ask nobody. Fill it in before you invite anybody");
    }
    if let RecruiterSettings::Parameters { only_study, .. } = &study.settings.recruiter
        && only_study.is_empty()
    {
        output.say("study.toml: `only_study` is empty: links of any study of the recruiter are let in");
    }
    output.say(format_args!("Ctrl-C stops it; {}", how_to_go_on(args)));
    Ok(())
}

/// How the site is started again. The same flags would make further links.
fn how_to_go_on(args: &StudyServe) -> &'static str {
    if args.links > 0 {
        "the same command without --links goes on, with these links"
    } else {
        "the same command goes on"
    }
}

/// The link for the recruiter, with Prolific's placeholders.
fn recruiter_link(url: &str, [person, study, session]: [&String; 3]) -> String {
    let place = |name: &String| match name.as_str() {
        "" => String::new(),
        "PROLIFIC_PID" | "STUDY_ID" | "SESSION_ID" => format!("{name}={{{{%{name}%}}}}"),
        name => format!("{name}=..."),
    };
    let query: Vec<String> = [person, study, session].into_iter().map(place).filter(|part| !part.is_empty()).collect();
    format!("{url}/join?{}", query.join("&"))
}

fn describe_site(serving: &ServedSite, has_code: bool) -> String {
    if serving.is_closed {
        return format!(
            "this study is closed: it takes no more answers. At {} those who finished still see their code by their own link; everybody else \
             reads that the study is over",
            serving.url
        );
    }
    let mut lines = vec![format!("the study is at {}", serving.url)];
    if let Some(link) = &serving.preview_link {
        lines.push(format!("preview, of which nothing is stored; open it again to begin anew: {link}"));
    } else if let Some(link) = &serving.recruiter_link {
        lines.push(format!("link for the recruiter: {link}"));
    }
    lines.extend(serving.links.iter().map(|link| format!("personal link: {link}")));
    lines.extend(unused_links_note(serving.links.len(), serving.unused_before));
    if serving.preview_link.is_none() && serving.recruiter_link.is_none() && serving.links.is_empty() {
        lines.push("participants need a personal link: `wayword study invite` makes some".to_owned());
    }
    let code = has_code
        .then(|| QrCode::new(serving.links.first().or(serving.preview_link.as_ref()).unwrap_or(&serving.url)))
        .and_then(Result::ok);
    if let Some(code) = code {
        lines.push(
            "the first link, for the camera of a phone; its browser warns, because nobody vouches for the certificate:"
                .to_owned(),
        );
        lines.push(code.render::<Dense1x2>().dark_color(Dense1x2::Light).light_color(Dense1x2::Dark).build());
    }
    lines.join("\n")
}
