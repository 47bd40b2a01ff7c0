//! Checks whether a model can be used, for `wayword doctor`: key, service, price, and an answer to a test question.
//! Each finding comes with advice if something is wrong.

use crate::{
    ModelServices, RemoteModel, ServiceDialect,
    endpoint::ProviderEndpoint,
    faults::{self, FaultContext, RemoteFault},
};
use std::{
    sync::Arc,
    time::{SystemTime, UNIX_EPOCH},
};
use wayword_core::{ChatMessage, Image, LanguageModel, ModelRequest, SamplingOptions};

/// Side of the test picture, pixels: large enough for every service.
const SQUARE_PX: u32 = 64;

/// The most tokens of a reply to a test question. One word is enough, but some models think first.
const MAX_TOKENS: u32 = 256;

/// How good or bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum CheckLevel {
    /// All is in order.
    Ok,
    /// The model can be used, but something should be changed.
    Warning,
    /// The model cannot be used.
    Problem,
}

/// The result of one check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ServiceFinding {
    /// How good or bad the finding is.
    pub level: CheckLevel,
    /// The finding, for people.
    pub what: String,
    /// How to fix it.
    pub to_do: Option<String>,
}

impl ServiceFinding {
    /// A finding that all is in order.
    pub fn ok(what: impl Into<String>) -> Self {
        Self { level: CheckLevel::Ok, what: what.into(), to_do: None }
    }

    fn warning(what: impl Into<String>, to_do: impl Into<String>) -> Self {
        Self { level: CheckLevel::Warning, what: what.into(), to_do: Some(to_do.into()) }
    }

    fn problem(what: impl Into<String>, to_do: impl Into<String>) -> Self {
        Self { level: CheckLevel::Problem, what: what.into(), to_do: Some(to_do.into()) }
    }

    /// A problem, from the text of an error that ends in a hint.
    #[must_use]
    pub fn from_error_text(text: &str) -> Self {
        let (what, to_do) = text.split_once("\nhint: ").unwrap_or((text, "see docs/MODELS.md"));
        Self::problem(what, to_do)
    }
}

impl ModelServices {
    /// Checks everything that a model needs: its key, its service and its price. Then asks it for a word and, if it is
    /// to see, for the colour of a red square. Both calls count and are limited like any other, but the ledger's
    /// answers are not used.
    #[must_use]
    pub fn check_model(&self, name: &str, is_to_see: bool) -> Vec<ServiceFinding> {
        let model = match self.model(name) {
            Ok(model) => model,
            Err(error) => return vec![ServiceFinding::from_error_text(&error.to_string())],
        };
        let mut findings = Vec::new();
        if !check_key(&model.endpoint, &mut findings) || !check_service(&model, &mut findings) {
            return findings;
        }
        check_price(&model, &mut findings);
        let answering = ServiceFinding::check_answering(model.as_ref());
        let answers = answering.level == CheckLevel::Ok;
        findings.push(answering);
        if answers && is_to_see {
            findings.extend(ServiceFinding::check_seeing(model.as_ref()));
        }
        findings
    }
}

/// Whether there is a key, if the provider needs one.
fn check_key(endpoint: &ProviderEndpoint, findings: &mut Vec<ServiceFinding>) -> bool {
    let provider = &endpoint.provider;
    match (endpoint.find_secret(), &provider.key_env) {
        (Err(closed), _) => {
            findings.push(ServiceFinding::problem(closed.reason, closed.hint));
            return false;
        }
        (Ok(Some(_)), Some(variable)) => findings.push(ServiceFinding::ok(format!("{variable} contains a key"))),
        _ => findings.push(ServiceFinding::ok(format!("{} needs no key", provider.name))),
    }
    if provider.base_url.plain && !provider.base_url.loopback {
        let what =
            format!("{} uses plain http: others on the network can read what is sent", provider.base_url.as_str());
        let secret = if provider.key_env.is_some() { ", including the key" } else { "" };
        findings.push(ServiceFinding::warning(what + secret, "use https, unless the network is your own"));
    }
    true
}

