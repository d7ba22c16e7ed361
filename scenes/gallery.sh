#!/bin/sh
# Renders the pictures of the README into docs/gallery: scenes/gallery.sh [NAME…]
# The commands are those of the README; DOTRAY names the program.
set -eu
cd "$(dirname "$0")/.."
dotray=${DOTRAY:-target/release/dotray}

picture() {
    name=$1
    size=$2
    shift 2
    case " $wanted " in
    "  " | *" $name "*) "$dotray" render "scenes/$name.ray" "docs/gallery/$name.png" --size "$size" --aa adaptive "$@" ;;
    esac
}

wanted="$*"
picture slides 720x480
picture hello 720x480
picture lake 600x400
picture virus 720x480
picture chess 600x400
picture desk 720x480 --recursion 8 --cutoff 0.01
picture glasses 720x480 --recursion 10 --cutoff 0.01
picture caffeine 720x480
picture nautilus 720x480
picture lenses 600x400 --recursion 10 --cutoff 0.01
picture gyroid 600x400
picture sphereflake 720x480 --recursion 6
picture knot 720x480
picture cornell 720x480 --recursion 8 --cutoff 0.01
picture mirrors 600x400 --recursion 40 --cutoff 0.01
picture field 720x480
picture network 720x480
