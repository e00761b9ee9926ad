//! Where the program keeps what is its own: settings in the platform's folder for settings, what it remembers between
//! two runs in the one for state.
//!
//! `COIF_HOME` goes before all of them. No folder is made before something is written into it.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The program's own folders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Places {
    /// What people set: settings, keys, layout.
    pub config: PathBuf,
    /// What the program remembers: recent files, recovery.
    pub state: PathBuf,
}

impl Places {
    /// Those of this machine and person.
    pub fn here() -> Self {
        Self::of(cfg!(windows), cfg!(target_os = "macos"), |name| std::env::var_os(name))
    }

    /// Everything under one folder.
    pub fn under(home: &Path) -> Self {
        Self { config: home.to_owned(), state: home.to_owned() }
    }

    fn of(windows: bool, mac: bool, variable: impl Fn(&str) -> Option<OsString>) -> Self {
        // The specification of these variables says that relative paths are to be ignored.
        let folder = |name: &str| variable(name).map(PathBuf::from).filter(|p| p.is_absolute());
        if let Some(home) = variable("COIF_HOME").filter(|home| !home.is_empty()) {
            return Self::under(Path::new(&home));
        }
        let home = folder(if windows { "USERPROFILE" } else { "HOME" })
            .unwrap_or_else(|| std::env::temp_dir().join("coif-home"));
        let (config, state) = if windows {
            (
                folder("APPDATA").unwrap_or_else(|| home.join("AppData/Roaming")),
                folder("LOCALAPPDATA").unwrap_or_else(|| home.join("AppData/Local")),
            )
        } else if mac {
            let support = home.join("Library/Application Support");
            (support.clone(), support)
        } else {
            (
                folder("XDG_CONFIG_HOME").unwrap_or_else(|| home.join(".config")),
                folder("XDG_STATE_HOME").unwrap_or_else(|| home.join(".local/state")),
            )
        };
        Self { config: config.join("coif"), state: state.join("coif") }
    }
}

#[cfg(feature = "editor")]
impl Places {
    /// What people set.
    pub(crate) fn settings(&self) -> PathBuf {
        self.config.join("settings.ron")
    }
    /// How rooms are docked.
    pub(crate) fn layout(&self) -> PathBuf {
        self.config.join("layout.ron")
    }
    /// A person's own keys.
    pub(crate) fn keys(&self) -> PathBuf {
        self.config.join("keys.ron")
    }
    /// Files that were open lately.
    pub(crate) fn recent(&self) -> PathBuf {
        self.state.join("recent.ron")
    }
    /// Documents of sessions that did not end by themselves.
    pub(crate) fn recovery(&self) -> PathBuf {
        self.state.join("recovery")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_those_of_the_platform_and_coif_home_goes_before_them() {
        let check = |windows, mac, set: &[(&str, &str)], config: &str, state: &str| {
            let set: Vec<(String, OsString)> =
                set.iter().map(|(name, value)| ((*name).to_owned(), (*value).into())).collect();
            let variable = |name: &str| {
                set.iter().find(|(known, _)| known == name).map(|(_, value)| value.clone())
            };
            let expected = Places { config: config.into(), state: state.into() };
            assert_eq!(Places::of(windows, mac, variable), expected);
        };
        let home = ("HOME", "/h");
        check(false, false, &[home], "/h/.config/coif", "/h/.local/state/coif");
        let xdg = [home, ("XDG_CONFIG_HOME", "/c"), ("XDG_STATE_HOME", "not/absolute")];
        check(false, false, &xdg, "/c/coif", "/h/.local/state/coif");
        let support = "/h/Library/Application Support/coif";
        check(false, true, &[home], support, support);
        let windows = [("USERPROFILE", "/u"), ("LOCALAPPDATA", "/l")];
        check(true, false, &windows, "/u/AppData/Roaming/coif", "/l/coif");
        check(false, false, &[home, ("COIF_HOME", "/x")], "/x", "/x");
        check(false, false, &[home, ("COIF_HOME", "")], "/h/.config/coif", "/h/.local/state/coif");
    }
}
