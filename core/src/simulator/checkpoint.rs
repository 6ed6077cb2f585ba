//! Checkpoints: a run as bytes, from which it goes on to the same bits.
//!
//! All numbers are little-endian. A header says what the bytes belong to, then follow state and carries, what the
//! method keeps between steps, inputs at their stage times and positions in the schedules, then a CRC-32
//! (ISO-HDLC) over everything before it.
//!
//! | bytes | what |
//! |---|---|
//! | 0…3 | `ECKP` |
//! | 4…5 | version of this format |
//! | 6 | method, in the order of [`Method::ALL`] |
//! | 7 | health: 0 trusted, 1 a node left its range, 2 a line did |
//! | 8…15 | network id |
//! | 16…19 | step \[µs\] |
//! | 20…23 | index of that node or line, else 0 |
//! | 24…31 | tick |
//! | 32…39 | tick of the fault, else 0 |
//! | 40…47 | steps without proof |
//! | 48…63 | words of state, work, inputs, cursors |
//! | 64…75 | margin of the last step: φ, spectral bound, proof |
//! | 76…87 | worst margin, the same |
//! | 88…  | the words |
//!
//! A checkpoint is for the same network, method, step and version of this format; anything else is refused before
//! anything is changed. So are figures that no run can have come to: a state that is not finite in a trusted run, a
//! place behind a schedule's end, a time that cannot be counted.

use super::{Fault, Health, Place, Simulator};
use crate::component::Element;
use crate::{Margin, Method, Proof, Schedule};

const MAGIC: [u8; 4] = *b"ECKP";
/// Rises whenever the words of any method or of the climate change their place or their meaning; `network-file`'s test
/// `checkpoint_layout` notices.
const VERSION: u16 = 6;
const HEADER: usize = 88;
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);
const CRC_BYTES: usize = 4;

/// Why a checkpoint was not written or not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CheckpointError {
    /// The buffer is too short, or the bytes are not as many as this simulator's checkpoint has.
    Length {
        /// Bytes that are needed.
        needed: usize,
        /// Bytes that were given.
        given: usize,
    },
    /// Not a checkpoint at all.
    NotACheckpoint,
    /// Written in another version of this format.
    Version(u16),
    /// Of another network.
    Network {
        /// That network's id.
        id: u64,
    },
    /// Of a run with another method or step.
    Settings,
    /// Its CRC or a figure in it is wrong.
    Damaged,
}

impl core::fmt::Display for CheckpointError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Length { needed, given } => write!(f, "{given} bytes, of which there must be {needed}"),
            Self::NotACheckpoint => f.write_str("not a checkpoint"),
            Self::Version(version) => write!(f, "version {version} of the format, not {VERSION}"),
            Self::Network { id } => write!(f, "of another network, {id:016x}"),
            Self::Settings => f.write_str("of a run with another method or step"),
            Self::Damaged => f.write_str("damaged"),
        }
    }
}

impl core::error::Error for CheckpointError {}

/// Puts numbers one after the other into bytes of sufficient length.
struct Writer<'b> {
    rest: &'b mut [u8],
}

impl Writer<'_> {
    fn bytes<const N: usize>(&mut self, bytes: [u8; N]) {
        if let Some((place, rest)) = core::mem::take(&mut self.rest).split_first_chunk_mut() {
            *place = bytes;
            self.rest = rest;
        }
    }

    fn margin(&mut self, margin: &Margin) {
        self.bytes(margin.phi.to_le_bytes());
        self.bytes(margin.spectral_bound.to_le_bytes());
        self.bytes((margin.proof as u32).to_le_bytes());
    }
}

/// Takes numbers one after the other; `None` behind the end.
struct Reader<'b> {
    rest: &'b [u8],
}

impl Reader<'_> {
    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (bytes, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(*bytes)
    }

    fn word(&mut self) -> Option<u32> {
        self.bytes().map(u32::from_le_bytes)
    }

    fn long(&mut self) -> Option<u64> {
        self.bytes().map(u64::from_le_bytes)
    }

    fn value(&mut self) -> Option<f32> {
        self.bytes().map(f32::from_le_bytes)
    }

    fn margin(&mut self) -> Option<Margin> {
        let (phi, spectral_bound) = (self.value()?, self.value()?);
        let proofs = [Proof::ByConstruction, Proof::Dominant, Proof::ShortStep, Proof::None];
        let proof = *proofs.get(self.word()? as usize)?;
        Some(Margin { phi, spectral_bound, proof })
    }

    fn values(&mut self, values: &mut [f32]) -> Option<()> {
        for value in values {
            *value = self.value()?;
        }
        Some(())
    }
}

