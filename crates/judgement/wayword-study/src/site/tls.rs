//! Sets up TLS with the user's certificate, or with a self-signed one that the study makes.

use crate::study::StudyError;
use std::{fs, net::IpAddr, path::Path, sync::Arc};
use tokio_rustls::{
    TlsAcceptor,
    rustls::{
        ServerConfig,
        pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject as _},
    },
};

/// The files of the self-signed certificate.
const SELF_SIGNED_CERTIFICATE_FILE: &str = "self-signed.pem";
const SELF_SIGNED_KEY_FILE: &str = "self-signed.key";

/// TLS with a certificate and a key, both in PEM.
///
/// # Errors
/// When a file cannot be read, or the two do not fit.
pub(super) fn acceptor_from_files(certificate: &Path, key: &Path) -> Result<TlsAcceptor, StudyError> {
    let wrong = |path: &Path, problem: String| StudyError::File {
        path: path.to_owned(),
        problem,
        hint: "give the certificate chain and the private key as PEM files",
    };
    let chain: Vec<CertificateDer<'static>> = CertificateDer::pem_file_iter(certificate)
        .and_then(Iterator::collect)
        .map_err(|error| wrong(certificate, error.to_string()))?;
    let private_key = PrivateKeyDer::from_pem_file(key).map_err(|error| wrong(key, error.to_string()))?;
    let provider = Arc::new(tokio_rustls::rustls::crypto::ring::default_provider());
    let config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .and_then(|builder| builder.with_no_client_auth().with_single_cert(chain, private_key));
    let mut config = config.map_err(|error| wrong(certificate, error.to_string()))?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(TlsAcceptor::from(Arc::new(config)))
}

/// TLS with a self-signed certificate. It is made once and then kept, so that a browser that was set to trust it goes on doing so.
///
/// # Errors
/// When it cannot be made or written.
pub(super) fn self_signed_acceptor(folder: &Path, address: IpAddr) -> Result<TlsAcceptor, StudyError> {
    let (certificate, key) = (folder.join(SELF_SIGNED_CERTIFICATE_FILE), folder.join(SELF_SIGNED_KEY_FILE));
    if !(certificate.is_file() && key.is_file()) {
        let names = vec!["localhost".to_owned(), "127.0.0.1".to_owned(), address.to_string()];
        let generated = rcgen::generate_simple_self_signed(names).map_err(|error| {
            StudyError::refused_request(format!("no certificate can be made: {error}"), "give --tls CERT KEY")
        })?;
        fs::write(&certificate, generated.cert.pem()).map_err(StudyError::io_error(&certificate, "write"))?;
        write_secret(&key, &generated.signing_key.serialize_pem()).map_err(StudyError::io_error(&key, "write"))?;
    }
    acceptor_from_files(&certificate, &key)
}

/// Writes a file that only its owner can read.
fn write_secret(path: &Path, text: &str) -> std::io::Result<()> {
    use std::io::Write as _;
    let mut options = fs::OpenOptions::new();
    options.write(true).create(true).truncate(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)?.write_all(text.as_bytes())
}
