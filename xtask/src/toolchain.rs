//! The compiler for Cortex-M: rustup's target where rustup can fetch it, else one built from Debian's packages.
//!
//! On machines that reach only their distribution's mirror and the crate registry, rustup has nothing to
//! download from. Debian's `rustc-web`, `cargo-web` and `rust-web-src` hold a matching compiler and source, `rust-web-clippy` its lints:
//! `core` and `alloc` are built once into a private sysroot, after which an ordinary stable `cargo build`
//! works, with neither `-Z` flags nor nightly in the project.

use crate::process::{command, output, present, run};
use crate::{Outcome, project, setup};
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The instruction set of every Cortex-M board here: M4F and M7, floats in FPU registers.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";
/// Name under which the Debian-made toolchain is linked into rustup.
const LINKED: &str = "eclss-fw";
const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-clippy"];
/// Changed when the recipe below changes, so that older sysroots are rebuilt.
const RECIPE: &str = "2";

/// A toolchain that can build the firmware.
pub(crate) enum Toolchain {
    /// The one that is active anyway.
    Active,
    /// The sysroot made here, at this path.
    Private(PathBuf),
}

impl Toolchain {
    /// The toolchain to use now, if one is ready. `ECLSS_TOOLCHAIN=debian` overlooks the active one.
    pub(crate) fn ready() -> Option<Self> {
        if !debian_forced() && has_core(&active_sysroot()?) {
            return Some(Self::Active);
        }
        let sysroot = project::cache_folder().ok()?.join("toolchain/sysroot");
        (has_core(&sysroot) && up_to_date()).then_some(Self::Private(sysroot))
    }

    /// `cargo` of this toolchain.
    pub(crate) fn cargo(&self) -> Command {
        let Self::Private(sysroot) = self else { return Command::new("cargo") };
        let mut cargo = Command::new(sysroot.join("bin/cargo"));
        cargo.env("RUSTC", sysroot.join("bin/rustc")).env("RUSTDOC", sysroot.join("bin/rustdoc"));
        cargo.env_remove("RUSTUP_TOOLCHAIN");
        cargo
    }

    /// Name and version of the compiler.
    pub(crate) fn version(&self) -> Option<String> {
        let mut rustc = match self {
            Self::Active => Command::new("rustc"),
            Self::Private(sysroot) => Command::new(sysroot.join("bin/rustc")),
        };
        // `rustc 1.96.0 (…)`: the release is what matters.
        let text = output(rustc.arg("-V"))?;
        Some(text.split_whitespace().take(2).collect::<Vec<_>>().join(" "))
    }

    /// `cargo clippy` of this toolchain.
    pub(crate) fn clippy(&self) -> Command {
        let mut clippy = self.cargo();
        if let Self::Private(sysroot) = self {
            // Cargo looks for its subcommand beside itself first; the driver asks the compiler for a sysroot.
            clippy = Command::new("/usr/bin/cargo-clippy");
            clippy.env("CARGO", sysroot.join("bin/cargo")).env("SYSROOT", sysroot);
            clippy.env("RUSTC", sysroot.join("bin/rustc")).env_remove("RUSTUP_TOOLCHAIN");
        }
        clippy.arg("clippy");
        clippy
    }

    /// Whether [`Self::clippy`] is there.
    pub(crate) fn has_clippy(&self) -> bool {
        match self {
            Self::Active => present("cargo-clippy"),
            Self::Private(_) => Path::new("/usr/bin/cargo-clippy").exists(),
        }
    }

    /// One line for the user.
    pub(crate) fn describe(&self) -> String {
        match self {
            Self::Active => format!("the active toolchain has {TARGET}"),
            Self::Private(path) => format!("a private toolchain in {} has {TARGET}", path.display()),
        }
    }
}

/// Makes a toolchain ready: nothing, `rustup target add`, or the build from Debian's source packages.
pub(crate) fn install() -> Outcome<Toolchain> {
    if let Some(toolchain) = Toolchain::ready() {
        return Ok(toolchain);
    }
    if !debian_forced() && present("rustup") {
        println!("The active toolchain lacks {TARGET}; rustup may have it.");
        if run(&mut command("rustup", &["target", "add", TARGET])).is_ok()
            && let Some(toolchain) = Toolchain::ready()
        {
            return Ok(toolchain);
        }
        println!("rustup could not fetch it.");
    }
    if !Path::new("/etc/debian_version").exists() {
        return Err(format!(
            "no toolchain for {TARGET}. Install rustup and run `rustup target add {TARGET}`; \
             without rustup only Debian's own compiler packages are supported"
        ));
    }
    println!(
        "Taking the distribution's compiler and building `core` for {TARGET} from its source (about a minute)."
    );
    setup::apt_install(&PACKAGES)?;
    build_sysroot()?;
    Toolchain::ready().ok_or_else(|| format!("the new sysroot does not hold `core` for {TARGET}"))
}

fn debian_forced() -> bool {
    std::env::var_os("ECLSS_TOOLCHAIN").is_some_and(|choice| choice == "debian")
}

fn active_sysroot() -> Option<PathBuf> {
    output(&mut command("rustc", &["--print", "sysroot"])).map(|path| PathBuf::from(path.trim()))
}

fn has_core(sysroot: &Path) -> bool {
    let libraries = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    let Ok(entries) = fs::read_dir(libraries) else { return false };
    entries.flatten().any(|entry| is_library(&entry.path(), &["libcore-"]))
}

/// Whether a file is a compiled library whose name begins with one of `starts`.
fn is_library(path: &Path, starts: &[&str]) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.extension().is_some_and(|extension| extension == "rlib")
        && starts.iter().any(|start| name.starts_with(start))
}

