//! Whether a network fits a board: what its tables take in flash and its numbers in RAM, against what the board
//! has. Used by the build; the sums are checked again by the compiler for the board itself.

use eclss_core::{Method, Network, Sizes};

/// What a network takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Need {
    /// Constant tables, with the width of this computer's pointers \[bytes\].
    pub flash: u64,
    /// State and work of its method \[bytes\].
    pub ram: u64,
}

/// What is kept for a board's program, whatever the network \[bytes\]. `tests/tests/qemu_elf.rs` holds it against what
/// the programs take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Program {
    /// Code, constants and initial values.
    pub flash: u64,
    /// Statics and stack.
    pub ram: u64,
}

/// Programs of the emulated boards.
pub const MPS2: Program = Program { flash: 256 << 10, ram: 48 << 10 };
/// Program of the NUCLEO-H743ZI2: with the link and its frames on the stack.
pub const NUCLEO: Program = Program { flash: 256 << 10, ram: 48 << 10 };

/// What a board has \[bytes\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Flash.
    pub flash: u64,
    /// RAM for statics and stack.
    pub ram: u64,
    /// What is not for the network.
    pub program: Program,
}

impl Need {
    /// Returns the sum over a network's tables, and the buffers that `method` asks for.
    pub fn of(network: &Network<'_>, method: Method) -> Self {
        let Sizes { state, work, inputs, cursors } = method.sizes(network);
        let ram = size_of::<f32>() * (state + work + inputs + cursors);
        Self { flash: network.flash_bytes() as u64, ram: ram as u64 }
    }

    /// Returns Rust constants with these figures, which the firmware's own compiler holds against its tables.
    pub fn constants(self) -> String {
        let Self { flash, ram } = self;
        format!(
            "\n/// Constant tables of the network [bytes].\npub const FLASH_BYTES: usize = {flash};\n\
             \n/// State and work of the network's method [bytes].\npub const RAM_BYTES: usize = {ram};\n"
        )
    }
}

/// Says for each memory that is too small what does not fit, and by how much.
pub fn check(board: &str, network: &str, method: &str, need: Need, room: Room) -> Result<(), String> {
    let short = |memory: &str, what: &str, need: u64, has: u64, program: u64| {
        let over = (need + program).checked_sub(has + 1)? + 1;
        Some(format!(
            "network {network} does not fit {board}: {what} takes {need} bytes of {memory}; of {has} there are, \
             {program} are the program's: {over} bytes too many"
        ))
    };
    let flash = short("flash", "its description", need.flash, room.flash, room.program.flash);
    let ram = short("RAM", &format!("method {method}"), need.ram, room.ram, room.program.ram);
    match (flash, ram) {
        (None, None) => Ok(()),
        (Some(one), None) | (None, Some(one)) => Err(one),
        (Some(flash), Some(ram)) => Err(format!("{flash}; {ram}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOM: Room = Room { flash: 1_000, ram: 500, program: Program { flash: 100, ram: 50 } };

    fn checked(flash: u64, ram: u64) -> Result<(), String> {
        check("a-board", "`n` (n.toml)", "tr-bdf2", Need { flash, ram }, ROOM)
    }

    #[test]
    fn what_fits_to_the_last_byte_fits() {
        assert_eq!(checked(900, 450), Ok(()));
    }

    #[test]
    fn what_does_not_fit_is_named_with_its_excess() {
        let ram = checked(900, 457).unwrap_err();
        assert_eq!(
            ram,
            "network `n` (n.toml) does not fit a-board: method tr-bdf2 takes 457 bytes of RAM; of 500 there are, \
             50 are the program's: 7 bytes too many"
        );
        let both = checked(901, 451).unwrap_err();
        assert!(both.contains("of flash") && both.contains("of RAM"), "{both}");
        assert_eq!(both.matches("1 bytes too many").count(), 2);
    }

    #[test]
    fn the_paper_loop_takes_what_its_buffers_take() {
        let need = Need::of(&eclss_core::example::paper_loop(), Method::Relaxation);
        let constants = need.constants();
        let buffers = size_of::<eclss_core::Storage<22, 32, 6, 0>>();
        assert_eq!(need.ram, buffers as u64);
        assert!(constants.contains(&format!("RAM_BYTES: usize = {buffers};")), "{constants}");
        assert!(need.flash > 6 * size_of::<eclss_core::Segment>() as u64);
    }
}
