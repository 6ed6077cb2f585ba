//! A network that is too large for a board must end the build with what is too large, and by how much.

use crate::firmware::{board, select};
use crate::process::shown;
use crate::toolchain::Toolchain;
use crate::{Outcome, project};

/// Builds firmware with a network that no board can hold: the build must fail and say what is too large, and by how
/// much.
pub(crate) fn refuses() -> Outcome {
    let toolchain = Toolchain::ready().ok_or("no firmware toolchain; run `cargo xtask setup`")?;
    let board = board("qemu-mps2-an386")?;
    let path = project::output_folder()?.join("too-large.toml");
    std::fs::write(&path, large_network(3_000))
        .map_err(|e| format!("cannot write {}: {e}", path.display()))?;
    let mut cargo = toolchain.cargo();
    select(cargo.arg("build"), board)?;
    cargo.env("ECLSS_NETWORK", &path);
    println!("$ ECLSS_NETWORK={} {}", path.display(), shown(&cargo));
    let built = cargo.output().map_err(|e| format!("cannot start cargo: {e}"))?;
    let text = String::from_utf8_lossy(&built.stderr).into_owned();
    let said = text.lines().find(|line| line.contains("does not fit"));
    match said {
        Some(line) if !built.status.success() && line.contains("bytes too many") => {
            println!("{line}");
            Ok(())
        }
        _ if built.status.success() => Err("a network of 3 000 nodes was built for a small board".into()),
        _ => Err(format!("the build failed without saying what does not fit:\n{text}")),
    }
}

/// A network file: a chain of cabins under a method that needs a matrix.
fn large_network(nodes: usize) -> String {
    let mut text = String::from(
        "schema = 1\nname = \"too_large\"\nreference_pressure_pa = 101325.0\n\n[run]\nmethod = \"tr-bdf2\"\n",
    );
    text.extend((0..nodes).map(|node| {
        format!(
            "\n[[node]]\nid = \"n{node}\"\nkind = \"cabin\"\nvolume_m3 = 60.0\npressure_pa = 101325.0\n\
             temperature_k = 295.15\n"
        )
    }));
    text.extend((1..nodes).map(|line| {
        let from = line - 1;
        format!(
            "\n[[line]]\nid = \"l{line}\"\nfrom = \"n{from}\"\nto = \"n{line}\"\n\n[[line.element]]\nid = \"p{line}\"\n\
             kind = \"pipe\"\nresistance_pa_s2_kg2 = 800.0\nlength_m = 2.0\ndiameter_m = 0.1\n"
        )
    }));
    text
}
