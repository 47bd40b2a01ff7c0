//! What the user can do about a fault. A run's calls and `doctor` give the same advice.

use super::{FaultContext, ServiceErrorBody, unreadable::is_html};

impl FaultContext<'_> {
    /// The hint for an address that is not that of the API.
    pub(crate) fn address_hint(&self) -> String {
        let ending = match self.version_path {
            "" => "mostly a host and a port without a path".to_owned(),
            path => format!("mostly one that ends in {path}"),
        };
        format!("give --base-url, or base_url under [providers.{}], the address of its API: {ending}", self.provider)
    }

    /// The hint for answers in a form that the dialect does not have.
    pub(super) fn dialect_hint(&self) -> String {
        format!(
            "if the service has another API, set dialect (openai, completions, anthropic, gemini or ollama) under [providers.{}]",
            self.provider
        )
    }

    /// The hint for a key that the service refuses or lacks.
    fn key_hint(&self) -> String {
        match self.key_env {
            Some(variable) => {
                format!("check the key in {variable} and its permissions, then run the same command to continue")
            }
            None => {
                format!("it needs a key: give --key-env VARIABLE, or set key_env under [providers.{}]", self.provider)
            }
        }
    }

    /// Where a provider's settings stand.
    fn table(&self) -> String {
        format!("under [providers.{}]", self.provider)
    }
}

/// A hint for the user, if the service will answer no further request of this run.
pub(super) fn stop_hint(
    status: u16,
    body: &[u8],
    service_error: &ServiceErrorBody,
    context: FaultContext<'_>,
) -> Option<String> {
    if service_error.is_out_of_money() || status == 402 {
        return Some(format!(
            "pay for more at {}, or wait until its quota is renewed; then run the same command to continue",
            context.provider
        ));
    }
    if service_error.is_daily_quota_used_up() {
        return Some(
            "today's quota is used up: run the same command tomorrow to continue, or choose another model".to_owned(),
        );
    }
    match status {
        // The moderation of one request has the same status as a key without permission.
        403 if service_error.is_moderated() => return None,
        401 | 403 if is_html(body) => {
            return Some(format!(
                "{}; a page of HTML mostly comes from a proxy or a firewall before it",
                context.key_hint()
            ));
        }
        401 | 403 => return Some(context.key_hint()),
        407 => {
            return Some(
                "the proxy asks for a password: give it in HTTPS_PROXY, or leave this host out with NO_PROXY"
                    .to_owned(),
            );
        }
        400 if service_error.has_bad_key() => return Some(context.key_hint()),
        300..=399 => {
            return Some(format!(
                "redirects are not followed, because the key would be sent along: set base_url {} to the address that the redirect leads to",
                context.table()
            ));
        }
        _ => {}
    }
    wrong_setting(status, service_error, context).or_else(|| wrong_address(status, service_error, context))
}

/// The setting to change, if a service refuses what every request of this run has; `None` for other faults.
fn wrong_setting(status: u16, service_error: &ServiceErrorBody, context: FaultContext<'_>) -> Option<String> {
    let says = |words: &[&str]| service_error.mentions_any(words);
    let at = context.table();
    if says(&["unexpected endpoint"]) {
        return Some(context.address_hint());
    }
    if says(&["plain http request was sent to https", "http request to an https server"]) {
        return Some(format!("the service speaks HTTPS: let base_url {at}, or --base-url, begin with https://"));
    }
    if says(&["requires more system memory"]) {
        return Some("name a smaller model, or free memory".to_owned());
    }
    let refuses = says(&[
        "unsupported",
        "not support",
        "unrecognized",
        "unknown",
        "extra inputs",
        "unavailable",
        "not permitted",
        "requires --",
        "must be 'json_schema'",
        "only 1 is allowed",
        "no endpoints found that support",
        "not a multimodal model",
        "is text-only",
        "at most 0 image",
    ]);
    // llama.cpp reports a model that does not see with status 500.
    let names_pictures = says(&[
        "image_url",
        "image input",
        "images",
        "0 image",
        "mmproj",
        "vision",
        "multimodal",
        "multi-modal",
        "text-only",
    ]);
    if refuses && names_pictures && matches!(status, 400 | 404 | 415 | 422 | 500 | 501) {
        return Some(format!(
            "the model takes no pictures: choose a vision model with --see; \
             and where --write-sees is given, leave it out or choose one with --write (`wayword doctor` shows a model of {} a picture)",
            context.provider
        ));
    }
    let names_model = says(&["model"])
        && says(&["not found", "does not exist", "no such model", "not exist", "no models loaded", "decommissioned"]);
    if matches!(status, 400 | 404 | 410 | 422) && names_model {
        return Some("check the name of the model: `wayword doctor` lists those that the service offers".to_owned());
    }
    if !refuses || !matches!(status, 400 | 404 | 422) {
        return None;
    }
    let setting = if says(&["max_completion_tokens", "max_tokens"]) {
        "max_tokens_field = \"max_completion_tokens\""
    } else if says(&["temperature"]) {
        "omit = [\"temperature\"]"
    } else if says(&["seed"]) {
        "omit = [\"seed\"]"
    } else if says(&["response_format", "json_schema", "responseschema", "format"]) {
        "json = \"prompt\""
    } else if says(&["tool"]) {
        "tools = false"
    } else if says(&["think"]) {
        "extra = { think = false }, or leave think out,"
    } else {
        return None;
    };
    Some(format!("set {setting} {at}"))
}

/// What to do where nothing stands at the address that requests go to. Once a service answered, its address is right, and one fault of
/// this kind is a passing one.
fn wrong_address(status: u16, service_error: &ServiceErrorBody, context: FaultContext<'_>) -> Option<String> {
    if context.has_answered || !matches!(status, 404 | 405 | 410 | 501) {
        return None;
    }
    // "No endpoints found matching your data policy" is about an account.
    if service_error.mentions_any(&["no endpoints found", "policy", "region", "deployment"]) {
        return Some("read what the service says, and change the model or the settings of the account".to_owned());
    }
    Some(context.address_hint())
}

/// What to do about a request that a service refuses as it is; `None` where the service's words have to do.
pub(super) fn call_hint(status: u16, service_error: &ServiceErrorBody, context: FaultContext<'_>) -> Option<String> {
    if service_error.is_too_long() {
        return Some(format!(
            "start the server with a longer context, set context_tokens {} to what the model reads at once, or send smaller pictures with --picture-px",
            context.table()
        ));
    }
    (status == 413).then(|| "send smaller pictures with --picture-px".to_owned())
}
