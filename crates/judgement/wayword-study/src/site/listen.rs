//! Starts the site: checks the options, listens, serves HTTP or HTTPS on each connection, and shuts down in order.

use super::{
    cookies::StudyCookies,
    desk::StudyDesk,
    pages::PageTemplates,
    request_guard::RequestLimiter,
    routes::{StudySite, build_router, script_with_words},
    tls,
};
use crate::study::{RecruiterSettings, ServeLock, Study, StudyError};
use axum::{Router, extract::Request};
use hyper::{body::Incoming, server::conn::http1, service::service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::{
    io,
    net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket},
    path::PathBuf,
    sync::Arc,
    time::Duration,
};
use tokio::{
    io::{AsyncRead, AsyncWrite},
    net::{TcpListener, TcpStream},
    sync::{Semaphore, watch},
    time,
};
use tokio_rustls::TlsAcceptor;
use tower_service::Service as _;

/// Most connections at once. A further one is closed, so that none waits without limit.
const MAX_CONNECTIONS: usize = 1024;
/// Most picture files that are read at once. Further requests for pictures wait.
const MAX_PICTURE_READS: usize = 64;
/// How long a TLS handshake or the head of a request may take.
const HEAD_TIMEOUT: Duration = Duration::from_secs(10);
/// How long a connection lasts at most. Browsers then open a new one.
const CONNECTION_LIFETIME: Duration = Duration::from_secs(300);
/// How long running requests may go on after the site was asked to stop.
const SHUTDOWN_GRACE: Duration = Duration::from_secs(5);
/// How often the caller is asked whether to stop.
const STOP_POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Largest head of a request, bytes. A connection with a larger one is closed.
const MAX_REQUEST_HEAD_BYTES: usize = 16 * 1024;

/// How the site can be reached.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ListenOptions {
    /// The address on which it listens. Port 0 takes any free port.
    pub address: SocketAddr,
    /// Whether it speaks TLS.
    pub security: SiteSecurity,
    /// The address that participants use, as `https://study.example.org`, if another server forwards their requests to this one.
    pub public: Option<String>,
}

/// Whether the site speaks TLS.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SiteSecurity {
    /// It does not, and listens on this machine alone.
    Loopback,
    /// It does not, and others in the network can read along. Only if the user asks for it.
    InsecureLan,
    /// By a certificate and a key.
    Tls {
        /// The certificate chain, PEM.
        certificate: PathBuf,
        /// Its private key, PEM.
        key: PathBuf,
    },
    /// By a self-signed certificate that the study makes; browsers warn of it.
    SelfSigned,
}

/// The addresses of a running site.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SiteAddress {
    /// The address on which it listens.
    pub address: SocketAddr,
    /// The URL that participants open, without a slash at the end.
    pub url: String,
}

/// Whose answers the site takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SiteAudience {
    /// Participants'. They are stored.
    Participants,
    /// The researcher's, who looks at the study. They are kept in memory only.
    Researcher,
}

/// How many answers an item takes in a preview, and so how often it can be walked through.
const PREVIEW_ANSWERS: u32 = 100_000;

/// Serves a preview of a study until `should_stop` returns true: each visit of `/preview` walks through the study as a new participant.
/// Nothing is stored, and every page has a note about it. A server for participants may run beside it.
///
/// # Errors
/// When the settings forbid it, the address cannot be had, or a file cannot be used.
pub fn preview_study(
    mut study: Study,
    listen: &ListenOptions,
    started: impl FnOnce(&SiteAddress),
    should_stop: impl Fn() -> bool,
) -> Result<(), StudyError> {
    study.settings.recruiter = RecruiterSettings::Links;
    study.plan.per_item = PREVIEW_ANSWERS;
    serve_audience(study, listen, SiteAudience::Researcher, started, should_stop)
}

/// Serves a study until `should_stop` returns true. It calls `started` once it listens, and finishes running requests before it ends.
///
/// # Errors
/// When the settings forbid it, the address cannot be had, or a file cannot be used.
pub fn serve_study(
    study: Study,
    listen: &ListenOptions,
    started: impl FnOnce(&SiteAddress),
    should_stop: impl Fn() -> bool,
) -> Result<(), StudyError> {
    check_listen_options(&study, listen)?;
    let _lock = ServeLock::acquire(&study.folder)?;
    serve_audience(study, listen, SiteAudience::Participants, started, should_stop)
}

