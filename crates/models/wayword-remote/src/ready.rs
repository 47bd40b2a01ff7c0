//! Checks, before a run begins, whether a model can be used: its key, its address, and whether it takes pictures. Sends
//! no question to the model.

use crate::{
    ConfigError, ModelServices, RemoteModel,
    base_url::BaseUrl,
    endpoint::ProviderEndpoint,
    faults::{self, RemoteFault},
};
use std::{
    io,
    net::{SocketAddr, TcpStream, ToSocketAddrs},
    time::Duration,
};
use ureq::{Proxy, http::Uri};

/// How often a secure connection is tried before a service is refused.
const MAX_SECURE_ATTEMPTS: usize = 2;

/// Longest wait for a connection. A service that takes longer is not refused.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(2);

impl ModelServices {
    /// Refuses a model if its key is missing, no service listens at its address, the host is not found, or the certificate of an HTTPS
    /// service is not valid. Makes one connection, and sends no key.
    ///
    /// # Errors
    /// When the model cannot be used, or the provider does not exist.
    pub fn check_ready(&self, name: &str) -> Result<(), ConfigError> {
        let model = self.model(name)?;
        let endpoint = &model.endpoint;
        if let Err(closed) = endpoint.find_secret() {
            return Err(ConfigError::NotReady { problem: closed.reason, hint: closed.hint });
        }
        let base_url = &endpoint.provider.base_url;
        let is_tried = match base_url.plain {
            true => self.is_reached_directly(endpoint),
            false => base_url.loopback || Proxy::try_from_env().is_none(),
        };
        if is_tried {
            check_connection(endpoint)?;
        }
        if base_url.plain { Ok(()) } else { check_secure_connection(endpoint) }
    }

    /// Refuses a model that is to be shown pictures, if its provider takes none. Makes no connection.
    ///
    /// # Errors
    /// When it takes no pictures, or the provider does not exist.
    pub fn takes_pictures(&self, name: &str) -> Result<(), ConfigError> {
        let model = self.model(name)?;
        let provider = &model.endpoint.provider;
        if !provider.blind {
            return Ok(());
        }
        let problem = format!("{name} cannot be shown pictures, because {} takes none", provider.name);
        let hint = "name a model that sees, behind a chat endpoint; or leave the pictures out".to_owned();
        Err(ConfigError::NotReady { problem, hint })
    }

    /// Refuses a model that is to be shown pictures, if its service reports that it does not see. Only Ollama reports
    /// this. With other services it is unknown until the model is asked; `doctor` shows it a picture.
    ///
    /// # Errors
    /// When it does not see, or the provider does not exist.
    pub fn check_sight(&self, name: &str) -> Result<(), ConfigError> {
        let model = self.model(name)?;
        if !self.is_reached_directly(&model.endpoint) || describes_sight(&model) != Some(false) {
            return Ok(());
        }
        let provider = &model.endpoint.provider.name;
        let problem =
            format!("{name} cannot be shown pictures: {provider} does not list vision among what this model can do");
        let hint = format!(
            "name a model that sees, as in {provider}/qwen2.5vl; `{provider} show {}` lists what it can do",
            model.model_name()
        );
        Err(ConfigError::NotReady { problem, hint })
    }

    /// The base URL of a model's service.
    ///
    /// # Errors
    /// When the provider does not exist.
    pub fn base_url(&self, name: &str) -> Result<String, ConfigError> {
        Ok(self.model(name)?.endpoint.provider.base_url.as_str().to_owned())
    }

    /// Whether a bare connection shows something. It shows nothing through a proxy.
    fn is_reached_directly(&self, endpoint: &ProviderEndpoint) -> bool {
        let provider = &endpoint.provider;
        let is_near = provider.local || self.has_own_address(&provider.name);
        provider.base_url.loopback || (is_near && Proxy::try_from_env().is_none())
    }
}

