#!/usr/bin/env bash
# What cargo calls in place of the compiler for the crates of this workspace (RUSTC_WORKSPACE_WRAPPER): lints and documents a crate, then
# compiles it. Both read the dependencies that the build for tests has compiled; `cargo clippy` and `cargo doc` would compile all of
# them once more, as metadata, which takes longer than the lints.
#
# The program is also checked as the build for farms has it: without features, and without the crates that they bring.
# Benches are linted and not compiled. What clippy and rustdoc find lies under target/lints/, a file for each crate, until it is mended.
compiler=$1
shift
case " $* " in *" --emit="*) ;; *) exec "$compiler" "$@" ;; esac # cargo asks what the compiler is

brought=" $(grep -o '"dep:[a-z0-9_-]*' app/Cargo.toml | cut -d: -f2 | tr '\n-' ' _') "
all=("$@") given=() bare=() name='' type='' out='' extra='' bench=''
while [ $# -gt 0 ]; do
    one=("$1")
    farm=1
    case $1 in
        --error-format=* | --json=* | --emit=*) one=() ;;
        --out-dir) out=$2 one=() && shift ;;
        --crate-name) name=$2 one+=("$2") && shift ;;
        --crate-type) type=$2 one+=("$2") && shift ;;
        --cfg) one+=("$2") farm='' && shift ;;
        --extern)
            one+=("$2")
            [[ $brought == *" ${2%%=*} "* ]] && farm=''
            shift
            ;;
        -C | -L | -A | -W | -D | -F | --check-cfg) one+=("$2") && shift ;;
        */benches/*) bench=1 ;;
    esac
    case " ${one[*]} " in *" extra-filename="*) extra=${one[1]#*=} ;; esac
    given+=("${one[@]}")
    [ -n "$farm" ] && bare+=("${one[@]}")
    shift
done

mkdir -p target/lints
found=target/lints/$name$extra.txt
lint() { clippy-driver "$compiler" "$@" --emit=metadata --out-dir target/lints -D warnings; }
# A library is linted with its tests, where it has any; without them the compiler's own warnings remain, such as code that tests alone use.
library=''
case " ${all[*]} " in *" --test "*) ;; *) [ "$type" = lib ] && library=1 ;; esac
{
    if [ -z "$library" ] || grep -q '^test = false' "$CARGO_MANIFEST_DIR/Cargo.toml"; then
        lint "${given[@]}"
    fi
    if [ -n "$library" ]; then
        rustdoc "${given[@]}" --out-dir target/doc -D warnings
        [ "$name" = coif ] && "$compiler" "${bare[@]}" --emit=metadata --out-dir target/lints -D warnings
    fi
} >"$found" 2>&1
[ -s "$found" ] || rm "$found"
rm -f "target/lints/"*"$extra.rmeta"

if [ -n "$bench" ]; then
    "$compiler" "${given[@]}" --emit=dep-info --out-dir "$out" && exec touch "$out/$name$extra"
fi
[ -n "$library" ] && all+=(-D warnings)
exec "$compiler" "${all[@]}"
