#!/usr/bin/env bash
# Everything tested: format, lints, documentation, and all tests, with one build of everything (lint.sh).
#
# tests/run.sh --long   then also what takes too long for every change: whole grooms evaluated by the release build for farms, whose
#                       hashes must be those of dev; random cases by the ten thousand; every groom on every real head; tests that are
#                       ignored else (all hair of every groom); and Blender's reader (bpy, a third of a gigabyte)
#
# Installs what the tests need where it may: Debian packages as root (a software graphics adapter among them), and usd-core
# in a Python environment under target/. Where it may not, it says what is missing; tests that need it are listed as
# skipped at the end.
# Ends with the five slowest tests, the processor time of all that it started, and the sum of the tests' own summary lines:
# "N passed, N failed, N skipped".
set -uo pipefail
cd "$(dirname "$0")/.."
[ "${1:-}" = --long ] && export COIF_LONG=1
export CARGO_INCREMENTAL="${CARGO_INCREMENTAL:-0}" CARGO_TERM_COLOR=never RUST_BACKTRACE=0
# Panics name their file and line without it.
export CARGO_PROFILE_DEV_DEBUG="${CARGO_PROFILE_DEV_DEBUG:-0}"
# Nothing is built again in parts: crates in one piece cost the least and run the fastest.
export CARGO_PROFILE_DEV_CODEGEN_UNITS="${CARGO_PROFILE_DEV_CODEGEN_UNITS:-1}"
log=target/tests.log
mkdir -p target
: >"$log"
failed=0
broken=0

# A program that takes the null device for a file to replace (coif 0.4.0 did, as root) leaves a file there, which all
# later programs fill and read. It is made anew.
if [ ! -c /dev/null ] && [ "$(id -u)" = 0 ]; then
    rm -f /dev/null && mknod -m 666 /dev/null c 1 3
fi

say() { printf '== %s\n' "$*"; }
# Puts into `spent` the processor time (s) of all that was started and waited for. (`times` must run in this shell, not in a child of
# it, and gives two lines, user and system time each: of this shell, and of its children.)
spend() {
    times >target/times
    spent=$(tail -n 1 target/times | tr 'ms' '  ' | awk '{ printf "%.0f", $1*60+$2+$3*60+$4 }')
}
# What the step took that began when so much was spent.
took() {
    spend
    printf '   %s s of processor time\n' $((spent - $1))
}
missing() { printf 'missing: %s\n' "$*" | tee -a "$log"; }

# --- what the tests need -----------------------------------------------------------------------
usd_core="usd-core==26.11"
python=target/venv/bin/python
if ! "$python" -c 'import pxr' 2>/dev/null; then
    say "Python environment with $usd_core under target/"
    if ! command -v python3 >/dev/null || ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
        if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
            apt-get update -qq && apt-get install -y -qq python3 python3-venv >/dev/null
        fi
    fi
    rm -rf target/venv
    if python3 -m venv target/venv >/dev/null 2>&1 &&
        "$python" -m pip install --quiet --disable-pip-version-check "$usd_core"; then
        :
    else
        rm -rf target/venv
        missing "Python 3 with venv and $usd_core (pip install $usd_core): files are not opened with OpenUSD"
    fi
fi
# Jobs for farms are run as a farm reads them.
openjd="openjd-cli==0.8.0"
if [ -x "$python" ] && ! "$python" -c 'import openjd.cli' 2>/dev/null; then
    "$python" -m pip install --quiet --disable-pip-version-check "$openjd" ||
        missing "$openjd (pip install $openjd): no job for farms is run"
fi
[ -x "$python" ] && export COIF_USD_PYTHON="$PWD/$python"

bpy="bpy==5.0.1" # for Python 3.11 alone
blender=target/venv-blender/bin/python
if [ -n "${COIF_LONG:-}" ] && ! "$blender" -c 'import bpy' 2>/dev/null; then
    say "Python environment with $bpy under target/"
    rm -rf target/venv-blender
    if python3 -m venv target/venv-blender >/dev/null 2>&1 &&
        "$blender" -m pip install --quiet --disable-pip-version-check "$bpy"; then
        :
    else
        rm -rf target/venv-blender
        missing "Python 3.11 with venv and $bpy (pip install $bpy): files are not opened with Blender"
    fi
fi

# FLIP, by which pictures are compared, is C++.
if ! command -v c++ >/dev/null && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    say "a C++ compiler"
    apt-get update -qq && apt-get install -y -qq g++ >/dev/null
fi
command -v c++ >/dev/null || missing "a C++ compiler (g++): nothing that compares pictures can be built"

# Pictures: a Vulkan driver, a software one where there is no other. Its threads must be told, and its loader wants a
# private folder for the session.
driver() {
    [ "$(uname)" != Linux ] && return
    compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null || compgen -G '/etc/vulkan/icd.d/*.json' >/dev/null
}
if ! driver && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    say "a software graphics adapter"
    apt-get update -qq && apt-get install -y -qq libvulkan1 mesa-vulkan-drivers >/dev/null