/// Whether a model sees, according to its service; `None` where the service does not report this or does not answer.
fn describes_sight(model: &RemoteModel) -> Option<bool> {
    let dialect = model.endpoint.provider.dialect;
    let wire = dialect.to_describe(model.model_name())?;
    let received = model.endpoint.post_request(&wire, wire.body.to_string().as_bytes()).ok()?;
    let body = received.body.ok().filter(|_| (200..300).contains(&received.status))?;
    dialect.describes_sight(&serde_json::from_slice(&body).ok()?)
}

/// Refuses a provider if no server accepts a connection at its address.
fn check_connection(endpoint: &ProviderEndpoint) -> Result<(), ConfigError> {
    match try_connect(&endpoint.provider.base_url) {
        Err(ConnectProblem::Port) => Err(nothing_listens(endpoint)),
        Err(ConnectProblem::Host(host)) => Err(host_not_found(endpoint, &host)),
        Ok(()) => Ok(()),
    }
}

/// Refuses a provider if no secure connection to it is possible. What may pass, such as a slow network, is no reason.
fn check_secure_connection(endpoint: &ProviderEndpoint) -> Result<(), ConfigError> {
    let (name, url) = (&endpoint.provider.name, endpoint.provider.base_url.as_str());
    let attempts = (0..MAX_SECURE_ATTEMPTS).map(|_| endpoint.try_secure_connection().err());
    // Only what every attempt meets is a reason.
    let Some(error) = attempts.take_while(Option::is_some).flatten().nth(MAX_SECURE_ATTEMPTS - 1) else {
        return Ok(());
    };
    if faults::ends_in_handshake(&error) {
        return Err(ConfigError::NotReady {
            problem: format!("the server at {url} ends each connection before it is secure, so {name} cannot be used"),
            hint: format!(
                "if it speaks no HTTPS, let --base-url, or base_url under [providers.{name}], begin with http://"
            ),
        });
    }
    match faults::fault_from_transport(&error, None, url, endpoint.fault_context()) {
        RemoteFault::Stop { reason, hint } => Err(ConfigError::NotReady { problem: reason, hint }),
        _ => Ok(()),
    }
}

/// The error for a port at which no server listens.
fn nothing_listens(endpoint: &ProviderEndpoint) -> ConfigError {
    let (name, url) = (&endpoint.provider.name, endpoint.provider.base_url.as_str());
    ConfigError::NotReady {
        problem: format!("nothing listens at {url}, so {name} cannot be used"),
        hint: format!(
            "start {name}, or give its address: --base-url URL, or base_url under [providers.{name}] in the --config file"
        ),
    }
}

/// The error for a host of which the network knows nothing.
fn host_not_found(endpoint: &ProviderEndpoint, host: &str) -> ConfigError {
    let (name, url) = (&endpoint.provider.name, endpoint.provider.base_url.as_str());
    ConfigError::NotReady {
        problem: format!("the host {host} is not found, so {name} cannot be used at {url}"),
        hint: format!(
            "check the name and the network, or give --base-url URL, or base_url under [providers.{name}] in the --config file"
        ),
    }
}

/// Why no connection is possible.
enum ConnectProblem {
    /// The machine is there, but no program listens at the port.
    Port,
    /// There is no machine of this name.
    Host(String),
}

/// Checks whether a server accepts a connection, or may accept one later: only a refused connection is a problem.
fn try_connect(url: &BaseUrl) -> Result<(), ConnectProblem> {
    let Some((host, port)) = host_and_port(url) else { return Ok(()) };
    let addresses: Vec<SocketAddr> =
        (host.as_str(), port).to_socket_addrs().map_err(|_| ConnectProblem::Host(host.clone()))?.collect();
    let is_refused = |address: &SocketAddr| {
        TcpStream::connect_timeout(address, CONNECT_TIMEOUT)
            .is_err_and(|error| error.kind() == io::ErrorKind::ConnectionRefused)
    };
    if !addresses.is_empty() && addresses.iter().all(is_refused) { Err(ConnectProblem::Port) } else { Ok(()) }
}

