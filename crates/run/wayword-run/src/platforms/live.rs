//! Connects to simulators that run as separate programs: ThreeDWorld and VirtualHome.

use crate::{error::CommandError, output};
use std::{
    io::ErrorKind,
    net::{SocketAddr, TcpStream, ToSocketAddrs},
    path::Path,
    sync::Arc,
    time::Duration,
};
use wayword_core::Platform;
use wayword_live::{
    tdw::{ControllerOptions, TdwOptions, TdwPlatform},
    virtualhome::{VirtualHomeOptions, VirtualHomePlatform},
};

/// How long a port may take to answer.
const PORT_WAIT: Duration = Duration::from_secs(2);

/// Waits for a TDW build at an address.
pub(super) fn open_tdw(package: Option<&Path>, at: Option<&str>) -> Result<Box<dyn Platform>, CommandError> {
    let mut controller = ControllerOptions::default();
    if let Some(at) = at {
        let hint = "write it as in --at 127.0.0.1:1071; use 0.0.0.0:1071 to accept builds on other machines";
        controller.address =
            at.parse().map_err(|_| CommandError::usage(format!("--at {at} is not an address"), hint))?;
    }
    let options = TdwOptions { controller, package: package.map(Path::to_owned), ..TdwOptions::default() };
    let platform = TdwPlatform::new(options).map_err(|error| {
        CommandError::usage(error.to_string(), "free the port, or name another with --at 127.0.0.1:1072")
    })?;
    Ok(Box::new(platform.heard_by(Arc::new(output::print_foreign_line))))
}

/// Connects to the VirtualHome executable at an address.
pub(super) fn open_virtualhome(at: Option<&str>) -> Result<Box<dyn Platform>, CommandError> {
    let mut options = VirtualHomeOptions::default();
    if let Some(at) = at {
        if !at.starts_with("http://") {
            let hint = "write it as in --at http://127.0.0.1:8080";
            return Err(CommandError::usage(format!("--at {at} is not an HTTP address"), hint));
        }
        options.url = at.to_owned();
    }
    refuse_closed_port(&options.url)?;
    Ok(Box::new(VirtualHomePlatform::new(options).heard_by(Arc::new(output::print_foreign_line))))
}

/// Refuses a closed port before a run begins.
fn refuse_closed_port(url: &str) -> Result<(), CommandError> {
    let host = url.trim_start_matches("http://").split('/').next().unwrap_or_default();
    // An address that cannot be parsed gets the client's own error.
    let Ok(mut addresses) = host.to_socket_addrs() else { return Ok(()) };
    let refuses = |address: SocketAddr| {
        TcpStream::connect_timeout(&address, PORT_WAIT).is_err_and(|error| error.kind() == ErrorKind::ConnectionRefused)
    };
    if addresses.all(refuses) {
        let port = host.rsplit(':').next().unwrap_or_default();
        return Err(CommandError::usage(
            format!("nothing listens at {url}, so VirtualHome cannot be asked"),
            format!("start VirtualHome with -batchmode -http-port={port}, or give its address: --at URL"),
        ));
    }
    Ok(())
}
