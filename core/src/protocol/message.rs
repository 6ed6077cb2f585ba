//! The messages, as postcard writes them: fields in this order, integers as varints, `f32` as four bytes.

use crate::mode::{Mode, Refusal, Request};
use crate::process::CHANNELS;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Version of the protocol: the first byte of every packet, in every version.
pub const VERSION: u8 = 1;

/// One packet: what a frame carries.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Packet {
    /// [`VERSION`].
    pub version: u8,
    /// What both ends agreed on; 0 before they did.
    pub session: u32,
    /// Counts all packets that the sender has sent in this session, from 1; 0 before there is one.
    pub sequence: u32,
    /// The sender's tick.
    pub tick: u64,
    /// The sender's clock \[µs since its start\].
    pub time_us: u64,
    /// The message.
    pub body: Body,
}

/// A message.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[allow(clippy::large_enum_variant, reason = "there is no heap, and data are what is sent")]
pub enum Body {
    /// Who I am and what I run; sent until both ends agree.
    Hello(Hello),
    /// The peer runs something else.
    Refused(Refused),
    /// Process data, once a tick.
    Data(Data),
    /// Something to do, once.
    Command(CommandFrame),
    /// The answer to a command.
    Ack(Ack),
    /// Something to do, once, with the sender's proof that it has the key.
    Keyed(KeyedCommand),
}

/// Which end of the wire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Role {
    /// Runs the plant and is time master.
    #[default]
    Plant,
    /// Drives the plant's inputs and reads its outputs.
    Controller,
}

/// Opens a session.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hello {
    /// Which end the sender is.
    pub role: Role,
    /// Id of the network.
    pub network_id: u64,
    /// Id of the process image.
    pub process_id: u64,
    /// The plant's step \[µs\].
    pub step_us: u32,
    /// Values from controller to plant.
    pub inputs: u16,
    /// Values from plant to controller.
    pub outputs: u16,
    /// The sender's number for this session, another one for each.
    pub nonce: u32,
    /// The peer's number, 0 until it is known.
    pub echo: u32,
}

/// Why a hello was refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RefusedReason {
    /// Both ends have the same role.
    Role,
    /// Another network.
    Network,
    /// Another process image.
    Process,
    /// Another step.
    Step,
}

/// Refuses a hello.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Refused {
    /// Why.
    pub reason: RefusedReason,
    /// The `nonce` of the hello that is refused.
    pub echo: u32,
}

/// The newest packet that the sender got, for delays and clocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Echo {
    /// Its sequence number; 0 for none.
    pub sequence: u32,
    /// Its time stamp \[µs on the clock of its sender\].
    pub time_us: u64,
    /// How long ago it came \[µs\].
    pub age_us: u32,
}

/// Process data of one tick.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Data {
    /// The sender's mode.
    pub mode: Mode,
    /// Why it is SAFE, [`crate::mode::Cause::code`]; 0 for no reason.
    pub cause: u8,
    /// The newest packet of the peer.
    pub echo: Echo,
    /// Raw values of the channels with port `link`, in the order of the process image.
    pub values: Vec<f32, CHANNELS>,
    /// [`crate::process::Quality`] of each value; may be empty, which says all are good.
    pub quality: Vec<u8, CHANNELS>,
    /// Quality that the sender found in each of the peer's values.
    pub seen: Vec<u8, CHANNELS>,
}

impl Default for Data {
    fn default() -> Self {
        Self {
            mode: Mode::PowerUp,
            cause: 0,
            echo: Echo::default(),
            values: Vec::new(),
            quality: Vec::new(),
            seen: Vec::new(),
        }
    }
}

impl Data {
    /// Value `index`, `None` where there is none or its sender does not vouch for it.
    pub fn value(&self, index: usize) -> Option<f32> {
        // Good, saturated and moving values are meant; everything else stands in for something.
        let meant = self.quality.get(index).is_none_or(|quality| matches!(quality, 0 | 3 | 9));
        self.values.get(index).copied().filter(|_| meant)
    }
}

/// A command with its number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CommandFrame {
    /// Number of the command: the same when it is sent again, another for each command of a session.
    pub id: u32,
    /// What to do.
    pub command: Command,
}

/// Bytes of a tag.
pub(super) const TAG_BYTES: usize = 16;

/// A command with a tag, which only those make who have the key: `docs/protocol.md`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KeyedCommand {
    /// The command.
    pub frame: CommandFrame,
    /// Its tag.
    pub tag: [u8; TAG_BYTES],
}

/// What to do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Change the mode.
    Mode(Request),
    /// Set a parameter.
    Set {
        /// Its number.
        parameter: u16,
        /// Its value.
        value: f32,
    },
    /// Tell a parameter.
    Get {
        /// Its number.
        parameter: u16,
    },
}

/// What became of a command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Done; the mode now.
    Mode(Mode),
    /// Done, or told: the parameter now.
    Value(f32),
    /// The mode stays.
    Refused(Refusal),
    /// There is no such parameter.
    NoSuchParameter,
    /// The value is not finite or out of the parameter's range.
    OutOfRange,
    /// Another command has not been done yet.
    Busy,
}

/// The answer to a command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ack {
    /// Number of the command.
    pub id: u32,
    /// What became of it.
    pub outcome: Outcome,
}