/// What a header says beyond what the simulator knows.
struct Header {
    tick: u64,
    health: Health,
    unproven_ticks: u64,
    margin: Margin,
    worst_margin: Margin,
}

impl<E: Element> Simulator<'_, E> {
    /// Bytes of a checkpoint of this simulator.
    pub fn checkpoint_bytes(&self) -> usize {
        let words = self.state.len() + self.work.len() + self.inputs.len() + self.cursors.len();
        HEADER + 4 * words + CRC_BYTES
    }

    /// Writes the run into the beginning of `bytes` and returns the part that was written.
    pub fn save<'b>(&self, bytes: &'b mut [u8]) -> Result<&'b [u8], CheckpointError> {
        let (needed, given) = (self.checkpoint_bytes(), bytes.len());
        let short = CheckpointError::Length { needed, given };
        let bytes = bytes.get_mut(..needed).ok_or(short)?;
        let (body, crc) = bytes.split_at_mut_checked(needed - CRC_BYTES).ok_or(short)?;
        let mut out = Writer { rest: body };
        let (health, index, fault_tick) = match self.health {
            Health::Trusted => (0, 0, 0),
            Health::Faulted(Fault { tick, place: Place::Node(index) }) => (1, index, tick),
            Health::Faulted(Fault { tick, place: Place::Line(index) }) => (2, index, tick),
        };
        out.bytes(MAGIC);
        out.bytes(VERSION.to_le_bytes());
        out.bytes([self.settings.method as u8, health]);
        out.bytes(self.network_id.to_le_bytes());
        out.bytes(self.settings.step_us.to_le_bytes());
        out.bytes(index.to_le_bytes());
        out.bytes(self.tick.to_le_bytes());
        out.bytes(fault_tick.to_le_bytes());
        out.bytes(self.unproven_ticks.to_le_bytes());
        for length in self.lengths() {
            out.bytes(length.to_le_bytes());
        }
        out.margin(&self.margin);
        out.margin(&self.worst_margin);
        for value in self.state.iter().chain(self.work.iter()).chain(self.inputs.iter()) {
            out.bytes(value.to_le_bytes());
        }
        for cursor in self.cursors.iter() {
            out.bytes(cursor.to_le_bytes());
        }
        crc.copy_from_slice(&CRC.checksum(body).to_le_bytes());
        Ok(bytes)
    }

    /// Goes back to the run in `bytes`, which [`Self::save`] wrote for the same network, method and step. What is
    /// refused changes nothing.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), CheckpointError> {
        let header = self.read_header(bytes)?;
        self.check_words(&header, bytes).ok_or(CheckpointError::Damaged)?;
        let mut words = Reader { rest: bytes.get(HEADER..).unwrap_or(&[]) };
        // The length was compared, so nothing ends early from here on.
        let taken = words
            .values(self.state)
            .and_then(|()| words.values(self.work))
            .and_then(|()| words.values(self.inputs))
            .and_then(|()| {
                for cursor in self.cursors.iter_mut() {
                    *cursor = words.word()?;
                }
                Some(())
            });
        self.tick = header.tick;
        self.time_us = header.tick.saturating_mul(u64::from(self.settings.step_us));
        self.health = header.health;
        self.unproven_ticks = header.unproven_ticks;
        (self.margin, self.worst_margin) = (header.margin, header.worst_margin);
        taken.ok_or(CheckpointError::Damaged)
    }

    /// Looks at the words of bytes that are whole and as long as they must be: a run that is trusted has finite states,
    /// inputs that its elements take, and its schedules are at one of their points.
    fn check_words(&self, header: &Header, bytes: &[u8]) -> Option<()> {
        let states = bytes.get(HEADER..HEADER + 4 * self.state.len())?;
        let finite = |word: &[u8; 4]| f32::from_le_bytes(*word).is_finite();
        let trusted = header.health == Health::Trusted;
        (!trusted || states.as_chunks().0.iter().all(finite)).then_some(())?;
        let inputs = HEADER + 4 * (self.state.len() + self.work.len());
        let inputs: &[[u8; 4]] = bytes.get(inputs..inputs + 4 * self.inputs.len())?.as_chunks().0;
        // A set for each of the method's stages.
        let mut stages = inputs.chunks(self.network.inputs.len().max(1));
        let taken = |stage: &[[u8; 4]]| {
            self.network.takes_inputs(|slot| stage.get(slot).map(|word| f32::from_le_bytes(*word)))
        };
        stages.all(taken).then_some(())?;
        let cursors = bytes.len().checked_sub(CRC_BYTES + 4 * self.cursors.len())?;
        let cursors = bytes.get(cursors..)?.as_chunks().0;
        let there = |(schedule, word): (&Schedule, &[u8; 4])| u32::from_le_bytes(*word) <= schedule.points;
        self.network.schedules.iter().zip(cursors).all(there).then_some(())
    }

    fn lengths(&self) -> [u32; 4] {
        [self.state.len(), self.work.len(), self.inputs.len(), self.cursors.len()].map(|words| words as u32)
    }

    fn read_header(&self, bytes: &[u8]) -> Result<Header, CheckpointError> {
        let mut header = Reader { rest: bytes };
        if header.bytes() != Some(MAGIC) {
            return Err(CheckpointError::NotACheckpoint);
        }
        let version = header.bytes().map(u16::from_le_bytes).ok_or(CheckpointError::Damaged)?;
        if version != VERSION {
            return Err(CheckpointError::Version(version));
        }
        // Only bytes that are whole are believed in what they say they are.
        let (body, crc) = bytes.split_last_chunk().ok_or(CheckpointError::Damaged)?;
        if CRC.checksum(body) != u32::from_le_bytes(*crc) {
            return Err(CheckpointError::Damaged);
        }
        self.compare(&mut header, bytes.len())
    }

    fn compare(&self, header: &mut Reader<'_>, given: usize) -> Result<Header, CheckpointError> {
        const ENDS: CheckpointError = CheckpointError::Damaged;
        let [method, health] = header.bytes().ok_or(ENDS)?;
        let id = header.long().ok_or(ENDS)?;
        if id != self.network_id {
            return Err(CheckpointError::Network { id });
        }
        let step_us = header.word().ok_or(ENDS)?;
        if Method::ALL.get(usize::from(method)) != Some(&self.settings.method)
            || step_us != self.settings.step_us
        {
            return Err(CheckpointError::Settings);
        }
        let index = header.word().ok_or(ENDS)?;
        let tick = header.long().ok_or(ENDS)?;
        let fault_tick = header.long().ok_or(ENDS)?;
        let unproven_ticks = header.long().ok_or(ENDS)?;
        for length in self.lengths() {
            if header.word() != Some(length) {
                return Err(CheckpointError::Length { needed: self.checkpoint_bytes(), given });
            }
        }
        if given != self.checkpoint_bytes() {
            return Err(CheckpointError::Length { needed: self.checkpoint_bytes(), given });
        }
        // A run of a hundred thousand years at most, so that time goes on counting.
        let time_us = tick.checked_mul(u64::from(step_us)).ok_or(ENDS)?;
        if time_us > u64::MAX >> 2 || fault_tick > tick || unproven_ticks > tick {
            return Err(ENDS);
        }
        let fault = |place| Health::Faulted(Fault { tick: fault_tick, place });
        let health = match health {
            0 => Health::Trusted,
            1 => fault(Place::Node(index)),
            2 => fault(Place::Line(index)),
            _ => return Err(ENDS),
        };
        let margin = header.margin().ok_or(ENDS)?;
        let worst_margin = header.margin().ok_or(ENDS)?;
        Ok(Header { tick, health, unproven_ticks, margin, worst_margin })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Settings, Storage, example};

    type Room = Storage<64, 192, 8, 4>;

    fn build(method: Method, storage: &mut Room) -> Simulator<'_> {
        static NETWORK: std::sync::LazyLock<crate::Network<'static>> =
            std::sync::LazyLock::new(example::paper_loop);
        Simulator::new(&NETWORK, Settings { method, step_us: 1_000 }, storage.buffers()).unwrap()
    }

    /// Saved in the middle of a transient and restored into another simulator that has been elsewhere meanwhile.
    #[test]
    fn a_restored_run_goes_on_to_the_same_bits() {
        for method in Method::ALL {
            let (mut ours, mut theirs) = (Room::new(), Room::new());
            let (mut ours, mut theirs) = (build(method, &mut ours), build(method, &mut theirs));
            let mut bytes = [0; 2_048];
            for step in 0..40 {
                ours.set_input(1, 1.0 - 0.01 * step as f32).unwrap();
                ours.step();
            }
            theirs.set_input(1, 0.3).unwrap();
            (0..7).for_each(|_| _ = theirs.step());
            let saved = ours.save(&mut bytes).unwrap();
            assert_eq!(saved.len(), ours.checkpoint_bytes());
            theirs.restore(saved).unwrap();
            assert_eq!((ours.state_hash(), ours.time_us()), (theirs.state_hash(), theirs.time_us()));
            for step in 0..500 {
                assert_eq!(ours.step(), theirs.step());
                assert_eq!(ours.state_hash(), theirs.state_hash(), "{method:?}, step {step}");
                assert_eq!(ours.margin().phi.to_bits(), theirs.margin().phi.to_bits());
            }
            assert_eq!(ours.worst_margin().phi.to_bits(), theirs.worst_margin().phi.to_bits());
            assert_eq!(ours.unproven_ticks(), theirs.unproven_ticks());
        }
    }

    #[test]
    fn what_is_foreign_is_refused_by_name() {
        let mut storage = Room::new();
        let ours = build(Method::TrBdf2, &mut storage);
        let mut bytes = [0; 2_048];
        let saved = ours.save(&mut bytes).unwrap();
        let mut room = Room::new();
        let refused = build(Method::Relaxation, &mut room).restore(saved);
        assert_eq!(refused, Err(CheckpointError::Settings));
        let inputs = [1.0, 0.5];
        let other = crate::Network { inputs: &inputs, ..example::paper_loop() };
        let settings = Settings { method: Method::TrBdf2, step_us: 1_000 };
        let mut room = Room::new();
        let mut theirs = Simulator::new(&other, settings, room.buffers()).unwrap();
        let id = ours.network_id();
        assert_eq!(theirs.restore(saved), Err(CheckpointError::Network { id }));
        assert_eq!(theirs.restore(b"something else"), Err(CheckpointError::NotACheckpoint));
        assert_eq!(theirs.restore(b"ECKP\x07\x00"), Err(CheckpointError::Version(7)));
        let mut few = [0; 100];
        assert!(matches!(ours.save(&mut few), Err(CheckpointError::Length { given: 100, .. })));
    }

    /// Whole bytes that no run can have come to, as of a writer with a mistake.
    #[test]
    fn figures_that_cannot_be_are_refused() {
        let points = [crate::SchedulePoint { time_us: 0, value: 1.0 }];
        let schedules = [crate::Schedule {
            input: 1,
            first_point: 0,
            points: 1,
            interpolation: crate::Interpolation::Hold,
        }];
        let network = crate::Network { schedules: &schedules, points: &points, ..example::paper_loop() };
        let settings = Settings { method: Method::TrBdf2, step_us: 1_000 };
        let mut storage = Room::new();
        let mut ours = Simulator::new(&network, settings, storage.buffers()).unwrap();
        ours.step();
        let mut bytes = [0; 2_048];
        let length = ours.save(&mut bytes).unwrap().len();
        let hash = ours.state_hash();
        let last_cursor = length - CRC_BYTES - 4;
        let mut refused = |place: usize, figure: &[u8]| {
            let mut bytes = bytes;
            bytes[place..place + figure.len()].copy_from_slice(figure);
            let crc = CRC.checksum(&bytes[..length - CRC_BYTES]).to_le_bytes();
            bytes[length - CRC_BYTES..length].copy_from_slice(&crc);
            let result = ours.restore(&bytes[..length]);
            ours.step();
            result
        };
        assert_eq!(refused(24, &u64::MAX.to_le_bytes()), Err(CheckpointError::Damaged));
        assert_eq!(refused(24, &(u64::MAX / 1_000).to_le_bytes()), Err(CheckpointError::Damaged));
        assert_eq!(refused(last_cursor, &2_u32.to_le_bytes()), Err(CheckpointError::Damaged));
        assert_eq!(refused(40, &u64::MAX.to_le_bytes()), Err(CheckpointError::Damaged));
        assert_eq!(refused(88, &f32::NAN.to_le_bytes()), Err(CheckpointError::Damaged));
        // The last stage's.
        let valve = last_cursor - 4;
        for wrong in [1.5, -0.5, f32::NAN] {
            assert_eq!(refused(valve, &wrong.to_le_bytes()), Err(CheckpointError::Damaged), "{wrong}");
        }
        assert_eq!(refused(valve, &0.5_f32.to_le_bytes()), Ok(()));
        assert_eq!(refused(24, &7_u64.to_le_bytes()), Ok(()));
        assert_ne!(ours.state_hash(), hash);
    }

    /// Every byte that is cut off and every bit that is turned is noticed, and nothing has changed by then.
    #[test]
    fn damage_is_noticed_before_anything_changes() {
        let mut storage = Room::new();
        let mut ours = build(Method::TrBdf2, &mut storage);
        (0..3).for_each(|_| _ = ours.step());
        let mut bytes = [0; 2_048];
        let length = ours.save(&mut bytes).unwrap().len();
        ours.step();
        let hash = ours.state_hash();
        for cut in 0..length {
            assert!(ours.restore(&bytes[..cut]).is_err(), "cut at {cut}");
        }
        for bit in 0..8 * length {
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert!(ours.restore(&bytes[..length]).is_err(), "bit {bit}");
            bytes[bit / 8] ^= 1 << (bit % 8);
        }
        assert_eq!((ours.state_hash(), ours.tick()), (hash, 4));
        assert_eq!(ours.restore(&bytes[..length]), Ok(()));
        assert_eq!(ours.tick(), 3);
    }
}