/// Whether the service answers. Also finds out whether it has the model.
fn check_service(model: &RemoteModel, findings: &mut Vec<ServiceFinding>) -> bool {
    let endpoint = &model.endpoint;
    let provider = &endpoint.provider;
    let url = provider.base_url.as_str();
    let received = match endpoint.request_models() {
        Ok(received) => received,
        Err(error) => {
            let fault = faults::fault_from_transport(&error, None, url, endpoint.fault_context());
            let reason = fault.reason().to_owned();
            let to_do = match fault {
                RemoteFault::Stop { hint, .. } => hint,
                _ if provider.local => format!("start {} or give --base-url", provider.name),
                _ => "check the network and the base URL".to_owned(),
            };
            findings.push(ServiceFinding::problem(reason, to_do));
            return false;
        }
    };
    let body = received.body.unwrap_or_default();
    if !(200..300).contains(&received.status) {
        let fault = faults::fault_from_response(
            received.status,
            &received.headers,
            &body,
            SystemTime::now(),
            endpoint.fault_context(),
        );
        return match fault {
            // Not every server can list its models.
            RemoteFault::Stop { reason, hint } if !matches!(received.status, 404 | 405 | 410 | 501) => {
                findings.push(ServiceFinding::problem(reason, hint));
                false
            }
            fault => {
                let what = format!("{url} lists no models: {}", fault.reason());
                findings.push(ServiceFinding::warning(what, endpoint.fault_context().address_hint()));
                true
            }
        };
    }
    findings.push(ServiceFinding::ok(format!("{url} answers")));
    let listed = serde_json::from_slice(&body).unwrap_or_default();
    match provider.dialect.listed_models(&listed) {
        Some(models) if models.iter().any(|known| is_listed_as(known, model.model_name())) => {
            findings.push(ServiceFinding::ok(format!("{} has {}", provider.name, model.model_name())));
        }
        Some(models) => {
            let to_do = match provider.dialect {
                ServiceDialect::Ollama => format!("ollama pull {}", model.model_name()),
                _ => format!("choose one of {}", list_models(&models, endpoint.fault_context())),
            };
            findings.push(ServiceFinding::warning(
                format!("{} does not list {}", provider.name, model.model_name()),
                to_do,
            ));
        }
        None => {
            let what = match faults::is_html(&body) {
                true => format!("{url} lists no models: it answers with a page of HTML"),
                false => format!("{url} lists no models"),
            };
            findings.push(ServiceFinding::warning(what, endpoint.fault_context().address_hint()));
        }
    }
    true
}

/// Whether a model in a service's list is the named one. Ollama's `:latest` may be left out.
fn is_listed_as(listed: &str, named: &str) -> bool {
    listed == named.trim_start_matches("models/") || listed.strip_suffix(":latest") == Some(named)
}

/// The first 12 names of a list, each cut to 80 characters, because the list comes from the server.
fn list_models(models: &[&str], who: FaultContext<'_>) -> String {
    let names: Vec<String> =
        models.iter().take(12).map(|name| who.safe_text(name).chars().take(80).collect()).collect();
    if models.len() > names.len() {
        format!("{}, ... ({} in all)", names.join(", "), models.len())
    } else {
        names.join(", ")
    }
}

/// Finds out whether the price of a model is known.
fn check_price(model: &RemoteModel, findings: &mut Vec<ServiceFinding>) {
    findings.push(match model.price() {
        Some(price) if price.as_of.is_empty() => ServiceFinding::ok(format!("{} costs nothing", model.name())),
        Some(price) => ServiceFinding::ok(format!(
            "{} costs ${} per million tokens in and ${} out (as of {})",
            model.name(),
            price.usd_per_million_in,
            price.usd_per_million_out,
            price.as_of
        )),
        None => ServiceFinding::warning(
            format!("the price of {} is not known, so --max-usd cannot be used with it", model.name()),
            "add the model's price to a file, and give the file with --prices FILE",
        ),
    });
}

/// The reply to one message, or the text of the error.
fn ask_once(model: &dyn LanguageModel, message: ChatMessage) -> Result<String, String> {
    let sampling = SamplingOptions { temperature: 0.0, max_tokens: MAX_TOKENS, seed: 0 };
    let request =
        ModelRequest { messages: vec![message], sampling, replicate: clock_replicate(), schema: None, tools: &[] };
    let mut replies = model.complete_requests(&[request]);
    replies
        .pop()
        .map_or_else(|| Err(String::new()), |reply| reply.map(|reply| reply.text).map_err(|error| error.to_string()))
}

/// A replicate number that differs between checks, so that no check is answered from the ledger: an old answer does not
/// show that the service works now.
fn clock_replicate() -> u32 {
    let ms = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_millis());
    u32::try_from(ms & u128::from(u32::MAX)).unwrap_or_default()
}

impl ServiceFinding {
    /// Asks any model for a word, wherever it runs.
    #[must_use]
    pub fn check_answering(model: &dyn LanguageModel) -> Self {
        match ask_once(model, ChatMessage::from_user("Answer with the one word: ready")) {
            Ok(_) => Self::ok(format!("{} answers", model.name())),
            Err(error) => {
                let (what, to_do) = error.split_once("\nhint: ").unwrap_or((&error, "read the service's message"));
                Self::problem(format!("a question failed: {what}"), to_do)
            }
        }
    }

    /// Asks any model for the colour of a red square, wherever it runs.
    pub fn check_seeing(model: &dyn LanguageModel) -> Option<Self> {
        let pixels = [220, 20, 20].repeat((SQUARE_PX * SQUARE_PX) as usize);
        let square = Image::new(SQUARE_PX, SQUARE_PX, pixels).ok()?;
        let text = "Which colour is this picture? Answer with one word.".to_owned();
        let to_do = "choose another model for --see";
        Some(match ask_once(model, ChatMessage::about_images(text, vec![Arc::new(square)])) {
            Ok(colour) if colour.to_lowercase().contains("red") => Self::ok(format!("{} sees", model.name())),
            Ok(answer) => {
                let what = format!("{} was shown a red square and said: {}", model.name(), faults::one_line(&answer));
                Self::warning(what, to_do)
            }
            Err(error) => Self::warning(format!("{} was shown a picture and failed: {error}", model.name()), to_do),
        })
    }
}
