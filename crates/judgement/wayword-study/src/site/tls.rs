//! Sets up TLS with the user's certificate, or with a self-signed one that the study makes.

use crate::study::StudyError;
use std::{fs, net::IpAddr, path::Path, sync::Arc};
use tokio_rustls::{
    TlsAcceptor,
    rustls::{
        Error, ServerConfig,
        pki_types::{
            CertificateDer, PrivateKeyDer,
            pem::{self, PemObject as _},
        },
    },
};

/// What to give for TLS.
const TLS_HINT: &str = "give --tls the certificate chain first and then its private key, as PEM files (-----BEGIN CERTIFICATE-----, \
                        -----BEGIN PRIVATE KEY-----)";
/// Largest PEM file that is read, bytes.
const MAX_PEM_BYTES: u64 = 1 << 20;
/// The files of the self-signed certificate.
const SELF_SIGNED_CERTIFICATE_FILE: &str = "self-signed.pem";
const SELF_SIGNED_KEY_FILE: &str = "self-signed.key";

/// TLS with a certificate and a key, both in PEM.
///
/// # Errors
/// When a file cannot be read, or the two do not fit.
pub(super) fn acceptor_from_files(certificate: &Path, key: &Path) -> Result<TlsAcceptor, StudyError> {
    let wrong = |path: &Path, problem: &str| StudyError::File {
        path: path.to_owned(),
        problem: problem.to_owned(),
        hint: TLS_HINT,
    };
    let (chain_pem, key_pem) = (read_pem(certificate)?, read_pem(key)?);
    let chain: Vec<CertificateDer<'static>> = CertificateDer::pem_slice_iter(&chain_pem)
        .collect::<Result<_, _>>()
        .map_err(|error| wrong(certificate, &error.to_string()))?;
    if chain.is_empty() {
        let has_key = PrivateKeyDer::from_pem_slice(&chain_pem).is_ok();
        return Err(wrong(
            certificate,
            if has_key { "this is a private key, not a certificate" } else { "it holds no certificate" },
        ));
    }
    let private_key = PrivateKeyDer::from_pem_slice(&key_pem).map_err(|error| match error {
        pem::Error::NoItemsFound if CertificateDer::from_pem_slice(&key_pem).is_ok() => {
            wrong(key, "this is a certificate, not a private key")
        }
        pem::Error::NoItemsFound => wrong(key, "it holds no private key without a password"),
        error => wrong(key, &error.to_string()),
    })?;
    let provider = Arc::new(tokio_rustls::rustls::crypto::ring::default_provider());
    let config = ServerConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .and_then(|builder| builder.with_no_client_auth().with_single_cert(chain, private_key));
    let mut config = config.map_err(|error| match error {
        Error::InconsistentKeys(_) => wrong(key, "this key does not belong to the certificate"),
        error => wrong(certificate, &error.to_string()),
    })?;
    config.alpn_protocols = vec![b"http/1.1".to_vec()];
    Ok(TlsAcceptor::from(Arc::new(config)))
}

/// Reads a PEM file, unless it is far too large for one.
fn read_pem(path: &Path) -> Result<Vec<u8>, StudyError> {
    let wrong = |problem: String| StudyError::File { path: path.to_owned(), problem, hint: TLS_HINT };
    let cannot_read = |error: std::io::Error| wrong(format!("cannot read: {error}"));
    let size = fs::metadata(path).map_err(cannot_read)?.len();
    if size > MAX_PEM_BYTES {
        return Err(wrong(format!("it has {size} bytes, and at most {MAX_PEM_BYTES} are read")));
    }
    fs::read(path).map_err(cannot_read)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_certificate_or_no_key_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["a", "b"] {
            let made = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
            fs::write(at(&format!("{name}.pem")), made.cert.pem()).unwrap();
            fs::write(at(&format!("{name}.key")), made.signing_key.serialize_pem()).unwrap();
        }
        fs::write(at("notes.txt"), "no PEM").unwrap();
        let told = |certificate: &str, key: &str| {
            acceptor_from_files(&at(certificate), &at(key)).map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(told("a.pem", "a.key"), Ok(()));
        for (certificate, key, file, said) in [
            ("notes.txt", "a.key", "notes.txt", "it holds no certificate"),
            ("a.pem", "notes.txt", "notes.txt", "it holds no private key"),
            ("a.key", "a.key", "a.key", "this is a private key, not a certificate"),
            ("a.pem", "a.pem", "a.pem", "this is a certificate, not a private key"),
            ("a.pem", "b.key", "b.key", "this key does not belong to the certificate"),
        ] {
            let told = told(certificate, key).unwrap_err();
            assert!(told.contains(&format!("{file}: {said}")) && told.contains("--tls"), "{certificate} {key}: {told}");
        }
        assert!(told("gone.pem", "a.key").unwrap_err().contains("gone.pem: cannot read"));
    }
}
