//! `cargo xtask setup`: makes a machine able to build and run the firmware, and is safe to repeat.

use crate::process::{command, output, present, run};
use crate::test::in_ci;
use crate::{Outcome, project, toolchain};

/// The oldest emulator whose boards were tried.
const QEMU_AT_LEAST: (u32, u32) = (7, 2);
/// Tools from the crate registry: name, and why they are needed.
const CARGO_TOOLS: [(&str, &str); 2] = [
    ("flip-link", "links the firmware so that a stack overflow faults instead of overwriting state"),
    ("defmt-print", "decodes the firmware's log"),
];

/// Checks each need in turn and installs what is missing, saying what it does before it does it.
pub(crate) fn setup(arguments: &[String]) -> Outcome {
    if let Some(unknown) = arguments.first() {
        return Err(format!("unknown argument `{unknown}`"));
    }
    let toolchain = toolchain::install()?;
    println!("ready: {}", toolchain.describe());
    install_qemu()?;
    for (tool, purpose) in CARGO_TOOLS {
        install_cargo_tool(tool, purpose)?;
    }
    install_browser()
}

/// Whether the page can be tested here.
pub(crate) fn browser_present() -> bool {
    present("chromedriver")
        && ["chromium", "chromium-browser", "google-chrome"].iter().any(|name| present(name))
}

/// Installs the browser in which the page is tested. Only machines that decide about changes must have it.
fn install_browser() -> Outcome {
    if !browser_present() {
        println!("Chromium or its driver is missing; the live page is tested in it.");
        if let Err(reason) = apt_install(&["chromium", "chromium-driver"]) {
            if in_ci() {
                return Err(reason);
            }
            println!("The page will not be tested: {reason}");
            return Ok(());
        }
        if !browser_present() && in_ci() {
            return Err("chromium and chromium-driver were installed but are not on the PATH".into());
        }
    }
    println!("ready: chromium, chromedriver");
    Ok(())
}

/// Whether [`setup`] would change nothing.
pub(crate) fn complete() -> bool {
    toolchain::Toolchain::ready().is_some()
        && qemu_version().is_some_and(|version| version >= QEMU_AT_LEAST)
        && CARGO_TOOLS.iter().all(|(tool, _)| present(tool))
}

fn install_qemu() -> Outcome {
    if qemu_version().is_none() {
        println!("qemu-system-arm is missing; it emulates the boards.");
        apt_install(&["qemu-system-arm"])?;
    }
    let (major, minor) = qemu_version().ok_or("qemu-system-arm does not run")?;
    if (major, minor) < QEMU_AT_LEAST {
        let (wanted_major, wanted_minor) = QEMU_AT_LEAST;
        return Err(format!(
            "qemu-system-arm is {major}.{minor}; {wanted_major}.{wanted_minor} or newer is needed"
        ));
    }
    println!("ready: qemu-system-arm {major}.{minor}");
    Ok(())
}

/// `QEMU emulator version 7.2.22 (Debian …)` → `(7, 2)`.
fn qemu_version() -> Option<(u32, u32)> {
    let text = output(&mut command("qemu-system-arm", &["--version"]))?;
    let mut numbers = text.split_whitespace().nth(3)?.split('.').map(str::parse);
    Some((numbers.next()?.ok()?, numbers.next()?.ok()?))
}

fn install_cargo_tool(tool: &str, purpose: &str) -> Outcome {
    if !present(tool) {
        println!("{tool} is missing; it {purpose}. Building it may take a minute.");
        // In a folder of its own, dropped afterwards: these builds have nothing in common with ours.
        let folder = project::output_folder()?.join("tools");
        run(command("cargo", &["install", "--locked", "--quiet", tool]).env("CARGO_TARGET_DIR", &folder))?;
        // Losing the race to clean up costs disk space only.
        let _ = std::fs::remove_dir_all(&folder);
        if !present(tool) {
            return Err(format!("{tool} was installed but is not on the PATH: add cargo's bin folder to it"));
        }
    }
    println!("ready: {tool}");
    Ok(())
}

/// Installs distribution packages on Debian and its kin, as root or through sudo.
pub(crate) fn apt_install(packages: &[&str]) -> Outcome {
    let wanted: Vec<&str> = packages.iter().copied().filter(|package| !installed(package)).collect();
    if wanted.is_empty() {
        return Ok(());
    }
    let list = wanted.join(" ");
    if !present("apt-get") {
        return Err(format!("install {list} with your distribution's package manager, then repeat"));
    }
    let root = output(&mut command("id", &["-u"])).is_some_and(|id| id.trim() == "0");
    if !root && !present("sudo") {
        return Err(format!(
            "installing {list} needs root or sudo; neither is at hand. Have them installed, then repeat"
        ));
    }
    println!("Installing the distribution's packages: {list}");
    let apt = |arguments: &[&str]| {
        let mut apt = if root {
            command("apt-get", &[])
        } else {
            command("sudo", &["DEBIAN_FRONTEND=noninteractive", "apt-get"])
        };
        apt.args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        run(&mut apt)
    };
    // A bare machine has no package lists at all, an old one lists versions that are gone.
    apt(&["update", "-qq"])?;
    apt(&[&["install", "-y", "-qq", "--no-install-recommends"], wanted.as_slice()].concat())
}

fn installed(package: &str) -> bool {
    output(&mut command("dpkg-query", &["-W", "-f=${Status}", package]))
        .is_some_and(|s| s == "install ok installed")
}
