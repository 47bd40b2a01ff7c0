//! Simulators that run beside this program.

use crate::{error::Error, output};
use std::{path::Path, sync::Arc};
use wayword_core::Platform;
use wayword_live::{
    tdw::{ControllerOptions, TdwOptions, TdwPlatform},
    virtualhome::{VirtualHomeOptions, VirtualHomePlatform},
};

/// Waits for a build at an address.
pub(super) fn tdw(package: Option<&Path>, at: Option<&str>) -> Result<Box<dyn Platform>, Error> {
    let mut controller = ControllerOptions::default();
    if let Some(at) = at {
        let hint = "write it as in --at 127.0.0.1:1071; 0.0.0.0:1071 lets builds on other machines in";
        controller.address = at.parse().map_err(|_| Error::usage(format!("--at {at}: that is no address"), hint))?;
    }
    let options = TdwOptions { controller, package: package.map(Path::to_owned), ..TdwOptions::default() };
    let platform = TdwPlatform::new(options)
        .map_err(|error| Error::usage(error.to_string(), "free the port, or name another with --at 127.0.0.1:1072"))?;
    Ok(Box::new(platform.heard_by(Arc::new(output::pass_on))))
}

/// Speaks to the executable at an address.
pub(super) fn virtualhome(at: Option<&str>) -> Result<Box<dyn Platform>, Error> {
    let mut options = VirtualHomeOptions::default();
    if let Some(at) = at {
        if !at.starts_with("http://") {
            let hint = "write it as in --at http://127.0.0.1:8080";
            return Err(Error::usage(format!("--at {at}: that is no HTTP address"), hint));
        }
        options.url = at.to_owned();
    }
    Ok(Box::new(VirtualHomePlatform::new(options).heard_by(Arc::new(output::pass_on))))
}
