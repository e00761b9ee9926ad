#!/usr/bin/env bash
# Draws the gallery of the hero grooms: four sides and four close-ups of each.
#
#   docs/gallery.sh FOLDER [GROOM...]            full pictures (1920 x 1080, 64 samples) into FOLDER
#   docs/gallery.sh --sheets FOLDER [GROOM...]   one sheet of small ones for each groom, made of those in FOLDER, into
#                                                docs/pictures/gallery/ (needs ImageMagick)
#
# SAMPLES and SIZE replace the number of samples and the size. Close-ups are views saved in each groom.
set -euo pipefail
sheets=
if [ "${1:-}" = --sheets ]; then
    sheets=1
    shift
fi
folder=$(realpath -m "${1:?a folder, or --sheets and a folder}")
shift
cd "$(dirname "$0")/.."
size=${SIZE:-1920x1080}
[ -n "$sheets" ] || cargo build --quiet --release -p coif
heroes=$(sed -n '/HEROES/,/];/p' graphs/src/grooms.rs | grep -oE '"[a-z0-9_]+"' | tr -d '"')
for groom in ${*:-$heroes}; do
    cameras=(--camera front --camera left --camera right --camera back)
    while read -r view; do cameras+=(--camera "$view"); done < <(
        sed -n '/^    views: {/,/^    },/p' "graphs/grooms/$groom.ron" | sed -nE 's/^        "(close [a-z]+)": .*/\1/p')
    if [ -n "$sheets" ]; then
        mkdir -p docs/pictures/gallery
        mapfile -t close < <(cd "$folder" && printf '%s\n' "$groom"-close-*.png)
        (cd "$folder" && montage "$groom"-{front,left,right,back}.png "${close[@]}" -tile 4x2 -geometry 400x225+1+1 \
            -background black -quality 82 -strip "$groom-sheet.jpg")
        mv "$folder/$groom-sheet.jpg" "docs/pictures/gallery/$groom.jpg"
        continue
    fi
    mkdir -p "$folder"
    target/release/coif render "$groom" "${cameras[@]}" --light "${LIGHT:-studio}" --size "$size" \
        --samples "${SAMPLES:-64}" --out "$folder/$groom-%s.png"
done
