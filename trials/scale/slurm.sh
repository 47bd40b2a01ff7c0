#!/usr/bin/env bash
# Runs a script of the launcher on a Slurm of one node, and looks at what becomes of its eight workers. See README.md.
set -uo pipefail
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=trials/scale/cluster.sh
source "$here/cluster.sh"

trial=$(mktemp -d)
TRIAL=$trial/workers
# What the launcher is told to pass on, by name.
export TRIAL_SECRET=geheim
logs="$trial/it's 100% logs"
mkdir "$TRIAL" "$logs"
faults=0
# When each waiting worker was put back, and how many seconds later Slurm itself would start those that were.
pending=()
pauses=

expect() {
    local what=$1 wanted=$2 found=$3
    if [[ $found == "$wanted" ]]; then
        echo "ok     $what: $found"
    else
        echo "FAULT  $what: $found, and not $wanted"
        faults=$((faults + 1))
    fi
}

# A field of a worker's job, as Slurm has it.
field() { scontrol --oneliner show job "${array}_$1" | grep -oP "(?<= $2=)\S+" | head -1; }
lines() { if [[ -f $TRIAL/$1 ]]; then wc -l <"$TRIAL/$1"; else echo 0; fi; }

# Slurm lets two minutes pass before it starts a requeued job; the trial leaves it 15 s of them. Not none: an end of the first start that
# is told after the second has begun would end that too.
hurry() {
    local part start submitted
    for part in {0..7}; do
        [[ $(field "$part" JobState) == PENDING ]] || continue
        start=$(date --date="$(field "$part" StartTime)" +%s 2>/dev/null) || continue
        # What was put back is submitted anew.
        submitted=$(date --date="$(field "$part" SubmitTime)" +%s) || continue
        if [[ ${pending[part]-} != "$submitted" ]]; then
            pending[part]=$submitted
            pauses+=" $((start - submitted))"
        fi
        (($(date +%s) - submitted < 15)) || scontrol update JobId="${array}_$part" StartTime=now
    done
}

trap 'cluster_stop' EXIT
cluster_start "$trial" 2>"$trial/errors" || exit 1
sinfo --version

cd "$here/../.." || exit 1
# The program of the workers knows the trial's folder by itself, because no other variable reaches it.
printf '#!/usr/bin/env bash\nTRIAL=%q exec %q "$@"\n' "$TRIAL" "$here/worker.sh" >"$trial/it's a worker"
chmod +x "$trial/it's a worker"
# shellcheck disable=SC2016 # Nothing may run what stands in these arguments.
cargo run --quiet --package wayword-queue --example slurm -- \
    8 4 "$logs" TRIAL_SECRET "$trial/it's a worker" generate '$(touch hacked) `touch hacked`' "it's" '*' >"$trial/script" || exit 1
bash -n "$trial/script" || exit 1

begin=$SECONDS
array=$(sbatch --parsable "$trial/script") || exit 1
echo "array $array"
# Part 7 is cancelled once it runs. All else ends by itself, the last after the time limit and the stubborn worker's patience.
until [[ $(lines starts-7) == 1 ]]; do sleep 1; done
scancel "${array}_7"
while squeue --noheader --jobs="$array" 2>/dev/null | grep -q .; do
    ((SECONDS - begin < 900)) || { echo "FAULT  it did not end"; faults=$((faults + 1)); break; }
    hurry
    sleep 3
done
echo "took $((SECONDS - begin)) s"

#     part state starts signals exit
while read -r part state starts signals code what; do
    expect "part $part ($what), state" "$state" "$(field "$part" JobState)"
    expect "part $part ($what), exit code" "$code" "$(field "$part" ExitCode)"
    expect "part $part ($what), starts" "$starts" "$(lines "starts-$part")"
    expect "part $part ($what), signals" "$signals" "$(lines "signals-$part")"
done <<'END'
0 COMPLETED 1 0 0:0 done
1 COMPLETED 2 0 0:0 stopped by a signal, then done
2 COMPLETED 2 0 0:0 busy, then done
3 FAILED 4 0 7:0 lost each time
4 FAILED 1 0 5:0 budget spent
5 COMPLETED 2 1 0:0 time is up, then done
6 COMPLETED 2 2 0:0 time is up and stubborn, then done
7 CANCELLED 1 1 6:0 cancelled
END
expect 'arguments' "generate|\$(touch hacked) \`touch hacked\`|it's|*|--shard|3/8|" "$(tr '\n' '|' <"$TRIAL/arguments-3")"
expect 'a named variable' geheim "$(cat "$TRIAL/secret-3")"
expect 'that variable in the script' 0 "$(grep -c geheim "$trial/script")"
expect 'logs' 8 "$(find "$logs" -name '*.log' | wc -l)"
expect 'the log of the one that lost something' 3 "$(grep -c 'It starts again' "$logs/wayword-${array}_3.log")"
expect 'nothing was run out of an argument' '' "$(find . "$TRIAL" -maxdepth 1 -name hacked)"
expect "Slurm's own pause before each start, s" 121 "$(tr ' ' '\n' <<<"$pauses" | grep . | sort -un)"
for part in 5 6; do
    paste -d ' ' <(head -1 "$TRIAL/starts-$part") <(tr '\n' ' ' <"$TRIAL/signals-$part") |
        awk -v part="$part" '{ for (i = 2; i <= NF; i++) print "part " part ": signal " $i - $1 " s after its start, of 240 s" }'
done

if ((faults > 0)); then
    echo "$faults faults; see $trial"
    exit 1
fi
rm -r "$trial"
echo "all as expected"
