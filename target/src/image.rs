//! A network as an image: what a board loads at run time instead of having it compiled in.
//!
//! Written with postcard from any description, read into arrays of fixed capacity. The last eight bytes are a hash
//! over the others, so that a damaged image is refused. The image also carries the network id that the writer
//! computed; a reader computes it anew, so that both are known to mean the same network.

use eclss_core::{
    Active, Fingerprint, Line, Method, Network, Node, Plan, Responsive, Schedule, SchedulePoint, Segment,
    Settings,
};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Version of the layout; readers refuse any other.
const VERSION: u8 = 3;
/// Capacity of [`Image`]: nodes, lines, and entries of the elimination.
pub const NODES: usize = 64;
/// Segments, inputs and points of schedules.
pub const SEGMENTS: usize = 256;
/// Schedules.
pub const SCHEDULES: usize = 16;
/// Entries of L + U.
const ENTRIES: usize = 512;
/// Numbers of state, and as many of work, that a network of these capacities may need with any method.
pub const NUMBERS: usize = 8 * 1024 + 128;
/// Bytes of the hash at the end.
const TRAILER: usize = 8;
/// Most bytes of an image that fits these capacities: every table full, every number at its longest.
pub const BYTES: usize = 30 * 1024;

/// Why an image was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ImageError {
    /// The hash at the end is not that of the bytes before it.
    Damaged,
    /// A table is longer than its capacity, or the bytes are no image.
    Unreadable,
    /// Of another version.
    Version(u8),
    /// A method that does not exist.
    Method(u8),
    /// The description's id is not the one that the writer computed.
    OtherId {
        /// As written.
        written: u64,
        /// Of what arrived.
        arrived: u64,
    },
    /// The buffer of the writer is too short.
    NoRoom,
    /// An image has flows only, and the network has a climate.
    Climate,
}

/// An image as written; field by field what [`Image`] reads.
#[derive(Serialize)]
struct Written<'a> {
    version: u8,
    method: u8,
    step_us: u32,
    id: u64,
    reference_pa: f32,
    nodes: &'a [Node],
    lines: &'a [Line],
    segments: &'a [Segment],
    active: &'a [Active],
    responsive: &'a [Responsive],
    inputs: &'a [f32],
    schedules: &'a [Schedule],
    points: &'a [SchedulePoint],
    end_start: &'a [u32],
    ends: &'a [u32],
    order: &'a [u32],
    row_start: &'a [u32],
    columns: &'a [u32],
    diagonal: &'a [u32],
    stamps: &'a [[u32; 4]],
    row_of: &'a [u32],
    leaves: &'a [[u32; 2]],
    terms: &'a [[u32; 3]],
    composite: &'a [u32],
    between: &'a [[u32; 2]],
}

/// A network that was loaded at run time, with how it is run.
#[derive(Deserialize)]
pub struct Image {
    #[allow(dead_code, reason = "looked at before the rest is read")]
    version: u8,
    method: u8,
    step_us: u32,
    id: u64,
    reference_pa: f32,
    nodes: Vec<Node, NODES>,
    lines: Vec<Line, NODES>,
    segments: Vec<Segment, SEGMENTS>,
    active: Vec<Active, SEGMENTS>,
    responsive: Vec<Responsive, NODES>,
    inputs: Vec<f32, SEGMENTS>,
    schedules: Vec<Schedule, SCHEDULES>,
    points: Vec<SchedulePoint, SEGMENTS>,
    end_start: Vec<u32, { NODES + 1 }>,
    ends: Vec<u32, { 2 * NODES }>,
    order: Vec<u32, NODES>,
    row_start: Vec<u32, { NODES + 1 }>,
    columns: Vec<u32, ENTRIES>,
    diagonal: Vec<u32, NODES>,
    stamps: Vec<[u32; 4], NODES>,
    row_of: Vec<u32, NODES>,
    leaves: Vec<[u32; 2], NODES>,
    terms: Vec<[u32; 3], { 2 * NODES }>,
    composite: Vec<u32, NODES>,
    between: Vec<[u32; 2], SEGMENTS>,
}

/// Writes a description and its settings into `buffer`; returns the part that was used.
pub fn write<'b>(
    network: &Network<'_>,
    settings: Settings,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], ImageError> {
    if !network.climate.is_none() {
        return Err(ImageError::Climate);
    }
    let method = Method::ALL.iter().position(|method| *method == settings.method).unwrap_or(usize::MAX);
    let plan = network.plan;
    let written = Written {
        version: VERSION,
        method: method as u8,
        step_us: settings.step_us,
        id: network.id(),
        reference_pa: network.reference_pa,
        nodes: network.nodes,
        lines: network.lines,
        segments: network.segments,
        active: network.active,
        responsive: network.responsive,
        inputs: network.inputs,
        schedules: network.schedules,
        points: network.points,
        end_start: plan.end_start,
        ends: plan.ends,
        order: plan.order,
        row_start: plan.row_start,
        columns: plan.columns,
        diagonal: plan.diagonal,
        stamps: plan.stamps,
        row_of: plan.row_of,
        leaves: plan.leaves,
        terms: plan.terms,
        composite: plan.composite,
        between: plan.between,
    };
    let room = buffer.len().checked_sub(TRAILER).ok_or(ImageError::NoRoom)?;
    let used = postcard::to_slice(&written, &mut buffer[..room]).map_err(|_| ImageError::NoRoom)?.len();
    let hash = hash(&buffer[..used]);
    buffer[used..used + TRAILER].copy_from_slice(&hash.to_le_bytes());
    Ok(&buffer[..used + TRAILER])
}

