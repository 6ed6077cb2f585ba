//! Feature `compiled`: writes the network that `ECLSS_NETWORK` names, relative to the workspace, as constant tables.
//!
//! Without that variable the paper's loop is taken, as for a board. Nothing to do without the feature.

use std::process::ExitCode;

#[cfg(not(feature = "compiled"))]
fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=build.rs");
    ExitCode::SUCCESS
}

#[cfg(feature = "compiled")]
fn main() -> ExitCode {
    match compiled::write() {
        Ok(()) => ExitCode::SUCCESS,
        Err(problems) => {
            for problem in problems {
                println!("cargo::error={problem}");
            }
            ExitCode::FAILURE
        }
    }
}

#[cfg(feature = "compiled")]
mod compiled {
    use std::path::PathBuf;
    use std::{env, fs};

    /// What names the network.
    const VARIABLE: &str = "ECLSS_NETWORK";
    /// The network of a build that names none.
    const DEFAULT: &str = "networks/paper.toml";
    /// Most segments for which a step is specialised; beyond, code would grow with the network.
    const MOST: usize = 64;

    pub(crate) fn write() -> Result<(), Vec<String>> {
        println!("cargo::rerun-if-changed=build.rs");
        println!("cargo::rerun-if-env-changed={VARIABLE}");
        let name = match env::var(VARIABLE) {
            Ok(name) => name,
            Err(env::VarError::NotPresent) => DEFAULT.to_owned(),
            Err(error) => return Err(vec![format!("{VARIABLE}: {error}")]),
        };
        let path = PathBuf::from("..").join(&name);
        println!("cargo::rerun-if-changed={}", path.display());
        let text = fs::read_to_string(&path)
            .map_err(|error| vec![format!("{VARIABLE}=\"{name}\", relative to the workspace: {error}")])?;
        let loaded = eclss_network_file::parse(&text, &name)
            .map_err(|error| error.problems().iter().map(ToString::to_string).collect::<Vec<_>>())?;
        let segments = loaded.network().segments.len();
        if segments > MOST {
            return Err(vec![format!(
                "{name}: has {segments} elements in its lines; a step is specialised for up to {MOST}"
            )]);
        }
        let out = PathBuf::from(env::var_os("OUT_DIR").ok_or(["no OUT_DIR".to_owned()])?);
        fs::write(out.join("network.rs"), loaded.to_rust())
            .map_err(|error| vec![format!("cannot write network.rs: {error}")])
    }
}