fi
driver || missing "a Vulkan driver (libvulkan1 mesa-vulkan-drivers): no pictures are drawn"
export LP_NUM_THREADS="${LP_NUM_THREADS:-$(nproc 2>/dev/null || echo 2)}"
if [ ! -d "${XDG_RUNTIME_DIR:-}" ]; then
    XDG_RUNTIME_DIR="$(mktemp -d)"
    export XDG_RUNTIME_DIR
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
fi
# A window: screens in memory, hands for them, and a pen with pressure at a real X server (its test runs as root only).
if [ "$(uname)" = Linux ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    wanted=()
    command -v Xvfb >/dev/null || wanted+=(xvfb)
    command -v xdotool >/dev/null || wanted+=(xdotool)
    command -v import >/dev/null || wanted+=(imagemagick)
    [ -x /usr/lib/xorg/Xorg ] || wanted+=(xserver-xorg-core)
    [ -e /usr/lib/xorg/modules/drivers/dummy_drv.so ] || wanted+=(xserver-xorg-video-dummy)
    # What a window opens at run time. (Read whole: a pipe that ends early is a failure here.)
    libraries=$(ldconfig -p)
    for pair in libX11-xcb.so.1:libx11-xcb1 libXcursor.so.1:libxcursor1 libXi.so.6:libxi6 libXrandr.so.2:libxrandr2 \
        libXrender.so.1:libxrender1 libxkbcommon.so.0:libxkbcommon0 libxkbcommon-x11.so.0:libxkbcommon-x11-0; do
        [[ $libraries == *"${pair%%:*}"* ]] || wanted+=("${pair##*:}")
    done
    if [ ${#wanted[@]} -gt 0 ]; then
        say "screens in memory"
        apt-get update -qq && apt-get install -y -qq --no-install-recommends "${wanted[@]}" >/dev/null
    fi
fi
command -v Xvfb >/dev/null && command -v xdotool >/dev/null && command -v import >/dev/null ||
    missing "Xvfb, xdotool and import (xvfb xdotool imagemagick): no window is tried"
[ -e ../shared ] || missing "../shared (real heads and hostile files): tests that need it are skipped"

# --- checks ------------------------------------------------------------------------------------
check() {
    say "$*"
    spend
    local before=$spent
    if ! "$@"; then
        printf 'FAILED: %s\n' "$*"
        failed=$((failed + 1))
    fi
    took "$before"
}
check cargo fmt --all --check
# The time that a test took is told to who may use what is not stable yet; the compiler is not, or it would build all anew.
triple=$(rustc -vV | sed -n 's/^host: //p' | tr 'a-z-' 'A-Z_')
export "CARGO_TARGET_${triple}_RUNNER=env RUSTC_BOOTSTRAP=1"
tests() {
    say "$*"
    spend
    local before=$spent
    "$@" -- --show-output -Z unstable-options --report-time ${ignored:-} >>"$log" 2>&1
    local code=$?
    took "$before"
    if [ $code -ne 0 ]; then
        # What did not compile, and what failed with what it printed: not what the others printed.
        awk '/^error/ { n = 12 } /^failures:$/ { p = 1 } /^test result:/ { p = 0 } p || n-- > 0' "$log" | cut -c 1-500 | tail -n 200
        broken=1
    fi
}
if [ -n "${COIF_LONG:-}" ]; then
    check cargo build --quiet --release -p coif --no-default-features
    export COIF_PROGRAM="$PWD/target/release/coif"
fi
# Lints and documentation, of benches too, come with the build.
export RUSTC_WORKSPACE_WRAPPER="$PWD/tests/lint.sh"
check cargo test --quiet --no-run --workspace --bins --examples --tests --benches
found=$(find target/lints -name '*.txt' 2>/dev/null)
if [ -n "$found" ]; then
    printf 'FAILED: lints and documentation\n'
    cat $found
    failed=$((failed + 1))
fi
tests cargo test --workspace --no-fail-fast --bins --examples --tests
unset RUSTC_WORKSPACE_WRAPPER
if [ -n "${COIF_LONG:-}" ]; then
    ignored=--ignored tests cargo test --release --no-fail-fast --workspace --lib --tests
fi

# --- sum ---------------------------------------------------------------------------------------
grep -E '^(skipped|missing): ' "$log" | sort -u
sum() { grep -E '^test result:' "$log" | sed -E "s/.* ([0-9]+) $1.*/\1/" | awk '{ n += $1 } END { print n + 0 }'; }
passed=$(sum passed)
failed=$((failed + $(sum failed)))
# What ended without a word of its tests (it was not built, or killed) is a failure too.
[ "$failed" -eq 0 ] && failed=$broken
skipped=$(grep -E '^skipped: ' "$log" | awk '{ print $2 }' | sort -u | wc -l)
sed -nE 's/^test (.*) \.\.\. FAILED.*/FAILED: \1/p' "$log"
say "the slowest tests"
sed -nE 's/^test (.*) \.\.\. [a-zA-Z]+ <([0-9.]+)s>$/\2 s \1/p' "$log" | sort -rn | head -n 5
spend
say "processor time: $spent s"
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