/// Refuses a network of which an image would carry only a part: the error says which and what to do.
#[cfg(all(not(target_os = "none"), any(test, feature = "image-writer")))]
pub fn check(loaded: &eclss_network_file::Loaded) -> Result<(), std::string::String> {
    let process = &loaded.process;
    let names = process.inputs.iter().map(|entry| &entry.name);
    let names: std::vec::Vec<&str> = names
        .chain(process.outputs.iter().map(|entry| &entry.name))
        .map(std::string::String::as_str)
        .collect();
    if !names.is_empty() {
        return Err(std::format!(
            "binds {} to hardware, and an image carries no channels: compile it in with ECLSS_NETWORK, or take the \
             channels out to run its plant alone",
            names.join(", ")
        ));
    }
    if !loaded.network().climate.volumes.is_empty() {
        return Err("has a climate, which an image does not carry: compile it in with ECLSS_NETWORK".into());
    }
    Ok(())
}

fn hash(bytes: &[u8]) -> u64 {
    let mut hash = Fingerprint::default();
    for byte in bytes {
        hash.word(u32::from(*byte));
    }
    hash.finish()
}

impl Image {
    /// Reads an image. What it describes is still to be checked, as [`eclss_core::Simulator::new`] does.
    pub fn read(bytes: &[u8]) -> Result<Self, ImageError> {
        let (bytes, trailer) = bytes.split_last_chunk::<TRAILER>().ok_or(ImageError::Damaged)?;
        if hash(bytes) != u64::from_le_bytes(*trailer) {
            return Err(ImageError::Damaged);
        }
        match bytes.first() {
            Some(&VERSION) => {}
            Some(&version) => return Err(ImageError::Version(version)),
            None => return Err(ImageError::Unreadable),
        }
        let image: Self = postcard::from_bytes(bytes).map_err(|_| ImageError::Unreadable)?;
        let arrived = image.network().id();
        if arrived != image.id {
            return Err(ImageError::OtherId { written: image.id, arrived });
        }
        image.settings()?;
        Ok(image)
    }