fn serve_audience(
    study: Study,
    listen: &ListenOptions,
    audience: SiteAudience,
    started: impl FnOnce(&SiteAddress),
    should_stop: impl Fn() -> bool,
) -> Result<(), StudyError> {
    check_address(listen)?;
    let host = reachable_host(listen.address.ip());
    let acceptor = match &listen.security {
        SiteSecurity::Loopback | SiteSecurity::InsecureLan => None,
        SiteSecurity::Tls { certificate, key } => Some(tls::acceptor_from_files(certificate, key)?),
        SiteSecurity::SelfSigned => Some(tls::self_signed_acceptor(&study.folder, host)?),
    };
    let scheme = if acceptor.is_some() { "https" } else { "http" };
    let public = listen.public.as_ref().map(|url| url.trim_end_matches('/').to_owned());
    let is_secure = public.as_ref().map_or(acceptor.is_some(), |url| url.starts_with("https://"));
    let study = Arc::new(study);
    let (desk, thread) = match audience {
        SiteAudience::Participants => StudyDesk::open(Arc::clone(&study))?,
        SiteAudience::Researcher => StudyDesk::open_in_memory(Arc::clone(&study))?,
    };
    let is_preview = audience == SiteAudience::Researcher;
    let site = StudySite {
        script: script_with_words(&study.texts),
        study: Arc::clone(&study),
        desk,
        pages: PageTemplates::new(&study.texts, is_preview)?,
        is_preview,
        cookies: StudyCookies { is_secure },
        pace: RequestLimiter::new(),
        readers: Semaphore::new(MAX_PICTURE_READS),
        public: public.clone(),
        scheme,
    };
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(StudyError::io_error("the async runtime", "start"))?;
    let served = runtime.block_on(async {
        let listener = TcpListener::bind(listen.address).await.map_err(|error| listen_error(listen.address, error))?;
        let address = listener.local_addr().map_err(StudyError::io_error(listen.address.to_string(), "listen on"))?;
        let url = public.unwrap_or_else(|| format!("{scheme}://{}", SocketAddr::new(host, address.port())));
        started(&SiteAddress { address, url });
        accept_connections(listener, acceptor, build_router(Arc::new(site)), should_stop).await;
        Ok(())
    });
    runtime.shutdown_timeout(SHUTDOWN_GRACE);
    // The desk's thread ends when the last request has gone.
    let _ = thread.join();
    served
}

/// Why an address cannot be had, and what to do.
fn listen_error(address: SocketAddr, error: io::Error) -> StudyError {
    let (problem, hint) = match error.kind() {
        io::ErrorKind::AddrInUse => (
            format!("port {} is in use by another program", address.port()),
            format!("stop that program, or give --listen {} or another port", SocketAddr::new(address.ip(), 0)),
        ),
        io::ErrorKind::AddrNotAvailable => (
            "this machine does not have this address".to_owned(),
            "give --listen an address of this machine, 127.0.0.1 for this machine alone, or 0.0.0.0 for all its networks".to_owned(),
        ),
        io::ErrorKind::PermissionDenied => (
            format!("you may not use port {}", address.port()),
            "give --listen a port from 1024 on, such as 127.0.0.1:8080".to_owned(),
        ),
        _ => return StudyError::io_error(address.to_string(), "listen on")(error),
    };
    StudyError::refused_request(format!("--listen {address}: {problem}"), hint)
}

/// Refuses addresses with which answers could be read along.
fn check_address(listen: &ListenOptions) -> Result<(), StudyError> {
    let is_loopback = listen.address.ip().is_loopback();
    if !is_loopback && listen.security == SiteSecurity::Loopback {
        let problem = format!("{}: others could read along, and the cookies with it", listen.address);
        let hint =
            "listen on 127.0.0.1 behind a server with TLS, or give --tls CERT KEY, --self-signed, or --insecure-lan";
        return Err(StudyError::refused_request(problem, hint));
    }
    let is_plain = listen.public.as_ref().is_some_and(|url| !url.starts_with("https://"));
    if is_plain && listen.security != SiteSecurity::InsecureLan {
        let problem = "--public: participants would come without TLS";
        return Err(StudyError::refused_request(
            problem,
            "give an address that begins with https://, or --insecure-lan",
        ));
    }
    Ok(())
}

