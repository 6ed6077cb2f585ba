//! Which network runs: the one that is compiled in, or an image that the emulator's command line names.

use super::semihosting::{self, Request};
use crate::image::{self, Image, ImageError};
use crate::network::{self, NetworkPlant};
use eclss_core::{Network, Simulator, Storage};
use static_cell::{ConstStaticCell, StaticCell};

/// The plant of a run; ends the run when there is none.
pub(super) fn plant(request: &Request) -> NetworkPlant {
    let plant = match &request.image {
        None => network::compiled_in().map_err(|error| defmt::error!("the network is refused: {}", error)),
        Some(path) => load(path),
    };
    plant.unwrap_or_else(|()| semihosting::exit(false))
}

#[inline(never)]
fn load(path: &str) -> Result<NetworkPlant, ()> {
    static BYTES: ConstStaticCell<[u8; image::BYTES]> = ConstStaticCell::new([0; image::BYTES]);
    static IMAGE: StaticCell<Result<Image, ImageError>> = StaticCell::new();
    static NETWORK: StaticCell<Network<'static>> = StaticCell::new();
    static STORAGE: ConstStaticCell<
        Storage<{ image::NUMBERS }, { image::NUMBERS }, { 3 * image::SEGMENTS }, { image::SCHEDULES }>,
    > = ConstStaticCell::new(Storage::new());
    let bytes = BYTES.take();
    let length = semihosting::read_file(path, bytes);
    let bytes = length.and_then(|length| bytes.get(..length)).ok_or_else(|| {
        defmt::error!("cannot read `{=str}`", path);
    })?;
    // An image is large: it is made where it stays.
    let image = IMAGE.init_with(|| Image::read(bytes)).as_ref().map_err(|error| *error);
    let run = image.and_then(|image| Ok((image, image.settings()?)));
    let (image, settings) = run.map_err(|error| defmt::error!("the image is refused: {}", error))?;
    let network = NETWORK.init(image.network());
    let simulator = Simulator::new(network, settings, STORAGE.take().buffers())
        .map_err(|error| defmt::error!("the network is refused: {}", error))?;
    Ok(network::loaded(simulator, "image", &[]))
}