    /// The description.
    pub fn network(&self) -> Network<'_> {
        Network {
            reference_pa: self.reference_pa,
            nodes: &self.nodes,
            lines: &self.lines,
            segments: &self.segments,
            active: &self.active,
            responsive: &self.responsive,
            inputs: &self.inputs,
            schedules: &self.schedules,
            points: &self.points,
            plan: Plan {
                end_start: &self.end_start,
                ends: &self.ends,
                order: &self.order,
                row_start: &self.row_start,
                columns: &self.columns,
                diagonal: &self.diagonal,
                stamps: &self.stamps,
                row_of: &self.row_of,
                leaves: &self.leaves,
                terms: &self.terms,
                composite: &self.composite,
                between: &self.between,
            },
            climate: eclss_core::Climate::NONE,
        }
    }

    /// How it is run.
    pub fn settings(&self) -> Result<Settings, ImageError> {
        let method = Method::ALL.get(usize::from(self.method)).copied();
        Ok(Settings { method: method.ok_or(ImageError::Method(self.method))?, step_us: self.step_us })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eclss_network_file::{Loaded, parse};

    fn paper() -> Loaded {
        parse(include_str!("../../networks/paper.toml"), "paper.toml").expect("it ships")
    }

    fn written(loaded: &Loaded, method: Method) -> std::vec::Vec<u8> {
        let settings = Settings { method, step_us: loaded.run.step_us };
        write(&loaded.network(), settings, &mut vec![0; BYTES]).expect("it fits").to_vec()
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        let loaded = paper();
        for method in Method::ALL {
            let image = Image::read(&written(&loaded, method)).unwrap();
            let (ours, theirs) = (image.network(), loaded.network());
            assert_eq!(image.settings(), Ok(Settings { method, step_us: 1_000 }));
            assert_eq!((ours.nodes, ours.lines, ours.plan), (theirs.nodes, theirs.lines, theirs.plan));
            assert_eq!((ours.segments, ours.active), (theirs.segments, theirs.active));
            assert_eq!((ours.schedules, ours.points), (theirs.schedules, theirs.points));
            assert_eq!((ours.inputs, ours.id()), (theirs.inputs, theirs.id()));
        }
    }

    /// The largest network that an image holds finds room for its state, its image, and no more.
    #[test]
    fn the_buffers_are_enough_for_the_whole_capacity() {
        let paper = paper();
        let per_line = SEGMENTS / NODES;
        let lines: std::vec::Vec<Line> = (0..NODES)
            .map(|line| Line {
                first_segment: (line * per_line) as u32,
                segments: per_line as u32,
                flow_segment: per_line as u32 - 1,
                ..paper.lines[0]
            })
            .collect();
        let network = Network {
            nodes: &[paper.nodes[0]; NODES],
            lines: &lines,
            segments: &[paper.segments[0]; SEGMENTS],
            active: &[Active { segment: u32::MAX, line: u32::MAX }; SEGMENTS],
            responsive: &[Responsive {
                line: u32::MAX,
                first_memory: SEGMENTS as u32,
                reference_density_kg_m3: f32::MAX,
            }; NODES],
            inputs: &[f32::MAX; SEGMENTS],
            schedules: &[paper.schedules[0]; SCHEDULES],
            points: &[SchedulePoint { time_us: u64::MAX, value: f32::MAX }; SEGMENTS],
            plan: Plan {
                end_start: &[u32::MAX; NODES + 1],
                ends: &[u32::MAX; 2 * NODES],
                order: &[u32::MAX; NODES],
                row_start: &[u32::MAX; NODES + 1],
                columns: &[u32::MAX; ENTRIES],
                diagonal: &[u32::MAX; NODES],
                stamps: &[[u32::MAX; 4]; NODES],
                row_of: &[u32::MAX; NODES],
                leaves: &[[u32::MAX; 2]; NODES],
                terms: &[[u32::MAX; 3]; 2 * NODES],
                composite: &[u32::MAX; NODES],
                between: &[[u32::MAX; 2]; SEGMENTS],
            },
            ..paper.network()
        };
        for method in Method::ALL {
            let sizes = method.sizes(&network);
            assert!(sizes.state.max(sizes.work) <= NUMBERS, "{}: {sizes:?}", method.name());
            assert!(sizes.inputs <= 3 * SEGMENTS && sizes.cursors <= SCHEDULES);
            let settings = Settings { method, step_us: u32::MAX };
            let mut buffer = vec![0; BYTES];
            let bytes = write(&network, settings, &mut buffer).expect("the largest image fits");
            assert!(Image::read(bytes).is_ok());
        }
    }

    #[test]
    fn no_flipped_bit_passes() {
        let whole = written(&paper(), Method::Relaxation);
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(Image::read(&bytes).err(), Some(ImageError::Damaged), "bit {bit}");
        }
    }

    /// An image whose hash is right but whose content is not: another version, another method, more than fits.
    #[test]
    fn what_is_not_an_image_is_refused_by_name() {
        let sealed = |change: fn(&mut std::vec::Vec<u8>)| {
            let mut bytes = written(&paper(), Method::Relaxation);
            bytes.truncate(bytes.len() - TRAILER);
            change(&mut bytes);
            bytes.extend(hash(&bytes).to_le_bytes());
            Image::read(&bytes).err()
        };
        assert_eq!(sealed(|_| {}), None);
        assert_eq!(sealed(|bytes| bytes[0] = VERSION + 1), Some(ImageError::Version(VERSION + 1)));
        assert_eq!(sealed(|bytes| bytes[1] = 5), Some(ImageError::Method(5)));
        assert_eq!(sealed(|bytes| bytes.truncate(40)), Some(ImageError::Unreadable));
        assert_eq!(sealed(std::vec::Vec::clear), Some(ImageError::Unreadable));
        assert!(matches!(sealed(|bytes| bytes[6] ^= 1), Some(ImageError::OtherId { .. })));
    }

    /// What would be lost on the way is refused: nobody shall take a plant without its hardware for the whole.
    #[test]
    fn a_network_with_channels_is_refused_by_their_names() {
        let bound = parse(include_str!("../../networks/hil.toml"), "hil.toml").expect("it ships");
        let refused = check(&bound).unwrap_err();
        assert!(refused.contains("valve.opening, fan.speed, loop.mass_flow"), "{refused}");
        let climate = parse(include_str!("../../networks/thcs.toml"), "thcs.toml").expect("it ships");
        assert!(check(&climate).is_err_and(|why| why.contains("climate")));
        assert_eq!(check(&paper()), Ok(()));
    }

    #[test]
    fn an_image_that_is_cut_short_is_refused() {
        let whole = written(&paper(), Method::TrBdf2);
        for length in 0..whole.len() {
            assert!(Image::read(&whole[..length]).is_err(), "{length} bytes");
        }
    }

    #[test]
    fn a_network_with_a_climate_is_refused() {
        let loaded = parse(include_str!("../../networks/thcs.toml"), "thcs.toml").expect("it ships");
        let settings = Settings { method: loaded.run.method, step_us: loaded.run.step_us };
        assert_eq!(write(&loaded.network(), settings, &mut vec![0; 4 * BYTES]), Err(ImageError::Climate));
    }

    #[test]
    fn a_buffer_that_is_too_short_is_refused() {
        let loaded = paper();
        let settings = Settings { method: Method::Relaxation, step_us: 1_000 };
        let length = written(&loaded, Method::Relaxation).len();
        assert_eq!(write(&loaded.network(), settings, &mut vec![0; length - 1]), Err(ImageError::NoRoom));
        assert!(write(&loaded.network(), settings, &mut vec![0; length]).is_ok());
    }
}
