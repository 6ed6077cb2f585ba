//! The application on a Linux computer.

fn main() -> std::process::ExitCode {
    eclss_target::boards::rt_pc::start(std::env::args().skip(1))
}