fn host_and_port(url: &BaseUrl) -> Option<(String, u16)> {
    let uri: Uri = url.as_str().parse().ok()?;
    let host = uri.host()?.trim_start_matches('[').trim_end_matches(']').to_owned();
    Some((host, uri.port_u16().unwrap_or(if url.plain { 80 } else { 443 })))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RemoteConfig;
    use std::net::TcpListener;
    use wayword_ledger::{Ledger, RunLimits};

    /// Why a model cannot be used at an address.
    fn told(base_url: &str, key_env: Option<&str>) -> Option<String> {
        let config = RemoteConfig {
            base_url: Some(base_url.to_owned()),
            key_env: key_env.map(str::to_owned),
            ..RemoteConfig::default()
        };
        let run = Ledger::in_memory().unwrap().start_run("test", RunLimits::default()).unwrap();
        ModelServices::new(config, run).unwrap().check_ready("server/words").err().map(|error| error.to_string())
    }

    #[test]
    fn ready_names_an_address_where_no_service_listens() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}/v1", listener.local_addr().unwrap());
        assert_eq!(told(&url, None), None);
        drop(listener);
        let problem = told(&url, None).unwrap();
        assert!(
            problem.contains(&url) && problem.contains("start server") && problem.contains("--base-url"),
            "{problem}"
        );
    }

    #[test]
    fn ready_names_a_server_without_https() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("https://{}/v1", listener.local_addr().unwrap());
        std::thread::spawn(move || {
            for mut stream in listener.incoming().map_while(Result::ok) {
                let _ = std::io::Read::read(&mut stream, &mut [0; 4096]);
            }
        });
        let problem = told(&url, None).unwrap();
        assert!(problem.contains("before it is secure") && problem.contains("begin with http://"), "{problem}");
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("https://{}/v1", listener.local_addr().unwrap());
        std::thread::spawn(move || {
            for mut stream in listener.incoming().map_while(Result::ok) {
                let _ =
                    std::io::Write::write_all(&mut stream, b"HTTP/1.1 400 Bad Request\r\ncontent-length: 0\r\n\r\n");
                let _ = std::io::Read::read(&mut stream, &mut [0; 4096]);
            }
        });
        let problem = told(&url, None).unwrap();
        assert!(problem.contains("does not speak HTTPS") && problem.contains("http://"), "{problem}");
    }

    #[test]
    fn ready_names_a_missing_key() {
        let problem = told("http://127.0.0.1:9/v1", Some("WAYWORD_NO_SUCH_KEY")).unwrap();
        assert!(problem.contains("WAYWORD_NO_SUCH_KEY") && problem.contains("export"), "{problem}");
    }

    #[test]
    fn takes_pictures_refuses_text_providers_before_any_call() {
        let told = |name: &str| {
            let config = RemoteConfig { base_url: Some("http://127.0.0.1:9/v1".to_owned()), ..RemoteConfig::default() };
            let run = Ledger::in_memory().unwrap().start_run("test", RunLimits::default()).unwrap();
            ModelServices::new(config, run).unwrap().takes_pictures(name).err().map(|error| error.to_string())
        };
        assert_eq!(told("server/words"), None);
        for name in ["completions/words", "deepseek/chat"] {
            assert!(told(name).unwrap().contains("cannot be shown pictures"), "{name}");
        }
    }

    #[test]
    fn an_address_has_a_host_and_a_port() {
        let place = |url| host_and_port(&BaseUrl::new(url, "/v1").unwrap()).unwrap();
        assert_eq!(place("http://[::1]:8000"), ("::1".to_owned(), 8000));
        assert_eq!(place("https://models.example.com/v1"), ("models.example.com".to_owned(), 443));
        assert_eq!(place("http://lab"), ("lab".to_owned(), 80));
    }
}
