//! coif: a groom editor made of nodes. This file tells graphics drivers what they read from the environment, and hands
//! over.

fn main() -> std::process::ExitCode {
    #[cfg(feature = "render")]
    tell_drivers();
    coif::main()
}

/// What graphics drivers read from the environment and nowhere else. What the user set stays.
///
/// Mesa's software adapter may take one thread only unless it is told how many there are; pictures are the same bytes for
/// any number. Mesa's choice of the display's own GPU asks a display that need not be there, and complains on stderr.
#[cfg(feature = "render")]
fn tell_drivers() {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let set = |name: &str, value: &str| {
        if !is_set(name) {
            #[expect(unsafe_code, reason = "no driver can be told in another way")]
            // SAFETY: this is the first thing that the program does, so no other thread reads the environment.
            unsafe {
                std::env::set_var(name, value);
            }
        }
    };
    if let Ok(cores) = std::thread::available_parallelism() {
        set("LP_NUM_THREADS", &cores.to_string());
    }
    if !is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") {
        set("NODEVICE_SELECT", "1");
    }
}