/// What the sysroot was made from; a newer distribution package makes it stale.
fn stamp() -> Option<String> {
    let compiler = output(&mut command("/usr/bin/rustc", &["-V"]))?;
    let source = output(&mut command("dpkg-query", &["-W", "-f=${Version}", "rust-web-src"]))?;
    Some(format!("{} | {source} | {TARGET} | recipe {RECIPE}\n", compiler.trim()))
}

fn up_to_date() -> bool {
    let Ok(folder) = project::cache_folder() else { return false };
    let made_from = fs::read_to_string(folder.join("toolchain/stamp")).ok();
    made_from.is_some() && made_from == stamp()
}

fn build_sysroot() -> Outcome {
    let say = |e: std::io::Error| format!("cannot write the private sysroot: {e}");
    let folder = project::cache_folder()?.join("toolchain");
    let (sysroot, dummy) = (folder.join("sysroot"), folder.join("dummy"));
    let host = host_triple()?;
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(say)?;
    }
    for part in
        [&sysroot.join("bin"), &sysroot.join("lib/rustlib").join(&host).join("bin"), &dummy.join("src")]
    {
        fs::create_dir_all(part).map_err(say)?;
    }
    // The host's standard library (for build scripts and macros) and the sources stay the distribution's.
    let rustlib = sysroot.join("lib/rustlib");
    symlink(format!("/usr/lib/rustlib/{host}/lib"), rustlib.join(&host).join("lib")).map_err(say)?;
    symlink("/usr/lib/rustlib/src", rustlib.join("src")).map_err(say)?;
    symlink(linker()?, rustlib.join(&host).join("bin/rust-lld")).map_err(say)?;
    symlink("/usr/bin/cargo", sysroot.join("bin/cargo")).map_err(say)?;
    for tool in ["rustc", "rustdoc"] {
        let wrapper = sysroot.join("bin").join(tool);
        let script = format!("#!/bin/sh\nexec /usr/bin/{tool} --sysroot '{}' \"$@\"\n", sysroot.display());
        fs::write(&wrapper, script).map_err(say)?;
        fs::set_permissions(&wrapper, fs::Permissions::from_mode(0o755)).map_err(say)?;
    }
    // `core` and its companions, by cargo's own recipe, as dependencies of an empty crate.
    let manifest = "[package]\nname = \"dummy\"\nversion = \"0.0.0\"\nedition = \"2024\"\n[workspace]\n";
    fs::write(dummy.join("Cargo.toml"), manifest).map_err(say)?;
    fs::write(dummy.join("src/lib.rs"), "#![no_std]\n").map_err(say)?;
    let mut build = command("/usr/bin/cargo", &["build", "--release", "--target", TARGET]);
    build.args(["-Z", "build-std=core,alloc", "-Z", "build-std-features=compiler-builtins-mem"]);
    build.current_dir(&dummy).env("RUSTC", "/usr/bin/rustc").env("RUSTC_BOOTSTRAP", "1");
    build.env("CARGO_TARGET_DIR", folder.join("build"));
    build.env("RUSTFLAGS", "-Cembed-bitcode=yes --remap-path-prefix=/usr/src=/rustc/src");
    for inherited in ["RUSTUP_TOOLCHAIN", "CARGO_BUILD_TARGET", "CARGO_ENCODED_RUSTFLAGS", "RUSTDOC", "CARGO"]
    {
        build.env_remove(inherited);
    }
    run(&mut build)?;
    let libraries = rustlib.join(TARGET).join("lib");
    fs::create_dir_all(&libraries).map_err(say)?;
    for entry in fs::read_dir(folder.join("build").join(TARGET).join("release/deps")).map_err(say)?.flatten()
    {
        if is_library(&entry.path(), &["libcore-", "liballoc-", "libcompiler_builtins-"]) {
            fs::copy(entry.path(), libraries.join(entry.file_name())).map_err(say)?;
        }
    }
    fs::remove_dir_all(folder.join("build")).map_err(say)?;
    fs::remove_dir_all(dummy).map_err(say)?;
    fs::write(folder.join("stamp"), stamp().ok_or("the distribution's compiler does not answer")?)
        .map_err(say)?;
    if present("rustup") {
        let sysroot = sysroot.to_string_lossy().into_owned();
        run(&mut command("rustup", &["toolchain", "link", LINKED, &sysroot]))?;
        println!("`cargo +{LINKED} build --target {TARGET}` now works by hand, too.");
    }
    Ok(())
}

fn host_triple() -> Outcome<String> {
    let version = output(&mut command("/usr/bin/rustc", &["-vV"])).ok_or("/usr/bin/rustc does not run")?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| "/usr/bin/rustc -vV names no host".into())
}

/// An `lld`: the active toolchain's own, else the distribution's newest.
fn linker() -> Outcome<PathBuf> {
    let host = host_triple()?;
    let bundled = active_sysroot().map(|root| root.join("lib/rustlib").join(host).join("bin/rust-lld"));
    if let Some(lld) = bundled.filter(|path| path.exists()) {
        return Ok(lld);
    }
    if newest_lld().is_none() {
        setup::apt_install(&["lld"])?;
    }
    newest_lld().ok_or_else(|| "no lld found after installing it".into())
}

fn newest_lld() -> Option<PathBuf> {
    let versions = fs::read_dir("/usr/lib").ok()?.flatten().filter_map(|entry| {
        let version: u32 = entry.file_name().to_str()?.strip_prefix("llvm-")?.parse().ok()?;
        let lld = entry.path().join("bin/lld");
        lld.exists().then_some((version, lld))
    });
    versions.max().map(|(_, lld)| lld)
}
