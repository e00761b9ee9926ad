//! coif: a groom editor made of nodes. This file only hands over to the command line.
//!
//! Without a command the editor would open; until it exists, the start-up groom is evaluated on the
//! built-in head and written to `start.usdc` in the current folder.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
