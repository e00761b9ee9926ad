//! coif: a groom editor made of nodes. This file only hands over to the command line.
//!
//! Without a command the editor would open; until it exists, the start-up groom is drawn on the built-in head and written
//! to `start.png` in the current folder.

mod cli;

fn main() -> std::process::ExitCode {
    #[cfg(feature = "render")]
    use_all_cores_of_a_software_adapter();
    cli::main()
}

/// Mesa's software adapter may take one thread only unless it is told how many to take; pictures are the same bytes for any
/// number. What the user set stays.
#[cfg(feature = "render")]
fn use_all_cores_of_a_software_adapter() {
    const THREADS: &str = "LP_NUM_THREADS";
    if let (None, Ok(cores)) = (std::env::var_os(THREADS), std::thread::available_parallelism()) {
        #[expect(unsafe_code, reason = "the driver reads its settings from the environment only")]
        // SAFETY: this is the first thing that the program does, so no other thread reads the environment.
        unsafe {
            std::env::set_var(THREADS, cores.to_string());
        }
    }
}
