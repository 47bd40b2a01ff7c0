//! TLS to a server: its certificate and name are always checked.

use crate::DatabaseError;
use rustls::{
    ClientConfig, RootCertStore,
    crypto::ring,
    pki_types::{CertificateDer, pem::PemObject},
};
use std::{env, path::PathBuf, sync::Arc};
use tokio_postgres_rustls::MakeRustlsConnect;

const CERTIFICATE_HINT: &str = "name the authority that signed the server's certificate, a PEM file, in PGSSLROOTCERT";

/// Makes TLS connections. The authorities are those of PGSSLROOTCERT, else the public ones.
pub(crate) fn tls_connector() -> Result<MakeRustlsConnect, DatabaseError> {
    let mut roots = RootCertStore::empty();
    match env::var_os("PGSSLROOTCERT").filter(|path| !path.is_empty()) {
        None => roots.extend(webpki_roots::TLS_SERVER_ROOTS.iter().cloned()),
        Some(path) => {
            let path = PathBuf::from(path);
            let failed = |problem: String| DatabaseError::File { path: path.clone(), problem, hint: CERTIFICATE_HINT };
            let certificates = CertificateDer::pem_file_iter(&path).map_err(|error| failed(error.to_string()))?;
            for certificate in certificates {
                let certificate = certificate.map_err(|error| failed(error.to_string()))?;
                roots.add(certificate).map_err(|error| failed(error.to_string()))?;
            }
            if roots.is_empty() {
                return Err(failed("it holds no certificate".to_owned()));
            }
        }
    }
    let builder = ClientConfig::builder_with_provider(Arc::new(ring::default_provider()));
    let config = builder
        .with_safe_default_protocol_versions()
        .map_err(|error| DatabaseError::Name {
            problem: format!("TLS cannot be used: {error}"),
            hint: CERTIFICATE_HINT,
        })?
        .with_root_certificates(roots)
        .with_no_client_auth();
    Ok(MakeRustlsConnect::new(config))
}
