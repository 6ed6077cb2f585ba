//! Tests of firmware on emulated boards, in one program. They need firmware and an emulator: `cargo xtask test qemu`.

mod emulator;
mod qemu_bits;
mod qemu_elf;
mod qemu_hil;
mod qemu_loop;
mod wire;
