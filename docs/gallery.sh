#!/usr/bin/env bash
# Draws the gallery of the hero grooms: four sides and four close-ups of each.
#
#   docs/gallery.sh FOLDER [GROOM...]      full pictures (1920 x 1080, 64 samples) into FOLDER
#   docs/gallery.sh --small [GROOM...]     the small ones (480 x 270) into docs/pictures/gallery/
#
# SAMPLES and SIZE replace the number of samples and the size. Close-ups are views saved in each groom.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:?a folder, or --small}
shift
size=${SIZE:-1920x1080}
if [ "$folder" = --small ]; then
    folder=docs/pictures/gallery
    size=${SIZE:-480x270}
fi
mkdir -p "$folder"
cargo build --quiet --release -p coif
heroes=$(sed -n '/HEROES/,/];/p' graphs/src/grooms.rs | grep -oE '"[a-z0-9_]+"' | tr -d '"')
for groom in ${*:-$heroes}; do
    cameras=(--camera front --camera left --camera right --camera back)
    while read -r view; do cameras+=(--camera "$view"); done < <(
        sed -n '/^    views: {/,/^    },/p' "graphs/grooms/$groom.ron" | sed -nE 's/^        "(close [a-z]+)": .*/\1/p')
    target/release/coif render "$groom" "${cameras[@]}" --light "${LIGHT:-studio}" --size "$size" \
        --samples "${SAMPLES:-64}" --out "$folder/$groom-%s.png"
done