/// Refuses addresses and settings with which answers could be read along, or participants would lack a contact or a code.
fn check_listen_options(study: &Study, listen: &ListenOptions) -> Result<(), StudyError> {
    check_address(listen)?;
    let is_open = !listen.address.ip().is_loopback() || listen.public.is_some();
    let is_recruited = matches!(study.settings.recruiter, RecruiterSettings::Parameters { .. });
    if is_open && is_recruited && study.settings.codes.done.is_empty() {
        let problem =
            "study.toml: `codes.done` is empty, so participants would have nothing to take back to the recruiter";
        return Err(StudyError::refused_request(problem, "copy the codes from the recruiter's page into [codes]"));
    }
    if is_open && study.settings.contact.trim().is_empty() {
        let problem = "study.toml: `contact` is empty, so participants could ask nobody";
        return Err(StudyError::refused_request(problem, "give a name, an institution and an address"));
    }
    Ok(())
}

/// The address that a participant's browser can open. For `0.0.0.0` this is the address of this machine in its network.
fn reachable_host(listen: IpAddr) -> IpAddr {
    if !listen.is_unspecified() {
        return listen;
    }
    // Connecting a UDP socket sends no packet; it only makes the system choose which of its own addresses it would send from. The
    // target is an address reserved for documentation (RFC 5737).
    let local = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0))
        .and_then(|socket| socket.connect(("192.0.2.1", 9)).and_then(|()| socket.local_addr()));
    local.map_or(IpAddr::V4(Ipv4Addr::LOCALHOST), |local| local.ip())
}

/// Serves each new connection in a task, until `should_stop` returns true. Then it asks all connections to end, and waits for them.
async fn accept_connections(
    listener: TcpListener,
    acceptor: Option<TlsAcceptor>,
    router: Router,
    should_stop: impl Fn() -> bool,
) {
    let free_connections = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    // Each connection holds a receiver, so the channel closes when the last connection has ended.
    let (end, ending) = watch::channel(());
    let mut poll = time::interval(STOP_POLL_INTERVAL);
    loop {
        let stream = tokio::select! {
            _ = poll.tick() => {
                if should_stop() {
                    break;
                }
                continue;
            }
            accepted = listener.accept() => match accepted {
                Ok((stream, _)) => stream,
                // Too many open files, or a connection that went away: the next may do better.
                Err(_) => {
                    time::sleep(STOP_POLL_INTERVAL).await;
                    continue;
                }
            },
        };
        let Ok(permit) = Arc::clone(&free_connections).try_acquire_owned() else {
            // No permit: the connection is dropped, so that none waits without limit.
            continue;
        };
        let (acceptor, router, ending) = (acceptor.clone(), router.clone(), ending.clone());
        tokio::spawn(async move {
            handle_connection(stream, acceptor, router, ending).await;
            drop(permit);
        });
    }
    drop(ending);
    let _ = end.send(());
    let _ = time::timeout(SHUTDOWN_GRACE, end.closed()).await;
}

/// Serves one connection, after a TLS handshake if there is an acceptor.
async fn handle_connection(
    stream: TcpStream,
    acceptor: Option<TlsAcceptor>,
    router: Router,
    ending: watch::Receiver<()>,
) {
    // Answers are small and complete: waiting for more to send with them costs time.
    let _ = stream.set_nodelay(true);
    match acceptor {
        None => serve_http(stream, router, ending).await,
        Some(acceptor) => {
            if let Ok(Ok(stream)) = time::timeout(HEAD_TIMEOUT, acceptor.accept(stream)).await {
                serve_http(stream, router, ending).await;
            }
        }
    }
}

/// Serves HTTP on one connection. Errors on it are the client's and are not reported.
async fn serve_http(
    stream: impl AsyncRead + AsyncWrite + Unpin + Send + 'static,
    router: Router,
    mut ending: watch::Receiver<()>,
) {
    let service = service_fn(move |request: Request<Incoming>| router.clone().call(request));
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIMEOUT)
        .max_buf_size(MAX_REQUEST_HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), service);
    tokio::pin!(connection);
    tokio::select! {
        _ = connection.as_mut() => return,
        _ = ending.changed() => {}
        () = time::sleep(CONNECTION_LIFETIME) => {}
    }
    connection.as_mut().graceful_shutdown();
    let _ = time::timeout(SHUTDOWN_GRACE, connection).await;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_that_cannot_be_had_says_what_to_do() {
        let told = |kind: io::ErrorKind| listen_error("127.0.0.1:8080".parse().unwrap(), kind.into()).to_string();
        let in_use = told(io::ErrorKind::AddrInUse);
        assert!(in_use.contains("port 8080 is in use") && in_use.contains("--listen 127.0.0.1:0"), "{in_use}");
        assert!(told(io::ErrorKind::AddrNotAvailable).contains("0.0.0.0"));
        assert!(told(io::ErrorKind::PermissionDenied).contains("from 1024"));
        assert!(told(io::ErrorKind::OutOfMemory).contains("cannot listen on"));
    }
}
