#!/usr/bin/env bash
# Plays a worker of Slurm's trial. Its part says how it ends; it writes down what it got and each signal that came.
set -u
cd "$TRIAL" || exit 1
part=${*: -1}
part=${part%/*}
printf '%s\n' "$@" >"arguments-$part"
echo "${TRIAL_SECRET-}" >"secret-$part"
date +%s >>"starts-$part"
starts=$(wc -l <"starts-$part")

end_asked() {
    date +%s >>"signals-$part"
    # The stubborn one ends at the second signal, as a worker does that waits for a model.
    [[ $part == 6 && $(wc -l <"signals-$part") == 1 ]] && return
    exit 6
}
trap end_asked TERM

rest() {
    # Short rests, because bash takes a signal only between two.
    for _ in {1..4000}; do sleep 0.2; done
    exit 1
}

case $part in
0) exit 0 ;;
1) ((starts == 1)) && exit 6 || exit 0 ;;
2) ((starts == 1)) && exit 4 || exit 0 ;;
3) exit 7 ;;
4) exit 5 ;;
5 | 6) ((starts == 1)) && rest || exit 0 ;;
7) rest ;;
esac
