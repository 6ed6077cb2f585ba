//! Writes a network file as an image that a board loads at run time: `network-image NETWORK.toml IMAGE`.

use eclss_core::Settings;
use eclss_target::image;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [network, path] = arguments.as_slice() else {
        return Err("usage: network-image NETWORK.toml IMAGE".into());
    };
    let loaded = eclss_network_file::load(Path::new(network))?;
    image::check(&loaded).map_err(|why| format!("{network} {why}"))?;
    let settings = Settings { method: loaded.run.method, step_us: loaded.run.step_us };
    let mut buffer = vec![0; image::BYTES];
    let bytes = image::write(&loaded.network(), settings, &mut buffer).map_err(|error| match error {
        image::ImageError::Climate => format!("{network} has a climate, and an image has flows only"),
        _ => format!("{network} is larger than an image may be ({} bytes)", image::BYTES),
    })?;
    std::fs::write(path, bytes)?;
    println!("{path}: network {:016x}, {} bytes", loaded.network().id(), bytes.len());
    Ok(())
}
